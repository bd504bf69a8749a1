// The exact judge's classes: triangles of scenes made by hand, and parts at random against a comparison of every pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "rt/base/random.hpp"
#include "tests/ground/exact_scenes.hpp"
#include "tests/ground/exact_shapes.hpp"

namespace surefoot::exact {
namespace {

using importer::Index;
using importer::Primitive;
using importer::WalkRule;

/// 5 by 5 tiles of 20 cm.
Primitive tiles_apart(double crack_m) {
    Primitive tiles;
    for (int i = 0; i < 5; ++i)
        for (int j = 0; j < 5; ++j)
            add_quad(tiles, vec3(i * (0.2 + crack_m), 0, j * (0.2 + crack_m)), vec3(0.2F, 0, 0), vec3(0, 0, 0.2F));
    return tiles;
}

/// Two halves without a common corner.
Primitive halved_ball(double radius) {
    constexpr std::uint32_t rings = 40;
    Primitive ball;
    for (std::uint32_t i = 0; i <= rings; ++i) {
        for (std::uint32_t j = 0; j < rings; ++j) {
            const double down = std::numbers::pi * i / rings, around = 2 * std::numbers::pi * j / rings;
            ball.positions.emplace_back(
                radius * dvec3(std::sin(down) * std::cos(around), std::cos(down), std::sin(down) * std::sin(around)));
        }
    }
    for (std::uint32_t i = 0; i < rings; ++i) {
        if (i == rings / 2) continue;
        for (std::uint32_t j = 0; j < rings; ++j) {
            const std::uint32_t a = i * rings + j, b = i * rings + (j + 1) % rings;
            ball.indices.insert(ball.indices.end(), {a, b, a + rings, a + rings, b, b + rings});
        }
    }
    return ball;
}

/// Upright panels of 30 cm in a row, each turned further than the one before it.
Primitive turning_panels(Index material, double degrees) {
    Primitive panels;
    panels.material = material;
    vec3 at(0);
    for (int i = 0; i < 6; ++i) {
        const double angle = degrees * i * std::numbers::pi / 180;
        add_quad(panels, at, vec3(0.3 * std::cos(angle), 0, 0.3 * std::sin(angle)), vec3(0, 1.5F, 0), true);
        at = panels.positions[panels.positions.size() - 3];
    }
    return panels;
}

}  // namespace

TEST(ExactClasses, TilesAMillimetreApartBlockAndThoseFiveApartDoNot) {
    SceneMaker make;
    make.add({tiles_apart(0.001)});
    make.add({tiles_apart(0.005)});
    const Blocks blocks = blocking_triangles(make.scene);
    EXPECT_EQ(blocks[0], all(50, true));
    EXPECT_EQ(blocks[1], all(50, false));
}

TEST(ExactClasses, PartsBelow30CmInTheWorldDoNotBlock) {
    SceneMaker make;
    make.add({one_box(vec3(0), vec3(0.2F))});
    make.add_node(0, scaled(2, 1, 1));
    make.add_node(0, scaled(-1.6, 1, 1));
    make.add_node(0, scaled(1.4, 1.4, 1.4));
    const Blocks blocks = blocking_triangles(make.scene);
    EXPECT_EQ(blocks[0], all(12, false)) << "20 cm";
    EXPECT_EQ(blocks[1], all(12, true)) << "40 cm on one axis";
    EXPECT_EQ(blocks[2], all(12, true)) << "mirrored";
    EXPECT_EQ(blocks[3], all(12, false)) << "28 cm";
}

TEST(ExactClasses, TheAuthorsRuleIsStrongerThanTheSize) {
    SceneMaker make;
    make.add({one_box(vec3(0), vec3(0.2F))}, dmat4(1.0), WalkRule::block);
    make.add_node(0, scaled(9, 9, 9), WalkRule::pass);
    const Blocks blocks = blocking_triangles(make.scene);
    EXPECT_EQ(blocks[0], all(12, true));
    EXPECT_EQ(blocks[1], all(12, false));
    EXPECT_EQ(ExactGround(make.scene, blocks).triangles(), 12U);
}

TEST(ExactClasses, NodesWithoutTrianglesOrVolumeAreEmpty) {
    SceneMaker make;
    make.add({one_box(vec3(0), vec3(1))});
    make.add_node(0, scaled(2, 0, 1));
    make.add_node(0, scaled(2, std::numeric_limits<double>::quiet_NaN(), 1));
    make.add_node(importer::none, dmat4(1.0));
    make.add({});
    EXPECT_EQ(blocking_triangles(make.scene), (Blocks{all(12, true), {}, {}, {}, {}}));
}

TEST(ExactClasses, SmallPartsJoinOthersByCornersWithin2Mm) {
    SceneMaker make;
    Primitive parts = one_box(vec3(0), vec3(1));
    add_box(parts, vec3(1.0015F, 1, 1), vec3(0.1F));                // 12 to 23: a corner 1.5 mm from the cube's
    add_box(parts, vec3(1.103F, 1, 1), vec3(0.1F));                 // 24 to 35: 1.5 mm from that one
    add_box(parts, vec3(1.3F, 1, 1), vec3(0.1F));                   // 36 to 47: alone
    add_box(parts, vec3(1.0005F, 0.4F, 0.4F), vec3(0.1F));          // 48 to 59: 0.5 mm from a face, far from its corners
    add_quad(parts, vec3(0), vec3(-0.1F, 0, 0), vec3(0, 0.1F, 0));  // 60, 61: at the cube's corner
    parts.positions[parts.positions.size() - 4] = vec3(-0.0F, 0, -0.0F);
    make.add({parts});
    make.add_node(0, scaled(1, 2, 1));
    const Blocks blocks = blocking_triangles(make.scene);
    ASSERT_EQ(blocks[0].size(), 62U);
    ASSERT_EQ(blocks[1].size(), 62U);
    for (std::size_t t = 0; t < 62; ++t) {
        EXPECT_EQ(blocks[0][t], t < 36 || t >= 60) << t;
        EXPECT_EQ(blocks[1][t], t < 12 || t >= 60) << t << ": by the largest scale they are 3 mm apart";
    }
}

TEST(ExactClasses, PrimitivesOfAMeshHangTogetherAndNodesDoNot) {
    SceneMaker make;
    const Primitive left = one_quad(vec3(0), vec3(0.2F, 0, 0), vec3(0, 0, 0.2F));
    make.add({left, one_quad(vec3(0.2F, 0, 0), vec3(0.2F, 0, 0), vec3(0, 0, 0.2F))});
    make.add({left}, moved(5, 0, 0));
    make.add_node(1, moved(5.2, 0, 0));
    EXPECT_EQ(blocking_triangles(make.scene), (Blocks{all(4, true), all(2, false), all(2, false)}));
}

TEST(ExactClasses, PebblesOnABlockingFloorDoNotBlock) {
    SceneMaker make;
    Primitive pebbles;
    for (int i = 0; i < 50; ++i) add_box(pebbles, vec3(0.3 * i, 0, 0), vec3(0.08F, 0.05F, 0.08F));
    make.add({pebbles});
    make.add({one_quad(vec3(-5, 0, -5), vec3(25, 0, 0), vec3(0, 0, 10))});
    EXPECT_EQ(blocking_triangles(make.scene), (Blocks{all(600, false), all(2, true)}));
}

TEST(ExactClasses, BallsOfManyTrianglesGoByTheirSize) {
    SceneMaker make;
    make.add({halved_ball(0.075)});
    make.add_node(0, scaled(2.5, 2.5, 2.5));
    EXPECT_EQ(blocking_triangles(make.scene), (Blocks{all(3120, false), all(3120, true)}));
}

TEST(ExactClasses, FencesOnAFloorBlockAndHoveringOnesDoNot) {
    struct Fence {
        const char* what;
        dmat4 world;
        bool blocks;
        WalkRule walk = WalkRule::by_rule;
    };
    const auto leaning = [](double up, double aside) {
        dmat4 world(1.0);
        world[1] = dvec4(0, up, aside, 0);
        return world;
    };
    const std::vector<Fence> fences = {
        {"on the floor", dmat4(1.0), true},
        {"a metre above", moved(0, 1, 0), false},
        {"25 cm above", moved(0, 0.25, 5), true},
        {"35 cm above", moved(0, 0.35, 5), false},
        {"85 cm over the floor", moved(0, -0.15, 5), true},
        {"75 cm over the floor", moved(0, -0.25, 5), false},
        {"90 cm wide", scaled(0.45, 1, 1), false},
        {"1.1 m wide", scaled(0.55, 1, 1), true},
        {"where there is no floor", moved(50, 0, 0), false},
        {"a metre above, by the author", moved(0, 1, 0), true, WalkRule::block},
        {"on the floor, but not for the author", dmat4(1.0), false, WalkRule::pass},
        {"0.2 m beyond the floor's rim", moved(0, 0, 20.2), true},
        {"0.4 m beyond the floor's rim", moved(0, 0, 20.4), false},
        {"a quarter of the width at 19.9 m", moved(19.4, 0, 0), true},
        {"a quarter of the width at 20.1 m", moved(19.6, 0, 0), false},
        {"leaning by 29 degrees", leaning(1.2, 0.665), true},
        {"leaning by 31 degrees", leaning(1.2, 0.721), false},
    };
    SceneMaker make;
    Primitive fence;
    fence.material = make.add_barred_material();
    add_quad(fence, vec3(0), vec3(2, 0, 0), vec3(0, 1, 0), true);
    make.add({one_quad(vec3(-20, 0, -20), vec3(40, 0, 0), vec3(0, 0, 40))});
    make.add({fence}, moved(0, 99, 0));
    for (const Fence& row : fences) make.add_node(1, row.world, row.walk);
    const Blocks blocks = blocking_triangles(make.scene);
    for (std::size_t i = 0; i < fences.size(); ++i) EXPECT_EQ(blocks[i + 2], all(2, fences[i].blocks)) << fences[i].what;
}

TEST(ExactClasses, FencesStandOnSlopesOfUpTo45Degrees) {
    for (const double degrees : {44.0, 46.0}) {
        const double rise = std::tan(degrees * std::numbers::pi / 180);
        SceneMaker make;
        Primitive fence;
        fence.material = make.add_barred_material();
        add_quad(fence, vec3(0), vec3(2, 0, 0), vec3(0, 1, 0), true);
        make.add({fence});
        make.add({one_quad(vec3(-20, -20 * rise, -20), vec3(40, 0, 0), vec3(0, 40 * rise, 40))});
        EXPECT_EQ(blocking_triangles(make.scene), (Blocks{all(2, degrees < 45), all(2, true)})) << degrees;
    }
}

TEST(ExactClasses, OneTexelBelowTheCutoffMakesATriangleSheer) {
    SceneMaker make;
    const Index full = make.add_image(4, 4, [](std::uint32_t, std::uint32_t) { return 255; });
    const Index top = make.add_image(4, 4, [](std::uint32_t, std::uint32_t y) { return y == 0 ? 255 : 0; });
    const Index half = make.add_image(1, 1, [](std::uint32_t, std::uint32_t) { return 128; });
    const Index empty = make.add_image(0, 0, [](std::uint32_t, std::uint32_t) { return 0; });
    const auto expect_solid = [&](Index material, bool with_uvs, bool solid, const char* what) {
        Primitive hovering;  // blocks only if it is solid
        hovering.material = material;
        add_quad(hovering, vec3(0, 9, 0), vec3(2, 0, 0), vec3(0, 1, 0), with_uvs);
        const Index node = make.add({hovering});
        EXPECT_EQ(blocking_triangles(make.scene)[node], all(2, solid)) << what;
    };
    using enum model::AlphaMode;
    expect_solid(make.add_material(mask, 1, full), true, true, "full");
    expect_solid(make.add_material(mask, 0.4F, full), true, false, "a factor below the cutoff");
    expect_solid(make.add_material(mask, 0.6F, full), true, true, "a factor above the cutoff");
    expect_solid(make.add_material(mask, 1, half), true, true, "128 of 127.5");
    expect_solid(make.add_material(mask, 0.99F, half), true, false, "128 of 128.8");
    expect_solid(make.add_material(mask, 1, half, 0.6F), true, false, "a higher cutoff");
    expect_solid(make.add_material(mask, 1, empty), true, true, "an image without texels");
    expect_solid(make.add_material(mask, 1, top), false, true, "no uvs");
    expect_solid(make.add_material(mask, 1, top), true, false, "only the top row");
    expect_solid(make.add_material(mask, 1, importer::none), true, true, "no image");
    expect_solid(make.add_material(blend, 1, full), true, true, "blended, full");
    expect_solid(make.add_material(blend, 0.98F, full), true, false, "blended, 0.98");
    expect_solid(make.add_material(blend, 1, half), true, false, "blended, half");
    expect_solid(make.add_material(opaque, 0, half), true, true, "opaque");
}

TEST(ExactClasses, ImagesRepeatAndUvsThatAreNotFiniteAreSheer) {
    SceneMaker make;
    const Index top = make.add_image(4, 4, [](std::uint32_t, std::uint32_t y) { return y == 0 ? 255 : 0; });
    Primitive hovering;
    hovering.material = make.add_material(model::AlphaMode::mask, 1, top);
    add_quad(hovering, vec3(0, 9, 0), vec3(2, 0, 0), vec3(0, 1, 0), true);
    for (vec2& uv : hovering.uvs) uv = vec2(uv.x + 3.0F, 0.2F * uv.y + 7.0F);  // stays in the repeated top row
    make.add({hovering});
    for (vec2& uv : hovering.uvs) uv -= vec2(9.0F, 14.0F);
    make.add({hovering});
    hovering.uvs[3].x = std::numeric_limits<float>::quiet_NaN();  // of the second triangle
    make.add({hovering});
    EXPECT_EQ(blocking_triangles(make.scene), (Blocks{all(2, true), all(2, true), {true, false}}));
}

TEST(ExactClasses, SheerCardsAreOneSheetWhereTheyTurnByLessThanTenDegrees) {
    SceneMaker make;
    Primitive fan, two_sides;
    fan.material = two_sides.material = make.add_barred_material();
    for (int i = 0; i < 9; ++i) {
        const double angle = 20 * i * std::numbers::pi / 180;
        add_quad(fan, vec3(0), vec3(0.6 * std::cos(angle), 0, 0.6 * std::sin(angle)), vec3(0, 1.5F, 0), true);
    }
    add_quad(two_sides, vec3(0), vec3(0.6F, 0, 0), vec3(0, 1.5F, 0), true);
    add_quad(two_sides, vec3(0), vec3(-0.6F, 0, 0.01F), vec3(0, 1.5F, 0), true);
    make.add({one_quad(vec3(-5, 0, -5), vec3(10, 0, 0), vec3(0, 0, 10))});
    make.add({fan});
    make.add({two_sides});
    make.add({turning_panels(fan.material, 8)});
    make.add({turning_panels(fan.material, 12)});
    const Blocks blocks = blocking_triangles(make.scene);
    EXPECT_EQ(blocks[0], all(2, true)) << "the floor";
    EXPECT_EQ(blocks[1], all(18, false)) << "cards around one stem: sheets of 0.6 m";
    EXPECT_EQ(blocks[2], all(4, true)) << "on two sides of a stem: a sheet of 1.2 m";
    EXPECT_EQ(blocks[3], all(12, true)) << "panels turned by 8 degrees each";
    EXPECT_EQ(blocks[4], all(12, false)) << "panels turned by 12 degrees each";
}

namespace {

/// Triangles of a few cm, and some larger ones. Many have a corner at one of another triangle, or some mm from it.
Primitive strewn_triangles(Random& random, std::uint32_t count) {
    Primitive strewn;
    const auto any = [&] { return vec3(any_in(random, dvec3(-1), dvec3(1))); };
    const auto corner_of_any = [&] {
        return strewn.positions[random.below(static_cast<std::uint32_t>(strewn.positions.size()))];
    };
    for (std::uint32_t i = 0; i < count; ++i) {
        const bool at_another = i % 20 == 1, near_another = i % 3 != 0 && !at_another;
        vec3 at = at_another || near_another ? corner_of_any() : 1.5F * any();
        if (near_another) {
            const vec3 aside = glm::normalize(any());
            at += static_cast<float>(random.range(0.0001, 0.0029)) * aside;
        }
        const float size = i % 30 == 0 ? 0.4F : 0.1F;
        for (std::uint32_t k = 0; k < 3; ++k) {
            strewn.positions.push_back(k == 0 ? at : at + size * any());
            strewn.indices.push_back(3 * i + k);
        }
    }
    return strewn;
}

/// Parts by comparing every pair of triangles.
class PairedParts {
public:
    PairedParts(const Primitive& primitive, const dvec3& scale) : corners_(primitive.indices.size() / 3), scale_(scale) {
        for (std::size_t i = 0; i < primitive.indices.size(); ++i)
            corners_[i / 3][i % 3] = dvec3(primitive.positions[primitive.indices[i]]);
        for (std::size_t t = 0; t < corners_.size(); ++t) part_.push_back(t);
    }

