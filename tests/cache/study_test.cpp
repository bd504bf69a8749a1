// The studies: numbers of boxes, the shape of the counts, and what a bird's-eye view shows.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "tools/cache_study/study.hpp"
#include "tools/cache_study/study_scenes.hpp"
#include "tools/cache_study/traced_points.hpp"

namespace surefoot::cache_study {
namespace {

Study study_of(const char* name, std::uint32_t frames = 0, bool pictures = false) {
    StudyRequest request;
    request.study = name;
    request.frames = frames;
    request.pictures = pictures;
    auto study = run_study(request, {});
    EXPECT_TRUE(study) << study.error().text();
    return study ? std::move(*study) : Study{};
}

/// Across the plain by 0.12 m a frame.
const Study& plain_in_small_steps() {
    static const Study study = study_of("flat", 4800, true);
    return study;
}

TEST(CacheStudy, HasTheBoxesAndFramesOfThePaper) {
    EXPECT_EQ(usual_frames("flat"), 120U);
    EXPECT_EQ(usual_frames("forest"), 100U);
    EXPECT_EQ(usual_frames("zoom"), 100U);
    EXPECT_EQ(study_of("flat", 2).boxes, 341U);
    EXPECT_EQ(study_of("flat", 2).filled_boxes, 341U);
    const Study forest = study_of("forest", 2);
    EXPECT_EQ(forest.boxes, 585U);
    EXPECT_EQ(forest.triangles, 105'000U);
    EXPECT_EQ(study_of("room", 2).boxes, 73U);
}

TEST(CacheStudy, OfThePlainComesToTheShapeOfFigure6InSmallerSteps) {
    const StudyShape in_120 = shape_of(sums_after_first(study_of("flat").corrected));
    EXPECT_LT(in_120.reused_per_combined, 1) << "a step of 5 m makes nearly every picture anew";
    const Study& study = plain_in_small_steps();
    const StudySums sums = sums_after_first(study.corrected);
    EXPECT_GE(sums.reused, 5 * sums.combined);
    EXPECT_GT(sums.combined, sums.fresh);
    EXPECT_LT(sums.work.triangles, sums.frames * study.triangles / 4);
    for (const StudyFrame& frame : study.corrected) {
        EXPECT_GT(frame.counts.not_replaceable, 0U) << "the block round the eye";
        EXPECT_LT(frame.counts.not_replaceable, 100U);
        EXPECT_GT(frame.bytes, 0U);
    }
}

TEST(CacheStudyAtNight, OfThePlainAtWalkingPaceHasTheShapeOfFigure6) {
    const Study study = study_of("flat", 12'400);
    EXPECT_NEAR(study.step_m, 1.4 / 30, 0.001);
    EXPECT_TRUE(shape_of(sums_after_first(study.corrected)).as_published());
}

TEST(CacheStudy, TracesNoMoreThanIsPromisedAndMoreByThePublishedTests) {
    const cache::PixelAngles pixels = cache::pixel_angles(Pose{}, {320, 240});
    for (const char* name : {"flat", "forest", "zoom", "room"}) {
        const Study study = study_of(name);
        for (const StudyFrame& frame : study.corrected) {
            EXPECT_LE(frame.bound_px, 1) << name;
            EXPECT_LE(frame.traced_px, frame.bound_px + 1e-9) << name;
        }
        EXPECT_GT(sums_after_first(study.corrected).traced_px, 0.3) << name << ": the bound is far from what happens";
        EXPECT_GT(sums_after_first(study.published).traced_px, pixels.mean_rad / pixels.smallest_rad)
            << name << ": beyond what those tests allow";
    }
}

TEST(CacheStudy, PointsKeepWhatWasWrongInThePicturesThatWereDrawnIntoOne) {
    const auto scene = make_study("flat", 2400);
    ASSERT_TRUE(scene);
    TracedPoints points(*scene);
    EXPECT_GT(points.count(), 1000U);
    cache::CacheState state = cache::empty_state(scene->tree);
    double at_making_rad = 0;
    for (std::uint32_t frame = 0; frame < 60; ++frame) {
        cache::CacheView view;
        view.eye = scene->eyes[frame];
        view.pixels = cache::pixel_angles(Pose{}, {320, 240});
        view.frame = frame;
        cache::CachePlan plan = cache::plan_frame(scene->tree, view, {}, state);
        points.follow(plan);
        std::erase_if(plan.draws, [&](const cache::BoxDraw& draw) { return plan.uses[draw.box] != cache::BoxUse::combined; });
        const double error_rad = points.max_error_rad(plan, view.eye);
        if (frame == 0) {
            EXPECT_LT(error_rad, 1e-12) << "all pictures are of one eye";
        }
        EXPECT_LE(error_rad, view.pixels.smallest_rad);
        at_making_rad = std::max(at_making_rad, error_rad);
        state = std::move(plan.after);
    }
    EXPECT_GT(at_making_rad, 0.1 * cache::pixel_angles(Pose{}, {320, 240}).smallest_rad);
}

TEST(CacheStudy, WalksThroughTheScene) {
    const auto walk = [](const char* name, std::uint32_t frames) {
        auto scene = make_study(name, frames);
        EXPECT_TRUE(scene);
        const Box box = scene->tree.boxes.front().box;
        return std::pair(box, *std::move(scene));
    };
    const auto [plain, flat] = walk("flat", 120);
    EXPECT_NEAR(flat.walked_m, 0.8 * 512 * std::sqrt(2.0), 1e-6);
    EXPECT_NEAR(flat.step_m * 119, flat.walked_m, 1e-9);
    EXPECT_NEAR(walk("flat", 1200).second.walked_m, flat.walked_m, 1e-9) << "the same way in smaller steps";
    const auto [wood, zoom] = walk("zoom", 100);
    EXPECT_NEAR(zoom.eyes.front().x, wood.min.x, 1e-9);
    EXPECT_NEAR(zoom.eyes.back().x, wood.centre().x, 1e-9);
    EXPECT_NEAR(zoom.eyes.back().z, wood.centre().z, 1e-9);
    const auto [walls, room] = walk("room", 100);
    for (const dvec3& eye : room.eyes) EXPECT_EQ(walls.distance(eye), 0) << "it stands inside";
    EXPECT_EQ(walk("room", 1).second.walked_m, 0);
}

TEST(CacheStudy, CountsTheTrianglesAndTexelsOfAFrame) {
    const std::vector<cache::Triangle> scene = {{dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0)}, {dvec3(0), dvec3(1), dvec3(0, 1, 0)}};
    const auto tree = cache::make_boxes(scene, {.levels = 1});
    ASSERT_TRUE(tree);
    cache::CacheView view;
    view.pixels = cache::pixel_angles(Pose{}, {320, 240});
    view.eye = {0.5, 0.5, 30};
    const cache::CachePlan first = cache::plan_frame(*tree, view, {}, cache::empty_state(*tree));
    EXPECT_EQ(work_of(*tree, first).triangles, 2U);
    EXPECT_EQ(work_of(*tree, first).texels, 64U * 64U);
    ++view.frame;
    const cache::CachePlan again = cache::plan_frame(*tree, view, {}, first.after);
    EXPECT_EQ(work_of(*tree, again).triangles, 0U) << "its picture serves again";
    EXPECT_EQ(work_of(*tree, again).texels, 0U);
    view.eye.z = 1.2;
    ++view.frame;
    const cache::CachePlan near = cache::plan_frame(*tree, view, {}, again.after);
    EXPECT_EQ(work_of(*tree, near).triangles, 2U) << "too near for a picture";
    EXPECT_EQ(work_of(*tree, near).texels, 0U);
}

TEST(CacheStudy, OfOneFrameHasNoLaterFrames) {
    const Study study = study_of("flat", 1, true);
    EXPECT_EQ(sums_after_first(study.corrected).frames, 0U);
    EXPECT_EQ(study.sheet.views.size(), 1U);
    EXPECT_EQ(study_of("flat", 30, true).sheet.views.size(), max_views);
}

TEST(CacheStudy, IsTheSameTwice) {
    const Study a = study_of("flat", 20), b = study_of("flat", 20);
    for (std::size_t i = 0; i < a.corrected.size(); ++i) {
        EXPECT_EQ(a.corrected[i].counts.fresh, b.corrected[i].counts.fresh);
        EXPECT_EQ(a.corrected[i].counts.reused, b.corrected[i].counts.reused);
        EXPECT_EQ(a.corrected[i].bytes, b.corrected[i].bytes);
        EXPECT_EQ(a.corrected[i].traced_px, b.corrected[i].traced_px);
        EXPECT_EQ(a.corrected[i].work.triangles, b.corrected[i].work.triangles);
    }
}

TEST(CacheStudy, WrongNamesAndStopsAreErrors) {
    StudyRequest request;
    request.study = "flatter";
    const auto wrong = run_study(request, {});
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().kind, ErrorKind::not_found);
    EXPECT_NE(wrong.error().text().find("forest"), std::string::npos);
    const std::atomic<bool> stop{true};
    Progress progress;
    progress.stop = &stop;
    request.study = "flat";
    const auto stopped = run_study(request, progress);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
}

/// Share of a view in which the channel stands out above both others, or all are near one value.
struct Inks {
    double red = 0, green = 0, white = 0, black = 0;
};
Inks inks_of(const BirdsEyeView& view) {
    Inks inks;
    for (std::size_t i = 0; i < view.size(); i += 4) {
        const int r = view[i], g = view[i + 1], b = view[i + 2];
        inks.red += r > g + 60 && r > b + 60 ? 1 : 0;
        inks.green += g > r + 60 && g > b + 60 ? 1 : 0;
        inks.white += std::min({r, g, b}) > 240 ? 1 : 0;
        inks.black += std::max({r, g, b}) < 30 ? 1 : 0;
    }
    const double all = static_cast<double>(view.size()) / 4;
    return {inks.red / all, inks.green / all, inks.white / all, inks.black / all};
}

TEST(BirdsEye, FirstIsRedAndGreenThenMostlyWhiteRoundABlackBlock) {
    const Study& study = plain_in_small_steps();
    ASSERT_EQ(study.sheet.views.size(), max_views);
    const Inks first = inks_of(study.sheet.views.front()), later = inks_of(study.sheet.views.back());
    EXPECT_GT(first.red, 0.05);
    EXPECT_GT(first.green, 0.3);
    EXPECT_LT(first.white, 0.01);
    EXPECT_GT(later.white, 0.5);
    EXPECT_GT(later.black, 0.02);
    EXPECT_LT(later.black, 0.3);
    const SheetPicture sheet = picture_of_sheet(study.sheet);
    EXPECT_EQ(sheet.width, 5 * (view_px + view_gap_px) + view_gap_px);
    EXPECT_EQ(sheet.rgba.size(), std::size_t{4} * sheet.width * sheet.height);
    EXPECT_EQ(picture_of_sheet({}).width, 0U);
}

}  // namespace
}  // namespace surefoot::cache_study
