// Leaves on coarse levels: fewer cards, larger, each with its picture; the same ones wherever they are fewer still.
#include "render/bake/cards.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "render/measure/mesh_distance.hpp"
#include "rt/base/random.hpp"

namespace surefoot::bake {
namespace {

/// A crown of cards of two triangles each about the origin, and a trunk of one material of its own.
Geometry crown(std::uint32_t cards) {
    Geometry g;
    GeometryPart leaves{0, {}}, trunk{1, {}};
    Random random(5);
    const auto add = [&](const vec3& at, const vec2& uv) {
        model::Vertex v{};
        for (int k = 0; k < 3; ++k) v.position[k] = at[k];
        v.normal[2] = 127;
        v.uv[0] = uv.x;
        v.uv[1] = uv.y;
        g.vertices.push_back(v);
        g.baked.push_back({20, 90, 30, 255});
        return static_cast<std::uint32_t>(g.vertices.size() - 1);
    };
    const auto add_square = [&](GeometryPart& part, const vec3& at, float size) {
        const std::uint32_t a = add(at, {0, 0}), b = add(at + vec3(size, 0, 0), {1, 0}),
                            c = add(at + vec3(size, size, 0), {1, 1});
        const std::uint32_t d = add(at + vec3(0, size, 0), {0, 1}), c2 = add(at + vec3(size, size, 0), {1, 1});
        for (const std::uint32_t i : {a, b, c, a, c2, d}) part.indices.push_back(i);  // together by place, not by vertex
    };
    for (std::uint32_t i = 0; i < cards; ++i) {
        const auto x = static_cast<float>(random.range(-2, 2)), y = static_cast<float>(random.range(2, 6));
        const auto z = static_cast<float>(random.range(-2, 2));
        add_square(leaves, {x, y, z}, 0.5F);
    }
    add_square(trunk, {0, 0, 0}, 2);
    g.parts = {leaves, trunk};
    return g;
}

TEST(Cards, AreWhatHangsTogetherByPlace) {
    const Geometry g = crown(50);
    const auto cards = cards_of(g, g.parts[0]);
    ASSERT_EQ(cards.size(), 50U);
    for (const auto& card : cards) EXPECT_EQ(card.size(), 6U);
    EXPECT_EQ(cards_of(g, g.parts[1]).size(), 1U);
    EXPECT_TRUE(cards_of(g, {0, {}}).empty());
}

TEST(Cards, OfASmallerShareAreAmongThoseOfALargerOne) {
    const Geometry g = crown(50);
    const auto cards = cards_of(g, g.parts[0]);
    std::vector<std::uint32_t> before = some_cards(cards, 1);
    EXPECT_EQ(before.size(), 300U);
    for (const double share : {0.5, 0.2, 0.05, 0.0}) {
        const std::vector<std::uint32_t> fewer = some_cards(cards, share);
        EXPECT_EQ(fewer.size(), std::max(6U, static_cast<unsigned>(share * 50 + 1e-9) * 6));
        EXPECT_TRUE(std::equal(fewer.begin(), fewer.end(), before.begin()));
        before = fewer;
    }
}

TEST(Cards, GrowAboutTheirMiddlesToTheAreaThatWasThereAndNoFurther) {
    for (const double share : {0.5, 0.1}) {
        Geometry g = crown(50);
        const double whole = area_of(g, g.parts[0].indices);
        GeometryPart part{0, some_cards(cards_of(g, g.parts[0]), share)};
        const double kept = area_of(g, part.indices);
        const std::vector<std::uint32_t> before = part.indices;
        enlarge_cards(g, part, whole);
        EXPECT_NEAR(area_of(g, part.indices), std::min(whole, 1.6 * 1.6 * kept), 1e-3 * whole);
        std::set<std::uint32_t> own(before.begin(), before.end());
        for (const std::uint32_t i : part.indices) EXPECT_FALSE(own.contains(i)) << "the full detail stays as it is";
        // Each about its own middle: none is farther from a kept one than it grew.
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            double nearest = 1e9;
            for (const std::uint32_t b : before)
                nearest = std::min(nearest, static_cast<double>(glm::length(position_of(g.vertices[b]) -
                                                                            position_of(g.vertices[part.indices[i]]))));
            EXPECT_LT(nearest, 0.5 * 0.6 * 0.75);
        }
    }
}

TEST(Cards, StayCutOutOnEveryLevelAndTheRestIsColoured) {
    ChainOptions options;
    options.proxy_material = 2;
    options.pictures = {Picture::clamped, Picture::clamped, Picture::none};
    options.cut_out = {true, false, false};
    const LodChain chain = make_chain(crown(200), options);
    ASSERT_GE(chain.levels.size(), 3U);
    for (const Level& level : chain.levels) {
        std::size_t cards = 0;
        for (const GeometryPart& part : level.parts) {
            if (part.material == 0) cards += part.indices.size() / 6;
        }
        EXPECT_GE(cards, 1U) << level.triangles << " triangles without a leaf";
        EXPECT_GE(2 * cards + 4, level.triangles) << "leaves of another material: solid";
    }
    EXPECT_LE(chain.levels.front().triangles, 48U);
    EXPECT_EQ(chain.levels.back().error_m, 0);
}

struct Surface {
    std::vector<vec3> points;
    std::vector<std::uint32_t> indices;
    Surface(const Geometry& g, const std::vector<GeometryPart>& parts) {
        for (const model::Vertex& v : g.vertices) points.push_back(position_of(v));
        for (const GeometryPart& part : parts) indices.insert(indices.end(), part.indices.begin(), part.indices.end());
    }
    [[nodiscard]] measure::MeshView view() const { return {points, indices}; }
};

TEST(Cards, ThatAreLeftOutOrGrewLieWithinTheLevelsError) {
    ChainOptions options;
    options.proxy_material = 2;
    options.pictures = {Picture::clamped, Picture::clamped, Picture::none};
    options.cut_out = {true, false, false};
    const LodChain chain = make_chain(crown(200), options);
    const Surface full(chain.full, chain.levels.back().parts);
    for (std::size_t l = 0; l + 1 < chain.levels.size(); ++l) {
        EXPECT_GT(chain.levels[l].error_m, chain.levels[l + 1].error_m);
        const Surface coarse(chain.full, chain.levels[l].parts);
        for (const measure::DistanceBounds& found :
             {measure::directed_distance(full.view(), measure::TriangleTree(coarse.view()), {}),
              measure::directed_distance(coarse.view(), measure::TriangleTree(full.view()), {})}) {
            EXPECT_LE(found.lower, chain.levels[l].error_m * 1.0001F);
            EXPECT_GT(found.lower, 0.01F) << "or the test shows nothing";
        }
    }
}

TEST(Cards, OneLargeThingAmongCrumbsIsSimplifiedAsAnyOther) {
    Geometry g = crown(8);
    GeometryPart& part = g.parts[0];
    constexpr std::uint32_t n = 20;  // a hedge's wall, a hundred times a card
    const auto base = static_cast<std::uint32_t>(g.vertices.size());
    for (std::uint32_t y = 0; y <= n; ++y) {
        for (std::uint32_t x = 0; x <= n; ++x) {
            model::Vertex v{};
            v.position[0] = 10 + 0.2F * static_cast<float>(x);
            v.position[1] = 0.2F * static_cast<float>(y);
            v.position[2] = 0.3F * std::sin(0.5F * static_cast<float>(x));
            v.normal[2] = 127;
            g.vertices.push_back(v);
            g.baked.push_back({20, 90, 30, 255});
            if (x == n || y == n) continue;
            const std::uint32_t a = base + y * (n + 1) + x, b = a + n + 1;
            for (const std::uint32_t i : {a, a + 1, b, a + 1, b + 1, b}) part.indices.push_back(i);
        }
    }
    ChainOptions options;
    options.proxy_material = 2;
    options.pictures = {Picture::none, Picture::none, Picture::none};
    options.cut_out = {true, false, false};
    const LodChain thinned = make_chain(g, options);
    options.cut_out = {};
    const LodChain plain = make_chain(g, options);
    ASSERT_EQ(thinned.levels.size(), plain.levels.size());
    for (std::size_t l = 0; l < plain.levels.size(); ++l) EXPECT_EQ(thinned.levels[l].error_m, plain.levels[l].error_m);
    EXPECT_GE(plain.levels.size(), 4U);
}

}  // namespace
}  // namespace surefoot::bake
