// The steal of the cores as evidence: what it explains, what it does not, and where the kernel does not say.
#include "rt/frame/steal_evidence.hpp"

#include <gtest/gtest.h>

#include <array>
#include <initializer_list>
#include <vector>

#include "rt/exchange/spsc_ring.hpp"
#include "rt/frame/blame.hpp"
#include "rt/monitor/recorder.hpp"
#include "tests/bench/stolen_frames.hpp"
#include "tests/time_units.hpp"

namespace surefoot::rt {
namespace {

constexpr std::int64_t steal_period_ns = 33 * ms;

/// Due at `due_ns`, and late by so much by its own doing.
FrameRecord late_by(std::int64_t late, std::int64_t due_ns, Cause cause = Cause::submit) {
    FrameRecord r;
    r.due_ns = due_ns;
    r.deadline_ns = due_ns + steal_period_ns;
    r.complete_ns = r.deadline_ns + late;
    r.missed = r.own_miss = late > 0;
    r.cause = late > 0 ? cause : Cause::none;
    return r;
}

/// Readings every 100 ms of a machine of three cores. The frame thread is on core 1, rasterisers are on the last two.
class CoreSteal : public testing::Test {
protected:
    CoreSteal() { judge({0, 0, 0}, {}); }

    void judge(std::vector<double> steal_ms, std::initializer_list<FrameRecord> frames) {
        records.assign(frames);
        evidence.read(now_ns, steal_ms);
        evidence.judge(records);
        now_ns += 100 * ms;
    }

