// Small functions on text: trims blanks, splits words, reads numbers, finds the nearest of known words.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

namespace surefoot {

/// Without the spaces, tabs and line ends around it.
std::string_view trimmed(std::string_view text);

/// The parts between any of `separators`; empty ones are left out.
std::vector<std::string_view> split(std::string_view text, std::string_view separators);

namespace detail {
/// The base is for whole numbers only.
template <class Number>
std::from_chars_result read_number(std::string_view text, Number& value, [[maybe_unused]] int base) {
    if constexpr (std::is_integral_v<Number>)
        return std::from_chars(text.data(), text.data() + text.size(), value, base);
    else
        return std::from_chars(text.data(), text.data() + text.size(), value);
}
}  // namespace detail

/// A number and nothing else, in the whole text.
template <class Number = std::int64_t>
std::optional<Number> number_in(std::string_view text, int base = 10) {
    Number value{};
    const auto read = detail::read_number(text, value, base);
    if (read.ec != std::errc{} || read.ptr != text.data() + text.size()) return std::nullopt;
    return value;
}

/// The number that the text begins with, whatever follows; `otherwise` where it begins with none.
template <class Number>
Number leading_number(std::string_view text, Number otherwise, int base = 10) {
    (void)detail::read_number(text, otherwise, base);
    return otherwise;
}

/// With '?' for every byte that is not printable ASCII: names of devices and recordings are bytes of unknown sort.
std::string printable(std::string text);

/// Levenshtein distance: insertions, deletions and replacements.
std::size_t edits_between(std::string_view a, std::string_view b);

/// The nearest of `words`. Empty if more than half of the letters differ, if all differ, or for words over 64 letters.
/// A part of a word counts as one edit: "rate" for "rate_hz".
std::string_view nearest_word(std::string_view word, std::span<const std::string_view> words);

}  // namespace surefoot
