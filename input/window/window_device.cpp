// The window's controls, their usual mapping, and the device.
#include "input/window/window_device.hpp"

#include "input/window/window_keys.hpp"

namespace surefoot::input {

namespace {

constexpr std::uint16_t desktop_page = 0x01, keyboard_page = 0x07, usage_x = 0x30, usage_y = 0x31;
constexpr const char* window_collection = "Window";
constexpr double run_scale = 0.66;  // of the way to the fastest: 2.5 times the pace of a walk

struct UsualKey {
    const char* control;
    Action action;
    double scale;
};

constexpr UsualKey usual_keys[] = {
    {"key-w", Action::forward, 1},
    {"key-up", Action::forward, 1},
    {"key-s", Action::forward, -1},
    {"key-down", Action::forward, -1},
    {"key-d", Action::side, 1},
    {"key-right", Action::side, 1},
    {"key-a", Action::side, -1},
    {"key-left", Action::side, -1},
    {"key-e", Action::up, 1},
    {"key-page-up", Action::up, 1},
    {"key-q", Action::up, -1},
    {"key-page-down", Action::up, -1},
    {"key-left-shift", Action::speed, run_scale},
    {"key-right-shift", Action::speed, run_scale},
    {"key-z", Action::zoom, 1},
    {"key-x", Action::zoom, -1},
    {"key-n", Action::next_viewpoint, 1},
    {"key-home", Action::reset, 1},
    {"key-t", Action::tour, 1},
    {"key-p", Action::pause, 1},
    {"key-l", Action::sunlight, 1},
    {"key-j", Action::shadows, 1},
    {"key-k", Action::lamps, 1},
    {"key-h", Action::fog, 1},
};

DeviceMapping usual_mapping(double deg_per_px) {
    DeviceMapping usual;
    usual.name = "default: keyboard and mouse";
    usual.reporting = Reporting::on_change;
    for (const UsualKey& key : usual_keys) {
        ButtonMapping button;
        button.control = {key.control, 0, 0, ""};
        button.action = key.action;
        button.scale = key.scale;
        usual.buttons.push_back(button);
    }
    for (const Action action : {Action::turn, Action::look}) {
        AxisMapping axis;
        axis.control = {action == Action::turn ? "pointer-x" : "pointer-y", 0, 0, ""};
        axis.action = action;
        axis.invert = true;  // to the right turns to the right, downwards looks down
        axis.deg_per_count = deg_per_px;
        usual.axes.push_back(axis);
    }
    return usual;
}

}  // namespace

std::vector<ControlInfo> window_controls() {
    std::vector<ControlInfo> controls;
    for (const WindowKey& key : window_keys()) {
        ControlInfo control;
        control.name = "key-" + std::string(key.name);
        control.collection = window_collection;
        control.kind = ControlKind::button;
        control.usage_page = keyboard_page;
        control.usage = key.usage;
        control.logical_max = 1;
        controls.push_back(control);
    }
    for (const std::uint16_t usage : {usage_x, usage_y}) {
        ControlInfo control;
        control.name = usage == usage_x ? "pointer-x" : "pointer-y";
        control.collection = window_collection;
        control.usage_page = desktop_page;
        control.usage = usage;
        control.logical_min = -32768;
        control.logical_max = 32767;
        control.relative = true;
        controls.push_back(control);
    }
    return controls;
}

DeviceMapping window_mapping(std::span<const DeviceMapping> mappings, double deg_per_px) {
    const DeviceIdentity identity{0, 0, std::string(window_device_name), DeviceClass::reject};
    for (const DeviceMapping& m : mappings)
        if (!m.match.product_name.empty() && matches(m.match, identity)) return m;
    return usual_mapping(deg_per_px);
}

std::uint64_t stop_keys(const DeviceMapping& mapping) {
    std::uint64_t bits = 0;
    const auto keys = window_keys();
    for (const ButtonMapping& button : mapping.buttons) {
        if (button.action != Action::stop) continue;
        const ControlRef& of = button.control;
        for (std::size_t i = 0; i < keys.size(); ++i) {
            const bool meant = of.name.empty() ? of.usage_page == keyboard_page && of.usage == keys[i].usage
                                               : of.name == "key-" + std::string(keys[i].name);
            if (meant) bits |= std::uint64_t{1} << i;
        }
    }
    return bits;
}

void fill_state(const WindowReport& report, DeviceState& state) {
    const std::size_t keys = window_keys().size();
    for (std::size_t i = 0; i < keys; ++i) state.value[i] = static_cast<std::int32_t>((report.keys >> i) & 1U);
    state.value[keys] = report.dx;
    state.value[keys + 1] = report.dy;
    for (std::size_t i = 0; i < keys + 2; ++i) state.has_value.set(i);
    state.stamp_ns = report.stamp_ns;
    ++state.reports;
    state.connected = true;
}

WindowDevice::WindowDevice(std::shared_ptr<WindowFeed> feed, std::span<const DeviceMapping> mappings, double deg_per_px,
                           const MessageSink& sink)
    : feed_(std::move(feed)) {
    const DeviceMapping mapping = window_mapping(mappings, deg_per_px);
    mapping_ = mapping.name;
    mapper_ = compile_what_fits(mapping, window_controls());
    for (const std::string& message : mapper_.messages) emit(sink, "{}: {}", window_device_name, message);
}

void WindowDevice::begin(Steering& steering, std::int64_t now_ns) {
    number_ = steering.attach(std::move(mapper_), window_keys().size() + 2, Reporting::on_change);
    if (number_ < 0) return;
    fill_state({}, state_);
    steering.report(number_, state_, now_ns);
}

}  // namespace surefoot::input
