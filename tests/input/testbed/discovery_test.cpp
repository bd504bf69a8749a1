// Finding devices through the real hidapi and libudev: one device is one device, whom it opens, and who has to be permitted
// first.
#include "tests/input/testbed/testbed.hpp"

namespace surefoot::input {
namespace {

using test::Testbed;
using test::Watcher;
using test::Wire;
using Kind = DeviceEvent::Kind;

std::unique_ptr<LiveDevices> live(FinderOptions options = {}, bool beside = false) {
    auto made = open_live(std::move(options), beside);
    EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().text());
    return std::move(*made);
}

TEST(Discovery, ADeviceIsFoundDescribedAndRead) {
    Testbed bed;
    auto r = recorded("spacenavigator-like");
    auto plug = bed.plug(r, {.serial = "s1"});
    const auto source = live();
    Watcher w(*source);
    const auto* added = w.next(Kind::added);
    ASSERT_NE(added, nullptr);
    const PluggedDevice& p = *added->event.plugged;
    EXPECT_EQ(p.node, "/dev/hidraw0");
    EXPECT_EQ(p.name, r.name);
    EXPECT_EQ(p.vendor, 0x046d);
    EXPECT_EQ(p.product, 0xc626);
    EXPECT_EQ(p.descriptor, r.descriptor);
    EXPECT_EQ(p.device.device_class, DeviceClass::navigation);
    EXPECT_FALSE(p.device.controls.front().relative) << "the quirk was not applied";
    EXPECT_EQ(p.identity(), "046d:c626 s1/input0");
    for (std::size_t i = 0; i < r.reports.size(); ++i) ASSERT_TRUE(Testbed::send(plug, r.report(i)));
    ASSERT_NE(w.next(Kind::drained), nullptr);
    ASSERT_EQ(w.count(Kind::report), r.reports.size());
    std::size_t i = 0;
    for (const auto& s : w.seen)
        if (s.event.kind == Kind::report) {
            const auto sent = r.report(i++);
            EXPECT_EQ(s.bytes, std::vector<std::byte>(sent.begin(), sent.end()));
            EXPECT_EQ(s.event.device, added->event.device);
        }
    EXPECT_EQ(w.seen.back().event.reports, r.reports.size());
}

TEST(Discovery, WhatTheListRepeatsIsOneDevice) {
    Testbed bed;
    bed.plug(recorded("nested-applications"));
    bed.plug(recorded("boot-mouse"), {.node = "hidraw1", .socket = "usb-0000:00:14.0-2/input0"});
    const auto source = live();
    Watcher w(*source);
    w.watch_for(300);
    EXPECT_EQ(w.count(Kind::added), 1U);
    EXPECT_EQ(w.count(Kind::refused), 1U);
    EXPECT_EQ(source->devices(), 1U);
}

TEST(Discovery, AMouseSteersOnlyWhereConfigured) {
    Testbed bed;
    bed.plug(recorded("boot-mouse"));
    {
        const auto source = live();
        Watcher w(*source);
        const auto* refused = w.next(Kind::refused);
        ASSERT_NE(refused, nullptr);
        EXPECT_EQ(refused->event.refused, Refused::unwanted);
        EXPECT_NE(refused->why.what.find("mouse"), std::string::npos) << refused->why.text();
        EXPECT_EQ(w.count(Kind::added), 0U);
    }
    FinderOptions all;
    all.wanted = [](const PluggedDevice&) { return true; };
    const auto source = live(all);
    Watcher w(*source);
    EXPECT_NE(w.next(Kind::added), nullptr);
}

TEST(Discovery, AMalformedDescriptorIsRefusedWithItsByte) {
    Testbed bed;
    auto r = recorded("spacenavigator-like");
    r.descriptor.resize(r.descriptor.size() - 3);
    bed.plug(r);
    const auto source = live();
    Watcher w(*source);
    const auto* refused = w.next(Kind::refused);
    ASSERT_NE(refused, nullptr);
    EXPECT_EQ(refused->event.refused, Refused::descriptor);
    EXPECT_NE(refused->why.place.find("byte"), std::string::npos) << refused->why.text();
}

class LatePermission : public ::testing::TestWithParam<Wire> {};

TEST_P(LatePermission, IsReportedOnceAndTakenAtTheChangeEvent) {
    Testbed bed;
    const auto plug = bed.plug(recorded("dualshock4-like"), {.wire = GetParam(), .readable = false});
    const test::NoOverride plain_user;
    const auto source = live();
    Watcher w(*source);
    const auto* refused = w.next(Kind::refused);
    ASSERT_NE(refused, nullptr);
    EXPECT_EQ(refused->event.refused, Refused::permission);
    EXPECT_NE(refused->why.remedy.find("70-surefoot.rules"), std::string::npos);
    w.watch_for(700);  // several tries of the schedule, all in vain
    EXPECT_EQ(w.count(Kind::refused), 1U) << "said more than once";
    EXPECT_EQ(w.count(Kind::added), 0U);
    bed.permit(plug);
    const std::int64_t permitted = test::now_ns();
    const double held_up = bed.held_up_ms();
    ASSERT_NE(w.next(Kind::added), nullptr);
    const double ms = static_cast<double>(test::now_ns() - permitted) * 1e-6 - (bed.held_up_ms() - held_up);
    EXPECT_LT(ms, 250);
    RecordProperty("change_to_open_ms", std::to_string(ms));
    std::printf("[ figure   ] permission to open: %.1f ms\n", ms);
}

INSTANTIATE_TEST_SUITE_P(Both, LatePermission, ::testing::Values(Wire::pipe, Wire::terminal));

TEST(Permission, IsTakenOnTheScheduleWhereNoEventComes) {
    Testbed bed;
    const auto plug = bed.plug(recorded("dualshock4-like"), {.readable = false});
    const test::NoOverride plain_user;
    const auto source = live();
    Watcher w(*source);
    ASSERT_NE(w.next(Kind::refused), nullptr);
    bed.permit(plug, false);
    EXPECT_NE(w.next(Kind::added, 2500), nullptr);
}

TEST(Permission, InAThreadBesideAsWell) {
    Testbed bed;
    const auto plug = bed.plug(recorded("dualshock4-like"), {.readable = false});
    const test::NoOverride plain_user;
    const auto source = live({}, true);
    Watcher w(*source);
    const auto* refused = w.next(Kind::refused);
    ASSERT_NE(refused, nullptr);
    EXPECT_EQ(refused->event.refused, Refused::permission);
    bed.permit(plug);
    EXPECT_NE(w.next(Kind::added, 250), nullptr);
}

TEST(Retry, TriesAtMostTwentyTimesInHalfAMinuteAndNeverGivesUp) {
    Retry retry;
    int tries = 0, last_minute = 0;
    for (std::int64_t now = 0; now < 3600'000'000'000; now += 1'000'000) {
        if (!retry.due(now)) continue;
        retry.failed(now);
        ++tries;
        if (now <= 30'000'000'000) {
            EXPECT_LE(tries, 20);
        }
        if (now >= 3540'000'000'000) ++last_minute;
    }
    EXPECT_EQ(last_minute, 30);
}

}  // namespace
}  // namespace surefoot::input
