// Scenes by hand through the bake: bounds that sampling cannot break, boxes included; a whole picture at the floor; no cracks.
#include "render/bake/bake.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <tuple>

#include "tests/bake/scenes.hpp"
#include "tests/bake/surface.hpp"

namespace surefoot::bake {
namespace {

model::Model baked(const importer::Scene& scene, BakeOptions options = {}) {
    auto model = bake(scene, options, {});
    EXPECT_TRUE(model.ok()) << (model.ok() ? "" : model.error().text());
    return model.ok() ? std::move(*model) : model::Model{};
}

void expect_bounds_hold(const model::Model& m, std::size_t points, std::size_t stride) {
    std::vector<float> mesh_ratios;
    for (const Judged& j : judge(m, points, stride)) {
        EXPECT_LE(j.sampled, j.bound + j.rounding) << "node " << j.node << " representation " << j.rep;
        if (m.reps[j.rep].kind == model::RepKind::mesh) mesh_ratios.push_back(j.bound / std::max(j.sampled, 1e-9F));
    }
    ASSERT_FALSE(mesh_ratios.empty());
    std::nth_element(mesh_ratios.begin(), mesh_ratios.begin() + static_cast<std::ptrdiff_t>(mesh_ratios.size() / 2),
                     mesh_ratios.end());
    EXPECT_LE(mesh_ratios[mesh_ratios.size() / 2], 2.0F);
}

const model::Representation& coarsest_everywhere(const model::Model& m, const model::Node& node) {
    model::Index r = node.first_rep;
    while (!m.reps[r].everywhere) ++r;
    return m.reps[r];
}

/// Baked once for all tests that only look at it.
const model::Model& town() {
    static const model::Model model = baked(small_town());
    return model;
}

TEST(BakeByHand, NoSampleLiesBeyondItsBound) { expect_bounds_hold(town(), 4000, 1); }

// The rule: no error of 10^5 points per representation exceeds its bound. All take a minute, so every tenth is tested, unless
// SUREFOOT_ALL_BOUNDS is set.
TEST(BakeByHand, NoneOfAHundredThousandSamplesLiesBeyondItsBound) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer makes this twenty times as long, and finds its faults with fewer points";
#else
    expect_bounds_hold(town(), 100000, std::getenv("SUREFOOT_ALL_BOUNDS") != nullptr ? 1 : 10);
#endif
}

// Positions near 6000 km have steps of half a metre in float: the bounds are made where the geometry is small.
TEST(BakeByHand, BoundsHoldFarFromTheOrigin) { expect_bounds_hold(baked(small_town({5.6e6, -6.1e6, 4e6})), 2000, 1); }

TEST(BakeByHand, PassesValidationAndCountsItsObjects) {
    const importer::Scene scene = small_town();
    const model::Model& m = town();
    EXPECT_TRUE(model::validate(m).ok());
    EXPECT_EQ(m.object_count, scene.nodes.size());
    EXPECT_EQ(m.triangles(), scene.triangles());
    std::vector<bool> seen(m.object_count, false);
    for (const model::Node& node : m.nodes) {
        if (node.object != model::none) seen[node.object] = true;
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), true), static_cast<std::ptrdiff_t>(m.object_count));
}

// "It never drops an object": however coarse, something stands where it is, within the bound.
TEST(BakeByHand, TheCrumbIsInTheCoarsestPicture) {
    const model::Model& m = town();
    const model::Representation& floor = coarsest_everywhere(m, m.nodes[0]);
    const dvec3 centre = m.nodes[0].box.centre();
    const Surface surface = surface_of(m, floor, centre);
    const measure::TriangleTree tree(surface.view());
    EXPECT_LE(tree.nearest(vec3(dvec3(300, 40, -90) - centre)).distance, floor.error_m);
}

