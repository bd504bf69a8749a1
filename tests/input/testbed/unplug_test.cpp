// Pulled, replugged and stalled devices through the real hidapi and libudev: rest in time, nothing stale, no descriptor leaked.
#include <atomic>
#include <functional>
#include <thread>

#include "input/devices/device_router.hpp"
#include "rt/base/random.hpp"
#include "rt/threads/guard.hpp"
#include "tests/input/plain_stick.hpp"
#include "tests/input/testbed/testbed.hpp"

namespace surefoot::input {
namespace {

using test::at;
using test::stick;
using test::Testbed;
using test::Wire;
using Kind = DeviceEvent::Kind;

std::unique_ptr<LiveDevices> live(bool beside = false) {
    auto made = open_live({}, beside);
    EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().text());
    return std::move(*made);
}

/// The input thread's loop, run by the test: events to the steering, a tick every millisecond.
struct Walk {
    explicit Walk(bool beside = false) : source(live(beside)) {}
    double step(std::int64_t until_ns = 0) {
        source->wait(until_ns == 0 ? test::now_ns() + 1'000'000 : until_ns);
        router.dispatch(source->take());
        steering.steers.plays();
        sample = steering.tick({}, test::now_ns());
        return glm::length(sample.velocity_m_s);
    }
    void run_ms(int ms) {
        const std::int64_t end = test::now_ns() + ms * std::int64_t{1'000'000};
        while (test::now_ns() < end) step();
    }
    /// Milliseconds until it stands still, those in which this process was held up left out; -1: not within a second.
    double ms_to_rest() {
        const std::int64_t from = test::now_ns();
        const double held_up = hold_ups.ms();
        test::Patience patience(1000);
        while (!patience.over())
            if (step() == 0) return ms_since(from, held_up);
        return -1;
    }
    [[nodiscard]] double ms_since(std::int64_t from_ns, double held_up) const {
        return std::max(0.0, static_cast<double>(test::now_ns() - from_ns) * 1e-6 - (hold_ups.ms() - held_up));
    }
    /// False: it was not found in time.
    bool found(int within_ms) {
        for (test::Patience patience(within_ms); source->devices() == 0 && !patience.over();) step();
        return source->devices() > 0;
    }
    [[nodiscard]] double speed() const { return glm::length(sample.velocity_m_s); }

