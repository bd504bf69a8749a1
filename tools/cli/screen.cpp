// Escape sequences that every terminal of the last decades knows, and termios.
#include "tools/cli/screen.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>

#include "tools/report/terminal.hpp"

namespace surefoot::cli {

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

Redraw::Redraw() {
    (void)std::fputs("\033[?25l", stdout);
    std::fflush(stdout);
}

Redraw::~Redraw() {
    (void)std::fputs("\033[?25h", stdout);
    std::fflush(stdout);
}

void Redraw::draw(std::span<const std::string> lines) {
    const report::TerminalStyle style = report::terminal_style(false);
    const std::size_t room = style.height - 1;
    std::string out;
    if (drawn_ > 0) out += fmt::format("\033[{}F", drawn_);
    std::size_t n = 0;
    for (const std::string& line : lines) {
        if (n + 1 == room && lines.size() > room) {
            out += fmt::format("\033[K... and {} more lines: make the window higher\n", lines.size() - n);
            ++n;
            break;
        }
        out += "\033[K" + report::cut_to(line, style.width) + "\n";
        ++n;
    }
    out += "\033[J";
    drawn_ = n;
    (void)std::fputs(out.c_str(), stdout);
    std::fflush(stdout);
}

}  // namespace surefoot::cli
