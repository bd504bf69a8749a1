// Checks of option values, so that wrong use is refused before anything is opened: what was found, and what is allowed.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "config/settings.hpp"
#include "rt/base/result.hpp"

namespace surefoot::cli {

/// A finite number within the limits, these included. unit: for people; may be empty.
CLI::Validator number_within(double min, double max, const std::string& unit = "");
/// A whole number within the limits; the text is put into plain decimal digits.
CLI::Validator whole_number_within(std::uint64_t min, std::uint64_t max);
/// One of the words.
CLI::Validator one_of(std::span<const std::string_view> words);
/// A backend of this version that draws pictures.
CLI::Validator drawing_backend();

/// Options that earlier versions had.
std::span<const config::Renamed> renamed_options();
/// The error for the first of them on a refused command line; nothing if there is none.
std::optional<std::string> renamed_option(std::span<const std::string_view> arguments);

struct Size {
    std::uint32_t width = 0, height = 0;
};
/// WIDTHxHEIGHT within the settings' limits.
Result<Size> parse_size(const std::string& text);

}  // namespace surefoot::cli
