// Trimming, splitting, printable bytes, and edit distance.
#include "rt/base/text.hpp"

#include <algorithm>
#include <utility>

namespace surefoot {

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\n";
    const auto from = text.find_first_not_of(blanks);
    return from == std::string_view::npos ? std::string_view() : text.substr(from, text.find_last_not_of(blanks) - from + 1);
}

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
    std::vector<std::string_view> parts;
    while (true) {
        const auto from = text.find_first_not_of(separators);
        if (from == std::string_view::npos) return parts;
        text.remove_prefix(from);
        const auto end = std::min(text.find_first_of(separators), text.size());
        parts.push_back(text.substr(0, end));
        text.remove_prefix(end);
    }
}

std::string printable(std::string text) {
    std::replace_if(
        text.begin(), text.end(),
        [](char c) { return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f; }, '?');
    return text;
}

std::size_t edits_between(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = std::exchange(row[j + 1], std::min({replaced, row[j] + 1, row[j + 1] + 1}));
        }
    }
    return row.back();
}

std::string_view nearest_word(std::string_view word, std::span<const std::string_view> words) {
    if (word.size() > 64) return {};
    std::string_view nearest;
    std::size_t fewest = std::max<std::size_t>(2, word.size() / 3);  // further than that is another word
    for (const std::string_view known : words) {
        const bool part = word.size() >= 3 && known.find(word) != std::string_view::npos;
        const std::size_t edits = part ? 1 : edits_between(word, known);
        if (edits >= word.size()) continue;  // nothing of the word is left
        if (edits < fewest || (edits == fewest && nearest.empty())) {
            fewest = edits;
            nearest = known;
        }
    }
    return nearest;
}

}  // namespace surefoot
