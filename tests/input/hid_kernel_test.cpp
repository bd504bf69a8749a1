// The kernel as a second opinion: what Linux 6.1.192 (Debian's 6.1.0-56-rt) made of descriptors and reports given to it
// through uhid in a virtual machine, kept as text, against what this parser and decoder make of them.
#include <fmt/format.h>

#include <fstream>
#include <map>
#include <sstream>

#include "rt/base/hash.hpp"
#include "tests/input/hid_test.hpp"
#include "tests/input/kernel_differences.hpp"

namespace surefoot::input {
namespace {

/// What debugfs rdesc shows of a layout, as one number. Equal ranges are not shown there and count as none.
std::uint64_t digest(const Layout& l) {
    std::uint64_t h = fnv_start;
    const auto add = [&](std::int64_t v) { h = fnv1a(h, static_cast<std::uint64_t>(v)); };
    for (const auto i : l.fields_by_report()) {
        const Field& f = l.fields[i];
        const bool range = f.logical_min != f.logical_max, physical = f.physical_min != f.physical_max;
        for (const std::int64_t v :
             {std::int64_t(f.kind), std::int64_t{f.report_id}, std::int64_t{f.bit_offset}, std::int64_t{f.size},
              std::int64_t{f.count}, std::int64_t{f.usages}, std::int64_t{range ? f.logical_min : 0},
              std::int64_t{range ? f.logical_max : 0}, std::int64_t{physical ? f.physical_min : 0},
              std::int64_t{physical ? f.physical_max : 0}, std::int64_t{f.exponent}, std::int64_t{f.flags & 0x1ffU}}) {
            add(v);
        }
        for (std::uint32_t k = 0; k < std::min(f.usages, 64U); ++k) add(l.usage_of(f, k));
        if (f.usages > 0) add(l.usage_of(f, f.usages - 1));
    }
    return h;
}

/// Lines "name accept|reject digest hex".
TEST(HidKernel, LayoutsAndVerdictsAreTheKernels) {
    std::ifstream file(device_folder() + "/kernel-layouts.txt");
    ASSERT_TRUE(file);
    std::size_t accepted = 0, refused = 0;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("#")) continue;
        std::istringstream words(line);
        std::string name, verdict, expected, bytes;
        words >> name >> verdict >> expected >> bytes;
        Layout l;
        const auto refusal = parse_descriptor(hex(bytes), l);
        ASSERT_EQ(refusal.has_value(), verdict == "reject") << name << (refusal ? ": " + refusal->what : "");
        ++(refusal ? refused : accepted);
        if (!refusal) {
            EXPECT_EQ(fmt::format("{:016x}", digest(l)), expected) << name;
        }
    }
    EXPECT_GT(accepted, 500U);
    EXPECT_GT(refused, 300U);
}

/// evdev's codes for the usages in the folder; -1: not an axis there.
int evdev_axis(const ControlInfo& c) {
    if (c.usage_page == 1 && c.usage >= 0x30 && c.usage <= 0x35) return c.usage - 0x30;
    if (c.usage_page == 1 && c.usage == 0x36) return 6;
    if (c.usage_page == 1 && c.usage == 0x38) return 8;
    if (c.usage_page == 2 && c.usage == 0xc4) return 9;
    if (c.usage_page == 2 && c.usage == 0xc5) return 10;
    return -1;
}

struct Changes {
    std::map<int, std::int32_t> axes;  ///< code to last value; hats as 16 and 17
    int pressed = 0, released = 0;
    bool operator==(const Changes&) const = default;
};

