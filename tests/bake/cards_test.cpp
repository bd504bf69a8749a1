// Leaves on coarse levels: fewer cards, larger, each with its picture; the same ones wherever they are fewer still.
#include "render/bake/cards.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "render/bake/bake.hpp"
#include "render/bake/cluster_cards.hpp"
#include "render/bake/mesh_surface.hpp"
#include "render/bake/vertex_clusters.hpp"
#include "rt/base/random.hpp"
#include "tests/bake/scenes.hpp"

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
    auto cards = cards_of(g, g.parts[0]);
    spread(g, cards, 1000);
    std::vector<std::uint32_t> before = some_cards(cards, 1);
    EXPECT_EQ(before.size(), 300U);
    for (const double share : {0.5, 0.2, 0.05, 0.0}) {
        const std::vector<std::uint32_t> fewer = some_cards(cards, share);
        EXPECT_EQ(fewer.size(), std::max(6U, static_cast<unsigned>(share * 50 + 1e-9) * 6));
        EXPECT_TRUE(std::equal(fewer.begin(), fewer.end(), before.begin()));
        before = fewer;
    }
}

/// How far the middle of any card lies from the nearest of the first `kept`.
float farthest(const Geometry& g, const std::vector<std::vector<std::uint32_t>>& cards, std::size_t kept) {
    const auto middle = [&](const std::vector<std::uint32_t>& card) {
        vec3 sum(0);
        for (const std::uint32_t i : card) sum += position_of(g.vertices[i]) / static_cast<float>(card.size());
        return sum;
    };
    float most = 0;
    for (const auto& card : cards) {
        float nearest = 1e9F;
        for (std::size_t k = 0; k < kept; ++k) nearest = std::min(nearest, glm::length(middle(card) - middle(cards[k])));
        most = std::max(most, nearest);
    }
    return most;
}

TEST(Cards, TheFirstOfThemReachEverywhere) {
    const Geometry g = crown(200);
    const auto as_they_came = cards_of(g, g.parts[0]);
    auto cards = as_they_came;
    spread(g, cards, 100);  // as far as 50 of two triangles
    for (const std::size_t kept : {4U, 10U, 25U, 50U})
        EXPECT_LT(farthest(g, cards, kept), 0.8F * farthest(g, as_they_came, kept)) << kept;
    auto all = cards;
    std::sort(all.begin(), all.end());
    auto before = as_they_came;
    std::sort(before.begin(), before.end());
    EXPECT_EQ(all, before) << "each once, none lost";
}

/// `count` squares in the part's plane, each with the whole picture: side by side, or corner to corner.
void add_row(Geometry& g, GeometryPart& part, std::uint32_t count, bool by_edges) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto base = static_cast<std::uint32_t>(g.vertices.size());
        for (std::uint32_t corner = 0; corner < 4; ++corner) {
            model::Vertex v{};
            v.uv[0] = corner == 1 || corner == 2 ? 1.0F : 0.0F;
            v.uv[1] = corner >= 2 ? 1.0F : 0.0F;
            v.position[0] = 10 + static_cast<float>(i) + v.uv[0];
            v.position[1] = v.uv[1] + (by_edges ? 0.0F : static_cast<float>(i));
            g.vertices.push_back(v);
            g.baked.push_back({20, 90, 30, 255});
        }
        for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) part.indices.push_back(base + k);
    }
}

TEST(Cards, ThatTouchInAPointAreEachItsOwnAndAFenceIsOne) {
    for (const bool fence : {false, true}) {
        Geometry g = crown(10);
        GeometryPart& part = g.parts[0];
        add_row(g, part, 4, fence);
        EXPECT_EQ(cards_of(g, part).size(), fence ? 11U : 14U);
        EXPECT_EQ(thinnable_cards(g, part).size(), fence ? 0U : 14U) << "8 of 28 triangles are more than a quarter";
    }
}