    test::HoldUps hold_ups;
    std::vector<std::string> messages;
    Steering steering{MotionLimits{}, SafetyLimits{}};
    DeviceRouter router{{}, steering, [this](std::string_view text) { messages.emplace_back(text); }};
    std::unique_ptr<LiveDevices> source;
    NavigationSample sample;
};

/// Sends every millisecond, as a streaming device does, while the walk runs.
void hold(Walk& walk, test::Plug& plug, int x, int y, int ms) {
    const std::int64_t from = test::now_ns();
    for (int i = 1; i <= ms; ++i) {
        (void)Testbed::send(plug, at(x, y));
        const std::int64_t until = from + i * std::int64_t{1'000'000};
        do {
            walk.step(until);
        } while (test::now_ns() < until);
    }
}

class Unplug : public ::testing::TestWithParam<bool> {};

/// Milliseconds from the pull to rest, deflected and with a report in flight.
double pulled_to_rest_ms(bool beside, Wire wire) {
    Testbed bed;
    auto plug = bed.plug(stick(), {.wire = wire});
    Walk walk(beside);
    while (walk.source->devices() == 0) walk.step();
    hold(walk, plug, 0, 0, 20);
    hold(walk, plug, 0, -127, 300);
    EXPECT_GT(walk.speed(), 0.5);
    (void)Testbed::send(plug, at(0, -127));
    if (wire == Wire::terminal)
        bed.hang_up(plug);  // udev has not said anything yet
    else
        bed.pull(plug);
    const double ms = walk.ms_to_rest();
    EXPECT_EQ(walk.source->devices(), 0U);
    if (wire == Wire::terminal) bed.pull(plug);
    walk.run_ms(20);
    EXPECT_EQ(walk.speed(), 0);
    EXPECT_EQ(walk.router.steering_now(), 0);
    return ms;
}

/// Of three: on a shared machine the host may stand still for longer than the limit.
double best_of_three(const std::function<double()>& once, double limit) {
    double best = once();
    for (int i = 1; i < 3 && best > limit; ++i) best = std::min(best, once());
    return best;
}

TEST_P(Unplug, RestsWithinFiftyMillisecondsThoughDeflected) {
    const double ms = best_of_three([&] { return pulled_to_rest_ms(GetParam(), Wire::terminal); }, 50);
    EXPECT_GE(ms, 0);
    EXPECT_LE(ms, 50);
    std::printf("[ figure   ] hang-up to rest: %.1f ms\n", ms);
}

TEST_P(Unplug, WhereOnlyUdevReportsItRestsAsWell) {
    const double ms = best_of_three([&] { return pulled_to_rest_ms(GetParam(), Wire::pipe); }, 50);
    EXPECT_GE(ms, 0);
    EXPECT_LE(ms, 50);
    std::printf("[ figure   ] udev's remove to rest: %.1f ms\n", ms);
}

TEST_P(Unplug, PluggedInAgainItSteersOnlyOnceSeenNeutral) {
    Testbed bed;
    auto plug = bed.plug(stick(), {.serial = "0001", .wire = Wire::terminal});
    Walk walk(GetParam());
    while (walk.source->devices() == 0) walk.step();
    hold(walk, plug, 0, 0, 20);
    hold(walk, plug, 0, -127, 200);
    ASSERT_GT(walk.speed(), 0.5);
    const std::vector<int> before = test::connected_numbers(walk.steering);
    ASSERT_EQ(before.size(), 1U);
    bed.pull(plug);
    ASSERT_GE(walk.ms_to_rest(), 0);
    const std::int64_t from = test::now_ns();
    const double held_up = walk.hold_ups.ms();
    plug = bed.plug(stick(), {.node = "hidraw1", .serial = "0001", .wire = Wire::terminal});  // another node, another path
    EXPECT_TRUE(walk.found(1000));
    const double ms = walk.ms_since(from, held_up);
    EXPECT_LE(ms, 1000);
    std::printf("[ figure   ] plugged to open: %.1f ms\n", ms);
    EXPECT_EQ(walk.router.pluggings(), 2U);
    hold(walk, plug, 0, -127, 100);
    EXPECT_EQ(test::connected_numbers(walk.steering), before) << "known by its serial, it gets its number again";
    EXPECT_EQ(walk.speed(), 0) << "deflected since it came";
    hold(walk, plug, 0, 0, 20);
    hold(walk, plug, 0, -127, 200);
    EXPECT_GT(walk.speed(), 0.5);
    bed.pull(plug);
}

INSTANTIATE_TEST_SUITE_P(HereAndBeside, Unplug, ::testing::Bool(),
                         [](const auto& i) { return i.param ? "FinderBeside" : "FinderHere"; });

TEST(Replug, TwoHundredTimesLeavesNoDescriptorBehind) {
    Testbed bed;
    Walk walk;
    Random random(7);
    std::size_t before = 0;
    double worst_rest_ms = 0, worst_open_ms = 0;
    int late_rests = 0, late_opens = 0;
    for (int i = 0; i < 200; ++i) {
        const std::int64_t from = test::now_ns();
        const double held_up = walk.hold_ups.ms();
        auto plug = bed.plug(stick(), {.wire = Wire::terminal});
        ASSERT_TRUE(walk.found(2000)) << i;
        const double open_ms = walk.ms_since(from, held_up);
        worst_open_ms = std::max(worst_open_ms, open_ms);
        late_opens += open_ms > 250 ? 1 : 0;
        hold(walk, plug, 0, 0, 5);
        hold(walk, plug, static_cast<int>(random.below(255)) - 127, static_cast<int>(random.below(255)) - 127, 20);
        bed.pull(plug);
        const double ms = walk.ms_to_rest();
        ASSERT_GE(ms, 0) << i;
        worst_rest_ms = std::max(worst_rest_ms, ms);
        late_rests += ms > 50 ? 1 : 0;
        ASSERT_EQ(walk.source->devices(), 0U) << i;
        walk.run_ms(2);
        if (i == 0) before = test::open_descriptors();
    }
    // The testbed closes its own end of an ioctl a little later; one left behind at each plugging would be 199.
    EXPECT_LE(test::open_descriptors(), before + 3);
    EXPECT_LE(late_rests, 2) << "more than what the host's pauses explain";
    EXPECT_LE(late_opens, 2);
    std::printf("[ figure   ] 200 times: worst open %.1f ms, worst rest %.1f ms\n", worst_open_ms, worst_rest_ms);
}

// The kernel's ring holds 63 reports and drops the newest: what a stalled reader finds ends in deflection, and the release is
// lost.
TEST(Stall, AfterAnOverflowItRestsThoughTheLastReportHasFullDeflection) {
    Testbed bed;
    auto plug = bed.plug(stick());
    Walk walk;
    while (walk.source->devices() == 0) walk.step();
    hold(walk, plug, 0, 0, 20);
    hold(walk, plug, 0, -127, 300);
    ASSERT_GT(walk.speed(), 0.5);
    int kept = 0;  // nobody reads for half a second
    for (int i = 0; i < 500; ++i) kept += kept < 63 && Testbed::send(plug, at(0, i < 400 ? -127 : 0)) ? 1 : 0;
    ASSERT_EQ(kept, 63);
    const auto reports = walk.router.accepted_reports();
    walk.step();
    EXPECT_EQ(walk.router.accepted_reports() - reports, 63U) << "not drained whole";
    walk.steering.steers.plays();
    EXPECT_EQ(walk.steering.safety().devices[0].held, Held::overflow);
    EXPECT_GE(walk.ms_to_rest(), 0);
    walk.run_ms(150);
    EXPECT_EQ(walk.speed(), 0);
    hold(walk, plug, 0, 0, 10);
    hold(walk, plug, 0, -127, 200);
    EXPECT_GT(walk.speed(), 0.5) << "steers again by what is new";
}

TEST(Stall, WithoutOverflowTheNewestReportCounts) {
    Testbed bed;
    auto plug = bed.plug(stick());
    Walk walk;
    while (walk.source->devices() == 0) walk.step();
    hold(walk, plug, 0, 0, 20);
    hold(walk, plug, 0, -127, 300);
    ASSERT_GT(walk.speed(), 0.5);
    for (int i = 0; i < 40; ++i) ASSERT_TRUE(Testbed::send(plug, at(0, i < 39 ? -127 : 0)));
    walk.step();
    walk.steering.steers.plays();
    EXPECT_TRUE(walk.steering.safety().devices[0].held == Held::no);
    EXPECT_EQ(walk.steering.safety().devices[0].passed.forward, 0);
}

TEST(Flood, OneDeviceThatNeverStopsHoldsUpNobody) {
    Testbed bed;
    auto plug = bed.plug(stick());
    auto quiet = bed.plug(stick(), {.node = "hidraw1", .socket = "usb-0000:00:14.0-2/input0"});
    Walk walk;
    while (walk.source->devices() < 2) walk.step();
    std::atomic<bool> stop{false};
    std::thread flood([&] {
        while (!stop.load())
            if (!Testbed::send(plug, at(0, -127))) std::this_thread::yield();
    });
    std::size_t quiet_reports = 0, most = 0;
    for (int i = 0; i < 40; ++i) {
        ASSERT_TRUE(Testbed::send(quiet, at(0, 0)));
        walk.source->wait(test::now_ns() + 1'000'000);
        std::size_t flooded = 0;
        for (const DeviceEvent& e : walk.source->take()) {
            walk.router.dispatch(e);
            if (e.kind == Kind::report) ++(e.device == 0 ? flooded : quiet_reports);
        }
        most = std::max(most, flooded);
        walk.steering.steers.plays();
        walk.sample = walk.steering.tick({}, test::now_ns());
    }
    stop.store(true);
    flood.join();
    EXPECT_EQ(quiet_reports, 40U);
    EXPECT_LE(most, max_drain);
    EXPECT_EQ(walk.speed(), 0);
}

// The input thread obeys the frame thread's rule while no device comes or goes: the finder has a thread of its own for the rest.
TEST(RealTime, ReadingNeitherAllocatesNorFrees) {
    if (!rt::guard_active()) GTEST_SKIP() << "allocations are not counted in this build";
    Testbed bed;
    auto plug = bed.plug(stick());
    Walk walk(true);
    while (walk.source->devices() == 0) walk.step();
    hold(walk, plug, 0, 0, 20);
    const auto before = rt::guard_counters();
    for (int i = 0; i < 500; ++i) {
        for (int k = 0; k < 3; ++k) ASSERT_TRUE(Testbed::send(plug, at(i % 100, -k)));
        const rt::OwnScope scope;
        walk.source->wait(test::now_ns() + 1'000'000);
        walk.router.dispatch(walk.source->take());
        walk.steering.steers.plays();
        walk.sample = walk.steering.tick({}, test::now_ns());
    }
    EXPECT_GE(walk.router.accepted_reports(), 1500U);
    EXPECT_EQ(rt::guard_counters().own_violations, before.own_violations);
}

}  // namespace
}  // namespace surefoot::input
