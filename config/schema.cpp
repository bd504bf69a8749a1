// The schema: every key once, with its unit, limits and help.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <utility>

#include "config/settings.hpp"
#include "config/values.hpp"
#include "rt/base/text.hpp"

namespace surefoot::config {

namespace {

using S = Settings;
using std::string_view;

constexpr Entry number(string_view key, string_view unit, double min, double max, string_view help, double S::*member) {
    return {key, Kind::number, unit, min, max, {}, help, member};
}
template <class Whole>
constexpr Entry integer(string_view key, string_view unit, double min, double max, string_view help, Whole S::*member) {
    return {key, Kind::integer, unit, min, max, {}, help, member};
}
constexpr std::array<double, 3> sample_counts{1, 2, 4};

constexpr Entry samples(string_view help, std::uint32_t S::*member) {
    Entry entry = integer("samples", "a pixel", sample_counts.front(), sample_counts.back(), help, member);
    entry.only = sample_counts;
    return entry;
}
constexpr Entry flag(string_view key, string_view help, bool S::*member) { return {key, Kind::flag, {}, 0, 1, {}, help, member}; }
template <class Chosen>
constexpr Entry choice(string_view key, std::span<const Named> of, string_view help, Chosen S::*member) {
    return {key, Kind::choice, {}, 0, 0, of, help, member};
}

constexpr double longest_name = 4095;  // bytes, PATH_MAX
constexpr std::array<double, 4> rotations{0, 90, 180, 270};

constexpr Entry file_name(string_view key, string_view help, std::string S::*member) {
    return {key, Kind::file, {}, 0, longest_name, {}, help, member};
}

constexpr Entry text(string_view key, string_view help, std::string S::*member) {
    return {key, Kind::text, {}, 0, 100, {}, help, member};
}

/// The screen of the kms back end.
std::vector<Entry> screen_entries() {
    Entry rotation =
        integer("rotation", "degrees", rotations.front(), rotations.back(),
                "By how much pictures are turned there, anticlockwise; a card may refuse 90 and 270.", &S::rotation_deg);
    rotation.only = rotations;
    return {
        text("screen", "Screen without a window system, by its connector: \"HDMI-A-1\"; \"\": the first that is connected.",
             &S::screen),
        text("mode", "Mode of that screen: \"1920x1080@60\"; \"\": the one that the screen prefers.", &S::mode),
        rotation,
    };
}

/// How a steered visitor moves.
std::vector<Entry> walker_entries() {
    return {
        choice("walking", rt::walking_modes, "Whether a steered visitor walks on floors and around walls, or flies through them.",
               &S::walking),
        number("eye_height_m", "m", 0.1, 100, "Walker: height of the eye above the floor.", &S::eye_height_m),
        number("body_radius_m", "m", 0.02, 10, "Walker: half the width of the body; no more than fits the height.",
               &S::body_radius_m),
        number("step_height_m", "m", 0, 10, "Walker: highest step that is climbed; at most 0.4 of the height.",
               &S::step_height_m),
        number("max_slope_deg", "degrees", 0, 89, "Walker: steepest floor that is climbed.", &S::max_slope_deg),
        number("edge_m", "m", 0, 1e6,
               "Walker: a drop of this much or more stops the visitor; less is fallen down, a step always.", &S::edge_m),
    };
}

/// What the picture shows of the view, and the window.
std::vector<Entry> picture_entries() {
    return {
        flag("fullscreen", "The window fills the screen at first; the key F11 changes that.", &S::fullscreen),
        number("pointer_turn_deg", "degrees", 0.01, 10, "Window: turn for each pixel that the pointer moves.",
               &S::pointer_turn_deg),
        number("shift_x", "half widths", -8, 8,
               "Off-axis projection: offset of the image centre to the right of the view direction.", &S::shift_x),
        number("shift_y", "half heights", -8, 8, "Off-axis projection: offset of the image centre upwards.", &S::shift_y),
    };
}

/// Where the eye is before the screen.
std::vector<Entry> seat_entries() {
    return {
        number("screen_width_cm", "cm", 0, 100000,
               "Width of one screen. With eye_distance_cm it sets the field of view of every pose; 0: the path does.",
               &S::screen_width_cm),
        number("eye_distance_cm", "cm", 0, 100000,
               "Distance of the eye from the plane of the screen. Screens side by side share it, each with its own shift_x.",
               &S::eye_distance_cm),
        number(
            "acuity_arcmin", "arcminutes", 0, 600,
            "Angle that the eye can tell apart. Finer errors are not bought. 0: one arcminute with a seat, else pixels decide.",
            &S::acuity_arcmin),
    };
}

/// What is drawn of the light at first, the hour of the day, and what moves by itself.
std::vector<Entry> light_entries() {
    return {
        flag("sunlight", "Light of sun and sky; false: colours as they are. A visitor may switch it (action sunlight, key L).",
             &S::sunlight),
        flag("shadows", "Places that something hides from the sun are darker. A visitor may switch it (action shadows, key J).",
             &S::shadows),
        flag("lamps",
             "By night, with an hour: light of lamps, at most 4096, and of what glows. A visitor may switch it (action lamps, "
             "key K).",
             &S::lamps),
        flag("fog", "What is far takes the colour of the sky. A visitor may switch it (action fog, key H).", &S::fog),
        number("hour", "h", -1, 24, "Hour of the day that the light is of, by the sun; -1: the model's own light.", &S::hour),
        number("hour_speed", "h/min", -600, 600, "Hours of the day that pass in a minute of the walk; 0: none. It needs an hour.",
               &S::hour_speed),
        flag("motion", "What animations move does so; false: all stands as at their start.", &S::motion),
        flag("buy_effects",
             "Where time is short, a frame leaves out sunlight, shadows, lamps or fog, if forms show more for it; false: all are "
             "drawn.",
             &S::buy_effects),
        choice("cache", rt::image_caches,
               "The image cache: what is far is drawn as pictures that are made while walking, each right to a pixel.",
               &S::cache),
    };
}

std::vector<Entry> make_entries(const Registry& selectors, const Registry& backends) {
    return {
        file_name("model", "The .walk model, relative to this file's folder; \"\": none, so the command line must name one.",
                  &S::model_file),
        file_name("path",
                  "CSV file of poses over time; \"\": MODEL.path.csv, else the model's own; \"none\": around its box. An input "
                  "starts there.",
                  &S::path_file),
        number("lift_m", "m", -1e7, 1e7, "Height added to every pose of the path; 1.5 for recorded drives.", &S::lift_m),
        file_name("input",
                  "Source of steering: \"\" follows the path; \"devices\": connected devices; \"window\": its keyboard; else a "
                  "recording.",
                  &S::input_file),
        file_name("steering", "File of input mappings; \"\": the default mapping of the device's class.", &S::steering_file),
        file_name("state",
                  "Folder of the cost table and of a latched emergency stop; \"\": $STATE_DIRECTORY, as systemd sets it.",
                  &S::state_dir),
        file_name("monitor",
                  "Address for live figures: unix:/PATH, 127.0.0.1:PORT or \"none\"; \"\": surefoot.sock in $RUNTIME_DIRECTORY.",
                  &S::monitor),
        file_name("incidents", "Folder to which surefootd writes bursts of misses; \"\": none.", &S::incidents),
        number("open_limit_s", "s", 1, 86400, "Maximum time for opening a model (surefootd).", &S::open_limit_s),
        number("rate_hz", "Hz", 1, 1000, "Frame rate of the walk.", &S::rate_hz),
        integer("width", "px", 16, 16384, "Width of the picture.", &S::width),
        integer("height", "px", 16, 16384, "Height of the picture.", &S::height),
        number("budget_ms", "ms", 0, 1000, "Time that a frame may spend; 0: what the rate allows.", &S::budget_ms),
        number("accuracy", "1/rad", 0, 1e6, "Stop refining at this accuracy; 0: refine as far as the budget goes.", &S::accuracy),
        number("min_accuracy", "1/rad", 0, 5e4, "Accuracy that every frame buys first; 0: none is guaranteed.", &S::min_accuracy),
        number(
            "resolution", "%", 0, 100,
            "Share of the picture's width and height that is drawn, then enlarged, in steps of 12.5 from 50; 0: what shows most.",
            &S::resolution_pct),
        samples("Samples of a pixel. More of them smooth edges, those of alpha-tested textures too, and take longer.",
                &S::samples),
        choice("filter", rt::texture_filters, "How textures are read where they are drawn smaller than they are.", &S::filter),
        number("rest_after_ms", "ms", 0, 60000,
               "Time that the eye must stand still before full detail is drawn bit by bit, then smoothed; 0: never.",
               &S::rest_after_ms),
        number("cost_scale", "", 0.01, 100, "Factor on predicted costs (real clock), or on charged costs (virtual clock).",
               &S::cost_scale),
        choice("selector", selectors.entries, "How the cut is chosen.", &S::selector),
        choice("late", rt::late_policies, "What happens to a late frame.", &S::late),
        choice("backend", backends.entries, "Where pictures are drawn.", &S::backend),
        choice("clock", rt::clock_kinds, "Clock that counts the frames.", &S::clock),
        integer("workers", "threads", 0, 256, "Threads that prepare frames; 0: chosen for the machine.", &S::workers),
        integer("rasterisers", "threads", 0, 256, "Threads of a software renderer; 0: chosen for the machine.", &S::rasterisers),
        flag("fifo", "Real-time scheduling (SCHED_FIFO) for the frame thread, rasterisers and workers.", &S::fifo),
        flag("strict",
             "Do not start if real time lacks anything: SCHED_FIFO, locked memory, an isolated core, thread placement or a cost "
             "table.",
             &S::strict),
        flag("in_frame_check", "Between slices, draw stand-ins when the rest no longer fits the frame.", &S::in_frame_check),
        flag("occlusion", "Leave out objects that are hidden from every possible pose of a frame.", &S::occlusion),
        flag("control", "Alternate the walk with a bare loop of the same cost, as a control for misses.", &S::control),
        integer("frame_core", "", -1, 4095, "Core of the frame thread; -1: chosen for the machine.", &S::frame_core),
        number("slice_us", "us", 50, 100000, "Predicted length of the shortest slices of submission.", &S::slice_us),
        number("hysteresis", "", 1, 10, "Factor by which a form must be better to replace the one on screen.", &S::hysteresis),
        number("reserve", "%", 0, 50,
               "Share of the budget that new forms leave free, so that others need not change. No effect at hysteresis 1.",
               &S::reserve_pct),
        number("gestalt", "", 0, 1, "How much of its loss a coarse group is forgiven if its members are alike; 0: none, 1: all.",
               &S::gestalt),
        {"sky", Kind::colour, {}, 0, 0, {}, "Background, as \"#rrggbb\".", &S::sky},
        integer("frame_priority", "FIFO", 1, 98, "Priority of the frame thread.", &S::frame_priority),
        integer("raster_priority", "FIFO", 1, 98, "Priority of the rasterisers; below the frame thread's.", &S::raster_priority),
        integer("worker_priority", "FIFO", 1, 98, "Priority of the workers; below the rasterisers'.", &S::worker_priority),
    };
}

}  // namespace

std::string normalised(string_view key) {
    std::string text(key);
    for (char& c : text) c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

std::span<const Renamed> renamed_keys() { return {}; }  // no key has had another name yet: tests/known_names.txt

std::optional<Error> renamed_error(std::span<const Renamed> table, std::string place, string_view name) {
    const std::string wanted = normalised(name);
    for (const Renamed& one : table) {
        if (normalised(one.before) != wanted) continue;
        if (one.now.empty())
            return Error{std::move(place), fmt::format("The name '{}' was removed", name), std::string(one.remedy),
                         ErrorKind::misuse};
        return Error{std::move(place), fmt::format("The name '{}' is now '{}'", name, one.now),
                     fmt::format("Write {} and keep the value", one.now), ErrorKind::misuse};
    }
    return std::nullopt;
}

Schema::Schema(Registry selectors, Registry backends, std::span<const Renamed> renamed)
    : selectors_(std::move(selectors)),
      backends_(std::move(backends)),
      renamed_(renamed),
      entries_(make_entries(selectors_, backends_)) {
    for (Entry& entry : entries_)
        if (entry.key == "selector")
            entry.absent = selectors_.absent;
        else if (entry.key == "backend")
            entry.absent = backends_.absent;
    insert_after("in_frame_check", light_entries());
    insert_after("steering", walker_entries());
    insert_after("height", picture_entries());
    insert_after("shift_y", seat_entries());
    insert_after("backend", screen_entries());
    defaults_.selector = selectors_.usual;
    defaults_.backend = backends_.usual;
}

void Schema::insert_after(string_view key, const std::vector<Entry>& more) {
    const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.key == key; });
    entries_.insert(at + 1, more.begin(), more.end());
}

const Entry* Schema::find(string_view key) const {
    const std::string wanted = normalised(key);
    const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.key == wanted; });
    return found == entries_.end() ? nullptr : &*found;
}

string_view Schema::nearest(string_view key) const {
    const std::string wanted = normalised(key);
    for (const Renamed& one : renamed_)
        if (normalised(one.before) == wanted) return one.now;
    std::vector<string_view> keys;
    for (const Entry& entry : entries_) keys.push_back(entry.key);
    return nearest_word(wanted, keys);
}

}  // namespace surefoot::config
