// A small scene that gives every effect something to do: for comparing pictures.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/gl/small_models.hpp"

namespace surefoot::test {

/// Triangles of one object. Colours and hidden shares differ from vertex to vertex, so that none may be mistaken for another.
struct Shape {
    std::vector<model::Vertex> vertices;
    std::vector<std::uint32_t> indices;

    /// Corners counter-clockwise; the texture repeats `repeat` times. `bulge` turns the normals outwards, as on a round body.
    void quad(const std::array<vec3, 4>& corners, float repeat = 1, float bulge = 0) {
        const auto first = static_cast<std::uint32_t>(vertices.size());
        const vec3 face = glm::normalize(glm::cross(corners[1] - corners[0], corners[3] - corners[0]));
        const vec3 middle = 0.25F * (corners[0] + corners[1] + corners[2] + corners[3]);
        for (std::size_t c = 0; c < 4; ++c) {
            const auto number = static_cast<unsigned>(vertices.size());
            const vec3 normal = glm::normalize(face + bulge * (corners[c] - middle));
            model::Vertex v{};
            for (int i = 0; i < 3; ++i) {
                const auto at = static_cast<std::size_t>(i);
                v.position[at] = corners[c][i];
                v.normal[at] = static_cast<std::int8_t>(std::lround(127 * normal[i]));
                v.colour[at] = static_cast<std::uint8_t>(95 + (number * 67 + static_cast<unsigned>(i) * 41) % 160);
            }
            v.colour[3] = static_cast<std::uint8_t>(110 + number * 53 % 145);
            v.uv[0] = c == 1 || c == 2 ? repeat : 0;
            v.uv[1] = c >= 2 ? 0 : repeat;
            for (unsigned i = 0; i < 4; ++i) v.hidden[i] = static_cast<std::uint8_t>((number * 83 + i * 59) % 256);
            vertices.push_back(v);
        }
        for (const std::uint32_t i : {0, 1, 2, 0, 2, 3}) indices.push_back(first + i);
    }
};

/// A square of half size `half` in the plane z = 0.
inline Shape sheet(float half, float repeat) {
    Shape shape;
    shape.quad({vec3(-half, -half, 0), vec3(half, -half, 0), vec3(half, half, 0), vec3(-half, half, 0)}, repeat, 0.4F);
    return shape;
}

/// A cube from -1 to 1.
inline Shape cube() {
    Shape shape;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0F, 1.0F}) {
            vec3 out(0), across(0), up(0);
            out[axis] = side;
            across[(axis + 1) % 3] = 1;
            up[(axis + 2) % 3] = side;
            shape.quad({out - across - up, out + across - up, out + across + up, out - across + up}, 1, 0.3F);
        }
    }
    return shape;
}

/// The scene: where its objects stand, and what each material has when it has its own effects.
struct EffectScene {
    static constexpr std::uint32_t objects = 10;
    const dvec3 site{4000, 20, -7000};  ///< far from 0: positions must be taken from the eye in double

    /// The i-th object's own effects.
    static model::EffectMask own_effects(model::Index i) {
        using namespace model;
        constexpr EffectMask lit = effect_sun | effect_openness;
        constexpr std::array<EffectMask, objects> own{
            effect_texture | lit | effect_shadow | effect_fog | effect_water,
            effect_vertex_colour | lit | effect_fog | effect_light_by_pixel,
            effect_texture | effect_vertex_colour | effect_sun | effect_shadow | effect_lit_picture,
            lit | effect_lamps,
            effect_texture | lit | effect_shadow | effect_lamps | effect_fog | effect_light_by_pixel,
            effect_texture | effect_alpha_mask | lit | effect_lamps,
            effect_blend | effect_fog,
            effect_texture | effect_blend | effect_sun | effect_shadow,
            effect_vertex_colour | lit | effect_shadow | effect_lamps | effect_light_by_pixel,
            effect_texture,
        };
        return own[i];
    }

    /// The scene with materials whose effects are `effects_of(object)`.
    template <class EffectsOf>
    model::Model build(EffectsOf effects_of) {
        SmallModel scene;
        add_textures(scene);
        Index next = 0;
        const auto add = [&](const Shape& shape, model::Material material, dvec3 where, const mat3& linear) {
            material.effects = effects_of(next++);
            scene.object(shape.vertices, shape.indices, scene.material(material),
                         at(site.x + where.x, site.y + where.y, site.z + where.z, linear));
        };
        add_walls(add);
        add_bodies(add);
        add_sheets(add);
        scene.model().reps.back().kind = model::RepKind::textured_box;  // its picture holds the light of the bake
        add_light(scene.model());
        return scene.finish();
    }

    /// From the entrance, from the side, and from so near behind the green sheet that the near plane cuts it.
    [[nodiscard]] std::vector<Pose> poses() const {
        const dvec3 along(std::cos(0.8), 0, -std::sin(0.8)), behind(-std::sin(0.8), 0, -std::cos(0.8));
        const dvec3 near_sheet = dvec3(-1.6, 1.9, -3) - 0.6 * along + 0.02 * behind;
        return {looking({0.1, 1.6, 1.3}, {0, 1.4, -5}), looking({3.1, 2.5, -0.8}, {-1.2, 0.9, -4.6}),
                looking(near_sheet, near_sheet + along - dvec3(0, 0.15, 0))};
    }

private:
    enum : Index { checker, leaf, tinted, with_levels };

