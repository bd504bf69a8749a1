// Parts whose shown sides see no sky: from which eyes they need no sun.
#include "render/model/room_sides.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace surefoot::model {
namespace {

/// Parts of squares, each with a normal, a middle, and what its two sides have of the sky.
struct Squares {
    Model model;

    explicit Squares(bool two_sided = true, EffectMask effects = effect_sun | effect_openness) {
        Material material;
        material.two_sided = two_sided;
        material.effects = effects;
        model.materials.push_back(material);
    }
    /// Starts a part.
    Squares& part() {
        model.parts.push_back(
            {0, static_cast<std::uint32_t>(model.indices.size()), 0, static_cast<std::uint32_t>(model.vertices.size()), 0});
        return *this;
    }
    Squares& square(const vec3& normal, const vec3& middle, bool front_closed, bool back_closed) {
        const vec3 other = std::abs(normal.y) < 0.9F ? vec3(0, 1, 0) : vec3(1, 0, 0);
        const vec3 u = glm::normalize(glm::cross(other, normal)), v = glm::cross(normal, u);
        Part& last = model.parts.back();
        const std::uint32_t base = last.vertex_count;
        for (const auto& [s, t] : {std::pair{-1.0F, -1.0F}, {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}}) {
            const vec3 at = middle + s * u + t * v;
            Vertex vertex{};
            for (int k = 0; k < 3; ++k) {
                vertex.position[k] = at[k];
                vertex.normal[k] = static_cast<std::int8_t>(std::lround(127 * normal[k]));
            }
            vertex.hidden[0] = front_closed ? 255 : 254;
            vertex.hidden[1] = back_closed ? 255 : 0;
            model.vertices.push_back(vertex);
        }
        for (const std::uint32_t i : {0, 1, 2, 0, 2, 3}) model.indices.push_back(base + i);
        last.vertex_count += 4;
        last.index_count += 6;
        return *this;
    }
    [[nodiscard]] RoomSides sides() const { return RoomSides(model); }
};

TEST(RoomSides, ASheetWithARoomBeforeItNeedsNoSunThere) {
    const RoomSides sides = Squares().part().square(vec3(0, 1, 0), vec3(5, 3, 5), true, false).sides();
    ASSERT_TRUE(sides.any(0));
    EXPECT_FALSE(sides.all(0));
    EXPECT_TRUE(sides.shows_no_sky(0, vec3(0, 3.1F, 0))) << "from above, also beside it";
    EXPECT_FALSE(sides.shows_no_sky(0, vec3(0, 2.9F, 0)));
    EXPECT_FALSE(sides.shows_no_sky(0, vec3(5, 3, 5))) << "in its plane, rounding says which side shows";
    EXPECT_FALSE(sides.shows_no_sky(0, vec3(0, std::numeric_limits<float>::quiet_NaN(), 0)));
}

TEST(RoomSides, ASheetWithARoomBehindItNeedsNoSunFromBehind) {
    const RoomSides sides = Squares().part().square(vec3(0, 1, 0), vec3(0, 3, 0), false, true).sides();
    EXPECT_FALSE(sides.shows_no_sky(0, vec3(0, 3.1F, 0)));
    EXPECT_TRUE(sides.shows_no_sky(0, vec3(0, 2.9F, 0)));
}

TEST(RoomSides, OfARoomInOnePieceTheEyeIsWithin) {
    Squares room;
    room.part();
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.0F, 1.0F}) {
            vec3 normal(0);
            normal[axis] = sign;
            room.square(normal, -normal, true, false);
        }
    const RoomSides sides = room.sides();
    EXPECT_TRUE(sides.shows_no_sky(0, vec3(0.5F, -0.9F, 0.9F)));
    for (const vec3& eye : {vec3(1.1F, 0, 0), vec3(0, -1.1F, 0), vec3(0, 0, 1.1F)}) EXPECT_FALSE(sides.shows_no_sky(0, eye));
}

TEST(RoomSides, OfSeveralSheetsAllMustShowTheirClosedSides) {
    const RoomSides sides = Squares()
                                .part()
                                .square(vec3(0, 1, 0), vec3(0, 3, 0), true, false)
                                .square(vec3(0, 1, 0), vec3(9, 4, 0), true, false)
                                .square(vec3(1, 0, 0), vec3(0, 0, 0), true, true)
                                .part()
                                .square(vec3(1, 0, 0), vec3(0, 0, 0), true, true)
                                .part()
                                .square(vec3(0, 1, 0), vec3(0, 3, 0), true, false)
                                .square(vec3(0, 1, 0), vec3(9, 3, 0), false, false)
                                .sides();
    EXPECT_FALSE(sides.shows_no_sky(0, vec3(0, 3.5F, 0))) << "below the second";
    EXPECT_TRUE(sides.shows_no_sky(0, vec3(-7, 4.5F, 0))) << "the third has no side in the open";
    EXPECT_TRUE(sides.all(1));
    EXPECT_TRUE(sides.shows_no_sky(1, vec3(0)));
    EXPECT_FALSE(sides.any(2)) << "one sees sky on both sides";
}

