// The second mip level as an item: its price, the wait for it, and what the frame that buys it draws.
#include "render/filter_lever.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "render/engine.hpp"
#include "tests/engine/forest_engine.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

using rt::TextureFilter;
using select::ItemKind;

/// Frames with this share until the step is offered and bought; 0: it is not within 2000.
std::uint32_t frames_until_bought(QualityDwell& dwell, double share) {
    for (std::uint32_t frame = 1; frame <= 2000; ++frame) {
        if (!dwell.offer(share)) continue;
        dwell.answer(true);
        return frame;
    }
    return 0;
}

TEST(QualityDwell, WaitsForFramesWithAmpleTimeAndStaysAsLongAsItFits) {
    QualityDwell dwell;
    EXPECT_EQ(frames_until_bought(dwell, 0.91), 0U) << "it would fit, but without ample time";
    EXPECT_EQ(frames_until_bought(dwell, 0.9), QualityDwell::min_wait);
    for (const double share : {0.5, 0.95, 1.0}) {
        EXPECT_TRUE(dwell.offer(share)) << share;
        dwell.answer(true);
    }
    EXPECT_FALSE(dwell.offer(1.01)) << "at once: no frame may be late for it";
    EXPECT_FALSE(dwell.on());
}

TEST(QualityDwell, OneFrameWithoutTimeBeginsTheWaitAnew) {
    QualityDwell dwell;
    for (std::uint32_t i = 1; i < QualityDwell::min_wait; ++i) EXPECT_FALSE(dwell.offer(0.5));
    EXPECT_FALSE(dwell.offer(0.95));
    EXPECT_EQ(frames_until_bought(dwell, 0.5), QualityDwell::min_wait);
    QualityDwell refused;
    for (std::uint32_t i = 1; i < QualityDwell::min_wait; ++i) EXPECT_FALSE(refused.offer(0.5));
    EXPECT_TRUE(refused.offer(0.5));
    refused.answer(false);
    EXPECT_TRUE(refused.offer(0.5)) << "others were dearer to that frame: it is offered to the next one";
}

TEST(QualityDwell, WaitsTwiceAsLongAfterAShortStay) {
    QualityDwell dwell;
    std::uint32_t wait = QualityDwell::min_wait;
    for (int i = 0; i < 8; ++i) {
        EXPECT_EQ(frames_until_bought(dwell, 0.5), wait);
        dwell.answer(false);
        wait = std::min(2 * wait, QualityDwell::max_wait);
    }
    EXPECT_EQ(frames_until_bought(dwell, 0.5), QualityDwell::max_wait);
    for (std::uint32_t i = 0; i < 8 * QualityDwell::max_wait; ++i) {
        EXPECT_TRUE(dwell.offer(1));
        dwell.answer(true);
    }
    EXPECT_FALSE(dwell.offer(2));
    EXPECT_EQ(frames_until_bought(dwell, 0.5), QualityDwell::min_wait) << "after a long stay";
}

TEST(QualityDwell, AShareThatIsNoNumberDoesNotFit) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        QualityDwell dwell;
        EXPECT_EQ(frames_until_bought(dwell, bad), 0U);
        EXPECT_EQ(frames_until_bought(dwell, 0.5), QualityDwell::min_wait);
        EXPECT_FALSE(dwell.offer(bad));
    }
}

/// A textured square twice as wide as the other in one representation, then each alone.
model::Model mixed_squares() {
    test::SmallModel scene;
    model::Material picture = test::plain(1, 1, 1, 1, model::effect_texture);
    picture.texture = scene.texture({255, 0, 0, 255}, {0, 0, 255, 255}, 64);
    const auto textured = scene.material(picture), bare = scene.material(test::plain(0, 1, 0));
    const auto both = scene.square(textured, test::at(0, 0, -3), 2);
    scene.square(bare, test::at(4, 0, -3), 1);
    scene.square(textured, test::at(-4, 0, -3), 1);
    model::Model model = scene.finish();
    model::Representation& rep = model.reps[model.nodes[both].first_rep];
    rep.part_count = 2;
    rep.triangles = 4;
    return model;
}

