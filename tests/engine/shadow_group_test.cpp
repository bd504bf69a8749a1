// The shadow map of what moves as a part of groups of effects: hidden whole or not, bought with them, and left out with them.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/engine.hpp"
#include "tests/bake/moving_scene.hpp"
#include "tests/engine/moving_frame.hpp"

namespace surefoot {
namespace {

constexpr model::EffectMask group_sun = model::effect_sun, group_shadow = model::effect_shadow,
                            group_moving = model::effect_moving_shadow;

/// A ball circles over a lawn.
model::Model baked_yard() {
    importer::Index ball = importer::none;
    importer::Scene scene = bake::lawn_with_ball_mesh(ball);
    bake::place_moving(scene, ball, dvec3(5, 3, 0), bake::add_turn(scene, dvec3(0, 3, 0), dvec3(0, 1, 0), 8));
    auto m = bake::bake(scene, {}, {});
    EXPECT_TRUE(m.ok());
    return std::move(*m);
}

/// `shaded`: something unseen takes most of the lawn's sun, as baked.
model::Model yard_model(bool shaded) {
    static const model::Model baked = baked_yard();
    model::Model m = baked;
    if (!shaded) return m;
    const auto add_shadow = [](model::EffectMask& effects) {
        if ((effects & group_moving) != 0) effects |= group_shadow;
    };
    for (model::Material& material : m.materials) add_shadow(material.effects);
    for (model::Representation& rep : m.reps) add_shadow(rep.effects);
    for (model::EffectFinding& finding : m.effects) finding.called_for |= finding.bit == group_shadow;
    m.sun_seen.assign(m.vertices.size(), {{51, 51}});
    return m;
}

/// Frames of an engine that buys its effects, or not.
struct YardFrames {
    std::unique_ptr<Engine> engine;
    prepare::PreparedFrame prepared;
    Pose pose;

    YardFrames(bool shaded, std::vector<model::EffectMask> switches, bool buys,
               const model::CostModel& costs = model::default_costs()) {
        pose.position = dvec3(0, 12, 20);
        pose.orientation = glm::quatLookAt(glm::normalize(-pose.position), dvec3(0, 1, 0));
        EngineOptions options;
        options.device.kind = gl::BackendKind::null;
        options.device.viewport = {320, 180};
        options.device.switches = std::move(switches);
        options.buys_effects = buys;
        auto opened = Engine::open(yard_model(shaded), costs, options);
        EXPECT_TRUE(opened.ok());
        engine = std::move(*opened);
        engine->device().draws.plays();
        engine->reserve(prepared);
    }
    SubmitReport frame(double time_s, double budget_us = 1e6) {
        SubmitLimits limits;
        limits.limit_us = 1e6;
        return test::moving_frame(*engine, prepared, pose, time_s, budget_us, limits);
    }
    [[nodiscard]] bool offers_a_refresh() const {
        const std::span<const select::Item> list = engine->offered().offered();
        return std::any_of(list.begin(), list.end(), [](const auto& item) { return item.kind == select::ItemKind::refresh; });
    }
};

TEST(ShadowGroups, OtherGroupsThatAreHiddenLeaveTheMap) {
    YardFrames yard(false, {group_sun}, false);
    yard.engine->hide_effects(~model::EffectMask{0});  // all that has a switch: the sun alone
    EXPECT_TRUE(yard.engine->refresh_shadow(yard.pose));
    const SubmitReport report = yard.frame(3);
    EXPECT_TRUE(report.shadow_refreshed && report.shadow_shown);
    YardFrames hidden(false, {group_moving}, false);
    hidden.engine->hide_effects(~model::EffectMask{0});
    EXPECT_FALSE(hidden.engine->refresh_shadow(hidden.pose));
    EXPECT_FALSE(hidden.frame(3).shadow_shown);
}

TEST(ShadowGroups, FramesThatBuyEffectsPredictTheReadingOfTheMap) {
    for (const bool shaded : {false, true}) {
        const model::EffectMask shadows = (shaded ? group_shadow : 0) | group_moving;
        YardFrames yard(shaded, {group_sun | shadows, shadows}, true);
        for (const double time_s : {1.0, 1.1, 1.1}) {
            const SubmitReport report = yard.frame(time_s);
            EXPECT_TRUE(report.shadow_shown);
            for (const EffectSale& sale : yard.engine->effect_sales()) EXPECT_FALSE(sale.dropped);
            EXPECT_NEAR(report.finished_us, report.predicted_us, 1e-3 * report.predicted_us) << shaded << " at " << time_s;
        }
        yard.engine->hide_effects(shadows);
        for (const double time_s : {1.2, 1.3}) {
            const SubmitReport report = yard.frame(time_s);
            EXPECT_FALSE(report.shadow_shown);
            EXPECT_NEAR(report.finished_us, report.predicted_us, 1e-3 * report.predicted_us) << shaded << " at " << time_s;
        }
    }
}

TEST(ShadowGroups, NoRefreshIsBoughtWhereShadowsAreDropped) {
    model::CostModel costs = model::default_costs();
    costs.prices = {{group_shadow, 0, 0, 1e5F}};
    YardFrames yard(true, {group_sun | group_shadow | group_moving, group_shadow | group_moving}, true, costs);
    for (int i = 0; i < 5; ++i) {
        const SubmitReport report = yard.frame(1 + 0.1 * i, 20'000);
        ASSERT_TRUE(yard.engine->effect_sales()[1].dropped);
        EXPECT_FALSE(yard.engine->effect_sales()[0].dropped) << "the sun costs nothing";
        EXPECT_FALSE(report.shadow_refreshed || report.shadow_shown);
        EXPECT_EQ(yard.offers_a_refresh(), i == 0) << "the first frame does not know it yet, frame " << i;
        EXPECT_FALSE(yard.engine->bought(select::ItemKind::refresh, 0)) << i;
        EXPECT_EQ(report.bought_items, 0U) << i;
        EXPECT_EQ(report.bought_us, 0) << i;
        EXPECT_NEAR(report.finished_us, report.predicted_us, 1e-3 * report.predicted_us) << i;
    }
}

}  // namespace
}  // namespace surefoot
