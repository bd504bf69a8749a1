// Text as the kernel writes it: words, numbers, masks.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace surefoot::doctor {

constexpr std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\n";
    const auto from = text.find_first_not_of(blanks);
    return from == std::string_view::npos ? std::string_view() : text.substr(from, text.find_last_not_of(blanks) - from + 1);
}

/// The parts between any of `separators`; empty ones are left out.
inline std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
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

/// A whole decimal number and nothing else.
inline std::optional<std::int64_t> number_in(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// Whether a bit is set in "ff,ffffffff" (hexadecimal groups of 32 bits, the lowest last); nothing where it is no such mask.
inline std::optional<bool> in_hex_mask(std::string_view mask, int bit) {
    const auto groups = split(mask, ",");
    const auto index = static_cast<std::size_t>(bit / 32);
    if (groups.empty()) return std::nullopt;
    if (index >= groups.size()) return false;
    const std::string_view group = groups[groups.size() - 1 - index];
    std::uint32_t bits = 0;
    const auto [end, error] = std::from_chars(group.data(), group.data() + group.size(), bits, 16);
    if (error != std::errc{} || end != group.data() + group.size()) return std::nullopt;
    return (bits >> static_cast<unsigned>(bit % 32) & 1U) != 0;
}

/// The same mask without one bit, in the same format. Text that is not a mask comes back unchanged.
inline std::string without_bit(std::string_view mask, int bit) {
    std::string text;
    const auto groups = split(mask, ",");
    for (std::size_t i = 0; i < groups.size(); ++i) {
        std::uint32_t bits = 0;
        const auto [end, error] = std::from_chars(groups[i].data(), groups[i].data() + groups[i].size(), bits, 16);
        if (error != std::errc{} || end != groups[i].data() + groups[i].size()) return std::string(mask);
        if (groups.size() - 1 - i == static_cast<std::size_t>(bit / 32)) bits &= ~(1U << static_cast<unsigned>(bit % 32));
        text += (i == 0 ? "" : ",") + fmt::format(fmt::runtime(i == 0 ? "{:x}" : "{:08x}"), bits);
    }
    return text;
}

/// The word in [brackets] of "always [madvise] never", as the kernel marks the one in force; "(full)" likewise.
inline std::string_view marked_word(std::string_view text, char open, char close) {
    const auto from = text.find(open);
    const auto end = text.find(close, from == std::string_view::npos ? 0 : from);
    if (from == std::string_view::npos || end == std::string_view::npos) return {};
    return text.substr(from + 1, end - from - 1);
}

}  // namespace surefoot::doctor
