// Mappings for devices that nobody configured, by usages (HID Usage Tables 1.5, pages 0x01, 0x02, 0x09).
#include <algorithm>
#include <cctype>

#include "input/map/mapping.hpp"

namespace surefoot::input {

namespace {

constexpr std::uint16_t desktop = 0x01, simulation = 0x02;
constexpr std::uint16_t x = 0x30, y = 0x31, z = 0x32, rx = 0x33, ry = 0x34, rz = 0x35, slider = 0x36;
constexpr std::uint16_t rudder = 0xba, throttle = 0xbb, accelerator = 0xc4, brake = 0xc5;

class Rules {
public:
    Rules(std::span<const ControlInfo> controls, DeviceClass device_class) : controls_(controls), class_(device_class) {}

    DeviceMapping make() {
        mapping_.name = "default: none";
        if (class_ == DeviceClass::reject || class_ == DeviceClass::trackball) return mapping_;
        const bool any_axis = axis(x) || axis(y) || axis(z) || axis(rx) || axis(ry) || axis(rz) || simulated(rudder) ||
                              simulated(accelerator) || simulated(brake);
        if (class_ == DeviceClass::buttons || !any_axis)
            mapping_.name = "default: buttons";
        else if (is_six_axis())
            six_axis();
        else if (is_pedals())
            pedals();
        else if (is_gamepad())
            gamepad();
        else
            joystick();
        buttons();
        return mapping_;
    }

private:
    [[nodiscard]] const ControlInfo* find(std::uint16_t page, std::uint16_t usage) const {
        const auto found = std::find_if(controls_.begin(), controls_.end(), [&](const ControlInfo& c) {
            return c.kind == ControlKind::axis && c.usage_page == page && c.usage == usage && !c.relative &&
                   c.logical_min < c.logical_max;
        });
        return found == controls_.end() ? nullptr : &*found;
    }
    [[nodiscard]] bool axis(std::uint16_t usage) const { return find(desktop, usage) != nullptr; }
    [[nodiscard]] bool simulated(std::uint16_t usage) const { return find(simulation, usage) != nullptr; }
    [[nodiscard]] std::size_t buttons_count() const {
        return static_cast<std::size_t>(std::count_if(controls_.begin(), controls_.end(),
                                                      [](const ControlInfo& c) { return c.kind == ControlKind::button; }));
    }
    /// Letters of the outermost collections, compared without spaces and signs: "Game Pad", "GamePad", "game-pad".
    [[nodiscard]] bool in_collection(std::string_view word) const {
        return std::any_of(controls_.begin(), controls_.end(), [&](const ControlInfo& c) {
            std::string letters;
            for (const char letter : c.collection)
                if (std::isalpha(static_cast<unsigned char>(letter)) != 0)
                    letters += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
            return letters.find(word) != std::string::npos;
        });
    }

    [[nodiscard]] bool is_six_axis() const {
        if (!(axis(x) && axis(y) && axis(z) && axis(rx) && axis(ry) && axis(rz))) return false;
        if (in_collection("multiaxis")) return true;
        const bool hat =
            std::any_of(controls_.begin(), controls_.end(), [](const auto& c) { return c.kind == ControlKind::hat; });
        return !hat && !in_collection("gamepad") && !in_collection("joystick");
    }
    [[nodiscard]] bool is_pedals() const {
        if (in_collection("gamepad") || (buttons_count() > 0 && !in_collection("pedal"))) return false;
        const bool drives = simulated(accelerator) || simulated(brake);
        return simulated(rudder) || drives || in_collection("pedal") || (axis(z) && !axis(slider) && !axis(rz)) ||
               (axis(rx) && axis(ry) && axis(rz) && !axis(x));
    }
    [[nodiscard]] bool is_gamepad() const {
        if (!axis(x) || !axis(y)) return false;
        if (in_collection("gamepad")) return (axis(rx) && axis(ry)) || (axis(z) && axis(rz));
        // Many gamepads call themselves joysticks: two full pairs and buttons for two hands.
        const bool lever = axis(slider) || simulated(throttle) || simulated(rudder);
        return !lever && buttons_count() >= 8 && ((axis(rx) && axis(ry)) || (axis(z) && axis(rz)));
    }

    [[nodiscard]] ControlRef ref(std::uint16_t page, std::uint16_t usage) const {
        const ControlInfo* control = find(page, usage);
        return {control->name, page, usage, control->collection};
    }
    AxisMapping& add(std::uint16_t page, std::uint16_t usage, Action action, bool invert = false, Rest rest = Rest::centre) {
        AxisMapping m;
        m.control = ref(page, usage);
        m.action = action;
        m.invert = invert;
        m.rest = rest;
        mapping_.axes.push_back(m);
        return mapping_.axes.back();
    }
    StickMapping& add_stick(std::uint16_t a, std::uint16_t b, Action first, bool invert_a, Action second, bool invert_b) {
        StickMapping m;
        m.controls = {ref(desktop, a), ref(desktop, b)};
        m.actions = {first, second};
        m.invert = {invert_a, invert_b};
        mapping_.sticks.push_back(m);
        return mapping_.sticks.back();
    }
    void add_hat(Action across, bool invert_across, Action along) {
        for (const ControlInfo& c : controls_) {
            if (c.kind != ControlKind::hat) continue;
            HatMapping m;
            m.control = {c.name, c.usage_page, c.usage, c.collection};
            m.actions = {across, along};
            m.invert = {invert_across, false};
            m.scale = 0.5;  // a hat has no half way
            m.smoothing_s = 0.1;
            mapping_.hats.push_back(m);
            return;
        }
    }

