// Settings of a walk and of the daemon: one schema with units, limits, defaults and help. Values come from TOML files and the
// command line, each with its origin. This room knows no other room's types: walk::settings_schema() passes names and help of
// registry entries to the schema.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "rt/base/light.hpp"
#include "rt/base/modes.hpp"
#include "rt/base/named.hpp"
#include "rt/base/result.hpp"

namespace surefoot::config {

/// The switches are what is drawn at first. The initial values are the defaults, but for names out of registries: see
/// Schema::defaults().
struct Settings : rt::Switches {
    std::string model_file;
    std::string path_file;           ///< empty: beside the model, else a generated tour
    std::string input_file;          ///< who steers; empty: the path is followed
    std::string steering_file;       ///< how it steers; empty: the default of the device's class
    std::string state_dir;           ///< empty: the program's own choice
    std::string monitor, incidents;  ///< the daemon's: where live figures are served; a folder
    rt::WalkingMode walking = rt::WalkingMode::automatic;
    double eye_height_m = 1.7, body_radius_m = 0.3, step_height_m = 0.25, max_slope_deg = 45, edge_m = 1;  ///< of the walker
    double lift_m = 0;          ///< added to the path's heights
    double open_limit_s = 600;  ///< the daemon's: for how long opening a model may take
    double rate_hz = 30;
    std::uint32_t width = 1280, height = 720;         ///< pixels
    bool fullscreen = false;                          ///< of the window, at first
    double pointer_turn_deg = 0.15;                   ///< turn for each pixel of the window's pointer
    double shift_x = 0, shift_y = 0;                  ///< off-axis projection, in half widths and half heights of the image
    double screen_width_cm = 0, eye_distance_cm = 0;  ///< the seat, see seat.hpp; 0: not given
    double acuity_arcmin = 0;   ///< angle that the eye tells apart; 0: one arcminute with a seat, else unknown
    double budget_ms = 0;       ///< 0: what the rate allows
    double accuracy = 0;        ///< rad^-1 to stop at; 0: as far as the budget goes
    double min_accuracy = 0;    ///< rad^-1 that is bought first; 0: nothing is guaranteed
    double resolution_pct = 0;  ///< of the sides at which frames are drawn; a step of 12.5; 0: chosen
    std::uint32_t samples = 1;  ///< of a pixel: 1, 2 or 4
    rt::TextureFilter filter = rt::TextureFilter::automatic;
    double cost_scale = 1;          ///< factor on predicted costs (real clock) or on charged ones (virtual clock)
    std::string selector, backend;  ///< names out of registries
    std::string screen, mode;       ///< of the kms back end: a connector, and "1920x1080@60"; empty: chosen
    int rotation_deg = 0;           ///< of that screen
    rt::LatePolicy late = rt::LatePolicy::lock;
    rt::ClockKind clock = rt::ClockKind::real;
    int workers = 0;      ///< 0: one a core beside the frame thread's
    int rasterisers = 0;  ///< 0: one a core
    bool fifo = true, strict = false, in_frame_check = true, occlusion = true, control = false;
    double hour = -1;                            ///< of the day; -1: the model's own light stays
    double hour_speed = 0;                       ///< hours of the day in a minute of the walk
    bool motion = true;                          ///< what animations move; false: all stands as at their start
    bool buy_effects = false;                    ///< frames leave out parts of the light that cost more than they show
    rt::ImageCache cache = rt::ImageCache::off;  ///< pictures of what is far stand for it, and are made while walking
    int frame_core = -1;                         ///< -1: chosen
    double rest_after_ms = 500;                  ///< 0: never
    double slice_us = 1000;
    double hysteresis = 1.25;
    double gestalt = 0;      ///< PrepareOptions::gestalt
    double reserve_pct = 3;  ///< of the budget, for forms of the last frame alone
    std::string sky = "#9eb8d1";
    int frame_priority = 80, raster_priority = 70, worker_priority = 60;
};

enum class Kind : std::uint8_t { number, integer, flag, choice, colour, file, text };

using Member = std::variant<double Settings::*, std::uint32_t Settings::*, int Settings::*, bool Settings::*,
                            std::string Settings::*, rt::LatePolicy Settings::*, rt::ClockKind Settings::*,
                            rt::TextureFilter Settings::*, rt::WalkingMode Settings::*, rt::ImageCache Settings::*>;

/// One row of the schema. min and max hold for number and integer, choices for choice (of an enum: in its order); max for
/// file and text: bytes.
struct Entry {
    std::string_view key;
    Kind kind = Kind::number;
    std::string_view unit;  ///< empty: none
    double min = 0, max = 0;
    std::span<const Named> choices;
    std::string_view help;
    Member member;
    std::span<const double> only = {};   ///< of integer: the values within the limits that are allowed; empty: all
    std::span<const Named> absent = {};  ///< names that are known and cannot be chosen, and why
};

/// A registry: names that may be chosen, passed by the room that owns them. `usual`: the default.
struct Registry {
    std::vector<Named> entries;
    std::string_view usual;
    std::vector<Named> absent = {};
};

/// A former name of a key or option. It is refused by name, with the new name or a remedy.
struct Renamed {
    std::string_view before, now;
    std::string_view remedy = {};  ///< for a name without successor
};

/// Keys that settings files of earlier versions may hold.
std::span<const Renamed> renamed_keys();
/// The error for a renamed key or option ("--rate"); nothing for other names. '-' and '_' are the same.
std::optional<Error> renamed_error(std::span<const Renamed> table, std::string place, std::string_view name);

/// Every key once, with unit, limits, choices, default and help. All texts about settings are generated from it.
class Schema {
public:
    /// Names and help, and the table of renamed keys, must outlive this.
    Schema(Registry selectors, Registry backends, std::span<const Renamed> renamed = renamed_keys());
    Schema(const Schema&) = delete;
    Schema& operator=(const Schema&) = delete;

