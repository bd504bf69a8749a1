// Edit distance, and the nearest of some words.
#include "rt/base/nearest.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace surefoot {

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
    std::size_t fewest = std::max<std::size_t>(2, word.size() / 2);  // further than that is another word
    for (const std::string_view known : words) {
        const bool part = word.size() >= 3 && known.find(word) != std::string_view::npos;
        const std::size_t edits = part ? 1 : edits_between(word, known);
        if (edits < fewest || (edits == fewest && nearest.empty())) {
            fewest = edits;
            nearest = known;
        }
    }
    return nearest;
}

}  // namespace surefoot
