// Every stair of a scene, up and down: found by the judge, walked by a script.
#include <gtest/gtest.h>

#include "tests/ground/judged_scene.hpp"
#include "tests/ground/stairs.hpp"

namespace surefoot::test {

namespace {

/// How many flights there are, and how many have room for a body on every tread: those were climbed and descended.
struct Flights {
    std::size_t found = 0, open = 0;
    double highest_m = 0;      ///< climbed on one flight
    std::size_t of_20_cm = 0;  ///< flights whose steps are 0.20 m
};

/// Walks all flights. Those that are not open are walked up to where the room ends, and printed; their way down is not judged.
Flights climb_all(const JudgedScene& of, const std::string& name) {
    const std::vector<Flight> flights = find_flights(*of.judge, box_of_scene(of.scene));
    const model::Walker walker(of.ground, {});
    Flights result{flights.size(), 0};
    for (const Flight& flight : flights) {
        const std::size_t open = open_treads(*of.judge, walker, flight);
        const Climbed climbed = climb(of.ground, flight);
        const dvec3& at = flight.bottom;
        result.highest_m = std::max(result.highest_m, climbed.up - at.y);
        const double rise_m = (flight.top.y - at.y) / static_cast<double>(flight.treads.size());
        result.of_20_cm += std::abs(rise_m - 0.2) < 0.005 ? 1 : 0;
        const std::string where = name + ", flight of " + std::to_string(flight.treads.size()) + " from " + std::to_string(at.x) +
                                  ' ' + std::to_string(at.y) + ' ' + std::to_string(at.z) + " to " + std::to_string(flight.top.y);
        if (open == flight.treads.size()) {
            EXPECT_GE(climbed.up, flight.top.y - 0.01) << where;
            EXPECT_LE(climbed.down, at.y + 0.01) << where;
            EXPECT_EQ(climbed.returns, 0U) << where;
            ++result.open;
            continue;
        }
        // On the way to the last tread with room the head comes under what closes the stair.
        const double goal = open > 1 ? flight.treads[open - 2].y : at.y;
        EXPECT_GE(climbed.up, goal - 0.01) << where;
        std::printf("  closed: %s: a body has room on %zu treads, got to %.2f m, and was put back %d times\n", where.c_str(),
                    open, climbed.up, static_cast<int>(climbed.returns));
    }
    std::printf("%s: %zu flights, %zu of them open, %zu with steps of 0.20 m; up to %.2f m climbed\n", name.c_str(), result.found,
                result.open, result.of_20_cm, result.highest_m);
    return result;
}

/// Floors and steps of squares.
struct Squares {
    importer::Primitive p;

    void add(const vec3& a, const vec3& b, const vec3& c, const vec3& d) {
        const auto first = static_cast<std::uint32_t>(p.positions.size());
        p.positions.insert(p.positions.end(), {a, b, c, d});
        for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) p.indices.push_back(first + i);
    }
    /// From x = 2 up, 0.28 m wide and 0.18 m high each; the last is 2 m wide.
    void add_steps(float z, int count) {
        for (int i = 0; i < count; ++i) {
            const float x0 = 2 + 0.28F * static_cast<float>(i), x1 = x0 + (i + 1 == count ? 2.0F : 0.28F),
                        y0 = 0.18F * static_cast<float>(i), y1 = y0 + 0.18F;
            add({x0, y1, z}, {x0, y1, z + 1.2F}, {x1, y1, z + 1.2F}, {x1, y1, z});
            add({x0, y0, z}, {x0, y0, z + 1.2F}, {x0, y1, z + 1.2F}, {x0, y1, z});
        }
    }
    JudgedScene judged() const {
        JudgedScene of;
        of.scene.materials.emplace_back();
        of.scene.meshes.push_back({"squares", {p}, {}});
        importer::Node node;
        node.mesh = 0;
        of.scene.nodes.push_back(node);
        of.finish();
        return of;
    }
};

/// A floor, a flight of ten steps up from it, a ramp, and a flight of two.
JudgedScene floor_with_stairs() {
    Squares of;
    of.add({-2, 0, -6}, {-2, 0, 6}, {8, 0, 6}, {8, 0, -6});
    of.add_steps(0, 10);
    of.add_steps(-2, 2);
    of.add({2, 0, 3}, {2, 0, 4}, {6, 2, 4}, {6, 2, 3});
    return of.judged();
}

}  // namespace

TEST(Stairs, AreFoundAndClimbed) {
    const Flights flights = climb_all(floor_with_stairs(), "squares");
    EXPECT_EQ(flights.found, 1U) << "neither the ramp nor the two steps";
    EXPECT_EQ(flights.open, 1U);
}

// On the fourth step the head is half a millimetre below a slab that is level but for a tenth of a millimetre a metre.
TEST(Stairs, WhoStandsCloseUnderASlabGetsDownAgain) {
    for (const float tilt : {-0.0005F, 0.0F, 0.0005F}) {
        Squares squares;
        squares.add({-2, 0, -6}, {-2, 0, 6}, {8, 0, 6}, {8, 0, -6});
        squares.add_steps(0, 10);
        const float y = 0.72F + 1.8F + 0.0007F;
        squares.add({1, y - tilt, 0}, {6, y + tilt, 0}, {6, y + tilt, 1.2F}, {1, y - tilt, 1.2F});
        const JudgedScene of = squares.judged();
        model::Walker walker(of.ground, {});
        ASSERT_NEAR(model::crown_m + model::Body{}.eye_m, 1.8, 1e-9);
        dvec3 eye(0, 1.7, 0.6);
        const auto push = [&](double way, double seconds) {
            for (double t = 0; t < seconds; t += tick_s) eye = walker.walk(eye, eye + dvec3(1.4 * tick_s * way, 0, 0), tick_s);
        };
        push(1, 6);
        EXPECT_NEAR(walker.feet().y, 0.72, 0.001) << tilt << ": as far as the head fits";
        EXPECT_EQ(walker.returns(), 0U) << tilt << ": the way down is free";
        push(-1, 3);
        EXPECT_NEAR(walker.feet().y, 0, 0.001) << tilt;
    }
}

TEST(Nightly, StairsOfTheTownAreClimbedAndDescended) {
    const Flights flights = climb_all(generated("town"), "town");
    EXPECT_GE(flights.found, 107U);
    EXPECT_GE(flights.open, 99U);
}

TEST(Nightly, StairsOfTheHospitalAreClimbedAsFarAsABodyFits) {
    const auto of = imported("interior/hospital/hospital_three_floors.glb");
    if (!of) GTEST_SKIP() << "SUREFOOT_DATA is not set, or lacks the hospital";
    const Flights flights = climb_all(*of, "hospital");
    EXPECT_GE(flights.found, 59U);
    EXPECT_GE(flights.open, 2U) << "slabs close the others above";
    EXPECT_EQ(flights.of_20_cm, flights.found);
    EXPECT_GE(flights.highest_m, 2.7);
}

}  // namespace surefoot::test