TEST(Cards, ThatTouchGrowEachAboutItsOwnMiddle) {
    Geometry g;
    GeometryPart part{0, {}};
    add_row(g, part, 8, false);
    Cards cards = cards_of(g, part);
    spread(g, cards, 100);
    const double whole = area_of(g, part.indices);
    part.indices = some_cards(cards, 0.5);
    ASSERT_EQ(part.indices.size(), 4U * 6);
    const std::vector<std::uint32_t> before = part.indices;
    enlarge_cards(g, part, cards, whole);
    const auto middle = [&](const std::vector<std::uint32_t>& of, std::size_t card) {
        vec3 sum(0);
        for (std::size_t i = 6 * card; i < 6 * card + 6; ++i) sum += position_of(g.vertices[of[i]]) / 6.0F;
        return sum;
    };
    for (std::size_t card = 0; card < 4; ++card) EXPECT_LT(glm::length(middle(part.indices, card) - middle(before, card)), 1e-5F);
    EXPECT_NEAR(area_of(g, part.indices), whole, 1e-4 * whole);
}

TEST(Cards, TheFirstOneIsNotALargeOne) {
    Geometry g = crown(30);
    GeometryPart& part = g.parts[0];
    Geometry fence;
    GeometryPart row{0, {}};
    add_row(fence, row, 10, true);
    const auto base = static_cast<std::uint32_t>(g.vertices.size());
    for (model::Vertex v : fence.vertices) {
        v.position[0] -= 15;  // in the crown's middle
        v.position[1] += 3.5F;
        g.vertices.push_back(v);
        g.baked.push_back({20, 90, 30, 255});
    }
    for (const std::uint32_t i : row.indices) part.indices.push_back(base + i);
    Cards cards = thinnable_cards(g, part);
    ASSERT_EQ(cards.size(), 31U);
    spread(g, cards, 1000);
    EXPECT_EQ(cards.front().size(), 6U) << "else every level would hold a quarter of the whole";
}

