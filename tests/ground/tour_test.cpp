// Default paths: through rooms, above terrain, around things; none through a wall, by the judge.
#include "render/bake/tour.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "tests/ground/judged_scene.hpp"

namespace surefoot::test {

namespace {

bake::Tour tour_of(const JudgedScene& of) { return bake::make_tour(of.ground, box_of_scene(of.scene), {}); }

/// Ten samples a second for a minute, the eye on a straight and even way from each to the next, and nothing in it.
void expect_sound(const JudgedScene& of, const bake::Tour& tour, const std::string& name) {
    const auto& samples = tour.path.samples;
    ASSERT_EQ(samples.size(), 601U) << name;
    EXPECT_NEAR(tour.path.duration_s(), 60, 1e-6) << name;
    std::size_t crossings = 0;
    double worst_turn = 0, length = 0, worst_overlap = 0;
    const model::Walker walker(of.ground, {});
    for (std::size_t i = 1; i < samples.size(); ++i) {
        const Pose &a = samples[i - 1].pose, &b = samples[i].pose;
        crossings += of.judge->crosses(a.position, b.position) ? 1 : 0;
        worst_turn = std::max(worst_turn, std::acos(std::clamp(glm::dot(a.forward(), b.forward()), -1.0, 1.0)) * 10);
        length += glm::length(b.position - a.position);
        if (tour.kind != "through its free space") continue;
        EXPECT_LE(glm::length(b.position - a.position), 0.25) << name << ' ' << i;
        const model::Capsule body = walker.capsule_at(b.position - dvec3(0, 1.7, 0));
        worst_overlap =
            std::max(worst_overlap, of.judge->penetration(body.low + dvec3(0, 0.15, 0), body.length - 0.15, body.radius));
    }
    EXPECT_EQ(crossings, 0U) << name;
    EXPECT_LT(worst_turn, 2.2) << name << ": the head turns at most so many rad a second";
    EXPECT_LE(worst_overlap, 0.05) << name << ": of the shoulders, as the eye's height is evened out on stairs";
    std::printf("%s: %s, %.1f m, head at most %.2f rad/s, shoulders %.3f m\n", name.c_str(), tour.kind.c_str(), length,
                worst_turn, worst_overlap);
}

}  // namespace

TEST(Tour, ThroughRoomsAndStreetsTouchesNothing) {
    for (const auto& [name, scale] : {std::pair{"room", 1.0}, {"garden", 0.3}, {"town", 0.05}}) {
        const JudgedScene of = generated(name, scale);
        const bake::Tour tour = tour_of(of);
        EXPECT_EQ(tour.kind, "through its free space") << name;
        expect_sound(of, tour, name);
    }
}

TEST(Tour, IsTheSameEachTime) {
    const JudgedScene of = generated("room");
    const bake::Tour one = tour_of(of), two = tour_of(of);
    ASSERT_EQ(one.path.samples.size(), two.path.samples.size());
    for (std::size_t i = 0; i < one.path.samples.size(); ++i) {
        ASSERT_EQ(one.path.samples[i].pose.position, two.path.samples[i].pose.position) << i;
        ASSERT_EQ(one.path.samples[i].pose.orientation, two.path.samples[i].pose.orientation) << i;
    }
}

TEST(Tour, GoesAroundWhatHasNoFloorToStandOn) {
    JudgedScene of;
    of.scene.materials.emplace_back();
    importer::Primitive p;
    p.positions = {{0, 0, 0}, {4, 0, 0}, {0, 6, 1}, {0, 0, 4}};
    p.indices = {0, 1, 2, 0, 2, 3, 1, 3, 2};
    of.scene.meshes.push_back({"spike", {p}, {}});
    importer::Node node;
    node.mesh = 0;
    of.scene.nodes.push_back(node);
    of.finish();
    const bake::Tour tour = tour_of(of);
    EXPECT_EQ(tour.kind, "around it");
    expect_sound(of, tour, "spike");
    for (const PathSample& s : tour.path.samples)
        ASSERT_GT(glm::dot(s.pose.forward(), glm::normalize(box_of_scene(of.scene).centre() - s.pose.position)), 0.999);
}

TEST(Tour, GoesInsideOfRoomsAndAroundClosedThings) {
    for (const double side : {6.0, 7.0, 8.0, 9.0}) {
        Triangles room, container;
        add_box(container, {0, 0, 0}, {side, 2.6, side});
        for (const model::GroundTriangle& t : container) room.push_back({t.a, t.c, t.b});
        const Box box{dvec3(0), dvec3(side, 2.6, side)};
        const bake::Tour inside = bake::make_tour(ground_of(room), box, {}),
                         around = bake::make_tour(ground_of(container), box, {});
        EXPECT_EQ(inside.kind, "through its free space") << side;
        for (const PathSample& s : inside.path.samples) ASSERT_NEAR(s.pose.position.y, 1.7, 1e-3) << side;
        EXPECT_EQ(around.kind, "around it") << side;
    }
}

// Thirty floors of 40 m: the window is smaller, so that the path is found in seconds.
TEST(Nightly, TourOfATowerIsWithinOneOfItsFloors) {
    Triangles t;
    for (int i = 0; i < 30; ++i) add_box(t, {0, 3.0 * i - 0.2, 0}, {40, 3.0 * i, 40});
    for (int i = 0; i < 30; ++i) add_box(t, {9, 3.0 * i, 9}, {11, 3.0 * i + 2.6, 11});
    const bake::Tour tour = bake::make_tour(ground_of(t), {dvec3(0, -0.2, 0), dvec3(40, 89.8, 40)}, {});
    EXPECT_EQ(tour.kind, "through its free space");
    for (const PathSample& s : tour.path.samples) ASSERT_NEAR(s.pose.position.y, tour.path.samples[0].pose.position.y, 1e-3);
}

TEST(Tour, OfNothingAndOfTinyThingsIsAPathToo) {
    EXPECT_EQ(bake::make_tour({}, {dvec3(0), dvec3(0)}, {}).path.samples.size(), 601U);
    EXPECT_EQ(bake::make_tour({}, {dvec3(0), dvec3(1e-3)}, {}).kind, "around it");
}

TEST(Nightly, ToursOfFilesTouchNothing) {
    const JudgedScene town = generated("town");
    const bake::Tour through = tour_of(town);
    EXPECT_EQ(through.kind, "through its free space");
    expect_sound(town, through, "town");
    constexpr std::string_view inside = "through its free space", above = "above its ground";
    for (const auto& [file, kind] : {std::pair{"interior/hospital/hospital_three_floors.glb", inside},
                                     {"outdoor/candela-city/candela_city.glb", inside},
                                     {"interior/ravenbridge-mansion/ravenbridge_mansion.glb", inside},
                                     {"outdoor/cocoa-temple/cocoa_temple.glb", inside},
                                     {"outdoor/flightgear-keflavik/keflavik.glb", above}}) {
        const auto of = imported(file);
        if (!of) GTEST_SKIP() << "SUREFOOT_DATA is not set, or lacks " << file;
        const bake::Tour tour = tour_of(*of);
        EXPECT_EQ(tour.kind, kind) << file;
        expect_sound(*of, tour, file);
    }
}

}  // namespace surefoot::test
