// Writes the steering file: only what differs from the defaults, so that a file shows what somebody decided.
#include <fmt/format.h>

#include <sstream>

#include <toml++/toml.h>

#include "input/map/steering_file.hpp"

namespace surefoot::input {

namespace {

class Writer {
public:
    void header(std::string_view text) { text_ += fmt::format("{}{}\n", text_.empty() ? "" : "\n", text); }
    void number(std::string_view key, double value, double standard) {
        if (value != standard) text_ += fmt::format("{} = {}\n", key, shown(value));
    }
    void flag(std::string_view key, bool value) {
        if (value) text_ += fmt::format("{} = true\n", key);
    }
    void flags(std::string_view key, const std::array<bool, 2>& value) {
        if (value[0] || value[1]) text_ += fmt::format("{} = [{}, {}]\n", key, value[0], value[1]);
    }
    void text(std::string_view key, std::string_view value) {
        if (!value.empty()) text_ += fmt::format("{} = {}\n", key, quoted(value));
    }
    void pair(std::string_view key, std::string_view a, std::string_view b) {
        text_ += fmt::format("{} = [{}, {}]\n", key, quoted(a), quoted(b));
    }
    void id(std::string_view key, const std::optional<std::uint16_t>& value) {
        if (value) text_ += fmt::format("{} = 0x{:04x}\n", key, *value);
    }
    template <std::size_t N, class E>
    void word(std::string_view key, const std::array<std::string_view, N>& names, E value, E standard) {
        if (value != standard) text(key, names[static_cast<std::size_t>(value)]);
    }
    void shape(const Shape& s) {
        const Shape d;
        number("dead_zone", s.dead_zone, d.dead_zone);
        number("hysteresis", s.hysteresis, d.hysteresis);
        number("saturation", s.saturation, d.saturation);
        word("curve", words::curves, s.curve, d.curve);
        if (s.curve == Curve::power || s.curve == Curve::expo)
            number("strength", s.strength, s.curve == Curve::power ? 2 : d.strength);
        number("smoothing_ms", s.smoothing_s * 1e3, 0);
    }
    void control(const ControlRef& ref) {
        text("control", name_of_control(ref));
        text("collection", ref.collection);
    }
    static std::string name_of_control(const ControlRef& ref) {
        return ref.name.empty() ? fmt::format("0x{:02x}:0x{:02x}", ref.usage_page, ref.usage) : ref.name;
    }
    [[nodiscard]] std::string take() { return std::move(text_); }

