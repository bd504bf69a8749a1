// Malformed descriptors beside the real devices: each with the kernel's verdict, and none steers that should not.
#include <algorithm>
#include <array>
#include <iostream>

#include "tests/fuzz/targets.hpp"
#include "tests/input/hid_corpus.hpp"

namespace surefoot::input {
namespace {

/// What is made of one descriptor. `refused_at` is the byte of the item at fault; accepted ones have -1.
struct MalformedRow {
    std::string_view name;
    int refused_at = -1;
    DeviceClass device_class = DeviceClass::reject;
    std::size_t axes = 0, hats = 0, buttons = 0;
    std::string_view inputs;  ///< "1:4 2:2": input reports by id, with their bytes; id 0 is none
    std::string_view why;
};

constexpr std::array<MalformedRow, corpus_seeds> malformed_rows = {{
    {"9000-fields", -1, DeviceClass::navigation, 256, 0, 0, "0:1125", "axes of one bit; those beyond 256 are counted, not kept"},
    {"all-zero-512", -1, DeviceClass::reject, 0, 0, 0, "", "unknown main items are passed over; nothing is left"},
    {"array-of-axes", -1, DeviceClass::reject, 0, 0, 0, "0:2", "an array lists what is pressed; an axis cannot be pressed"},
    {"const-only", -1, DeviceClass::reject, 0, 0, 0, "0:8", "padding"},
    {"delimiter-unbalanced", 6, DeviceClass::reject, 0, 0, 0, "", "closes a delimiter that was never opened"},
    {"duplicate-usage-x4", -1, DeviceClass::navigation, 5, 0, 0, "0:5", "four X of their own names and a Y"},
    {"feature-only", -1, DeviceClass::reject, 0, 0, 0, "", "a feature is asked for, not reported"},
    {"hat-physical-rad", -1, DeviceClass::buttons, 0, 1, 0, "0:1", "a hat's unit does not matter: it has eight steps"},
    {"input-no-data", -1, DeviceClass::reject, 0, 0, 0, "0:2", "an Input item without flags is an array"},
    {"nested-app-x8", -1, DeviceClass::navigation, 2, 0, 0, "0:2", "joysticks in joysticks"},
    {"push-restores-report-id", -1, DeviceClass::navigation, 6, 0, 0, "1:4 2:2", "the third pair is of report 1 again"},
    {"report-id-reused-kinds", -1, DeviceClass::navigation, 2, 0, 0, "1:2", "an id is of its kind"},
    {"size-31-unaligned", -1, DeviceClass::navigation, 1, 0, 1, "0:4", "31 bits behind one bit"},
    {"size-32-unsigned-full", -1, DeviceClass::reject, 0, 0, 0, "0:4", "a maximum of 2^32-1 is below its minimum in 32 bits"},
    {"size-neg1", 12, DeviceClass::reject, 0, 0, 0, "", "elements of 2^32-1 bits"},
    {"truncated-after-prefix", 4, DeviceClass::reject, 0, 0, 0, "", "ends behind an item's first byte"},
    {"two-gb-report", 14, DeviceClass::reject, 0, 0, 0, "", "2^31-1 elements"},
    {"usage-ext-other-page", -1, DeviceClass::navigation, 1, 0, 0, "0:1", "a usage of four bytes has its own page"},
    {"usage-page-after-usage", -1, DeviceClass::navigation, 1, 0, 0, "0:1", "the page behind a usage holds for it"},
}};

void expect_device(const MalformedRow& row, const HidDevice& d) {
    EXPECT_EQ(row.refused_at, -1) << "accepted";
    EXPECT_STREQ(class_name(d.device_class), class_name(row.device_class)) << d.reason;
    const auto count = [&](ControlKind kind) {
        return static_cast<std::size_t>(
            std::count_if(d.controls.begin(), d.controls.end(), [&](const ControlInfo& c) { return c.kind == kind; }));
    };
    std::string inputs;
    for (const Report& r : d.layout.reports)
        if (r.kind == ReportKind::input)
            inputs += (inputs.empty() ? "" : " ") + std::to_string(r.id) + ":" + std::to_string(r.bytes());
    EXPECT_EQ(inputs, row.inputs);
    EXPECT_EQ(count(ControlKind::axis), row.axes);
    EXPECT_EQ(count(ControlKind::hat), row.hats);
    EXPECT_EQ(count(ControlKind::button), row.buttons);
}

/// Reports of all zeros, all ones and both bits in turn, of every declared id: values stay in their ranges, or the target aborts.
void feed_reports(const std::vector<std::byte>& descriptor, const Layout& layout) {
    std::vector<std::byte> bytes{static_cast<std::byte>(descriptor.size() & 0xffU),
                                 static_cast<std::byte>(descriptor.size() >> 8U)};
    bytes.insert(bytes.end(), descriptor.begin(), descriptor.end());
    for (const Report& r : layout.reports) {
        if (r.kind != ReportKind::input) continue;
        for (const unsigned pattern : {0x00U, 0xffU, 0x55U, 0xaaU, 0x80U, 0x7fU}) {
            if (layout.numbered[0]) bytes.push_back(static_cast<std::byte>(r.id));
            bytes.insert(bytes.end(), r.bytes(), static_cast<std::byte>(pattern));
        }
    }
    fuzz::reports(bytes);
}

TEST_F(HidCorpus, MalformedDescriptorsHaveTheKernelsVerdicts) {
    const auto verdicts = read_table(root / "malformed" / "verdicts.tsv", 4);
    std::size_t accepted = 0, refused = 0, files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(root / "malformed")) files += entry.path().extension() == ".bin";
    EXPECT_EQ(files, verdicts.size());
    for (const auto& verdict : verdicts) {
        SCOPED_TRACE(verdict[0]);
        const auto bytes = read_file(root / "malformed" / (verdict[0] + ".bin"), max_descriptor_bytes);
        ASSERT_TRUE(bytes.ok());
        EXPECT_EQ(bytes->size(), std::stoul(verdict[1]));
        const auto row =
            std::find_if(malformed_rows.begin(), malformed_rows.end(), [&](const auto& r) { return r.name == verdict[0]; });
        ASSERT_TRUE(row != malformed_rows.end()) << "nothing is said here of what should come of it";
        fuzz::descriptor(*bytes);
        Layout layout;
        const auto refusal = parse_descriptor(*bytes, layout);
        EXPECT_EQ(refusal ? "rejected" : "accepted", verdict[2]) << (refusal ? refusal->what : "");
        if (refusal) {
            EXPECT_EQ(static_cast<int>(refusal->offset), row->refused_at) << refusal->what;
            ++refused;
            continue;
        }
        feed_reports(*bytes, layout);
        const HidDevice d = describe_device(std::move(layout), {});
        expect_device(*row, d);
        // What gives the kernel nothing gives nothing here.
        EXPECT_TRUE(verdict[3] != "0" || d.controls.empty());
        ++accepted;
    }
    EXPECT_EQ(accepted + refused, verdicts.size());
    EXPECT_GE(verdicts.size(), corpus_seeds);
    EXPECT_GT(accepted, 0U);
    EXPECT_GT(refused, 0U);
    std::cout << accepted << " accepted, " << refused << " refused, as by the kernel\n";
}

}  // namespace
}  // namespace surefoot::input
