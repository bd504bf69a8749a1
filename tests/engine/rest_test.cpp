// At rest: when the eye counts as still, and what is shown then. Pictures on software GL; times by predicted costs or a counted
// clock, so that they are the same on every machine.
#include "render/rest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "render/measure/image_metrics.hpp"
#include "tests/engine/forest_engine.hpp"
#include "tests/gl/small_models.hpp"
#include "tests/select/count_malloc.hpp"

namespace surefoot {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t period_ns = 33 * ms;
constexpr double frame_limit_us = 32'000;

TEST(RestWatch, RestsAfterTheTimeAndNotBefore) {
    RestWatch watch(500 * ms);
    const Pose pose;
    EXPECT_FALSE(watch.at_rest(pose, 0));
    EXPECT_FALSE(watch.at_rest(pose, 499 * ms));
    EXPECT_TRUE(watch.at_rest(pose, 500 * ms));
    EXPECT_TRUE(watch.at_rest(pose, 5000 * ms));
}

TEST(RestWatch, ANoiseBelowBothThresholdsIsNoMovement) {
    RestWatch watch(500 * ms);
    Pose pose;
    EXPECT_FALSE(watch.at_rest(pose, 0));
    pose.position.x = 0.9 * RestWatch::still_m;
    pose.orientation = glm::angleAxis(0.9 * RestWatch::still_rad, dvec3(0, 1, 0));
    EXPECT_TRUE(watch.at_rest(pose, 600 * ms));
    pose.orientation = -pose.orientation;  // the same direction
    EXPECT_TRUE(watch.at_rest(pose, 700 * ms));
}

TEST(RestWatch, AnyMovementAboveAThresholdBeginsAnew) {
    const auto still_after = [](auto change) {
        RestWatch watch(500 * ms);
        Pose pose;
        watch.at_rest(pose, 0);
        EXPECT_TRUE(watch.at_rest(pose, 600 * ms));
        change(pose);
        EXPECT_FALSE(watch.at_rest(pose, 700 * ms));
        EXPECT_FALSE(watch.at_rest(pose, 1199 * ms));
        return watch.at_rest(pose, 1200 * ms);
    };
    EXPECT_TRUE(still_after([](Pose& pose) { pose.position.z += 1.1 * RestWatch::still_m; }));
    EXPECT_TRUE(still_after([](Pose& pose) { pose.orientation = glm::angleAxis(1.1 * RestWatch::still_rad, dvec3(1, 0, 0)); }));
    EXPECT_TRUE(still_after([](Pose& pose) { pose.fov_y_rad += 1.1 * RestWatch::still_rad; }));
}

TEST(RestWatch, ASlowDriftEndsARest) {
    RestWatch watch(500 * ms);
    Pose pose;
    bool rested = false, ended = false;
    for (int frame = 0; frame < 200; ++frame) {
        const bool rests = watch.at_rest(pose, frame * 10 * ms);
        ended = ended || (rested && !rests);
        rested = rested || rests;
        pose.position.x += 0.015 * RestWatch::still_m;
    }
    EXPECT_TRUE(rested);
    EXPECT_TRUE(ended);
}

TEST(RestWatch, NeverRestsWhereItIsOffOrThePoseIsNoNumberOrTimeRunsBackwards) {
    RestWatch off(0);
    EXPECT_FALSE(off.at_rest({}, 0));
    EXPECT_FALSE(off.at_rest({}, 1'000'000 * ms));
    RestWatch watch(500 * ms);
    Pose lost;
    lost.position.x = std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < 5; ++i) EXPECT_FALSE(watch.at_rest(lost, i * 1000 * ms));
    EXPECT_FALSE(watch.at_rest({}, 5000 * ms));
    EXPECT_FALSE(watch.at_rest({}, 4000 * ms));
    EXPECT_FALSE(watch.at_rest({}, 4400 * ms));
    EXPECT_TRUE(watch.at_rest({}, 4500 * ms));
    watch.forget();
    EXPECT_FALSE(watch.at_rest({}, 4600 * ms));
}