    /// Of triangles that are at most `reach` apart, one of which is marked.
    void unite(double reach, const std::vector<bool>& marked) {
        for (std::size_t a = 0; a < corners_.size(); ++a)
            for (std::size_t b = 0; b < a; ++b)
                if (part_[a] != part_[b] && (marked[a] || marked[b]) && apart(a, b) <= reach)
                    std::replace(part_.begin(), part_.end(), std::size_t(part_[a]), std::size_t(part_[b]));
    }

    /// [triangle]
    [[nodiscard]] std::vector<bool> in_small_parts() const {
        std::vector<Box> boxes(corners_.size());
        for (std::size_t t = 0; t < corners_.size(); ++t) boxes[part_[t]].grow(box_of(corners_[t]));
        std::vector<bool> small(corners_.size());
        for (std::size_t t = 0; t < corners_.size(); ++t) {
            const dvec3 size = (boxes[part_[t]].max - boxes[part_[t]].min) * scale_;
            small[t] = std::max({size.x, size.y, size.z}) < 0.3;
        }
        return small;
    }

private:
    [[nodiscard]] double apart(std::size_t a, std::size_t b) const {
        double smallest = std::numeric_limits<double>::infinity();
        for (const dvec3& p : corners_[a])
            for (const dvec3& q : corners_[b]) smallest = std::min(smallest, glm::length(p - q));
        return smallest;
    }

