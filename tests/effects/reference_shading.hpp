// The reference for pictures: every effect by its definition, at a vertex and at a pixel. Slow, in double.
// It shares no code with render/, which it checks: of the model it only reads the data.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "render/model/model.hpp"
#include "render/model/view.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::reference {

/// The light of a moment. A colour of 1 is white.
struct Light {
    dvec3 towards_sun{0, 1, 0};
    dvec3 sun{0.56, 0.53, 0.47}, ground{0.34, 0.32, 0.30}, sky{0.52, 0.56, 0.62};
    std::uint32_t moment = 0;                               ///< it is between this share of the sun and the next
    double between = 0;                                     ///< 0: at this one, 1: at the next
    double lamps = 0;                                       ///< light of a lamp's full byte
    double rooms = 1;                                       ///< of the light of a room that sees no sky
    double fog_density = 0;                                 ///< at a distance of 1 / density, half is left
    dvec3 background{1.0};                                  ///< multiplies the sky, which is the fog's colour too
    dvec3 pictures{1.0};                                    ///< multiplies what was captured by the light of the bake
    bool sun_on_pictures = true, lamps_on_pictures = true;  ///< of lit pictures; without the sun they have a light of 1
    double time_s = 0;                                      ///< since waves began
};

/// As it is where nobody sets another: lamps are off. At the visibility, one part in twenty comes through the fog.
inline Light own_light(const model::Model& model) {
    Light light;
    light.towards_sun = model.sun_direction;
    if (model.light.fog_visibility_m > 0) light.fog_density = std::log2(20.0) / model.light.fog_visibility_m;
    return light;
}

/// A model, where it is seen from, in which light, and what shows where it is not.
struct View {
    const model::Model& model;
    Pose pose;
    model::Viewport viewport;
    dvec3 sky{0.0};
    Light light{};
    [[nodiscard]] dvec3 behind() const { return sky * light.background; }  ///< the colour behind everything
};

/// What the light of a surface goes by, for both of its sides.
struct Surface {
    dvec3 normal{0.0};                           ///< world, of the side before it; unit at vertices
    dvec4 hidden{0.0};                           ///< shares: sky before and behind it, room before and behind it
    double sun = 0;                              ///< share of the sun that shines on it
    dvec3 lamps_before{0.0}, lamps_behind{0.0};  ///< roots of the light of all lamps
    double picture_sun = 0;                      ///< of a lit picture: half of the sun's light on it
    dvec3 picture_lamps{0.0};                    ///< the root of that of lamps
};

/// What a corner of a triangle hands to its pixels. All of it varies evenly in space, not on the picture.
struct Corner {
    dvec3 from_eye{0.0};  ///< from the eye to it, along the axes of the world; metres
    dvec4 colour{0.0};
    dvec2 uv{0.0};
    Surface surface{};  ///< where pixels are lit one by one
};

/// A point of a surface from the side that is lit: its normal there, and what is seen from that side.
struct LitSide {
    dvec3 normal{0.0};         ///< unit, world
    double sky = 1, room = 1;  ///< shares that are not hidden
    double sun = 1;            ///< share of the sun that shines on it
    dvec3 lamps{0.0};          ///< light of all lamps
    dvec3 picture{1.0};        ///< all light on a lit picture
};

/// A pixel of a triangle, before its colour is known.
struct Fragment {
    Corner at;            ///< at the pixel's centre
    dvec2 uv_right{0.0};  ///< by how much uv changes from this pixel to the next one to the right
    dvec2 uv_below{0.0};  ///< the same for the next one below
};

inline bool has(const model::Material& material, model::Effect effect) { return (material.effects & effect) != 0; }

