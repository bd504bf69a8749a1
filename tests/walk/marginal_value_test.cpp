// What one more millisecond would have shown, as each record says: true in the mean when the same walk has it. Near the floor,
// where one dear form decides, it is not: at 4 ms it says 0.22 and 0.06 come.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

/// Means over the frames of a walk.
struct Means {
    double value = 0, one_more_ms = 0;
    std::uint64_t dropped = 0;
};

Means means_at(double budget_ms, const std::string& selector = "threshold", double rate_hz = 30, std::uint64_t length = 60) {
    walk::WalkRequest request = test::Forest::get().virtual_request(length);
    request.rest_after_ms = 0;
    request.resolution_pct = 100;
    request.backend = "null";
    request.hysteresis = 1;
    request.reserve_pct = 0;
    request.budget_ms = budget_ms;
    request.rate_hz = rate_hz;
    request.selector = selector;
    auto costs = std::make_shared<model::CostModel>(model::default_costs());
    costs->combine.submit_weight *= 3;  // the small forest is cheap
    costs->combine.raster_weight *= 3;
    request.given_costs = costs;
    const walk::WalkOutcome outcome = test::walk(request);
    Means means;
    for (const rt::FrameRecord& r : outcome.records) {
        EXPECT_GE(r.one_more_ms, 0);
        EXPECT_LE(r.one_more_ms, 1) << r.frame;
        means.value += double{r.value} / static_cast<double>(outcome.records.size());
        means.one_more_ms += double{r.one_more_ms} / static_cast<double>(outcome.records.size());
        means.dropped += r.dropped_objects;
    }
    return means;
}

TEST(MarginalValue, IsWhatTheSameWalkGainsByAMillisecondMore) {
    for (const double budget_ms : {7.0, 10.0}) {
        const Means now = means_at(budget_ms), more = means_at(budget_ms + 1);
        const double gained = more.value - now.value;
        std::printf("%.0f ms: value %.4f, one more ms is said to add %.4f, adds %.4f\n", budget_ms, now.value, now.one_more_ms,
                    gained);
        EXPECT_NEAR(now.one_more_ms, gained, 0.2 * gained) << budget_ms;
    }
}

TEST(MarginalValue, IsNothingWhereFullDetailFits) {
    const Means all = means_at(400, "threshold", 2, 10);
    EXPECT_NEAR(all.value, 1, 1e-6);
    EXPECT_EQ(all.one_more_ms, 0);
}

TEST(MarginalValue, SelectorsWithoutGroupsLeaveObjectsOut) {
    EXPECT_EQ(means_at(4, "threshold", 30, 10).dropped, 0U);
    EXPECT_GT(means_at(4, "greedy", 30, 10).dropped, 0U);
    EXPECT_GT(means_at(4, "reactive", 30, 10).dropped, 0U);
    EXPECT_EQ(means_at(4, "static", 30, 10).one_more_ms, 0) << "it has no budget";
    EXPECT_EQ(means_at(7, "curve-budget", 30, 10).one_more_ms, 0) << "its time goes to accuracy";
}

}  // namespace
}  // namespace surefoot
