// Descriptors of real devices: layout against the kernel's dump, class and controls against the index.
#include "tests/input/hid_corpus.hpp"

#include <algorithm>
#include <iostream>

#include "tests/input/kernel_dump.hpp"

namespace surefoot::input {
namespace {

namespace fs = std::filesystem;

DumpedNumbers as_dumped(const Field& f) {
    const bool range = f.logical_min != f.logical_max, physical = f.physical_min != f.physical_max;
    return {std::int64_t(f.kind),
            f.report_id,
            f.bit_offset,
            f.size,
            f.count,
            range ? f.logical_min : 0,
            range ? f.logical_max : 0,
            physical ? f.physical_min : 0,
            physical ? f.physical_max : 0,
            f.exponent,
            f.flags & 0x1ff};
}

/// The kernel prints names, not numbers. A name and its number must stand for each other everywhere, and a name that ends in
/// hexadecimal ("Button.000a", "ff00.0021") must end in its number.
class NameTable {
public:
    void expect(std::uint32_t number, const std::string& name) {
        EXPECT_EQ(number_of_.try_emplace(name, number).first->second, number) << name;
        EXPECT_EQ(name_of_.try_emplace(number, name).first->second, name) << number;
        if (const auto low = hex_of(name, name.size() - std::min<std::size_t>(name.size(), 4))) {
            EXPECT_EQ(*low, number & 0xffffU) << name;
        }
        if (const auto page = hex_of(name, 0); page && name.size() == 9) {
            EXPECT_EQ(*page, number >> 16U) << name;
        }
    }
    [[nodiscard]] std::size_t size() const { return name_of_.size(); }

private:
    static std::optional<std::uint32_t> hex_of(const std::string& name, std::size_t from) {
        if (name.size() < from + 4) return std::nullopt;
        const std::string digits = name.substr(from, 4);
        if (digits.find_first_not_of("0123456789abcdef") != std::string::npos) return std::nullopt;
        return static_cast<std::uint32_t>(std::stoul(digits, nullptr, 16));
    }
    std::map<std::string, std::uint32_t> number_of_;
    std::map<std::uint32_t, std::string> name_of_;
};

void expect_field(const Layout& l, const Field& f, const DumpedField& dumped, NameTable& usages, NameTable& units) {
    EXPECT_TRUE(as_dumped(f) == dumped.numbers);
    ASSERT_EQ(f.usages, dumped.usages.size());
    for (std::uint32_t k = 0; k < f.usages; ++k) usages.expect(l.usage_of(f, k), dumped.usages[k]);
    // A collection of usage 0 is printed like none.
    const auto expect_collection = [&](std::uint8_t type, const std::string& name) {
        const std::uint32_t usage = l.enclosing(f.collection, type);
        EXPECT_EQ(usage == 0, name.empty()) << name;
        if (usage != 0 && !name.empty()) usages.expect(usage, name);
    };
    expect_collection(collection_type::physical, dumped.physical);
    expect_collection(collection_type::logical, dumped.logical);
    expect_collection(collection_type::application, dumped.application);
    EXPECT_EQ(f.unit == 0, dumped.unit.empty()) << dumped.unit;
    if (!dumped.unit.empty()) units.expect(f.unit, dumped.unit);
}

TEST_F(HidCorpus, LayoutsEqualTheKernelsDumps) {
    std::size_t compared = 0, fields = 0;
    NameTable usages, units;
    for (const CorpusDevice& device : devices) {
        SCOPED_TRACE(device.slug);
        const auto bytes = device.descriptor();
        EXPECT_EQ(bytes.size(), device.descriptor_bytes);
        const KernelDump dump = read_kernel_dump(device.folder / "kernel-rdesc.txt");
        const Layout l = layout_of(bytes);
        const auto order = l.fields_by_report();
        ASSERT_GT(order.size(), 0U);
        ASSERT_EQ(order.size(), dump.fields.size());
        for (std::size_t i = 0; i < order.size(); ++i, ++fields) {
            SCOPED_TRACE("field " + std::to_string(i) + " at byte " + std::to_string(l.fields[order[i]].offset));
            expect_field(l, l.fields[order[i]], dump.fields[i], usages, units);
        }
        ++compared;
    }
    EXPECT_EQ(compared, devices.size());
    EXPECT_GT(units.size(), 1U);
    std::cout << compared << " devices, " << fields << " fields, " << usages.size() << " usages, " << units.size() << " units\n";
}

TEST_F(HidCorpus, TheIndexNamesEveryFolder) {
    std::size_t folders = 0;
    for (const auto& entry : fs::directory_iterator(root)) {
        if (!fs::exists(entry.path() / "rdesc.bin")) continue;
        ++folders;
        EXPECT_TRUE(std::any_of(devices.begin(), devices.end(), [&](const auto& d) { return d.folder == entry.path(); }))
            << entry.path() << " is not in the index";
    }
    EXPECT_EQ(folders, devices.size());
}

DeviceClass class_of(const std::string& expected) {
    if (expected == "navigation") return DeviceClass::navigation;
    if (expected == "map-as-trackball") return DeviceClass::trackball;
    if (expected == "buttons-only") return DeviceClass::buttons;
    EXPECT_TRUE(expected == "reject" || expected == "reject-or-quirk") << expected;
    return DeviceClass::reject;
}

/// "X16r": usage, bits and the descriptor's own flag, as the index writes an axis; empty for what the index does not list.
std::string as_indexed(const HidDevice& d, std::size_t control) {
    static const std::map<std::uint32_t, const char*> listed = {
        {0x10030, "X"},      {0x10031, "Y"},     {0x10032, "Z"},   {0x10033, "Rx"},    {0x10034, "Ry"},   {0x10035, "Rz"},
        {0x10036, "Slider"}, {0x10038, "Wheel"}, {0x10039, "Hat"}, {0x200c4, "Accel"}, {0x200c5, "Brake"}};
    const ControlInfo& c = d.controls[control];
    const Field& f = d.layout.fields[d.sources[control].field];
    const auto found = listed.find(full_usage(c.usage_page, c.usage));
    return found == listed.end() ? "" : found->second + std::to_string(f.size) + (f.relative() ? "r" : "");
}

TEST_F(HidCorpus, ClassesAndControlsAreThoseOfTheIndex) {
    // Axes that the index leaves out: it lists the pages Generic Desktop and Simulation.
    std::map<std::string, std::string> unlisted;
    std::size_t axes = 0, buttons = 0, navigating = 0;
    for (const CorpusDevice& device : devices) {
        SCOPED_TRACE(device.slug);
        const HidDevice d = device.described();
        EXPECT_STREQ(class_name(d.device_class), class_name(class_of(device.expected_class))) << d.reason;
        std::vector<std::string> expected, found;
        std::istringstream names(device.axes == "-" ? "" : device.axes);
        for (std::string name; std::getline(names, name, ',');) expected.push_back(name);
        std::size_t pressed = 0;
        for (std::size_t i = 0; i < d.controls.size(); ++i) {
            const ControlInfo& c = d.controls[i];
            if (c.kind == ControlKind::button) {
                pressed += c.usage_page == 9;
            } else if (const std::string name = as_indexed(d, i); name.empty()) {
                unlisted[device.slug] += c.name + " ";
            } else {
                found.push_back(name);
            }
        }
        std::sort(expected.begin(), expected.end());
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, expected);
        EXPECT_EQ(pressed, device.buttons);
        axes += found.size();
        buttons += pressed;
        navigating += d.device_class == DeviceClass::navigation;
    }
    EXPECT_EQ(unlisted, (std::map<std::string, std::string>{{"trackball-elecom-huge2", "pan "}, {"x52", "move-side move-up "}}));
    std::cout << axes << " axes and hats, " << buttons << " buttons, " << navigating << " devices that navigate\n";
}

}  // namespace
}  // namespace surefoot::input