/// The light that multiplies a colour, of a vertex or a pixel. Each effect of light changes what the effects before it leave.
inline dvec3 light_at_vertex(const View& view, const model::Material& material, const LitSide& side) {
    const dvec3& n = side.normal;
    dvec3 light(1.0);
    if (has(material, model::effect_sun)) {  // a hemisphere from ground to sky, and one sun
        const Light& of = view.light;
        const double up = 0.5 + 0.5 * n.y;
        const double facing = std::max(0.0, glm::dot(n, of.towards_sun) / glm::length(of.towards_sun));
        const double share = has(material, model::effect_shadow) ? side.sun : 1.0;
        light *= (1.0 - up) * of.ground + up * of.sky + share * facing * of.sun;
    }
    if (has(material, model::effect_openness)) {  // a quarter of the sky is enough for all of the light outside
        const dvec3 of_room = dvec3(0.98, 0.95, 0.91) + dvec3(0.06 * n.x + 0.12 * n.y - 0.04 * n.z);
        const double outside = std::min(1.0, 4.0 * side.sky);
        light = (1.0 - outside) * view.light.rooms * of_room + outside * light;
        light *= 0.6 + 0.4 * side.room;
    }
    if (has(material, model::effect_lamps)) light += side.lamps;  // they are near: neither sky nor corners change them
    if (has(material, model::effect_lit_picture)) light *= side.picture;
    return light;
}

/// The share of the sun that a vertex sees now: on the line between those of two moments.
inline double sun_at_vertex(const View& view, std::uint32_t vertex) {
    const std::uint8_t* const shares = &view.model.sun_seen[vertex].share[view.light.moment];
    return (shares[0] + view.light.between * (shares[1] - shares[0])) / 255.0;
}

/// Of one side of a vertex. The model has the root of the light, so that little light has fine steps.
inline dvec3 root_of_lamps(const View& view, std::uint32_t vertex, bool behind) {
    const model::LampLight& stored = view.model.lamp_light[vertex];
    const std::uint8_t* const root = behind ? stored.behind : stored.before;
    return dvec3(root[0], root[1], root[2]) / 255.0;
}

/// The light of lamps on one side of a vertex.
inline dvec3 lamps_at_vertex(const View& view, std::uint32_t vertex, bool behind) {
    const dvec3 root = root_of_lamps(view, vertex, behind);
    return view.light.lamps * root * root;
}

inline Surface surface_at(const View& view, const model::Material& material, const dmat3& linear, std::uint32_t vertex) {
    const model::Vertex& v = view.model.vertices[vertex];
    const dvec3 stored = glm::max(dvec3(v.normal[0], v.normal[1], v.normal[2]) / 127.0, dvec3(-1.0));
    Surface surface;
    surface.normal = glm::normalize(glm::transpose(glm::inverse(linear)) * stored);
    surface.hidden = dvec4(v.hidden[0], v.hidden[1], v.hidden[2], v.hidden[3]) / 255.0;
    surface.sun = has(material, model::effect_shadow) ? sun_at_vertex(view, vertex) : 1.0;
    if (has(material, model::effect_lit_picture)) {
        surface.picture_sun = sun_at_vertex(view, vertex);
        surface.picture_lamps = root_of_lamps(view, vertex, false);
    }
    if (!has(material, model::effect_lamps)) return surface;
    surface.lamps_before = root_of_lamps(view, vertex, false);
    surface.lamps_behind = root_of_lamps(view, vertex, true);
    return surface;
}

/// By how much a point faces away from the eye: -1 straight to it, 1 straight away.
inline double facing_away(const Surface& surface, const dvec3& from_eye) {
    return glm::dot(glm::normalize(surface.normal), glm::normalize(from_eye));
}

/// Of a picture: twice the sum of what the sun, the sky, the ground and rooms give by its shares, and lamps.
inline dvec3 light_on_picture(const Light& of, const Surface& surface) {
    const dvec3 sun = of.sun_on_pictures ? surface.picture_sun * of.sun : dvec3(0);
    const dvec3 sky = of.sun_on_pictures ? of.sky : dvec3(1), ground = of.sun_on_pictures ? of.ground : dvec3(1);
    const double night =
        std::clamp((0.56 - of.sky.g) / (0.56 - 0.12), 0.0, 1.0);  // rooms count less then: one sees windows alone
    const dvec3 rooms = (1 - 0.75 * night) * of.rooms * dvec3(0.98, 0.95, 0.91);
    const dvec3 lamps = (of.lamps_on_pictures ? 0.7 * of.lamps : 0) * surface.picture_lamps * surface.picture_lamps;
    return 2.0 * (sun + surface.hidden.x * sky + surface.hidden.y * ground + surface.hidden.z * rooms) + lamps;
}

