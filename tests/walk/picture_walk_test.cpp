// The image cache in a walk: seen in its figures, the same at any number of workers, and no violation of the frame thread's
// rules.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/walk/walk_fixture.hpp"
#include "tools/report/report.hpp"

namespace surefoot {
namespace {

TEST(PictureWalk, DrawsAndBuysPicturesWithinTheBudgetAndSaysSo) {
    walk::WalkRequest request = test::Forest::get().virtual_request(50);
    request.cache = true;
    const walk::WalkOutcome outcome = test::walk(request);
    const report::PicturesSummary& pictures = outcome.summary.pictures;
    EXPECT_GT(pictures.made, 0U);
    EXPECT_GT(pictures.drawn_mean, 0.5);
    EXPECT_GT(pictures.max_bytes, 0U);
    EXPECT_EQ(outcome.summary.misses, 0U);
    for (const rt::FrameRecord& r : outcome.records) {
        ASSERT_EQ(r.guard_violations, 0U) << r.frame;
        ASSERT_LE(r.captures_us, 0.25F * r.budget_us + 1) << r.frame;
    }
    const auto json = nlohmann::json::parse(report::to_json(outcome.summary))["pictures"];
    EXPECT_EQ(json["made"], pictures.made);
    request.workers = 3;
    const walk::WalkOutcome again = test::walk(request);
    EXPECT_EQ(again.summary.cut_hash, outcome.summary.cut_hash);
    EXPECT_EQ(again.summary.pictures.made, pictures.made);
}

TEST(PictureWalk, WithoutTheSettingThereAreNone) {
    const walk::WalkOutcome outcome = test::walk(test::Forest::get().virtual_request(30));
    EXPECT_EQ(outcome.summary.pictures.made, 0U);
    EXPECT_EQ(outcome.summary.pictures.max_bytes, 0U);
    for (const rt::FrameRecord& r : outcome.records) ASSERT_EQ(r.pictures + r.bought_items, 0U) << r.frame;
}

}  // namespace
}  // namespace surefoot