    std::vector<Corners> corners_;
    dvec3 scale_;
    std::vector<std::size_t> part_;  ///< [triangle]
};

}  // namespace

TEST(ExactClasses, PartsAreThoseOfEveryPairCompared) {
    Random random(17);
    std::size_t blocking = 0, passing = 0, joined = 0;
    for (int round = 0; round < 9; ++round) {
        const dvec3 scale(round % 3 == 0 ? 1.0 : 0.5, 1.0, round % 3 == 2 ? 3.0 : 1.0);
        SceneMaker make;
        const Primitive strewn = strewn_triangles(random, 300);
        make.add({strewn}, scaled(scale.x, scale.y, scale.z));
        PairedParts parts(strewn, scale);
        parts.unite(0, all(300, true));
        const std::vector<bool> small_before = parts.in_small_parts();
        parts.unite(0.002 / std::max({scale.x, scale.y, scale.z}), small_before);
        const std::vector<bool> small = parts.in_small_parts();
        const Blocks blocks = blocking_triangles(make.scene);
        ASSERT_EQ(blocks[0].size(), 300U);
        for (std::size_t t = 0; t < 300; ++t) {
            EXPECT_EQ(blocks[0][t], !small[t]) << round << ", " << t;
            ++(small[t] ? passing : blocking);
            joined += small_before[t] && !small[t] ? 1 : 0;
        }
    }
    EXPECT_GT(blocking, 500U);
    EXPECT_GT(passing, 500U);
    EXPECT_GT(joined, 100U) << "triangles that block by the 2 mm alone";
}

}  // namespace surefoot::exact
