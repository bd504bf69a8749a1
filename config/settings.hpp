// What a user may set for a walk and for the daemon: one schema table with units, limits, defaults and help; values from
// TOML files and the command line; and where each value came from. Knows no room's types: tools/walk maps it to theirs.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::config {

/// The initial values are the defaults.
struct Settings {
    std::string model, path, input, steering, state;  ///< files; see file_setting() for what relative names stand for
    std::string monitor, incidents;                   ///< the daemon's: where live figures are served; a folder
    double lift_m = 0;                                ///< added to the path's heights
    double open_limit_s = 600;                        ///< the daemon's: for how long opening a model may take
    double rate_hz = 30;
    std::int64_t width = 1280, height = 720;  ///< pixels
    double shift_x = 0, shift_y = 0;          ///< off axis, in halves of the picture
    double budget_ms = 0;                     ///< 0: what the rate allows
    double accuracy = 0;                      ///< rad^-1 to stop at; 0: as far as the budget goes
    double cost_scale = 1;                    ///< on the machine's cost table
    std::string selector = "two-stage";
    std::string late = "lock";
    std::string backend = "egl";
    std::string clock = "real";
    std::int64_t workers = 0;      ///< 0: one a core beside the frame thread's
    std::int64_t rasterisers = 0;  ///< 0: one a core
    bool fifo = true, strict = false, in_frame_check = true, occlusion = true, control = false;
    std::int64_t frame_core = -1;  ///< -1: chosen
    double slice_us = 1000;
    double hysteresis = 1.25;
    std::string sky = "#9eb8d1";
    std::int64_t frame_priority = 80, raster_priority = 70, worker_priority = 60;
};

enum class Kind : std::uint8_t { number, integer, flag, choice, colour, file };

using Member = std::variant<double Settings::*, std::int64_t Settings::*, bool Settings::*, std::string Settings::*>;

/// One row of the schema. min and max hold for number and integer, choices for choice; max for file: bytes.
struct Entry {
    std::string_view key;
    Kind kind = Kind::number;
    std::string_view unit;  ///< empty: none
    double min = 0, max = 0;
    std::span<const std::string_view> choices;
    std::string_view help;
    Member member;
};

std::span<const Entry> schema();
/// Null for an unknown key. A key's '-' and '_' are the same (command lines write --rate-hz).
const Entry* find_entry(std::string_view key);
/// The known key that an unknown one was probably meant to be; empty where none is near.
std::string_view nearest_key(std::string_view key);

/// Where a value came from: "default", "FILE:LINE", "FILE:LINE (profile NAME)", or "command line".
struct Origin {
    std::string file;
    std::int64_t line = 0;
    bool command_line = false;
    std::string profile;
    [[nodiscard]] std::string text() const;
};

/// Values with their origins. Every change is checked against the schema; a refused change leaves all as it was.
struct Configuration {
    Settings values;
    std::map<std::string, Origin, std::less<>> origins;  ///< only keys that are not at their default's origin
    [[nodiscard]] Origin origin(std::string_view key) const;
};

/// TOML over what is there: top-level keys, then those of [profile.NAME] if `profile` is not empty.
/// Errors name FILE:LINE and the key: syntax, unknown key (with the nearest known one), wrong type, out of limits.
Result<void> load_file(Configuration& configuration, const std::string& file, std::string_view profile = {});
Result<void> load_text(Configuration& configuration, std::string_view text, const std::string& name,
                       std::string_view profile = {});

/// One thing that is wrong in a file. `error` says it in words; the rest is the same in parts, empty where it does not apply.
struct Problem {
    Error error;
    std::string file;
    std::int64_t line = 0;
    std::string key, found, allowed, nearest;  ///< nearest: the known key that an unknown one was probably meant to be
};
/// Everything that is wrong in a file, by line: syntax, every key of every profile, and the rules across keys, with each profile
/// in force. Empty: load_file() and check() succeed, whatever the profile.
std::vector<Problem> problems_in_file(const std::string& file);
std::vector<Problem> problems_in_text(std::string_view text, const std::string& name);

/// One value as text, as on a command line.
Result<void> set_value(Configuration& configuration, std::string_view key, std::string_view text);

/// Rules across keys: workers below rasterisers below the frame thread. Call after the last change.
Result<void> check(const Configuration& configuration);

/// A key of kind file, ready to be opened: a relative name in a settings file is relative to that file's folder. Empty stays
/// empty, and so does `word` (a value that is no file name).
std::string file_setting(const Configuration& configuration, std::string_view key, std::string_view word = {});

/// A key's value as TOML would write it.
std::string value_text(const Settings& settings, const Entry& entry);
/// All keys with unit, limits, default and help: a TOML file that changes nothing.
std::string commented_defaults();
/// One line a key: value, unit, origin, and what is allowed.
std::string explain(const Configuration& configuration);

/// "#rrggbb" to 0..1 each, as sRGB bytes over 255; the text must have passed the schema.
std::array<float, 3> colour_of(std::string_view text);

}  // namespace surefoot::config
