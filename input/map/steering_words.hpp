// The words of enums as the steering file writes them, in the enums' order.
#pragma once

#include <array>
#include <string_view>

namespace surefoot::input::words {

constexpr std::array<std::string_view, 4> curves = {"linear", "power", "expo", "smooth"};
constexpr std::array<std::string_view, 3> rests = {"centre", "min", "max"};
constexpr std::array<std::string_view, 2> dead_zones = {"axial", "radial"};
constexpr std::array<std::string_view, 3> reportings = {"learn", "streaming", "on_change"};
constexpr std::array<std::string_view, 4> classes = {"navigation", "trackball", "buttons", "reject"};
constexpr std::array<std::string_view, 6> roles = {"button", "stop", "stop_reset", "dead_man", "encoder_a", "encoder_b"};
constexpr std::array<std::string_view, 4> biases = {"as_is", "pull_up", "pull_down", "off"};

}  // namespace surefoot::input::words