TEST(FilterCosts, GrowByTheShareOfTexturedPixels) {
    model::CostModel costs = model::default_costs();  // 3 ns a textured pixel, 1.5 ns a bare one
    costs.trilinear_factor = 1.5F;
    const model::Model model = mixed_squares();
    const FilterCosts filter(model, costs);
    ASSERT_TRUE(filter.any());
    const auto grown = [&](model::Index node) { return filter.with(model.nodes[node].first_rep, {7, 100}).raster_us; };
    EXPECT_NEAR(grown(1), 100 + 50 * (16 * 3.0F) / (16 * 3.0F + 4 * 1.5F), 0.01);
    EXPECT_EQ(grown(2), 100);
    EXPECT_FLOAT_EQ(grown(3), 150);
    EXPECT_EQ(filter.with(model.nodes[3].first_rep, {7, 100}).submit_us, 7);
    model::CostModel priced = costs;
    priced.ns_per_pixel = 1;
    const FilterCosts with_price(model, priced);
    const auto grown_beside = [&](model::Index node) { return with_price.with(model.nodes[node].first_rep, {7, 100}).raster_us; };
    EXPECT_NEAR(grown_beside(3), 100 + 50 * 3.0F / (3.0F + 1.0F), 0.01) << "the price of every pixel does not grow";
    EXPECT_NEAR(grown_beside(1), 100 + 50 * (16 * 3.0F) / (16 * (3.0F + 1.0F) + 4 * (1.5F + 1.0F)), 0.01);
    EXPECT_EQ(grown_beside(2), 100);
    for (const float odd : {1.0F, 0.5F, std::nanf(""), std::numeric_limits<float>::infinity()}) {
        costs.trilinear_factor = odd;
        EXPECT_FALSE(FilterCosts(model, costs).any()) << odd;
    }
}

/// Eight textured squares ahead.
model::Model textured_wall(bool textured = true) {
    test::SmallModel scene;
    model::Material picture = test::plain(0.8F, 0.9F, 1, 1, textured ? model::effect_texture : model::EffectMask{0});
    if (textured) picture.texture = scene.texture({255, 0, 0, 255}, {0, 0, 255, 255}, 64);
    const auto material = scene.material(picture);
    for (int i = 0; i < 8; ++i) scene.square(material, test::at(0.5 * (i % 4) - 0.75, i < 4 ? -0.3 : 0.3, -2.4), 0.25F);
    scene.finish();
    model::Model& model = scene.model();
    if (textured) std::fill(model.texels.begin() + 4 * (64 * 64 + 32 * 32), model.texels.end(), std::byte{0});  // coarser: black
    // The root shows one square, which is far from right.
    model.reps.push_back(model.reps.front());
    model.reps.back().error_m = 1;
    model.nodes[0].first_rep = static_cast<model::Index>(model.reps.size() - 1);
    return model;
}

struct FilteredWalk {
    std::unique_ptr<Engine> engine;
    Pose pose;
    prepare::PreparedFrame set;
    double charged_us = 0;
    SubmitReport report;

    FilteredWalk() = default;
    explicit FilteredWalk(model::Model model, bool second_filter = true,
                          std::string selector = std::string(select::usual_selector)) {
        EngineOptions options;
        options.device.kind = gl::BackendKind::null;
        options.device.second_filter = second_filter;
        options.selector = std::move(selector);
        open(std::move(model), options);
    }
    /// With pictures.
    explicit FilteredWalk(TextureFilter filter) {
        EngineOptions options;
        options.device.viewport = {160, 96};
        options.device.filter = filter;
        options.device.second_filter = true;
        options.rest_after_ms = 500;
        open(textured_wall(), options);
    }
    void open(model::Model model, const EngineOptions& options, const model::CostModel& costs = model::default_costs()) {
        auto opened = Engine::open(std::move(model), costs, options);
        if (!opened) return;
        engine = std::move(*opened);
        engine->device().draws.plays();
        engine->reserve(set);
    }
    /// Several devices of a test take turns.
    void bind() const {
        engine->device().draws.plays();
        engine->device().bind();
    }
    /// Returns what the selection predicts, with headroom.
    double frame(double budget_us, std::int64_t at_ns = -1) {
        bind();
        engine->device().draws.plays();
        engine->prepare({pose, 0, 0}, 0, 0, 0, set);  // prices are of this very pose
        engine->offer_filter(set, budget_us, {});
        const double predicted_us = static_cast<double>(engine->select(set, budget_us, {}, 0).predicted_us);
        const double before_us = engine->device().charged_us();
        report = engine->submit(pose, {.elapsed_us = 0, .limit_us = budget_us, .frame_ns = at_ns});
        charged_us = engine->device().charged_us() - before_us;
        return predicted_us;
    }
    std::uint32_t frames_until_trilinear(double budget_us) {
        for (std::uint32_t i = 1; i <= 1000; ++i) {
            frame(budget_us);
            if (report.filter == TextureFilter::trilinear) return i;
        }
        return 0;
    }
    /// What the second level costs the frame, by hand: all is textured, so a quarter less a hundredth of the raster time.
    [[nodiscard]] double price_us() const { return 0.24 * double{set.full_cost.raster_us} * raster_weight; }
    static constexpr double raster_weight = 0.5, headroom = 1.25;
};

