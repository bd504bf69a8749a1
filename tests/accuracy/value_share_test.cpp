// Shares of the greatest value: what counts, what is left out, and that no selector exceeds the bound.
#include "tools/accuracy/value_share.hpp"

#include <gtest/gtest.h>

#include "tests/select/scene.hpp"

namespace surefoot::accuracy {
namespace {

Path street() {
    Path path;
    for (int i = 0; i < 5; ++i) {
        Pose pose;
        pose.position = dvec3(0, 3, 120.0 - 20 * i);
        path.samples.push_back({static_cast<double>(i), pose});
    }
    return path;
}

ShareRequest request_of(std::vector<std::string> selectors) {
    ShareRequest request;
    request.selectors = std::move(selectors);
    request.frames = 6;
    request.limits.max_steps = 100'000;
    request.limits.max_parts = 20;
    return request;
}

TEST(ValueShares, AreBelowOneAndOfTheBoundAtMostThoseOfTheBest) {
    const model::Model town = test::town(5);
    const model::CostModel costs = model::default_costs();
    const auto shares = value_shares(town, costs, street(), request_of({"threshold", "depth-first", "oracle"}), {});
    ASSERT_TRUE(shares.ok());
    EXPECT_EQ(shares->frames, 6U);
    ASSERT_EQ(shares->selectors.size(), 3U);
    for (const ValueShare& s : shares->selectors) {
        EXPECT_LE(s.of_best, 1 + 1e-6) << s.selector;
        EXPECT_LE(s.of_bound, s.of_best + 1e-9) << s.selector;
        EXPECT_LE(s.min_of_best, s.of_best + 1e-9) << s.selector;
        EXPECT_GT(s.min_of_bound, 0) << s.selector;
    }
    EXPECT_GT(shares->selectors[0].of_best, 0.95);
    EXPECT_GT(shares->selectors[0].of_best, shares->selectors[1].of_best);
    EXPECT_NEAR(shares->selectors[2].of_best, 1, 0.01);
    EXPECT_GE(shares->bound_gap, 0);
}

TEST(ValueShares, FramesWithNothingToChooseAreCountedApart) {
    const model::Model town = test::town(4);
    const model::CostModel costs = model::default_costs();
    ShareRequest request = request_of({"threshold"});
    request.budget_us = 1;
    const auto floors = value_shares(town, costs, street(), request, {});
    ASSERT_TRUE(floors.ok());
    EXPECT_EQ(floors->floor_frames, 6U);
    EXPECT_EQ(floors->frames, 0U);
    request.budget_us = 1e9;
    const auto full = value_shares(town, costs, street(), request, {});
    ASSERT_TRUE(full.ok());
    EXPECT_EQ(full->full_frames, 6U);
}

TEST(ValueShares, UnknownSelectorsMissingFilesAndAStopAreErrors) {
    const model::Model town = test::town(3);
    const model::CostModel costs = model::default_costs();
    EXPECT_FALSE(value_shares(town, costs, street(), request_of({"three-stage"}), {}).ok());
    const std::atomic<bool> stop{true};
    const auto stopped =
        value_shares(town, costs, street(), request_of({"threshold"}), {.report = {}, .stop = &stop, .notify = {}});
    ASSERT_FALSE(stopped.ok());
    EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
    walk::WalkRequest walk;
    walk.model_file = "/nonexistent/town.walk";
    EXPECT_FALSE(value_shares_of_walk(walk, request_of({"threshold"}), {}).ok());
}

}  // namespace
}  // namespace surefoot::accuracy
