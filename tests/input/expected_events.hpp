// Decoded controls put into evdev's words: the events that the kernel must have made of a report.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "input/hid/decoder.hpp"
#include "tests/input/kernel_differences.hpp"
#include "tests/input/kernel_dump.hpp"
#include "tests/input/kernel_events.hpp"

namespace surefoot::input {

/// Foretells evdev's events from decoded controls. Which element has which event is the dump's word; values, changes and noise
/// are reckoned as in hid-input.c and input.c of Linux 6.1.
class ExpectedEvents {
public:
    ExpectedEvents(const HidDevice& device, const KernelDump& dump, const KernelEvents& events, Differences& allowed)
        : device_(device), allowed_(allowed) {
        std::vector<std::size_t> first(device.layout.fields.size());
        std::size_t next = 0;
        for (const std::uint32_t f : device.layout.fields_by_report()) {
            first[f] = next;
            if (device.layout.fields[f].kind != ReportKind::feature) next += device.layout.fields[f].usages;
        }
        EXPECT_TRUE(dump.cut ? dump.events.size() < next : dump.events.size() == next);
        for (std::size_t c = 0; c < device.controls.size(); ++c) {
            const ControlSource source = device.sources[c];
            const std::size_t at = first[source.field] + source.index;
            if (at >= dump.events.size()) {
                ADD_FAILURE() << device.controls[c].name << " is behind the end of the dump";
                return;
            }
            bind(c, dump.events[at].event, events);
        }
    }

    /// Behind a report that was accepted: the events that evdev makes of it.
    std::vector<KernelEvent> step(const DeviceState& state) {
        std::vector<KernelEvent> made;
        for (std::size_t c = 0; c < bound_.size(); ++c)
            if (!state.carried_over.test(c)) add(made, bound_[c], state.has_value.test(c), state.value[c]);
        return made;
    }

private:
    struct Bound {
        EventType type = EventType::key;
        std::uint32_t code = 0;
        bool without_events = false, hat = false;
        bool deflection = false;  ///< relative to the kernel only
        bool had_value = false;
        std::int32_t fuzz = 0, last = 0, last_y = 0;
    };

    void bind(std::size_t control, const std::string& event, const KernelEvents& events) {
        static const std::map<std::string, std::uint32_t> absolute = {
            {"X", 0},        {"Y", 1},   {"Z", 2},      {"Rx", 3},     {"Ry", 4},      {"Rz", 5},
            {"Throttle", 6}, {"Gas", 9}, {"Brake", 10}, {"Hat0X", 16}, {"Volume", 32}, {"Misc", 40}};
        const ControlInfo& c = device_.controls[control];
        Bound& b = bound_.emplace_back();
        b.hat = c.kind == ControlKind::hat;
        const std::string kind = event.substr(0, event.find('.')), name = event.substr(event.find('.') + 1);
        if (kind == "Sync") {
            b.without_events = true;
            allowed_.add(Difference::no_code);
        } else if (kind == "Key" || kind == "Power") {
            b.code = full_usage(c.usage_page, c.usage);
            EXPECT_TRUE(c.kind == ControlKind::button) << c.name;
        } else if (kind == "Absolute" && absolute.contains(name)) {
            b.type = EventType::absolute;
            b.code = absolute.at(name);
            EXPECT_FALSE(c.relative) << c.name;
            const auto axis = events.axes.find(b.code);
            ASSERT_TRUE(axis != events.axes.end()) << c.name;
            b.fuzz = axis->second.fuzz;
            if (c.kind == ControlKind::axis) {
                EXPECT_EQ(c.logical_min, axis->second.min) << c.name;
                EXPECT_EQ(c.logical_max, axis->second.max) << c.name;
            }
        } else if (kind == "Relative") {
            b.type = EventType::relative;
            b.code = c.usage_page == 0x0c ? rel_hwheel : c.usage == 0x38 ? rel_wheel : c.usage - 0x30U;
            b.deflection = !c.relative;
            EXPECT_TRUE(c.relative || !device_.quirks.empty()) << c.name;
        } else {
            ADD_FAILURE() << c.name << ": " << event;
        }
    }

    /// input_defuzz_abs_event().
    static std::int32_t without_noise(std::int32_t value, std::int32_t last, std::int32_t fuzz) {
        const std::int64_t step = std::abs(std::int64_t{value} - last);
        if (step < fuzz / 2) return last;
        if (step < fuzz) return static_cast<std::int32_t>((std::int64_t{last} * 3 + value) / 4);
        if (step < std::int64_t{fuzz} * 2) return static_cast<std::int32_t>((std::int64_t{last} + value) / 2);
        return value;
    }

    void change(std::vector<KernelEvent>& made, const Bound& b, std::uint32_t code, std::int32_t& last, std::int32_t value) {
        const std::int32_t seen = without_noise(value, last, b.fuzz);
        if (seen != value) allowed_.add(Difference::noise);
        if (seen != last) made.push_back({b.type, code, seen});
        last = seen;
    }

    void add(std::vector<KernelEvent>& made, Bound& b, bool has_value, std::int32_t value) {
        static constexpr int hat_x[] = {0, 1, 1, 1, 0, -1, -1, -1}, hat_y[] = {-1, -1, 0, 1, 1, 1, 0, -1};
        if (b.without_events) return;
        if (b.hat) {
            const auto at = static_cast<std::size_t>(value);
            change(made, b, b.code, b.last, has_value ? hat_x[at] : 0);
            change(made, b, b.code + 1, b.last_y, has_value ? hat_y[at] : 0);
            return;
        }
        if (!has_value && b.had_value) allowed_.add(Difference::null_state);
        b.had_value = has_value;
        if (has_value && b.type != EventType::relative) change(made, b, b.code, b.last, value);
        if (!has_value || b.type != EventType::relative || value == 0) return;
        if (b.deflection) allowed_.add(Difference::deflection);
        made.push_back({b.type, b.code, value});
        if (b.code == rel_hwheel) made.push_back({b.type, rel_hwheel_fine, value * 120});
        if (b.code == rel_wheel) made.push_back({b.type, rel_wheel_fine, value * 120});
    }

    static constexpr std::uint32_t rel_hwheel = 6, rel_wheel = 8, rel_wheel_fine = 11, rel_hwheel_fine = 12;
    const HidDevice& device_;
    Differences& allowed_;
    std::vector<Bound> bound_;
};

}  // namespace surefoot::input