    [[nodiscard]] Pose looking(const dvec3& from, const dvec3& to) const {
        const dvec3 back = glm::normalize(from - to), right = glm::normalize(glm::cross(dvec3(0, 1, 0), back));
        Pose pose;
        pose.position = site + from;
        pose.orientation = glm::normalize(glm::quat_cast(dmat3(right, glm::cross(back, right), back)));
        pose.fov_y_rad = 1.25;
        return pose;
    }
    /// Shares and lamps differ from vertex to vertex, from moment to moment and from side to side.
    static void add_light(model::Model& model) {
        model.light.fog_visibility_m = 25;
        for (unsigned v = 0; v < model.vertices.size(); ++v) {
            model::SunSeen sun{};
            for (unsigned i = 0; i < 16; ++i) sun.share[i] = static_cast<std::uint8_t>((v * 101 + i * 83) % 256);
            model::LampLight lamps{};
            for (unsigned i = 0; i < 3; ++i) {
                lamps.before[i] = static_cast<std::uint8_t>((v * 71 + i * 47) % 200);
                lamps.behind[i] = static_cast<std::uint8_t>((v * 43 + i * 89 + 120) % 200);
            }
            model.sun_seen.push_back(sun);
            model.lamp_light.push_back(lamps);
        }
    }
    static mat3 turned(float angle_rad, const vec3& axis) {
        return mat3(glm::mat3_cast(glm::angleAxis(angle_rad, glm::normalize(axis))));
    }
    static model::Material coloured(std::array<float, 4> colour, Index texture, bool two_sided = false, float cutoff = 0.5F) {
        model::Material material;
        material.colour = colour;
        material.texture = texture;
        material.two_sided = two_sided;
        material.alpha_cutoff = cutoff;
        return material;
    }
    static void add_textures(SmallModel& scene) {
        add_checker(scene.model(), 4, 1, {235, 225, 200, 255}, {70, 90, 120, 255});
        add_checker(scene.model(), 4, 1, {120, 210, 80, 255}, {60, 130, 50, 40});
        add_checker(scene.model(), 2, 1, {250, 240, 160, 230}, {160, 200, 250, 130});
        add_checker(scene.model(), 32, 6, {240, 120, 60, 255}, {40, 60, 200, 200});
        scene.model().textures[tinted].clamp = true;
    }
    /// Four fields a side. Each level fades towards grey, so that levels can be told apart.
    static void add_checker(model::Model& model, std::uint32_t side, std::uint32_t levels, std::array<int, 4> a,
                            std::array<int, 4> b) {
        model::Texture texture;
        texture.width = texture.height = side;
        texture.levels = levels;
        texture.first_byte = model.texels.size();
        for (std::uint32_t level = 0; level < levels; ++level, side /= 2) {
            for (std::uint32_t i = 0; i < side * side; ++i) {
                const std::uint32_t column = 4 * (i % side) / side, row = 4 * (i / side) / side;
                for (const int byte : (column + row) % 2 == 0 ? a : b)
                    model.texels.push_back(static_cast<std::byte>(128 + (byte - 128) / static_cast<int>(1 + level)));
            }
        }
        model.textures.push_back(texture);
    }
    template <class Add>
    static void add_walls(Add add) {
        Shape floor, back, left;
        floor.quad({vec3(-4, 0, 3), vec3(4, 0, 3), vec3(4, 0, -7), vec3(-4, 0, -7)}, 2, 0.05F);
        add(floor, coloured({0.9F, 0.85F, 0.8F, 1}, checker), {0, 0, 0}, mat3(1));
        back.quad({vec3(-4, 0, 0), vec3(4, 0, 0), vec3(4, 4, 0), vec3(-4, 4, 0)}, 1.5F, 0.1F);
        add(back, coloured({0.8F, 0.9F, 0.95F, 1}, checker), {0, 0, -7}, mat3(1));
        left.quad({vec3(0, 0, 3), vec3(0, 0, -7), vec3(0, 3, -7), vec3(0, 3, 3)}, 1, 0.1F);
        add(left, coloured({1, 0.8F, 0.6F, 0.7F}, leaf), {-4, 0, 0}, mat3(1));
    }
    template <class Add>
    static void add_bodies(Add add) {
        const auto scaled = [](float x, float y, float z) { return mat3(vec3(x, 0, 0), vec3(0, y, 0), vec3(0, 0, z)); };
        const mat3 wide = turned(0.5F, {0.1F, 1, 0}) * scaled(0.8F, 0.6F, 0.4F);
        const mat3 mirrored = turned(-0.7F, {0, 1, 0.2F}) * scaled(-0.5F, 0.9F, 0.6F);
        add(cube(), coloured({0.7F, 0.6F, 0.9F, 0.8F}, leaf), {-1.8, 0.8, -4.7}, wide);
        add(cube(), coloured({0.9F, 0.7F, 0.5F, 1}, checker), {1.9, 1.1, -5.2}, mirrored);
    }
    template <class Add>
    static void add_sheets(Add add) {
        add(sheet(1, 0.75F), coloured({1, 1, 1, 0.9F}, leaf, true), {0.1, 1.3, -4}, turned(0.4F, {0.2F, 1, 0}));
        add(sheet(0.7F, 1), coloured({0.9F, 0.3F, 0.2F, 0.4F}, tinted, true), {0.8, 1.3, -2.6}, turned(0.1F, {0, 1, 0}));
        add(sheet(0.8F, 1), coloured({0.2F, 0.5F, 0.9F, 0.6F}, tinted, true, 0.3F), {1.3, 1.5, -3.3},
            turned(-0.2F, {0.3F, 1, 0}));
        add(sheet(0.8F, 0.5F), coloured({0.6F, 0.9F, 0.5F, 0.9F}, checker, true, 0.7F), {-1.6, 1.9, -3}, turned(0.8F, {0, 1, 0}));
        add(sheet(1.1F, 1), coloured({1, 1, 1, 1}, with_levels), {-0.3, 3.1, -6}, mat3(1));
    }
};

}  // namespace surefoot::test