    [[nodiscard]] std::span<const Entry> entries() const { return entries_; }
    /// Null for an unknown key. A key's '-' and '_' are the same (command lines write --rate-hz).
    [[nodiscard]] const Entry* find(std::string_view key) const;
    /// The new name of a renamed key, else the nearest known key; empty if none is near.
    [[nodiscard]] std::string_view nearest(std::string_view key) const;
    [[nodiscard]] std::span<const Renamed> renamed() const { return renamed_; }
    [[nodiscard]] const Settings& defaults() const { return defaults_; }

private:
    void insert_after(std::string_view key, const std::vector<Entry>& more);

    Registry selectors_, backends_;
    std::span<const Renamed> renamed_;
    std::vector<Entry> entries_;
    Settings defaults_;
};

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
    explicit Configuration(const Schema& of) : schema(&of), values(of.defaults()) {}
    const Schema* schema;
    Settings values;
    std::map<std::string, Origin, std::less<>> origins;  ///< only keys that are not at their default's origin
    [[nodiscard]] Origin origin(std::string_view key) const;
};

/// TOML over what is there: top-level keys, then those of [profile.NAME] if `profile` is not empty.
/// Errors name FILE:LINE and the key: syntax, unknown key (with the nearest known one), wrong type, out of limits.
Result<void> load_file(Configuration& configuration, const std::string& file, std::string_view profile = {});
Result<void> load_text(Configuration& configuration, std::string_view text, const std::string& name,
                       std::string_view profile = {});

/// A problem in a file. `error` is for people; the other members are its parts, empty if they do not apply.
struct Problem {
    Error error;
    std::string file;
    std::int64_t line = 0;
    std::string key, found, allowed, nearest;  ///< nearest: known key nearest to an unknown one
};
/// All problems of a file, by line: syntax, keys of all profiles, and rules across keys for each profile. If empty, load_file()
/// and check() succeed with any profile.
std::vector<Problem> problems_in_file(const Schema& schema, const std::string& file);
std::vector<Problem> problems_in_text(const Schema& schema, std::string_view text, const std::string& name);

/// One value as text, as on a command line.
Result<void> set_value(Configuration& configuration, std::string_view key, std::string_view text);

/// Rules across keys: workers below rasterisers below the frame thread. Call after the last change.
Result<void> check(const Configuration& configuration);

/// A key of kind file, ready to be opened: a relative name in a settings file is relative to that file's folder. Empty stays
/// empty, and so does `word` (a value that is no file name).
std::string file_setting(const Configuration& configuration, std::string_view key, std::string_view word = {});

/// The name that was chosen.
std::string_view choice_of(const Settings& settings, const Entry& entry);
/// A key's value as TOML would write it.
std::string value_text(const Settings& settings, const Entry& entry);
/// All keys with unit, limits, default and help: a TOML file that changes nothing.
std::string commented_defaults(const Schema& schema);
/// One line a key: value, unit, origin, and what is allowed.
std::string explain(const Configuration& configuration);

/// "#rrggbb" to 0..1 each, as sRGB bytes over 255; the text must have passed the schema.
std::array<float, 3> colour_of(std::string_view text);

}  // namespace surefoot::config