TEST(Cards, GrowAboutTheirMiddlesToTheAreaThatWasThereAndNoFurther) {
    for (const double share : {0.5, 0.1}) {
        Geometry g = crown(50);
        const double whole = area_of(g, g.parts[0].indices);
        const Cards cards = cards_of(g, g.parts[0]);
        GeometryPart part{0, some_cards(cards, share)};
        const double kept = area_of(g, part.indices);
        const std::vector<std::uint32_t> before = part.indices;
        enlarge_cards(g, part, cards, whole);
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

TEST(Cards, LeaveTheTrunkItsShapeAndAreNeverBoxed) {
    Geometry g = crown(100);
    GeometryPart& trunk = g.parts[1];
    constexpr std::uint32_t around = 12, up = 12;  // 288 triangles, and bent: no level of it is exact
    const auto base = static_cast<std::uint32_t>(g.vertices.size());
    for (std::uint32_t y = 0; y <= up; ++y) {
        for (std::uint32_t x = 0; x < around; ++x) {
            const float turn = 6.2831853F * static_cast<float>(x) / around, height = static_cast<float>(y) / 3;
            model::Vertex v{};
            v.position[0] = 0.3F * std::cos(turn) + 0.2F * std::sin(2 * height);
            v.position[1] = height;
            v.position[2] = 0.3F * std::sin(turn);
            g.vertices.push_back(v);
            g.baked.push_back({90, 60, 20, 255});
            if (y == up) continue;
            const std::uint32_t a = base + y * around + x, b = base + y * around + (x + 1) % around;
            for (const std::uint32_t i : {a, b, a + around, b, b + around, a + around}) trunk.indices.push_back(i);
        }
    }
    ChainOptions options;
    options.proxy_material = 2;
    options.cut_out = {true, false, false};
    const LodChain chain = make_chain(g, options);
    ASSERT_GE(chain.levels.size(), 4U);
    EXPECT_LE(chain.levels.front().triangles, 60U) << "the trunk did not keep it from getting small";
    for (const Level& level : chain.levels) {
        double leaves = 0, solid = 0;
        for (const GeometryPart& part : level.parts)
            (part.material == 0 ? leaves : solid) += static_cast<double>(part.indices.size() / 3);
        EXPECT_GT(leaves, 0) << "a box of " << solid;
        if (level.triangles < 490 && leaves > 4) {
            EXPECT_GE(solid / 290, 1.2 * leaves / 200);
        }
    }
}

TEST(Cards, ThatAreLeftOutOrGrewLieWithinTheLevelsError) {
    ChainOptions options;
    options.proxy_material = 2;
    options.pictures = {Picture::clamped, Picture::clamped, Picture::none};
    options.cut_out = {true, false, false};
    const LodChain chain = make_chain(crown(200), options);
    const MeshSurface full(chain.full.vertices, chain.levels.back().parts);
    for (std::size_t l = 0; l + 1 < chain.levels.size(); ++l) {
        EXPECT_GT(chain.levels[l].error_m, chain.levels[l + 1].error_m);
        const MeshSurface coarse(chain.full.vertices, chain.levels[l].parts);
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

/// Nine crowns in three rows, merged.
Geometry orchard() {
    Geometry g;
    g.parts = {{0, {}}, {1, {}}};
    for (int tree = 0; tree < 9; ++tree) {
        const Geometry one = crown(60);
        const auto base = static_cast<std::uint32_t>(g.vertices.size());
        for (model::Vertex v : one.vertices) {
            v.position[0] += 6.0F * static_cast<float>(tree % 3);
            v.position[2] += 6.0F * static_cast<float>(tree / 3);
            g.vertices.push_back(v);
        }
        g.baked.insert(g.baked.end(), one.baked.begin(), one.baked.end());
        for (std::size_t p = 0; p < 2; ++p)
            for (const std::uint32_t i : one.parts[p].indices) g.parts[p].indices.push_back(base + i);
    }
    return g;
}

TEST(ClusterCards, OfManyCrownsAreSomeOfThemLargerWithinTheLevelsErrors) {
    const Geometry all = orchard();
    Geometry solid = all;
    const std::vector<GeometryPart> cards = take_cards(solid, {true, false, false}, 2, 30);
    ASSERT_EQ(cards.size(), 1U);
    ASSERT_EQ(solid.parts.size(), 1U);
    EXPECT_EQ(solid.parts[0].material, 1U);
    const std::vector<std::uint32_t> owners(all.vertices.size(), 0);
    ClusteringLimits limits;
    limits.max_triangles = 40;
    limits.min_triangles = 12;
    const LodChain grid = cluster_vertices(solid, owners, {true, true, true}, limits);
    const LodChain chain = with_cards(grid, solid, cards, {300, 20, 0.25F});
    ASSERT_GE(chain.levels.size(), 4U);
    EXPECT_LE(chain.levels.back().triangles, 300 + grid.levels.back().triangles);
    const MeshSurface full(all.vertices, all.parts);
    const double area_m2 = area_of(all, all.parts[0].indices);
    for (std::size_t l = 0; l < chain.levels.size(); ++l) {
        const Level& level = chain.levels[l];
        std::size_t triangles = 0, leaves = 0, trunks = 0;
        for (const GeometryPart& part : level.parts) {
            triangles += part.indices.size() / 3;
            (part.material == 0 ? leaves : trunks) += part.indices.size() / 3;
            if (part.material != 0) continue;
            const double kept = static_cast<double>(part.indices.size()) / static_cast<double>(all.parts[0].indices.size());
            const double grown = area_of(chain.full, part.indices) / area_m2;
            EXPECT_NEAR(grown, std::min(1.0, 2.5 * 2.5 * kept), 0.02) << "coverage is kept, or the cards grew as far as they may";
        }
        EXPECT_EQ(triangles, level.triangles);
        EXPECT_GE(leaves, 2U);
        EXPECT_GE(trunks, 2U);
        if (l > 0) {
            EXPECT_LT(level.error_m, chain.levels[l - 1].error_m);
        }
        const MeshSurface coarse(chain.full.vertices, level.parts);
        for (const measure::DistanceBounds& found :
             {measure::directed_distance(full.view(), measure::TriangleTree(coarse.view()), {}),
              measure::directed_distance(coarse.view(), measure::TriangleTree(full.view()), {})})
            EXPECT_LE(found.lower, level.error_m * 1.0001F);
    }
}

TEST(ClusterCards, WithoutAnythingSolidAreLevelsOfTheirOwn) {
    Geometry g = orchard();
    g.parts.pop_back();
    const std::vector<GeometryPart> cards = take_cards(g, {true}, 2, 30);
    ASSERT_EQ(g.triangles(), 0U);
    const LodChain chain = with_cards({}, g, cards, {256, 16, 0.25F});
    EXPECT_GE(chain.levels.size(), 4U);
    EXPECT_LE(chain.levels.back().triangles, 256U);
    EXPECT_GE(chain.levels.front().triangles, 8U);
}

TEST(ClusterCards, ThatAreFewAreColouredAndSolid) {
    Geometry g = crown(7);
    EXPECT_TRUE(take_cards(g, {true, false, false}, 2, 30).empty());
    ASSERT_EQ(g.parts.size(), 2U);
    EXPECT_EQ(g.parts[1].material, 2U);
    EXPECT_EQ(g.parts[1].indices.size(), 7U * 6);
    for (const std::uint32_t i : g.parts[1].indices) EXPECT_EQ(g.vertices[i].colour[1], 90);
}

TEST(ClusterCards, LargerThanALevelMayBeAreColouredAndSolid) {
    Geometry g = orchard();
    EXPECT_TRUE(take_cards(g, {true, false, false}, 2, 1).empty());
    EXPECT_EQ(g.triangles(), orchard().triangles());
}

TEST(ClusterCards, OfABakedWoodAreSeenThroughAtEveryDistance) {
    importer::Scene scene;
    scene.sources = {"by hand"};
    image::Image leaf;
    leaf.width = leaf.height = 8;
    for (int i = 0; i < 64; ++i)
        leaf.rgba.insert(leaf.rgba.end(), {40, 120, 30, static_cast<std::uint8_t>((i / 8 + i) % 3 == 0 ? 255 : 0)});
    scene.images.push_back(leaf);
    scene.materials.resize(2);
    scene.materials[0].image = 0;
    scene.materials[0].alpha = model::AlphaMode::mask;
    scene.materials[0].alpha_cutoff = 0.5F;
    importer::Primitive leaves, trunk = tube(6, 0.2F, 4);
    trunk.material = 1;
    Random random(3);
    for (std::uint32_t card = 0; card < 120; ++card) {
        vec3 at(0);
        for (int k = 0; k < 3; ++k) at[k] = static_cast<float>(random.range(-2, 2));
        at.y += 5;
        for (const vec2& corner : {vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 1)}) {
            leaves.positions.push_back(at + 0.6F * vec3(corner, 0));
            leaves.normals.push_back({0, 0, 1});
            leaves.uvs.push_back(corner);
        }
        for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) leaves.indices.push_back(4 * card + i);
    }
    scene.meshes.push_back({"tree", {leaves, trunk}});
    for (int tree = 0; tree < 64; ++tree) place(scene, 0, dvec3(7 * (tree % 8), 0, 7 * (tree / 8)));
    const auto model = bake(scene, {}, {});
    ASSERT_TRUE(model.ok()) << model.error().text();
    std::size_t clusters = 0, seen_through = 0;
    for (const model::Node& node : model->nodes) {
        if (node.kind != model::NodeKind::cluster) continue;
        std::uint32_t children = 0;
        for (model::Index c = node.first_child; c < node.first_child + node.child_count; ++c) {
            // The coarsest mesh; before it there may be a box.
            const model::Node& child = model->nodes[c];
            const auto own = std::span(model->reps).subspan(child.first_rep, child.rep_count);
            children += std::ranges::find(own, model::RepKind::mesh, &model::Representation::kind)->triangles;
        }
        EXPECT_LE(model->reps[node.first_rep + node.rep_count - 1].triangles, children) << "a parent costs less";
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            ++clusters;
            seen_through += (model->reps[r].effects & model::effect_alpha_mask) != 0 ? 1 : 0;
        }
    }
    EXPECT_GE(clusters, 8U);
    EXPECT_EQ(seen_through, clusters);
}

}  // namespace
}  // namespace surefoot::bake
