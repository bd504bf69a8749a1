// Answers to mappings: pairs of stick axes become sticks, the rest is as it was shown.
#include <algorithm>
#include <array>

#include "input/map/teach.hpp"

namespace surefoot::input {

namespace {

ControlRef ref_of(const ControlInfo& c) { return {c.name, c.usage_page, c.usage, c.collection}; }

/// HID's usages of the two axes of one stick, the one across first.
constexpr std::array<std::array<std::uint16_t, 2>, 3> stick_usages = {{{0x30, 0x31}, {0x32, 0x35}, {0x33, 0x34}}};

/// Whether `a` goes across and `b` along on one stick. A six-axis cap is no stick: its axes are pushed one by one.
bool one_stick(const ControlInfo& a, const ControlInfo& b) {
    if (a.usage_page != 0x01 || b.usage_page != 0x01 || a.collection != b.collection) return false;
    if (a.collection.find("Multi-axis") != std::string::npos) return false;
    return std::any_of(stick_usages.begin(), stick_usages.end(),
                       [&](const auto& pair) { return a.usage == pair[0] && b.usage == pair[1]; });
}

/// Whether the response has to be turned round so that what was shown gives the requested direction.
bool inverted(const Learned& l) { return (l.rest == Rest::centre ? l.positive : true) != (l.sign > 0); }

void add_axes(DeviceMapping& m, std::span<const ControlInfo> infos, std::vector<Learned> axes) {
    while (!axes.empty()) {
        const Learned a = axes.front();
        axes.erase(axes.begin());
        const auto partner = std::find_if(axes.begin(), axes.end(), [&](const Learned& b) {
            const ControlInfo &i = infos[a.control], &j = infos[b.control];
            return moves(a.action) && moves(b.action) && a.rest == Rest::centre && b.rest == Rest::centre && !i.relative &&
                   !j.relative && (one_stick(i, j) || one_stick(j, i));
        });
        if (partner != axes.end()) {
            Learned across = a, along = *partner;
            if (!one_stick(infos[across.control], infos[along.control])) std::swap(across, along);
            axes.erase(partner);
            StickMapping s;
            s.controls = {ref_of(infos[across.control]), ref_of(infos[along.control])};
            s.actions = {across.action, along.action};
            s.invert = {inverted(across), inverted(along)};
            m.sticks.push_back(s);
            continue;
        }
        AxisMapping axis;
        axis.control = ref_of(infos[a.control]);
        axis.action = a.action;
        axis.rest = a.rest;
        axis.invert = inverted(a);
        m.axes.push_back(axis);
    }
}

void add_hat(DeviceMapping& m, const ControlInfo& info, const Learned& l) {
    const ControlRef ref = ref_of(info);
    auto found = std::find_if(m.hats.begin(), m.hats.end(), [&](const HatMapping& h) { return h.control.name == ref.name; });
    if (found == m.hats.end()) {
        HatMapping h;
        h.control = ref;
        h.scale = 0.5;  // a hat has no half way
        h.smoothing_s = 0.1;
        found = m.hats.insert(m.hats.end(), h);
    }
    found->actions[l.hat_axis] = l.action;
    found->invert[l.hat_axis] = inverted(l);
}

void add_button(DeviceMapping& m, const ControlInfo& info, const Learned& l) {
    ButtonMapping b;
    b.control = ref_of(info);
    b.action = l.action;
    b.debounce_s = 0.005;
    if (has_size(l.action)) {
        b.scale = 0.5 * l.sign;
        b.smoothing_s = 0.1;
    }
    m.buttons.push_back(b);
}

}  // namespace

std::vector<DeviceMapping> Teach::mappings() const {
    std::vector<DeviceMapping> all;
    for (std::size_t d = 0; d < devices_.size(); ++d) {
        const Device& device = devices_[d];
        DeviceMapping m;
        m.name = device.identity.product_name.empty() ? "shown" : device.identity.product_name;
        m.match.vendor = device.identity.vendor;
        m.match.product = device.identity.product;
        const DeviceMapping usual = default_mapping(device.infos, device.identity.device_class);
        m.reporting = usual.reporting;
        m.flies = usual.flies;
        std::vector<Learned> axes;
        for (const Learned& l : learned_) {
            if (l.device != static_cast<int>(d)) continue;
            const ControlInfo& info = device.infos[l.control];
            if (info.kind == ControlKind::axis)
                axes.push_back(l);
            else if (info.kind == ControlKind::hat)
                add_hat(m, info, l);
            else
                add_button(m, info, l);
        }
        add_axes(m, device.infos, std::move(axes));
        if (!m.axes.empty() || !m.sticks.empty() || !m.hats.empty() || !m.buttons.empty()) all.push_back(std::move(m));
    }
    return all;
}

}  // namespace surefoot::input
