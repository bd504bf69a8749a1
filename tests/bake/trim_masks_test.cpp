// Triangles of masked materials are cut down to what shows: nothing of that is lost, little else is kept.
#include "render/bake/trim_masks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "render/bake/cards.hpp"
#include "render/bake/mesh_surface.hpp"
#include "rt/base/random.hpp"

namespace surefoot::bake {
namespace {

constexpr std::uint32_t side = 64;

/// A masked material whose texture is opaque where opaque(u, v), with two levels.
model::Model masked(const std::function<bool(double, double)>& opaque) {
    model::Model m;
    m.textures.push_back({side, side, 0, 0, false});
    for (std::uint32_t wide = side; wide >= side / 2; wide /= 2, ++m.textures[0].levels) {
        for (std::uint32_t y = 0; y < wide; ++y) {
            for (std::uint32_t x = 0; x < wide; ++x) {
                const bool shows = opaque((x + 0.5) / wide, (y + 0.5) / wide);
                for (int k = 0; k < 4; ++k) m.texels.push_back(k < 3 || shows ? std::byte{255} : std::byte{0});
            }
        }
    }
    model::Material material;
    material.texture = 0;
    material.alpha = model::AlphaMode::mask;
    material.effects = model::effect_texture | model::effect_alpha_mask;
    m.materials.push_back(material);
    return m;
}

/// A square of 1 m from (0, 0) whose uv run from (0, 0) to (repeats, repeats); mirrored: the other way along x.
Geometry card(float repeats = 1, bool mirrored = false) {
    Geometry g;
    for (int corner = 0; corner < 4; ++corner) {
        model::Vertex v{};
        v.position[0] = corner == 1 || corner == 2 ? 1.0F : 0.0F;
        v.position[1] = corner >= 2 ? 1.0F : 0.0F;
        v.normal[2] = 127;
        v.uv[0] = repeats * (mirrored ? 1 - v.position[0] : v.position[0]);
        v.uv[1] = repeats * v.position[1];
        for (std::size_t k = 0; k < 4; ++k) v.colour[k] = corner >= 2 ? 200 : 100;
        g.vertices.push_back(v);
        g.baked.push_back({});
    }
    g.parts.push_back({0, {0, 1, 2, 0, 2, 3}});
    return g;
}

/// How many triangles of the parts hold a place of the card, counting only what faces +z.
int covers(const Geometry& g, const std::vector<GeometryPart>& parts, const vec2& at) {
    int count = 0;
    for (const GeometryPart& part : parts) {
        for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
            const auto corner = [&](std::size_t k) { return vec2(position_of(g.vertices[part.indices[i + k]])); };
            const auto side_of = [&](const vec2& a, const vec2& b) {
                return (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
            };
            const vec2 a = corner(0), b = corner(1), c = corner(2);
            count += side_of(a, b) >= -1e-6F && side_of(b, c) >= -1e-6F && side_of(c, a) >= -1e-6F ? 1 : 0;
        }
    }
    return count;
}

double area(const Geometry& g, const std::vector<GeometryPart>& parts) {
    double sum = 0;
    for (const GeometryPart& part : parts) sum += area_of(g, part.indices);
    return sum;
}

bool oval(double u, double v) { return std::hypot(u - 0.3, v - 0.4) < 0.15; }
bool cross_of_twigs(double u, double v) { return std::abs(u - v) < 0.04 || std::abs(u + v - 1) < 0.04; }

std::vector<GeometryPart> cut(Geometry& g, const model::Model& m) { return trimmed(g, g.parts, MaskShapes(m, {true}), {}); }

TEST(TrimMasks, KeepsAllThatShowsAndLittleElse) {
    for (const auto& opaque : {oval, cross_of_twigs}) {
        const model::Model m = masked(opaque);
        for (const float repeats : {1.0F, 2.0F}) {
            for (const bool mirrored : {false, true}) {
                Geometry g = card(repeats, mirrored);
                const std::vector<GeometryPart> parts = cut(g, m);
                if (parts.empty() && opaque != oval && repeats == 2) continue;  // four crosses take too many triangles
                ASSERT_EQ(parts.size(), 1U);
                Random random(5);
                for (int i = 0; i < 4000; ++i) {
                    const vec2 at(static_cast<float>(random.unit()), static_cast<float>(random.unit()));
                    const double u = static_cast<double>(repeats * (mirrored ? 1 - at.x : at.x)),
                                 v = static_cast<double>(repeats * at.y);
                    const bool shows = opaque(u - std::floor(u), v - std::floor(v));
                    EXPECT_TRUE(!shows || covers(g, parts, at) > 0) << at.x << ' ' << at.y;
                }
                EXPECT_LT(area(g, parts), opaque == oval ? 0.22 : 0.6);
            }
        }
    }
}

TEST(TrimMasks, VerticesLieOnTheCardAndShowTheSame) {
    const model::Model m = masked(oval);
    Geometry g = card();
    const std::vector<GeometryPart> parts = cut(g, m);
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_GT(g.vertices.size(), 4U);
    EXPECT_EQ(g.baked.size(), g.vertices.size());
    for (const std::uint32_t index : parts[0].indices) {
        const model::Vertex& v = g.vertices[index];
        EXPECT_NEAR(v.uv[0], v.position[0], 1e-5);
        EXPECT_NEAR(v.uv[1], v.position[1], 1e-5);
        EXPECT_EQ(v.position[2], 0);
        EXPECT_EQ(v.normal[2], 127);
        EXPECT_NEAR(v.colour[0], 100 + 100 * v.position[1], 1);
    }
}

TEST(TrimMasks, TwoTrianglesOfACardAreCutAsOne) {
    const model::Model m = masked([](double u, double v) { return std::hypot(u - 0.5, v - 0.5) < 0.2; });
    Geometry g = card();
    const std::vector<GeometryPart> parts = cut(g, m);
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_LE(parts[0].indices.size() / 3, 10U);
    EXPECT_LT(area(g, parts), 0.2) << "the hull of a disc of 0.13";
}

TEST(TrimMasks, LeaveAloneWhatTheyCannotMakeCheaper) {
    const model::Model full = masked([](double, double) { return true; });
    Geometry g = card();
    EXPECT_TRUE(cut(g, full).empty()) << "all of it shows";
    EXPECT_EQ(g.vertices.size(), 4U);
    model::Model opaque = masked(oval);
    opaque.materials[0].alpha = model::AlphaMode::opaque;
    EXPECT_TRUE(cut(g, opaque).empty()) << "no mask";
    model::Model clamped = masked(oval);
    clamped.textures[0].clamp = true;
    EXPECT_TRUE(cut(g, clamped).empty());
    const model::Model m = masked(oval);
    for (const float repeats : {0.0F, std::nanf(""), 1e9F, INFINITY}) {
        Geometry odd = card(repeats);
        EXPECT_TRUE(cut(odd, m).empty()) << repeats;
        EXPECT_EQ(odd.vertices.size(), 4U);
    }
    const model::Model none = masked([](double, double) { return false; });
    EXPECT_TRUE(cut(g, none).empty()) << "a form without a triangle is none";
}

TEST(TrimMasks, ACoarserMipLevelShowsWhereTheFinestDoesNot) {
    model::Model m = masked(oval);
    const std::size_t second = std::size_t{4} * side * side;
    for (std::size_t i = second + 3; i < m.texels.size(); i += 4) m.texels[i] = std::byte{255};
    Geometry g = card();
    EXPECT_TRUE(cut(g, m).empty());
}

TEST(TrimMasks, LevelsKeepTheirOrder) {
    const model::Model m = masked(oval);
    for (const std::uint32_t hidden : {0U, 90U, 99U}) {  // of 100 cards, in a corner of the picture where nothing shows
        LodChain chain;
        for (std::uint32_t i = 0; i < 100; ++i) {
            Geometry one = card(i < hidden ? 0.1F : 1.0F);
            for (model::Vertex& v : one.vertices) v.position[2] = static_cast<float>(i);
            chain.full.vertices.insert(chain.full.vertices.end(), one.vertices.begin(), one.vertices.end());
            chain.full.baked.resize(chain.full.vertices.size());
        }
        for (const std::uint32_t cards : {8U, 13U, 40U, 100U}) {
            GeometryPart part;
            for (std::uint32_t i = 0; i < cards; ++i)
                for (const std::uint32_t corner : {0U, 1U, 2U, 0U, 2U, 3U})
                    part.indices.push_back(4 * (i * 100 / cards) + corner);
            chain.levels.push_back({{part}, 2 * cards, cards < 100 ? 1.0F / static_cast<float>(cards) : 0.0F});
        }
        trim_levels(chain, MaskShapes(m, {true}));
        for (std::size_t i = 1; i < chain.levels.size(); ++i) {
            EXPECT_LT(chain.levels[i].error_m, chain.levels[i - 1].error_m);
            EXPECT_TRUE(chain.levels[i].error_m == 0 || chain.levels[i].triangles > chain.levels[i - 1].triangles)
                << hidden << ' ' << i;
        }
        EXPECT_EQ(chain.levels.back().triangles, 200U);
    }
}

TEST(TrimMasks, WhatIsCutAwayCountsInTheError) {
    const model::Model m = masked(oval);
    for (const bool cluster : {false, true}) {  // which has no full detail of its own
        LodChain chain;
        chain.full = card();
        for (const float z : {0.01F, 0.02F}) {
            const Geometry more = card();
            const auto base = static_cast<std::uint32_t>(chain.full.vertices.size());
            chain.full.vertices.insert(chain.full.vertices.end(), more.vertices.begin(), more.vertices.end());
            for (std::size_t k = base; k < chain.full.vertices.size(); ++k) chain.full.vertices[k].position[2] = z;
            chain.full.baked.resize(chain.full.vertices.size());
            for (const std::uint32_t corner : {0U, 1U, 2U, 0U, 2U, 3U}) chain.full.parts[0].indices.push_back(base + corner);
        }
        const std::vector<GeometryPart> full = chain.full.parts;
        const std::vector<std::uint32_t> one(full[0].indices.begin(), full[0].indices.begin() + 6);
        const std::vector<std::uint32_t> half(one.begin(), one.begin() + 3);
        chain.levels.push_back({{{0, half}}, 1, 0.75F});
        chain.levels.push_back({{{0, one}}, 2, 0.02F});
        if (!cluster) chain.levels.push_back({full, 100, 0.0F});  // more than the cut level
        trim_levels(chain, MaskShapes(m, {true}));
        const Level& cut = chain.levels[1];
        ASSERT_GT(cut.triangles, 2U);
        const MeshSurface whole(chain.full.vertices, full), left(chain.full.vertices, cut.parts);
        const float off = measure::sampled_distance(whole.view(), measure::TriangleTree(left.view()), 10000, 1).largest;
        EXPECT_GT(off, 0.7F) << "a far corner of the card";
        EXPECT_GE(cut.error_m, off);
        EXPECT_LE(cut.error_m, 1.2F * off);
        EXPECT_GT(chain.levels[0].error_m, cut.error_m);
    }
}

TEST(TrimMasks, OfAHugePictureKeepAllThatShows) {
    model::Model m;
    m.textures.push_back({2048, 8, 1, 0, false});
    m.texels.assign(std::size_t{4} * 2048 * 8, std::byte{0});
    m.texels[4 * (3 * 2048 + 1000) + 3] = std::byte{255};  // one texel shows
    model::Material material;
    material.texture = 0;
    material.alpha = model::AlphaMode::mask;
    m.materials.push_back(material);
    Geometry g = card();
    const std::vector<GeometryPart> parts = cut(g, m);
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_GE(covers(g, parts, {1000.5F / 2048, 3.5F / 8}), 1);
    EXPECT_LT(area(g, parts), 0.02);
}

TEST(TrimMasks, TrianglesThatFoldOverAreNoCard) {
    const model::Model m = masked(oval);
    Geometry g = card();
    g.vertices[3] = g.vertices[0];  // the second triangle lies upon the first, seen from behind
    g.vertices[3].position[0] = g.vertices[3].uv[0] = 0.6F;
    g.vertices[3].position[1] = g.vertices[3].uv[1] = 0.2F;
    const auto before = area(g, g.parts);
    const std::vector<GeometryPart> parts = cut(g, m);
    EXPECT_TRUE(parts.empty() || area(g, parts) < before);
    for (const GeometryPart& part : parts)
        for (const std::uint32_t index : part.indices) EXPECT_TRUE(std::isfinite(g.vertices[index].position[0]));
}

TEST(TrimMasks, FullDetailGetsACheaperTwinThatShowsTheSame) {
    const model::Model m = masked(oval);
    LodChain chain;
    chain.full = card();
    chain.levels.push_back({chain.full.parts, 2, 0.0F});
    trim_levels(chain, MaskShapes(m, {true}));
    ASSERT_EQ(chain.levels.size(), 2U);
    EXPECT_EQ(chain.levels[0].error_m, model::trimmed_error_m);
    EXPECT_GT(chain.levels[0].triangles, 2U);
    EXPECT_EQ(chain.levels[1].triangles, 2U);
    EXPECT_EQ(chain.levels[1].parts[0].indices.size(), 6U) << "full detail stays";
}

}  // namespace
}  // namespace surefoot::bake
