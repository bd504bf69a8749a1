// The user's mapping of a device: which control does what, and its response. Plain data, read from and written to TOML.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "input/controls.hpp"
#include "input/map/response.hpp"

namespace surefoot::input {

enum class Action : std::uint8_t {
    none,
    forward,
    side,
    up,
    turn,
    look,
    speed,
    zoom,  // the seven that have a size, as in MotionRequest
    next_viewpoint,
    reset,
    tour,
    pause,
    sunlight,
    shadows,
    lamps,
    fog,         // edges, as in MotionRequest; the last four in the order of rt::light_switches
    dead_man,    // walks only while held
    stop,        // emergency stop: latched
    stop_reset,  // clears the latch once the stop is no longer asserted
};
constexpr std::size_t action_count = 19;

/// As in TOML: "forward", "next_viewpoint", ...; index is the Action.
std::span<const std::string_view> action_names();
std::string_view name_of(Action action);
[[nodiscard]] constexpr bool has_size(Action a) { return a >= Action::forward && a <= Action::zoom; }
/// Of an action that switches light: its index in rt::light_switches.
[[nodiscard]] constexpr std::size_t switch_of(Action a) {
    return static_cast<std::size_t>(a) - static_cast<std::size_t>(Action::sunlight);
}
static_assert(switch_of(Action::fog) + 1 == rt::switch_count);
/// Whether the action moves the walker. The neutral interlock watches these. Speed and zoom it does not: a throttle keeps its
/// place.
[[nodiscard]] constexpr bool moves(Action a) { return a >= Action::forward && a <= Action::look; }

/// A control, by its name ("x"), else by usage page and usage ("0x01:0x30"). If not empty, `collection` must be a part of the
/// control's collection path.
struct ControlRef {
    std::string name;
    std::uint16_t usage_page = 0, usage = 0;
    std::string collection;
    [[nodiscard]] std::string text() const;
};

/// How an axis or hat becomes an action.
struct AxisMapping {
    ControlRef control;
    Action action = Action::none;
    Shape shape;
    Rest rest = Rest::centre;
    bool invert = false;
    double scale = 1;            ///< response at full deflection; 0..1
    double counts_per_s = 1000;  ///< relative controls only (trackball, mouse, encoder): the pace that is full response
    /// Relative controls that turn or look only: the angle of a count. So a pointer turns the eye as far as it was moved, at any
    /// pace, without shape. 0: they set a pace.
    double deg_per_count = 0;
};

/// Two axes that one hand moves. Axes: to the right and downwards, as HID sticks count.
struct StickMapping {
    std::array<ControlRef, 2> controls;
    std::array<Action, 2> actions{};
    std::array<bool, 2> invert{};
    Shape shape;
    bool radial = true;  ///< false: each axis has its own dead zone
    double scale = 1;
};

/// A hat is a stick with eight directions. Axes: right and up.
struct HatMapping {
    ControlRef control;
    std::array<Action, 2> actions{};
    std::array<bool, 2> invert{};
    double scale = 1;
    double smoothing_s = 0;
};

/// How a button becomes an action.
struct ButtonMapping {
    ControlRef control;
    Action action = Action::none;
    double scale = 1;              ///< request of the held button, -1..1; for actions that have a size
    double smoothing_s = 0;        ///< of those: time constant
    double debounce_s = 0;         ///< a release counts once it lasted so long (contact bounce); a press counts at once
    bool normally_closed = false;  ///< asserted while the contact is open or its state unknown: for stops
};

/// How the device reports while it is deflected, which decides what silence means (safety/).
enum class Reporting : std::uint8_t {
    learn,      ///< found out from the reports
    streaming,  ///< sends all the time while deflected: silence is a fault
    on_change,  ///< sends changes only: silence means "as before"
};

/// Every given member must match; an empty matcher fits every device.
struct DeviceMatch {
    std::optional<std::uint16_t> vendor, product;
    std::string product_name;  ///< a part of the name, upper or lower case
    std::optional<DeviceClass> device_class;
};

/// All mappings of one device, and which devices they fit.
struct DeviceMapping {
    std::string name;
    DeviceMatch match;
    Reporting reporting = Reporting::learn;
    bool flies = false;  ///< moves the eye freely in space, through walls too, unless the walk's settings say otherwise
    std::vector<AxisMapping> axes;
    std::vector<StickMapping> sticks;
    std::vector<HatMapping> hats;
    std::vector<ButtonMapping> buttons;
};

/// Facts about a device, for finding its mapping.
struct DeviceIdentity {
    std::uint16_t vendor = 0, product = 0;
    std::string product_name;
    DeviceClass device_class = DeviceClass::reject;
};

[[nodiscard]] bool matches(const DeviceMatch& match, const DeviceIdentity& identity);
/// The first that fits; null for none.
const DeviceMapping* find_mapping(std::span<const DeviceMapping> mappings, const DeviceIdentity& identity);

/// The mapping of an unconfigured device, from its class, collections and usages. Known: gamepads, joysticks with or without
/// twist and throttle, six-axis controllers, pedals, button boxes. Trackballs, mice, keyboards and rejected devices get an empty
/// mapping: they steer only if configured. Each socket of an adapter is mapped as a device of its own. `name` is the rule
/// used.
DeviceMapping default_mapping(std::span<const ControlInfo> controls, DeviceClass device_class);

}  // namespace surefoot::input
