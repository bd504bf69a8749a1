// The elements of a layout that can be controls, found once and used for both names and class.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "input/hid/descriptor.hpp"
#include "input/hid/usages.hpp"

namespace surefoot::input {

/// One value of a report, before controls are made of it.
struct Element {
    std::uint32_t field = 0, index = 0;  ///< as in ControlSource
    std::uint32_t usage = 0;
    ControlKind kind = ControlKind::axis;
    Application application = Application::none;
};

/// In the order of the layout, at most max_elements looked at.
std::vector<Element> find_elements(const Layout& layout);

/// Usage of the outermost application collection with a known purpose. Else that of the outermost application collection, else of
/// the outermost collection, else 0 (HID 1.11, 6.2.2.6).
std::uint32_t application_usage(const Layout& layout, std::uint32_t collection);

/// Class of a device, with the reason.
struct Verdict {
    DeviceClass device_class = DeviceClass::reject;
    std::string reason;
};
Verdict classify(const Layout& layout, const std::vector<Element>& elements, bool trackball);

/// A mouse that declares buttons constant, as ELECOM's trackballs do: the only sign of a ball that a descriptor gives.
bool pointer_with_constant_buttons(const Layout& layout);

}  // namespace surefoot::input
