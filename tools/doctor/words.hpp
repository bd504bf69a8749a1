// Reads text in the kernel's formats: masks, and the chosen word of several.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/text.hpp"

namespace surefoot::doctor {

/// Whether a bit is set in "ff,ffffffff" (hexadecimal groups of 32 bits, the lowest last); nothing where it is no such mask.
inline std::optional<bool> in_hex_mask(std::string_view mask, int bit) {
    const auto groups = split(mask, ",");
    const auto index = static_cast<std::size_t>(bit / 32);
    if (groups.empty()) return std::nullopt;
    if (index >= groups.size()) return false;
    const std::string_view group = groups[groups.size() - 1 - index];
    const auto bits = number_in<std::uint32_t>(group, 16);
    if (!bits) return std::nullopt;
    return (*bits >> static_cast<unsigned>(bit % 32) & 1U) != 0;
}

/// The same mask without one bit, in the same format. Text that is not a mask comes back unchanged.
inline std::string without_bit(std::string_view mask, int bit) {
    std::string text;
    const auto groups = split(mask, ",");
    for (std::size_t i = 0; i < groups.size(); ++i) {
        auto bits = number_in<std::uint32_t>(groups[i], 16);
        if (!bits) return std::string(mask);
        if (groups.size() - 1 - i == static_cast<std::size_t>(bit / 32)) *bits &= ~(1U << static_cast<unsigned>(bit % 32));
        text += (i == 0 ? "" : ",") + fmt::format(fmt::runtime(i == 0 ? "{:x}" : "{:08x}"), *bits);
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
