// Meshes of clusters cover about as much as what is below them: else they are scaled, and what cannot be goes.
#include "render/bake/cluster_coverage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "render/bake/bake.hpp"
#include "render/bake/level_coverage.hpp"
#include "render/bake/mesh_surface.hpp"
#include "render/bake/picture_loss.hpp"
#include "render/measure/mesh_distance.hpp"
#include "tests/bake/scenes.hpp"

namespace surefoot::bake {
namespace {

/// `count` upright squares of 2 * half_m in a row, 1 m apart.
Level add_squares(Geometry& g, int count, float half_m, float error_m) {
    const int middle = count / 2;
    Level level{{{0, {}}}, static_cast<std::uint32_t>(2 * count), error_m};
    for (int i = 0; i < count; ++i) {
        const auto base = static_cast<std::uint32_t>(g.vertices.size());
        for (const vec2 c : {vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)}) {
            model::Vertex v{};
            v.position[0] = static_cast<float>(i - middle) + half_m * c.x;
            v.position[1] = half_m * c.y;
            v.position[2] = i % 2 == 0 ? -1.0F : 1.0F;
            v.normal[2] = 127;
            g.vertices.push_back(v);
            g.baked.push_back({100, 100, 100, 255});
        }
        for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) level.parts[0].indices.push_back(base + k);
    }
    return level;
}

model::Model row_looks() {
    model::Model m;
    m.materials.resize(1);
    m.materials[0].two_sided = true;
    return m;
}

std::uint64_t samples_of_level(const Geometry& g, const Level& level, const ClusterCover& cover,
                               std::vector<bool>* outlines = nullptr) {
    std::uint64_t sum = 0;
    FormPicture picture;
    for (const FormView& view : cover.views) {
        picture.clear(view);
        draw_geometry(*cover.looks, g.vertices, level.parts, picture);
        for (const FormSample& sample : picture.samples) {
            sum += sample.covered() ? 1 : 0;
            if (outlines != nullptr) outlines->push_back(sample.covered());
        }
    }
    return sum;
}

/// A cluster of eleven squares of 0.8 m, whose levels have squares of these halves.
struct SquareRow {
    model::Model looks = row_looks();
    Geometry full;
    Level whole;
    LodChain chain;
    ClusterCover cover;

    explicit SquareRow(const std::vector<float>& halves_m, float whole_half_m = 0.4F)
        : whole(add_squares(full, 11, whole_half_m, 0)) {
        for (const float half_m : halves_m)
            chain.levels.push_back(add_squares(chain.full, 11, half_m, 3.0F - static_cast<float>(chain.levels.size())));
        cover.box = full.box();
        for (const auto& [azimuth_rad, elevation_rad] : std::span(loss_directions).first<outline_directions>())
            cover.views.push_back(view_of(cover.box, direction_of(azimuth_rad, elevation_rad), dvec3(0), outline_px));
        cover.looks = &looks;
        cover.full = samples_of_level(full, whole, cover, &cover.outlines);
        for (const Level& level : chain.levels) cover.levels.push_back(samples_of_level(chain.full, level, cover));
    }
    [[nodiscard]] double share(std::size_t level) const {
        return static_cast<double>(samples_of_level(chain.full, chain.levels[level], cover)) / static_cast<double>(cover.full);
    }
};

TEST(ClusterCoverage, WhatCoversTooLittleGrowsAndItsErrorHolds) {
    SquareRow row({0.2F, 0.35F});
    ASSERT_LT(row.share(0), min_covered);
    const Geometry before = row.chain.full;
    const Level small = row.chain.levels[0];
    ASSERT_TRUE(mend_cluster(row.chain, row.cover));
    ASSERT_EQ(row.chain.levels.size(), 2U);
    EXPECT_GE(row.share(0), min_covered);
    EXPECT_LE(row.share(0), 1.1);
    EXPECT_EQ(row.chain.levels[0].triangles, 22U);
    EXPECT_EQ(row.chain.full.vertices.size(), before.vertices.size()) << "no level uses the vertices from before";
    measure::DistanceLimits limits;
    const MeshSurface old_surface(before.vertices, small.parts), surface(row.chain.full.vertices, row.chain.levels[0].parts);
    const float way_m = measure::two_sided_distance(old_surface.view(), surface.view(), limits).lower;
    EXPECT_GT(way_m, 0.05F);
    EXPECT_GE(row.chain.levels[0].error_m, small.error_m + way_m);
    EXPECT_LE(row.chain.levels[0].error_m, small.error_m + 0.4F);
}

TEST(ClusterCoverage, WhatCannotCoverEnoughGoesUnlessNothingElseIsLeft) {
    SquareRow row({0.05F, 0.35F});
    ASSERT_TRUE(mend_cluster(row.chain, row.cover));
    ASSERT_EQ(row.chain.levels.size(), 1U);
    EXPECT_GE(row.share(0), min_covered);
    SquareRow alone({0.02F, 0.05F});
    ASSERT_TRUE(mend_cluster(alone.chain, alone.cover));
    ASSERT_EQ(alone.chain.levels.size(), 1U);
    EXPECT_EQ(alone.chain.levels[0].error_m, 2.0F) << "the one that covers more";
    alone.cover.levels.erase(alone.cover.levels.begin());
    EXPECT_FALSE(mend_cluster(alone.chain, alone.cover));
}