TEST(RestOffset, SamplesLieWithinAPixelAndSpreadEvenly) {
    EXPECT_EQ(rest_offset_px(0), dvec2(0));
    std::vector<int> columns(8), rows(8);
    dvec2 mean(0);
    for (std::uint32_t i = 0; i < max_rest_samples; ++i) {
        const dvec2 at = rest_offset_px(i);
        ASSERT_TRUE(std::abs(at.x) <= 0.5 && std::abs(at.y) <= 0.5) << i;
        ++columns[static_cast<std::size_t>(std::min(7.0, 8 * (at.x + 0.5)))];
        ++rows[static_cast<std::size_t>(std::min(7.0, 8 * (at.y + 0.5)))];
        mean += at / double{max_rest_samples};
    }
    for (const auto* counts : {&columns, &rows})
        for (const int count : *counts) EXPECT_NEAR(count, 8, 2);
    EXPECT_LT(glm::length(mean), 0.02);
}

/// An engine that stands or walks, frame by frame. Without a clock of its own: what is drawn takes as long as predicted.
struct Walk {
    std::unique_ptr<Engine> engine;
    prepare::PreparedFrame prepared;
    std::int64_t at_ns = 0;
    double budget_us = 3000;  ///< little, so that the cut is coarse
    double limit = frame_limit_us;

    SubmitReport frame(const Pose& pose) {
        at_ns += period_ns;
        engine->prepare({pose, 0.25, 0.06}, 0, 0, 0, prepared);
        engine->select(prepared, budget_us, {}, 0);
        SubmitLimits limits;
        limits.limit_us = limit;
        limits.frame_ns = at_ns;
        return engine->submit(pose, limits);
    }
    std::vector<std::uint8_t> picture() {
        engine->device().draws.plays();
        auto image = engine->device().read_pixels();
        EXPECT_TRUE(image.ok());
        return image.ok() ? std::move(image->rgba) : std::vector<std::uint8_t>{};
    }
};

constexpr model::Viewport size{160, 96};

model::CostModel slow_costs() {
    model::CostModel costs = model::default_costs();
    costs.combine.submit_weight *= 30;  // full detail takes several frames
    costs.combine.raster_weight *= 30;
    return costs;
}

/// Baked once.
const model::Model& forest() {
    static const model::Model baked = [] {
        auto scene = scenes::generate("forest", 0.2, 1);
        EXPECT_TRUE(scene.ok());
        auto model = bake::bake(scene->scene, {}, {});
        EXPECT_TRUE(model.ok());
        return std::move(*model);
    }();
    return baked;
}

Walk open(gl::BackendKind backend, double rest_after_ms, float resolution = 1) {
    Walk walk;
    EngineOptions options;
    options.device.kind = backend;
    options.device.viewport = size;
    options.rest_after_ms = rest_after_ms;
    options.resolution = resolution;
    auto opened = Engine::open(forest(), slow_costs(), options);
    if (opened) {
        walk.engine = std::move(*opened);
        walk.engine->device().draws.plays();
        walk.engine->reserve(walk.prepared);
    }
    return walk;
}

double psnr_db(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    const double mse = measure::snr(a, b).mse;
    return mse > 0 ? 10 * std::log10(255.0 * 255.0 / mse) : std::numeric_limits<double>::infinity();
}

std::vector<std::uint8_t> full_picture(Walk& walk, const Pose& pose) {
    walk.engine->draw_unbudgeted(pose, walk.engine->full_detail(pose));
    return walk.picture();
}

/// The mean of 64 pictures on a regular grid, which share no position with the samples but the middle.
std::vector<std::uint8_t> grid_of_64(Walk& walk, const Pose& pose) {
    gl::Device& device = walk.engine->device();
    device.draws.plays();
    const auto items = walk.engine->full_detail(pose);
    std::vector<double> sum;
    for (int i = 0; i < 64; ++i) {
        const int column = i % 8, row = i / 8;
        device.begin_rest(pose, {(column + 0.5) / 8 - 0.5, (row + 0.5) / 8 - 0.5});
        for (const auto parts : {gl::Parts::opaque, gl::Parts::blended}) device.draw_rest(items, parts);
        device.show_rest(1);
        device.finish_rest_frame();
        const auto one = walk.picture();
        sum.resize(one.size());
        for (std::size_t p = 0; p < one.size(); ++p) sum[p] += double(one[p]);
    }
    std::vector<std::uint8_t> mean;
    for (const double value : sum) mean.push_back(static_cast<std::uint8_t>(std::lround(value / 64)));
    return mean;
}