TEST(RoomSides, OneSidedPartsShowTheirFront) {
    Squares squares(false);
    squares.part().square(vec3(0, 1, 0), vec3(0), true, false).part().square(vec3(0, 1, 0), vec3(0), false, true);
    const RoomSides sides = squares.sides();
    EXPECT_TRUE(sides.all(0));
    EXPECT_FALSE(sides.any(1));
}

TEST(RoomSides, WhatOneSidedPartsTurnAwayFromTheEyeNeedsNoSun) {
    // The bottom of a cabinet sees the sky below a building, its back the room.
    const RoomSides cabinet = Squares(false)
                                  .part()
                                  .square(vec3(0, -1, 0), vec3(0), false, true)
                                  .square(vec3(1, 0, 0), vec3(1, 1, 0), true, true)
                                  .sides();
    ASSERT_TRUE(cabinet.any(0));
    EXPECT_FALSE(cabinet.all(0));
    EXPECT_TRUE(cabinet.shows_no_sky(0, vec3(3, 0.1F, 0))) << "from above its plane";
    EXPECT_FALSE(cabinet.shows_no_sky(0, vec3(3, 0, 0))) << "in its plane, rounding says whether it is drawn";
    EXPECT_FALSE(cabinet.shows_no_sky(0, vec3(3, -0.1F, 0)));
    Squares turned(false);
    turned.part().square(vec3(0, -1, 0), vec3(0), false, true).square(vec3(1, 0, 0), vec3(0), true, true);
    for (std::size_t v = 0; v < 4; ++v) turned.model.vertices[v].normal[1] = 127;
    EXPECT_TRUE(turned.sides().shows_no_sky(0, vec3(3, 0.1F, 0))) << "triangles tell what is drawn, not normals";
    EXPECT_FALSE(turned.sides().shows_no_sky(0, vec3(3, -0.1F, 0)));
}

/// In mirrored places the device takes the other winding for the front. Seen from an eye, that is the same side.
TEST(RoomSides, MirroredPlacesTurnTheSameTrianglesAway) {
    Squares squares(false);
    squares.part().square(vec3(0, -1, 0), vec3(0), false, true).square(vec3(1, 0, 0), vec3(0), true, true);
    const RoomSides sides = squares.sides();
    int drawn = 0, turned_away = 0;
    for (const bool mirrored : {false, true}) {
        const mat3 linear(vec3(0, 0, mirrored ? -2 : 2), vec3(0, 1.5F, 0), vec3(-3, 0, 0));
        ASSERT_EQ(glm::determinant(linear) < 0, mirrored);
        const dvec3 origin(7, 8, 9);
        std::array<dvec3, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vertex& v = squares.model.vertices[squares.model.indices[k]];
            corner[k] = origin + dmat3(linear) * dvec3(v.position[0], v.position[1], v.position[2]);
        }
        const dvec3 normal = (mirrored ? -1.0 : 1.0) * glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
        for (int i = 0; i < 400; ++i) {
            const dvec3 eye = origin + dvec3(i % 7 - 3, i % 11 - 5.5, i % 13 - 6);
            const bool is_drawn = glm::dot(normal, eye - corner[0]) > 0;
            EXPECT_EQ(sides.shows_no_sky(0, eye_in_frame(origin, linear, eye)), !is_drawn) << mirrored << " " << i;
            ++(is_drawn ? drawn : turned_away);
        }
    }
    EXPECT_GT(std::min(drawn, turned_away), 200);
}

TEST(RoomSides, RoundThingsAndOtherLightKeepTheSun) {
    Squares round;
    round.part();
    for (int i = 0; i < 9; ++i) {
        const float angle = 0.1F * static_cast<float>(i);
        round.square(vec3(std::cos(angle), 0, std::sin(angle)), vec3(0), true, false);
    }
    EXPECT_FALSE(round.sides().any(0)) << "too many directions";
    constexpr EffectMask sun = effect_sun | effect_openness;
    for (const EffectMask effects :
         {EffectMask{effect_sun}, EffectMask{effect_openness}, sun | effect_light_by_pixel, sun | effect_lit_picture})
        EXPECT_FALSE(Squares(true, effects).part().square(vec3(0, 1, 0), vec3(0), true, true).sides().any(0)) << effects;
}

TEST(RoomSides, AnEyeComesIntoTheFrameOfWhatIsPlaced) {
    const mat3 linear(vec3(0, 0, -2), vec3(0, -2, 0), vec3(3, 0, 0));
    const dvec3 origin(7, 8, 9), at(0.5, -1, 2);
    const vec3 back = eye_in_frame(origin, linear, origin + dmat3(linear) * at);
    EXPECT_LT(glm::length(dvec3(back) - at), 1e-6);
}

}  // namespace
}  // namespace surefoot::model
