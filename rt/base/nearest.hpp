// Finds the known word nearest to a mistyped one, for error messages.
#pragma once

#include <span>
#include <string_view>

namespace surefoot {

/// Levenshtein distance: insertions, deletions and replacements.
std::size_t edits_between(std::string_view a, std::string_view b);

/// The nearest of `words`. Empty if more than half of the letters differ, or for words over 64 letters.
/// A part of a word counts as one edit: "rate" for "rate_hz".
std::string_view nearest_word(std::string_view word, std::span<const std::string_view> words);

}  // namespace surefoot
