// Effects that show nothing in the light of a frame are left out: pictures are equal to the bit, costs are lower, and nobody is
// told that they were switched off or dropped.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/effects/effects.hpp"
#include "render/engine.hpp"
#include "tests/bake/house_scene.hpp"
#include "tests/bake/moving_scene.hpp"
#include "tests/effects/effect_scene.hpp"
#include "tests/engine/moving_frame.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot {
namespace {

using model::EffectMask;
using Pixels = std::vector<std::uint8_t>;

constexpr EffectMask lit_sun = model::effect_sun, lit_lamps = model::effect_lamps,
                     all_shadows = model::effect_shadow | model::effect_moving_shadow;
constexpr model::Viewport lamp_picture{160, 96};

/// The findings that a bake would write.
model::Model with_findings(model::Model model) {
    EffectMask used = 0;
    for (const model::Material& material : model.materials) used |= material.effects;
    model.effects.clear();
    for (std::uint32_t e = 0; e < model::effect_count; ++e)
        model.effects.push_back({1U << e, (used >> e & 1U) != 0, 1, "", true});
    return model;
}

model::Model stripped(model::Model m, EffectMask of) {
    for (model::Material& material : m.materials) material.effects &= ~of;
    for (model::Representation& rep : m.reps) rep.effects &= ~of;
    return m;
}

/// Two models that lamps and shadows fall on, and where they are seen from.
struct LampScene {
    std::string name;
    model::Model model;
    std::vector<Pose> poses;
};

Result<model::Model> baked_fully(const importer::Scene& scene) {
    bake::BakeOptions options;
    options.quality = bake::Quality::full;
    return bake::bake(scene, options, {});
}

/// A house with a closed room, lamps within and without, and a ball that flies about it.
LampScene baked_house() {
    importer::Scene scene = lit::house_scene();
    scene.lamps = {lit::bulb(dvec3(-2, 2.5, 1), 120), lit::bulb(dvec3(7, 3, 2), 300)};
    bake::place_moving(scene, bake::add_mesh(scene, bake::ball(6, 0.6F), "ball"), dvec3(9, 3, 0),
                       bake::add_turn(scene, dvec3(0, 3, 0), dvec3(0, 1, 0), 8));
    auto baked = baked_fully(scene);
    EXPECT_TRUE(baked.ok());
    LampScene house{"house", std::move(*baked), std::vector<Pose>(2)};
    house.poses[0].position = dvec3(-1, 2, 0);
    house.poses[1].position = dvec3(14, 5, 10);
    house.poses[1].orientation = glm::quatLookAt(glm::normalize(-house.poses[1].position), dvec3(0, 1, 0));
    return house;
}

/// A part of the town in the evening.
LampScene baked_town() {
    auto scene = scenes::generate("town", 0.01, 1, true);
    EXPECT_TRUE(scene.ok());
    auto baked = baked_fully(scene->scene);
    EXPECT_TRUE(baked.ok());
    LampScene town{"town", std::move(*baked), {}};
    for (const double share : {0.05, 0.4, 0.75}) town.poses.push_back(sample_path(scene->path, share * scene->path.duration_s()));
    return town;
}

const LampScene& hall_with_lamps() {
    static const LampScene hall = [] {
        test::EffectScene scene;
        return LampScene{"hall", with_findings(scene.build(test::EffectScene::own_effects)), scene.poses()};
    }();
    return hall;
}

const LampScene& house_with_lamps() {
    static const LampScene house = baked_house();
    return house;
}

/// The same, and nothing receives a shadow of what moves.
const LampScene& still_house() {
    static const LampScene house{"still house", with_findings(stripped(house_with_lamps().model, model::effect_moving_shadow)),
                                 house_with_lamps().poses};
    return house;
}

std::vector<gl::DrawItem> leaves_of(const model::Model& m) {
    std::vector<gl::DrawItem> items;
    for (model::Index n = 0; n < m.nodes.size(); ++n)
        if (m.nodes[n].child_count == 0) items.push_back({n, m.nodes[n].first_rep + m.nodes[n].rep_count - 1});
    return items;
}

gl::DeviceOptions pictures_by(gl::BackendKind kind, std::vector<EffectMask> switches) {
    gl::DeviceOptions options;
    options.kind = kind;
    options.viewport = lamp_picture;
    options.switches = std::move(switches);
    return options;
}

/// A device that draws all effects in any light.
std::unique_ptr<gl::Device> plain_device(const model::Model& m, std::vector<EffectMask> switches = {}) {
    auto device = gl::open_device(pictures_by(gl::BackendKind::egl, std::move(switches)));
    if (!device) return nullptr;
    (*device)->draws.plays();
    EXPECT_TRUE((*device)->load(m, effects::assemble_program).ok());
    return std::move(*device);
}

Pixels picture_of(gl::Device& device) {
    device.draws.plays();
    auto image = device.read_pixels();
    EXPECT_TRUE(image.ok());
    return image.ok() ? image->rgba : Pixels{};
}

Pixels plain_picture(gl::Device& device, const model::Model& m, const Pose& pose) {
    device.bind();
    device.begin_frame(pose);
    device.draw(leaves_of(m));
    device.end_slice();
    device.end_items();
    device.finish_frame();
    Pixels pixels = picture_of(device);
    device.release();
    return pixels;
}

/// Without a number: the model's own light.
model::Daylight light_of(const model::Model& m, std::optional<double> hour) {
    return hour ? model::daylight_at(*hour, m.light) : model::daylight_of_model(m.sun_direction, m.light);
}

std::unique_ptr<Engine> engine_of(const model::Model& m, gl::DeviceOptions device, bool buys = false,
                                  const model::CostModel& costs = model::default_costs(), double rest_after_ms = 0) {
    EngineOptions options;
    options.device = std::move(device);
    options.buys_effects = buys;
    options.rest_after_ms = rest_after_ms;
    options.motion = !(rest_after_ms > 0);
    options.slice_us = 1e9;  // one slice: the number of slices goes by costs, and they have their own
    if (buys) options.effect_hours = {0, 6, 12, 18, 24};
    auto opened = Engine::open(m, costs, options);
    EXPECT_TRUE(opened.ok());
    return opened ? std::move(*opened) : nullptr;
}

Pixels engine_picture(Engine& engine, const model::Model& m, const Pose& pose) {
    engine.device().bind();
    engine.draw_unbudgeted(pose, leaves_of(m));
    Pixels pixels = picture_of(engine.device());
    engine.device().release();
    return pixels;
}

class UnlitEffects : public ::testing::Test {
protected:
    void SetUp() override {
#ifdef SUREFOOT_WATCHES_THREADS
        GTEST_SKIP() << "no GL is opened where the thread sanitizer watches";
#endif
    }
};

const std::vector<std::optional<double>> some_hours{std::nullopt, 12.0, 3.9, 4.1, 20.0, 22.0, 0.0};

void expect_no_trace_at_any_hour(const LampScene& scene) {
    const auto plain = plain_device(scene.model);
    ASSERT_NE(plain, nullptr);
    plain->draws.plays();
    plain->release();
    const auto engine = engine_of(scene.model, pictures_by(gl::BackendKind::egl, {}));
    ASSERT_NE(engine, nullptr);
    const std::vector<std::string> programs = engine->device().program_listing();
    engine->device().draws.plays();
    engine->device().release();
    for (const std::optional<double>& hour : some_hours) {
        const model::Daylight light = light_of(scene.model, hour);
        plain->bind();
        plain->set_light(light);
        plain->release();
        engine->device().bind();
        engine->set_light(light);
        engine->device().release();
        for (const Pose& pose : scene.poses)
            EXPECT_EQ(engine_picture(*engine, scene.model, pose), plain_picture(*plain, scene.model, pose))
                << scene.name << " at " << hour.value_or(-1);
    }
    EXPECT_EQ(engine->device().program_listing(), programs) << "compiled when the model was loaded, and no more since";
}

TEST_F(UnlitEffects, LeaveNoTraceInThePictureAtAnyHour) {
    expect_no_trace_at_any_hour(hall_with_lamps());
    expect_no_trace_at_any_hour(house_with_lamps());
}

/// Two things have squares that overlap in one plane, where their depths are equal: the one that is drawn first shows.
TEST_F(UnlitEffects, ThatAreLeftOutDoNotChangeWhichOfTwoEqualDepthsShows) {
    for (const bool lamps_on_first : {true, false}) {
        test::SmallModel small;
        // Out of view: so the programs are not in the order of the squares.
        small.square(small.material(test::plain(0, 0, 1, 1, lit_sun | (lamps_on_first ? 0U : lit_lamps))), test::at(0, 0, 30));
        for (const bool first : {true, false}) {
            const EffectMask effects = lit_sun | (first == lamps_on_first ? lit_lamps : 0U);
            model::Material material = test::plain(first ? 1.0F : 0.0F, first ? 0.0F : 1.0F, 0, 1, effects);
            material.two_sided = true;
            const float half = first ? 1.0F : 0.7F, away = first ? 5.0F : -6.0F;
            test::Shape shape = test::sheet(half, 1);
            // Not flat, or the first in the model would win, as parts in one plane are told apart.
            shape.quad({vec3(0, away, -1), vec3(0.1F, away, -1), vec3(0.1F, away + 0.1F, -1), vec3(0, away + 0.1F, -1)});
            small.object(shape.vertices, shape.indices, small.material(material), test::at(first ? 0 : 0.3, 0.1, -3));
        }
        model::Model m = with_findings(small.finish());
        m.lamp_light.assign(m.vertices.size(), {{90, 90, 90, 0}, {}});
        gl::DeviceOptions how = pictures_by(gl::BackendKind::egl, {});
        how.viewport = {65, 65};
        const auto engine = engine_of(m, how);
        auto plain = gl::open_device(how);
        ASSERT_TRUE(engine != nullptr && plain.ok());
        engine->device().draws.plays();
        engine->device().release();
        (*plain)->bind();
        ASSERT_TRUE((*plain)->load(m, effects::assemble_program).ok());
        (*plain)->release();
        EXPECT_EQ(engine_picture(*engine, m, {}), plain_picture(**plain, m, {})) << lamps_on_first;
    }
}

/// Its bake takes half a minute.
using UnlitEffectsAtNight = UnlitEffects;
TEST_F(UnlitEffectsAtNight, OfATownLeaveNoTraceAtAnyHour) { expect_no_trace_at_any_hour(baked_town()); }

/// What the engine leaves out by an hour would show at another; and the sun shows at midnight, by its sky and ground.
TEST_F(UnlitEffects, OthersAndOtherHoursWouldShow) {
    const std::vector<EffectMask> switches{lit_sun | all_shadows, all_shadows, model::effect_shadow, lit_lamps};
    for (const LampScene& scene : {hall_with_lamps(), house_with_lamps()}) {
        const auto device = plain_device(scene.model, switches);
        ASSERT_NE(device, nullptr);
        device->draws.plays();
        device->release();
        const auto differ = [&](double hour, EffectMask hidden) {
            bool any = false;
            for (const Pose& pose : scene.poses) {
                device->bind();
                device->set_light(model::daylight_at(hour, scene.model.light));
                device->hide_effects(0);
                device->release();
                const Pixels with = plain_picture(*device, scene.model, pose);
                device->bind();
                device->hide_effects(hidden);
                device->release();
                any = any || plain_picture(*device, scene.model, pose) != with;
            }
            return any;
        };
        EXPECT_TRUE(differ(0, lit_sun | all_shadows)) << scene.name << ": sky and ground light";
        EXPECT_FALSE(differ(0, all_shadows)) << scene.name;
        EXPECT_TRUE(differ(12, all_shadows)) << scene.name;
        EXPECT_TRUE(differ(22, lit_lamps)) << scene.name;
        EXPECT_FALSE(differ(12, lit_lamps)) << scene.name;
    }
}

TEST_F(UnlitEffects, LeavePicturesAtRestAloneAndAreInThemWhenTheyShow) {
    const LampScene& scene = still_house();
    const auto plain = plain_device(scene.model);
    ASSERT_NE(plain, nullptr);
    plain->draws.plays();
    plain->release();
    model::CostModel slow = model::default_costs();  // a sample of the picture at rest takes a frame and more
    slow.combine.submit_weight *= 30;
    slow.combine.raster_weight *= 30;
    const auto engine = engine_of(scene.model, pictures_by(gl::BackendKind::egl, {}), false, slow, 100);
    prepare::PreparedFrame prepared;
    engine->reserve(prepared);
    std::int64_t at_ns = 0;
    const Pose pose = scene.poses.back();
    for (const double hour : {12.0, 22.0, 0.0, 12.0}) {
        engine->device().bind();
        engine->set_light(model::daylight_at(hour, scene.model.light));
        SubmitReport report;
        std::size_t rested = 0;
        Pixels first;
        for (int i = 0; i < 20; ++i) {
            engine->prepare({pose, 0.25, 0.06}, 0, 0, 0, prepared);
            engine->hide_effects(0);  // as a walk does before each frame
            engine->select(prepared, 30'000, {}, 0);
            SubmitLimits limits;
            limits.limit_us = 32'000;
            limits.frame_ns = at_ns += 33'000'000;
            report = engine->submit(pose, limits);
            if (report.at_rest && report.rest_samples == 1 && rested++ == 0) first = picture_of(engine->device());
        }
        engine->device().release();
        EXPECT_GE(rested, 1U) << hour;
        plain->bind();
        plain->set_light(model::daylight_at(hour, scene.model.light));
        plain->release();
        EXPECT_EQ(first, plain_picture(*plain, scene.model, pose)) << hour;
    }
}

/// An engine that charges what it predicts.
struct ChargedEngine {
    std::unique_ptr<Engine> engine;
    prepare::PreparedFrame set;
    Pose pose;
    ChargedEngine(const model::Model& m, const Pose& from, std::vector<EffectMask> switches = {}, bool buys = false,
                  const model::CostModel& costs = model::default_costs())
        : engine(engine_of(m, pictures_by(gl::BackendKind::null, std::move(switches)), buys, costs)), pose(from) {
        engine->device().draws.plays();
        engine->reserve(set);
    }
    void light(const model::Daylight& light, double hour) {
        engine->device().draws.plays();
        engine->set_light(light, static_cast<float>(hour));
    }
    /// Predicted and charged, us.
    std::pair<double, double> frame(double budget_us = 1e9, bool prepares = true) {
        engine->device().draws.plays();
        if (prepares) engine->prepare({pose, 0, 0}, 0, 0, 0, set);
        engine->select(set, budget_us, {}, 0);
        const double before = engine->device().charged_us();
        const SubmitReport report = engine->submit(pose, {.elapsed_us = 0, .limit_us = 1e9});
        return {report.predicted_us, engine->device().charged_us() - before};
    }
};

model::CostModel dear_effects() {
    model::CostModel costs = model::default_costs();
    costs.prices = {{lit_lamps, 200, 300, 2}, {model::effect_shadow, 300, 200, 1}};
    return costs;
}

TEST(UnlitEffectCosts, AreNeitherPredictedNorCharged) {
    const LampScene& scene = still_house();
    const Pose pose = scene.poses.back();
    const auto cost = [&](const model::Model& m, std::optional<double> hour) {
        ChargedEngine house(m, pose, {}, false, dear_effects());
        if (hour) house.light(model::daylight_at(*hour, scene.model.light), *hour);
        const auto [predicted, charged] = house.frame();
        EXPECT_NEAR(predicted, charged, 1e-4 * charged);
        return charged;
    };
    const model::Model lampless = stripped(scene.model, lit_lamps);
    const double no_lamps = cost(lampless, 12), no_shadows = cost(stripped(scene.model, all_shadows), 0);
    EXPECT_NEAR(cost(scene.model, std::nullopt), cost(lampless, std::nullopt), 1e-6 * no_lamps)
        << "lamps are off without an hour";
    EXPECT_NEAR(cost(scene.model, 12), no_lamps, 1e-6 * no_lamps);
    EXPECT_NEAR(cost(scene.model, 0), no_shadows, 1e-6 * no_shadows);
    const double dusk = cost(scene.model, 20);
    EXPECT_GT(dusk, 1.001 * no_lamps) << "both show";
    EXPECT_GT(dusk, 1.001 * no_shadows);
}

/// The set of a frame is older than its light, by up to three frames.
TEST(UnlitEffectCosts, AreRightInTheFrameThatTheLightChangesIn) {
    const LampScene& scene = still_house();
    ChargedEngine house(scene.model, scene.poses.back(), {}, false, dear_effects());
    double before = 0;
    for (const double hour : {12.0, 22.0, 12.0, 20.0, 0.0}) {
        house.light(model::daylight_at(hour, scene.model.light), hour);
        if (before == 0) house.frame();
        const auto [predicted, charged] = house.frame(1e9, false);
        EXPECT_NEAR(predicted, charged, 1e-4 * charged) << hour << " by a set of the light before";
        EXPECT_NE(charged, before) << hour;
        const auto [later, later_charged] = house.frame();
        EXPECT_NEAR(later_charged, charged, 1e-4 * charged) << hour << " by a set of its own light";
        EXPECT_NEAR(later, later_charged, 1e-4 * charged);
        before = charged;
    }
}

TEST(UnlitEffectCosts, AreNoSaleAndNoLackOfTime) {
    const LampScene& scene = still_house();
    model::CostModel costs = model::default_costs();
    costs.prices = {{lit_lamps, 0, 0, 1e4F}, {model::effect_shadow, 0, 0, 1e4F}};
    const std::vector<EffectMask> switches{model::effect_sun | model::effect_shadow, model::effect_shadow, lit_lamps};
    constexpr std::size_t of_shade = 1, of_lamps = 2;
    ChargedEngine house(scene.model, scene.poses.back(), switches, true, costs);
    const auto sales_at = [&](double hour) {
        house.light(model::daylight_at(hour, scene.model.light), hour);
        const auto [predicted, charged] = house.frame(20'000);
        EXPECT_NEAR(predicted, charged, 1e-4 * charged) << hour;
        return std::array{house.engine->effect_sales()[of_shade], house.engine->effect_sales()[of_lamps]};
    };
    for (const double hour : {12.0, 0.0, 12.0}) {
        const auto [shadow, lamp] = sales_at(hour);
        const bool day = hour == 12.0;
        EXPECT_TRUE(day ? shadow.dropped : lamp.dropped) << hour << ": it would show, and is too dear";
        EXPECT_GT((day ? shadow : lamp).rate, 0) << hour;
        EXPECT_FALSE((day ? lamp : shadow).dropped) << hour << ": it shows nothing";
        EXPECT_FALSE((day ? lamp : shadow).fell) << hour;
        EXPECT_EQ((day ? lamp : shadow).rate, 0) << hour << ": it is not for sale";
    }
}

/// hide_effects() goes by the switches of the options alone.
TEST(UnlitEffectCosts, GiveNobodyASwitch) {
    const LampScene& scene = still_house();
    ChargedEngine house(scene.model, scene.poses.back(), {}, false, dear_effects());
    for (const double hour : {12.0, 20.0, 0.0}) {
        house.light(model::daylight_at(hour, scene.model.light), hour);
        const double before = house.frame().second;
        house.engine->device().draws.plays();
        house.engine->hide_effects(~EffectMask{0});
        EXPECT_EQ(house.frame().second, before) << hour;
        house.engine->hide_effects(0);
    }
    EXPECT_TRUE(house.engine->options().device.switches.empty());
}

/// A ball circles over a lawn. By night nothing reads the map.
TEST_F(UnlitEffects, OfWhatMovesLeaveNoTraceByNight) {
    importer::Index ball = importer::none;
    importer::Scene scene = bake::lawn_with_ball_mesh(ball);
    bake::place_moving(scene, ball, dvec3(5, 3, 0), bake::add_turn(scene, dvec3(0, 3, 0), dvec3(0, 1, 0), 8));
    const auto baked = bake::bake(scene, {}, {});
    ASSERT_TRUE(baked.ok());
    ASSERT_NE(baked->called_for() & model::effect_moving_shadow, 0U);
    Pose pose;
    pose.position = dvec3(0, 12, 20);
    pose.orientation = glm::quatLookAt(glm::normalize(-pose.position), dvec3(0, 1, 0));
    const auto plain = plain_device(*baked);
    ASSERT_NE(plain, nullptr);
    plain->draws.plays();
    plain->release();
    const auto engine = engine_of(*baked, pictures_by(gl::BackendKind::egl, {}));
    ChargedEngine yard(*baked, pose), without(stripped(*baked, model::effect_moving_shadow), pose);
    for (const double hour : {0.0, 12.0}) {
        const model::Daylight light = model::daylight_at(hour, baked->light);
        plain->bind();
        plain->set_light(light);
        plain->release();
        engine->device().bind();
        engine->set_light(light);
        EXPECT_EQ(engine->refresh_shadow(pose), hour == 12.0);
        engine->device().release();
        const Pixels shown = engine_picture(*engine, *baked, pose), unshaded = plain_picture(*plain, *baked, pose);
        EXPECT_EQ(shown == unshaded, hour == 0.0) << hour;
        yard.light(light, hour);
        without.light(light, hour);
        EXPECT_EQ(yard.frame().second == without.frame().second, hour == 0.0) << hour;
    }
}

}  // namespace
}  // namespace surefoot
