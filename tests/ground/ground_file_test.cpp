// The ground in a .walk file: comes back as it went out; damage is an error by name, or harmless.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

#include "render/bake/ground.hpp"
#include "render/model/ground/near.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/random.hpp"
#include "tests/ground/grounds.hpp"
#include "tests/model/two_triangles.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot::model {

namespace {

/// Boxes, some of them instances of one mesh, and a floor wide enough for 32 bits.
Ground sample_ground() {
    test::Triangles once, shared;
    test::add_floor(once, -300, 300, -300, 300, 0);
    Random random(5);
    for (int i = 0; i < 40; ++i) {
        const dvec3 at = any_in(random, dvec3(-20, 0, -20), dvec3(20, 2, 20));
        test::add_box(once, at, at + any_in(random, dvec3(0.1), dvec3(2)));
    }
    test::add_box(shared, dvec3(-1), dvec3(1));
    Ground ground;
    bake::append(ground, bake::build_tree(once, 1.0 / 4096));
    bake::append(ground, bake::build_tree(shared, 1.0 / 4096));
    for (int i = 0; i < 9; ++i) {
        const auto turn = mat3(dmat3(glm::mat3_cast(glm::angleAxis(0.7 * i, dvec3(0, 1, 0)))));
        ground.instances.push_back({any_in(random, dvec3(-30), dvec3(30)), turn, 1});
    }
    bake::order_instances(ground);
    return ground;
}

std::vector<GroundTriangle> triangles_near(const Ground& ground, const Box& box) {
    std::vector<GroundTriangle> found;
    for_triangles_near(ground, box, [&](const GroundTriangle& t) { found.push_back(t); });
    return found;
}

}  // namespace

TEST(GroundFile, ComesBackAsItWentOut) {
    Model model = two_triangles();
    model.ground = sample_ground();
    const test::TemporaryFolder folder;
    ASSERT_TRUE(write_walk(folder / "m.walk", model).ok());
    const auto read = read_walk(folder / "m.walk");
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->ground.triangles, model.ground.triangles);
    EXPECT_EQ(read->ground.bytes, model.ground.bytes);
    const auto before = triangles_near(model.ground, {dvec3(-40), dvec3(40)});
    const auto after = triangles_near(read->ground, {dvec3(-40), dvec3(40)});
    ASSERT_EQ(before.size(), after.size());
    EXPECT_EQ(before.size(), 2U + 40 * 12 + 9 * 12);
    for (std::size_t i = 0; i < before.size(); ++i) ASSERT_EQ(before[i].a, after[i].a) << i;
}

TEST(TourFile, ComesBackAsItWentOutAndIsChecked) {
    Model model = two_triangles();
    model.tour.samples = {{0, {{1, 2, 3}, {1, 0, 0, 0}, 1}}, {2.5, {{4, 5, 6}, {0, 0, 1, 0}, 1.2}}};
    model.tour_kind = "around it";
    const test::TemporaryFolder folder;
    ASSERT_TRUE(write_walk(folder / "m.walk", model).ok());
    const auto read = read_walk(folder / "m.walk");
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->tour_kind, "around it");
    ASSERT_EQ(read->tour.samples.size(), 2U);
    EXPECT_EQ(read->tour.samples[1].time_s, 2.5);
    EXPECT_EQ(read->tour.samples[1].pose.position, dvec3(4, 5, 6));
    EXPECT_EQ(read->tour.samples[1].pose.orientation, dquat(0, 0, 1, 0));
    EXPECT_EQ(read->tour.samples[1].pose.fov_y_rad, 1.2);
    const auto refused = [&](auto spoil) {
        Model bad = model;
        spoil(bad.tour.samples[1]);
        return !validate(bad).ok();
    };
    EXPECT_TRUE(refused([](PathSample& s) { s.time_s = 0; }));
    EXPECT_TRUE(refused([](PathSample& s) { s.pose.position.x = std::numeric_limits<double>::quiet_NaN(); }));
    EXPECT_TRUE(refused([](PathSample& s) { s.pose.orientation.y = 3; }));
    EXPECT_TRUE(refused([](PathSample& s) { s.pose.fov_y_rad = 0; }));
}

TEST(GroundFile, WithoutASectionTheModelHasNoGround) {
    const test::TemporaryFolder folder;
    ASSERT_TRUE(write_walk(folder / "m.walk", two_triangles()).ok());
    const auto read = read_walk(folder / "m.walk");
    ASSERT_TRUE(read.ok());
    EXPECT_TRUE(read->ground.empty());
    EXPECT_TRUE(triangles_near(read->ground, {dvec3(-40), dvec3(40)}).empty());
}