TEST(Rest, StandingStillShowsFullDetailToTheBitThenASmoothPicture) {
    Walk walk = open(gl::BackendKind::egl, 500);
    if (!walk.engine) GTEST_SKIP() << "no software GL";
    const Pose pose = test::forest_pose(*walk.engine);
    std::vector<std::uint8_t> last, rested;
    std::uint32_t samples = 0;
    int drawing = 0, sampling = 0;
    for (int i = 0; i < 600; ++i) {  // 20 s
        const SubmitReport report = walk.frame(pose);
        auto now = walk.picture();
        ASSERT_EQ(report.at_rest, i >= 16) << i;  // 500 ms are over with the 16th period
        EXPECT_LE(report.predicted_us, walk.limit);
        ASSERT_GE(report.rest_samples, samples) << "a picture became worse";
        if (report.at_rest && report.rest_samples == 0) {
            ++drawing;
            ASSERT_EQ(now, last) << "frame " << i << ": the picture moved before full detail was whole";
        }
        if (report.rest_samples > 0 && rested.empty()) rested = now;
        if (report.rest_samples == samples && samples > 0) {
            ASSERT_EQ(now, last);
        }
        if (report.rest_samples > samples) ++sampling;
        samples = report.rest_samples;
        last = std::move(now);
    }
    EXPECT_GE(drawing, 2) << "full detail fitted one frame: this test shows nothing";
    EXPECT_GE(sampling, 10);
    EXPECT_EQ(samples, max_rest_samples);
    EXPECT_EQ(walk.frame(pose).predicted_us, 0) << "nothing is left to draw";
    EXPECT_EQ(walk.frame(pose).slices, 0U);
    const auto full = full_picture(walk, pose), smooth = grid_of_64(walk, pose);
    EXPECT_EQ(psnr_db(rested, full), std::numeric_limits<double>::infinity());
    EXPECT_GE(psnr_db(last, smooth), 35);
    EXPECT_GT(psnr_db(last, smooth), psnr_db(full, smooth) + 3) << "samples smooth the picture";
}

TEST(Rest, TheRestedPictureIsWholeWhateverTheResolutionOfTheWalk) {
    Walk walk = open(gl::BackendKind::egl, 500, 0.5F);
    if (!walk.engine) GTEST_SKIP() << "no software GL";
    const Pose pose = test::forest_pose(*walk.engine);
    SubmitReport report;
    for (int i = 0; i < 600 && report.rest_samples == 0; ++i) report = walk.frame(pose);
    ASSERT_GT(report.rest_samples, 0U);
    EXPECT_EQ(report.resolution, 1);
    while (report.rest_samples < max_rest_samples) report = walk.frame(pose);
    Walk whole = open(gl::BackendKind::egl, 500);
    whole.engine->device().bind();
    SubmitReport same;
    while (same.rest_samples < report.rest_samples) same = whole.frame(pose);
    const auto expected = whole.picture();
    walk.engine->device().bind();
    ASSERT_EQ(same.rest_samples, report.rest_samples);
    EXPECT_EQ(walk.picture(), expected);
}

