// The panel as a device.
#include "input/gpio/panel_device.hpp"

#include <algorithm>

namespace surefoot::input {

namespace {

Action action_named(std::string_view name) {
    const auto names = action_names();
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? Action::none : static_cast<Action>(found - names.begin());
}

ControlRef ref_to(const ControlInfo& control) { return {control.name, 0, 0, control.collection}; }

}  // namespace

DeviceMapping panel_mapping(std::span<const DeviceMapping> mappings, std::span<const ControlInfo> controls) {
    const DeviceIdentity identity{0, 0, std::string(panel_name), DeviceClass::buttons};
    for (const DeviceMapping& m : mappings)
        if (!m.match.product_name.empty() && matches(m.match, identity)) return m;
    DeviceMapping named;
    named.name = "gpio lines by their names";
    for (const ControlInfo& c : controls) {
        const Action action = action_named(c.name);
        if (action == Action::none) continue;
        if (c.kind == ControlKind::button) {
            ButtonMapping button;
            button.control = ref_to(c);
            button.action = action;
            named.buttons.push_back(button);
        } else if (has_size(action)) {
            AxisMapping axis;
            axis.control = ref_to(c);
            axis.action = action;
            axis.counts_per_s = 40;  // a detent is four steps: ten of them a second are full response
            named.axes.push_back(axis);
        }
    }
    if (!named.buttons.empty() || !named.axes.empty()) return named;
    return default_mapping(controls, DeviceClass::buttons);
}

PanelDevice::PanelDevice(std::vector<LineConfig> lines, std::span<const DeviceMapping> mappings, OpenLines opener, void* context,
                         MessageSink sink, Opening where)
    : panel_(std::move(lines), opener, context, where), sink_(std::move(sink)) {
    const DeviceMapping mapping = panel_mapping(mappings, panel_.controls());
    mapping_ = mapping.name;
    mapper_ = compile_what_fits(mapping, panel_.controls());
    for (const std::string& message : mapper_.messages) emit(sink_, "{}: {}", panel_name, message);
    spare_ = mapper_;
}

/// A stop that is asserted because the chip is missing must be explained: nobody has pressed anything.
void PanelDevice::service(std::int64_t now_ns) {
    panel_.service(now_ns);
    if (panel_.problem() == last_problem_.view()) return;
    last_problem_ = format_message("{}", panel_.problem());
    if (last_problem_.size == 0)
        emit(sink_, "{}: The lines are open.", panel_name);
    else
        emit(sink_, "{}: {} The lines are tried again. A stop among them is asserted until then.", panel_name,
             last_problem_.view());
}

void PanelDevice::open() {
    panel_.wait_for_first_try();
    service(0);
    (void)panel_.take_lines();  // that the lines were closed until now is no broken wire
}

/// The steering gives the mapper back that the number had before: the first time an empty one, later the panel's other one.
void PanelDevice::attach(Steering& steering) {
    number_ = steering.attach(std::move(mapper_), panel_.controls().size(), Reporting::on_change, known_);
    if (number_ < 0) return emit(sink_, "{}: {} devices steer already. Unplug one.", panel_name, max_devices);
    if (!attached_once_) std::swap(mapper_, spare_);
    attached_once_ = true;
    known_ = number_;
    reports_ = 0;
}

PanelDevice::Step PanelDevice::step(Steering& steering, std::int64_t now_ns) {
    service(now_ns);
    Step out;
    if (has_controls()) {
        const bool anew = panel_.opens() != opens_;
        opens_ = panel_.opens();
        if (number_ >= 0 && (anew || !panel_.open())) {
            steering.detach(number_);
            number_ = -1;
        }
        if (anew && panel_.open()) attach(steering);
        if (number_ >= 0 && panel_.state().reports != reports_) {
            reports_ = panel_.state().reports;
            steering.report(number_, panel_.state(), now_ns);
            steering.drained(number_, 1);
            out.reported = true;
        }
    }
    out.lines = panel_.take_lines();
    return out;
}

}  // namespace surefoot::input
