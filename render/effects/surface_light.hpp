// The light of a point of a surface, as the programs compute it at a vertex: the processor's own copy of their few lines.
#pragma once

#include <array>
#include <cstdint>

#include "render/effects/effects.hpp"
#include "render/model/daylight.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::effects {

/// The light of a picture, as a vertex with effect_lit_picture has it. Shares are of max_picture_light, in steps of 1/255.
struct PictureLight {
    std::array<std::uint8_t, 4> from{};   ///< sky, ground, rooms; Vertex::hidden
    model::SunSeen sun{};                 ///< by moment: of the sun's light, by angle and shadow
    std::array<std::uint8_t, 3> lamps{};  ///< as LampLight::before has them
};
constexpr float max_picture_light = 2;
vec3 light_on_picture(const PictureLight& light, const model::Daylight& of_moment);

/// A point of a surface, seen from before it. Colours are display values.
struct SurfacePoint {
    vec3 normal{0, 1, 0};               ///< in the world, unit
    float sees_sky = 1, sees_room = 1;  ///< shares, as Vertex::hidden has them
    model::SunSeen sun_seen = model::always_in_sun;
    vec3 by_lamps{0.0F};  ///< 0..1: square root of the lamps' light
    PictureLight picture{};
};

/// What modules with light change, in the order of application.
struct SurfaceLight {
    vec3 lit{1.0F}, by_sun{0.0F};
};

/// The light by these effects, as a factor of the surface's colour.
vec3 light_of(const SurfacePoint& point, model::EffectMask mask, const model::Daylight& light);

}  // namespace surefoot::effects