// Moves away in each phase: before full detail is whole, when it is shown, while samples are added, and at the end.
TEST(Rest, AMovementShowsInTheSameFrameWhatAWalkWithoutRestShows) {
    for (const std::uint32_t until : {0U, 1U, 7U, max_rest_samples}) {
        Walk with = open(gl::BackendKind::egl, 500);
        if (!with.engine) GTEST_SKIP() << "no software GL";
        Walk without = open(gl::BackendKind::egl, 0);
        Pose pose = test::forest_pose(*with.engine);
        with.engine->device().bind();
        int shown = 0;
        for (SubmitReport report; !report.at_rest || report.rest_samples < until; ++shown) report = with.frame(pose);
        std::vector<std::vector<std::uint8_t>> moved;
        for (int i = 0; i < 5; ++i) {
            pose.position.x += 0.05;
            EXPECT_FALSE(with.frame(pose).at_rest);
            moved.push_back(with.picture());
        }
        without.engine->device().bind();
        pose = test::forest_pose(*without.engine);
        for (int i = 0; i < shown; ++i) without.frame(pose);
        for (int i = 0; i < 5; ++i) {
            pose.position.x += 0.05;
            EXPECT_FALSE(without.frame(pose).at_rest);
            EXPECT_EQ(without.picture(), moved[static_cast<std::size_t>(i)]) << "frame " << i << " after " << until << " samples";
        }
    }
}

/// Squares of every effect, glass included.
Walk open_mixed() {
    Walk walk;
    EngineOptions options;
    options.device.viewport = size;
    options.rest_after_ms = 500;
    options.slice_us = 50;  // blended parts take several slices
    std::vector<gl::DrawItem> items;
    auto opened = Engine::open(test::mixed_scene(items), slow_costs(), options);
    if (opened) {
        walk.engine = std::move(*opened);
        walk.engine->device().draws.plays();
        walk.engine->reserve(walk.prepared);
    }
    return walk;
}

TEST(Rest, BlendedPartsLieInTheOrderOfAFrame) {
    Walk walk = open_mixed();
    if (!walk.engine) GTEST_SKIP() << "no software GL";
    Pose pose;
    pose.fov_y_rad = 1.5707963267948966;
    SubmitReport report;
    for (int i = 0; i < 600 && report.rest_samples == 0; ++i) report = walk.frame(pose);
    ASSERT_GT(report.rest_samples, 0U);
    while (report.rest_samples < max_rest_samples) report = walk.frame(pose);
    const auto last = walk.picture(), smooth = grid_of_64(walk, pose);
    EXPECT_GE(psnr_db(last, smooth), 35);
    walk.engine->draw_unbudgeted(pose, {});  // begins anew
    const auto full = full_picture(walk, pose);
    walk.limit = 3000;  // a sample a frame at most
    report = {};
    for (int i = 0; i < 600 && report.rest_samples == 0; ++i) report = walk.frame(pose);
    ASSERT_EQ(report.rest_samples, 1U);
    EXPECT_EQ(walk.picture(), full);
}

TEST(Rest, AfterAPictureForAReportTheNextFrameDrawsItsCut) {
    Walk walk = open(gl::BackendKind::egl, 500);
    if (!walk.engine) GTEST_SKIP() << "no software GL";
    const Pose pose = test::forest_pose(*walk.engine);
    SubmitReport report;
    while (report.rest_samples < 2) report = walk.frame(pose);
    walk.engine->draw_unbudgeted(pose, {});
    report = walk.frame(pose);
    EXPECT_FALSE(report.at_rest);
    EXPECT_GT(report.items, 0U);
}

TEST(Rest, ChargesWhatItPredictsAndNeverMoreThanTheTimeThatIsLeft) {
    Walk walk = open(gl::BackendKind::null, 500);
    ASSERT_NE(walk.engine, nullptr);
    const Pose pose = test::forest_pose(*walk.engine);
    bool rested = false;
    for (int i = 0; i < 600; ++i) {
        const SubmitReport report = walk.frame(pose);
        if (!report.at_rest) continue;
        EXPECT_NEAR(report.finished_us, report.predicted_us, 1 + 1e-3 * report.predicted_us);
        EXPECT_LE(report.finished_us, walk.limit);
        rested = rested || report.rest_samples == max_rest_samples;
    }
    EXPECT_TRUE(rested);
}

