// Finds the elements that can be controls, names them uniquely, and applies the quirks.
#include "input/hid/device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <tuple>

#include "input/hid/element.hpp"

namespace surefoot::input {

namespace {

/// Usable bits: 1 to 32 of them, data, not padding.
bool carries_values(const Field& f) {
    return f.kind == ReportKind::input && !f.constant() && f.size >= 1 && f.size <= 32 && f.count >= 1 &&
           f.collection != no_collection;
}

std::optional<ControlKind> role_in(const Field& f, std::uint32_t usage) {
    const std::int64_t range = std::int64_t{f.logical_max} - f.logical_min;
    if (!f.variable()) return button_in_array(usage) ? std::optional(ControlKind::button) : std::nullopt;
    const auto role = role_of(usage, range);
    // Without a range there is no deflection to speak of; a button needs none.
    if (role && *role != ControlKind::button && range <= 0) return std::nullopt;
    return role;
}

std::string path_of(const Layout& layout, std::uint32_t collection) {
    std::string path;
    for (; collection != no_collection; collection = layout.collections[collection].parent) {
        const Collection& c = layout.collections[collection];
        std::string name = usage_name(c.usage);
        if (name.empty()) {
            static constexpr const char* types[] = {"Physical",    "Application",  "Logical",       "Report",
                                                    "Named Array", "Usage Switch", "Usage Modifier"};
            name = c.usage != 0                ? fmt::format("{:04x}:{:04x}", c.usage >> 16U, c.usage & 0xffffU)
                   : c.type < std::size(types) ? types[c.type]
                                               : "Vendor";
        }
        // Deep nests are cut: a path is for people.
        if (path.size() > 200) return path.insert(0, "…/");
        if (!path.empty()) path.insert(0, "/");
        path.insert(0, name);
    }
    return path;
}

/// "mouse" for a control that shares its name with one of another application.
std::string prefix_of(Application a) {
    switch (a) {
        case Application::mouse:
            return "mouse-";
        case Application::keyboard:
            return "keyboard-";
        case Application::digitizer:
            return "touch-";
        case Application::consumer:
            return "media-";
        default:
            return "";
    }
}

class Names {
public:
    std::string unique(const Element& e) {
        std::string name = control_name(e.usage);
        if (used_.insert(name).second) return name;
        if (const auto prefix = prefix_of(e.application); !prefix.empty() && used_.insert(prefix + name).second)
            return prefix + name;
        // From where the last of this name ended: a descriptor may hold thousands of one name.
        for (int& n = last_.try_emplace(name, 1).first->second;;)
            if (auto numbered = fmt::format("{}-{}", name, ++n); used_.insert(numbered).second) return numbered;
    }

private:
    std::set<std::string> used_;
    std::map<std::string, int> last_;
};

double physical(std::int32_t value, std::int32_t exponent) { return value * std::pow(10.0, std::clamp(exponent, -32, 32)); }

ControlInfo control_of(const Layout& layout, const Element& e, std::string name, bool deflections) {
    const Field& f = layout.fields[e.field];
    ControlInfo c;
    c.name = std::move(name);
    c.collection = path_of(layout, f.collection);
    c.kind = e.kind;
    c.usage_page = static_cast<std::uint16_t>(e.usage >> 16U);
    c.usage = static_cast<std::uint16_t>(e.usage);
    c.logical_min = f.variable() ? f.logical_min : 0;
    c.logical_max = f.variable() ? f.logical_max : 1;
    // The globals of an axis before it often still stand when a button is declared: a button has no physical range.
    if (f.physical_min != f.physical_max && e.kind != ControlKind::button) {
        c.physical_min = physical(f.physical_min, f.exponent);
        c.physical_max = physical(f.physical_max, f.exponent);
        c.unit = unit_name(f.unit);
    }
    c.relative = f.relative() && !deflections;
    c.wraps = (f.flags & flag::wrap) != 0;
    return c;
}

std::uint32_t outermost_of(const Layout& layout, std::uint32_t collection) {
    while (layout.collections[collection].parent != no_collection) collection = layout.collections[collection].parent;
    return collection;
}

/// The sockets of an adapter for several pads, in the descriptor's order: outermost collections of one usage, each with an X and
/// a Y that deflect. Anything else has none.
std::vector<std::uint32_t> ports_of(const Layout& layout, std::span<const Element> elements) {
    constexpr std::uint32_t x = full_usage(page::generic_desktop, 0x30), y = full_usage(page::generic_desktop, 0x31);
    std::map<std::uint32_t, unsigned> pairs;  // by collection: 1 for an X, 2 for a Y
    std::uint32_t field = no_collection, outermost = 0;
    for (const Element& e : elements) {
        const Field& f = layout.fields[e.field];
        if (e.application != Application::steering || f.relative() || (e.usage != x && e.usage != y)) continue;
        // Once a field: hostile descriptors nest thousands deep, with thousands of elements.
        if (e.field != field) outermost = outermost_of(layout, f.collection);
        field = e.field;
        pairs[outermost] |= e.usage == x ? 1U : 2U;
    }
    std::map<std::uint32_t, std::vector<std::uint32_t>> alike;  // by usage
    for (const auto& [collection, found] : pairs) {
        std::vector<std::uint32_t>& same = alike[layout.collections[collection].usage];
        if (found == 3 && same.size() < max_ports) same.push_back(collection);
    }
    for (const auto& [usage, ports] : alike)
        if (ports.size() > 1) return ports;
    return {};
}

/// Steering first, axes first, numbered buttons before keys: where a device has too many, the least useful are left out.
int rank(const Element& e) {
    const int kind = e.kind == ControlKind::axis ? 0 : e.kind == ControlKind::hat ? 1 : e.usage >> 16U == page::button ? 2 : 3;
    return (e.application == Application::steering ? 0 : 4) + kind;
}

}  // namespace

std::vector<Element> find_elements(const Layout& layout) {
    std::vector<Element> found;
    std::uint32_t looked_at = 0;
    for (std::uint32_t i = 0; i < layout.fields.size(); ++i) {
        const Field& f = layout.fields[i];
        if (!carries_values(f)) continue;
        const Application application = application_of(application_usage(layout, f.collection));
        const std::uint32_t wanted = f.variable() ? f.count : f.usages;
        std::uint32_t index = 0;
        const auto take = [&](std::uint32_t usage) {
            if (const auto kind = role_in(f, usage)) found.push_back({i, index, usage, *kind, application});
            ++index;
            return ++looked_at < max_elements;
        };
        for (std::uint32_t r = f.first_run; r < f.first_run + f.run_count; ++r)
            for (std::uint32_t k = 0; k < layout.runs[r].count && index < wanted; ++k)
                if (!take(layout.runs[r].at(k))) return found;
        // The last usage stands for all further elements of a variable field; of an array it is one button.
        const UsageRun& last = layout.runs[f.first_run + f.run_count - 1];
        while (f.variable() && index < wanted)
            if (!take(last.at(last.count - 1))) return found;
    }
    return found;
}

HidDevice describe_device(Layout layout, DeviceId id) {
    HidDevice device;
    device.layout = std::move(layout);
    const Layout& l = device.layout;
    std::vector<Element> elements = find_elements(l);

    const Quirk* deflections = find_quirk(id, QuirkEffect::deflections);
    const Quirk* ball = find_quirk(id, QuirkEffect::trackball);
    // Without an id only the shape is left to go by.
    const bool ball_by_shape = ball == nullptr && (!id.known() || id.vendor == 0x056e) && pointer_with_constant_buttons(l);
    Verdict verdict = classify(l, elements, ball != nullptr || ball_by_shape || named_trackball(id.name));
    device.device_class = verdict.device_class;
    device.reason = std::move(verdict.reason);
    if (device.device_class == DeviceClass::trackball) {
        device.quirks.emplace_back(ball != nullptr            ? ball->why
                                   : named_trackball(id.name) ? "a trackball by its name; its descriptor says mouse"
                                                              : "a mouse with buttons declared constant: a trackball by ELECOM");
    }

    std::stable_sort(elements.begin(), elements.end(), [](const Element& a, const Element& b) { return rank(a) < rank(b); });
    const std::vector<std::uint32_t> ports = ports_of(l, elements);
    Names names;
    bool corrected = false;
    for (const Element& e : elements) {
        if (device.controls.size() == max_controls) {
            device.controls_left_out = static_cast<std::uint32_t>(elements.size() - max_controls);
            break;
        }
        const Field& f = l.fields[e.field];
        const bool six_axis =
            application_usage(l, f.collection) == full_usage(page::generic_desktop, 0x08) && e.kind == ControlKind::axis;
        corrected |= f.relative() && six_axis && deflections != nullptr;
        device.controls.push_back(control_of(l, e, names.unique(e), six_axis && deflections != nullptr));
        device.sources.push_back({e.field, e.index});
        if (ports.empty()) continue;
        if (const auto port = std::ranges::find(ports, outermost_of(l, f.collection)); port != ports.end())
            device.controls.back().port = static_cast<std::uint8_t>(port - ports.begin());
    }
    if (corrected) device.quirks.emplace_back(deflections->why);
    return device;
}

const char* class_name(DeviceClass c) {
    switch (c) {
        case DeviceClass::navigation:
            return "navigation";
        case DeviceClass::trackball:
            return "trackball";
        case DeviceClass::buttons:
            return "buttons";
        case DeviceClass::reject:
            return "reject";
    }
    return "reject";
}

const char* kind_name(ControlKind kind) {
    return kind == ControlKind::axis ? "axis" : kind == ControlKind::hat ? "hat" : "button";
}

}  // namespace surefoot::input
