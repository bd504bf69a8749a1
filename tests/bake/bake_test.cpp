// The bake: every bound holds, parents cost less than their children, the same bits at any worker count, refusals by name.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <map>

#include "render/bake/bake.hpp"
#include "render/bake/cluster.hpp"
#include "render/bake/objects.hpp"
#include "render/measure/mesh_distance.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tests/bake/scenes.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot {
namespace {

#ifdef SUREFOOT_SANITIZED
constexpr double small_scale = 0.03;  // the sanitizers take ten times as long
#else
constexpr double small_scale = 0.1;
#endif

importer::Scene scene_of(const char* name, double scale) {
    auto generated = scenes::generate(name, scale, 1);
    EXPECT_TRUE(generated.ok());
    return std::move(generated->scene);
}

model::Model bake_of(const importer::Scene& scene, int workers = 0) {
    bake::BakeOptions options;
    options.workers = workers;
    auto model = bake::bake(scene, options, {});
    EXPECT_TRUE(model.ok()) << (model.ok() ? "" : model.error().text());
    return std::move(*model);
}

/// The leaves together are the scene: no triangle is lost, none is there twice. Said of every scene that a test bakes anyway.
void expect_every_triangle_in_the_leaves(const importer::Scene& scene, const model::Model& m, const char* name) {
    std::uint64_t leaves = 0;
    for (const model::Node& node : m.nodes) {
        if (node.child_count == 0) leaves += m.reps[node.first_rep + node.rep_count - 1].triangles;
    }
    EXPECT_EQ(leaves, scene.triangles()) << name;
    EXPECT_EQ(m.triangles(), scene.triangles()) << name;
}

/// A representation's triangles in the world, relative to `origin`.
struct Surface {
    std::vector<vec3> positions;
    std::vector<std::uint32_t> indices;
    void add(const model::Model& m, const model::Representation& rep, const dvec3& origin) {
        const model::Placement& placement = m.placements[rep.placement];
        for (std::uint32_t p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            const model::Part& part = m.parts[p];
            for (std::uint32_t i = 0; i < part.index_count; ++i) {
                const model::Vertex& v = m.vertices[part.first_vertex + m.indices[part.first_index + i]];
                const dvec3 at =
                    placement.origin + dvec3(dmat3(placement.linear) * dvec3(v.position[0], v.position[1], v.position[2]));
                indices.push_back(static_cast<std::uint32_t>(positions.size()));
                positions.push_back(vec3(at - origin));
            }
        }
    }
    [[nodiscard]] measure::MeshView view() const { return {positions, indices}; }
};

void add_full_detail(const model::Model& m, model::Index n, const dvec3& origin, Surface& out) {
    const model::Node& node = m.nodes[n];
    if (node.child_count == 0) out.add(m, m.reps[node.first_rep + node.rep_count - 1], origin);
    for (std::uint32_t c = 0; c < node.child_count; ++c) add_full_detail(m, node.first_child + c, origin, out);
}

TEST(Bake, NoSampledPointLiesBeyondARepresentationsBound) {
    const model::Model m = bake_of(scene_of("forest", 0.5));
    std::vector<double> tightness;
    int checked = 0;
    for (model::Index n = 0; n < m.nodes.size(); n += 1 + static_cast<model::Index>(m.nodes.size() / 150)) {
        const model::Node& node = m.nodes[n];
        if (node.triangles > 60000) continue;  // the time of a unit test
        const dvec3 origin = node.box.centre();
        Surface full;
        add_full_detail(m, n, origin, full);
        const measure::TriangleTree full_tree(full.view());
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            const model::Representation& rep = m.reps[r];
            if (rep.error_m == 0 || rep.kind != model::RepKind::mesh) continue;
            Surface coarse;
            coarse.add(m, rep, origin);
            const float there = measure::sampled_distance(full.view(), measure::TriangleTree(coarse.view()), 4000, n).largest;
            const float back = measure::sampled_distance(coarse.view(), full_tree, 4000, n + 1).largest;
            const float sampled = std::max(there, back);
            ASSERT_LE(sampled, rep.error_m * 1.0005F + 1e-5F) << "node " << n << " rep " << r - node.first_rep;
            if (sampled > 0) tightness.push_back(rep.error_m / sampled);
            ++checked;
        }
    }
    ASSERT_GT(checked, 60);
    std::sort(tightness.begin(), tightness.end());
    EXPECT_LE(tightness[tightness.size() / 2], 2.0) << "the median bound is at most twice the sampled distance";
}

