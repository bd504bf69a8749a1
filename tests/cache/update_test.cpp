// A frame of the image cache: every box is drawn once and within a pixel, whatever the eye, the options and the room for
// pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "render/cache/update.hpp"
#include "rt/base/random.hpp"

namespace surefoot::cache {
namespace {

constexpr double plain_m = 160;

/// A plain of upright triangles, 10 m apart, with a hole without any.
std::vector<Triangle> plain_with_hole() {
    std::vector<Triangle> out;
    for (int i = 0; i < 16; ++i)
        for (int j = 0; j < 16; ++j) {
            if (i >= 12 && j >= 12 && i + j != 30) continue;
            const dvec3 at(i * 10.0, 0, j * 10.0);
            out.push_back({at + dvec3(1, 0, 1), at + dvec3(9, 0, 9), at + dvec3(1, 2, 9)});
        }
    return out;
}

BoxTree tree_of(const std::vector<Triangle>& triangles, std::uint32_t branching = 4, std::uint32_t levels = 5) {
    auto tree = make_boxes(triangles, {.branching = branching, .levels = levels});
    EXPECT_TRUE(tree);
    return *std::move(tree);
}

CacheView view_from(const dvec3& eye, std::uint32_t frame, model::Viewport viewport = {320, 240}) {
    CacheView view;
    view.eye = eye;
    view.pixels = pixel_angles(Pose{}, viewport);
    view.frame = frame;
    return view;
}

/// Every leaf with triangles that is in view is drawn once, by itself or by a box above it.
void expect_whole(const BoxTree& tree, const CacheView& view, const CachePlan& plan) {
    std::vector<int> covered(tree.boxes.size(), 0);
    for (const BoxDraw& draw : plan.draws) {
        ++covered[draw.box];
        if (!draw.picture) {
            EXPECT_EQ(tree.boxes[draw.box].child_count, 0U);
        }
    }
    for (Index i = 1; i < tree.boxes.size(); ++i) covered[i] += covered[tree.boxes[i].parent];
    for (Index i = 0; i < tree.boxes.size(); ++i) {
        const CacheBox& box = tree.boxes[i];
        if (box.child_count > 0 || box.primitive_count == 0) continue;
        const bool seen = view.frustum == nullptr || model::visible(*view.frustum, box.box);
        ASSERT_TRUE(covered[i] == 1 || (!seen && covered[i] == 0)) << "leaf " << i << " is drawn " << covered[i] << " times";
    }
}

/// Counts, bytes and errors are those of what is in the plan.
void expect_consistent(const BoxTree& tree, const CacheView& view, const CacheOptions& options, const CachePlan& plan) {
    expect_whole(tree, view, plan);
    std::uint64_t bytes = 0;
    for (const Picture& picture : plan.after.pictures) bytes += bytes_of(picture.texels);
    EXPECT_EQ(plan.after.bytes, bytes);
    EXPECT_LE(bytes, options.max_bytes);
    std::vector<bool> made(tree.boxes.size()), drawn_from(tree.boxes.size());
    CacheCounts counts;
    for (const Refresh& refresh : plan.refreshes) {
        EXPECT_FALSE(made[refresh.box]) << "twice in a frame";
        EXPECT_FALSE(drawn_from[refresh.box]) << "made after it was drawn into its parent's picture";
        made[refresh.box] = true;
        ++(refresh.from_children ? counts.combined : counts.fresh);
        const CacheBox& box = tree.boxes[refresh.box];
        EXPECT_EQ(plan.after.pictures[refresh.box].frame, view.frame);
        EXPECT_LE(plan.after.pictures[refresh.box].generation, options.max_generation);
        for (Index child = box.first_child; refresh.from_children && child < box.first_child + box.child_count; ++child) {
            EXPECT_TRUE(tree.boxes[child].primitive_count == 0 || plan.after.pictures[child].texels > 0);
            drawn_from[child] = true;
        }
    }
    EXPECT_EQ(counts.fresh, plan.counts.fresh);
    EXPECT_EQ(counts.combined, plan.counts.combined);
    for (const BoxDraw& draw : plan.draws) {
        const bool old = draw.picture && !made[draw.box];
        counts.reused += old ? 1 : 0;
        counts.not_replaceable += draw.picture ? 0 : 1;
        if (draw.picture) {
            EXPECT_LE(picture_errors(plan.after.pictures[draw.box], view.eye).total(), view.pixels.smallest_rad);
            EXPECT_LE(texel_rad(plan.after.pictures[draw.box], view.eye), view.pixels.smallest_rad);
            EXPECT_LE(plan.after.pictures[draw.box].texels, options.max_texels);
        }
    }
    EXPECT_EQ(counts.reused, plan.counts.reused);
    EXPECT_EQ(counts.not_replaceable, plan.counts.not_replaceable);
    EXPECT_LE(plan.max_error_rad, view.pixels.smallest_rad);
}

/// A walk with jumps: over the plain, into boxes, on their faces, far away, and where no number is.
dvec3 any_eye(Random& random, const dvec3& last) {
    const std::uint32_t kind = random.below(12);
    if (kind == 0) return any_in(random, dvec3(0), dvec3(plain_m, 2, plain_m));
    if (kind == 1) return {10.0 * random.below(16), 1, 10.0 * random.below(16)};
    if (kind == 2) return any_in(random, dvec3(-2000), dvec3(2000));
    if (kind == 3 && random.below(8) == 0) return dvec3(std::numeric_limits<double>::quiet_NaN());
    const dvec3 from = std::isfinite(last.x) ? last : dvec3(50, 1, 50);
    return from + any_in(random, dvec3(-0.3), dvec3(0.3));
}

TEST(CacheFrame, DrawsEveryBoxOnceAndWithinAPixel) {
    const BoxTree tree = tree_of(plain_with_hole());
    Random random(1);
    for (int run = 0; run < 16; ++run) {
        CacheOptions options;
        options.max_bytes = std::array<std::uint64_t, 5>{0, 100, bytes_of(64), 40 * bytes_of(64), 256ULL << 20U}[random.below(5)];
        options.max_texels = std::array{64U, 128U, 256U}[random.below(3)];
        options.max_generation = random.below(5);
        options.child_share = random.range(0.2, 1);
        options.upkeep_refreshes = random.below(3) * 4;
        options.surround = random.below(2) == 0;
        CacheState state = empty_state(tree);
        dvec3 eye(-30, 1, 40);
        for (std::uint32_t frame = 0; frame < 60; ++frame) {
            eye = any_eye(random, eye);
            CacheView view = view_from(eye, frame);
            Pose pose;
            pose.position = eye;
            pose.orientation = glm::angleAxis(random.range(0, 6.28), dvec3(0, 1, 0));
            const model::Frustum frustum = model::make_frustum(pose, {320, 240}, model::far_corners_m(tree.boxes[0].box));
            if (run % 2 == 1 && std::isfinite(eye.x)) view.frustum = &frustum;
            CachePlan plan = plan_frame(tree, view, options, state);
            expect_consistent(tree, view, options, plan);
            if (HasFailure()) return;
            state = std::move(plan.after);
        }
    }
}

TEST(CacheFrame, AnEyeThatStaysOrTurnsRefreshesNothing) {
    const BoxTree tree = tree_of(plain_with_hole());
    const CacheOptions options;
    CachePlan plan = plan_frame(tree, view_from({-40, 1, -40}, 0), options, empty_state(tree));
    EXPECT_GT(plan.counts.fresh, 50U);
    EXPECT_GT(plan.counts.combined, 10U);
    const std::uint64_t bytes = plan.after.bytes;
    for (std::uint32_t frame = 1; frame < 5; ++frame) {
        Pose pose;
        pose.position = {-40, 1, -40};
        pose.orientation = glm::angleAxis(1.5 * frame, dvec3(0, 1, 0));
        const model::Frustum frustum = model::make_frustum(pose, {320, 240}, 1e4);
        CacheView view = view_from(pose.position, frame);
        view.frustum = &frustum;
        plan = plan_frame(tree, view, options, plan.after);
        EXPECT_TRUE(plan.refreshes.empty());
        EXPECT_EQ(plan.after.bytes, bytes);
    }
}

TEST(CacheFrame, ThePlanIsTheSameAtAnyNumberOfWorkers) {
    const BoxTree tree = tree_of(plain_with_hole());
    const auto count = static_cast<Index>(tree.boxes.size());
    CacheOptions options;
    options.max_bytes = 120 * bytes_of(64);  // some are dropped
    CacheState state = empty_state(tree);
    std::size_t dropped = 0;
    double inherited = 0;
    for (std::uint32_t frame = 0; frame < 12; ++frame) {
        const CacheView view = view_from({-20 + 0.7 * frame + (frame < 6 ? 0 : 150), 1, 30 + 0.2 * frame}, frame);
        CachePlan alone = plan_frame(tree, view, options, state);
        for (const Index workers : {2U, 3U, 7U}) {
            std::vector<BoxFacts> facts(count);
            std::vector<std::thread> threads;
            for (Index w = 0; w < workers; ++w)
                threads.emplace_back([&, w] {
                    evaluate_boxes(tree, view, options, state, count * w / workers, count * (w + 1) / workers, facts);
                });
            for (std::thread& thread : threads) thread.join();
            const CachePlan plan = plan_frame(tree, view, options, state, facts);
            EXPECT_EQ(plan.uses, alone.uses);
            ASSERT_EQ(plan.refreshes.size(), alone.refreshes.size());
            for (std::size_t i = 0; i < plan.refreshes.size(); ++i) {
                EXPECT_EQ(plan.refreshes[i].box, alone.refreshes[i].box);
                EXPECT_EQ(plan.refreshes[i].from_children, alone.refreshes[i].from_children);
            }
            ASSERT_EQ(plan.draws.size(), alone.draws.size());
            for (std::size_t i = 0; i < plan.draws.size(); ++i) {
                EXPECT_EQ(plan.draws[i].box, alone.draws[i].box);
                EXPECT_EQ(plan.draws[i].picture, alone.draws[i].picture);
            }
            EXPECT_EQ(plan.dropped, alone.dropped);
            for (Index i = 0; i < count; ++i) EXPECT_EQ(plan.after.pictures[i].inherited, alone.after.pictures[i].inherited);
            EXPECT_EQ(plan.after.bytes, alone.after.bytes);
            EXPECT_EQ(plan.max_error_rad, alone.max_error_rad);
        }
        dropped += alone.dropped.size();
        for (const Picture& picture : alone.after.pictures) inherited = std::max(inherited, picture.inherited);
        state = std::move(alone.after);
    }
    EXPECT_GT(dropped, 0U);
    EXPECT_GT(inherited, 0);
}

TEST(CacheFrameDeathTest, FactsOfAnotherEyeOrFrameEndTheProgram) {
    const BoxTree tree = tree_of(plain_with_hole());
    const auto count = static_cast<Index>(tree.boxes.size());
    const CacheOptions options;
    const CacheState state = empty_state(tree);
    std::vector<BoxFacts> facts(count);
    evaluate_boxes(tree, view_from({-20, 1, 30}, 3), options, state, 0, count, facts);
    EXPECT_FALSE(plan_frame(tree, view_from({-20, 1, 30}, 3), options, state, facts).draws.empty());
    EXPECT_DEATH(plan_frame(tree, view_from({-20, 1, 31}, 3), options, state, facts), "eye");
    EXPECT_DEATH(plan_frame(tree, view_from({-20, 1, 30}, 4), options, state, facts), "eye");
}

/// Whether the way from a to b leads through the inside of a box.
bool leads_through(const dvec3& a, const dvec3& b, const Box& box) {
    double enter = 0, leave = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double way = b[axis] - a[axis], low = box.min[axis] + 1e-6 - a[axis], high = box.max[axis] - 1e-6 - a[axis];
        if (std::abs(way) < 1e-12) {
            if (low > 0 || high < 0) return false;
            continue;
        }
        enter = std::max(enter, std::min(low / way, high / way));
        leave = std::min(leave, std::max(low / way, high / way));
    }
    return enter < leave;
}

TEST(CacheFrame, DrawsBackToFront) {
    Random random(11);
    std::vector<Triangle> scattered;
    for (int i = 0; i < 400; ++i) {
        const dvec3 at = any_in(random, dvec3(0), dvec3(90, 40, 60));
        scattered.push_back({at, at + dvec3(1, 0, 1), at + dvec3(0, 1, 0)});
    }
    int behind = 0;
    for (const BoxTree& tree : {tree_of(plain_with_hole()), tree_of(scattered, 8, 3)}) {
        const dvec3 margin(20, 20, 20);
        for (int run = 0; run < 20; ++run) {
            const Box& all = tree.boxes.front().box;
            const CacheView view = view_from(any_in(random, all.min - margin, all.max + margin), 0);
            const CachePlan plan = plan_frame(tree, view, {}, empty_state(tree));
            for (std::size_t later = 0; later < plan.draws.size(); ++later) {
                const Box& box = tree.boxes[plan.draws[later].box].box;
                const dvec3 point = any_in(random, box.min, box.max);
                for (std::size_t other = 0; other < plan.draws.size(); ++other) {
                    if (other == later || !leads_through(view.eye, point, tree.boxes[plan.draws[other].box].box)) continue;
                    ++behind;
                    ASSERT_GT(other, later) << "what hides it is drawn before it";
                }
            }
        }
    }
    EXPECT_GT(behind, 1000);
}

TEST(CacheFrame, OptionsOutOfRangeAreRefused) {
    EXPECT_TRUE(check_cache_options({}));
    const auto refused = [](auto change) {
        CacheOptions options;
        change(options);
        const auto ok = check_cache_options(options);
        return !ok && ok.error().kind == ErrorKind::misuse;
    };
    EXPECT_TRUE(refused([](CacheOptions& o) { o.max_generation = 0xffffffffU; }));
    EXPECT_TRUE(refused([](CacheOptions& o) { o.max_texels = 0; }));
    EXPECT_TRUE(refused([](CacheOptions& o) { o.min_texels = 65; }));
    EXPECT_TRUE(refused([](CacheOptions& o) { o.max_texels = 1U << 31U; }));
    for (const double share : {0.0, 1.1, -1.0, static_cast<double>(NAN)})
        EXPECT_TRUE(refused([&](CacheOptions& o) { o.child_share = share; })) << share;
}

/// Most pictures that a frame of a straight walk makes after the first.
std::size_t max_refreshes_of(const BoxTree& tree, const CacheOptions& options, const dvec3& from, const dvec3& step) {
    CacheState state = empty_state(tree);
    std::size_t max = 0;
    for (std::uint32_t frame = 0; frame < 160; ++frame) {
        CachePlan plan = plan_frame(tree, view_from(from + step * static_cast<double>(frame), frame), options, state);
        EXPECT_LE(plan.counts.ahead, options.upkeep_refreshes + 80U) << "the last one may need a whole subtree";
        if (frame > 0) max = std::max(max, plan.refreshes.size());
        state = std::move(plan.after);
    }
    return max;
}

TEST(CacheFrame, RefreshingChildrenAheadSpreadsThem) {
    const BoxTree tree = tree_of(plain_with_hole());
    CacheOptions with, without;
    with.child_share = without.child_share = 0.5;  // children are refreshed early, so many at once
    without.upkeep_refreshes = 0;
    for (const auto& [from, step] :
         {std::pair{dvec3(-60, 1, 40), dvec3(0.02, 0, 0.02)}, {dvec3(48, 1, 48), dvec3(0.01, 0, 0.01)}})
        EXPECT_LT(3 * max_refreshes_of(tree, with, from, step), 2 * max_refreshes_of(tree, without, from, step));
}

TEST(CacheFrame, WhatWasUnusedForLongestMakesRoom) {
    const BoxTree tree = tree_of(plain_with_hole());
    CacheOptions options;
    options.max_bytes = 40 * bytes_of(64);
    CacheState state = empty_state(tree);
    std::size_t dropped = 0;
    for (std::uint32_t frame = 0; frame < 10; ++frame) {
        const CacheView view = view_from(frame < 3 ? dvec3(-40, 1, -40) : dvec3(35, 1, 35), frame);
        CachePlan plan = plan_frame(tree, view, options, state);
        expect_consistent(tree, view, options, plan);
        for (const Index box : plan.dropped) EXPECT_LT(state.last_used[box] + 1, frame);
        dropped += plan.dropped.size();
        state = std::move(plan.after);
    }
    EXPECT_GT(dropped, 0U);
}

TEST(CacheFrame, GenerationsAreBounded) {
    const BoxTree tree = tree_of(plain_with_hole());
    for (const std::uint32_t max_generation : {0U, 1U, 2U, 4U}) {
        CacheOptions options;
        options.max_generation = max_generation;
        const CachePlan plan = plan_frame(tree, view_from({-1500, 1, -1500}, 0), options, empty_state(tree));
        std::uint32_t largest = 0;
        for (const Picture& picture : plan.after.pictures) largest = std::max(largest, picture.generation);
        EXPECT_LE(largest, max_generation);
        if (max_generation == 4) {
            EXPECT_EQ(largest, 4U) << "the whole plain is one picture of pictures";
        }
        EXPECT_EQ(plan.draws.size(), 1U);
    }
}

TEST(CacheFrame, ByThePublishedRulesPicturesOfPicturesForgetTheirErrors) {
    const BoxTree tree = tree_of(plain_with_hole());
    CacheOptions options;
    options.rules = ValidityRules::published;
    CacheState state = empty_state(tree);
    std::vector<Picture> remembered(tree.boxes.size());  // the same pictures, with what their children lacked
    double max_forgotten = 0, max_error = 0;
    for (std::uint32_t frame = 0; frame < 120; ++frame) {
        const CacheView view = view_from({-40 + 0.02 * frame, 1, -20 + 0.03 * frame}, frame);
        CachePlan plan = plan_frame(tree, view, options, state);
        expect_whole(tree, view, plan);
        for (const Refresh& refresh : plan.refreshes) {
            const CacheBox& box = tree.boxes[refresh.box];
            Picture& picture = remembered[refresh.box];
            picture = plan.after.pictures[refresh.box];
            EXPECT_EQ(picture.inherited, 0);
            for (Index child = box.first_child; refresh.from_children && child < box.first_child + box.child_count; ++child) {
                if (tree.boxes[child].primitive_count == 0) continue;
                const double error = picture_errors(remembered[child], view.eye).total();
                picture.inherited = std::max(picture.inherited, inherited_error(error, picture.tangent));
            }
        }
        for (const BoxDraw& draw : plan.draws) {
            if (!draw.picture) continue;
            max_forgotten = std::max(max_forgotten, picture_errors(remembered[draw.box], view.eye).inherited);
            max_error = std::max(max_error, picture_errors(remembered[draw.box], view.eye).total());
        }
        state = std::move(plan.after);
    }
    const PixelAngles pixels = view_from({}, 0).pixels;
    EXPECT_GT(max_forgotten, 0.5 * pixels.mean_rad);
    EXPECT_GT(max_error, pixels.mean_rad) << "over what these rules allow";
}

TEST(CacheFrame, OneTriangleAndOneBoxAreDrawn) {
    const std::vector<Triangle> one = {{dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0)}};
    for (const std::uint32_t levels : {1U, 4U}) {
        const BoxTree tree = tree_of(one, 8, levels);
        CacheState state = empty_state(tree);
        const CacheOptions options;
        std::uint32_t frame = 0;
        for (const dvec3& eye :
             {dvec3(0.3, 0.3, 100), dvec3(0.3, 0.3, 1), dvec3(0.3, 0.3, 0), dvec3(0.3, 0.3, -1), dvec3(0.25, 0.25, 0)}) {
            const CacheView view = view_from(eye, frame++);
            CachePlan plan = plan_frame(tree, view, options, state);
            expect_consistent(tree, view, options, plan);
            EXPECT_GE(plan.draws.size(), 1U);
            if (levels == 1) {
                EXPECT_EQ(plan.draws.front().picture, eye.z == 100);
            }
            state = std::move(plan.after);
        }
    }
    const BoxTree none_at_all;
    EXPECT_TRUE(plan_frame(none_at_all, view_from({}, 0), {}, {}).draws.empty());
}

}  // namespace
}  // namespace surefoot::cache
