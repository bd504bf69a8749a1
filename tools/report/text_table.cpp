// Wrapping and colouring.
#include "tools/report/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace surefoot::report {

namespace {

/// Columns on screen: code points (no wide characters are used here).
std::size_t width_of(std::string_view text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
}

/// The last columns of a word longer than a line: of a path, its end says more than its middle.
std::string end_of(const std::string& text, std::size_t most) {
    std::size_t at = text.size();
    for (std::size_t kept = 0; at > 0 && kept + 1 < most; --at)
        kept += (static_cast<unsigned char>(text[at - 1]) & 0xc0U) != 0x80U ? 1 : 0;
    return "…" + text.substr(at);
}

}  // namespace

void TextTable::row(std::string_view label, std::string_view words, std::string_view code) {
    std::string line;
    std::string_view shown = label;
    std::size_t at = 0;
    while (at < words.size()) {
        auto end = words.find(' ', at);
        if (end == std::string_view::npos) end = words.size();
        const auto word = words.substr(at, end - at);
        at = end + 1;
        if (!line.empty() && label_columns + width_of(line) + 1 + width_of(word) > max_columns) {
            put(shown, line, code);
            shown = {};
            line.clear();
        }
        if (!line.empty()) line += ' ';
        line += word;
    }
    put(shown, line, code);
}

std::string TextTable::coloured(std::string_view text, std::string_view code) const {
    if (!colour_ || code.empty()) return std::string(text);
    return fmt::format("\x1b[{}m{}\x1b[0m", code, text);
}

void TextTable::put(std::string_view label, std::string line, std::string_view code) {
    if (label_columns + width_of(line) > max_columns) line = end_of(line, max_columns - label_columns);
    const std::string padded = fmt::format("{:<{}}", label, label_columns);
    raw(coloured(padded, "2") + coloured(line, code));
}

}  // namespace surefoot::report