TEST(Bake, ACoarsestFormCostsLessThanItsChildrensTogetherAndEveryTriangleIsInTheLeaves) {
    const importer::Scene scene = scene_of("town", 0.1);
    const model::Model m = bake_of(scene);
    expect_every_triangle_in_the_leaves(scene, m, "town");
    const auto coarsest = [&](const model::Node& node) {
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            if (m.reps[r].everywhere) return m.reps[r].triangles;
        }
        ADD_FAILURE() << "a node without a form that is valid everywhere";
        return 0U;
    };
    for (const model::Node& node : m.nodes) {
        if (node.child_count < 2) continue;
        std::uint32_t sum = 0;
        for (std::uint32_t c = 0; c < node.child_count; ++c) sum += coarsest(m.nodes[node.first_child + c]);
        EXPECT_LE(coarsest(node), std::max(24U, sum));
    }
    EXPECT_LE(coarsest(m.nodes[0]), 300U) << "the floor is a few hundred triangles at most";
}

TEST(Bake, TheSameBitsAtAnyWorkerCount) {
    const test::TemporaryFolder folder;
    const importer::Scene scene = scene_of("room", 0.5);
    const auto file_of = [&](const model::Model& m) {
        EXPECT_TRUE(model::write_walk(folder / "m.walk", m).ok());
        return *read_file(folder / "m.walk");
    };
    const model::Model one = bake_of(scene, 1);
    expect_every_triangle_in_the_leaves(scene, one, "room");
    const auto file = file_of(one);
    for (const int workers : {2, 4}) {
        const model::Model other = bake_of(scene, workers);
        ASSERT_EQ(one.nodes.size(), other.nodes.size());
        ASSERT_EQ(one.indices, other.indices);
        ASSERT_EQ(one.vertices.size(), other.vertices.size());
        EXPECT_EQ(std::memcmp(one.vertices.data(), other.vertices.data(), one.vertices.size() * sizeof(model::Vertex)), 0);
        ASSERT_EQ(one.reps.size(), other.reps.size());
        for (std::size_t r = 0; r < one.reps.size(); ++r) EXPECT_EQ(one.reps[r].error_m, other.reps[r].error_m);
        ASSERT_EQ(one.losses.size(), one.reps.size());
        ASSERT_EQ(other.losses.size(), one.reps.size());
        for (std::size_t r = 0; r < one.reps.size(); ++r) EXPECT_EQ(one.losses[r].colour, other.losses[r].colour);
        EXPECT_TRUE(file_of(other) == file) << "the whole file, " << workers << " workers";
    }
}

/// Rings of vertices, one above the other, with sides between them: what no other form is.
bool is_stack_of_prisms(const model::Model& m, const model::Representation& rep) {
    if (rep.kind != model::RepKind::mesh || rep.part_count != 1 || rep.triangles < 16 || rep.triangles > 46) return false;
    const model::Part& part = m.parts[rep.first_part];
    std::map<float, std::map<std::uint32_t, int>> rings;
    for (std::uint32_t i = 0; i < part.index_count; ++i) {
        const std::uint32_t index = m.indices[part.first_index + i];
        ++rings[m.vertices[part.first_vertex + index].position[1]][index];
    }
    return (rings.size() == 3 || rings.size() == 5) && std::all_of(rings.begin(), rings.end(), [](const auto& ring) {
               return ring.second.size() == 4 || ring.second.size() == 5;
           });
}

/// How many forms of each method a model has.
struct Methods {
    int cards = 0, cluster_cards = 0, stacks = 0, pictures = 0;
    explicit Methods(const model::Model& m) {
        for (const model::Node& node : m.nodes) {
            for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
                const model::Representation& rep = m.reps[r];
                pictures += rep.kind == model::RepKind::textured_box ? 1 : 0;
                if (rep.kind != model::RepKind::mesh || model::is_full_detail(node, r, rep.error_m)) continue;
                stacks += node.child_count == 0 && is_stack_of_prisms(m, rep) ? 1 : 0;
                bool masked = false;
                for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
                    masked |= m.materials[m.parts[p].material].alpha == model::AlphaMode::mask;
                (node.child_count > 0 ? cluster_cards : cards) += masked ? 1 : 0;
            }
        }
    }
};

TEST(Bake, FilesOfCardsStacksAndPicturesAreTheSameAtAnyWorkerCount) {
    const tbb::global_control more_than_cores(tbb::global_control::max_allowed_parallelism, 4);
    const test::TemporaryFolder folder;
    for (const char* name : {"garden", "forest"}) {
        const importer::Scene scene = scene_of(name, small_scale);
        std::vector<std::vector<std::byte>> files;
        for (const int workers : {1, 4}) {
            const model::Model m = bake_of(scene, workers);
            expect_every_triangle_in_the_leaves(scene, m, name);
            const Methods made(m);
            if (m.textures.empty()) {
                EXPECT_GT(made.stacks, 0) << name;
            } else {
                EXPECT_GT(made.cards, 0) << name;
                EXPECT_GT(made.cluster_cards, 0) << name;
                EXPECT_GT(made.pictures, 0) << name;
            }
            ASSERT_TRUE(model::write_walk(folder / "m.walk", m).ok());
            files.push_back(*read_file(folder / "m.walk"));
        }
        EXPECT_TRUE(files[0] == files[1]) << name;
    }
}

