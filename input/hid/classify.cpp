// The purpose of a device, from its application collections and usable elements alone.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "input/hid/device.hpp"
#include "input/hid/element.hpp"

namespace surefoot::input {

namespace {

struct Count {
    std::uint32_t axes = 0, hats = 0, buttons = 0;
    void add(ControlKind kind) { ++(kind == ControlKind::axis ? axes : kind == ControlKind::hat ? hats : buttons); }
    [[nodiscard]] std::string text() const {
        std::string t;
        const auto append_count = [&](std::uint32_t n, const char* one, const char* many) {
            if (n > 0) t += fmt::format("{}{} {}", t.empty() ? "" : ", ", n, n == 1 ? one : many);
        };
        append_count(axes, "axis", "axes");
        append_count(hats, "hat", "hats");
        append_count(buttons, "button", "buttons");
        return t;
    }
};

/// The first application of that sort which the layout's input fields name.
std::string name_of(const Layout& layout, Application wanted) {
    for (const Field& f : layout.fields) {
        if (f.kind != ReportKind::input) continue;
        const auto usage = application_usage(layout, f.collection);
        if (application_of(usage) == wanted) return usage_text(usage);
    }
    return "device";
}

const char* why_rejected(Application a) {
    switch (a) {
        case Application::mouse:
            return "a mouse or pointer belongs to the desktop";
        case Application::keyboard:
            return "a keyboard is for typing";
        case Application::digitizer:
            return "a tablet, touch pad or touch screen reports a position, not a deflection";
        case Application::consumer:
            return "media keys and remote controls have nothing to steer with";
        case Application::system:
            return "power and system keys have nothing to steer with";
        case Application::telephony:
            return "a headset or telephone has nothing to steer with";
        case Application::sensor:
            return "a sensor is no hand control";
        case Application::head_tracker:
            return "a head-mounted device or tracker is not a hand control";
        case Application::power:
            return "a battery or power supply has nothing to steer with";
        case Application::vendor:
            return "its reports are vendor-defined";
        default:
            return "its collections hold no joystick, game pad, multi-axis controller or simulation control";
    }
}

/// The sort of application that most of the input bits belong to; steering ones come first whatever their size.
Application main_application(const Layout& layout) {
    std::array<std::uint64_t, 16> bits{};
    for (const Field& f : layout.fields) {
        if (f.kind != ReportKind::input) continue;
        bits[static_cast<std::size_t>(application_of(application_usage(layout, f.collection)))] +=
            std::uint64_t{f.size} * f.count;
    }
    // What people would call it, before what fills it: a mouse with a vendor report is a mouse.
    for (const auto a :
         {Application::digitizer, Application::mouse, Application::keyboard, Application::telephony, Application::consumer,
          Application::system, Application::sensor, Application::head_tracker, Application::power}) {
        if (bits[static_cast<std::size_t>(a)] > 0) return a;
    }
    return bits[static_cast<std::size_t>(Application::vendor)] > 0 ? Application::vendor : Application::none;
}

bool any_input(const Layout& layout) {
    for (const Field& f : layout.fields)
        if (f.kind == ReportKind::input) return true;
    return false;
}

/// Every input stands in applications that name nothing, and some of it is numbered buttons: button boxes with firmware of their
/// own leave the application undefined. Axes in such a device do not steer: nothing says what they measure.
std::uint32_t nameless_buttons(const Layout& layout, const std::vector<Element>& elements) {
    for (const Field& f : layout.fields)
        if (f.kind == ReportKind::input && application_of(application_usage(layout, f.collection)) != Application::none) return 0;
    return static_cast<std::uint32_t>(
        std::count_if(elements.begin(), elements.end(), [](const Element& e) { return e.usage >> 16U == page::button; }));
}

}  // namespace

std::uint32_t application_usage(const Layout& layout, std::uint32_t collection) {
    std::uint32_t outermost = 0, significant = 0, any = 0;
    for (; collection != no_collection; collection = layout.collections[collection].parent) {
        const Collection& c = layout.collections[collection];
        any = c.usage;
        if (c.type != collection_type::application) continue;
        outermost = c.usage;
        const Application a = application_of(c.usage);
        if (a != Application::none && a != Application::other && a != Application::vendor) significant = c.usage;
    }
    // Some makers put a joystick into a physical collection and forget the application; the kernel takes those as well.
    return significant != 0 ? significant : outermost != 0 ? outermost : any;
}

bool pointer_with_constant_buttons(const Layout& layout) {
    for (const Field& f : layout.fields) {
        if (f.kind != ReportKind::input || !f.constant() || f.size == 0 || f.count == 0) continue;
        if (layout.usage_of(f, 0) >> 16U != page::button) continue;
        if (application_of(application_usage(layout, f.collection)) == Application::mouse) return true;
    }
    return false;
}

Verdict classify(const Layout& layout, const std::vector<Element>& elements, bool trackball) {
    Count steering, pointing;
    for (const Element& e : elements) {
        if (e.application == Application::steering) steering.add(e.kind);
        if (e.application == Application::mouse) pointing.add(e.kind);
    }
    const bool declared = name_of(layout, Application::steering) != "device";
    if (steering.axes > 0) {
        return {DeviceClass::navigation, fmt::format("a {} with {}", name_of(layout, Application::steering), steering.text())};
    }
    if (trackball && pointing.axes >= 2) return {DeviceClass::trackball, fmt::format("a trackball with {}", pointing.text())};
    if (steering.hats + steering.buttons > 0) {
        return {DeviceClass::buttons,
                fmt::format("a {} without a usable axis: {}", name_of(layout, Application::steering), steering.text())};
    }
    if (Count box{.buttons = nameless_buttons(layout, elements)}; box.buttons > 0)
        return {DeviceClass::buttons, fmt::format("a button box that names no application, with {}", box.text())};
    if (!any_input(layout)) return {DeviceClass::reject, "it declares no input that has a usage"};
    if (declared) {
        return {DeviceClass::reject,
                fmt::format("a {} without a usable input: each is constant, has no range or size, or no steering usage",
                            name_of(layout, Application::steering))};
    }
    return {DeviceClass::reject, why_rejected(main_application(layout))};
}

}  // namespace surefoot::input