    // A six-axis puck counts x to the right, y towards the user, z downwards, and turns right-handedly about them.
    void six_axis() {
        mapping_.name = "default: six axes";
        mapping_.reporting = Reporting::streaming;  // every 8 ms while deflected, zeros on release, then nothing
        add(desktop, x, Action::side);
        add(desktop, y, Action::forward, true);
        add(desktop, z, Action::up, true);
        add(desktop, rx, Action::look);
        add(desktop, rz, Action::turn, true);
    }

    /// Stick axes count to the right and towards the user: forward and look are inverted, and so is turn (to the left).
    void gamepad() {
        mapping_.name = "default: gamepad";
        add_stick(x, y, Action::side, false, Action::forward, true);
        const bool z_stick = axis(z) && axis(rz);
        if (z_stick)
            add_stick(z, rz, Action::turn, true, Action::look, true);
        else
            add_stick(rx, ry, Action::turn, true, Action::look, true);
        // Triggers: Sony's Rx/Ry beside sticks on Z/Rz. One trigger axis for both (xusb's Z) rests in its middle.
        if (z_stick && axis(rx) && axis(ry)) {
            add(desktop, rx, Action::up, true, Rest::min);
            add(desktop, ry, Action::up, false, Rest::min);
        } else if (simulated(accelerator) && simulated(brake)) {
            add(simulation, brake, Action::up, true, Rest::min);
            add(simulation, accelerator, Action::up, false, Rest::min);
        } else if (!z_stick && axis(z)) {
            add(desktop, z, Action::up, true);
        }
        add_hat(Action::none, false, Action::up);
    }

    void joystick() {
        mapping_.name = "default: joystick";
        const bool twist = axis(rz) || simulated(rudder);
        const bool pair = axis(x) && axis(y);
        if (pair)
            add_stick(x, y, twist ? Action::side : Action::turn, !twist, Action::forward, true);
        else if (axis(y))
            add(desktop, y, Action::forward, true);
        else if (axis(x))
            add(desktop, x, Action::turn, true);
        if (twist) {
            AxisMapping& m = axis(rz) ? add(desktop, rz, Action::turn, true) : add(simulation, rudder, Action::turn, true);
            m.shape.dead_zone = 0.15;  // a hand that pushes also twists a little
        }
        // Levers lie with their low end away from the user: pushed forward is fast.
        if (simulated(throttle))
            add(simulation, throttle, Action::speed, true);
        else if (axis(slider))
            add(desktop, slider, Action::speed, true);
        else if (axis(z) && !(axis(rx) && axis(ry)))
            add(desktop, z, Action::speed, true);
        add_hat(twist ? Action::none : Action::side, false, Action::look);
    }

    /// A pedal that rests at its upper end never shows itself neutral, and so does nothing until `rest = "max"` is configured:
    /// guessing from where it stands would take a pressed pedal for a resting one.
    void pedals() {
        mapping_.name = "default: pedals";
        const bool drives = simulated(accelerator) || simulated(brake);
        if (simulated(accelerator)) add(simulation, accelerator, Action::forward, false, Rest::min);
        if (simulated(brake)) add(simulation, brake, Action::forward, true, Rest::min);
        const bool upper = !axis(x) && axis(rx) && axis(ry) && axis(rz);
        if (simulated(rudder))
            add(simulation, rudder, Action::turn, true);
        else if (upper || axis(z))
            add(desktop, upper ? rz : z, Action::turn, true);
        const std::uint16_t right = upper ? rx : x, left = upper ? ry : y;
        if (!drives && axis(right)) add(desktop, right, Action::forward, false, Rest::min);
        if (!drives && axis(left)) add(desktop, left, Action::forward, true, Rest::min);
    }

    void buttons() {
        constexpr std::array<Action, 4> actions = {Action::next_viewpoint, Action::reset, Action::tour, Action::pause};
        std::size_t next = 0;
        for (const ControlInfo& c : controls_) {
            if (c.kind != ControlKind::button || next == actions.size()) continue;
            ButtonMapping m;
            m.control = {c.name, c.usage_page, c.usage, c.collection};
            m.action = actions[next++];
            m.settle_s = 0.005;
            mapping_.buttons.push_back(m);
        }
    }

    std::span<const ControlInfo> controls_;
    DeviceClass class_;
    DeviceMapping mapping_;
};

}  // namespace

DeviceMapping default_mapping(std::span<const ControlInfo> controls, DeviceClass device_class) {
    return Rules(controls, device_class).make();
}

}  // namespace surefoot::input
