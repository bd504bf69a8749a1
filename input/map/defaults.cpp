// Mappings for devices that nobody configured, by usages (HID Usage Tables 1.5, pages 0x01, 0x02, 0x09).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <vector>

#include "input/map/mapping.hpp"

namespace surefoot::input {

namespace {

constexpr std::uint16_t desktop = 0x01, simulation = 0x02, game = 0x05;
constexpr std::uint16_t x = 0x30, y = 0x31, z = 0x32, rx = 0x33, ry = 0x34, rz = 0x35, slider = 0x36;
constexpr std::array six_usages = {x, y, z, rx, ry, rz};
constexpr double puck_reports_per_s = 125;  // of the pucks that report every 8 ms while deflected
constexpr std::uint16_t aileron = 0xb0, elevator = 0xb8, rudder = 0xba, throttle = 0xbb, accelerator = 0xc4, brake = 0xc5,
                        wheel_turn = 0xc8;
constexpr std::uint16_t game_turn = 0x21, game_pitch = 0x22, game_side = 0x24, game_forward = 0x25, game_up = 0x26;

class Rules {
public:
    Rules(std::span<const ControlInfo> controls, DeviceClass device_class) : controls_(controls), class_(device_class) {}

    DeviceMapping make() {
        mapping_.name = "default: none";
        if (class_ == DeviceClass::reject || class_ == DeviceClass::trackball) return mapping_;
        const bool any_axis = axis(x) || axis(y) || axis(z) || axis(rx) || axis(ry) || axis(rz) || simulated(rudder) ||
                              simulated(accelerator) || simulated(brake) || simulated(wheel_turn) || simulated(aileron) ||
                              simulated(elevator);
        if (class_ == DeviceClass::navigation && is_relative_six_axis())
            relative_six_axis();
        else if (class_ == DeviceClass::navigation && !any_axis && (gaming(game_forward) || gaming(game_turn)))
            game_controller();
        else if (!any_axis && has_hat())
            hat_alone();
        else if (class_ == DeviceClass::buttons || !any_axis)
            mapping_.name = "default: buttons";
        else if (is_six_axis())
            six_axis();
        else if (in_collection("multiaxis"))
            fewer_axes();
        else if (is_wheel())
            wheel();
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
    [[nodiscard]] const ControlInfo* find(std::uint16_t page, std::uint16_t usage, bool relative = false) const {
        const auto found = std::find_if(controls_.begin(), controls_.end(), [&](const ControlInfo& c) {
            return c.kind == ControlKind::axis && c.usage_page == page && c.usage == usage && c.relative == relative &&
                   c.logical_min < c.logical_max;
        });
        return found == controls_.end() ? nullptr : &*found;
    }
    [[nodiscard]] bool axis(std::uint16_t usage) const { return find(desktop, usage) != nullptr; }
    [[nodiscard]] bool simulated(std::uint16_t usage) const { return find(simulation, usage) != nullptr; }
    [[nodiscard]] bool gaming(std::uint16_t usage) const { return find(game, usage) != nullptr; }
    /// One range for all of them, as the two sticks of a pad have.
    [[nodiscard]] bool alike(std::initializer_list<std::uint16_t> usages) const {
        const ControlInfo* first = find(desktop, *usages.begin());
        return first != nullptr && std::all_of(usages.begin(), usages.end(), [&](std::uint16_t usage) {
                   const ControlInfo* c = find(desktop, usage);
                   return c != nullptr && c->logical_min == first->logical_min && c->logical_max == first->logical_max;
               });
    }
    /// The right stick of a pad with two further pairs is Z and Rz (Sony's), or Rx and Ry (Microsoft's): the pair with the left
    /// stick's range; where both have it, Z and Rz only if the descriptor names them together, before the others.
    [[nodiscard]] bool right_stick_is_z() const {
        if (!axis(z) || !axis(rz)) return false;
        if (!axis(rx) || !axis(ry)) return true;
        const bool z_like = alike({x, y, z, rz}), r_like = alike({x, y, rx, ry});
        if (z_like != r_like) return z_like;
        return find(desktop, rz) == find(desktop, z) + 1 && find(desktop, z) < find(desktop, rx);
    }
    [[nodiscard]] bool counts_both_ways() const {
        return std::any_of(controls_.begin(), controls_.end(), [](const ControlInfo& c) {
            return c.kind == ControlKind::axis && c.usage_page == desktop && c.logical_min < 0;
        });
    }
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
        return !has_hat() && !in_collection("gamepad") && !in_collection("joystick");
    }
    /// Of a maker that no quirk names, and so taken at its word.
    [[nodiscard]] bool is_relative_six_axis() const {
        return in_collection("multiaxis") && std::all_of(six_usages.begin(), six_usages.end(), [&](std::uint16_t usage) {
                   return find(desktop, usage, true) != nullptr;
               });
    }
    [[nodiscard]] bool has_hat() const {
        return std::any_of(controls_.begin(), controls_.end(), [](const auto& c) { return c.kind == ControlKind::hat; });
    }
    [[nodiscard]] bool is_pedals() const {
        if (in_collection("gamepad") || (buttons_count() > 0 && !in_collection("pedal"))) return false;
        const bool drives = simulated(accelerator) || simulated(brake);
        const bool toes = axis(z) && !axis(slider) && !axis(rz) && !counts_both_ways();
        const bool flies = simulated(aileron) || simulated(elevator);
        return (simulated(rudder) && !flies) || drives || in_collection("pedal") || toes ||
               (axis(rx) && axis(ry) && axis(rz) && !axis(x));
    }
    [[nodiscard]] bool is_wheel() const {
        if (in_collection("gamepad")) return false;
        return simulated(wheel_turn) || (simulated(accelerator) && axis(x) && buttons_count() > 0);
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
        if (control == nullptr) control = find(page, usage, true);
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
    /// Where the device has it, relative or not.
    void add_present(std::uint16_t page, std::uint16_t usage, Action action, bool invert = false) {
        if (find(page, usage) != nullptr || find(page, usage, true) != nullptr) add(page, usage, action, invert);
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
        mapping_.flies = true;
        add_present(desktop, x, Action::side);
        add_present(desktop, y, Action::forward, true);
        add_present(desktop, z, Action::up, true);
        add_present(desktop, rx, Action::look);
        add_present(desktop, rz, Action::turn, true);
    }

    /// At full deflection such a device, too, sends its largest count in every report: that pace is full response.
    void relative_six_axis() {
        six_axis();
        mapping_.name = "default: six relative axes";
        for (AxisMapping& m : mapping_.axes) {
            const ControlInfo* control = find(m.control.usage_page, m.control.usage, true);
            m.counts_per_s = puck_reports_per_s * control->logical_max;
        }
    }

    /// Of a puck's six those that are there.
    void fewer_axes() {
        six_axis();
        mapping_.name = "default: multi-axis";
    }

    /// Game Controls page (HID Usage Tables, 0x05): named by what they do, to the right and forwards.
    void game_controller() {
        mapping_.name = "default: 3D game controller";
        add_present(game, game_forward, Action::forward);
        add_present(game, game_side, Action::side);
        add_present(game, game_up, Action::up);
        add_present(game, game_turn, Action::turn, true);
        add_present(game, game_pitch, Action::look);
    }

    void wheel() {
        mapping_.name = "default: wheel";
        if (simulated(wheel_turn))
            add(simulation, wheel_turn, Action::turn, true);
        else
            add(desktop, x, Action::turn, true);
        if (simulated(accelerator)) add(simulation, accelerator, Action::forward, false, Rest::min);
        if (simulated(brake)) add(simulation, brake, Action::forward, true, Rest::min);
    }

    void hat_alone() {
        mapping_.name = "default: hat";
        add_hat(Action::turn, true, Action::forward);
    }

    /// Stick axes count to the right and towards the user: forward and look are inverted, and so is turn (to the left).
    void gamepad() {
        mapping_.name = "default: gamepad";
        add_stick(x, y, Action::side, false, Action::forward, true);
        const bool z_stick = right_stick_is_z();
        if (z_stick)
            add_stick(z, rz, Action::turn, true, Action::look, true);
        else
            add_stick(rx, ry, Action::turn, true, Action::look, true);
        // Triggers: the pair that is no stick. One trigger axis for both (xusb's Z) rests in its middle.
        if (z_stick && axis(rx) && axis(ry)) {
            add(desktop, rx, Action::up, true, Rest::min);
            add(desktop, ry, Action::up, false, Rest::min);
        } else if (!z_stick && axis(z) && axis(rz)) {
            add(desktop, z, Action::up, true, Rest::min);
            add(desktop, rz, Action::up, false, Rest::min);
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
        if (!axis(x) && simulated(aileron)) add(simulation, aileron, twist ? Action::side : Action::turn, !twist);
        if (!axis(y) && simulated(elevator)) add(simulation, elevator, Action::forward, true);
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
            m.debounce_s = 0.005;
            mapping_.buttons.push_back(m);
        }
    }

    std::span<const ControlInfo> controls_;
    DeviceClass class_;
    DeviceMapping mapping_;
};

}  // namespace

DeviceMapping default_mapping(std::span<const ControlInfo> controls, DeviceClass device_class) {
    std::uint8_t last = 0;
    for (const ControlInfo& c : controls) last = std::max(last, c.port);
    if (last == 0) return Rules(controls, device_class).make();
    // An adapter: whichever socket the pad is in, it steers.
    DeviceMapping all;
    for (int port = 0; port <= last; ++port) {
        std::vector<ControlInfo> of_port;
        std::ranges::copy_if(controls, std::back_inserter(of_port), [&](const ControlInfo& c) { return c.port == port; });
        DeviceMapping one = Rules(of_port, device_class).make();
        if (port == 0) {
            all.name = fmt::format("{}, {} ports", one.name, last + 1);
            all.reporting = one.reporting;
            all.flies = one.flies;
        }
        std::ranges::move(one.axes, std::back_inserter(all.axes));
        std::ranges::move(one.sticks, std::back_inserter(all.sticks));
        std::ranges::move(one.hats, std::back_inserter(all.hats));
        std::ranges::move(one.buttons, std::back_inserter(all.buttons));
    }
    return all;
}

}  // namespace surefoot::input