TEST(BakeByHand, TheFloorIsSmallButAPicture) {
    const model::Model& m = town();
    const model::Representation& floor = coarsest_everywhere(m, m.nodes[0]);
    EXPECT_LE(floor.triangles, 300U);
    EXPECT_GE(floor.triangles, 12U);
    EXPECT_LT(floor.error_m, 0.25 * m.nodes[0].box.diagonal());
}

// A plate of many squares is as exact with two: it must not lose its picture for that.
TEST(BakeByHand, APlateKeepsItsPicture) {
    importer::Scene scene = small_town();
    const importer::Primitive plate = grid_surface(20, 20, [](float u, float v) { return vec3(2 * u, 2 * v, 0); });
    place(scene, add_mesh(scene, plate, "poster"), {-40, 2, 10});
    ASSERT_NE(scene.materials[0].image, importer::none);
    const model::Model m = baked(scene);
    const auto poster = std::find_if(m.nodes.begin(), m.nodes.end(),
                                     [&](const model::Node& node) { return std::string_view(m.name_of(node)) == "poster"; });
    ASSERT_NE(poster, m.nodes.end());
    int simpler = 0;
    for (model::Index r = poster->first_rep; r < poster->first_rep + poster->rep_count; ++r) {
        const model::Representation& rep = m.reps[r];
        if (rep.kind != model::RepKind::mesh || static_cast<double>(rep.error_m) > poster->box.diagonal() / 64) continue;
        simpler += rep.triangles < poster->triangles ? 1 : 0;
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            EXPECT_NE(m.materials[m.parts[p].material].texture, model::none) << rep.triangles << " triangles";
        }
    }
    EXPECT_GT(simpler, 0);
}

// Two things in one place make a mesh of one of them: exact in form, and wrong in colour where it is large.
TEST(BakeByHand, ClustersOfColoursAreNeverCalledNearlyExact) {
    const model::Model& m = town();
    for (const model::Node& node : m.nodes) {
        if (node.kind != model::NodeKind::cluster) continue;
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            EXPECT_GE(static_cast<double>(m.reps[r].error_m), 0.99 * node.box.diagonal() / 64);
        }
    }
}

// Maciel 1994, section 3.1: drawing the parent costs less than drawing its children at their coarsest.
TEST(BakeByHand, ParentsAreCheaperThanTheirChildren) {
    const model::Model& m = town();
    for (std::size_t n = 0; n < m.nodes.size(); ++n) {
        const model::Node& node = m.nodes[n];
        if (node.child_count == 0) continue;
        std::uint64_t children = 0, draws = 0;
        for (std::uint32_t c = 0; c < node.child_count; ++c) {
            const auto& rep = coarsest_everywhere(m, m.nodes[node.first_child + c]);
            children += rep.triangles;
            draws += rep.part_count;
        }
        const auto& own = coarsest_everywhere(m, node);
        EXPECT_LE(own.triangles, children) << "node " << n;
        EXPECT_LT(own.part_count, draws) << "node " << n;
    }
}

TEST(BakeByHand, ErrorsFallAndOnlyLeavesAreExact) {
    const model::Model& m = town();
    for (const model::Node& node : m.nodes) {
        const auto& finest = m.reps[node.first_rep + node.rep_count - 1];
        EXPECT_EQ(finest.error_m == 0.0F, node.child_count == 0);
    }
}

TEST(BakeByHand, NothingIsDrawnThatCostsMoreThanASixteenthOfAFrame) {
    importer::Scene scene = small_town();
    place(scene, add_mesh(scene, hills(150, 40), "large"), {0, 30, 0});  // 45 000 triangles
    const model::Model m = baked(scene);
    const model::CostModel costs = model::default_costs();
    bool pieces = false;
    for (const model::Node& node : m.nodes) pieces = pieces || node.kind == model::NodeKind::piece;
    EXPECT_TRUE(pieces);
    for (const model::Representation& rep : m.reps) {
        const auto cost = costs.item(static_cast<float>(rep.triangles), 1000, costs.grid_for(rep.effects));
        EXPECT_LE(cost.submit_us + cost.raster_us, 33333.0 / 16) << rep.triangles;
    }
}

