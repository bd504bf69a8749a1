// A described device: its layout, its named controls bound by usage and collection, its class and the reason for it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "input/controls.hpp"
#include "input/hid/descriptor.hpp"
#include "input/hid/quirks.hpp"

namespace surefoot::input {

/// Limit of elements searched for controls. Far above real devices; bounds the time for hostile ones.
constexpr std::uint32_t max_elements = 8192;
constexpr std::size_t max_ports = 8;  ///< of an adapter; pads in further sockets are not mapped by default

/// Where a control's value comes from: element `index` of a variable field, or usage `index` of an array.
struct ControlSource {
    std::uint32_t field = 0;
    std::uint32_t index = 0;
};

/// A device as its descriptor describes it.
struct HidDevice {
    Layout layout;
    std::vector<ControlInfo> controls;   ///< axes, hats, buttons of steering collections first, then the others
    std::vector<ControlSource> sources;  ///< parallel to `controls`
    DeviceClass device_class = DeviceClass::reject;
    std::string reason;                   ///< of the class, one sentence
    std::vector<std::string> quirks;      ///< applied, in words
    std::uint32_t controls_left_out = 0;  ///< beyond max_controls
};

/// Names the controls and decides the class. `id` selects quirks; unknown ids select none.
HidDevice describe_device(Layout layout, DeviceId id);

const char* class_name(DeviceClass c);
const char* kind_name(ControlKind kind);

}  // namespace surefoot::input