/// The lit side of a vertex, or of a point between vertices. A two-sided surface is lit on the side that the eye sees.
inline LitSide lit_side(const View& view, const model::Material& material, const Surface& surface, const dvec3& from_eye) {
    LitSide side;
    const bool behind = material.two_sided && facing_away(surface, from_eye) > 0;
    side.normal = (behind ? -1.0 : 1.0) * glm::normalize(surface.normal);
    side.sky = 1.0 - (behind ? surface.hidden.y : surface.hidden.x);
    side.room = 1.0 - (behind ? surface.hidden.w : surface.hidden.z);
    side.sun = surface.sun;
    const dvec3& root = behind ? surface.lamps_behind : surface.lamps_before;
    side.lamps = view.light.lamps * root * root;
    if (has(material, model::effect_lit_picture)) side.picture = light_on_picture(view.light, surface);
    return side;
}

/// A material's colour. That of a captured picture goes with the light, in steps of a byte.
inline dvec4 material_colour(const View& view, const model::Material& material, bool captured) {
    dvec4 colour(material.colour[0], material.colour[1], material.colour[2], material.colour[3]);
    for (int i = 0; i < 3 && captured; ++i) {
        const double byte = std::round(255.0 * colour[i]) * view.light.pictures[i];
        colour[i] = std::min(255.0, std::round(byte)) / 255.0;
    }
    return colour;
}

inline Corner corner_at(const View& view, const model::Material& material, const model::Placement& placement,
                        std::uint32_t vertex, bool captured) {
    const model::Vertex& v = view.model.vertices[vertex];
    const dmat3 linear(placement.linear);
    Corner corner;
    corner.from_eye = placement.origin - view.pose.position + linear * dvec3(v.position[0], v.position[1], v.position[2]);
    corner.uv = dvec2(v.uv[0], v.uv[1]);
    corner.colour = material_colour(view, material, captured);
    if (has(material, model::effect_vertex_colour))
        corner.colour *= dvec4(v.colour[0], v.colour[1], v.colour[2], v.colour[3]) / 255.0;
    corner.surface = surface_at(view, material, linear, vertex);
    if (has(material, model::effect_light_by_pixel)) return corner;
    const dvec3 light = light_at_vertex(view, material, lit_side(view, material, corner.surface, corner.from_eye));
    corner.colour *= dvec4(light, 1.0);
    return corner;
}

/// A texel, 0..1. Texels beyond the border repeat, or are those of the border.
inline dvec4 texel(const model::Model& model, const model::Texture& texture, std::uint32_t level, double column, double row) {
    std::uint64_t byte = texture.first_byte;
    std::uint32_t width = texture.width, height = texture.height;
    for (std::uint32_t i = 0; i < level; ++i) {
        byte += 4ULL * width * height;
        width = std::max(1U, width / 2);
        height = std::max(1U, height / 2);
    }
    const auto inside = [&](double at, double count) {
        return static_cast<std::uint64_t>(texture.clamp ? std::clamp(at, 0.0, count - 1) : at - count * std::floor(at / count));
    };
    byte += 4 * (inside(row, height) * width + inside(column, width));
    dvec4 colour;
    for (std::size_t i = 0; i < 4; ++i) colour[static_cast<int>(i)] = std::to_integer<int>(model.texels[byte + i]) / 255.0;
    return colour;
}

/// The mip level for a pixel: the one whose texels are nearest to the pixel's size, by factors of two.
inline std::uint32_t mip_level(const model::Texture& texture, const Fragment& fragment) {
    const dvec2 size(texture.width, texture.height);
    const double texels = std::max(glm::length(size * fragment.uv_right), glm::length(size * fragment.uv_below));
    if (!(texels > 1)) return 0;
    const double level = std::ceil(std::log2(texels) + 0.5) - 1, last = std::max(1U, texture.levels) - 1;
    return static_cast<std::uint32_t>(std::clamp(level, 0.0, last));
}

/// The four texels around uv, each by its nearness in columns and rows.
inline dvec4 bilinear(const model::Model& model, const model::Texture& texture, std::uint32_t level, const dvec2& uv) {
    const double column = uv.x * std::max(1U, texture.width >> level) - 0.5;
    const double row = uv.y * std::max(1U, texture.height >> level) - 0.5;
    const double left = std::floor(column), top = std::floor(row);
    const auto between = [&](double at_row) {
        const double right = column - left;
        return (1.0 - right) * texel(model, texture, level, left, at_row) +
               right * texel(model, texture, level, left + 1, at_row);
    };
    return (1.0 - (row - top)) * between(top) + (row - top) * between(top + 1);
}

