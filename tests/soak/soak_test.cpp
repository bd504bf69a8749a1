// A soak as a whole, on the virtual clock: an hour in seconds, the same figures every time, and a page and JSON that hold them.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "rt/base/file.hpp"
#include "rt/threads/guard.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/soak/soak.hpp"

namespace surefoot::soak {
namespace {

using test::Forest;

/// Hundreds of frames; a sanitizer makes a second ten times as long.
const double a_while_s = rt::guard_active() ? 60 : 20;

SoakRequest virtual_soak(double seconds) {
    SoakRequest r;
    r.walk = Forest::get().virtual_request(0);
    r.seconds = seconds;
    return r;
}

TEST(Soak, TwentyVirtualMinutesHoldAndLeaveAPageAndTheirFigures) {
    // The sanitizers keep freed memory, which a soak rightly calls growth: all but that is judged there.
    const bool memory_counts = rt::guard_active();
    const std::uint64_t minutes = memory_counts ? 20 : 2;  // they are also ten times slower
    SoakRequest request = virtual_soak(static_cast<double>(minutes) * 60);
    request.report_dir = Forest::get().dir + "/soak";
    auto outcome = run_soak(request, {});
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    const SoakSummary& s = outcome->summary;
    for (const SoakCheck& check : s.checks) {
        if (!memory_counts && check.name == "memory") continue;
        EXPECT_EQ(check.judged, Judged::holds) << check.name << ": " << check.words;
    }
    EXPECT_EQ(s.walk.frames, minutes * 60 * 30);
    EXPECT_EQ(s.slots_run + s.slots_skipped, s.slots_elapsed);
    EXPECT_EQ(s.grid_drift_ns, 0);
    EXPECT_GT(s.samples.size(), 5 * minutes);
    ASSERT_EQ(s.loads.size(), 1U) << "nothing contends on a virtual clock";
    EXPECT_EQ(s.loads[0].name, "reloads");
    EXPECT_TRUE(s.loads[0].real) << s.loads[0].words;
    EXPECT_FALSE(s.machine.kernel.empty());
    EXPECT_FALSE(s.command_line.empty());

    const auto page = read_text(outcome->report_page);
    ASSERT_TRUE(page.ok());
    const std::string verdict = memory_counts ? "the verdict holds" : "not judged",
                      time = fmt::format("{} minutes of virtual time", minutes);
    for (const char* expected : {time.c_str(), verdict.c_str(), "descriptors", "Interrupts"})
        EXPECT_NE(page->find(expected), std::string::npos) << expected;
    EXPECT_EQ(page->find("nan"), std::string::npos);
    EXPECT_EQ(page->find("http"), std::string::npos) << "the page asks the network for something";
    const auto json = nlohmann::json::parse(*read_text(request.report_dir + "/soak.json"));
    EXPECT_EQ(json["verdict"], memory_counts ? "holds" : "not judged");
    EXPECT_EQ(json["walk"]["frames"], minutes * 60 * 30);
    EXPECT_EQ(json["grid"]["drift_ns"], 0);
    for (const char* key : {"kernel", "kernel_command_line", "interrupts", "pressure", "steal_ms"})
        EXPECT_TRUE(json["machine"].contains(key)) << key;
}

TEST(Soak, IsTheSameTwice) {
    SoakSummary two[2];
    for (SoakSummary& s : two) {
        auto outcome = run_soak(virtual_soak(a_while_s), {});
        ASSERT_TRUE(outcome.ok());
        s = outcome->summary;
    }
    EXPECT_EQ(two[0].walk.frame_ms.max, two[1].walk.frame_ms.max);
    EXPECT_EQ(two[0].walk.accuracy_min, two[1].walk.accuracy_min);
    ASSERT_EQ(two[0].phases.size(), two[1].phases.size());
    EXPECT_EQ(two[0].phases.back().frames, two[1].phases.back().frames);
}

TEST(Soak, CostsThatAreThreeTimesWhatIsPredictedBreakItsVerdict) {
    SoakRequest request = virtual_soak(a_while_s);
    request.walk.cost_scale = 3;
    request.walk.correct_costs = false;
    request.walk.in_frame_check = false;
    auto outcome = run_soak(request, {});
    ASSERT_TRUE(outcome.ok());
    EXPECT_EQ(verdict_of(outcome->summary), Judged::broken);
    EXPECT_GT(outcome->summary.walk.own_misses, 100U);
    EXPECT_FALSE(outcome->summary.misses.empty());
}

TEST(Soak, StoppedItJudgesWhatRan) {
    std::atomic<bool> stop{true};
    Progress progress;
    progress.stop = &stop;
    auto outcome = run_soak(virtual_soak(600), progress);
    ASSERT_TRUE(outcome.ok());
    EXPECT_TRUE(outcome->summary.stopped);
    EXPECT_LT(outcome->summary.ran_s, 600);
}

}  // namespace
}  // namespace surefoot::soak
