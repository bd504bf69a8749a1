// Wrapping, colouring, aligning.
#include "tools/report/terminal.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace surefoot::report {

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

bool continues_a_code_point(char c) { return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U; }

/// The last places of a word longer than a line: of a path, its end says more than its middle.
std::string end_of(const std::string& text, std::size_t max_width) {
    std::size_t at = text.size();
    for (std::size_t kept = 0; at > 0 && kept + 1 < max_width; --at) kept += continues_a_code_point(text[at - 1]) ? 0 : 1;
    return "…" + text.substr(at);
}

void append_cell(std::string& line, const TextColumn& column, std::string_view text, bool first) {
    if (!first) line.append(column.gap, ' ');
    line += column.width < 0 ? fmt::format("{:>{}}", text, -column.width) : fmt::format("{:<{}}", text, column.width);
}

}  // namespace

TerminalStyle terminal_style(bool colour, std::size_t width) {
    TerminalStyle style;
    style.colour = colour;
    style.unicode = speaks_utf8();
    style.width = width;
    winsize size{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0) {
        style.width = size.ws_col;
        style.height = std::max<std::size_t>(size.ws_row, 3);
    }
    return style;
}

bool colour_wanted() {
    return isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;
}  // NOLINT(concurrency-mt-unsafe)

std::string inked(const TerminalStyle& style, Ink ink, std::string_view text) {
    constexpr std::array<std::string_view, 10> codes = {"", "1", "2", "32", "33", "31", "36", "1;32", "1;33", "1;31"};
    if (!style.colour || ink == Ink::plain) return std::string(text);
    return fmt::format("\033[{}m{}\033[0m", codes[static_cast<std::size_t>(ink)], text);
}

Ink strong(Ink ink) {
    switch (ink) {
        case Ink::good:
            return Ink::strong_good;
        case Ink::warn:
            return Ink::strong_warn;
        case Ink::bad:
            return Ink::strong_bad;
        default:
            return ink;
    }
}

std::size_t places(std::string_view line) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '\033')
            i = std::min(line.find('m', i), line.size() - 1);
        else if (!continues_a_code_point(line[i]))
            ++count;
    }
    return count;
}

std::string cut_to(std::string_view line, std::size_t width) {
    std::string out;
    std::size_t used = 0;
    bool styled = false;
    for (std::size_t i = 0; i < line.size();) {
        if (line[i] == '\033') {
            const std::size_t end = std::min(line.find('m', i), line.size() - 1);
            out += line.substr(i, end - i + 1);
            styled = line.substr(i, end - i + 1) != "\033[0m";
            i = end + 1;
            continue;
        }
        std::size_t next = i + 1;
        while (next < line.size() && continues_a_code_point(line[next])) ++next;
        if (used == width) break;
        out += line.substr(i, next - i);
        ++used;
        i = next;
    }
    if (styled) out += "\033[0m";
    return out;
}

std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
    std::vector<std::string> lines(1);
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find(' ', at), text.size());
        const auto word = text.substr(at, end - at);
        at = end + 1;
        if (!lines.back().empty() && places(lines.back()) + 1 + places(word) > width) lines.emplace_back();
        if (!lines.back().empty()) lines.back() += ' ';
        lines.back() += word;
    }
    return lines;
}

std::string share_bar(const TerminalStyle& style, double share, std::size_t width) {
    const double cells = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) * static_cast<double>(width) : 0;
    const auto whole = static_cast<std::size_t>(std::lround(cells));
    std::string bar;
    for (std::size_t i = 0; i < width; ++i) bar += style.unicode ? (i < whole ? "█" : "░") : (i < whole ? "#" : "-");
    return bar;
}

std::string deflection_bar(double at, std::size_t width) {
    std::string text(width, '-');
    const std::size_t middle = width / 2;
    const auto cell = std::min(width - 1, static_cast<std::size_t>(at * static_cast<double>(width)));
    for (std::size_t i = std::min(middle, cell); i <= std::max(middle, cell); ++i) text[i] = '#';
    text[middle] = '|';
    if (cell != middle) text[cell] = '#';
    return text;
}

std::string progress_line(std::string_view stage, double done, std::string_view left) {
    const auto filled = static_cast<std::size_t>(std::clamp(done, 0.0, 1.0) * 24.0);
    return fmt::format("{:<22} [{:<24}] {:3.0f} %  {}", stage, std::string(filled, '#'), 100.0 * done, left);
}

std::string Columns::heading() const {
    std::string line;
    for (const TextColumn& column : columns_) append_cell(line, column, column.heading, &column == columns_.data());
    return line;
}

std::string Columns::row(std::initializer_list<std::string> cells) const {
    std::string line;
    auto column = columns_.begin();
    for (const std::string& cell : cells) {
        if (column == columns_.end()) break;
        append_cell(line, *column, cell, column == columns_.begin());
        ++column;
    }
    return line;
}

void LabelledText::row(std::string_view label, std::string_view words, Ink ink) {
    constexpr std::size_t width = max_columns - label_columns;
    for (const std::string& line : wrapped(words, width)) {
        raw(inked(style_, Ink::dim, fmt::format("{:<{}}", label, label_columns)) +
            inked(style_, ink, places(line) > width ? end_of(line, width) : line));
        label = {};
    }
}

}  // namespace surefoot::report
