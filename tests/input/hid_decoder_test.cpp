// Reports to values, worked out by hand; what is refused changes nothing; no allocation.
#include "rt/threads/guard.hpp"
#include "tests/input/hid_test.hpp"

namespace surefoot::input {
namespace {

TEST(HidDecoder, BitsAcrossBytesAndSigns) {
    const auto b = hex("ab cd ef 01 23 45 67");
    EXPECT_EQ(extract_bits(b, 0, 8), 0xabU);
    EXPECT_EQ(extract_bits(b, 4, 8), 0xdaU);
    EXPECT_EQ(extract_bits(b, 7, 32), static_cast<std::uint32_t>((0x4523'01ef'cdabULL >> 7U) & 0xffffffffULL));
    EXPECT_EQ(extract_bits(b, 55, 1), 0U);
    EXPECT_EQ(extract_bits(b, 54, 2), 1U);
    EXPECT_EQ(sign_extend(0x7ff, 11), -1);
    EXPECT_EQ(sign_extend(0x400, 11), -1024);
    EXPECT_EQ(sign_extend(0x80000000U, 32), INT32_MIN);
    EXPECT_EQ(sign_extend(1, 1), -1);
}

TEST(HidDecoder, SpaceNavigatorMovesFullRange) {
    Live d(device("spacenavigator-like"));
    EXPECT_EQ(d["x"], std::nullopt) << "never seen";
    EXPECT_EQ(d.feed("01 5e 01 a2 fe 00 00"), ReportFate::accepted);
    EXPECT_EQ(d["x"], 350);
    EXPECT_EQ(d["y"], -350);
    EXPECT_EQ(d["rx"], std::nullopt) << "its own report has not come";
    EXPECT_FALSE(d.state.carried_over[0]);
    d.feed("02 01 00 ff ff 10 00");
    EXPECT_EQ(d["ry"], -1);
    EXPECT_EQ(d["x"], 350) << "held";
    EXPECT_TRUE(d.state.carried_over[0]) << "by another report";
    d.feed("01 00 10 00 80 ff 7f");
    EXPECT_EQ(d["x"], 350) << "clamped";
    EXPECT_EQ(d["y"], -350);
    d.feed("03 02 00");
    EXPECT_EQ(d["button-1"], 0);
    EXPECT_EQ(d["button-2"], 1);
    EXPECT_EQ(d.state.reports, 4U);
    EXPECT_EQ(d.state.stamp_ns, 4);
}

TEST(HidDecoder, AnArraysIndexCountsFromItsLogicalMinimumZeroToo) {
    // Buttons 1 to 8 as an array of one byte, 0 to 7 (HID 1.11, 6.2.2.5): what is out of range is nothing pressed.
    Layout layout;
    ASSERT_FALSE(parse_descriptor(hex("05 01 09 04 a1 01 05 09 19 01 29 08 15 00 25 07 75 08 95 01 81 00 c0"), layout));
    const HidDevice pad = describe_device(std::move(layout), {});
    ReportDecoder decoder(pad);
    DeviceState state;
    const auto pressed = [&](unsigned index) {
        const std::byte report[] = {static_cast<std::byte>(index)};
        EXPECT_EQ(decoder.decode(report, 1, state), ReportFate::accepted);
        std::string names;
        for (std::size_t c = 0; c < pad.controls.size(); ++c)
            if (state.value[c] != 0) names += pad.controls[c].name + " ";
        return names;
    };
    EXPECT_EQ(pressed(0), "button-1 ");
    EXPECT_EQ(pressed(7), "button-8 ");
    EXPECT_EQ(pressed(8), "");
}

TEST(HidDecoder, ShortLongAndUndeclaredReportsChangeNothing) {
    Live d(device("spacenavigator-like"));
    d.feed("01 5e 01 a2 fe 00 00");
    const DeviceState before = d.state;
    EXPECT_EQ(d.feed("01 00 00 00 00 00"), ReportFate::too_short);
    EXPECT_EQ(d.feed(""), ReportFate::too_short);
    EXPECT_EQ(d.feed("01 00 00 00 00 00 00 00"), ReportFate::too_long);
    EXPECT_EQ(d.feed("09 00 00"), ReportFate::undeclared);
    EXPECT_EQ(d.feed("04 00"), ReportFate::undeclared) << "declared as output only";
    EXPECT_EQ(d.feed("00 00"), ReportFate::undeclared);
    EXPECT_EQ(d.state.value, before.value);
    EXPECT_EQ(d.state.has_value, before.has_value);
    EXPECT_EQ(d.state.reports, before.reports);
    EXPECT_EQ(d.state.stamp_ns, before.stamp_ns);
    EXPECT_EQ(d.decoder.counts().accepted, 1U);
    EXPECT_EQ(d.decoder.counts().too_short, 2U);
    EXPECT_EQ(d.decoder.counts().too_long, 1U);
    EXPECT_EQ(d.decoder.counts().undeclared, 3U);
}

TEST(HidDecoder, HatsOfEveryRange) {
    Live ps(device("dualshock4-like"));
    const std::string rest(54 * 3, ' ');
    std::string tail;
    for (int i = 0; i < 54; ++i) tail += " 00";
    ps.feed("01 80 80 80 80 08 00 00 00 00" + tail);
    EXPECT_EQ(ps["hat"], std::nullopt);
    ps.feed("01 80 80 80 80 02 00 00 00 00" + tail);
    EXPECT_EQ(ps["hat"], 2);
    Live h(device("hat-240"));  // 0..239 in 16 bits; 1..8; 1..3
    h.feed("80 00 00 00");
    EXPECT_EQ(h["hat"], 0);
    EXPECT_EQ(h["hat-2"], std::nullopt) << "0 of 1..8 is the centre, not north";
    h.feed("80 1d 00 01");
    EXPECT_EQ(h["hat"], 0);
    EXPECT_EQ(h["hat-2"], 0);
    h.feed("80 1e 00 18");
    EXPECT_EQ(h["hat"], 1);
    EXPECT_EQ(h["hat-2"], 7);
    h.feed("80 ef 00 09");
    EXPECT_EQ(h["hat"], 7);
    EXPECT_EQ(h["hat-2"], std::nullopt) << "outside without the null flag is the centre as well";
    h.feed("80 f0 00 00");
    EXPECT_EQ(h["hat"], std::nullopt);
}

TEST(HidDecoder, TenAndSixteenBitTriggers) {
    Live d(device("xbox-bluetooth-like"));
    d.feed("01 00 00 ff ff 00 80 00 80 00 00 ff 03 01 01 40 01");
    EXPECT_EQ(d["x"], 0);
    EXPECT_EQ(d["y"], 65535);
    EXPECT_EQ(d["brake"], 0);
    EXPECT_EQ(d["accelerator"], 1023);
    EXPECT_EQ(d["hat"], 0);
    EXPECT_EQ(d["button-1"], 1);
    EXPECT_EQ(d["button-15"], 1);
    EXPECT_EQ(d["consumer-224"], 1);
    EXPECT_EQ(d["consumer-223"], std::nullopt);
    d.feed("02 01");
    EXPECT_EQ(d["consumer-223"], 1);
}

TEST(HidDecoder, ArraysAreListsOfWhatIsPressed) {
    Live d(device("six-axis-array-buttons"));
    d.feed("1c 01 00 05 00 00 00 00 00 00 00 00 00");
    EXPECT_EQ(d["button-1"], 1);
    EXPECT_EQ(d["button-5"], 1);
    d.feed("1c 05 00 7f 00 80 00 00 00 00 00 00 00");
    EXPECT_EQ(d["button-1"], 0) << "absence is release";
    EXPECT_EQ(d["button-5"], 1);
    EXPECT_EQ(d["button-127"], 1);
    Live k(device("boot-keyboard"));
    k.feed("02 00 04 05 00 00 00 00");
    EXPECT_EQ(k["key-e1"], 1);
    EXPECT_EQ(k["key-04"], 1);
    k.feed("00 00 01 01 01 01 01 01");
    EXPECT_EQ(k["key-04"], 1) << "a roll-over leaves the array as it was";
    EXPECT_EQ(k["key-e1"], 0) << "and only the array";
    k.feed("00 00 00 00 00 00 00 00");
    EXPECT_EQ(k["key-04"], 0);
}

TEST(HidDecoder, NullStatesHaveNoValueAndOthersAreClamped) {
    Live d(describe_device(layout_of(hex("05 01 09 04 a1 01 15 0a 25 64 75 08 95 01 09 30 81 42 09 31 81 02 c0")), {}));
    d.feed("32 05");
    EXPECT_EQ(d["x"], 50);
    EXPECT_EQ(d["y"], 10);
    d.feed("c8 c8");
    EXPECT_EQ(d["x"], std::nullopt);
    EXPECT_EQ(d["y"], 100);
}

TEST(HidDecoder, DoesNotAllocate) {
    if (!rt::guard_active()) GTEST_SKIP() << "allocations are not counted under sanitizers";
    for (const char* name : {"dualshock4-like", "boot-keyboard", "six-axis-array-buttons", "xbox-bluetooth-like"}) {
        const Recording r = recorded(name);
        Live d(device_of(r));
        const auto before = rt::guard_counters().own_violations;
        {
            const rt::OwnScope scope;
            for (std::size_t i = 0; i < r.reports.size(); ++i) (void)d.decoder.decode(r.report(i), 1, d.state);
        }
        EXPECT_EQ(rt::guard_counters().own_violations, before) << name;
    }
}

TEST(HidDecoder, FullWidthValues) {
    Live d(device("wide-values"));
    EXPECT_EQ(d.feed("00 00 00 80 ff ff ff 7f 00 00 00 80 00 04 00"), ReportFate::accepted);
    EXPECT_EQ(d["x"], INT32_MIN);
    EXPECT_EQ(d["y"], INT32_MAX);
    EXPECT_EQ(d["rx"], -1024);
}

}  // namespace
}  // namespace surefoot::input
