// The processor's copy of the light, by which effects are valued, against the reference that pictures are compared with.
#include "render/effects/surface_light.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "rt/base/random.hpp"
#include "tests/effects/reference_shading.hpp"

namespace surefoot::effects {
namespace {

constexpr model::EffectMask of_light =
    model::effect_sun | model::effect_openness | model::effect_shadow | model::effect_lamps | model::effect_lit_picture;

reference::Light reference_light(const model::Daylight& light) {
    reference::Light out;
    out.towards_sun = dvec3(light.sun_direction);
    out.sun = dvec3(light.sun_light);
    out.ground = dvec3(light.ground_light);
    out.sky = dvec3(light.sky_light);
    out.moment = light.sun_moment;
    out.between = static_cast<double>(light.sun_between);
    out.lamps = static_cast<double>(light.lamp_strength);
    out.rooms = static_cast<double>(light.room_light);
    return out;
}

/// Any light on a picture.
PictureLight any_picture(Random& random, const model::Model& model) {
    PictureLight picture;
    const auto byte = [&] { return static_cast<std::uint8_t>(random.below(256)); };
    picture.from = {byte(), byte(), byte(), 0};
    picture.sun = model.sun_seen[0];
    for (std::uint8_t& root : picture.lamps) root = byte();
    return picture;
}

/// The same, as a vertex of the reference has it.
reference::Surface surface_of(const PictureLight& picture, double in_sun) {
    reference::Surface surface;
    surface.hidden = dvec4(picture.from[0], picture.from[1], picture.from[2], 0) / 255.0;
    surface.picture_sun = in_sun;
    surface.picture_lamps = dvec3(picture.lamps[0], picture.lamps[1], picture.lamps[2]) / 255.0;
    return surface;
}

TEST(SurfaceLight, EqualsTheReferenceByEveryMaskAtEveryHour) {
    Random random(7);
    model::LightFacts facts;
    facts.max_lamp_light = 1.5F;
    facts.night_room_light = 0.4F;
    model::Model model;
    model.sun_seen.resize(1);
    model.lamp_light.resize(1);
    for (int i = 0; i < 2000; ++i) {
        const model::Daylight light =
            i % 10 == 0 ? model::daylight_of_model(model.sun_direction, facts) : model::daylight_at(random.range(0, 24), facts);
        for (std::uint8_t& share : model.sun_seen[0].share) share = static_cast<std::uint8_t>(random.below(256));
        for (std::uint8_t& byte : model.lamp_light[0].before) byte = static_cast<std::uint8_t>(random.below(256));
        const reference::View view{model, {}, {}, dvec3(0), reference_light(light)};
        reference::LitSide side;
        side.normal = glm::normalize(any_in(random, dvec3(-1), dvec3(1)));
        side.sky = random.unit();
        side.room = random.unit();
        model::Material material;
        material.effects = static_cast<model::EffectMask>(random.next()) & of_light;
        if ((material.effects & model::effect_shadow) != 0) side.sun = reference::sun_at_vertex(view, 0);
        if ((material.effects & model::effect_lamps) != 0) side.lamps = reference::lamps_at_vertex(view, 0, false);
        SurfacePoint point;
        point.normal = vec3(side.normal);
        point.sees_sky = static_cast<float>(side.sky);
        point.sees_room = static_cast<float>(side.room);
        point.sun_seen = model.sun_seen[0];
        const std::uint8_t* const lamps = model.lamp_light[0].before;
        point.by_lamps = vec3(lamps[0], lamps[1], lamps[2]) / 255.0F;
        const bool is_picture = (material.effects & model::effect_lit_picture) != 0;
        if (is_picture) {
            point.picture = any_picture(random, model);
            side.picture = reference::light_on_picture(view.light, surface_of(point.picture, reference::sun_at_vertex(view, 0)));
        }
        const dvec3 expected = reference::light_at_vertex(view, material, side);
        const vec3 found = light_of(point, material.effects, light);
        for (int c = 0; c < 3; ++c) {
            const double scale = is_picture ? std::max(1.0, expected[c]) : 1.0;  // its light multiplies that of others
            ASSERT_NEAR(found[c], expected[c], 2e-5 * scale) << effects_text(material.effects) << ", " << i;
        }
    }
}

TEST(SurfaceLight, EachModuleWithLightHasOne) {
    for (const EffectModule& module : all_effects()) {
        EXPECT_EQ(module.light != nullptr, module.is_light()) << module.name;
        if (module.priced_on == 0) {
            EXPECT_EQ(module.usual_price.effect, 0U) << module.name;
            continue;
        }
        EXPECT_EQ(module.usual_price.effect, module.bit) << module.name;
        EXPECT_EQ(module.priced_on & module.bit, 0U) << module.name << " is measured on a class without it";
    }
}

}  // namespace
}  // namespace surefoot::effects
