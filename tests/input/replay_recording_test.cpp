// Recordings: read, written, read again to the same bits; every fault with its line.
#include "input/replay/recording.hpp"

#include "rt/base/random.hpp"
#include "tests/input/hid_test.hpp"

namespace surefoot::input {
namespace {

TEST(Recording, ReadsHidRecordersLines) {
    auto r = parse_recording(
        "# by hand\nD: 0\nR: 3 05 01 c0\nN: A Stick, with  spaces \nP: usb-1\nI: 3 046d C626\nE: 000012.345678 2 01 ff\n\n"
        "E: 13.5 0\nE: 14 1 A # pressed\r\nS: ignored\n",
        "r");
    ASSERT_TRUE(r.ok()) << r.error().text();
    EXPECT_EQ(r->descriptor, hex("05 01 c0"));
    EXPECT_EQ(r->name, "A Stick, with  spaces");
    EXPECT_EQ(r->bus, 3);
    EXPECT_EQ(r->product, 0xc626);
    ASSERT_EQ(r->reports.size(), 3U);
    EXPECT_EQ(r->reports[0].time_us, 12'345'678);
    EXPECT_EQ(r->reports[0].line, 7U);
    EXPECT_EQ(r->reports[1].time_us, 13'500'000);
    EXPECT_EQ(r->report(1).size(), 0U);
    EXPECT_EQ(r->report(2)[0], std::byte{0x0a});
}

TEST(Recording, OfSeveralDevicesTheFirstIsRead) {
    auto r = parse_recording("D: 2\nR: 1 c0\nE: 1.0 1 02\nD: 3\nR: 1 b4\nE: 2.0 1 03\nD: 2\nE: 3.0 1 04\n", "r");
    ASSERT_TRUE(r.ok());
    EXPECT_EQ(r->reports.size(), 2U);
    EXPECT_EQ(r->other_devices, 1U);
    EXPECT_EQ(r->descriptor, hex("c0"));
}

TEST(Recording, FaultsNameTheirLine) {
    const std::pair<const char*, int> faults[] = {
        {"E: 1.0 2 01\n", 1},
        {"\n\nE: 1.0 1 01 02\n", 3},
        {"E: x 1 01\n", 1},
        {"E: 1.x 1 01\n", 1},
        {"E: 1. 1 01\n", 1},
        {"E: 1.0 1 1ff\n", 1},
        {"E: 1.0 1 zz\n", 1},
        {"E: 1.0 -1\n", 1},
        {"E: 1.0 16385 00\n", 1},
        {"E: -1.0 1 00\n", 1},
        {"R: 2 00\n", 1},
        {"R: 1 c0\nR: 1 c0\n", 2},
        {"I: 3 046d\n", 1},
        {"I: 3 046d 12345\n", 1},
        {"D: x\n", 1},
        {"hello\n", 1},
        {"# ok\nbinary \x01\n", 2},
        {"E: 99999999999999999999.0 0\n", 1},
        {"E: 1.1234567891 0\n", 1},
        {"E:\n", 1},
    };
    for (const auto& [text, line] : faults) {
        auto r = parse_recording(text, "r");
        ASSERT_FALSE(r.ok()) << text;
        EXPECT_EQ(r.error().place, "r: line " + std::to_string(line)) << text;
        EXPECT_FALSE(r.error().remedy.empty());
    }
}

TEST(Recording, RoundTripIsBitExact) {
    Random random(3);
    Recording r;
    r.name = "A stick";
    r.place = "here";
    r.bus = 5;
    r.vendor = 0x46d;
    r.product = 0xffff;
    for (int i = 0; i < 77; ++i) r.descriptor.push_back(static_cast<std::byte>(random.below(256)));
    for (int i = 0; i < 2000; ++i) {
        std::vector<std::byte> report(random.below(70));
        for (auto& b : report) b = static_cast<std::byte>(random.below(256));
        r.add(static_cast<std::int64_t>(random.next() >> 12U) % 4'000'000'000'000, report);
    }
    const std::string text = write_recording(r);
    auto again = parse_recording(text, "again");
    ASSERT_TRUE(again.ok()) << again.error().text();
    EXPECT_EQ(again->descriptor, r.descriptor);
    EXPECT_EQ(again->bytes, r.bytes);
    EXPECT_EQ(again->name, r.name);
    ASSERT_EQ(again->reports.size(), r.reports.size());
    for (std::size_t i = 0; i < r.reports.size(); ++i) EXPECT_EQ(again->reports[i].time_us, r.reports[i].time_us);
    EXPECT_EQ(write_recording(*again), text);
}

TEST(Recording, OnFilesToo) {
    for (const auto& entry : std::filesystem::directory_iterator(device_folder())) {
        if (entry.path().extension() != ".hid") continue;
        auto r = read_recording(entry.path());
        ASSERT_TRUE(r.ok()) << r.error().text();
        auto again = parse_recording(write_recording(*r), "again");
        ASSERT_TRUE(again.ok());
        EXPECT_EQ(again->bytes, r->bytes);
    }
    EXPECT_FALSE(read_recording("/nowhere").ok());
    EXPECT_FALSE(looks_like_recording(hex("05 01 09 04")));
    EXPECT_FALSE(looks_like_recording({}));
}

}  // namespace
}  // namespace surefoot::input
