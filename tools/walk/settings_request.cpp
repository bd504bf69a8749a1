// Makes a request from settings, and checks it.
#include "tools/walk/settings_request.hpp"

#include <fmt/format.h>

#include <utility>

#include "render/gl/backends.hpp"
#include "render/gl/kms_modes.hpp"
#include "render/select/registry.hpp"
#include "tools/walk/path_source.hpp"

namespace surefoot::walk {

namespace {

struct FileSetting {
    std::string_view key;
    std::string config::Settings::*member;
    std::string_view word = {};  ///< a value that is no file name
};

constexpr FileSetting files[] = {
    {"model", &config::Settings::model_file},
    {"path", &config::Settings::path_file, no_path},
    {"input", &config::Settings::input_file, live_input},
    {"steering", &config::Settings::steering_file},
    {"state", &config::Settings::state_dir},
};

/// An endless walk keeps no records, so it has no summary and no outputs.
Result<void> check_endless(const WalkRequest& r) {
    if (r.control || r.frames > 0 || r.seconds > 0)
        return Error{"endless walk", "An endless walk cannot have --frames, --seconds or --control", "Remove them",
                     ErrorKind::misuse};
    const bool writes = !(r.ledger_file + r.trace_file + r.report_dir + r.snap_dir + r.capture_file).empty();
    if (writes)
        return Error{"endless walk", "An endless walk keeps no frames, so none can be written",
                     "Remove the outputs, or set an end", ErrorKind::misuse};
    return {};
}

Result<void> check_real_time(const WalkRequest& r) {
    if (r.clock == rt::ClockKind::real) return {};
    if (r.control)
        return Error{"--control", "The control needs the real clock", "Remove --control or --clock virtual", ErrorKind::misuse};
    if (r.strict)
        return Error{"--strict", "This option needs the real clock", "Remove --strict or --clock virtual", ErrorKind::misuse};
    if (r.input_file == live_input || r.input_file == window_input)
        return Error{"--input " + r.input_file, "Devices and windows need the real clock",
                     "Remove --clock virtual, or give a recording (`surefoot devices record`)", ErrorKind::misuse};
    return {};
}

/// A window's keyboard needs a window; and what fills the screen too.
Result<void> check_window(const WalkRequest& r, gl::BackendKind backend) {
    if (r.input_file == window_input && !r.may_steer)
        return Error{fmt::format("--input {}", window_input), "Only `surefoot walk` and the service are steered by a window",
                     "Remove it", ErrorKind::misuse};
    if (backend == gl::BackendKind::window) return {};
    const std::string remedy = fmt::format("Add --backend {}", gl::window_backend);
    if (r.input_file == window_input)
        return Error{fmt::format("--input {}", window_input),
                     "This input is a window's keyboard and mouse, and there is no window", remedy, ErrorKind::misuse};
    if (r.fullscreen) return Error{"--fullscreen", "There is no window to fill the screen", remedy, ErrorKind::misuse};
    return {};
}

}  // namespace

WalkRequest::WalkRequest() : config::Settings(settings_schema().defaults()) {}

const config::Schema& settings_schema() {
    static const config::Schema schema({named(select::selectors()), select::usual_selector, named(select::refused_selectors())},
                                       {named(gl::backends()), gl::usual_backend});
    return schema;
}

void apply_settings(const config::Configuration& configuration, WalkRequest& request) {
    config::Settings settings = configuration.values;
    for (const auto& [key, member, word] : files) {
        const bool is_window = member == &config::Settings::input_file && configuration.values.input_file == window_input;
        settings.*member = config::file_setting(configuration, key, is_window ? window_input : word);
        if (!(request.*member).empty()) settings.*member = request.*member;
    }
    static_cast<config::Settings&>(request) = std::move(settings);
}

Result<void> check_request(const WalkRequest& r) {
    if (auto ok = check_real_time(r); !ok) return ok;
    if (r.control && (r.frames > 0 || r.seconds > 0))
        return Error{r.frames > 0 ? "--frames" : "--seconds", "This option cannot set the control's length: --control-pairs does",
                     "Remove it, or --control (or `control` in the --config file)", ErrorKind::misuse};
    if (r.control && !r.input_file.empty())
        return Error{"--control", "The control compares blocks of one walk, and nobody steers the same way twice",
                     "Remove --input", ErrorKind::misuse};
    const auto backend = gl::backend_named(r.backend);
    if (!backend) return backend.error();
    if (auto mode = gl::read_mode(r.mode); !mode) return mode.error();
    if (auto ok = check_window(r, (*backend)->kind); !ok) return ok;
    if (r.cost_noise > 0 && (r.clock == rt::ClockKind::real || (*backend)->draws()))
        return Error{"--cost-noise", "Only simulated costs can have noise, and these costs are real",
                     "Add --clock virtual --backend null", ErrorKind::misuse};
    if (const auto selector = select::selector_named(r.selector); selector)
        if (auto ok = select::can_guarantee(**selector, r.min_accuracy); !ok) return ok;
    if (!r.steering_file.empty() && r.input_file.empty() && !window_steers(r))
        return Error{"--steering", "A steering file needs a device, and this walk follows its path",
                     "Add --input devices, or --input REC with a recording of a device", ErrorKind::misuse};
    if (r.clear_stop && !is_steered_live(r))
        return Error{"--clear-stop", "This option needs devices, and none steers this walk", "Add --input devices",
                     ErrorKind::misuse};
    return r.endless ? check_endless(r) : Result<void>{};
}

bool window_steers(const WalkRequest& r) {
    const auto backend = gl::backend_named(r.backend);
    if (!backend || (*backend)->kind != gl::BackendKind::window || r.clock != rt::ClockKind::real || r.control) return false;
    if (!r.may_steer) return false;
    return r.input_file.empty() || r.input_file == window_input || r.input_file == live_input;
}

void prepare_process(const WalkRequest& first) { gl::prepare_process(first.rasterisers); }

std::string keep_process(const WalkRequest& first, WalkRequest& request) {
    const int wanted = gl::effective_rasterisers(request.rasterisers), have = gl::effective_rasterisers(first.rasterisers);
    request.rasterisers = first.rasterisers;
    if (wanted == have) return {};
    return fmt::format("rasterisers: {} take effect at the next start of the process. Until then it draws with {}.", wanted,
                       have);
}

}  // namespace surefoot::walk
