// Where no picture pays, a walk's cache looks seldom; and where prices are in doubt it makes none that hardly pays.
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "render/cache/in_view.hpp"
#include "render/cache/walk_cache.hpp"
#include "rt/base/random.hpp"
#include "tests/cache/row.hpp"

namespace surefoot::cache {
namespace {

constexpr model::Viewport idle_view{1280, 720};

/// An eye that walks past the row, 300 m from it.
class IdleCache : public testing::TestWithParam<bool> {
protected:
    void SetUp() override {
        auto boxes = SceneBoxes::make(row_of_leaves(10.5), {}, TreeOptions{8, 2, 0});
        ASSERT_TRUE(boxes.ok());
        cache_ = WalkCache(std::move(*boxes), {.layers = 24, .surround = GetParam(), .picture_us = 100});
    }
    /// Each leaf costs so much as a form. Pictures that are offered are made. Their number; `looked` counts plans that looked.
    std::size_t frame(float cost_us, double picture_factor = 1) {
        Pose pose;
        pose.position = eye_;
        const model::Frustum seen = model::make_frustum(pose, idle_view, 1e4, 0.3, 0.2);
        const model::CoverBits set = cache_.cover(view_pixels(pose, idle_view, 0.2), 0.2);
        PlanView view;
        view.course = {eye_, step_m_, 0.03, 90};
        view.pixels = view_pixels(pose, idle_view, 0.3);
        view.frustum = &seen;
        view.pixel_rad = model::pixel_angle(pose, idle_view);
        view.view_px = 1.0 * idle_view.width * idle_view.height;
        view.max_price_us = 1e9;
        view.picture_factor = picture_factor;
        view.refills = refills_;
        std::size_t made = 0;
        for (const CacheOffer& offer : cache_.plan(view)) {
            if (!cache_.take(offer)) continue;
            cache_.captured(offer.box);
            ++made;
        }
        looked_ += cache_.is_idle() ? 0 : 1;
        if (!cache_.is_idle()) {  // as the engine does
            cache_.begin_costs(set);
            for (model::Index n = 1; n < 9; ++n)
                if (!cache_.boxes().covered(n, set)) cache_.add_cost(n, cost_us, 1, 1);
            cache_.end_costs();
        }
        eye_ += step_m_;
        return made;
    }
    WalkCache cache_;
    dvec3 eye_{60, 5, 300}, step_m_{0.05, 0, 0};
    bool refills_ = false;
    int looked_ = 0;
};

TEST_P(IdleCache, LooksInOneOfEightFramesWhereNothingPays) {
    for (int i = 0; i < 40; ++i) EXPECT_EQ(frame(1), 0U);
    looked_ = 0;
    for (int i = 0; i < 80; ++i) EXPECT_EQ(frame(1), 0U);
    EXPECT_EQ(looked_, 10);
    refills_ = true;
    looked_ = 0;
    for (int i = 0; i < 20; ++i) frame(1);
    EXPECT_EQ(looked_, 20) << "after a jump it looks in each frame";
}

/// At 30 frames a second that is a second. While pictures are made and shown it looks in each frame.
TEST_P(IdleCache, FindsWhatPaysWithinThirtyFrames) {
    for (int i = 0; i < 80; ++i) frame(1);
    std::size_t made = 0;
    for (int i = 0; i < 30; ++i) made += frame(2000);
    EXPECT_GT(made, 0U);
    looked_ = 0;
    for (int i = 0; i < 80; ++i) frame(2000);
    EXPECT_EQ(looked_, 80);
}

/// A picture that saves little is made where the table is right about pictures, and not where they take twice as long.
TEST_P(IdleCache, WherePricesAreInDoubtWhatHardlyPaysIsNotMade) {
    ASSERT_EQ(cache_.boxes().boxes_of(4).size(), 1U);
    const Index leaf = cache_.boxes().boxes_of(4)[0];
    const float price_us =
        cache_.draw_us(leaf, eye_, model::pixel_angle(Pose{}, idle_view), 1.0 * idle_view.width * idle_view.height);
    for (const auto& [factor, share, makes] : {std::tuple{1.0, 1.2F, true}, {2.0, 1.2F, false}, {2.0, 1.4F, true}}) {
        SetUp();
        std::size_t made = 0;
        const float saves_us = share * price_us * static_cast<float>(factor) / (factor > 1 ? 0.85F : 1.0F);
        for (int i = 0; i < 40; ++i) made += frame(saves_us, factor);
        EXPECT_EQ(made > 0, makes) << factor << " " << share;
    }
}

INSTANTIATE_TEST_SUITE_P(Keeps, IdleCache, testing::Bool(),
                         [](const auto& of) { return std::string(of.param ? "Surround" : "View"); });

/// From box to box the same boxes are in view as by a test of each, where those above it are.
TEST(InView, FindsWhatATestOfEachBoxFinds) {
    Random random(9);
    int in = 0, out = 0, whole = 0;
    for (int i = 0; i < 4000; ++i) {
        Pose pose;
        pose.position = any_in(random, dvec3(-30), dvec3(30));
        pose.orientation =
            glm::angleAxis(random.range(-3, 3), glm::normalize(any_in(random, dvec3(-1), dvec3(1)) + dvec3(0, 2, 0)));
        const bool region = random.below(2) == 0;
        const model::Frustum seen =
            model::make_frustum(pose, idle_view, 1e3, region ? 0.5 : 0.0, region ? random.range(0, 1.2) : 0.0);
        const dvec3 low = any_in(random, dvec3(-60), dvec3(40)), side = any_in(random, dvec3(0.5), dvec3(30));
        const Box above{low, low + side};
        const unsigned among = planes_across(seen, above, all_planes);
        ASSERT_EQ(among != out_of_view, model::visible(seen, above)) << i;
        for (int k = 0; k < 8; ++k) {
            const dvec3 at = low + side * any_in(random, dvec3(0), dvec3(0.7));
            const Box box{at, at + 0.3 * side * random.range(0, 1)};
            const unsigned across = planes_across(seen, box, among);
            ASSERT_EQ(across != out_of_view, among != out_of_view && model::visible(seen, box)) << i << " " << k;
            ++(across == out_of_view ? out : across == 0 ? whole : in);
        }
    }
    EXPECT_GT(in, 500);
    EXPECT_GT(out, 500);
    EXPECT_GT(whole, 500);
}

}  // namespace
}  // namespace surefoot::cache
