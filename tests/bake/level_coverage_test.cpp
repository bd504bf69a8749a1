// Levels cover about as much as full detail: what covers too little grows, and what cannot goes.
#include "render/bake/level_coverage.hpp"

#include <gtest/gtest.h>

#include "render/bake/mesh_surface.hpp"
#include "render/bake/objects.hpp"
#include "render/bake/picture_loss.hpp"
#include "render/measure/mesh_distance.hpp"
#include "tests/bake/scenes.hpp"

namespace surefoot::bake {
namespace {

void add_square(Geometry& g, const vec3& at, const vec3& along, const vec3& up, std::size_t part) {
    const auto base = static_cast<std::uint32_t>(g.vertices.size());
    for (const vec2 c : {vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)}) {
        model::Vertex v{};
        for (int k = 0; k < 3; ++k) v.position[k] = at[k] + c.x * along[k] + c.y * up[k];
        v.normal[1] = 127;
        v.colour[1] = 120;
        v.colour[3] = 255;
        g.vertices.push_back(v);
        g.baked.push_back({v.colour[0], v.colour[1], v.colour[2], v.colour[3]});
    }
    for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) g.parts[part].indices.push_back(base + i);
}

vec3 in_ball(Random& random) {
    vec3 at(2);
    while (glm::dot(at, at) > 1) at = vec3(any_in(random, dvec3(-1), dvec3(1)));
    return at;
}

/// `count` squares of 2 * half_m in a ball of 2 m; every third is of the second material.
Geometry bush(int count, float half_m) {
    Geometry g;
    g.parts = {{0, {}}, {1, {}}};
    Random random(3);
    for (int i = 0; i < count; ++i) {
        const vec3 at = in_ball(random), along = glm::normalize(in_ball(random) + vec3(0.01F, 0, 0));
        const vec3 up = glm::normalize(glm::cross(along, in_ball(random)));
        add_square(g, at, half_m * along, half_m * up, i % 3 == 0 ? 1 : 0);
    }
    return g;
}

model::Model plain_looks() {
    model::Model m;
    m.materials.resize(3);
    for (model::Material& material : m.materials) {
        material.effects = model::effect_vertex_colour;
        material.two_sided = true;
    }
    return m;
}

/// Samples of a level to those of full detail, in the directions by which losses are measured.
double covered_share(const LodChain& chain, const Level& level) {
    const model::Model looks = plain_looks();
    PictureDifference difference;
    for (const auto& [azimuth_rad, elevation_rad] : loss_directions) {
        FormPicture full, form;
        Box box;
        for (const GeometryPart& part : chain.levels.back().parts)
            for (const std::uint32_t i : part.indices) box.grow(dvec3(position_of(chain.full.vertices[i])));
        full.clear(view_of(box, direction_of(azimuth_rad, elevation_rad), dvec3(0.0), 64));
        form.clear(full.view);
        draw_geometry(looks, chain.full.vertices, chain.levels.back().parts, full);
        draw_geometry(looks, chain.full.vertices, level.parts, form);
        difference.add(full, form);
    }
    return static_cast<double>(difference.form()) / static_cast<double>(difference.full_detail);
}

/// Full detail of 60 squares, and a level with the first `count` of its first part.
LodChain with_level(std::size_t count) {
    LodChain chain;
    chain.full = bush(60, 0.12F);
    Level few{{{0, {}}}, static_cast<std::uint32_t>(2 * count), 0.2F};
    const auto& all = chain.full.parts[0].indices;
    few.parts[0].indices.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(6 * count));
    chain.levels = {few, {chain.full.parts, static_cast<std::uint32_t>(chain.full.triangles()), 0}};
    return chain;
}

/// The same full detail, and a level with all squares of its first part, of six tenths of their length.
LodChain with_small_squares() {
    LodChain chain = with_level(40);
    Geometry& g = chain.full;
    std::vector<std::uint32_t>& indices = chain.levels[0].parts[0].indices;
    for (std::size_t first = 0; first < indices.size(); first += 6) {
        const std::uint32_t from = indices[first], to = static_cast<std::uint32_t>(g.vertices.size());
        const vec3 middle = 0.5F * (position_of(g.vertices[from]) + position_of(g.vertices[from + 2]));
        for (std::uint32_t corner = from; corner < from + 4; ++corner) {
            model::Vertex v = g.vertices[corner];
            for (int k = 0; k < 3; ++k) v.position[k] = middle[k] + 0.6F * (v.position[k] - middle[k]);
            g.vertices.push_back(v);
            g.baked.push_back({v.colour[0], v.colour[1], v.colour[2], v.colour[3]});
        }
        for (std::size_t i = first; i < first + 6; ++i) indices[i] += to - from;
    }
    return chain;
}