    StealEvidence evidence{1, CpuMask{1, 2}};
    std::int64_t now_ns = 0;
    std::vector<FrameRecord> records;
};

TEST_F(CoreSteal, ThatGrewByTheLatenessMakesAMissStolen) {
    for (const Cause cause :
         {Cause::select, Cause::submit, Cause::raster, Cause::upload, Cause::present, Cause::prepared_too_old}) {
        StealEvidence one(1, CpuMask{1});
        std::vector<FrameRecord> frames{late_by(7 * ms, 20 * ms, cause)};
        one.read(0, std::array{50.0, 20.0});
        one.read(100 * ms, std::array{50.0, 30.0});
        one.judge(frames);
        EXPECT_EQ(frames[0].cause, Cause::stolen) << cause_names[static_cast<std::size_t>(cause)];
        EXPECT_FALSE(frames[0].own_miss);
        EXPECT_TRUE(frames[0].by_core_steal);
        EXPECT_EQ(frames[0].core_steal_ns, 10 * ms);
        EXPECT_TRUE(frames[0].missed);
    }
}

TEST_F(CoreSteal, ThatGrewByLessLeavesAMissOwn) {
    judge({0, 10, 0}, {late_by(11 * ms, 20 * ms)});
    EXPECT_EQ(records[0].cause, Cause::submit);
    EXPECT_TRUE(records[0].own_miss);
    EXPECT_FALSE(records[0].by_core_steal);
    EXPECT_EQ(records[0].core_steal_ns, 10 * ms);
}

TEST_F(CoreSteal, OfACoreThatNoFrameUsesExplainsNothing) {
    judge({40, 0, 0}, {late_by(1 * ms, 20 * ms)});
    EXPECT_TRUE(records[0].own_miss);
    EXPECT_EQ(records[0].core_steal_ns, 0);
}

TEST_F(CoreSteal, OfARasterisersCoreExplainsOnlyWhatWaitsForIt) {
    judge({0, 0, 10}, {late_by(2 * ms, 10 * ms, Cause::select), late_by(2 * ms, 50 * ms, Cause::raster)});
    EXPECT_TRUE(records[0].own_miss) << "the frame thread chose on its own core";
    EXPECT_FALSE(records[1].own_miss);
    judge({0, 10, 10}, {late_by(2 * ms, 120 * ms, Cause::select)});
    EXPECT_FALSE(records[0].own_miss);
    judge({0, 20, 10}, {late_by(7 * ms, 210 * ms, Cause::raster), late_by(7 * ms, 250 * ms, Cause::select)});
    EXPECT_FALSE(records[0].own_miss);
    EXPECT_TRUE(records[1].own_miss) << "3 ms are left";
}

TEST_F(CoreSteal, ExplainsOneMissOnlyAndNothingTwice) {
    judge({0, 0, 10}, {late_by(7 * ms, 10 * ms), late_by(7 * ms, 55 * ms)});
    EXPECT_FALSE(records[0].own_miss);
    EXPECT_TRUE(records[1].own_miss) << "3 ms are left";
    judge({0, 0, 10}, {late_by(2 * ms, 120 * ms)});
    EXPECT_TRUE(records[0].own_miss) << "that was of the readings before";
}

TEST_F(CoreSteal, ThatTheClocksSawExplainsNothingMore) {
    FrameRecord in_time = late_by(-5 * ms, 10 * ms);
    in_time.stolen_ns = 6 * ms;
    judge({0, 10, 0}, {late_by(7 * ms, 50 * ms), in_time});
    EXPECT_TRUE(records[0].own_miss) << "4 ms are left";
    EXPECT_EQ(records[1].cause, Cause::none);
}

TEST_F(CoreSteal, LeavesCausesWithEvidenceOfTheirOwn) {
    for (const Cause cause : {Cause::preempted, Cause::page_fault, Cause::stopped, Cause::woken_late}) {
        StealEvidence one(0, CpuMask{0});
        std::vector<FrameRecord> frames{late_by(2 * ms, 20 * ms, cause)};
        one.read(0, std::array{0.0});
        one.read(100 * ms, std::array{50.0});
        one.judge(frames);
        EXPECT_EQ(frames[0].cause, cause);
        EXPECT_TRUE(frames[0].own_miss);
        EXPECT_EQ(frames[0].core_steal_ns, 50 * ms) << "it is told beside";
    }
}

TEST_F(CoreSteal, IsOfAllReadingsRoundALongFrame) {
    judge({0, 10, 0}, {});
    judge({0, 30, 0}, {late_by(25 * ms, 80 * ms)});  // until 138 ms
    EXPECT_EQ(records[0].core_steal_ns, 30 * ms);
    EXPECT_FALSE(records[0].own_miss);
}

TEST_F(CoreSteal, ExplainsAPictureThatWasShownLate) {
    FrameRecord r = late_by(-5 * ms, 10 * ms);
    r.show_ns = r.deadline_ns;
    r.presented_ns = r.show_ns + 8 * ms;
    r.missed = r.own_miss = true;
    r.cause = Cause::present;
    judge({0, 10, 0}, {r});
    EXPECT_EQ(records[0].cause, Cause::stolen);
}

TEST_F(CoreSteal, IsUnknownWhereTheKernelDoesNotSayAndRoundNoFrameOfBefore) {
    judge({}, {late_by(2 * ms, 20 * ms)});
    EXPECT_EQ(records[0].core_steal_ns, -1);
    EXPECT_TRUE(records[0].own_miss);
    judge({0, 0, 90}, {late_by(2 * ms, 120 * ms)});
    EXPECT_EQ(records[0].core_steal_ns, -1) << "one reading is no growth";
    judge({0, 0, 100}, {late_by(2 * ms, 190 * ms)});
    EXPECT_EQ(records[0].core_steal_ns, -1) << "its first part lies before the readings";
    judge({0, 0, 110}, {late_by(2 * ms, 310 * ms)});
    EXPECT_EQ(records[0].core_steal_ns, 10 * ms);
}

TEST_F(CoreSteal, IsReadByTwoThreadsWhoseOlderReadingIsDropped) {
    evidence.read(90 * ms, std::array{0.0, 10.0, 0.0});
    evidence.read(80 * ms, std::array{0.0, 0.0, 0.0});
    now_ns = 100 * ms;
    judge({0, 10, 0}, {late_by(2 * ms, 20 * ms), late_by(5 * ms, 60 * ms)});
    EXPECT_EQ(records[0].core_steal_ns, 10 * ms);
    EXPECT_FALSE(records[0].own_miss) << "a frame of the first reading, judged after the last";
    EXPECT_EQ(records[1].core_steal_ns, 10 * ms) << "of both readings";
}

TEST_F(CoreSteal, OfAClockThatGoesBackIsNoGrowth) {
    judge({0, 50, 50}, {});
    judge({0, 0, 0}, {late_by(2 * ms, 120 * ms)});
    EXPECT_EQ(records[0].core_steal_ns, 0);
    EXPECT_TRUE(records[0].own_miss);
}

/// Recorded on hosts whose kernel charged the theft to the thread that ran.
TEST_F(CoreSteal, ExplainsTheRecordedTheftsThatLookedLikeWork) {
    const auto thefts = bench::read_stolen_frames(std::string(SUREFOOT_SOURCE_DIR) + "/tests/rt/stolen_frames.csv");
    ASSERT_TRUE(thefts.ok()) << thefts.error().text();
    int own_by_clocks = 0, own = 0;
    for (FrameRecord r : *thefts) {
        BlameLimits limits;
        limits.period_ns = r.deadline_ns - r.due_ns;
        r.cause = blame(r, limits);
        r.own_miss = is_own_miss(r, limits);
        own_by_clocks += r.own_miss ? 1 : 0;
        StealEvidence one(0, CpuMask{0});
        one.read(r.due_ns, std::array{0.0});
        one.read(r.complete_ns, std::array{static_cast<double>(r.core_steal_ns) * 1e-6});
        one.judge({&r, 1});
        EXPECT_EQ(r.cause, Cause::stolen) << "late by " << late_ns(r) << " ns";
        own += r.own_miss ? 1 : 0;
    }
    EXPECT_GE(own_by_clocks, 13);
    EXPECT_LE(own, 1) << "late by 22.4 ms, of which the clocks saw 17.3; the core's ticks say 20";
}

TEST(Recorder, HandsTheBatchOverBeforeRecordsAreKeptAndSeen) {
    SpscRing<FrameRecord> ring(1024);
    for (std::uint64_t i = 0; i < 600; ++i) {
        FrameRecord record;
        record.frame = i;
        ring.try_push(record);
    }
    std::size_t batched = 0;
    std::vector<std::uint64_t> seen;
    RecorderOptions options;
    options.poll_ns = 3'600'000'000'000;
    options.on_batch = [&](std::span<FrameRecord> records) {
        batched += records.size();
        for (FrameRecord& record : records) record.core_steal_ns = static_cast<std::int64_t>(record.frame);
    };
    options.on_record = [&](const FrameRecord& record) {
        EXPECT_EQ(record.core_steal_ns, static_cast<std::int64_t>(record.frame));
        seen.push_back(record.frame);
    };
    Recorder recorder(ring, options);
    recorder.stop();
    EXPECT_EQ(batched, 600U);
    ASSERT_EQ(seen.size(), 600U);
    EXPECT_EQ(seen.back(), 599U);
    EXPECT_EQ(recorder.records().at(300).core_steal_ns, 300);
}

}  // namespace
}  // namespace surefoot::rt
