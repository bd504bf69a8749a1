// The light of lamps at a point: laws by hand, walls, and cells beside a plain loop.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/bake/lamp_field.hpp"
#include "render/bake/lit_vertices.hpp"
#include "rt/base/random.hpp"
#include "tests/bake/lit_scenes.hpp"

namespace surefoot {
namespace {

const dvec3 upwards(0, 1, 0);
constexpr double lift_m = bake::ray_lift_m;

/// In the open: nothing hides anything.
double lux_of_one(const importer::Lamp& lamp, const dvec3& at, const dvec3& normal = upwards) {
    const model::Ground none;
    const bake::RayTree nothing(none);
    return bake::LampField({lamp}, nothing).lux_at(at - lift_m * normal, normal).g;
}

importer::Lamp spot(double inner_deg, double outer_deg) {
    importer::Lamp lamp = lit::bulb(dvec3(0, 4, 0), 100);
    lamp.cos_inner = std::cos(inner_deg * std::numbers::pi / 180);
    lamp.cos_outer = std::cos(outer_deg * std::numbers::pi / 180);
    return lamp;
}

/// On the ground, this far from straight below a lamp in 4 m.
dvec3 at_angle(double degrees) { return {4 * std::tan(degrees * std::numbers::pi / 180), 0, 0}; }

TEST(LampField, FallsWithTheSquareOfTheDistanceAndTheCosine) {
    const importer::Lamp lamp = lit::bulb(dvec3(0, 4, 0), 100);
    EXPECT_NEAR(lux_of_one(lamp, dvec3(0)), 100 / 16.0, 1e-9);
    EXPECT_NEAR(lux_of_one(lamp, dvec3(3, 0, 0)), 100 / 25.0 * 0.8, 1e-9);
    EXPECT_NEAR(lux_of_one(lamp, dvec3(3, 0, 0), dvec3(-1, 0, 0)), 100 / 25.0 * 0.6, 1e-9);
    EXPECT_EQ(lux_of_one(lamp, dvec3(3, 0, 0), dvec3(1, 0, 0)), 0) << "it looks away";
    EXPECT_EQ(lux_of_one(lamp, dvec3(0, 5, 0)), 0) << "the lamp is below";
    const model::Ground none;
    const bake::RayTree nothing(none);
    importer::Lamp red = lamp;
    red.colour = {1, 0.5F, 0.25F};
    const dvec3 lux = bake::LampField({red, red}, nothing).lux_at(dvec3(0, -lift_m, 0), upwards);
    EXPECT_NEAR(lux.r, 2 * 100 / 16.0, 1e-9);
    EXPECT_NEAR(lux.g, 100 / 16.0, 1e-9);
    EXPECT_NEAR(lux.b, 0.5 * 100 / 16.0, 1e-9);
    EXPECT_FALSE(bake::LampField({red}, nothing).empty());
    EXPECT_TRUE(bake::LampField({}, nothing).empty());
    EXPECT_EQ(bake::LampField({}, nothing).lux_at(dvec3(1), upwards), dvec3(0));
}

TEST(LampField, EndsSoftlyAtItsRangeAndWhereItIsDark) {
    importer::Lamp lamp = lit::bulb(dvec3(0, 4, 0), 100);
    lamp.range_m = 10;
    EXPECT_NEAR(lux_of_one(lamp, dvec3(3, 0, 0)), 100 / 25.0 * 0.8 * (1 - 1 / 16.0), 1e-9);
    EXPECT_GT(lux_of_one(lamp, dvec3(9.1, 0, 0)), 0);
    EXPECT_LT(lux_of_one(lamp, dvec3(9.1, 0, 0)), 0.05);
    EXPECT_EQ(lux_of_one(lamp, dvec3(9.3, 0, 0)), 0);
    lamp.range_m = 0;
    EXPECT_GT(lux_of_one(lamp, dvec3(0, -66, 0)), 0);
    EXPECT_EQ(lux_of_one(lamp, dvec3(0, -67, 0)), 0) << "100 cd give 0.02 lx over 70.7 m";
}

TEST(LampField, OfASpotIsFullWithinTheInnerConeAndNothingBeyondTheOuter) {
    const importer::Lamp soft = spot(20, 40);
    const importer::Lamp open = lit::bulb(soft.at, 100);
    const auto share = [&](const importer::Lamp& lamp, double degrees) {
        return lux_of_one(lamp, at_angle(degrees)) / lux_of_one(open, at_angle(degrees));
    };
    EXPECT_NEAR(share(soft, 0), 1, 1e-9);
    EXPECT_NEAR(share(soft, 19.9), 1, 1e-9);
    const double between = (std::cos(std::numbers::pi / 6) - soft.cos_outer) / (soft.cos_inner - soft.cos_outer);
    EXPECT_NEAR(share(soft, 30), between * between, 1e-9);
    EXPECT_GT(share(soft, 39.9), 0);
    EXPECT_EQ(share(soft, 40.1), 0);
    EXPECT_EQ(share(spot(30, 30), 30.01), 0) << "a hard edge";
    EXPECT_NEAR(share(spot(30, 30), 29.99), 1, 1e-9);
    importer::Lamp sideways = soft;
    sideways.towards = {1, 0, 0};
    EXPECT_EQ(lux_of_one(sideways, dvec3(0)), 0);
    EXPECT_NEAR(lux_of_one(sideways, dvec3(5, 4, 0), dvec3(-1, 0, 0)), 100 / 25.0, 1e-9);
}

TEST(LampField, DoesNotComeThroughAWallButOutOfItsHousing) {
    importer::Scene scene;
    lit::put(scene, lit::sheet(vec3(2, 2, 0), vec3(0, 2, 0), vec3(0, 0, 2)), "wall", dvec3(0));
    scene.lamps = {lit::bulb(dvec3(0, 2, 0), 100)};
    const auto rays = bake::make_light_rays(scene, {});
    EXPECT_GT(rays->lamps.lux_at(dvec3(1, 0, 0), upwards).r, 1) << "before it";
    EXPECT_EQ(rays->lamps.lux_at(dvec3(3, 1, 0), upwards).r, 0) << "behind it";
    EXPECT_GT(rays->lamps.lux_at(dvec3(3, 1, 9), upwards).r, 0) << "past it";
    scene.lamps[0].at.x = 1.8;
    EXPECT_GT(bake::make_light_rays(scene, {})->lamps.lux_at(dvec3(3, 1, 0), upwards).r, 1) << "a wall within 0.3 m is its own";
}

/// KHR_lights_punctual, without anything that hides.
double plain_lux(const importer::Lamp& lamp, const dvec3& from, const dvec3& normal) {
    const double distance = glm::length(lamp.at - from), reach = std::sqrt(lamp.candela / 0.02);
    if (distance >= std::min(reach, lamp.range_m) || distance <= 0) return 0;
    const double falling = std::max(glm::dot(normal, lamp.at - from) / distance, 0.0);
    const double near_m = std::max(distance, 0.1);
    return lamp.candela * falling / (near_m * near_m) * (1 - std::pow(distance / lamp.range_m, 4));
}

TEST(LampField, OfManyLampsIsTheirSumWhereverTheyReach) {
    Random random(5);
    std::vector<importer::Lamp> lamps;
    for (int i = 0; i < 200; ++i) {
        lamps.push_back(lit::bulb({random.range(-300, 300), random.range(-40, 40), random.range(-300, 300)}, 1e4));
        if (i % 4 == 0) lamps.back().at = 16.0 * glm::round(lamps.back().at / 16.0);  // where cells meet
        lamps.back().range_m = 0.5 * std::pow(1000.0, i / 199.0);
    }
    const model::Ground none;
    const bake::RayTree nothing(none);
    const bake::LampField field(lamps, nothing);
    int lit_by_near = 0;
    for (int i = 0; i < 1000; ++i) {
        dvec3 at(random.range(-320, 320), random.range(-45, 45), random.range(-320, 320));
        const importer::Lamp& near = lamps[static_cast<std::size_t>(random.range(0, 100))];
        const dvec3 way = glm::normalize(dvec3(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)));
        if (i % 3 == 0) at = near.at + near.range_m * random.range(0, 1.01) * way;  // of small ones, at their rims too
        if (i % 5 == 0) at[i % 3] = 16.0 * std::round(at[i % 3] / 16.0) - (i % 2 == 0 ? lift_m / 2 : 0);
        const dvec3 normal = i % 2 == 0 ? dvec3(i % 3 == 0 ? 1 : 0, i % 3 == 1 ? 1 : 0, i % 3 == 2 ? 1 : 0) : -way;
        double sum = 0, of_near = 0;
        for (const importer::Lamp& lamp : lamps) {
            const double lux = plain_lux(lamp, at + lift_m * normal, normal);
            sum += lux;
            if (lamp.range_m < 56) of_near += lux;
        }
        lit_by_near += of_near > 0 ? 1 : 0;
        EXPECT_NEAR(field.lux_at(at, normal).g, sum, 1e-6 * std::max(sum, 1.0)) << i;
    }
    EXPECT_GT(lit_by_near, 100);
}

TEST(LampField, IsFoundAcrossTheBorderOfACell) {
    importer::Lamp lamp = lit::bulb(dvec3(16 + 0.45, 0, 0), 100);
    lamp.range_m = 0.44;  // in the cell from 16 m on alone
    const dvec3 east(1, 0, 0);
    const double lux = plain_lux(lamp, dvec3(16.015, 0, 0), east);
    ASSERT_GT(lux, 1);
    EXPECT_NEAR(lux_of_one(lamp, dvec3(16.015, 0, 0), east), lux, 1e-9) << "the surface lies in the cell before";
}

TEST(LampField, AtALampAndWithoutANormalIsFinite) {
    const importer::Lamp lamp = lit::bulb(dvec3(-5, 3, -7), 1e9);
    const model::Ground none;
    const bake::RayTree nothing(none);
    const bake::LampField field({lamp}, nothing);
    for (const dvec3& at : {lamp.at, lamp.at - lift_m * upwards, lamp.at - 1e-9 * upwards}) {
        const dvec3 lux = field.lux_at(at, upwards);
        EXPECT_TRUE(std::isfinite(lux.r) && lux.r >= 0) << lux.r;
    }
    EXPECT_EQ(field.lux_at(dvec3(0), dvec3(0)), dvec3(0));
    EXPECT_EQ(field.lux_at(dvec3(0), dvec3(NAN)), dvec3(0));
    EXPECT_EQ(field.lux_at(dvec3(1e300), upwards), dvec3(0));
}

TEST(LampField, ShownLightRisesFromBlackToWhite) {
    EXPECT_EQ(bake::shown_light(dvec3(0)), vec3(0));
    EXPECT_EQ(bake::shown_light(dvec3(-1)), vec3(0));
    float before = 0;
    for (double lux = 0.001; lux < 1e5; lux *= 1.3) {
        const vec3 shown = bake::shown_light(dvec3(lux, 0, 2 * lux));
        EXPECT_GE(shown.r, before);
        EXPECT_LE(shown.b, 1.0F);
        EXPECT_GE(shown.b, shown.r);
        EXPECT_EQ(shown.g, 0.0F);
        before = shown.r;
    }
    EXPECT_NEAR(bake::shown_light(dvec3(10)).r, std::pow(1 - std::exp(-1.0), 1 / 2.2), 1e-6);
    EXPECT_NEAR(before, 1, 1e-6);
}

}  // namespace
}  // namespace surefoot
