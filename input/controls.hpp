// Types shared by the rooms of the device layer: controls, device states, motion requests, samples.
//
//   hid/, gpio/ ──► DeviceState ──► map/ ──► MotionRequest ──► safety/ ──► motion/ ──► NavigationSample (latest value)
//   (raw values)    (per device)    (actions, -1..1)  (may only     (limits, filter,
//                                                      reduce it)    pose in double)
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <string>
#include <vector>

#include "rt/base/geometry.hpp"
#include "rt/base/light.hpp"

namespace surefoot::input {

constexpr std::size_t max_controls = 256;  ///< of one device; further ones are counted and ignored

enum class ControlKind : std::uint8_t { axis, hat, button };

/// The purpose of a device, from the usages in its descriptor.
enum class DeviceClass : std::uint8_t { navigation, trackball, buttons, reject };

/// One named control, bound by usage and collection, never by index.
struct ControlInfo {
    std::string name;        ///< unique in the device: "x", "rz", "hat", "button-3", "slider-2"
    std::string collection;  ///< path of its collections, outermost first: "Joystick/Physical"
    ControlKind kind = ControlKind::axis;
    std::uint16_t usage_page = 0, usage = 0;
    std::int32_t logical_min = 0, logical_max = 0;
    double physical_min = 0, physical_max = 0;  ///< in `unit`; both 0 where the descriptor gives none
    std::string unit;                           ///< "deg", "cm", ...; may be empty
    bool relative = false;                      ///< after quirks: a displacement, not a deflection
    bool wraps = false;
    std::uint8_t port = 0;  ///< socket of an adapter for several pads, from 0; each pad has X and Y of its own
};

/// Newest raw values of one device, index-parallel to its ControlInfo list. Plain data: copied through exchanges.
/// hat: 0..7 clockwise from north. `has_value` false: never seen, or a null state (a hat at its centre).
struct DeviceState {
    std::array<std::int32_t, max_controls> value{};
    std::bitset<max_controls> has_value;
    std::bitset<max_controls> carried_over;  ///< not in the newest report, which has another id: the value is older
    std::int64_t stamp_ns = 0;               ///< CLOCK_MONOTONIC when its newest report was read; 0: none yet
    std::uint64_t reports = 0;               ///< accepted; short, long and undeclared ones are counted apart and change nothing
    bool connected = false;
};

/// The requested motion, before any limit: each -1..1, in the eye's frame. +forward is along -Z, +side to the right.
struct MotionRequest {
    double forward = 0, side = 0, up = 0;
    double turn = 0, look = 0;  ///< turn > 0: to the left (counter-clockwise from above); look > 0: upwards
    double speed = 0;           ///< -1..1: from the slowest to the fastest factor; 0 leaves it
    double zoom = 0;            ///< -1..1: how fast the field of view becomes narrower; below 0: wider again
    bool next_viewpoint = false, reset = false, tour = false, pause = false;  ///< edges: true in the sample they happen in
    std::uint32_t switched = 0;                                               ///< edges too: bit i is rt::light_switches[i]
    double turn_by_rad = 0, look_by_rad = 0;  ///< by a pointer: an angle, not a rate; in the sample it happens in, as edges
};

/// How the walk follows the request: `brake` reaches it within brake_s (a device was lost), `stop` stands still in this step.
enum class Order : std::uint8_t { walk, brake, stop };

/// The command that safety/ passes to motion/.
struct Command {
    MotionRequest request;
    Order order = Order::walk;
    std::int64_t stamp_ns = 0;  ///< of the newest report in it
};

/// Counts of edges since the start. Newest-wins exchanges drop samples together with their edges. A reader that compares these
/// counts with the last ones it handled loses no edge and takes none twice. Counts wrap.
struct PressCounts {
    std::uint32_t next_viewpoint = 0, reset = 0, tour = 0, pause = 0;
    rt::SwitchPresses light;
};

/// The sample for the frame thread; newest wins. At rest all is zero and the pose is held.
struct NavigationSample {
    Pose pose;                 ///< integrated so far, double; see geometry.hpp for the frame
    dvec3 velocity_m_s{0.0};   ///< world
    dvec3 angular_rad_s{0.0};  ///< world, axis times rate
    /// What of both comes from a floor or a wall that moves: how it carries the eye now, and at most in the next moments. Turns
    /// are to the left. All 0 where nothing moves near.
    dvec3 carried_m_s{0.0};
    double carried_rad_s = 0, max_carried_m_s = 0, max_carried_rad_s = 0;
    double zoom_rate = 0;      ///< of the magnification's natural logarithm, 1/s
    double uncertainty_m = 0;  ///< of the pose one frame ahead; prepare/ widens its region by it
    double uncertainty_rad = 0;
    std::int64_t stamp_ns = 0;   ///< of the newest report in it
    std::uint64_t sequence = 0;  ///< of samples, from 1
    bool next_viewpoint = false, reset = false, tour = false, pause = false;
    bool stopped = false;  ///< emergency stop or dead-man: rest by order
    bool pointed = false;  ///< a pointer turns the eye, or did a moment ago: it may turn faster than a stick
    PressCounts presses;   ///< up to and with this sample
};

}  // namespace surefoot::input
