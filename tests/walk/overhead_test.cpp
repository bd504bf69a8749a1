// The overhead factor of a walk on the real clock: it multiplies what is predicted, the record shows it, and the correction does
// not take it back. The null backend predicts without GL.
#include <gtest/gtest.h>

#include "tests/walk/walk_fixture.hpp"
#include "tools/walk/walk_session.hpp"

namespace surefoot {
namespace {

using test::walk;

/// Frames that were selected as usual, not drawn coarse.
struct Selected {
    std::size_t frames = 0;
    double predicted_us = 0, triangles = 0;  ///< means
    float last_correction = 1;
    float cost_scale = 0;  ///< of all frames; 0: they differ
};

Selected walk_at(double cost_scale, double budget_ms, bool correct_costs) {
    walk::WalkRequest request = test::Forest::get().virtual_request(60);
    request.clock = rt::ClockKind::real;
    request.fifo = false;
    request.rate_hz = 20;  // a slow, busy host prepares most frames in time as well
    request.in_frame_check = false;
    request.occlusion = false;
    request.budget_ms = budget_ms;
    request.correct_costs = correct_costs;
    request.cost_scale = cost_scale;
    const walk::WalkOutcome outcome = walk(request);
    Selected s;
    for (const rt::FrameRecord& r : outcome.records) {
        if (s.frames == 0) s.cost_scale = r.cost_scale;
        if (r.cost_scale != s.cost_scale) ADD_FAILURE() << "frame " << r.frame << " says " << r.cost_scale;
        if (r.candidates == 0) continue;
        ++s.frames;
        s.predicted_us += r.predicted_us;
        s.triangles += static_cast<double>(r.triangles);
        s.last_correction = r.correction;
    }
    EXPECT_GT(s.frames, 20U);
    EXPECT_EQ(outcome.summary.cost_scale, cost_scale);
    s.predicted_us /= static_cast<double>(s.frames);
    s.triangles /= static_cast<double>(s.frames);
    return s;
}

TEST(Overhead, MultipliesEveryPredictedCost) {
    model::CostModel costs = model::default_costs();
    const model::CostModel more = walk::with_overhead(costs, 1.5);
    EXPECT_FLOAT_EQ(more.combine.frame_us(300, 700), 1.5F * costs.combine.frame_us(300, 700));
    EXPECT_FLOAT_EQ(more.combine.frame_us(700, 300), 1.5F * costs.combine.frame_us(700, 300));
    EXPECT_EQ(more.headroom, costs.headroom);
    const model::Viewport picture{1280, 720};
    const model::Quality smooth{4, rt::TextureFilter::bilinear, rt::TextureFilter::bilinear};
    const model::CostModel of_samples = model::at_quality(costs, smooth), more_of_samples = model::at_quality(more, smooth);
    const auto fixed_us = [&](const model::CostModel& of) { return of.combine_at(0.5F, picture).fixed_us; };
    EXPECT_GT(fixed_us(of_samples), fixed_us(costs));
    EXPECT_FLOAT_EQ(fixed_us(more_of_samples), 1.5F * fixed_us(of_samples));
    EXPECT_FLOAT_EQ(more.enlarge_us(0.5F, picture), 1.5F * costs.enlarge_us(0.5F, picture));
    EXPECT_FLOAT_EQ(more_of_samples.rest_pass_us(picture), 1.5F * of_samples.rest_pass_us(picture));
    const model::CostModel of_sky = model::with_background(costs), more_of_sky = model::with_background(more);
    EXPECT_GT(fixed_us(of_sky), fixed_us(costs));
    EXPECT_FLOAT_EQ(fixed_us(more_of_sky), 1.5F * fixed_us(of_sky));
    EXPECT_FLOAT_EQ(more_of_sky.rest_pass_us(picture), 1.5F * of_sky.rest_pass_us(picture));
}

TEST(Overhead, OnTheRealClockFullDetailIsPredictedDearerAndTheRecordSaysBy) {
    const Selected one = walk_at(1, 1000, false), three = walk_at(3, 1000, false);
    EXPECT_NEAR(three.triangles / one.triangles, 1, 0.1) << "full detail fits both";
    EXPECT_NEAR(three.predicted_us / one.predicted_us, 3, 0.4);
    EXPECT_EQ(one.cost_scale, 1);
    EXPECT_EQ(three.cost_scale, 3);
}

TEST(Overhead, OnTheRealClockABudgetBuysLess) {
    const Selected one = walk_at(1, 13, false), more = walk_at(1.5, 13, false);
    EXPECT_LT(more.triangles, 0.8 * one.triangles);
}

TEST(Overhead, IsNotTakenBackByTheCorrection) {
    // The null device takes a fraction of what is predicted, so the correction falls to its lowest. With a predicted cost of
    // nearly nothing it would rise instead, if the factor were taken for the machine's error.
    EXPECT_LT(walk_at(1, 1000, true).last_correction, 0.6F);
    EXPECT_LT(walk_at(0.01, 1000, true).last_correction, 0.6F);
}

}  // namespace
}  // namespace surefoot