/// How much brighter three waves make water. Each goes its way as waves of its length do in deep water, and fades where a pixel
/// is a good part of it. How far a pixel reaches over the water goes by its distance and by how steeply one looks down.
inline double brightness_of_water(const View& view, const dvec3& from_eye) {
    struct Wave {
        dvec2 per_m;  ///< radians, eastwards and southwards
        double strength;
    };
    constexpr std::array<Wave, 3> waves{{{{0.79, 0.34}, 0.07}, {{-0.62, 1.06}, 0.07}, {{2.95, -1.5}, 0.06}}};
    const double pixel_rad = 2.0 * std::tan(0.5 * view.pose.fov_y_rad) / view.viewport.height;
    const double far = glm::length(from_eye), sine = std::max(std::abs(from_eye.y), 1e-3) / far;
    const dvec3 place = view.pose.position + from_eye;
    std::array<double, 3> phase{};
    for (std::size_t i = 0; i < waves.size(); ++i)
        phase[i] =
            glm::dot(waves[i].per_m, dvec2(place.x, place.z)) - std::sqrt(9.81 * glm::length(waves[i].per_m)) * view.light.time_s;
    // They bend each other.
    const std::array<double, 3> curved{phase[0] + 0.9 * std::sin(phase[1]), phase[1] + 0.9 * std::sin(phase[0]),
                                       phase[2] + std::sin(phase[0])};
    double brightness = 1;
    for (std::size_t i = 0; i < waves.size(); ++i) {
        const double k = glm::length(waves[i].per_m), shown = std::clamp(1.6 - k * pixel_rad * far / sine, 0.0, 1.0);
        brightness += shown * waves[i].strength * std::cos(curved[i]);
    }
    return brightness;
}

/// What a triangle does to a pixel.
struct Shade {
    dvec4 colour{0.0};           ///< 0..1; the fourth number is the opacity
    bool is_hole = false;        ///< nothing is drawn
    bool is_close_call = false;  ///< whether there is a hole, or which side is lit, hangs by rounding
};

/// The colour at a pixel. Each effect of pixels changes what the effects before it leave.
inline Shade colour_at_pixel(const View& view, const model::Material& material, const Fragment& fragment) {
    Shade shade{fragment.at.colour};
    if (has(material, model::effect_light_by_pixel)) {
        const Surface& surface = fragment.at.surface;
        const LitSide side = lit_side(view, material, surface, fragment.at.from_eye);
        shade.colour *= dvec4(light_at_vertex(view, material, side), 1.0);
        shade.is_close_call = material.two_sided && std::abs(facing_away(surface, fragment.at.from_eye)) < 1e-3;
    }
    if (has(material, model::effect_texture)) {
        const model::Texture& texture = view.model.textures[material.texture];
        shade.colour *= bilinear(view.model, texture, mip_level(texture, fragment), fragment.at.uv);
    }
    if (has(material, model::effect_alpha_mask)) {
        shade.is_hole = shade.colour.a < material.alpha_cutoff;
        shade.is_close_call |= std::abs(shade.colour.a - material.alpha_cutoff) < 2.0 / 255.0;
    }
    if (!has(material, model::effect_blend)) shade.colour.a = 1;
    if (has(material, model::effect_water))
        shade.colour = dvec4(brightness_of_water(view, fragment.at.from_eye) * dvec3(shade.colour), shade.colour.a);
    if (has(material, model::effect_fog)) {  // it takes a pixel's colour, and leaves how much of it shows
        const double depth_m = glm::dot(fragment.at.from_eye, view.pose.forward());
        const double left = std::pow(2.0, -view.light.fog_density * depth_m);
        shade.colour = dvec4(left * dvec3(shade.colour) + (1.0 - left) * view.behind(), shade.colour.a);
    }
    shade.colour = glm::clamp(shade.colour, 0.0, 1.0);
    return shade;
}

}  // namespace surefoot::reference
