// From settings to a request.
#include "tools/walk/settings_request.hpp"

namespace surefoot::walk {

namespace {

void put_file(const config::Configuration& c, std::string_view key, std::string_view word, std::string& into) {
    if (into.empty()) into = config::file_setting(c, key, word);
}

void put_files(const config::Configuration& c, WalkRequest& r) {
    put_file(c, "model", {}, r.model_file);
    put_file(c, "path", {}, r.path_file);
    put_file(c, "input", live_input, r.input_file);
    put_file(c, "steering", {}, r.steering_file);
    put_file(c, "state", {}, r.state_dir);
}

}  // namespace

void apply_settings(const config::Configuration& configuration, WalkRequest& r) {
    const config::Settings& s = configuration.values;
    put_files(configuration, r);
    r.lift_m = s.lift_m;
    r.rate_hz = s.rate_hz;
    r.width = static_cast<std::uint32_t>(s.width);
    r.height = static_cast<std::uint32_t>(s.height);
    r.shift_x = s.shift_x;
    r.shift_y = s.shift_y;
    r.budget_ms = s.budget_ms;
    r.accuracy = s.accuracy;
    r.cost_scale = s.cost_scale;
    r.selector = s.selector;
    r.late = s.late;
    r.backend = s.backend;
    r.clock = s.clock;
    r.workers = static_cast<int>(s.workers);
    r.rasterisers = static_cast<int>(s.rasterisers);
    r.fifo = s.fifo;
    r.strict = s.strict;
    r.control = s.control;
    r.in_frame_check = s.in_frame_check;
    r.occlusion = s.occlusion;
    r.frame_core = static_cast<int>(s.frame_core);
    r.frame_priority = static_cast<int>(s.frame_priority);
    r.raster_priority = static_cast<int>(s.raster_priority);
    r.worker_priority = static_cast<int>(s.worker_priority);
    r.slice_us = s.slice_us;
    r.hysteresis = s.hysteresis;
    r.sky = config::colour_of(s.sky);
}

}  // namespace surefoot::walk
