// Mapping to bindings: finds the named controls and settles every shape for them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "input/map/mapper.hpp"
#include "rt/base/text.hpp"

namespace surefoot::input {

namespace {

bool fits(const ControlRef& ref, const ControlInfo& control, ControlKind kind) {
    if (control.kind != kind) return false;
    if (!ref.collection.empty() && control.collection.find(ref.collection) == std::string::npos) return false;
    return ref.name.empty() ? control.usage_page == ref.usage_page && control.usage == ref.usage : control.name == ref.name;
}

Error not_found(const ControlRef& ref, std::span<const ControlInfo> controls, ControlKind kind) {
    std::vector<std::string_view> names;
    std::string all;
    for (const ControlInfo& control : controls) {
        if (control.kind != kind) continue;
        names.push_back(control.name);
        if (names.size() <= 24) all += (all.empty() ? "" : ", ") + control.name;
    }
    const auto nearest = nearest_word(ref.name, names);
    constexpr std::array<std::string_view, 3> kinds = {"axis", "hat", "button"};
    const auto word = kinds[static_cast<std::size_t>(kind)];
    return {ref.text(), fmt::format("The device has no such {}", word),
            !nearest.empty() ? fmt::format("Did you mean '{}'?", nearest)
            : all.empty()    ? fmt::format("Bind no {}: the device has none", word)
                             : fmt::format("Use one of {}", all),
            ErrorKind::not_found};
}

class Compiler {
public:
    explicit Compiler(std::span<const ControlInfo> controls)
        : controls_(controls), adapter_(std::ranges::any_of(controls, [](const ControlInfo& c) { return c.port > 0; })) {
        mapper.adapter = adapter_;
    }

    void axis(const AxisMapping& from) {
        const auto at = find(from.control, ControlKind::axis);
        if (!at) return;
        Binding b;
        b.source = controls_[*at].relative ? Binding::Source::relative : Binding::Source::axis;
        b.counts_per_s = from.counts_per_s;
        if (controls_[*at].relative && from.deg_per_count > 0 && (from.action == Action::turn || from.action == Action::look)) {
            b.source = Binding::Source::pointer;
            b.rad_per_count = from.deg_per_count * std::numbers::pi / 180;
        }
        b.own_interlock = from.rest != Rest::centre;
        set(b, 0, *at, from.action, from.invert ? -from.scale : from.scale, from.rest);
        shape(b, from.shape);
        push(b);
    }
    void stick(const StickMapping& from) {
        if (!from.radial) {
            for (std::size_t i = 0; i < 2; ++i)
                if (from.actions[i] != Action::none)
                    axis({from.controls[i], from.actions[i], from.shape, Rest::centre, from.invert[i], from.scale});
            return;
        }
        Binding b;
        b.source = Binding::Source::stick;
        for (std::size_t i = 0; i < 2; ++i) {
            const auto at = find(from.controls[i], ControlKind::axis);
            if (!at) return;
            if (controls_[*at].relative) {
                errors_.push_back({from.controls[i].text(),
                                   "The control is a displacement, not a deflection: it cannot be part of a stick",
                                   "Bind it as [[device.axis]]", ErrorKind::misuse});
                return;
            }
            set(b, i, *at, from.actions[i], from.invert[i] ? -from.scale : from.scale, Rest::centre);
        }
        if (b.control[0] == b.control[1]) {
            errors_.push_back(
                {from.controls[0].text(), "The control is named twice for one stick", "Name two axes", ErrorKind::misuse});
            return;
        }
        shape(b, from.shape);
        push(b);
    }
    void hat(const HatMapping& from) {
        const auto at = find(from.control, ControlKind::hat);
        if (!at) return;
        Binding b;
        b.source = Binding::Source::hat;
        for (std::size_t i = 0; i < 2; ++i)
            set(b, i, *at, from.actions[i], from.invert[i] ? -from.scale : from.scale, Rest::centre);
        b.smoothing_s = from.smoothing_s;
        push(b);
    }
    void button(const ButtonMapping& from) {
        const auto at = find(from.control, ControlKind::button);
        if (!at) return;
        Binding b;
        b.source = Binding::Source::button;
        set(b, 0, *at, from.action, from.scale, Rest::centre);
        b.smoothing_s = from.smoothing_s;
        b.debounce_ns = static_cast<std::int64_t>(std::llround(from.debounce_s * 1e9));
        b.normally_closed = from.normally_closed;
        push(b);
    }

    Mapper mapper;
    [[nodiscard]] const std::vector<Error>& errors() const { return errors_; }

private:
    std::optional<std::uint16_t> find(const ControlRef& ref, ControlKind kind) {
        const auto limit = std::min(controls_.size(), max_controls);
        for (std::size_t i = 0; i < limit; ++i) {
            const ControlInfo& control = controls_[i];
            if (!fits(ref, control, kind)) continue;
            if (kind == ControlKind::axis && !control.relative && control.logical_min >= control.logical_max) {
                errors_.push_back(
                    {ref.text(), fmt::format("The control has the empty range {}..{}", control.logical_min, control.logical_max),
                     "Bind another control: the descriptor is wrong", ErrorKind::damaged});
                return std::nullopt;
            }
            return static_cast<std::uint16_t>(i);
        }
        errors_.push_back(not_found(ref, controls_, kind));
        return std::nullopt;
    }
    void set(Binding& b, std::size_t i, std::uint16_t control, Action action, double gain, Rest rest) const {
        b.control[i] = control;
        b.action[i] = action;
        b.gain[i] = gain;
        const ControlInfo& info = controls_[control];
        if (info.logical_min < info.logical_max) b.rest[i] = RestFinder(info.logical_min, info.logical_max, rest);
        if (adapter_) b.own_interlock = true;
    }
    static void shape(Binding& b, const Shape& shape) {
        double half = b.rest[0].half_travel_counts();
        if (b.source == Binding::Source::stick) half = std::min(half, b.rest[1].half_travel_counts());
        if (b.source == Binding::Source::relative || b.source == Binding::Source::pointer)
            half = 1e9;  // a pace has no counts of tremor
        b.response = response_for(shape, half);
        b.smoothing_s = shape.smoothing_s;
    }
    void push(const Binding& b) { mapper.bindings.push_back(b); }

    std::span<const ControlInfo> controls_;
    std::vector<Error> errors_;
    /// What one says of a socket without a pad need never be rest: that must not hold the pad in another.
    bool adapter_ = false;
};

Compiler compiled(const DeviceMapping& mapping, std::span<const ControlInfo> controls) {
    Compiler c(controls);
    for (const auto& m : mapping.axes) c.axis(m);
    for (const auto& m : mapping.sticks) c.stick(m);
    for (const auto& m : mapping.hats) c.hat(m);
    for (const auto& m : mapping.buttons) c.button(m);
    return c;
}

}  // namespace

Result<Mapper> compile(const DeviceMapping& mapping, std::span<const ControlInfo> controls) {
    Compiler c = compiled(mapping, controls);
    c.mapper.flies = mapping.flies;
    if (!c.errors().empty()) {
        Error error = c.errors().front();
        error.place = fmt::format("mapping '{}', control {}", mapping.name, error.place);
        return error;
    }
    return std::move(c.mapper);
}

Mapper compile_what_fits(const DeviceMapping& mapping, std::span<const ControlInfo> controls) {
    Compiler c = compiled(mapping, controls);
    c.mapper.flies = mapping.flies;
    for (const Error& error : c.errors()) c.mapper.messages.push_back(error.text());
    return std::move(c.mapper);
}

}  // namespace surefoot::input
