// What a sky takes of a frame: it is in the prediction, and the device charges as much.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "tests/engine/forest_engine.hpp"

namespace surefoot {
namespace {

constexpr model::Viewport sky_viewport{640, 400};

std::unique_ptr<Engine> engine_before(bool has_sky, bool shown = true, std::uint32_t samples = 1,
                                      const model::CostModel& costs = model::default_costs()) {
    model::Model forest = test::forest_model();
    for (model::EffectFinding& finding : forest.effects)
        if (finding.bit == model::effect_sky) finding.called_for = has_sky;
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    options.device.viewport = sky_viewport;
    options.device.samples = samples;
    options.device.rest = true;
    options.device.background = shown;
    auto opened = Engine::open(std::move(forest), costs, options);
    EXPECT_TRUE(opened.ok());
    return opened ? std::move(*opened) : nullptr;
}

double fixed_us(const Engine& engine, float resolution) {
    return static_cast<double>(engine.costs().combine_at(resolution, sky_viewport).fixed_us);
}

/// That the device charges for a frame without items, and for a picture at rest that is only begun.
std::pair<double, double> charged_us(Engine& engine, float resolution) {
    gl::Device& device = engine.device();
    device.draws.plays();
    const double before = device.charged_us();
    device.begin_frame(Pose{}, resolution);
    device.finish_frame();
    const double frame = device.charged_us();
    device.begin_rest(Pose{}, dvec2(0));
    return {frame - before, device.charged_us() - frame};
}

TEST(SkyPrice, IsOfEveryPixelOfEveryFrameAndIsCharged) {
    for (const std::uint32_t samples : {1U, 4U}) {
        const auto without = engine_before(false, true, samples), with = engine_before(true, true, samples),
                   hidden = engine_before(true, false, samples);
        ASSERT_TRUE(without && with && hidden);
        const double ns = static_cast<double>(model::CostModel{}.background_ns_per_pixel);
        EXPECT_GT(ns, 0);
        for (const float resolution : {1.0F, 0.5F}) {
            const double pixels = 640.0 * 400 * static_cast<double>(resolution * resolution), us = 1e-3 * ns * pixels;
            EXPECT_NEAR(fixed_us(*with, resolution) - fixed_us(*without, resolution), us, 0.1);
            EXPECT_EQ(fixed_us(*hidden, resolution), fixed_us(*without, resolution));
            const auto [frame, rest] = charged_us(*with, resolution);
            const auto [plain_frame, plain_rest] = charged_us(*without, resolution);
            EXPECT_NEAR(frame - plain_frame, us, 0.1);
            EXPECT_NEAR(rest - plain_rest, 1e-3 * ns * 640 * 400, 0.1) << "a picture at rest is whole";
        }
    }
}

TEST(SkyPrice, IsOfTheFirstPassOfAPictureAtRestAlone) {
    const auto without = engine_before(false), with = engine_before(true);
    ASSERT_TRUE(without && with);
    const auto charged_by_others = [](Engine& engine) {
        gl::Device& device = engine.device();
        device.draws.plays();
        device.begin_rest(Pose{}, dvec2(0));
        const double begun = device.charged_us();
        device.add_sample(true);
        device.show_rest(1);
        return device.charged_us() - begun;
    };
    EXPECT_NEAR(charged_by_others(*with), charged_by_others(*without), 1e-6);
    EXPECT_EQ(with->costs().rest_pass_us(sky_viewport), without->costs().rest_pass_us(sky_viewport));
}

/// The device draws while the time of the clock stands still: only what is in flight counts.
TEST(SkyPrice, IsInFlightUntilTheFirstSliceIsDrawn) {
    model::CostModel costs = model::default_costs();
    costs.background_ns_per_pixel = 100;
    const double sky_us = 1e-3 * 100 * 640 * 400;
    std::array<std::uint32_t, 2> coarse{};
    for (const bool has_sky : {false, true}) {
        const auto engine = engine_before(has_sky, true, 1, costs);
        ASSERT_NE(engine, nullptr);
        const Pose pose = test::forest_pose(*engine);
        prepare::PreparedFrame prepared;
        engine->reserve(prepared);
        engine->prepare({pose, 0.1, 0.06}, 0, 0, 0, prepared);
        engine->select(prepared, test::ample_us, {1, 1}, 0);
        SubmitLimits limits{.limit_us = sky_us};
        limits.now_ns = [](void*) -> std::int64_t { return 0; };
        coarse[has_sky ? 1 : 0] = engine->submit(pose, limits).downgraded_slices;
    }
    EXPECT_EQ(coarse[0], 0U);
    EXPECT_GT(coarse[1], 0U) << "the sky alone takes all of the time";
}

TEST(MissingPrices, AreTheUsualOnesOfWhatTheModelCallsFor) {
    model::Model forest = test::forest_model();
    for (model::EffectFinding& finding : forest.effects)
        if (finding.bit == model::effect_light_by_pixel) finding.called_for = true;
    model::CostModel costs = model::default_costs();
    costs.prices = {{model::effect_sun, 1, 1, 1}};
    costs.prices_measured = costs.calibrated = true;
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    const auto engine = Engine::open(std::move(forest), costs, options);
    ASSERT_TRUE(engine.ok());
    std::vector<model::EffectMask> priced;
    for (const model::EffectPrice& price : (*engine)->costs().prices) priced.push_back(price.effect);
    EXPECT_EQ(priced, (std::vector<model::EffectMask>{model::effect_sun, model::effect_light_by_pixel}));
}

TEST(SkyPrice, IsListedWithTheProgramsOfAModelThatHasIt) {
    const auto without = engine_before(false), with = engine_before(true);
    ASSERT_TRUE(without && with);
    EXPECT_EQ(with->device().program_listing().size(), without->device().program_listing().size() + 1);
    EXPECT_NE(with->device().program_text(model::effect_sky), "");
    EXPECT_EQ(without->device().program_text(model::effect_sky), "");
}

}  // namespace
}  // namespace surefoot
