// A walk that stands still for a while: what its records and figures say, and that nothing else changes.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "render/rest.hpp"
#include "render/select/registry.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

/// Walks for two seconds, stands for ten, walks on for two.
std::shared_ptr<const Path> with_a_stand() {
    auto along = read_path(test::Forest::get().path_file);
    EXPECT_TRUE(along.ok());
    auto path = std::make_shared<Path>();
    const double step_s = 0.1;
    for (int i = 0; i <= 140; ++i) {
        PathSample& at = path->samples.emplace_back();
        at.time_s = i * step_s;
        at.pose = sample_path(*along, i <= 20 ? i * step_s : i <= 120 ? 2 : (i - 100) * step_s);
    }
    return path;
}

walk::WalkOutcome walked(double rest_after_ms, std::string_view selector) {
    walk::WalkRequest request = test::Forest::get().virtual_request(420);
    request.path_file.clear();
    request.given_path = with_a_stand();
    request.rest_after_ms = rest_after_ms;
    request.selector = selector;
    return test::walk(request);
}

TEST(RestWalk, RestsWhereItStandsAndChangesNothingElse) {
    // Frames at rest teach the correction nothing. Afterwards its sixth digit differs; this selector is not so fine. Neither is
    // threshold; two-stage is, in some models.
    const auto with = walked(500, "best-first"), without = walked(0, "best-first");
    ASSERT_EQ(with.records.size(), 420U);
    ASSERT_EQ(without.records.size(), 420U);
    std::uint32_t samples = 0;
    int rests = 0;
    for (std::size_t i = 0; i < with.records.size(); ++i) {
        const rt::FrameRecord &f = with.records[i], &g = without.records[i];
        const bool stands = i >= 60 + 15 && i <= 360;  // the last of them is a hair before the path goes on
        ASSERT_EQ(f.at_rest, stands && f.at_rest) << "frame " << i << " moves";
        ASSERT_FALSE(g.at_rest);
        ASSERT_EQ(f.cut_hash, g.cut_hash) << i;
        ASSERT_EQ(f.missed, g.missed) << i;
        ASSERT_EQ(f.guard_violations, 0U);
        ASSERT_EQ(f.skipped_before, g.skipped_before);
        ASSERT_FALSE(f.at_rest && f.floor_frame);
        if (f.at_rest) {
            ++rests;
            ASSERT_GE(f.rest_samples, samples) << i;
            samples = f.rest_samples;
            ASSERT_TRUE(f.rest_samples == 0 || std::isinf(f.accuracy));
        } else {
            ASSERT_EQ(f.items, g.items) << i;
            ASSERT_EQ(f.triangles, g.triangles) << i;
            ASSERT_EQ(f.resolution, g.resolution) << i;
            ASSERT_EQ(f.rest_samples, 0U);
        }
    }
    EXPECT_GE(rests, 280);
    EXPECT_GT(samples, 1U);
    EXPECT_EQ(with.summary.rest_frames, static_cast<std::uint64_t>(rests));
    EXPECT_EQ(with.summary.rest_samples, samples);
    EXPECT_GT(with.summary.rested_frames, 0U);
    EXPECT_GT(with.summary.rest_ms, 0);
    EXPECT_LE(with.summary.rest_ms, 1000);
    EXPECT_EQ(without.summary.rest_frames, 0U);
    EXPECT_EQ(with.summary.misses, without.summary.misses);
}

TEST(RestWalk, ChangesPredictionsHardlyWhereTheWalkGoesOn) {
    const auto with = walked(500, select::usual_selector), without = walked(0, select::usual_selector);
    ASSERT_EQ(with.records.size(), 420U);
    ASSERT_EQ(without.records.size(), 420U);
    for (std::size_t i = 0; i < with.records.size(); ++i) {
        const rt::FrameRecord &f = with.records[i], &g = without.records[i];
        ASSERT_TRUE(i > 360 || f.cut_hash == g.cut_hash) << i;
        ASSERT_NEAR(f.correction, g.correction, 1e-4) << i;
        ASSERT_TRUE(f.at_rest || std::abs(f.predicted_us - g.predicted_us) <= 0.01F * g.predicted_us) << i;
    }
}

}  // namespace
}  // namespace surefoot
