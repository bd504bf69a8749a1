// Layouts derived by hand from HID 1.11 and the rules of input/hid/descriptor.hpp, each rule with its smallest descriptor.
#include <fmt/format.h>

#include "tests/input/hid_test.hpp"

namespace surefoot::input {
namespace {

/// "input 1 @16 8x3 0..255 f2: 10030 10031": kind, id, bit offset, size x count, logical range, flags: usages.
std::string line(const Layout& l, const Field& f) {
    std::string text = fmt::format("{} {} @{} {}x{} {}..{} f{:x}:",
                                   f.kind == ReportKind::input    ? "in"
                                   : f.kind == ReportKind::output ? "out"
                                                                  : "feature",
                                   f.report_id, f.bit_offset, f.size, f.count, f.logical_min, f.logical_max, f.flags);
    for (std::uint32_t k = 0; k < std::min(f.usages, 6U); ++k) text += fmt::format(" {:x}", l.usage_of(f, k));
    return text;
}

std::vector<std::string> lines(std::string_view descriptor) {
    const Layout l = layout_of(hex(descriptor));
    std::vector<std::string> all;
    for (const auto i : l.fields_by_report()) all.push_back(line(l, l.fields[i]));
    return all;
}
using FieldLines = std::vector<std::string>;

TEST(HidDescriptor, BootMouseOfTheSpecification) {
    EXPECT_EQ(lines("05 01 09 02 a1 01 09 01 a1 00 05 09 19 01 29 03 15 00 25 01 95 03 75 01 81 02 95 01 75 05 81 01"
                    "05 01 09 30 09 31 15 81 25 7f 75 08 95 02 81 06 c0 c0"),
              (FieldLines{"in 0 @0 1x3 0..1 f2: 90001 90002 90003", "in 0 @8 8x2 -127..127 f6: 10030 10031"}));
}

TEST(HidDescriptor, KeyboardArrayAndOutput) {
    const Layout l = layout_of(recorded("boot-keyboard").descriptor);
    ASSERT_EQ(l.fields.size(), 3U);
    const auto order = l.fields_by_report();
    EXPECT_EQ(line(l, l.fields[order[0]]), "in 0 @0 1x8 0..1 f2: 700e0 700e1 700e2 700e3 700e4 700e5");
    EXPECT_EQ(line(l, l.fields[order[1]]), "in 0 @16 8x6 0..101 f0: 70000 70001 70002 70003 70004 70005");
    EXPECT_EQ(l.fields[order[1]].usages, 102U);
    EXPECT_EQ(line(l, l.fields[order[2]]), "out 0 @0 1x5 0..1 f2: 80001 80002 80003 80004 80005");
    EXPECT_EQ(l.find(ReportKind::input, 0)->bits, 64U);
    EXPECT_EQ(l.find(ReportKind::output, 0)->bits, 8U);
}

TEST(HidDescriptor, MaximumIsSignedOnlyBelowAZeroMinimum) {
    EXPECT_EQ(lines("05 01 09 04 a1 01 75 08 95 01 15 00 25 ff 09 30 81 02 15 81 25 ff 09 31 81 02"
                    "15 00 27 ff ff 00 00 09 32 81 02 c0"),
              (FieldLines{"in 0 @0 8x1 0..255 f2: 10030", "in 0 @8 8x1 -127..-1 f2: 10031", "in 0 @16 8x1 0..65535 f2: 10032"}));
}

TEST(HidDescriptor, UsagePageCountsAtTheMainItem) {
    // The page after the last usage moves it; usages that have another page from before a first page change stay.
    EXPECT_EQ(lines("05 01 09 04 a1 01 75 08 95 02 25 7f 09 30 05 02 09 c4 81 02 09 bb 05 09 95 01 81 02 c0"),
              (FieldLines{"in 0 @0 8x2 0..127 f2: 10030 200c4", "in 0 @16 8x1 0..127 f2: 900bb"}));
}

TEST(HidDescriptor, FourByteUsagesCarryTheirPage) {
    const auto l = layout_of(recorded("four-byte-usages").descriptor);
    EXPECT_EQ(line(l, l.fields[0]), "in 0 @0 8x3 0..255 f2: 10030 10031 200c5");
    EXPECT_EQ(line(l, l.fields[1]), "in 0 @24 1x8 0..1 f2: 90001 90002 90003 90004 90005 90006");
}

TEST(HidDescriptor, LastUsageRepeatsAndRangesMixWithSingleUsages) {
    EXPECT_EQ(lines("05 09 09 04 a1 01 25 01 75 01 95 06 09 01 19 05 29 06 09 0a 81 02 c0"),
              (FieldLines{"in 0 @0 1x6 0..1 f2: 90001 90005 90006 9000a 9000a 9000a"}));
}

TEST(HidDescriptor, PaddingTakesInheritedSizeAndCount) {
    const auto l = layout_of(recorded("stick-14-bit").descriptor);
    const auto order = l.fields_by_report();
    std::vector<std::uint32_t> offsets;
    for (const auto i : order) offsets.push_back(l.fields[i].bit_offset);
    EXPECT_EQ(offsets, (std::vector<std::uint32_t>{0, 16, 24, 40, 56, 64}));  // the bare 81 01 behind the hat takes 4 bits
    EXPECT_EQ(l.find(ReportKind::input, 0)->bytes(), 9U);
}

TEST(HidDescriptor, ReportIdsAreStreamsOfTheirKindAndContinue) {
    const auto l = layout_of(recorded("ids-in-two-collections").descriptor);
    FieldLines all;
    for (const auto i : l.fields_by_report()) all.push_back(line(l, l.fields[i]));
    EXPECT_EQ(all, (FieldLines{"in 1 @0 8x1 -127..127 f2: 10030", "in 1 @8 8x1 -127..127 f2: 10032",
                               "in 2 @0 8x1 -127..127 f2: 10031", "feature 1 @0 8x1 -127..127 f2: 10033"}));
    EXPECT_TRUE(l.numbered[0]);
    EXPECT_NE(l.find(ReportKind::output, 3), nullptr) << "a report of padding alone is still declared";
    EXPECT_EQ(l.find(ReportKind::input, 3), nullptr);
}

TEST(HidDescriptor, PushAndPopRestoreEverythingWithTheReportId) {
    const auto l = layout_of(recorded("push-pop").descriptor);
    ASSERT_EQ(l.fields.size(), 2U);
    EXPECT_EQ(line(l, l.fields[0]), "in 2 @0 8x1 -127..127 f6: 10030");
    EXPECT_EQ(line(l, l.fields[1]), "in 1 @0 8x1 0..255 f2: 10031");
}

TEST(HidDescriptor, OfDelimitedUsagesTheFirstSetCounts) {
    const auto l = layout_of(recorded("delimiters").descriptor);
    EXPECT_EQ(line(l, l.fields[0]), "in 0 @0 8x3 -127..127 f2: 10030 10031 10031") << "behind the second set nothing counts";
}

TEST(HidDescriptor, UnitExponentIsANibbleOrANumber) {
    const auto l = layout_of(recorded("physical-units").descriptor);
    ASSERT_EQ(l.fields.size(), 4U);
    EXPECT_EQ(l.fields[0].exponent, -2);
    EXPECT_EQ(l.fields[0].physical_min, -180);
    EXPECT_EQ(l.fields[0].physical_max, 180);
    EXPECT_EQ(l.fields[1].exponent, -1);
    EXPECT_EQ(l.fields[2].exponent, 2);
    EXPECT_EQ(l.fields[3].exponent, -2);
}

TEST(HidDescriptor, CollectionsKeepTheirNesting) {
    const auto l = layout_of(recorded("nested-applications").descriptor);
    ASSERT_EQ(l.collections.size(), 4U);
    EXPECT_EQ(l.collections[1].parent, 0U);
    EXPECT_EQ(l.collections[2].parent, 0U);
    EXPECT_EQ(l.collections[2].usage, 0x00010005U);
    EXPECT_EQ(l.collections[3].level, 1U);
    EXPECT_EQ(l.enclosing(1, collection_type::application), 0x00010004U);
}

TEST(HidDescriptor, BeyondTheFieldLimitBitsAreStillCounted) {
    std::string text = "05 01 09 04 a1 01 75 01 95 01 ";
    for (int i = 0; i < 300; ++i) text += "09 30 81 02 ";
    const auto l = layout_of(hex(text + "c0"));
    EXPECT_EQ(l.fields.size(), 256U);
    EXPECT_EQ(l.find(ReportKind::input, 0)->bits, 300U);
    EXPECT_EQ(l.note_count, 44U);
    EXPECT_EQ(l.notes.size(), max_notes);
}

TEST(HidDescriptor, ARangeBeyond31BitsIsCounted) {
    const auto l = layout_of(hex("05 01 09 04 a1 01 09 30 15 00 27 ff ff ff ff 75 20 95 01 81 02 09 31 27 ff ff ff 7f 81 02 c0"));
    ASSERT_EQ(l.notes.size(), 1U);
    EXPECT_EQ(l.notes[0].offset, 19U);
    EXPECT_NE(l.notes[0].what.find("4294967295"), std::string::npos) << l.notes[0].what;
}

}  // namespace
}  // namespace surefoot::input
