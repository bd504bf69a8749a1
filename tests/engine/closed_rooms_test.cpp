// A walk in a closed room draws nothing with the sun; one outside does; and a room with a window does.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "render/bake/bake.hpp"
#include "render/engine.hpp"
#include "render/model/effects_below.hpp"
#include "tests/bake/house_scene.hpp"
#include "tests/bake/moving_scene.hpp"

namespace surefoot {
namespace {

/// An engine of the house that draws nothing.
std::unique_ptr<Engine> engine_of_house() {
    bake::BakeOptions bake_options;
    bake_options.quality = bake::Quality::full;
    auto model = bake::bake(lit::house_scene(), bake_options, {});
    EXPECT_TRUE(model.ok());
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    options.device.viewport = {320, 180};
    auto engine = Engine::open(std::move(*model), model::default_costs(), options);
    EXPECT_TRUE(engine.ok());
    return std::move(*engine);
}

/// What a cut draws.
struct DrawnWith {
    int sun = 0, no_sun = 0;
    std::string names;  ///< of nodes with the sun, and where they are
};

DrawnWith items_with_sun(Engine& engine, const dvec3& at, double turn_rad) {
    Pose pose;
    pose.position = at;
    pose.orientation = glm::angleAxis(turn_rad, dvec3(0, 1, 0));
    prepare::PreparedFrame prepared;
    engine.reserve(prepared);
    engine.prepare({pose, 0, 0}, 0, 0, 0, prepared);
    const model::Model& m = engine.model();
    DrawnWith out;
    for (const select::CutItem& item : engine.select(prepared, 30'000, {}, 0).items) {
        const bool sun = (m.reps[item.rep].effects & model::effect_sun) != 0;
        ++(sun ? out.sun : out.no_sun);
        const Box& box = m.nodes[item.node].box;
        if (sun)
            out.names += fmt::format("{} {:.1f} {:.1f} {:.1f} to {:.1f} {:.1f} {:.1f}; ", m.name_of(m.nodes[item.node]),
                                     box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z);
    }
    return out;
}

TEST(ClosedRooms, AreDrawnWithoutTheSunFromWithin) {
    const auto engine = engine_of_house();
    for (int i = 0; i < 16; ++i) {
        const dvec3 at(-2.55 + 1.2 * std::sin(i), 2, 0.9 * std::cos(2.0 * i));
        const DrawnWith drawn = items_with_sun(*engine, at, 2 * std::numbers::pi * i / 16);
        EXPECT_EQ(drawn.sun, 0) << i << ": " << drawn.names;
        EXPECT_GT(drawn.no_sun, 0) << i;
    }
}

TEST(ClosedRooms, StandApartAlsoWhereSomethingMoves) {
    importer::Scene scene = lit::house_scene();
    const importer::Index ball = bake::add_mesh(scene, bake::ball(12, 1), "ball");
    bake::place_moving(scene, ball, dvec3(30, 3, 30), bake::add_lift(scene, dvec3(0, 12, 0), 10));
    bake::BakeOptions options;
    options.quality = bake::Quality::full;
    const auto moving = bake::bake(scene, options, {});
    ASSERT_TRUE(moving.ok());
    ASSERT_FALSE(moving->motions.empty());
    EXPECT_TRUE(model::has_rooms_apart(*moving));
    EXPECT_FALSE(model::has_rooms_apart(*bake::bake(bake::moving_town(), options, {}))) << "no room is there";
}

TEST(ClosedRooms, AreDrawnWithTheSunFromOutsideAndBehindAWindow) {
    const auto engine = engine_of_house();
    EXPECT_GT(items_with_sun(*engine, dvec3(0, 1.6, 15), 0).sun, 0) << "the outer side";
    EXPECT_GT(items_with_sun(*engine, dvec3(1, 2, 0), -std::numbers::pi / 2).sun, 0) << "towards the window";
}

}  // namespace
}  // namespace surefoot