TEST(Bake, LeavesAreSplitBelowASixteenthOfAFrame) {
    importer::Scene scene = bake::small_town();  // its balls have 2304 triangles each, one is stretched and one mirrored
    bake::place(scene, bake::add_mesh(scene, bake::hills(60, 40), "large"), {0, 30, 0});
    bake::BakeOptions options;
    model::CostModel slow = model::default_costs();  // a machine on which 1/16 frame is few triangles
    for (model::CostGrid& grid : slow.grids) {
        for (model::ItemCost& cell : grid.cells) cell.submit_us *= 40;
    }
    options.costs = &slow;
    auto m = bake::bake(scene, options, {});
    ASSERT_TRUE(m.ok());
    std::uint32_t largest = 0;
    for (const model::Node& node : m->nodes) {
        if (node.child_count == 0) largest = std::max(largest, m->reps[node.first_rep + node.rep_count - 1].triangles);
    }
    EXPECT_LE(largest, 1024U);
}

TEST(Bake, ASceneOfPlainColoursCallsForNoTextureAndNoVertexColour) {
    importer::Scene scene;
    scene.materials.push_back({"red", {1, 0, 0, 1}, importer::none, 0.5F, model::AlphaMode::opaque, false, true});
    importer::Mesh mesh{"grid", {{}}};
    importer::Primitive& p = mesh.primitives[0];
    for (int y = 0; y <= 24; ++y) {
        for (int x = 0; x <= 24; ++x)
            p.positions.emplace_back(x, std::sin(0.7F * static_cast<float>(x)) * std::cos(0.5F * static_cast<float>(y)), y);
    }
    for (std::uint32_t y = 0; y < 24; ++y) {
        for (std::uint32_t x = 0; x < 24; ++x) {
            const std::uint32_t a = y * 25 + x;
            for (const std::uint32_t i : {a, a + 25, a + 1, a + 1, a + 25, a + 26}) p.indices.push_back(i);
        }
    }
    scene.meshes.push_back(mesh);
    for (int i = 0; i < 5; ++i) {
        importer::Node node;
        node.mesh = 0;
        node.world[3] = dvec4(30.0 * i, 0, 0, 1);
        scene.nodes.push_back(node);
    }
    const model::Model m = bake_of(scene);
    EXPECT_EQ(m.called_for(), 0U);
    for (const model::Representation& rep : m.reps) EXPECT_EQ(rep.effects, 0U);
}

TEST(Bake, NothingDrawableAndStoppedAreNamed) {
    importer::Scene empty;
    empty.sources = {"empty.glb"};
    empty.materials.emplace_back();
    auto nothing = bake::bake(empty, {}, {});
    ASSERT_FALSE(nothing.ok());
    EXPECT_NE(nothing.error().text().find("empty.glb"), std::string::npos);
    const std::atomic<bool> stop{true};
    Progress progress;
    progress.stop = &stop;
    auto stopped = bake::bake(scene_of("room", 0.1), {}, progress);
    ASSERT_FALSE(stopped.ok());
    EXPECT_NE(stopped.error().what.find("stopped"), std::string::npos);
}

TEST(Clusters, GrowFromNearToFarAndHoldEveryObjectOnce) {
    std::vector<Box> boxes;
    for (int i = 0; i < 100; ++i) {
        const int column = i % 10, row = i / 10;
        const dvec3 at(10.0 * column, 0, 10.0 * row);
        boxes.push_back({at, at + dvec3(1)});
    }
    boxes.push_back({dvec3(-5), dvec3(100)});  // one that encloses all
    const bake::ClusterTree tree = bake::grow_clusters(boxes, 8);
    std::vector<int> seen(boxes.size(), 0);
    std::vector<std::uint32_t> open{tree.root};
    while (!open.empty()) {
        const std::uint32_t e = open.back();
        open.pop_back();
        if (e < boxes.size()) {
            ++seen[e];
            continue;
        }
        const bake::ClusterTree::Cluster& cluster = tree.clusters[e - boxes.size()];
        EXPECT_GE(cluster.children.size(), 2U);
        EXPECT_LE(cluster.children.size(), 8U);
        for (const std::uint32_t c : cluster.children) {
            EXPECT_TRUE(cluster.box.contains(c < boxes.size() ? boxes[c] : tree.clusters[c - boxes.size()].box));
            open.push_back(c);
        }
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(boxes.size()));
}

TEST(Objects, LargestStretchIsAnUpperBoundAndTight) {
    EXPECT_NEAR(bake::largest_stretch(dmat3(3.0)), 3.0, 0.004);
    const dmat3 shear(dvec3(1, 0, 0), dvec3(5, 1, 0), dvec3(0, 0, 0.1));
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const double a = 0.1 * i, b = 0.0123 * i;
        worst = std::max(worst, glm::length(shear * dvec3(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b))));
    }
    EXPECT_GE(bake::largest_stretch(shear), worst);
    EXPECT_LE(bake::largest_stretch(shear), worst * 1.01);
    EXPECT_EQ(bake::largest_stretch(dmat3(0.0)), 0.0);
}

}  // namespace
}  // namespace surefoot