TEST(EngineFilter, IsBoughtAfterAWhileOfAmpleTimeAndChargedAsPredicted) {
    FilteredWalk walk(textured_wall());
    ASSERT_TRUE(walk.engine);
    const double without_us = walk.frame(1e6);
    const SubmitReport plain = walk.report;
    const double plain_charged_us = walk.charged_us;
    EXPECT_EQ(plain.filter, TextureFilter::bilinear);
    EXPECT_EQ(plain.bought_items, 0U);
    const double price_us = walk.price_us();
    ASSERT_GT(price_us, 1);
    const double with_us = without_us + price_us * FilteredWalk::headroom;
    FilteredWalk tight(textured_wall());
    EXPECT_EQ(tight.frames_until_trilinear(with_us / 0.97 / 0.9 * 0.9999), 0U) << "it fits, but without ample time";
    EXPECT_EQ(tight.report.bought_items, 0U);
    FilteredWalk ample(textured_wall());
    EXPECT_EQ(ample.frames_until_trilinear(with_us / 0.97 / 0.9 * 1.0001), QualityDwell::min_wait);
    EXPECT_TRUE(ample.engine->bought(ItemKind::filter, 1));
    EXPECT_EQ(ample.report.bought_items, 1U);
    EXPECT_NEAR(ample.report.bought_us, price_us, 1e-3);
    EXPECT_NEAR(ample.report.predicted_us, plain.predicted_us + price_us, 1e-3);
    EXPECT_NEAR(ample.charged_us, plain_charged_us + price_us, 1e-3) << "charged with the draws, once";
    EXPECT_NEAR(ample.report.predicted_us, ample.charged_us, 1e-3);
    EXPECT_EQ(ample.report.triangles, plain.triangles);
    EXPECT_EQ(ample.report.downgraded_slices, 0U);
}

TEST(EngineFilter, StaysWhileItFitsAndLeavesAtOnceWhereItDoesNot) {
    FilteredWalk walk(textured_wall());
    ASSERT_TRUE(walk.engine);
    const double without_us = walk.frame(1e6), with_us = without_us + walk.price_us() * FilteredWalk::headroom;
    const std::uint64_t all = walk.report.triangles;
    ASSERT_GT(walk.frames_until_trilinear(2 * with_us), 0U);
    for (int i = 0; i < 100; ++i) {
        EXPECT_NEAR(walk.frame(1.0001 * with_us / 0.97), with_us, 1e-2);
        ASSERT_EQ(walk.report.filter, TextureFilter::trilinear) << i;
        ASSERT_LE(walk.charged_us, with_us);
    }
    walk.frame(0.9999 * with_us / 0.97);
    EXPECT_EQ(walk.report.filter, TextureFilter::bilinear);
    EXPECT_EQ(walk.report.triangles, all) << "forms are worth more";
    EXPECT_LE(walk.charged_us, without_us);
    EXPECT_EQ(walk.frames_until_trilinear(2 * with_us), 2 * QualityDwell::min_wait) << "it stayed for 101 frames only";
    walk.engine->select_last();
    walk.engine->device().draws.plays();
    EXPECT_EQ(walk.engine->submit({}, {.elapsed_us = 0, .limit_us = 1e6}).filter, TextureFilter::bilinear);
    walk.frame(2 * with_us);
    EXPECT_EQ(walk.report.filter, TextureFilter::bilinear) << "a frame without a prepared set ends it too";
}

