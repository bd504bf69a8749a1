// The steering file, read and written: [motion], [safety], [[device]] and [[gpio]].
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "input/gpio/panel.hpp"
#include "input/map/mapping.hpp"
#include "input/motion/motion.hpp"
#include "input/safety/safety.hpp"

namespace surefoot::input {

/// The content of a steering file.
struct SteeringFile {
    std::vector<DeviceMapping> devices;  ///< the first that fits a device is taken; none fits: the default of its class
    MotionLimits motion;
    SafetyLimits safety;
    std::vector<LineConfig> lines;
};

/// Errors name FILE:LINE, the key, the allowed values and the nearest known name. Unknown keys are errors. Controls are checked
/// when a device comes (compile()), because only then they are known.
Result<SteeringFile> read_steering(const std::string& file);
Result<SteeringFile> parse_steering(std::string_view text, const std::string& name);

/// TOML that parse_steering() reads back to the same; keys at their defaults are left out.
std::string steering_text(const SteeringFile& steering);
std::string device_text(const DeviceMapping& mapping);

/// The words of enums as the file writes them, in the enums' order.
namespace words {
constexpr std::array<std::string_view, 4> curves = {"linear", "power", "expo", "smooth"};
constexpr std::array<std::string_view, 3> rests = {"centre", "min", "max"};
constexpr std::array<std::string_view, 2> dead_zones = {"axial", "radial"};
constexpr std::array<std::string_view, 3> reportings = {"learn", "streaming", "on_change"};
constexpr std::array<std::string_view, 4> classes = {"navigation", "trackball", "buttons", "reject"};
constexpr std::array<std::string_view, 6> roles = {"button", "stop", "stop_reset", "dead_man", "encoder_a", "encoder_b"};
constexpr std::array<std::string_view, 4> biases = {"as_is", "pull_up", "pull_down", "off"};
}  // namespace words

}  // namespace surefoot::input
