// Escape sequences that every terminal of the last decades knows, and termios.
#include "tools/cli/terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace surefoot::cli {

namespace {

/// As locales are chosen: the first of these that is set says it.
bool speaks_utf8() {
    for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
        const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe)
        if (value == nullptr || *value == '\0') continue;
        const std::string_view text(value);
        return text.find("UTF-8") != std::string_view::npos || text.find("utf8") != std::string_view::npos ||
               text.find("utf-8") != std::string_view::npos;
    }
    return false;
}

}  // namespace

monitor::Look terminal_look(bool colour) {
    monitor::Look look;
    look.colour = colour;
    look.unicode = speaks_utf8();
    winsize size{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0) {
        look.width = size.ws_col;
        look.height = std::max<std::size_t>(size.ws_row, 3);
    }
    return look;
}

FullScreen::FullScreen() {
    keys_ = isatty(STDIN_FILENO) == 1 && tcgetattr(STDIN_FILENO, &before_) == 0;
    if (keys_) {
        termios raw = before_;
        raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
        raw.c_cc[VMIN] = 0;
        raw.c_cc[VTIME] = 0;
        raw.c_cc[VSUSP] = _POSIX_VDISABLE;
        (void)tcsetattr(STDIN_FILENO, TCSANOW, &raw);
    }
    (void)std::fputs("\033[?1049h\033[?25l\033[H\033[2J", stdout);
    std::fflush(stdout);
}

FullScreen::~FullScreen() {
    (void)std::fputs("\033[?25h\033[?1049l", stdout);
    std::fflush(stdout);
    if (keys_) (void)tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
}

void FullScreen::draw(std::span<const std::string> lines) {
    // Over the old one, line by line: clearing first would flicker.
    std::string out = "\033[H";
    for (std::size_t i = 0; i < lines.size(); ++i) out += lines[i] + "\033[K" + (i + 1 < lines.size() ? "\r\n" : "");
    out += "\033[J";
    (void)std::fputs(out.c_str(), stdout);
    std::fflush(stdout);
}

char FullScreen::wait_key(std::int64_t timeout_ms) {
    const bool listen = keys_ && !keys_over_;
    pollfd p{listen ? STDIN_FILENO : -1, POLLIN, 0};
    if (::poll(&p, 1, static_cast<int>(timeout_ms)) <= 0 || !listen) return 0;
    char key = 0;
    if (::read(STDIN_FILENO, &key, 1) == 1) return key;
    keys_over_ = true;  // else it would be ready for ever
    return 0;
}

}  // namespace surefoot::cli
