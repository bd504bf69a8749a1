// Effects as items of a frame's budget: bought by value per us, charged as predicted, and left out without flicker.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "render/effect_lever.hpp"
#include "tests/engine/forest_engine.hpp"
#include "tests/select/count_malloc.hpp"

namespace surefoot {
namespace {

using model::effect_fog, model::effect_shadow;
using test::ample_us;

constexpr std::size_t shade = 0, fog = 1;  // of the switches

/// A forest in fog, where something hides the sun everywhere. Baked once.
const model::Model& foggy_forest() {
    static const model::Model forest = [] {
        auto scene = scenes::generate("forest", 0.2, 1);
        EXPECT_TRUE(scene.ok());
        auto baked = bake::bake(scene->scene, {}, {});
        EXPECT_TRUE(baked.ok());
        for (model::Material& material : baked->materials) {
            material.effects |= effect_fog;
            if ((material.effects & model::effect_sun) != 0) material.effects |= effect_shadow;
        }
        for (model::Representation& rep : baked->reps) rep.effects |= effect_fog | effect_shadow;
        baked->sun_seen.resize(baked->vertices.size());
        baked->light.fog_visibility_m = 200;
        return std::move(*baked);
    }();
    return forest;
}

/// The forest in shadow and fog. Prices in ns a pixel.
struct EffectForest {
    std::unique_ptr<Engine> engine;
    prepare::PreparedFrame set;