/// What evdev would report of the step from `before` to `after`.
Changes changes(const HidDevice& d, const DeviceState& before, const DeviceState& after, std::map<int, std::int32_t>& last,
                Differences& allowed) {
    Changes made;
    static constexpr int hat_x[] = {0, 1, 1, 1, 0, -1, -1, -1}, hat_y[] = {-1, -1, 0, 1, 1, 1, 0, -1};
    const auto moved = [&](int code, std::int32_t value, bool relative) {
        if (relative ? value != 0 : last[code] != value) made.axes[code] = value;
        last[code] = value;
    };
    for (std::size_t i = 0; i < d.controls.size(); ++i) {
        const ControlInfo& c = d.controls[i];
        if (c.kind == ControlKind::button) {
            const auto was = before.has_value.test(i) ? before.value[i] : 0, is = after.has_value.test(i) ? after.value[i] : 0;
            made.pressed += is > was;
            made.released += is < was;
        } else if (c.kind == ControlKind::hat) {
            const auto at = static_cast<std::size_t>(after.value[i]);
            moved(16, after.has_value.test(i) ? hat_x[at] : 0, false);
            moved(17, after.has_value.test(i) ? hat_y[at] : 0, false);
        } else if (evdev_axis(c) < 0) {
            allowed.add(Difference::no_code);
        } else if (!after.has_value.test(i)) {
            if (before.has_value.test(i)) allowed.add(Difference::null_state);
        } else {
            moved(evdev_axis(c) + (c.relative ? 100 : 0), after.value[i], c.relative);
        }
    }
    return made;
}

/// Lines "name report type code value". What may differ is in kernel_differences; devices with two controls for one code are not
/// in the file.
TEST(HidKernel, ValuesAreTheEventsOfEvdev) {
    std::ifstream file(device_folder() + "/kernel-events.txt");
    ASSERT_TRUE(file);
    std::map<std::string, std::map<std::size_t, Changes>> events;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("#")) continue;
        std::istringstream words(line);
        std::string name;
        std::size_t report = 0;
        int type = 0, code = 0, value = 0;
        words >> name >> report >> type >> code >> value;
        Changes& c = events[name][report];
        if (type == 1) ++(value != 0 ? c.pressed : c.released);
        if (type == 2) c.axes[code + 100] = value;
        if (type == 3) c.axes[code] = value;
    }
    EXPECT_GE(events.size(), 10U);
    Differences allowed;
    std::size_t compared = 0;
    for (auto& [name, by_report] : events) {
        const Recording r = recorded(name);
        const HidDevice d = describe_device(layout_of(r.descriptor), {});  // the machine had neutral ids: no quirks
        ReportDecoder decoder(d);
        DeviceState state;
        std::map<int, std::int32_t> last;
        for (std::size_t i = 0; i < r.reports.size(); ++i) {
            const DeviceState before = state;
            if (const ReportFate fate = decoder.decode(r.report(i), 1, state); fate != ReportFate::accepted) {
                allowed.add(Difference::not_as_declared);
                if (fate == ReportFate::too_long) break;  // the kernel took what it declares of it: the two are apart from here
                EXPECT_EQ(by_report[i], Changes{}) << name << " report " << i;
                continue;
            }
            ++compared;
            // A relative value is of this report alone.
            const auto carried = decoder.controls_in(static_cast<std::uint8_t>(r.report(i)[0]));
            for (std::size_t c = 0; c < d.controls.size(); ++c)
                if (d.controls[c].relative && std::find(carried.begin(), carried.end(), c) == carried.end()) state.value[c] = 0;
            const Changes mine = changes(d, before, state, last, allowed);
            EXPECT_EQ(mine.axes, by_report[i].axes) << name << " report " << i;
            EXPECT_EQ(mine.pressed, by_report[i].pressed) << name << " report " << i;
            EXPECT_EQ(mine.released, by_report[i].released) << name << " report " << i;
        }
    }
    std::printf("%zu reports of %zu devices compared\n", compared, events.size());
    allowed.print();
    EXPECT_EQ(allowed.times(Difference::not_as_declared), 6U);
    for (const Difference d : {Difference::null_state, Difference::hat_outside, Difference::no_code})
        EXPECT_EQ(allowed.times(d), 0U) << "these recordings need none of them";
    EXPECT_GE(compared, 44U);
}

}  // namespace
}  // namespace surefoot::input
