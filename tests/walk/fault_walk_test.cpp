// Faults that are injected into a walk on the real clock: uploads, pictures that are drawn again, late sets. And that its records
// know the steal of their cores. Nothing here depends on how fast the machine is.
#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>

#include "rt/clock/clock.hpp"
#include "tests/time_units.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/report/report.hpp"

namespace surefoot {
namespace {

walk::WalkRequest quick_real_request() {
    walk::WalkRequest request = test::Forest::get().virtual_request(8);
    request.clock = rt::ClockKind::real;
    request.fifo = false;
    request.rate_hz = 200;
    return request;
}

TEST(FaultWalk, UploadsRedrawingsAndLateSetsAreOfTheFrameThatTheyAreInjectedInto) {
    rt::RealClock clock;
    std::atomic<int> sets{0};
    int drawn_again = 0;
    walk::WalkObserver observer;
    observer.inject = [&](walk::FramePhase phase, const rt::FrameRecord& r) {
        if (phase == walk::FramePhase::submit && r.frame == 3) {
            clock.burn_ns(2 * ms);
            return walk::Fault::upload;
        }
        if (phase == walk::FramePhase::raster && r.frame == 5 && drawn_again < 4) {
            ++drawn_again;
            clock.burn_ns(1 * ms);
            return walk::Fault::draw_again;
        }
        return walk::Fault::none;
    };
    observer.inject_prepare = [&] { ++sets; };
    const auto outcome = walk::run_walk(quick_real_request(), {}, observer);
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    ASSERT_EQ(outcome->records.size(), 8U);
    EXPECT_EQ(drawn_again, 4);
    EXPECT_GT(sets.load(), 0);
    EXPECT_TRUE(nlohmann::json::parse(report::to_json(outcome->summary))["core_steal_misses"].is_number());
    for (const rt::FrameRecord& r : outcome->records) {
        EXPECT_EQ(r.upload_ns >= 2 * ms, r.frame == 3) << r.frame;
        EXPECT_GE(r.core_steal_ns, 0) << "its cores' steal is known, frame " << r.frame;
        if (r.frame == 5) {
            EXPECT_GE(r.rastered_ns - r.submitted_ns, 3 * ms);
        }
    }
}

TEST(FaultWalk, OnTheVirtualClockNobodyReadsTheStealOfCores) {
    for (const rt::FrameRecord& r : test::walk(test::Forest::get().virtual_request(3)).records) EXPECT_EQ(r.core_steal_ns, -1);
}

}  // namespace
}  // namespace surefoot
