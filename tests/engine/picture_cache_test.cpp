// The image cache in frames: nothing is missing in any of them, spending stays within the budget, and off means as before.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "render/measure/image_metrics.hpp"
#include "tests/engine/picture_walk.hpp"
#include "tests/select/count_malloc.hpp"

namespace surefoot {
namespace {

using test::along;
using test::holes;
using test::PictureWalk;

TEST(PictureCache, AWalkHasNoHoleAndDrawsFewerTriangles) {
    PictureWalk with(test::forest_model(), {}), without(test::forest_model(), {.layers = 0});
    const Box& box = with.engine().model().nodes[0].box;
    std::uint64_t triangles = 0, all_triangles = 0;
    std::uint32_t pictures = 0, made = 0;
    for (int i = 0; i < 40; ++i) {
        Pose pose = along(with.engine(), i);
        pose.position.z += 2 * box.half().z;  // all of it is ahead
        const SubmitReport report = with.frame(pose);
        EXPECT_TRUE(holes(with.engine(), pose).empty()) << i;
        triangles += report.triangles;
        all_triangles += without.frame(pose).triangles;
        pictures += report.pictures;
        made += report.pictures_made;
        EXPECT_NEAR(report.value, 1, 1e-6) << i;
        if (report.pictures == 0) continue;
        EXPECT_GT(report.worst_error_rad, 0.0F);
        EXPECT_LE(report.worst_error_rad, model::pixel_angle(pose, with.engine().options().device.viewport));
    }

    EXPECT_GT(pictures, 200U);
    EXPECT_GT(made, 5U);
    EXPECT_LT(made, pictures / 5) << "pictures serve again and again";
    EXPECT_LT(static_cast<double>(triangles), 0.85 * static_cast<double>(all_triangles));
}

TEST(PictureCache, HardEyesLeaveNoHole) {
    PictureWalk walk(test::forest_model(), {});
    Pose pose;
    for (int i = 0; i < 20; ++i) walk.frame(pose = along(walk.engine(), i));
    EXPECT_FALSE(walk.engine().pictures().empty());
    const Box world = walk.engine().model().nodes[0].box;
    const std::vector<dvec3> eyes = {world.centre(), world.min, world.max, world.centre() + dvec3(0, 1e6, 0),
                                     dvec3(world.min.x, world.centre().y, world.centre().z)};
    for (const dvec3& eye : eyes) {
        for (int i = 0; i < 4; ++i) {
            Pose there = pose;
            there.position = eye;
            walk.frame(there);
            EXPECT_TRUE(holes(walk.engine(), there).empty());
        }
        for (int i = 0; i < 6; ++i) walk.frame(pose);
        EXPECT_TRUE(holes(walk.engine(), pose).empty());
    }
    Pose nowhere = pose;
    nowhere.position.x = std::numeric_limits<double>::quiet_NaN();
    walk.frame(nowhere);
    EXPECT_TRUE(walk.engine().pictures().empty());
    walk.frame(pose);
    walk.frame(pose);
    EXPECT_TRUE(holes(walk.engine(), pose).empty());
}

/// The set says that pictures show a part of the scene, and the pose is one from which they do not.
TEST(PictureCache, WhatPicturesCannotShowAnyMoreIsDrawnInFullOrCoarse) {
    PictureWalk walk(test::forest_model(), {});
    Pose pose;
    for (int i = 0; i < 20; ++i) walk.frame(pose = along(walk.engine(), i));
    ASSERT_GT(walk.set().left_out, 0U);
    Pose beside = pose;
    beside.position.x += 25;
    for (const double limit_us : {test::ample_us, 0.0}) {
        walk.engine().device().draws.plays();
        walk.engine().select(walk.set(), test::ample_us, {}, 0);
        const SubmitReport report = walk.engine().submit(beside, {.elapsed_us = 0, .limit_us = limit_us});
        EXPECT_GT(report.uncovered_items, 0U);
        EXPECT_EQ(report.downgraded_slices > 0, limit_us == 0);
    }
    walk.engine().select(walk.set(), test::ample_us, {}, 0);
    walk.engine().submit(pose, {.elapsed_us = 0, .limit_us = test::ample_us});
    EXPECT_FALSE(walk.engine().pictures().empty());
}

model::Daylight dim(int step) {
    model::Daylight light;
    light.sun_light = vec3(0.1F + 0.01F * static_cast<float>(step));
    return light;
}

/// Sets that rely on the old pictures show them; no further set is told of them.
TEST(PictureCache, AnotherLightLeavesNothingUncovered) {
    PictureWalk walk(test::forest_model(), {});
    for (int i = 0; i < 20; ++i) walk.frame(along(walk.engine(), i));
    ASSERT_GT(walk.engine().pictures().size(), 0U);
    walk.engine().set_light(dim(0));
    std::uint32_t made = 0;
    for (int i = 20; i < 28; ++i) {
        const Pose pose = along(walk.engine(), i);
        const SubmitReport report = walk.frame(pose);
        EXPECT_EQ(report.uncovered_items, 0U) << i;
        EXPECT_TRUE(holes(walk.engine(), pose).empty()) << i;
        made += report.pictures_made;
        if (i == 20) {
            EXPECT_GT(report.pictures, report.pictures_made);
        } else {
            EXPECT_LE(report.pictures, made) << "the old ones are of another light";
        }
    }
    EXPECT_GT(made, 0U);
}

TEST(PictureCache, NoPictureIsMadeWhereTheLightChangesBeforeItPays) {
    PictureWalk walk(test::forest_model(), {});
    std::uint32_t made = 0, late = 0;
    for (int i = 0; i < 36; ++i) {
        if (i % 3 == 0) walk.engine().set_light(dim(i));
        const std::uint32_t of_frame = walk.frame(along(walk.engine(), i)).pictures_made;
        (i < 6 ? made : late) += of_frame;
    }
    EXPECT_EQ(late, 0U);
    for (int i = 36; i < 46; ++i) made += walk.frame(along(walk.engine(), i)).pictures_made;
    EXPECT_GT(made, 0U) << "the light stays";
}

/// The price of what pictures cannot show any more, beside what was bought, is over the frame's limit: the frame is one without
/// a prepared set.
TEST(PictureCache, TooMuchInPlaceOfPicturesIsDrawnAsWithoutASet) {
    struct Jump {
        SubmitReport report;
        std::vector<model::Index> holes;
    };
    const auto after_jump = [](std::uint32_t layers, double limit_us) {
        PictureWalk walk(test::forest_model(), {.layers = layers});
        Pose pose;
        for (int i = 0; i < 8; ++i) walk.frame(pose = along(walk.engine(), i));
        pose.position.x += 25;
        walk.engine().device().draws.plays();
        walk.engine().select(walk.set(), test::ample_us, {}, 0);
        const SubmitReport report = walk.engine().submit(pose, {.elapsed_us = 0, .limit_us = limit_us});
        return Jump{report, holes(walk.engine(), pose)};
    };
    const Jump with = after_jump(64, test::ample_us), without = after_jump(0, test::ample_us);
    EXPECT_EQ(with.holes, without.holes) << "what the set of the other place did not see";
    const SubmitReport all = with.report;
    const double all_us = all.predicted_us;
    EXPECT_GT(all.captures_us, 0) << "something was bought";
    for (const double share : {0.3, 0.35, 0.4}) {
        const auto [report, missing] = after_jump(64, share * all_us);
        EXPECT_TRUE(missing.empty()) << share;
        EXPECT_GT(report.uncovered_items, 0U);
        EXPECT_LE(report.predicted_us, share * all_us) << share;
        EXPECT_EQ(report.captures_us, 0) << share;
        EXPECT_GT(report.slices, 0U);
        EXPECT_EQ(report.downgraded_slices, report.slices) << "nothing of the cut was drawn";
    }
}

/// At rest nothing is captured, so nothing is bought. What is captured after it is paid for.
TEST(PictureCache, AtRestNoPictureIsBought) {
    PictureWalk walk(test::forest_model(), {.rest_after_ms = 30});
    bool rested = false;
    for (int i = 0; i < 20; ++i) {
        const SubmitReport report = walk.frame(along(walk.engine(), i < 2 ? i : i < 12 ? 2 : i - 10));
        EXPECT_EQ(report.pictures_made > 0, report.captures_us > 0) << i;
        EXPECT_LE(report.pictures_made, 8U) << i;
        if (report.at_rest && rested) {
            EXPECT_EQ(walk.bought(), 0U) << i;
        }
        rested = rested || report.at_rest;
    }
    EXPECT_TRUE(rested);
}

TEST(PictureCache, NoRoomForAPictureMeansNoPicture) {
    PictureWalk one(test::forest_model(), {.layers = 1}), none(test::forest_model(), {.layers = 0});
    for (int i = 0; i < 20; ++i) {
        const Pose pose = along(one.engine(), i);
        const SubmitReport of_one = one.frame(pose), of_none = none.frame(pose);
        EXPECT_LE(of_one.picture_bytes, 256U * 256 * 4);
        EXPECT_TRUE(holes(one.engine(), pose).empty()) << i;
        EXPECT_EQ(of_none.pictures + of_none.pictures_made, 0U);
    }
}

TEST(PictureCache, NewPicturesAreBoughtWithinTheBudgetAndCharged) {
    for (const char* selector : {"best-first", "curve-budget", "threshold"}) {
        PictureWalk walk(test::forest_model(), {.selector = selector});
        gl::Device& device = walk.engine().device();
        device.draws.plays();
        const double full_us = walk.frame(along(walk.engine(), 0)).predicted_us, budget_us = 0.6 * full_us;
        std::uint32_t made = 0;
        for (int i = 1; i < 30; ++i) {
            const Pose pose = along(walk.engine(), i);
            const double before_us = device.charged_us();
            const SubmitReport report = walk.frame(pose, budget_us);
            EXPECT_LE(report.predicted_us, budget_us) << selector << ' ' << i;
            EXPECT_NEAR(device.charged_us() - before_us, report.predicted_us, 2e-2 * report.predicted_us)
                << "forms are priced for a region";
            EXPECT_TRUE(holes(walk.engine(), pose).empty()) << selector << ' ' << i;
            made += report.pictures_made;
            double captures_us = 0;
            for (const select::Item& item : walk.engine().offered().offered())
                if (item.kind == select::ItemKind::refresh && walk.engine().bought(item.kind, item.what))
                    captures_us += static_cast<double>(item.cost_us);
            EXPECT_NEAR(report.captures_us, captures_us, 1e-3) << selector << ' ' << i;
            EXPECT_EQ(device.stats().captures, report.pictures_made);
        }
        EXPECT_GT(made, 0U) << selector;
    }
}

TEST(PictureCache, WithoutABudgetNewPicturesTakeATenthOfAFrameAtMost) {
    PictureWalk walk(test::forest_model(), {});
    constexpr double budget_us = 33'333;
    for (int i = 0; i < 30; ++i) {
        const SubmitReport report = walk.frame(along(walk.engine(), i), budget_us);
        EXPECT_LE(report.captures_us, 0.1 * budget_us + 1) << i;
    }
}

TEST(PictureCache, NoPictureTakesLongerThanASliceMay) {
    PictureWalk walk(test::forest_model(), {});
    constexpr double budget_us = 4000;
    std::uint32_t made = 0;
    for (int i = 0; i < 20; ++i) {
        made += walk.frame(along(walk.engine(), i), budget_us).pictures_made;
        for (const select::Item& item : walk.engine().offered().offered()) {
            if (item.kind == select::ItemKind::refresh) {
                EXPECT_LE(item.cost_us, budget_us / 16) << i;
            }
        }
    }
    EXPECT_GT(made, 0U);
}

TEST(PictureCache, PicturesKeepTheGuaranteedError) {
    for (const double max_error_rad : {1e-3, 2.5e-3}) {
        PictureWalk walk(test::forest_model(), {.selector = "curve-budget", .max_error_rad = max_error_rad});
        std::uint32_t pictures = 0;
        for (int i = 0; i < 20; ++i) {
            const SubmitReport report = walk.frame(along(walk.engine(), i));
            EXPECT_EQ(report.guarantee, rt::Guarantee::kept) << i;
            EXPECT_LE(report.worst_weighted_rad, max_error_rad) << i;
            pictures += report.pictures;
        }
        EXPECT_GT(pictures, 0U) << max_error_rad;
    }
}

/// A model without a box for pictures is drawn as forms.
TEST(PictureCache, AModelWithoutBoxesHasNoPictures) {
    model::Model model = test::forest_model();
    for (model::Node& node : model.nodes)
        if (node.child_count == 0) node.box = {};
    PictureWalk walk(model, {});
    EXPECT_FALSE(walk.engine().has_pictures());
    EXPECT_NE(walk.engine().picture_reason(), "");
}

TEST(PictureCache, IsTheSameAtAnyNumberOfWorkers) {
    PictureWalk one(test::forest_model(), {}), four(test::forest_model(), {.workers = 4});
    for (int i = 0; i < 20; ++i) {
        const SubmitReport a = one.frame(along(one.engine(), i)), b = four.frame(along(one.engine(), i));
        EXPECT_EQ(a.triangles, b.triangles) << i;
        EXPECT_EQ(a.pictures, b.pictures) << i;
        EXPECT_EQ(a.pictures_made, b.pictures_made) << i;
        EXPECT_EQ(a.predicted_us, b.predicted_us) << i;
        EXPECT_EQ(one.set().covered, four.set().covered) << i;
    }
}

/// Drawn again from what it showed, a frame is what it was: its pictures too, also where they are more than one frame can make.
TEST(PictureCache, FramesAreDrawnAgainWithTheirPictures) {
    PictureWalk walk(test::forest_model(), {.kind = gl::BackendKind::egl});
    if (walk.absent()) GTEST_SKIP() << "no EGL here";
    Engine& engine = walk.engine();
    engine.device().draws.plays();
    Pose pose;
    for (int i = 0; i < 12; ++i) walk.frame(pose = along(engine, i));
    const std::vector<gl::DrawItem> items(engine.drawn().begin(), engine.drawn().end());
    const std::vector<ShownPicture> shown(engine.shown_pictures().begin(), engine.shown_pictures().end());
    ASSERT_GT(shown.size(), 5U);
    ShownPicture unseen = shown.front();
    unseen.picture.place.layer = 63;
    unseen.picture.box = {pose.position - 1.0, pose.position + 1.0};
    std::vector<ShownPicture> pictures(gl::max_captures, unseen);
    pictures.insert(pictures.end(), shown.begin(), shown.end());
    const auto frame = engine.device().read_pixels();
    engine.draw_unbudgeted(pose, items, 1, rt::TextureFilter::automatic);
    const auto bare = engine.device().read_pixels();
    engine.draw_unbudgeted(pose, items, pictures, 1, rt::TextureFilter::automatic);
    const auto again = engine.device().read_pixels();
    ASSERT_TRUE(frame && bare && again);
    EXPECT_NE(frame->rgba, bare->rgba);
    EXPECT_EQ(frame->rgba, again->rgba);
    const SubmitReport next = walk.frame(pose);
    EXPECT_LE(next.pictures, next.pictures_made) << "those of the walk are gone";
    EXPECT_TRUE(holes(engine, pose).empty());
}

TEST(PictureCache, BoxesOfAFrameAreMadeReusedOrTriangles) {
    PictureWalk walk(test::forest_model(), {});
    std::uint32_t first = 0, last = 0, reused = 0;
    for (int i = 0; i < 40; ++i) {
        const Pose pose = along(walk.engine(), i);
        const SubmitReport report = walk.frame(pose);
        std::uint32_t shown = 0, made = 0, shown_anew = 0, as_triangles = 0;
        for (const cache::FrameBox& box : walk.engine().cache_boxes()) {
            shown += box.shown ? 1 : 0;
            made += box.made ? 1 : 0;
            shown_anew += box.shown && box.made ? 1 : 0;
            as_triangles += box.as_triangles ? 1 : 0;
            EXPECT_FALSE(box.shown && box.as_triangles) << i;
        }
        EXPECT_EQ(report.pictures, shown) << i;
        EXPECT_EQ(report.pictures_made, made) << i;
        EXPECT_EQ(report.pictures_reused, shown - shown_anew) << i;
        EXPECT_EQ(report.boxes_as_triangles, as_triangles) << i;
        if (i == 0) first = as_triangles;
        last = as_triangles;
        reused += report.pictures_reused;
    }
    EXPECT_GT(reused, 200U);
    EXPECT_GT(first, 20U) << "at first there is no picture";
    EXPECT_LT(last, first);
    const std::vector<std::uint8_t> above = walk.engine().birds_eye(walk.engine().cache_boxes(), {}, 64);
    EXPECT_EQ(above.size(), 4U * 64 * 64);
    EXPECT_TRUE(walk.engine().birds_eye({}, {}, 64).empty()) << "nothing was kept of that frame";
    PictureWalk without(test::forest_model(), {.layers = 0});
    EXPECT_TRUE(without.engine().cache_boxes().empty());
}

/// How much pictures are predicted to take in some frames, over the table's price, where a clock shows a share of what is
/// predicted.
double learnt_from(double share, int from = 180, int to = 200) {
    const test::PictureWalkOptions how{.viewport = {1280, 720}};  // small pictures are not timed
    PictureWalk timed(test::forest_model(), how), untimed(test::forest_model(), how);
    test::ScriptedClock clock{.share = share};
    double by_clock_us = 0, by_table_us = 0;
    for (int i = 0; i < to; ++i) {
        Pose pose = along(timed.engine(), i / 8);
        pose.position.z += 4 * timed.engine().model().nodes[0].box.half().z;
        const SubmitReport of_table = untimed.frame(pose), report = timed.frame(pose, test::ample_us, test::ample_us, &clock);
        if (i < from) continue;
        by_clock_us += report.pictures_us / std::max(1U, report.pictures);
        by_table_us += of_table.pictures_us / std::max(1U, of_table.pictures);
    }
    return by_clock_us / by_table_us;
}

/// A frame's correction is of all of it. Pictures that are dearer or cheaper than the table says are found by themselves.
TEST(PictureCache, PicturesAreTimedByThemselves) {
    for (const double share : {0.5, 1.0, 2.0}) EXPECT_NEAR(learnt_from(share), share, 0.15 * share) << "with the end of a slice";
}

/// So dear pictures are known within the first frames that show some, and no more of them are made.
TEST(PictureCache, PicturesThatAreDearAreFoundOutAtOnce) { EXPECT_GT(learnt_from(6, 10, 14), 3); }

/// Drivers may wait for new pictures where a frame begins. They are in flight no more then, and no slice is drawn coarser.
TEST(PictureCache, WhatBeginningTookIsNotWaitedForTwice) {
    PictureWalk plain(test::forest_model(), {}), waits(test::forest_model(), {});
    int frames = 0;
    for (int i = 0; i < 12; ++i) {
        const Pose pose = along(plain.engine(), i);
        const SubmitReport report = plain.frame(pose);
        test::ScriptedClock clock{.begins_us = report.captures_us};
        frames += report.captures_us > 0.2 * report.predicted_us ? 1 : 0;
        EXPECT_EQ(waits.frame(pose, test::ample_us, 1.25 * report.predicted_us, &clock).downgraded_slices, 0U) << i;
    }
    EXPECT_GT(frames, 0);
}

/// Where forms compete for the time: a quarter of the budget at most for two seconds after a jump, then within a tenth.
TEST(PictureCache, NewPicturesTakeLessOnceTheWalkGoesOn) {
    constexpr double budget_us = 4000;
    PictureWalk walk(test::forest_model(), {.selector = std::string(select::usual_selector)});
    double first_us = 0, later_us = 0;
    std::uint32_t later = 0;
    for (int i = 0; i < 120; ++i) {
        Pose pose = along(walk.engine(), i);
        pose.position.z += 2 * walk.engine().model().nodes[0].box.half().z;
        const SubmitReport report = walk.frame(pose, budget_us);
        (i < 60 ? first_us : later_us) = std::max(i < 60 ? first_us : later_us, report.captures_us);
        later += i < 60 ? 0 : report.pictures_made;
    }
    EXPECT_GT(first_us, 0.1 * budget_us);
    EXPECT_LE(first_us, 0.25 * budget_us);
    EXPECT_GT(later, 0U);
    EXPECT_LE(later_us, 0.1 * budget_us);
}

TEST(PictureCache, FramesAllocateNothing) {
    PictureWalk walk(test::forest_model(), {});
    std::uint32_t made = 0;
    std::uint64_t allocated = 0;
    for (int i = 0; i < 30; ++i) {
        const Pose pose = along(walk.engine(), i);
        walk.prepare(pose);
        const std::uint64_t before = test::allocations();
        const SubmitReport report = walk.draw(pose, test::ample_us, test::ample_us);
        allocated += test::allocations() - before;
        made += report.pictures_made;
    }
    EXPECT_GT(made, 0U);
    EXPECT_EQ(allocated, 0U);
}

/// Off means that nothing of the frame is another one.
TEST(PictureCache, WithoutLayersFramesAreAsTheyWere) {
    PictureWalk off(test::forest_model(), {.layers = 0});
    const auto plain = test::forest_engine();
    ASSERT_TRUE(plain);
    EXPECT_TRUE(off.engine().cover(along(off.engine(), 0), {}).none());
    off.frame(along(off.engine(), 0));
    EXPECT_EQ(off.set().left_out, 0U);
    EXPECT_EQ(off.set().covered.count(), 0U);
    EXPECT_EQ(off.engine().offered().offered().size(), 0U);
    EXPECT_EQ(off.engine().drawn_capacity(), plain->drawn_capacity());
}

/// As drawn by a device: a walk's frames beside full detail from the same eye.
TEST(PictureCache, ShowsWhatFullDetailShows) {
    PictureWalk walk(test::forest_model(), {.kind = gl::BackendKind::egl});
    if (walk.absent()) GTEST_SKIP() << "no EGL here";
    Engine& engine = walk.engine();
    engine.device().draws.plays();
    std::uint32_t pictures = 0;
    for (int i = 0; i < 12; ++i) {
        const Pose pose = along(engine, i);
        pictures += walk.frame(pose).pictures;
        if (i % 6 != 5) continue;
        const auto cached = engine.device().read_pixels();
        engine.draw_unbudgeted(pose, engine.full_detail(pose));
        const auto full = engine.device().read_pixels();
        ASSERT_TRUE(cached && full);
        EXPECT_NE(cached->rgba, full->rgba) << "pictures are drawn";
        EXPECT_GT(10 * std::log10(255.0 * 255.0 / measure::snr(cached->rgba, full->rgba).mse), 30) << i;
    }
    EXPECT_GT(pictures, 20U);
}

}  // namespace
}  // namespace surefoot