TEST(EngineFilter, AViewWithoutTexturesEndsItAndTheWaitBeginsAnew) {
    FilteredWalk walk(textured_wall());
    ASSERT_TRUE(walk.engine);
    ASSERT_EQ(walk.frames_until_trilinear(1e6), QualityDwell::min_wait);
    const Pose ahead = walk.pose;
    walk.pose.orientation = glm::angleAxis(3.14159265358979, dvec3(0, 1, 0));
    walk.frame(1e6);
    EXPECT_EQ(walk.report.filter, TextureFilter::bilinear) << "there is nothing to filter";
    EXPECT_EQ(walk.report.refused_items, 0U);
    walk.pose = ahead;
    EXPECT_EQ(walk.frames_until_trilinear(1e6), 2 * QualityDwell::min_wait) << "it stayed for one frame";
}

TEST(EngineFilter, WhatTakesNoTimeIsNotOffered) {
    FilteredWalk walk;
    model::CostModel costs = model::default_costs();
    costs.combine.raster_weight = costs.combine.max_weight = 0;  // a machine whose frames wait for submission alone
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    options.device.second_filter = true;
    walk.open(textured_wall(), options, costs);
    ASSERT_TRUE(walk.engine);
    for (std::uint32_t i = 0; i < 2 * QualityDwell::min_wait; ++i) {
        walk.frame(1e6);
        ASSERT_EQ(walk.report.refused_items, 0U) << i;
    }
    EXPECT_GT(walk.set.full_filter_us, 0) << "or the test shows nothing";
}

TEST(EngineFilter, DoesNotFlickerWhereTheBudgetTrembles) {
    FilteredWalk walk(textured_wall());
    ASSERT_TRUE(walk.engine);
    const double without_us = walk.frame(1e6), with_us = without_us + walk.price_us() * FilteredWalk::headroom;
    const auto changes = [&](double middle) {
        int count = 0;
        for (int i = 0; i < 2000; ++i) {
            const TextureFilter before = walk.report.filter;
            const double budget_us = middle * with_us / 0.97 * (1 + 0.04 * std::sin(0.7 * i));
            walk.frame(budget_us);
            EXPECT_LE(walk.charged_us, std::max(budget_us, without_us)) << i;
            count += walk.report.filter != before ? 1 : 0;
        }
        return count;
    };
    EXPECT_EQ(changes(1.0), 0) << "never ample";
    EXPECT_EQ(changes(1.07), 0) << "mostly not ample for " << QualityDwell::min_wait << " frames on end";
    EXPECT_EQ(changes(1.2), 1);
    EXPECT_EQ(changes(1.05), 0) << "where it is on, it stays";
}

TEST(EngineFilter, IsOfferedOnlyWhereSomethingIsTexturedAndABudgetRules) {
    const auto bought = [](FilteredWalk walk) {
        EXPECT_TRUE(walk.engine);
        const bool trilinear = walk.frames_until_trilinear(1e6) > 0;
        EXPECT_EQ(walk.report.bought_items, trilinear ? 1U : 0U);
        EXPECT_EQ(walk.report.refused_items, 0U);
        return trilinear;
    };
    EXPECT_TRUE(bought(FilteredWalk(textured_wall())));
    EXPECT_TRUE(bought(FilteredWalk(textured_wall(), true, "two-stage")));
    EXPECT_FALSE(bought(FilteredWalk(textured_wall(), false)));
    EXPECT_FALSE(bought(FilteredWalk(textured_wall(false))));
    EXPECT_FALSE(bought(FilteredWalk(textured_wall(), true, "flat"))) << "full detail for comparisons is always the same";
}

model::Model textured_forest() {
    model::Model forest = test::forest_model();
    for (model::Material& material : forest.materials) material.effects |= model::effect_texture;
    for (model::Representation& rep : forest.reps) rep.effects |= model::effect_texture;
    return forest;
}

