// Reads the steering file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "input/map/steering_file.hpp"
#include "rt/base/file.hpp"
#include "rt/base/text.hpp"
#include "rt/base/toml_reader.hpp"

namespace surefoot::input {

namespace {

constexpr std::uint64_t max_bytes = 1U << 20U;
constexpr double ms = 1e-3;

template <class E>
void choose(TableReader& table, std::string_view key, std::span<const std::string_view> names, E& value) {
    auto index = static_cast<std::size_t>(value);
    table.choice(key, names, index);
    value = static_cast<E>(index);
}

/// A time that the file gives in ms, or s, and the program keeps in ns or s.
void time(TableReader& table, std::string_view key, double max, std::string_view unit, double scale_ns, std::int64_t& value_ns) {
    double value = static_cast<double>(value_ns) / scale_ns;
    table.number(key, 0, max, unit, value);
    value_ns = std::llround(value * scale_ns);
}
void time_ms(TableReader& table, std::string_view key, double max_ms, double& value_s) {
    double value = value_s / ms;
    table.number(key, 0, max_ms, "ms", value);
    value_s = value * ms;
}

std::optional<std::uint16_t> hex(std::string_view text) {
    if (!text.starts_with("0x")) return std::nullopt;
    return number_in<std::uint16_t>(text.substr(2), 16);
}

/// "x", or "0x01:0x30".
void control_of(TableReader& table, std::string_view key, const std::string& text, ControlRef& control) {
    if (text.empty()) return table.refuse(key, "is missing", "Name the control as `surefoot devices` lists it");
    const auto colon = text.find(':');
    const auto page = hex(text.substr(0, colon)), usage = colon == std::string::npos ? std::nullopt : hex(text.substr(colon + 1));
    if (page && usage) {
        control.usage_page = *page;
        control.usage = *usage;
    } else {
        control.name = text;
    }
}

void one_control(TableReader& table, ControlRef& control) {
    std::string text;
    table.text("control", text);
    table.text("collection", control.collection);
    control_of(table, "control", text, control);
}

void read_shape(TableReader& table, Shape& shape) {
    table.number("dead_zone", 0, 0.9, "of the travel", shape.dead_zone);
    table.number("hysteresis", 0, 0.3, "of the travel", shape.hysteresis);
    table.number("saturation", 0.1, 1, "of the travel", shape.saturation);
    choose(table, "curve", words::curves, shape.curve);
    if (shape.curve == Curve::power && !table.has("strength")) shape.strength = 2;
    const bool power = shape.curve == Curve::power;
    table.number("strength", power ? 1 : 0, power ? 4 : 1, power ? "exponent" : "share of the cube", shape.strength);
    time_ms(table, "smoothing_ms", 1000, shape.smoothing_s);
    if (shape.dead_zone < shape.hysteresis)
        table.refuse(table.has("dead_zone") ? "dead_zone" : "hysteresis",
                     fmt::format("= {} makes the dead zone {} narrower than the hysteresis {}",
                                 table.has("dead_zone") ? shape.dead_zone : shape.hysteresis, shape.dead_zone, shape.hysteresis),
                     "Widen dead_zone or lower hysteresis, so that the control comes to rest");
    if (shape.saturation <= shape.dead_zone + shape.hysteresis + 0.05)
        table.refuse(table.has("saturation") ? "saturation" : "dead_zone", "leaves nothing between dead zone and saturation",
                     "Write a saturation above dead_zone + hysteresis + 0.05");
}

void need_action(TableReader& table, std::string_view key) {
    if (!table.has(key)) table.refuse(key, "is missing", "Say what the control does");
}

Result<void> read_axis(TableReader& table, std::vector<AxisMapping>& into) {
    AxisMapping m;
    one_control(table, m.control);
    need_action(table, "action");
    choose(table, "action", action_names(), m.action);
    if (m.action != Action::none && !has_size(m.action))
        table.refuse("action", fmt::format("= {} is no action for an axis", name_of(m.action)),
                     "Use forward, side, up, turn, look, speed or zoom");
    read_shape(table, m.shape);
    choose(table, "rest", words::rests, m.rest);
    table.flag("invert", m.invert);
    table.number("scale", 0, 1, "", m.scale);
    table.number("counts_per_s", 1, 1e6, "counts/s", m.counts_per_s);
    table.number("deg_per_count", 0, 45, "degrees", m.deg_per_count);
    if (m.deg_per_count > 0 && m.action != Action::turn && m.action != Action::look)
        table.refuse("deg_per_count", fmt::format("is an angle, and {} is none", name_of(m.action)),
                     "Use the action turn or look, or write counts_per_s");
    into.push_back(m);
    return table.finish();
}

void two_actions(TableReader& table, std::array<Action, 2>& actions) {
    need_action(table, "actions");
    std::array<std::size_t, 2> index{};
    table.choices("actions", action_names(), index);
    for (std::size_t i = 0; i < 2; ++i) {
        actions[i] = static_cast<Action>(index[i]);
        if (actions[i] != Action::none && !has_size(actions[i]))
            table.refuse("actions", fmt::format("names {}, which is no action for a stick or hat", name_of(actions[i])),
                         "Use forward, side, up, turn, look, speed, zoom or none");
    }
}

Result<void> read_stick(TableReader& table, std::vector<StickMapping>& into) {
    StickMapping m;
    std::array<std::string, 2> names;
    table.texts("controls", names);
    std::string collection;
    table.text("collection", collection);
    for (std::size_t i = 0; i < 2; ++i) {
        control_of(table, "controls", names[i], m.controls[i]);
        m.controls[i].collection = collection;
    }
    two_actions(table, m.actions);
    table.flags("invert", m.invert);
    read_shape(table, m.shape);
    std::size_t zone = m.radial ? 1 : 0;
    table.choice("dead_zone_shape", words::dead_zones, zone);
    m.radial = zone == 1;
    table.number("scale", 0, 1, "", m.scale);
    into.push_back(m);
    return table.finish();
}

Result<void> read_hat(TableReader& table, std::vector<HatMapping>& into) {
    HatMapping m;
    one_control(table, m.control);
    two_actions(table, m.actions);
    table.flags("invert", m.invert);
    table.number("scale", 0, 1, "", m.scale);
    time_ms(table, "smoothing_ms", 1000, m.smoothing_s);
    into.push_back(m);
    return table.finish();
}

Result<void> read_button(TableReader& table, std::vector<ButtonMapping>& into) {
    ButtonMapping m;
    one_control(table, m.control);
    need_action(table, "action");
    choose(table, "action", action_names(), m.action);
    table.number("scale", -1, 1, "", m.scale);
    time_ms(table, "smoothing_ms", 1000, m.smoothing_s);
    time_ms(table, "settle_ms", 1000, m.debounce_s);
    table.flag("normally_closed", m.normally_closed);
    into.push_back(m);
    return table.finish();
}

void read_id(TableReader& table, std::string_view key, std::optional<std::uint16_t>& id) {
    if (!table.has(key)) {
        std::int64_t none = 0;
        return table.integer(key, 0, 0xffff, none);
    }
    std::int64_t value = 0;
    table.integer(key, 0, 0xffff, value);
    id = static_cast<std::uint16_t>(value);
}

Result<void> read_device(TableReader& table, std::vector<DeviceMapping>& into) {
    DeviceMapping m;
    table.text("name", m.name);
    read_id(table, "vendor", m.match.vendor);
    read_id(table, "product", m.match.product);
    table.text("product_name", m.match.product_name);
    if (std::size_t index = 0; table.has("class")) {
        table.choice("class", words::classes, index);
        m.match.device_class = static_cast<DeviceClass>(index);
    } else {
        table.choice("class", words::classes, index);
    }
    choose(table, "reporting", words::reportings, m.reporting);
    table.flag("flies", m.flies);
    table.tables("axis", [&](TableReader& t) { return read_axis(t, m.axes); });
    table.tables("stick", [&](TableReader& t) { return read_stick(t, m.sticks); });
    table.tables("hat", [&](TableReader& t) { return read_hat(t, m.hats); });
    table.tables("button", [&](TableReader& t) { return read_button(t, m.buttons); });
    into.push_back(std::move(m));
    return table.finish();
}

Result<void> read_motion(TableReader& table, MotionLimits& m) {
    table.number("walk_m_s", 0.01, 100, "m/s", m.walk_m_s);
    table.number("slowest", 0.01, 1, "factor", m.slowest);
    table.number("fastest", 1, 100, "factor", m.fastest);
    table.number("max_m_s", 0.01, 1000, "m/s", m.max_m_s);
    table.number("accel_m_s2", 0.1, 1000, "m/s2", m.accel_m_s2);
    table.number("turn_rad_s", 0.01, 10, "rad/s", m.turn_rad_s);
    table.number("look_rad_s", 0.01, 10, "rad/s", m.look_rad_s);
    table.number("accel_rad_s2", 0.1, 1000, "rad/s2", m.accel_rad_s2);
    table.number("max_pitch_rad", 0, 1.57, "rad", m.max_pitch_rad);
    table.number("max_zoom", 1, 50, "factor", m.max_zoom);
    table.number("zoom_per_s", 1.01, 10, "factor a second", m.zoom_per_s);
    table.flag("level", m.level);
    table.number("min_cutoff_hz", 0.5, 100, "Hz", m.filter.min_cutoff_hz);
    table.number("cutoff_slope", 0, 100, "Hz per full deflection a second", m.filter.slope);
    return table.finish();
}

Result<void> read_safety(TableReader& table, SafetyLimits& s) {
    time(table, "age_limit_ms", 10'000, "ms", 1e6, s.age_limit_ns);
    table.number("slew_per_s", 0.5, 1000, "full deflections a second", s.slew_per_s);
    time(table, "dead_man_press_ms", 1000, "ms", 1e6, s.dead_man.press_ns);
    time(table, "dead_man_idle_s", 86'400, "s; 0: never", 1e9, s.dead_man.idle_limit_ns);
    return table.finish();
}

Result<void> read_line(TableReader& table, std::vector<LineConfig>& into) {
    LineConfig line;
    for (const auto& [key, text] :
         {std::pair{"name", &line.name}, std::pair{"chip", &line.request.chip}, std::pair{"line", &line.request.line}}) {
        if (!table.has(key)) table.refuse(key, "is missing", "Give a line its name, its chip and its line (a name or an offset)");
        table.text(key, *text);
    }
    choose(table, "role", words::roles, line.role);
    choose(table, "bias", words::biases, line.request.bias);
    table.flag("active_low", line.request.active_low);
    table.flag("normally_closed", line.normally_closed);
    if (line.role == LineRole::stop && table.has("normally_closed") && !line.normally_closed)
        table.refuse("normally_closed", "= false is not allowed for a stop",
                     "Wire the stop normally closed: a broken wire must stop the walk");
    if (line.role == LineRole::stop) line.normally_closed = true;
    time(table, "settle_ms", 1000, "ms", 1e6, line.debounce_ns);
    into.push_back(line);
    return table.finish();
}

}  // namespace

Result<SteeringFile> parse_steering(std::string_view text, const std::string& name) {
    SteeringFile steering;
    const auto root = parse_toml(text, name);
    if (!root) return root.error();
    TableReader table(*root, name, "");
    table.table("motion", [&](TableReader& t) { return read_motion(t, steering.motion); });
    table.table("safety", [&](TableReader& t) { return read_safety(t, steering.safety); });
    table.tables("device", [&](TableReader& t) { return read_device(t, steering.devices); });
    table.tables("gpio", [&](TableReader& t) { return read_line(t, steering.lines); });
    if (const auto done = table.finish(); !done) return done.error();
    if (const auto lines = check_lines(steering.lines); !lines) {
        Error error = lines.error();
        error.place = name + ", " + error.place;
        return error;
    }
    return steering;
}

Result<SteeringFile> read_steering(const std::string& file) {
    const auto text = read_text(file, max_bytes);
    if (!text) return text.error();
    return parse_steering(*text, file);
}

}  // namespace surefoot::input
