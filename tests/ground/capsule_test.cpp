// Capsules against triangles: distances and first contacts as the exact judge finds them.
#include "render/model/ground/capsule.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "render/import/scene.hpp"
#include "rt/base/random.hpp"
#include "tests/ground/exact_ground.hpp"

namespace surefoot::model {

namespace {

dvec3 any(Random& random, double reach) { return any_in(random, dvec3(-reach), dvec3(reach)); }

/// The judge's ground of one triangle.
exact::ExactGround judged(const GroundTriangle& t) {
    importer::Scene scene;
    scene.materials.emplace_back();
    importer::Primitive primitive;
    for (const dvec3& p : {t.a, t.b, t.c}) primitive.positions.emplace_back(p);
    primitive.indices = {0, 1, 2};
    scene.meshes.push_back({"one", {primitive}, {}});
    importer::Node node;
    node.mesh = 0;
    node.walk = importer::WalkRule::block;
    scene.nodes.push_back(node);
    return {scene, exact::blocking_triangles(scene)};
}

/// Corners that a float holds.
GroundTriangle any_triangle(Random& random) {
    GroundTriangle t{any(random, 2), any(random, 2), any(random, 2)};
    if (random.below(4) == 0) t.b = t.a + any(random, 0.01);    // a sliver
    if (random.below(6) == 0) t.c.y = t.b.y = t.a.y;            // a floor
    if (random.below(6) == 0) t.b = {t.a.x, t.a.y + 1, t.a.z};  // an upright edge
    for (dvec3* p : {&t.a, &t.b, &t.c}) *p = dvec3(vec3(*p));
    return t;
}

}  // namespace

TEST(Capsule, IsAsFarFromATriangleAsTheJudgeSays) {
    Random random(1);
    for (int i = 0; i < 4000; ++i) {
        const GroundTriangle t = any_triangle(random);
        const Capsule capsule{any(random, 2), random.below(5) == 0 ? 0.0 : random.range(0, 2), 0.3};
        const Separation s = separation(capsule, t);
        ASSERT_NEAR(s.distance, judged(t).distance(capsule.low, capsule.length, 100), 1e-9) << i;
        ASSERT_NEAR(glm::length(s.away), 1, 1e-9) << i;
    }
}

TEST(Capsule, TouchesWhereTheJudgeSays) {
    Random random(2);
    int touched = 0, missed = 0;
    for (int i = 0; i < 4000; ++i) {
        const GroundTriangle t = any_triangle(random);
        const Capsule capsule{any(random, 2), random.range(0, 1.5), 0.3};
        const exact::ExactGround judge = judged(t);
        if (judge.distance(capsule.low, capsule.length, 100) <= capsule.radius) continue;  // begins inside: the next test
        const dvec3 move = any(random, 3);
        const Contact contact = first_contact(capsule, move, t);
        const double share = judge.first_contact(capsule.low, capsule.length, capsule.radius, move);
        if (share > 1 || contact.share > 1) {
            ++missed;
            ASSERT_TRUE(share > 1 && contact.share > 1) << i << ": one touches";
            continue;
        }
        ++touched;
        ASSERT_NEAR(contact.share * glm::length(move), share * glm::length(move), 1e-4) << i;
        ASSERT_LE(contact.share, share + 1e-9) << i << ": never beyond the first contact";
        ASSERT_LT(glm::dot(contact.away, move), 0) << i;
    }
    EXPECT_GT(touched, 250);
    EXPECT_GT(missed, 500);
}

TEST(Capsule, ThatOverlapsMayLeaveButNotGoDeeper) {
    const GroundTriangle wall{{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}};
    const Capsule capsule{{0, -0.5, 0.2}, 1, 0.3};
    EXPECT_GT(first_contact(capsule, {0, 0, 1}, wall).share, 1) << "away";
    EXPECT_EQ(first_contact(capsule, {0, 0, -1}, wall).share, 0) << "deeper";
    EXPECT_GT(first_contact(capsule, {1, 0, 0}, wall).share, 1) << "along";
}

TEST(Capsule, HeightsAreFoundOnEdgesAndCorners) {
    const GroundTriangle t{{0, 1, 0}, {4, 1, 0}, {0, 3, 4}};
    EXPECT_DOUBLE_EQ(height_at(t, 0, 0), 1);
    EXPECT_DOUBLE_EQ(height_at(t, 2, 0), 1);
    EXPECT_DOUBLE_EQ(height_at(t, 0, 4), 3);
    EXPECT_DOUBLE_EQ(height_at(t, 0, 2), 2);
    EXPECT_EQ(height_at(t, 2.1, 2.1), -std::numeric_limits<double>::infinity());
    EXPECT_EQ(height_at({{0, 0, 0}, {0, 1, 0}, {0, 1, 1}}, 0, 0), -std::numeric_limits<double>::infinity()) << "upright";
}

}  // namespace surefoot::model
