// A soak's timetable, figures and verdict: each point of it holds when it should, and only then.
#include <gtest/gtest.h>

#include <cerrno>
#include <cmath>

#include "rt/base/random.hpp"
#include "tools/soak/plan.hpp"
#include "tools/soak/soak_verdict.hpp"
#include "tools/soak/tally.hpp"

namespace surefoot::soak {
namespace {

constexpr std::int64_t soak_period_ns = 16'666'667;

TEST(SoakPlan, CoversEverySecondAndRunsEveryLoadAloneOrWithOthersAndAllAtOnce) {
    for (const double seconds : {20.0, 181.5, 1200.0, 7200.0}) {
        const LoadPlan plan = plan_loads(usual_loads, seconds, 4, 7);
        double at = 0;
        LoadSet seen = 0;
        bool all = false;
        for (const LoadPhase& phase : plan.phases) {
            EXPECT_EQ(phase.from_s, at);
            EXPECT_NE(phase.loads, 0U);
            EXPECT_EQ(phase.loads & ~usual_loads, 0U) << "the clock is stepped though nobody asked";
            EXPECT_NEAR(std::fmod(phase.from_s, 4), 0, 1e-9) << "a pair of control blocks sees two loads";
            at = phase.to_s;
            seen |= phase.loads;
            all = all || phase.loads == usual_loads;
        }
        EXPECT_DOUBLE_EQ(at, seconds);
        if (seconds < 100) continue;
        EXPECT_EQ(seen, usual_loads);
        EXPECT_TRUE(all);
    }
}

TEST(SoakPlan, IsTheSameForTheSameSeedAndAnotherForAnother) {
    const auto loads = [](std::uint64_t seed) {
        std::vector<LoadSet> sets;
        for (const LoadPhase& phase : plan_loads(usual_loads, 1200, 4, seed).phases) sets.push_back(phase.loads);
        return sets;
    };
    EXPECT_EQ(loads(3), loads(3));
    EXPECT_NE(loads(3), loads(4));
}

TEST(SoakPlan, AnswersForEveryTime) {
    const LoadPlan plan = plan_loads(load_bit(LoadKind::cpu) | load_bit(LoadKind::io), 100, 4, 1);
    EXPECT_EQ(plan.at(-1), 0U);
    EXPECT_EQ(plan.at(100), 0U);
    EXPECT_EQ(plan.at(0), plan.phases.front().loads);
    EXPECT_EQ(plan.at(99.9), plan.phases.back().loads);
    EXPECT_EQ(plan.phase_at(1e9), plan.phases.size() - 1);
}

TEST(SoakPlan, MixesAreReadAndWrongOnesNamed) {
    EXPECT_EQ(*parse_mix("cpu,clock"), load_bit(LoadKind::cpu) | load_bit(LoadKind::clock));
    EXPECT_EQ(names_of(*parse_mix("io,cpu")), (std::vector<std::string>{"cpu", "io"}));
    for (const char* wrong : {"", "cpu,disk", "cpu,,io", "CPU"}) {
        const auto mix = parse_mix(wrong);
        ASSERT_FALSE(mix.ok()) << wrong;
        EXPECT_NE(mix.error().remedy.find("devices"), std::string::npos);
    }
}

/// Twenty minutes that hold in every point.
SoakSummary good_soak() {
    SoakSummary s;
    s.ran_s = 1200;
    s.walk.clock = "real";
    s.walk.rate_hz = 60;
    s.walk.frames = 36'000;
    s.walk.misses = 3;
    s.walk.own_misses = 2;
    s.walk.fifo = s.walk.locked = true;
    s.walk.control.ran = true;
    s.walk.control.other_miss_share = 0.6;
    rt::DeadlineVerdict& v = s.walk.control.verdict;
    v.own_holds = v.control_holds = v.enough_pairs = v.load_counts = v.holds = true;
    v.pairs = 300;
    v.p_value = 0.7;
    s.slots_run = 71'990, s.slots_skipped = 10, s.slots_elapsed = 72'000;
    Random random(1);
    for (int i = 0; i < 1200; ++i) {
        // Settling at first, then a few KiB about a level; a file is open every now and then.
        const double settling = i < 200 ? (200 - i) * -40.0 : 0;
        s.samples.push_back({1.0 * i, 300'000 + settling + random.range(-8, 8), 400'000, i % 7 == 0 ? 13U : 12U, 20});
    }
    SoakLoad cpu;
    cpu.name = "cpu";
    cpu.ran = cpu.real = true;
    s.loads = {cpu};
    return s;
}

Judged of(SoakSummary s, const std::string& name) {
    judge_soak(s);
    for (const SoakCheck& check : s.checks)
        if (check.name == name) return check.judged;
    ADD_FAILURE() << "no point " << name;
    return Judged::not_judged;
}

TEST(SoakVerdict, AGoodSoakHoldsInEveryPoint) {
    SoakSummary s = good_soak();
    judge_soak(s);
    EXPECT_EQ(s.checks.size(), 7U);
    for (const SoakCheck& check : s.checks) EXPECT_EQ(check.judged, Judged::holds) << check.name << ": " << check.words;
    EXPECT_EQ(verdict_of(s), Judged::holds);
}

TEST(SoakVerdict, OwnMissesBreakItAndSoDoesAWalkThatIsWorseThanItsControl) {
    auto s = good_soak();
    s.walk.own_misses = 40;
    EXPECT_EQ(of(s, "deadlines"), Judged::holds);
    s.walk.own_misses = 41;
    EXPECT_EQ(of(s, "deadlines"), Judged::broken);
    s = good_soak();
    s.walk.control.verdict.control_holds = false;
    EXPECT_EQ(of(s, "deadlines"), Judged::broken);
    s = good_soak();
    s.walk.frames = 0;
    EXPECT_EQ(of(s, "deadlines"), Judged::broken);
}

TEST(SoakVerdict, WhatWasTooShortOrTooLightIsNeitherKeptNorBroken) {
    auto s = good_soak();
    s.walk.control.verdict.enough_pairs = false;
    EXPECT_EQ(of(s, "deadlines"), Judged::not_judged);
    s = good_soak();
    s.walk.control.verdict.load_counts = false;
    EXPECT_EQ(of(s, "deadlines"), Judged::not_judged);
    judge_soak(s);
    EXPECT_EQ(verdict_of(s), Judged::not_judged);
    s.walk.own_misses = 1000;
    judge_soak(s);
    EXPECT_EQ(verdict_of(s), Judged::broken) << "broken outweighs not judged";
    s = good_soak();
    s.ran_s = 500;
    s.samples.resize(500);
    EXPECT_EQ(of(s, "memory"), Judged::not_judged);
    s.samples.clear();
    EXPECT_EQ(of(s, "memory"), Judged::not_judged);
    EXPECT_EQ(of(s, "threads"), Judged::not_judged);
}

TEST(SoakVerdict, ALeakOfAPageAMinuteBreaksItAndALateStepOfASampleDoesNot) {
    auto s = good_soak();
    for (auto& sample : s.samples) sample.memory_kib += 4.0 * std::floor(sample.time_s / 60);  // 240 KiB an hour
    EXPECT_EQ(of(s, "memory"), Judged::broken);
    s = good_soak();
    for (std::size_t i = 0; i < s.samples.size(); i += 50) s.samples[i].memory_kib += 50'000;
    EXPECT_EQ(of(s, "memory"), Judged::holds) << "a file read for a moment is no leak";
    s = good_soak();
    for (auto& sample : s.samples) sample.memory_kib -= sample.time_s;
    EXPECT_EQ(of(s, "memory"), Judged::holds) << "shrinking is no leak";
}

TEST(SoakVerdict, ADescriptorThatIsNeverGivenBackBreaksIt) {
    auto s = good_soak();
    for (std::size_t i = 700; i < s.samples.size(); ++i) ++s.samples[i].descriptors;
    EXPECT_EQ(of(s, "descriptors"), Judged::broken);
    EXPECT_EQ(of(s, "threads"), Judged::holds);
    s = good_soak();
    s.samples.back().threads += 1;
    EXPECT_EQ(of(s, "threads"), Judged::holds) << "one that comes and goes";
    for (std::size_t i = 900; i < s.samples.size(); ++i) s.samples[i].threads += 1;
    EXPECT_EQ(of(s, "threads"), Judged::broken);
}

TEST(SoakVerdict, TheGridIsExactOrBroken) {
    auto s = good_soak();
    --s.slots_run;
    EXPECT_EQ(of(s, "grid"), Judged::broken);
    s = good_soak();
    s.grid_drift_ns = 1;
    EXPECT_EQ(of(s, "grid"), Judged::broken);
    s = good_soak();
    s.records_lost = 1;
    EXPECT_EQ(of(s, "grid"), Judged::not_judged);
}

TEST(SoakVerdict, ALoadThatIsTooLightIsNoLoadAndARefusedOneIsReported) {
    auto s = good_soak();
    s.loads[0].real = false;
    EXPECT_EQ(of(s, "load"), Judged::not_judged);
    s = good_soak();
    SoakLoad caches;
    caches.name = "caches";
    s.loads.push_back(caches);
    EXPECT_EQ(of(s, "load"), Judged::holds);
    judge_soak(s);
    EXPECT_NE(s.checks[1].words.find("not run: caches"), std::string::npos) << s.checks[1].words;
}

TEST(SoakVerdict, WithoutRealTimeItIsNotJudgedAndAFaultInTheFrameBreaksIt) {
    auto s = good_soak();
    s.walk.fifo = false;
    EXPECT_EQ(of(s, "real time"), Judged::not_judged);
    s = good_soak();
    s.walk.page_faults = 1;
    EXPECT_EQ(of(s, "real time"), Judged::broken);
    s = good_soak();
    s.walk.clock = "virtual";
    judge_soak(s);
    for (const SoakCheck& check : s.checks) EXPECT_NE(check.name, "real time");
}

TEST(SoakLoads, AreRealByTheirFiguresAndRefusedByTheSystemsWord) {
    const auto describe = [](LoadKind kind, double amount, double evidence, int refused = 0, double other = -1) {
        LoadFigures f;
        f.kind = kind;
        f.seconds = 10;
        f.amount = amount;
        f.evidence = evidence;
        f.refused = refused;
        f.cores = 2;
        return describe_load(f, other);
    };
    EXPECT_TRUE(describe(LoadKind::cpu, 9000, 0, 0, 0.5).real);
    EXPECT_FALSE(describe(LoadKind::cpu, 9000, 0, 0, 0.1).real) << "ordinary scheduling stands it";
    EXPECT_TRUE(describe(LoadKind::cpu, 9000, 0).real);
    EXPECT_FALSE(describe(LoadKind::cpu, 900, 0).real);
    EXPECT_TRUE(describe(LoadKind::memory, 5000, 1e5).real);
    EXPECT_FALSE(describe(LoadKind::memory, 5000, 0).real) << "memory that took no fault was never there";
    EXPECT_FALSE(describe(LoadKind::io, 0, 0).real);
    EXPECT_TRUE(describe(LoadKind::forks, 2000, 2100).real);
    EXPECT_TRUE(describe(LoadKind::devices, 78'000, 80'000).real);
    EXPECT_FALSE(describe(LoadKind::devices, 40'000, 80'000).real) << "half of the storm was lost";
    const SoakLoad refused = describe(LoadKind::caches, 0, 0, EACCES);
    EXPECT_FALSE(refused.ran);
    EXPECT_NE(refused.words.find("not permitted here"), std::string::npos);
}

/// Two frames in time, then one that runs over two slots, and so on, for `frames` frames; every fourth is the control's.
std::vector<rt::FrameRecord> frames_of(int frames) {
    std::vector<rt::FrameRecord> records;
    std::uint64_t slot = 0;
    std::uint32_t skipped = 0;
    for (int i = 0; i < frames; ++i) {
        rt::FrameRecord r;
        r.frame = static_cast<std::uint64_t>(i);
        slot += skipped;
        r.slot = slot++;
        r.skipped_before = skipped;
        r.due_ns = 1'000 + static_cast<std::int64_t>(r.slot) * soak_period_ns;
        r.deadline_ns = r.due_ns + soak_period_ns;
        r.woken_ns = r.selected_ns = r.submitted_ns = r.due_ns;
        const bool late = i % 3 == 2;
        r.rastered_ns = r.complete_ns = r.due_ns + (late ? 5 : 1) * soak_period_ns / 2;
        r.missed = r.own_miss = late;
        r.cause = late ? rt::Cause::submit : rt::Cause::none;
        r.control = i % 4 == 3;
        r.accuracy = i == 10 ? 2.0F : 100.0F;
        skipped = late ? 2 : 0;
        records.push_back(r);
    }
    return records;
}

TEST(SoakTally, CountsTheWalksFramesTheGridAndWhatWasLost) {
    const LoadPlan plan = plan_loads(usual_loads, 60, 4, 1);
    SoakTally tally(plan, soak_period_ns, 60);
    tally.begin(1'000);
    const auto records = frames_of(1200);
    std::uint64_t walked = 0, missed = 0, skipped = 0, skipped_all = 0;
    for (std::size_t i = 0; i < records.size(); ++i) {
        tally.add(records[i]);
        walked += records[i].control ? 0 : 1;
        missed += records[i].missed && !records[i].control ? 1 : 0;
        skipped_all += records[i].skipped_before;
        if (i > 0 && !records[i - 1].control) skipped += records[i].skipped_before;
    }
    SoakSummary s;
    tally.fill(s);
    EXPECT_EQ(s.walk.frames, walked);
    EXPECT_EQ(s.walk.misses, missed);
    EXPECT_EQ(s.walk.own_misses, missed);
    EXPECT_EQ(s.walk.skipped, skipped);
    EXPECT_EQ(s.walk.miss_causes.at("submit"), missed);
    EXPECT_EQ(s.walk.accuracy_min, 2.0);
    EXPECT_EQ(s.slots_run, 1200U);
    EXPECT_EQ(s.slots_skipped, skipped_all);
    EXPECT_EQ(s.slots_run + s.slots_skipped, s.slots_elapsed);
    EXPECT_EQ(s.grid_drift_ns, 0);
    EXPECT_EQ(s.records_lost, 0U);
    std::uint64_t in_phases = 0, in_columns = 0, listed = 0;
    for (const SoakPhase& p : s.phases) in_phases += p.frames;
    for (const SoakColumn& c : s.columns) in_columns += c.frames;
    for (const SoakMiss& m : s.misses) listed += m.skipped;
    EXPECT_EQ(in_phases, walked);
    EXPECT_EQ(in_columns, walked);
    EXPECT_EQ(listed, skipped);
    EXPECT_NEAR(s.walk.frame_ms.max, 41.7, 0.1);
}

TEST(SoakTally, ALostRecordAndAFrameOffItsPlaceAreSeen) {
    const LoadPlan plan = plan_loads(usual_loads, 60, 4, 1);
    auto records = frames_of(100);
    SoakTally lossy(plan, soak_period_ns, 60);
    lossy.begin(1'000);
    for (std::size_t i = 0; i < records.size(); ++i)
        if (i != 50) lossy.add(records[i]);
    SoakSummary s;
    lossy.fill(s);
    EXPECT_GE(s.records_lost, 1U);
    records[70].due_ns += 25;
    SoakTally drifting(plan, soak_period_ns, 60);
    drifting.begin(1'000);
    for (const auto& r : records) drifting.add(r);
    SoakSummary drifted;
    drifting.fill(drifted);
    EXPECT_EQ(drifted.grid_drift_ns, 25);
}

}  // namespace
}  // namespace surefoot::soak