    void time(std::string_view key, std::int64_t value_ns, std::int64_t standard_ns, double unit_ns) {
        number(key, static_cast<double>(value_ns) / unit_ns, static_cast<double>(standard_ns) / unit_ns);
    }

private:
    static std::string shown(double value) { return fmt::format("{}", value); }
    static std::string quoted(std::string_view value) {
        std::ostringstream out;
        out << toml::toml_formatter{toml::value<std::string>{std::string(value)},
                                    toml::toml_formatter::default_flags & ~toml::format_flags::allow_literal_strings &
                                        ~toml::format_flags::allow_multi_line_strings};
        return out.str();
    }
    std::string text_;
};

void write_device(Writer& w, const DeviceMapping& m) {
    w.header("[[device]]");
    w.text("name", m.name);
    w.id("vendor", m.match.vendor);
    w.id("product", m.match.product);
    w.text("product_name", m.match.product_name);
    if (m.match.device_class) w.text("class", words::classes[static_cast<std::size_t>(*m.match.device_class)]);
    w.word("reporting", words::reportings, m.reporting, Reporting::learn);
    w.flag("flies", m.flies);
    for (const AxisMapping& a : m.axes) {
        w.header("[[device.axis]]");
        w.control(a.control);
        w.text("action", name_of(a.action));
        w.shape(a.shape);
        w.word("rest", words::rests, a.rest, Rest::centre);
        w.flag("invert", a.invert);
        w.number("scale", a.scale, 1);
        w.number("counts_per_s", a.counts_per_s, AxisMapping{}.counts_per_s);
        w.number("deg_per_count", a.deg_per_count, AxisMapping{}.deg_per_count);
    }
    for (const StickMapping& s : m.sticks) {
        w.header("[[device.stick]]");
        w.pair("controls", Writer::name_of_control(s.controls[0]), Writer::name_of_control(s.controls[1]));
        w.text("collection", s.controls[0].collection);
        w.pair("actions", name_of(s.actions[0]), name_of(s.actions[1]));
        w.flags("invert", s.invert);
        w.shape(s.shape);
        if (!s.radial) w.text("dead_zone_shape", "axial");
        w.number("scale", s.scale, 1);
    }
    for (const HatMapping& h : m.hats) {
        w.header("[[device.hat]]");
        w.control(h.control);
        w.pair("actions", name_of(h.actions[0]), name_of(h.actions[1]));
        w.flags("invert", h.invert);
        w.number("scale", h.scale, 1);
        w.number("smoothing_ms", h.smoothing_s * 1e3, 0);
    }
    for (const ButtonMapping& b : m.buttons) {
        w.header("[[device.button]]");
        w.control(b.control);
        w.text("action", name_of(b.action));
        w.number("scale", b.scale, 1);
        w.number("smoothing_ms", b.smoothing_s * 1e3, 0);
        w.number("settle_ms", b.debounce_s * 1e3, 0);
        w.flag("normally_closed", b.normally_closed);
    }
}

void write_limits(Writer& w, const MotionLimits& m, const SafetyLimits& s) {
    const MotionLimits dm;
    const SafetyLimits ds;
    w.header("[motion]");
    w.number("walk_m_s", m.walk_m_s, dm.walk_m_s);
    w.number("slowest", m.slowest, dm.slowest);
    w.number("fastest", m.fastest, dm.fastest);
    w.number("max_m_s", m.max_m_s, dm.max_m_s);
    w.number("accel_m_s2", m.accel_m_s2, dm.accel_m_s2);
    w.number("turn_rad_s", m.turn_rad_s, dm.turn_rad_s);
    w.number("look_rad_s", m.look_rad_s, dm.look_rad_s);
    w.number("accel_rad_s2", m.accel_rad_s2, dm.accel_rad_s2);
    w.number("max_pitch_rad", m.max_pitch_rad, dm.max_pitch_rad);
    w.number("max_zoom", m.max_zoom, dm.max_zoom);
    w.number("zoom_per_s", m.zoom_per_s, dm.zoom_per_s);
    w.flag("level", m.level);
    w.number("min_cutoff_hz", m.filter.min_cutoff_hz, dm.filter.min_cutoff_hz);
    w.number("cutoff_slope", m.filter.slope, dm.filter.slope);
    w.header("[safety]");
    w.time("age_limit_ms", s.age_limit_ns, ds.age_limit_ns, 1e6);
    w.number("slew_per_s", s.slew_per_s, ds.slew_per_s);
    w.time("dead_man_press_ms", s.dead_man.press_ns, ds.dead_man.press_ns, 1e6);
    w.time("dead_man_idle_s", s.dead_man.idle_limit_ns, ds.dead_man.idle_limit_ns, 1e9);
}

}  // namespace

std::string device_text(const DeviceMapping& mapping) {
    Writer w;
    write_device(w, mapping);
    return w.take();
}

std::string steering_text(const SteeringFile& steering) {
    Writer w;
    write_limits(w, steering.motion, steering.safety);
    for (const DeviceMapping& m : steering.devices) write_device(w, m);
    for (const LineConfig& line : steering.lines) {
        w.header("[[gpio]]");
        w.text("name", line.name);
        w.text("chip", line.request.chip);
        w.text("line", line.request.line);
        w.word("role", words::roles, line.role, LineRole::button);
        w.word("bias", words::biases, line.request.bias, Bias::as_is);
        w.flag("active_low", line.request.active_low);
        w.flag("normally_closed", line.normally_closed && line.role != LineRole::stop);
        w.time("settle_ms", line.debounce_ns, LineConfig{}.debounce_ns, 1e6);
    }
    return w.take();
}

}  // namespace surefoot::input
