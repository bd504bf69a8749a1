// The daemon's pure rules: when the watchdog is fed, how bursts of misses are told, how the status reads.
#include <gtest/gtest.h>

#include "systemd/daemon/heartbeat.hpp"
#include "systemd/daemon/misses.hpp"
#include "systemd/daemon/service_state.hpp"

namespace surefoot::daemon {
namespace {

constexpr std::int64_t period = 20'000'000, look = 50'000'000, second = 1'000'000'000;

/// Looks from `now` on for `seconds`, with a frame a period unless frozen; how many pings.
struct Time {
    Heartbeat heartbeat;
    std::int64_t now = 0;
    std::uint64_t frames = 0;
    int pings = 0, stalls = 0, resumes = 0;
    void pass(double seconds, bool frames_come) {
        pings = stalls = resumes = 0;
        for (const std::int64_t until = now + static_cast<std::int64_t>(seconds * 1e9); now < until; now += look) {
            if (frames_come) frames += look / period;
            const Beat beat = heartbeat.look(now, frames);
            pings += beat.ping ? 1 : 0;
            stalls += beat.stalled ? 1 : 0;
            resumes += beat.resumed ? 1 : 0;
        }
    }
};

TEST(Heartbeat, PingsOnlyWhileFramesCome) {
    Time t{Heartbeat(4 * second, period)};
    t.heartbeat.frames_begin(0, period);
    t.pass(20, true);
    EXPECT_GE(t.pings, 15) << "four a timeout";
    EXPECT_LE(t.pings, 21);
    EXPECT_EQ(t.stalls + t.resumes, 0);
    t.pass(10, false);
    EXPECT_LE(t.pings, 1) << "of frames that came before";
    EXPECT_EQ(t.stalls, 1) << "said once";
    t.pass(2, true);
    EXPECT_GE(t.pings, 1);
    EXPECT_EQ(t.resumes, 1);
}

TEST(Heartbeat, AFreezeStopsThePingsWithinOneInterval) {
    Time t{Heartbeat(4 * second, period)};
    t.heartbeat.frames_begin(0, period);
    t.pass(5, true);
    t.pass(1, false);
    t.pass(9, false);
    EXPECT_EQ(t.pings, 0);
}

TEST(Heartbeat, OpeningIsTrustedForAsLongAsItMayTake) {
    Time t{Heartbeat(4 * second, period)};
    t.heartbeat.opening(0, 10 * second);
    t.pass(10, false);
    EXPECT_GE(t.pings, 8);
    EXPECT_EQ(t.stalls, 0);
    t.pass(10, false);
    EXPECT_EQ(t.pings, 0) << "a driver that hangs while opening is not fed for ever";
    t.heartbeat.frames_begin(t.now, period);
    t.pass(1, true);
    EXPECT_GE(t.pings, 1);
}

TEST(Heartbeat, WhileTheFirstFrameIsNotDueNothingStalls) {
    Time t{Heartbeat(4 * second, period)};
    t.heartbeat.frames_begin(3 * second / 2, period);
    t.pass(2, false);
    EXPECT_EQ(t.stalls, 0);
    t.pass(3, false);
    EXPECT_EQ(t.stalls, 1) << "it did not come";
}

TEST(Heartbeat, WithoutAWatchdogStallsAreReportedAllTheSame) {
    Time t{Heartbeat(0, period)};
    t.heartbeat.frames_begin(0, period);
    t.pass(5, true);
    EXPECT_EQ(t.pings, 0);
    t.pass(5, false);
    EXPECT_EQ(t.pings, 0);
    EXPECT_EQ(t.stalls, 1);
}

TEST(Heartbeat, ASlowRateIsNoStall) {
    Heartbeat heartbeat(10 * second, second);
    heartbeat.frames_begin(0, second);
    for (std::int64_t now = 0; now < 60 * second; now += look)
        EXPECT_FALSE(heartbeat.look(now, static_cast<std::uint64_t>(now / second)).stalled) << now;
}

rt::FrameRecord frame(std::uint64_t slot, bool missed, rt::Cause cause = rt::Cause::none, std::uint32_t skipped = 0) {
    rt::FrameRecord r;
    r.slot = slot;
    r.due_ns = static_cast<std::int64_t>(slot) * period;
    r.deadline_ns = r.due_ns + period;
    r.complete_ns = r.deadline_ns + (missed ? 3'000'000 : -5'000'000);
    r.missed = missed;
    r.own_miss = missed && cause == rt::Cause::raster;
    r.cause = cause;
    r.skipped_before = skipped;
    return r;
}

TEST(Bursts, AreOneLineEach) {
    Bursts bursts;
    std::vector<Burst> reported;
    std::uint64_t slot = 0;
    const auto pass = [&](int count, bool missed, rt::Cause cause = rt::Cause::none) {
        for (int i = 0; i < count; ++i) {
            if (auto burst = bursts.add(frame(slot++, missed, cause))) reported.push_back(*burst);
        }
    };
    pass(100, false);
    EXPECT_TRUE(reported.empty());
    pass(3, true, rt::Cause::raster);
    pass(20, false);
    pass(1, true, rt::Cause::stolen);
    pass(49, false);
    EXPECT_TRUE(reported.empty()) << "a second has not passed";
    pass(200, false);
    ASSERT_EQ(reported.size(), 1U);
    EXPECT_EQ(reported[0].misses, 4U);
    EXPECT_EQ(reported[0].own_misses, 3U);
    EXPECT_EQ(reported[0].first_slot, 100U);
    EXPECT_EQ(reported[0].last_slot, 123U);
    EXPECT_EQ(reported[0].main_cause(), rt::Cause::raster);
    EXPECT_EQ(reported[0].text(), "4 frames missed in 0.5 s, at worst 3.0 ms late: stolen 1, raster 3");
    EXPECT_FALSE(bursts.finish()) << "none is open";
}

TEST(Bursts, AFrameThatTookSecondsAndTheSlotsItCostAreOne) {
    Bursts bursts;
    EXPECT_FALSE(bursts.add(frame(0, false)));
    rt::FrameRecord frozen = frame(1, true, rt::Cause::stopped);
    frozen.complete_ns = frozen.deadline_ns + 3 * second;
    EXPECT_FALSE(bursts.add(frozen));
    EXPECT_FALSE(bursts.add(frame(153, false, rt::Cause::none, 151)));
    const auto burst = bursts.finish();
    ASSERT_TRUE(burst);
    EXPECT_EQ(burst->text(), "1 frame missed, 151 slots skipped, at worst 3000.0 ms late: stopped 1");
}

TEST(Bursts, EveryMissIsInExactlyOneLineAndALongBurstIsReportedByTheMinute) {
    Bursts bursts;
    std::uint64_t reported = 0, lines = 0, skipped = 0;
    for (std::uint64_t slot = 0; slot < 50 * 300; ++slot) {
        if (auto burst = bursts.add(frame(slot, slot % 3 == 0, rt::Cause::submit, slot % 100 == 1 ? 2 : 0))) {
            reported += burst->misses;
            skipped += burst->skipped;
            ++lines;
            EXPECT_TRUE(burst->goes_on);
            EXPECT_NE(burst->text().find("the burst goes on"), std::string::npos);
        }
    }
    EXPECT_EQ(lines, 4U);
    const auto rest = bursts.finish();
    ASSERT_TRUE(rest);
    EXPECT_FALSE(rest->goes_on);
    EXPECT_EQ(reported + rest->misses, 5000U);
    EXPECT_EQ(skipped + rest->skipped, 300U);
}

TEST(Status, NamesTheMostImportantFirst) {
    Facts f;
    f.phase = Phase::walking;
    f.model = "lobby.walk";
    f.in_short = "60 Hz, 1280x720, egl";
    f.frames = 1000;
    f.misses = 2;
    f.skipped = 1;
    EXPECT_EQ(status_text(f), "walking lobby.walk (60 Hz, 1280x720, egl): 1000 frames, 2 missed, 1 slots skipped");
    f.lacks = {"SCHED_FIFO is refused", "no isolated core among 0-1"};
    f.refused = "s.toml:3: The key 'x' is unknown";
    f.uncalibrated = true;
    EXPECT_EQ(
        status_text(f),
        "walking lobby.walk (60 Hz, 1280x720, egl): 1000 frames, 2 missed, 1 slots skipped; the configuration was refused, the "
        "last good one is in use: s.toml:3: The key 'x' is unknown; not fully real-time: SCHED_FIFO is refused, no isolated core "
        "among 0-1; uncalibrated");
    f.stalled = true;
    EXPECT_TRUE(status_text(f).starts_with("NO FRAMES COME; "));
}

}  // namespace
}  // namespace surefoot::daemon