    explicit EffectForest(float shade_ns, float fog_ns, bool buys = true, model::EffectMask with_fog = effect_fog) {
        model::CostModel costs = model::default_costs();
        costs.prices = {{effect_shadow, 0, 0, shade_ns}, {effect_fog, 0, 0, fog_ns}};
        EngineOptions options;
        options.device.kind = gl::BackendKind::null;
        options.device.switches = {effect_shadow, with_fog};
        options.buys_effects = buys;
        auto opened = Engine::open(foggy_forest(), costs, options);
        EXPECT_TRUE(opened.ok());
        engine = std::move(*opened);
        engine->reserve(set);
        prepare();
    }
    void prepare() { engine->prepare({test::forest_pose(*engine), 0, 0}, 0, 0, 0, set); }
    /// Predicted and charged, us.
    std::pair<double, double> draw(double budget_us) {
        engine->device().draws.plays();
        engine->select(set, budget_us, {}, 0);
        const double before = engine->device().charged_us();
        report = engine->submit(test::forest_pose(*engine), {.elapsed_us = 0, .limit_us = ample_us});
        return {report.predicted_us, engine->device().charged_us() - before};
    }
    [[nodiscard]] EffectSale sale(std::size_t i) const { return engine->effect_sales()[i]; }
    SubmitReport report;
};

TEST(EngineEffects, WithTimeForAllAreShownChargedAndPredicted) {
    EffectForest f(0.5F, 0.25F);
    EXPECT_EQ(f.set.without, effect_shadow | effect_fog) << "forms are priced without what is bought beside them";
    EXPECT_GT(f.set.effect_value[shade], 0);
    EXPECT_GT(f.set.effect_value[fog], 0);
    EXPECT_LE(f.set.effect_value[shade], 1.001F * f.set.curve.full_value) << "no more than all that is seen";
    const auto [predicted, charged] = f.draw(ample_us);
    EXPECT_NEAR(predicted, charged, 1e-4 * charged);
    EXPECT_EQ(f.report.bought_items, 2U);
    for (const std::size_t i : {shade, fog}) {
        EXPECT_FALSE(f.sale(i).dropped);
        EXPECT_GT(f.sale(i).rate, 0);
    }
    EffectForest always(0.5F, 0.25F, false);
    EXPECT_TRUE(always.engine->effect_sales().empty());
    EXPECT_EQ(always.set.without, 0U);
    EXPECT_EQ(always.set.effect_value[shade], 0);
    EXPECT_NEAR(always.draw(ample_us).first, predicted, 0.01 * predicted) << "the same, but for the ends of slices";
}

TEST(EngineEffects, TheOneOfTheLeastValuePerMicrosecondGoesFirst) {
    std::array<int, 2> first{};
    for (const auto& [shade_ns, fog_ns] : {std::pair{0.5F, 20.0F}, {60.0F, 0.2F}, {5.0F, 2.5F}, {2.0F, 8.0F}, {300.0F, 0.5F}}) {
        EffectForest f(shade_ns, fog_ns);
        const double full_us = f.draw(ample_us).first;
        for (double budget_us = full_us; budget_us > 0.01 * full_us; budget_us *= 0.95) {
            const auto [predicted, charged] = f.draw(budget_us);
            EXPECT_NEAR(predicted, charged, 1e-4 * charged);
            if (!f.sale(shade).fell && !f.sale(fog).fell) continue;
            if (f.sale(shade).fell && f.sale(fog).fell) break;
            const std::size_t gone = f.sale(shade).fell ? shade : fog;
            EXPECT_LT(f.sale(gone).rate, f.sale(1 - gone).rate);
            EXPECT_TRUE(f.sale(gone).dropped && !f.sale(1 - gone).dropped);
            ++first[gone];
            break;
        }
    }
    EXPECT_GT(first[shade], 0) << "dear shadows go before a cheap fog";
    EXPECT_GT(first[fog], 0);
}

TEST(EngineEffects, APartThatGoesWithAnotherIsNeitherChargedNorCalledShown) {
    EffectForest f(0.05F, 30.0F, true, effect_fog | effect_shadow);  // as shadows go with the sun
    const double full_us = f.draw(ample_us).first;
    bool went = false;
    for (double budget_us = full_us; budget_us > 0.01 * full_us; budget_us *= 0.95) {
        const auto [predicted, charged] = f.draw(budget_us);
        EXPECT_NEAR(predicted, charged, 1e-4 * charged);
        EXPECT_TRUE(f.sale(shade).dropped || !f.sale(fog).dropped) << "at " << budget_us;
        went = went || f.sale(fog).dropped;
    }
    EXPECT_TRUE(went);
}

TEST(EngineEffects, FormsHaveTheTimeOfTheOneThatIsLeftOut) {
    EffectForest f(0.0F, 40.0F), always(0.0F, 40.0F, false);
    EffectForest cheap(0.0F, 0.0F);
    const double budget_us = 1.2 * cheap.draw(ample_us).first;
    const auto [predicted, charged] = f.draw(budget_us);
    EXPECT_TRUE(f.sale(fog).dropped);
    EXPECT_EQ(f.sale(shade).rate, 0) << "what costs nothing is no item";
    EXPECT_FALSE(f.sale(shade).dropped);
    EXPECT_NEAR(predicted, charged, 1e-4 * charged);
    EXPECT_LE(predicted, budget_us);
    always.draw(budget_us);
    EXPECT_GT(f.report.triangles, always.report.triangles);
    EXPECT_GT(f.report.value, always.report.value);
}

TEST(EngineEffects, ADroppedOneStaysAwayForSecondsAndLongerEachTime) {
    EffectForest f(0.0F, 1.0F);
    f.draw(0);
    for (int i = 0; i < 4; ++i) {
        f.draw(ample_us);
        EXPECT_TRUE(f.sale(fog).dropped) << i;
    }
    for (int i = 0; i < 30; ++i) f.draw(ample_us);
    EXPECT_FALSE(f.sale(fog).dropped) << "a fall at the start is soon taken back";
    std::vector<std::uint32_t> away;
    for (int fall = 0; fall < 4; ++fall) {
        f.draw(0);
        ASSERT_TRUE(f.sale(fog).dropped && f.sale(fog).fell) << fall;
        std::uint32_t frames = 0;
        for (; f.sale(fog).dropped; ++frames) {
            ASSERT_LT(frames, 10'000U);
            f.draw(ample_us);
            ASSERT_FALSE(f.sale(fog).fell);
        }
        away.push_back(frames);
    }
    EXPECT_EQ(away, (std::vector<std::uint32_t>{90, 180, 360, 720})) << "it came back for a frame each time";
    for (std::uint32_t i = 0; i < 8 * 720; ++i) f.draw(ample_us);
    f.draw(0);
    std::uint32_t frames = 0;
    for (; f.sale(fog).dropped; ++frames) f.draw(ample_us);
    EXPECT_EQ(frames, 90U) << "it had stayed long";
}

TEST(EngineEffects, AtAnyBudgetNoneComesAndGoesFromFrameToFrame) {
    EffectForest f(0.4F, 0.4F);
    const double full_us = f.draw(ample_us).first;
    for (int i = 0; i < 30; ++i) f.draw(ample_us);
    std::array<std::uint32_t, 2> changed_at{};
    std::array<bool, 2> was{false, false};
    int changes = 0;
    for (std::uint32_t i = 1; i < 3000; ++i) {
        f.draw(full_us * (0.45 + 0.55 * std::sin(0.37 * i) * std::sin(0.011 * i)));
        for (const std::size_t e : {shade, fog}) {
            if (f.sale(e).dropped == was[e]) continue;
            was[e] = f.sale(e).dropped;
            ++changes;
            EXPECT_TRUE(was[e] || i - changed_at[e] >= 90U) << "frame " << i;
            changed_at[e] = i;
        }
    }
    EXPECT_GT(changes, 2);
    EXPECT_LT(changes, 40);
}

TEST(EngineEffects, WhatIsSwitchedOffIsNeitherPricedNorBought) {
    EffectForest f(0.5F, 0.25F), always(0.5F, 0.25F, false);
    for (EffectForest* const forest : {&f, &always}) {
        const double with = forest->draw(ample_us).first;
        forest->engine->device().draws.plays();
        forest->engine->hide_effects(effect_fog);
        forest->prepare();
        const auto [predicted, charged] = forest->draw(ample_us);
        EXPECT_LT(predicted, 0.99 * with);
        EXPECT_NEAR(predicted, charged, 1e-4 * charged);
        forest->engine->select_last();
        forest->engine->device().draws.plays();
        const double before = forest->engine->device().charged_us();
        const SubmitReport last =
            forest->engine->submit(test::forest_pose(*forest->engine), {.elapsed_us = 0, .limit_us = ample_us});
        EXPECT_NEAR(last.predicted_us, forest->engine->device().charged_us() - before, 1e-4 * last.predicted_us);
    }
    EXPECT_EQ(f.sale(fog).rate, 0);
    EXPECT_FALSE(f.sale(fog).dropped) << "a visitor's choice is no lack of time";
    EXPECT_GT(f.sale(shade).rate, 0);
    EXPECT_EQ(always.set.without, effect_fog);
}

/// Beyond the visibility, shadows show nothing in the fog, and all of themselves without it.
TEST(EngineEffects, FogThatIsOffOrDroppedTakesNothingFromTheWorthOfOthers) {
    const auto value = [](EffectForest& f, std::size_t of) {
        f.prepare();
        return f.set.effect_value[of];
    };
    EffectForest f(0.01F, 0.01F);
    f.draw(ample_us);
    const float in_fog = value(f, shade), of_fog = value(f, fog);
    f.engine->device().draws.plays();
    f.engine->hide_effects(effect_fog);
    const float in_clear = value(f, shade);
    EXPECT_GT(in_clear, 1.2F * in_fog);
    f.engine->device().draws.plays();
    f.engine->hide_effects(0);
    EXPECT_EQ(value(f, shade), in_fog);

    EffectForest dear(0.01F, 1000.0F);
    EXPECT_EQ(value(dear, shade), in_fog) << "nothing was selected yet";
    dear.draw(20'000);
    ASSERT_TRUE(dear.sale(fog).dropped);
    EXPECT_EQ(value(dear, shade), in_clear) << "the picture has no fog";
    EXPECT_EQ(value(dear, fog), of_fog) << "so that it can come back";
}

TEST(EngineEffects, WithoutBudgetAllAreShownAndPricedWithTheForms) {
    EffectForest f(0.5F, 0.25F);
    ASSERT_TRUE(f.engine->set_selector("distance").ok());
    f.prepare();
    EXPECT_EQ(f.set.without, 0U);
    const auto [predicted, charged] = f.draw(1);
    EXPECT_NEAR(predicted, charged, 1e-4 * charged);
    for (const std::size_t i : {shade, fog}) EXPECT_FALSE(f.sale(i).dropped);
}

TEST(EngineEffects, GreedyChoosesTheRenderingOfTheFrame) {
    EffectForest f(0.01F, 40.0F);
    ASSERT_TRUE(f.engine->set_selector("greedy").ok());
    f.prepare();
    const double full_us = f.draw(ample_us).first;
    EXPECT_FALSE(f.sale(fog).dropped);
    f.draw(0.3 * full_us);
    EXPECT_TRUE(f.sale(fog).dropped);
    EXPECT_FALSE(f.sale(shade).dropped) << "it shows more for its time than the last objects";
}

TEST(EngineEffects, AreBoughtWithoutAnAllocation) {
    EffectForest f(0.4F, 0.4F);
    const double full_us = f.draw(ample_us).first;
    f.draw(0.3 * full_us);
    const std::uint64_t before = test::allocations();
    for (int i = 0; i < 10; ++i) f.draw((0.2 + 0.2 * i) * full_us);
    EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace surefoot