TEST(EngineFilter, TheInFrameCheckCountsItSliceBySlice) {
    FilteredWalk walk(textured_forest());
    ASSERT_TRUE(walk.engine);
    const Pose pose = test::forest_pose(*walk.engine);
    double charged_us = 0;
    const auto frame = [&](double limit_us) {
        walk.engine->device().draws.plays();
        walk.engine->prepare({pose, 0, 0}, 0, 0, 0, walk.set);
        walk.engine->offer_filter(walk.set, test::ample_us, {});
        walk.engine->select(walk.set, test::ample_us, {}, 0);
        const double before_us = walk.engine->device().charged_us();
        const SubmitReport report = walk.engine->submit(pose, {.elapsed_us = 0, .limit_us = limit_us});
        charged_us = walk.engine->device().charged_us() - before_us;
        return report;
    };
    const SubmitReport one = frame(test::ample_us);
    EXPECT_EQ(one.filter, TextureFilter::bilinear);
    const double one_us = charged_us;
    for (std::uint32_t i = 2; i < QualityDwell::min_wait; ++i) frame(test::ample_us);
    const SubmitReport two = frame(test::ample_us);
    EXPECT_EQ(two.filter, TextureFilter::trilinear);
    EXPECT_NEAR(two.predicted_us, charged_us, 1e-3 * charged_us);
    EXPECT_NEAR(two.predicted_us - one.predicted_us, two.bought_us, 1e-3 * two.bought_us) << "not counted twice";
    ASSERT_GT(charged_us, 1.05 * one_us) << "or the test shows nothing";
    const double limit_us = 0.95 * charged_us;
    const SubmitReport tight = frame(limit_us);
    EXPECT_EQ(tight.filter, TextureFilter::trilinear);
    EXPECT_GT(tight.downgraded_slices, 0U) << "without the price of the filter, all would seem to fit";
    EXPECT_LE(charged_us, limit_us);
}

std::vector<std::uint8_t> picture_in(const FilteredWalk& walk) {
    walk.bind();
    walk.engine->device().draws.plays();
    auto image = walk.engine->device().read_pixels();
    EXPECT_TRUE(image.ok());
    return image.ok() ? std::move(image->rgba) : std::vector<std::uint8_t>{};
}

TEST(EngineFilter, FramesHaveTheFilterThatTheyBoughtAndAllOtherPicturesTheBest) {
    FilteredWalk walk(TextureFilter::automatic), one(TextureFilter::bilinear), two(TextureFilter::trilinear);
    if (!walk.engine || !one.engine || !two.engine) GTEST_SKIP() << "no EGL";
    if (!walk.engine->device().switches_filter()) GTEST_SKIP() << "no software driver: it draws trilinear anyway";
    const auto full = walk.engine->full_detail({});
    const auto draw_full = [&](const FilteredWalk& each, TextureFilter filter) {
        each.bind();
        each.engine->draw_unbudgeted({}, full, 1, filter);
    };
    for (const FilteredWalk* each : {&walk, &one, &two}) draw_full(*each, TextureFilter::automatic);
    const auto bilinear = picture_in(one), trilinear = picture_in(two);
    EXPECT_NE(bilinear, trilinear) << "or the test shows nothing";
    EXPECT_EQ(picture_in(walk), trilinear);
    draw_full(walk, TextureFilter::bilinear);
    EXPECT_EQ(picture_in(walk), bilinear);
    draw_full(walk, TextureFilter::automatic);
    for (FilteredWalk* each : {&walk, &one, &two}) each->frame(1e6);
    EXPECT_EQ(walk.report.filter, TextureFilter::bilinear);
    EXPECT_EQ(picture_in(walk), picture_in(one)) << "whatever the picture before had";
    ASSERT_EQ(walk.frames_until_trilinear(1e6), QualityDwell::min_wait - 1);
    EXPECT_EQ(picture_in(walk), picture_in(two));
    EXPECT_EQ(one.frames_until_trilinear(1e6), 0U) << "a filter that was asked for stays";
}

TEST(EngineFilter, PicturesAtRestHaveTheBestFilterAndItsPrice) {
    FilteredWalk walk(TextureFilter::automatic), two(TextureFilter::trilinear);
    if (!walk.engine || !two.engine) GTEST_SKIP() << "no EGL";
    if (!walk.engine->device().switches_filter()) GTEST_SKIP() << "no software driver: it draws trilinear anyway";
    for (int i = 0; i < 20; ++i) {
        for (FilteredWalk* each : {&walk, &two}) each->frame(1e6, i * 33'000'000LL);
        ASSERT_EQ(walk.report.at_rest, two.report.at_rest);
        ASSERT_EQ(walk.report.rest_samples, two.report.rest_samples);
        if (!walk.report.at_rest) continue;
        EXPECT_NEAR(walk.report.predicted_us, two.report.predicted_us, 1e-3 * two.report.predicted_us);
    }
    ASSERT_GT(walk.report.rest_samples, 0U);
    EXPECT_EQ(walk.report.filter, TextureFilter::trilinear);
    EXPECT_EQ(picture_in(walk), picture_in(two));
}

}  // namespace
}  // namespace surefoot