TEST(LevelCoverage, WhatCoversTooLittleGrowsWithinTheBoxAndItsErrorWithIt) {
    const model::Model looks = plain_looks();
    ChainOptions options;
    options.looks = &looks;
    LodChain chain = with_small_squares();
    ASSERT_LT(covered_share(chain, chain.levels[0]), 0.45);
    const Box box = bush(60, 0.12F).box();
    const auto length = [&] {
        const auto& at = chain.levels[0].parts[0].indices;
        return glm::length(position_of(chain.full.vertices[at[1]]) - position_of(chain.full.vertices[at[0]]));
    };
    const float before = length();
    EXPECT_TRUE(take_poor_levels(chain, options).empty());
    ASSERT_EQ(chain.levels.size(), 2U);
    EXPECT_EQ(chain.levels[0].triangles, 80U);
    EXPECT_GT(covered_share(chain, chain.levels[0]), min_covered);
    EXPECT_LT(covered_share(chain, chain.levels[0]), 1);
    EXPECT_GT(length(), 1.2F * before);
    for (const std::uint32_t i : chain.levels[0].parts[0].indices) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_GE(chain.full.vertices[i].position[k], box.min[k] - 1e-6);
            EXPECT_LE(chain.full.vertices[i].position[k], box.max[k] + 1e-6);
        }
    }
    EXPECT_GE(chain.levels[0].error_m, 0.2F);
}

TEST(LevelCoverage, TheErrorOfWhatGrewIsMeasuredAgain) {
    const model::Model looks = plain_looks();
    ChainOptions options;
    options.looks = &looks;
    LodChain chain = with_small_squares();
    chain.levels[0].error_m = 0.001F;
    EXPECT_TRUE(take_poor_levels(chain, options).empty());
    ASSERT_EQ(chain.levels.size(), 2U);
    const MeshSurface full(chain.full.vertices, chain.levels[1].parts), grown(chain.full.vertices, chain.levels[0].parts);
    const float lower = measure::two_sided_distance(full.view(), grown.view(), {}).lower;
    EXPECT_GT(lower, 0.01F) << "a third of the squares is missing";
    EXPECT_GE(chain.levels[0].error_m, lower);
}

TEST(LevelCoverage, WhatCannotGrowEnoughGoesUnlessNothingElseIsLeft) {
    const model::Model looks = plain_looks();
    ChainOptions options;
    options.looks = &looks;
    LodChain chain = with_level(2);
    std::vector<Level> poor = take_poor_levels(chain, options);
    ASSERT_EQ(poor.size(), 1U);
    ASSERT_EQ(chain.levels.size(), 1U);
    put_back_poor_level(chain, std::move(poor));
    ASSERT_EQ(chain.levels.size(), 2U);
    EXPECT_EQ(chain.levels[0].triangles, 4U);
    chain = with_small_squares();
    chain.levels.insert(chain.levels.begin(), with_level(2).levels[0]);
    chain.levels[0].error_m = 0.5F;
    poor = take_poor_levels(chain, options);
    EXPECT_EQ(poor.size(), 1U);
    put_back_poor_level(chain, std::move(poor));
    ASSERT_EQ(chain.levels.size(), 2U);
    EXPECT_EQ(chain.levels[0].triangles, 80U);
}

TEST(LevelCoverage, LevelsOfPiecesCoverWhatTheirPiecesDo) {
    const model::Model looks = plain_looks();
    ChainOptions options;
    options.looks = &looks;
    options.proxy_material = 2;
    options.pictures.resize(3, Picture::none);
    options.cut_out = {true, false, false};
    CutLimits limits;
    limits.longest_m = 1.2;
    limits.min_triangles = 64;
    const std::vector<MeshForm> forms = make_forms(bush(200, 0.1F), limits, options);
    ASSERT_GT(forms.size(), 1U);
    std::size_t levels = 0;
    for (const MeshForm& form : forms) {
        for (std::size_t i = 0; i + 1 < form.chain.levels.size(); ++i, ++levels) {
            const double share = covered_share(form.chain, form.chain.levels[i]);
            EXPECT_GE(share, min_covered) << form.chain.levels[i].triangles;
            EXPECT_LE(share, max_covered) << form.chain.levels[i].triangles;
        }
    }
    EXPECT_GE(levels, forms.size());
}

TEST(LevelCoverage, LevelsThatCoverEnoughStayAsTheyAre) {
    const model::Model looks = plain_looks();
    ChainOptions options;
    options.looks = &looks;
    LodChain chain = with_level(38);
    const std::vector<std::uint32_t> before = chain.levels[0].parts[0].indices;
    const std::size_t vertices = chain.full.vertices.size();
    EXPECT_TRUE(take_poor_levels(chain, options).empty());
    EXPECT_EQ(chain.levels[0].parts[0].indices, before);
    EXPECT_EQ(chain.full.vertices.size(), vertices);
    EXPECT_EQ(chain.levels[0].error_m, 0.2F);
}

}  // namespace
}  // namespace surefoot::bake