TEST(GroundTree, FindsWhatABoxMeetsAndNothingIsLost) {
    const Ground ground = sample_ground();
    const auto all = triangles_near(ground, {dvec3(-1e4), dvec3(1e4)});
    Random random(6);
    std::size_t met = 0;
    for (int i = 0; i < 100; ++i) {
        const dvec3 at = any_in(random, dvec3(-25, -1, -25), dvec3(25, 2, 25));
        const Box box{at, at + any_in(random, dvec3(0), dvec3(4))};
        const auto found = triangles_near(ground, box);
        for (const GroundTriangle& t : found) ASSERT_TRUE(ground_tree::overlap(box, ground_tree::box_of(t))) << i;
        for (const GroundTriangle& t : all) {
            bool meets = false;  // at one of 400 points
            for (int k = 0; k < 400 && !meets; ++k) {
                const double u = random.unit(), v = random.range(0, 1 - u);
                const dvec3 p = t.a + u * (t.b - t.a) + v * (t.c - t.a);
                meets = ground_tree::overlap(box, {p, p});
            }
            if (!meets) continue;
            ++met;
            ASSERT_TRUE(std::any_of(found.begin(), found.end(), [&](const GroundTriangle& f) {
                return f.a == t.a && f.b == t.b && f.c == t.c;
            })) << i;
        }
    }
    EXPECT_GT(met, 50U);
}

TEST(GroundTree, TakesSixteenBytesATriangleAndKeepsAQuarterOfAMillimetre) {
    auto made = scenes::generate("room", 1, 1);
    const Ground ground = bake::make_ground(made->scene, {});
    const double instances = 64.0 * static_cast<double>(ground.instances.size());
    EXPECT_LE((static_cast<double>(bytes_of(ground)) - instances) / static_cast<double>(ground.triangles), 16.0);
    test::Triangles one{{{0.1, 0.2, 0.3}, {1.7, 0.4, 0.5}, {0.3, 1.9, 0.7}}};
    const auto back = triangles_near(test::ground_of(one), {dvec3(-9), dvec3(9)});
    ASSERT_EQ(back.size(), 1U);
    EXPECT_LT(glm::length(back[0].a - one[0].a), 2.2e-4);
    EXPECT_LT(glm::length(back[0].c - one[0].c), 2.2e-4);
}

TEST(GroundFile, DamageIsAnErrorOrHarmless) {
    const Ground good = sample_ground();
    ASSERT_TRUE(validate(good).ok());
    Random random(7);
    int refused = 0;
    for (int i = 0; i < 3000; ++i) {
        Ground bad = good;
        const auto spoil = [&](void* record, std::size_t size) {
            const auto value = static_cast<unsigned char>(random.next());
            static_cast<unsigned char*>(record)[random.below(static_cast<std::uint32_t>(size))] = value;
        };
        const auto any = [&](auto& list) -> auto& { return list[random.below(static_cast<std::uint32_t>(list.size()))]; };
        switch (random.below(5)) {
            case 0: {
                GroundBlock& block = any(bad.blocks);
                block.first_byte ^= 1U << random.below(32);
                if (random.below(2) == 0) block.corners = static_cast<std::uint8_t>(random.next());
                if (random.below(2) == 0) block.triangles = static_cast<std::uint8_t>(random.next());
                if (random.below(2) == 0) block.wide = !block.wide;
                break;
            }
            case 1:
                spoil(&any(bad.boxes), sizeof(GroundBox));
                break;
            case 2:
                spoil(bad.bytes.data(), bad.bytes.size());
                break;
            case 3:
                spoil(&any(bad.meshes), sizeof(GroundMesh));
                break;
            default:
                spoil(&any(bad.instances), sizeof(GroundInstance));
                break;
        }
        if (!validate(bad).ok()) {
            ++refused;
            continue;
        }
        index_instances(bad);
        triangles_near(bad, {dvec3(-5), dvec3(5)});  // whatever it finds, it ends and stays in its arrays
        Walker walker(bad, {});
        test::push(walker, {0, 1.7, 0}, {1, 0, 0.3}, 0.02);
    }
    EXPECT_GT(refused, 300);
}

TEST(GroundFile, TwoBakesOfOneSceneHaveTheSameGround) {
    auto made = scenes::generate("garden", 0.3, 1);
    const Ground one = bake::make_ground(made->scene, {}), two = bake::make_ground(made->scene, {});
    EXPECT_EQ(one.bytes, two.bytes);
    ASSERT_EQ(one.boxes.size(), two.boxes.size());
    EXPECT_EQ(std::memcmp(one.boxes.data(), two.boxes.data(), one.boxes.size() * sizeof(GroundBox)), 0);
}

}  // namespace surefoot::model