TEST(Rest, SaysWhatIsShown) {
    Walk walk = open(gl::BackendKind::null, 500);
    ASSERT_NE(walk.engine, nullptr);
    const Pose pose = test::forest_pose(*walk.engine);
    SubmitReport before, report;
    for (int i = 0; i < 17; ++i) report = walk.frame(pose), before = report.at_rest ? before : report;
    ASSERT_TRUE(report.at_rest);
    ASSERT_EQ(report.rest_samples, 0U);
    EXPECT_EQ(report.triangles, before.triangles) << "the last cut is still shown";
    EXPECT_EQ(report.worst_error_rad, before.worst_error_rad);
    while (report.rest_samples == 0) report = walk.frame(pose);
    EXPECT_EQ(report.worst_error_rad, 0);
    EXPECT_GT(report.triangles, before.triangles);
    const auto full = walk.engine->full_detail(pose);
    EXPECT_GE(report.items, full.size());
    const auto drawn = walk.engine->drawn();
    for (const gl::DrawItem& item : full)
        EXPECT_TRUE(
            std::any_of(drawn.begin(), drawn.end(), [&](const auto& d) { return d.node == item.node && d.rep == item.rep; }));
}

// No frame has the time for a part of this picture. Then the walk goes on as without a rest.
TEST(Rest, APictureThatFitsNoFrameIsRefusedAndTheCutIsDrawnAgain) {
    Walk walk = open(gl::BackendKind::null, 500);
    ASSERT_NE(walk.engine, nullptr);
    Pose pose = test::forest_pose(*walk.engine);
    walk.limit = 200;
    int rests = 0, after = 0;
    for (int i = 0; i < 200; ++i) {
        const SubmitReport report = walk.frame(pose);
        EXPECT_EQ(report.rest_samples, 0U);
        if (report.at_rest) {
            ++rests;
            EXPECT_LE(report.finished_us, walk.limit);
        } else if (rests > 0) {
            ++after;
        }
    }
    EXPECT_GT(rests, 0);
    EXPECT_GT(after, 50) << "the shown cut stayed for ever";
    walk.limit = frame_limit_us;
    pose.position.x += 1;
    SubmitReport report;
    for (int i = 0; i < 100 && report.rest_samples == 0; ++i) report = walk.frame(pose);
    EXPECT_GT(report.rest_samples, 0U) << "another pose is tried again";
}

// Full detail is never taken back while the eye stands still, not even if no further sample fits.
TEST(Rest, AWholePictureStaysWhereNoSampleFitsAnyMore) {
    Walk walk = open(gl::BackendKind::null, 500);
    ASSERT_NE(walk.engine, nullptr);
    const Pose pose = test::forest_pose(*walk.engine);
    SubmitReport report;
    for (int i = 0; i < 100 && report.rest_samples == 0; ++i) report = walk.frame(pose);
    ASSERT_GT(report.rest_samples, 0U);
    const std::size_t items = walk.engine->drawn().size();
    walk.limit = 200;
    for (int i = 0; i < 200; ++i) {
        report = walk.frame(pose);
        EXPECT_TRUE(report.at_rest) << i;
        EXPECT_GT(report.rest_samples, 0U) << i;
        EXPECT_EQ(walk.engine->drawn().size(), items) << i;
    }
    walk.limit = frame_limit_us;
    for (int i = 0; i < 600; ++i) report = walk.frame(pose);
    EXPECT_EQ(report.rest_samples, max_rest_samples) << "it goes on when there is time again";
}

TEST(Rest, AllocatesNothing) {
    Walk walk = open(gl::BackendKind::null, 500);
    ASSERT_NE(walk.engine, nullptr);
    const Pose pose = test::forest_pose(*walk.engine);
    walk.frame(pose);
    SubmitLimits limits;
    limits.limit_us = frame_limit_us;
    bool rested = false;
    const std::uint64_t before = test::allocations();
    for (int i = 0; i < 600; ++i) {
        limits.frame_ns = walk.at_ns += period_ns;
        rested = walk.engine->submit(pose, limits).rest_samples == max_rest_samples;
    }
    EXPECT_EQ(test::allocations(), before);
    EXPECT_TRUE(rested);
}

}  // namespace
}  // namespace surefoot
