// Inside the config room: one value put into the settings within the schema's limits. Used by the TOML reader.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "config/settings.hpp"

namespace surefoot::config {

using Value = std::variant<double, bool, std::string>;

/// The allowed values, for people: "a number from 1 to 1000 (Hz)".
std::string allowed(const Entry& entry);
/// A value as TOML would write it.
std::string text_of(const Value& value);
/// Sets the value. If it is refused, changes nothing and returns an error without a place.
std::optional<Error> assign(Settings& settings, const Entry& entry, const Value& value);
/// Why a known name cannot be chosen; empty for other names.
std::string_view absent_because(const Entry& entry, std::string_view name);
Error unknown_key(const Schema& schema, std::string place, std::string_view key);
/// Lower case, with '_' for '-'.
std::string normalised(std::string_view key);

}  // namespace surefoot::config