// Neighbouring pieces share their borders: every vertex on a border of the whole is there, exactly, at full detail.
TEST(BakeByHand, PiecesJoinWithoutCracks) {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(1);
    place(scene, add_mesh(scene, hills(120, 100), "large"), dvec3(0));
    const model::Model m = baked(scene);
    ASSERT_GT(m.nodes.size(), 2U);
    const dvec3 centre = m.nodes[0].box.centre();
    Surface whole = full_detail(m, 0, centre);
    // Edges seen once are borders; a crack between pieces would add inner ones.
    std::vector<std::array<float, 6>> edges;
    for (std::size_t i = 0; i < whole.positions.size(); i += 3) {
        for (std::size_t k = 0; k < 3; ++k) {
            vec3 a = whole.positions[i + k], b = whole.positions[i + (k + 1) % 3];
            if (std::tie(a.x, a.y, a.z) > std::tie(b.x, b.y, b.z)) std::swap(a, b);
            edges.push_back({a.x, a.y, a.z, b.x, b.y, b.z});
        }
    }
    std::sort(edges.begin(), edges.end());
    std::size_t single = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const bool twin = (i > 0 && edges[i] == edges[i - 1]) || (i + 1 < edges.size() && edges[i] == edges[i + 1]);
        single += twin ? 0 : 1;
    }
    EXPECT_EQ(single, 4U * 120U);
}

TEST(BakeByHand, OneObjectAloneIsTheRoot) {
    importer::Scene scene;
    scene.materials.resize(1);
    place(scene, add_mesh(scene, ball(12, 1), "ball"), {1, 2, 3});
    const model::Model m = baked(scene);
    ASSERT_EQ(m.nodes.size(), 1U);
    EXPECT_EQ(m.nodes[0].kind, model::NodeKind::object);
    EXPECT_STREQ(m.name_of(m.nodes[0]), "ball");
}

// All in one place: no cell of any size can tell them apart, and no node may have them all as children.
TEST(BakeByHand, CrowdInOnePlaceIsCutAtMedians) {
    importer::Scene scene;
    scene.materials.resize(1);
    const auto mesh = add_mesh(scene, ball(3, 1), "ball");
    for (int i = 0; i < 500; ++i) place(scene, mesh, {1, 2, 3});
    const model::Model m = baked(scene);
    for (const model::Node& node : m.nodes) EXPECT_LE(node.child_count, 32U);
}

TEST(BakeByHand, TenThousandObjects) {
#ifdef SUREFOOT_SANITIZED
    constexpr int objects = 2000;  // a minute for all of them
#else
    constexpr int objects = 10'000;
#endif
    importer::Scene scene;
    scene.materials.resize(1);
    const auto mesh = add_mesh(scene, ball(4, 0.4F), "ball");
    Random random(2);
    for (int i = 0; i < objects; ++i) place(scene, mesh, {random.range(0, 900), random.range(0, 9), random.range(0, 900)});
    const model::Model m = baked(scene);
    EXPECT_EQ(m.object_count, static_cast<std::uint32_t>(objects));
    EXPECT_LE(coarsest_everywhere(m, m.nodes[0]).triangles, 300U);
    expect_bounds_hold(m, 300, 97);
}

TEST(BakeByHand, RealScenesKeepTheirBounds) {
    const char* data = std::getenv("SUREFOOT_DATA");
    if (data == nullptr) GTEST_SKIP() << "SUREFOOT_DATA is not set";
    const auto scene = importer::import_files({std::string(data) + "/interior/hospital/hospital_three_floors.glb"}, {});
    if (!scene) GTEST_SKIP() << scene.error().text();
    expect_bounds_hold(baked(*scene), 500, 7);
}

}  // namespace
}  // namespace surefoot::bake