TEST(ClusterCoverage, WhatCoversTooMuchShrinks) {
    SquareRow row({0.48F, 0.2F}, 0.22F);
    row.cover.box.grow(dvec3(-6, -0.5, -1));
    row.cover.box.grow(dvec3(6, 0.5, 1));
    ASSERT_GT(row.share(0), max_covered);
    const Level large = row.chain.levels[0];
    ASSERT_TRUE(mend_cluster(row.chain, row.cover));
    ASSERT_EQ(row.chain.levels.size(), 2U);
    EXPECT_LE(row.share(0), max_covered);
    EXPECT_GE(row.share(0), 1.0);
    EXPECT_GT(row.chain.levels[0].error_m, large.error_m + 0.05F);
}

TEST(ClusterCoverage, ErrorsAtMostDoubleBesideTheWayOfWhatMovesBelow) {
    const auto row_of = [](float error_m, double displacement_m) {
        SquareRow row({0.2F, 0.35F});
        row.chain.levels[0].error_m = error_m + static_cast<float>(displacement_m);
        row.chain.levels[1].error_m = 0.01F + static_cast<float>(displacement_m);
        row.cover.displacement_m = displacement_m;
        EXPECT_TRUE(mend_cluster(row.chain, row.cover));
        return row.chain.levels.size();
    };
    EXPECT_EQ(row_of(1, 0), 2U);
    EXPECT_EQ(row_of(0.05F, 0), 1U) << "corners go farther than the level may be off";
    EXPECT_EQ(row_of(1, 40), 2U);
    EXPECT_EQ(row_of(0.05F, 40), 1U) << "though what is below moves by 40 m";
}

TEST(ClusterCoverage, NothingGrowsBeyondTheBox) {
    SquareRow row({0.2F, 0.35F});
    row.cover.box.max.y = 0.2;
    row.cover.box.min.y = -0.2;
    ASSERT_TRUE(mend_cluster(row.chain, row.cover));
    ASSERT_EQ(row.chain.levels.size(), 2U);
    float widest = 0;
    for (const std::uint32_t i : row.chain.levels[0].parts[0].indices) {
        EXPECT_LE(std::abs(row.chain.full.vertices[i].position[1]), 0.2F);
        widest = std::max(widest, row.chain.full.vertices[i].position[0]);
    }
    EXPECT_GT(widest, 5.3F) << "to the sides it grew";
}

TEST(ClusterCoverage, LevelsThatCoverEnoughStayAsTheyAre) {
    SquareRow row({0.3F, 0.38F});
    const std::vector<std::uint32_t> indices = row.chain.levels[0].parts[0].indices;
    EXPECT_FALSE(mend_cluster(row.chain, row.cover));
    EXPECT_EQ(row.chain.levels[0].parts[0].indices, indices);
    EXPECT_EQ(row.chain.levels[0].error_m, 3.0F);
}

std::uint64_t samples_of_picture(const FormPicture& picture) {
    return static_cast<std::uint64_t>(std::ranges::count_if(picture.samples, &FormSample::covered));
}

/// By form of a cluster: what it covers in all directions by which losses are measured, to full detail's. 1 where little shows.
std::vector<double> cluster_shares(const model::Model& m) {
    std::vector<std::uint64_t> full(m.reps.size()), form(m.reps.size());
    PictureTree tree(m);
    const ForAll serially = [](std::size_t n, const std::function<void(std::size_t)>& body) {
        for (std::size_t i = 0; i < n; ++i) body(i);
    };
    for (const auto& [azimuth_rad, elevation_rad] : loss_directions) {
        const auto count = [&](model::Index n, const FormPicture& seen) {
            FormPicture one;
            for (model::Index r = m.nodes[n].first_rep; r < m.nodes[n].first_rep + m.nodes[n].rep_count; ++r) {
                one.clear(seen.view);
                draw_form(m, m.reps[r], one);
                full[r] += samples_of_picture(seen);
                form[r] += samples_of_picture(one);
            }
            return true;
        };
        EXPECT_TRUE(tree.look({direction_of(azimuth_rad, elevation_rad)}, serially, count));
    }
    std::vector<double> shares(m.reps.size(), 1.0);
    for (std::size_t r = 0; r < shares.size(); ++r)
        if (full[r] >= 400) shares[r] = static_cast<double>(form[r]) / static_cast<double>(full[r]);
    return shares;
}

// Grids make tetrahedra of beads and blades of posts. Without the rule 28 of these meshes are off; 15 stay so: they are the
// only meshes of their clusters, and have no room to grow.
TEST(ClusterCoverage, ABakeHoldsMeshesOfClustersToIt) {
    importer::Scene scene;
    scene.materials.resize(1);
    const importer::Index post = add_mesh(scene, tube(6, 0.1F, 1), "post"), bead = add_mesh(scene, ball(6, 0.3F), "bead");
    Random random(7);
    for (int i = 0; i < 80; ++i) place(scene, i % 2 == 0 ? post : bead, any_in(random, dvec3(0), dvec3(12, 6, 12)));
    const auto baked = bake(scene, {}, {});
    ASSERT_TRUE(baked.ok());
    const model::Model& m = *baked;
    const std::vector<double> shares = cluster_shares(m);
    std::size_t meshes = 0, off = 0;
    for (const model::Node& node : m.nodes) {
        if (node.child_count == 0) continue;
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            if (m.reps[r].kind != model::RepKind::mesh) continue;
            ++meshes;
            if (shares[r] < min_covered || shares[r] > max_covered) ++off;
        }
    }
    EXPECT_GT(meshes, 20U);
    EXPECT_LE(off, 17U) << "of " << meshes;
}

}  // namespace
}  // namespace surefoot::bake
