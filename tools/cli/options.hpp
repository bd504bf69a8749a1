// Checks of option values, so that wrong use is refused before anything is opened: what was found, and what is allowed.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "config/settings.hpp"
#include "render/select/benefit_model.hpp"
#include "rt/base/result.hpp"

namespace surefoot::cli {

/// The error for a value that is not allowed, in one wording for all options. given: the option and the value, or the value
/// alone. why: why not, as the end of a sentence; may be empty. allowed: what is.
Error refused_value(const std::string& given, std::string_view why, const std::string& allowed);
// Checks of CLI11 return that error's text with the value alone; config::wrong_use() puts the option before it.

/// A finite number within the limits, these included. unit: for people; may be empty.
CLI::Validator number_within(double min, double max, const std::string& unit = "");
/// A whole number within the limits; the text is put into plain decimal digits.
CLI::Validator whole_number_within(std::uint64_t min, std::uint64_t max);
/// One of the words.
CLI::Validator one_of(std::span<const std::string_view> words);
/// A backend of this version that draws pictures.
CLI::Validator drawing_backend();
/// --benefit: the benefit by which the 1994 selectors go.
void add_benefit(CLI::App* command, select::BenefitModel& model);
/// --time SECONDS, of the model's animations.
CLI::Option* add_time(CLI::App* command, double& time_s);
/// An error where a benefit is chosen, and none of the selectors goes by it.
Result<void> check_benefit(select::BenefitModel model, std::span<const std::string> selectors);
/// Any text but the empty one: an empty variable of a script is no wish for no output.
CLI::Validator names_something();

/// Options that earlier versions had.
std::span<const config::Renamed> renamed_options();

struct Size {
    std::uint32_t width = 0, height = 0;
};
/// WIDTHxHEIGHT within the settings' limits.
Result<Size> parse_size(const std::string& text);

}  // namespace surefoot::cli
