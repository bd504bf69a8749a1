// What moves, baked: boxes and errors hold at any time, still things stay as they are, and so do files of still scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "render/bake/bake.hpp"
#include "render/bake/motions.hpp"
#include "render/model/ground/walker.hpp"
#include "render/model/moving.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tests/bake/moving_scene.hpp"
#include "tests/bake/surface.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot::bake {
namespace {

using model::Index;

const model::Model& moving_model() {
    static const model::Model baked = [] {
        auto m = bake(moving_town(), {}, {});
        EXPECT_TRUE(m.ok()) << m.error().text();
        return std::move(*m);
    }();
    return baked;
}

std::vector<Index> moving_leaves(const model::Model& m) {
    std::vector<Index> leaves;
    for (Index n = 0; n < m.nodes.size(); ++n)
        if (m.nodes[n].child_count == 0 && model::motion_of(m, m.nodes[n]) != model::none) leaves.push_back(n);
    return leaves;
}

/// A corner of the node's full detail, at rest.
dvec3 corner_at_rest(const model::Model& m, Index node, Random& random) {
    const model::Node& n = m.nodes[node];
    const model::Representation& rep = m.reps[n.first_rep + n.rep_count - 1];
    const model::Part& part = m.parts[rep.first_part + random.below(rep.part_count)];
    const std::uint32_t index = m.indices[part.first_index + random.below(part.index_count)];
    const float* v = m.vertices[part.first_vertex + index].position;
    const model::Placement& p = m.placements[rep.placement];
    return p.origin + dmat3(p.linear) * dvec3(v[0], v[1], v[2]);
}

TEST(MotionBake, KeepsWhatMovesAndTheMotionsThatItHas) {
    importer::Scene scene = moving_town();
    add_lift(scene, dvec3(1, 0, 0), 3);  // nobody has it
    const auto m = bake(scene, {}, {});
    ASSERT_TRUE(m.ok()) << m.error().text();
    EXPECT_EQ(m->motions.size(), 4U);
    std::map<Index, int> objects;
    for (const Index n : moving_leaves(*m)) ++objects[model::motion_of(*m, m->nodes[n])];
    EXPECT_EQ(objects.size(), 3U) << "the arm moves nothing by itself";
    for (const auto& [motion, count] : objects) EXPECT_EQ(count, m->motions[motion].period_s == 8 ? 3 : 1);
    EXPECT_TRUE(model::motion_finding(*m).called_for);
}

TEST(MotionBake, BoxesHoldAtAHundredThousandRandomTimes) {
    const model::Model& m = moving_model();
    const std::vector<Index> leaves = moving_leaves(m);
    ASSERT_EQ(leaves.size(), 5U);
    Random random(1);
    for (int i = 0; i < 100'000; ++i) {
        const Index leaf = leaves[random.below(static_cast<std::uint32_t>(leaves.size()))];
        const double t = 1000 * random.unit() - 500;
        const dvec3 at = model::pose_at(m, model::motion_of(m, m.nodes[leaf]), t)(corner_at_rest(m, leaf, random));
        for (Index n = leaf; n != model::none; n = m.nodes[n].parent)
            ASSERT_LE(m.nodes[n].box.distance(at), 1e-5) << "node " << n << ", time " << t;
    }
}

TEST(MotionBake, BoxesAreNotMuchLargerThanTheWay) {
    const model::Model& m = moving_model();
    for (const Index leaf : moving_leaves(m)) {
        Box seen;
        Random random(leaf);
        for (int i = 0; i < 20'000; ++i)
            seen.grow(model::pose_at(m, model::motion_of(m, m.nodes[leaf]), 60 * random.unit())(corner_at_rest(m, leaf, random)));
        EXPECT_LT(m.nodes[leaf].box.diagonal(), 1.5 * seen.diagonal()) << leaf;
    }
}

/// Full detail as it is at a time, and each form of each node above what moves: no point of the one is farther from the other
/// than the form's error.
void expect_errors_hold(int times, std::uint64_t seed) {
    const model::Model& m = moving_model();
    std::set<Index> nodes;
    for (const Index leaf : moving_leaves(m))
        for (Index n = leaf; n != model::none; n = m.nodes[n].parent) nodes.insert(n);
    Random random(seed);
    int judged = 0;
    for (int round = 0; round < times; ++round) {
        const double t = 40 * random.unit();
        model::Model now = m;
        for (model::Placement& p : now.placements) p = model::moved(p, model::pose_at(m, p.motion, t));
        for (const Index n : nodes) {
            for (const Judged& one : judge_node(now, n, 3000)) {
                EXPECT_LE(one.sampled, one.bound + one.rounding) << "node " << n << ", form " << one.rep << ", time " << t;
                ++judged;
            }
        }
    }
    EXPECT_GT(judged, 10 * times);
}

TEST(MotionBake, ErrorsHoldAtRandomTimes) { expect_errors_hold(6, 5); }

TEST(MotionBakeAtNight, ErrorsHoldAtHundredsOfRandomTimes) { expect_errors_hold(300, 6); }

TEST(MotionBake, FormsAboveStandAtRestAndTheirErrorSaysHowFarOffThatIs) {
    const model::Model& m = moving_model();
    const model::Node& root = m.nodes[0];
    ASSERT_EQ(root.child_count, 2U) << "what stands, and what moves";
    double displacement_m = 0;
    for (const Index leaf : moving_leaves(m)) {
        const model::Node& node = m.nodes[leaf];
        displacement_m =
            std::max(displacement_m, model::reach_of(m, model::motion_of(m, node), model::rest_box_of(m, node)).displacement_m);
        if (m.motions[model::motion_of(m, node)].period_s != 8) continue;
        EXPECT_EQ(model::motion_of(m, m.nodes[node.parent]), model::motion_of(m, node)) << "three parts turn as one";
    }
    EXPECT_EQ(model::motion_of(m, root), model::none);
    for (Index r = root.first_rep; r < root.first_rep + root.rep_count; ++r)
        EXPECT_GE(static_cast<double>(m.reps[r].error_m), 0.99 * displacement_m);
}

/// Of a tree: its forms' errors by the box of the node at rest.
TEST(MotionBake, WhatStandsHasTheErrorsThatItHasAlone) {
    const auto alone = bake(small_town(), {}, {});
    ASSERT_TRUE(alone.ok());
    const model::Model& m = moving_model();
    const Index still = model::motion_of(m, m.nodes[m.nodes[0].first_child]) == model::none &&
                                m.nodes[m.nodes[0].first_child].triangles == alone->nodes[0].triangles
                            ? m.nodes[0].first_child
                            : m.nodes[0].first_child + 1;
    ASSERT_EQ(m.nodes[still].triangles, alone->nodes[0].triangles);
    const auto meshes = [](const model::Model& of, const model::Node& node) {
        std::vector<float> errors;
        for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r)
            if (of.reps[r].kind == model::RepKind::mesh) errors.push_back(of.reps[r].error_m);
        return errors;
    };
    EXPECT_EQ(meshes(m, m.nodes[still]), meshes(*alone, alone->nodes[0]));
    EXPECT_EQ(m.nodes[still].box.min, alone->nodes[0].box.min);
    EXPECT_EQ(m.nodes[still].box.max, alone->nodes[0].box.max);
}

TEST(MotionBake, IsTheSameAtAnyNumberOfWorkers) {
    const test::TemporaryFolder folder;
    std::vector<std::vector<std::byte>> files;
    for (const int workers : {1, 3}) {
        BakeOptions options;
        options.workers = workers;
        const auto m = bake(moving_town(), options, {});
        ASSERT_TRUE(m.ok());
        ASSERT_TRUE(model::write_walk(folder / "m.walk", *m).ok());
        files.push_back(*read_file(folder / "m.walk"));
    }
    EXPECT_EQ(files[0], files[1]);
    EXPECT_TRUE(model::read_walk(folder / "m.walk").ok());
}

TEST(MotionBake, ASceneInWhichNothingMovesIsAsIfItHadNoMotions) {
    const test::TemporaryFolder folder;
    const auto bytes = [&](const importer::Scene& scene) {
        const auto m = bake(scene, {}, {});
        EXPECT_TRUE(m.ok());
        EXPECT_TRUE(model::write_walk(folder / "m.walk", *m).ok());
        return *read_file(folder / "m.walk");
    };
    importer::Scene idle = small_town();
    add_lift(idle, dvec3(0, 5, 0), 4);  // nobody has it
    EXPECT_EQ(bytes(idle), bytes(small_town()));
}

TEST(MotionBake, AllThatMovesAndNothingThatStandsIsBakedToo) {
    importer::Scene scene = moving_town();
    std::erase_if(scene.nodes, [](const importer::Node& n) { return n.motion == importer::none; });
    const auto m = bake(scene, {}, {});
    ASSERT_TRUE(m.ok()) << m.error().text();
    scene.nodes.resize(1);
    const auto one = bake(scene, {}, {});
    ASSERT_TRUE(one.ok()) << one.error().text();
    EXPECT_NE(model::motion_of(*one, one->nodes[0]), model::none);
    EXPECT_EQ(model::MovingNodes(*one).roots(), std::vector<Index>{0});
}

/// Pictures on boxes turn with what they show.
TEST(MotionBake, BoxesOfWhatMovesMoveAlong) {
    importer::Scene scene = moving_town();
    importer::Primitive striped = ball(40, 2);
    const auto mesh = add_mesh(scene, striped, "globe");
    place_moving(scene, mesh, dvec3(60, 20, 20), add_turn(scene, dvec3(60, 20, 20), dvec3(0, 1, 0), 6));
    const auto m = bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    std::size_t boxes = 0;
    for (const model::Node& node : m->nodes) {
        const Index motion = model::motion_of(*m, node);
        for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            EXPECT_EQ(m->placements[m->reps[r].placement].motion, motion);
            boxes += motion != model::none && m->reps[r].kind != model::RepKind::mesh ? 1 : 0;
        }
    }
    EXPECT_GT(boxes, 0U) << "else the test shows nothing";
}

TEST(MotionBake, NoTourLeadsThroughAWay) {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(1);
    const auto floor = add_mesh(scene, grid_surface(30, 30, [](float u, float v) { return vec3(30 * v, 0, 30 * u); }), "floor");
    const auto crate = add_mesh(scene, tube(12, 1, 2), "crate");
    place(scene, floor, dvec3(0));
    for (int i = 0; i < 12; ++i) place(scene, crate, dvec3(3 + 2 * i, 0, i % 2 == 0 ? 2 : 28));
    place_moving(scene, crate, dvec3(4, 0, 15), add_lift(scene, dvec3(22, 0, 0), 8), dvec3(1.5));
    const auto m = bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    ASSERT_EQ(m->tour_kind, "through its free space");
    const model::MotionReach reach = model::reach_of(*m, 0, {dvec3(2.5, 0, 13.5), dvec3(5.5, 3, 16.5)});
    for (const PathSample& sample : m->tour.samples) EXPECT_GT(reach.box.distance(sample.pose.position), 0) << sample.time_s;
}

}  // namespace
}  // namespace surefoot::bake
