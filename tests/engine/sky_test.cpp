// What a sky takes of a frame: it is in the prediction, and the device charges as much.
#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "tests/engine/forest_engine.hpp"

namespace surefoot {
namespace {

constexpr model::Viewport sky_viewport{640, 400};

std::unique_ptr<Engine> engine_before(bool has_sky, bool shown = true, std::uint32_t samples = 1) {
    model::Model forest = test::forest_model();
    for (model::EffectFinding& finding : forest.effects)
        if (finding.bit == model::effect_sky) finding.called_for = has_sky;
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    options.device.viewport = sky_viewport;
    options.device.samples = samples;
    options.device.rest = true;
    options.device.background = shown;
    auto opened = Engine::open(std::move(forest), model::default_costs(), options);
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

TEST(SkyPrice, IsListedWithTheProgramsOfAModelThatHasIt) {
    const auto without = engine_before(false), with = engine_before(true);
    ASSERT_TRUE(without && with);
    EXPECT_EQ(with->device().program_listing().size(), without->device().program_listing().size() + 1);
    EXPECT_NE(with->device().program_text(model::effect_sky), "");
    EXPECT_EQ(without->device().program_text(model::effect_sky), "");
}

}  // namespace
}  // namespace surefoot
