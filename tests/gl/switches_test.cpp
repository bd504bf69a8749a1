// Switches of effects on a device: all that they need is there once a model is loaded. Changing them makes and compiles nothing.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/gl_device.hpp"
#include "tests/gl/fake_gl.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

using test::FakeGl;

TEST(EffectSwitches, are_changed_without_making_or_compiling_anything) {
    const std::vector<model::EffectMask> groups{model::effect_sun | model::effect_shadow, model::effect_shadow,
                                                model::effect_lamps, model::effect_fog};
    test::SmallModel scene;
    constexpr model::EffectMask all = model::effect_sun | model::effect_shadow | model::effect_lamps | model::effect_fog;
    const std::vector<gl::DrawItem> items{
        {scene.square(scene.material(test::plain(1, 0, 0, 1, all)), test::at(0, 0, -5)), 0},
        {scene.square(scene.material(test::plain(0, 1, 0, 1, model::effect_sun)), test::at(1, 0, -5)), 1}};
    model::Model model = scene.finish();
    model.sun_seen.assign(model.vertices.size(), model::always_in_sun);
    model.lamp_light.resize(model.vertices.size());
    gl::DeviceOptions options;
    options.viewport = {64, 64};
    options.max_items = 16;
    options.switches = groups;
    auto device = gl::GlDevice::make(std::make_unique<test::FakeContext>(), options);
    ASSERT_TRUE(device.ok()) << device.error().text();
    gl::Device& drawn = **device;
    drawn.draws.plays();
    ASSERT_TRUE(drawn.load(model, effects::assemble_program).ok());
    const int compiles = FakeGl::get().compiles, linked = FakeGl::get().linked, objects = FakeGl::get().objects();
    EXPECT_GT(linked, 8) << "without every union of the groups";
    EXPECT_GT(compiles, 8);
    for (unsigned turn = 0; turn <= 16; ++turn) {
        model::EffectMask hidden = 0;
        for (std::size_t i = 0; i < groups.size(); ++i)
            if ((turn >> i & 1U) != 0) hidden |= groups[i];
        drawn.hide_effects(hidden);
        drawn.begin_frame(Pose{});
        drawn.draw(items);
        drawn.end_slice();
        drawn.end_items();
        drawn.finish_frame();
        drawn.present();
    }
    EXPECT_EQ(FakeGl::get().compiles, compiles);
    EXPECT_EQ(FakeGl::get().linked, linked);
    EXPECT_EQ(FakeGl::get().objects(), objects);
}

}  // namespace
}  // namespace surefoot
