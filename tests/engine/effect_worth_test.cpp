// What leaving an effect out changes of the picture, against differences worked out by hand.
#include "render/effect_worth.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/gl/small_models.hpp"
#include "tests/select/count_malloc.hpp"

namespace surefoot {
namespace {

using model::effect_fog, model::effect_lamps, model::effect_shadow, model::effect_sun;
using test::SmallModel;

constexpr std::array<float, 3> sky{0.5F, 0.6F, 0.7F};

float loss_at(const EffectWorth& made, std::size_t group, std::size_t node, float hour) {
    EffectWorth worth = made;  // nothing is worked out yet, or other hours are
    const prepare::EffectLoss loss = worth.at(hour)[group];
    return loss.before[node] + loss.between * (loss.after[node] - loss.before[node]);
}

double mean_square(const dvec3& difference) { return glm::dot(difference, difference) / 3; }

TEST(EffectGroups, ASwitchOwnsWhatNoSmallerOneHas) {
    const std::vector<model::EffectMask> switches{effect_sun | effect_shadow, effect_shadow, effect_fog};
    const std::vector<EffectGroup> groups = groups_of(switches);
    ASSERT_EQ(groups.size(), 3U);
    for (std::size_t i = 0; i < groups.size(); ++i) EXPECT_EQ(groups[i].mask, switches[i]);
    EXPECT_EQ(groups[0].own, effect_sun);
    EXPECT_EQ(groups[1].own, effect_shadow);
    EXPECT_EQ(groups[2].own, effect_fog);
}

TEST(EffectGroups, ReadingTheMapOfWhatMovesIsPricedWithTheSmallestGroupThatIsForSale) {
    constexpr model::EffectMask moving = model::effect_moving_shadow;
    const std::vector<EffectGroup> both =
        groups_for_sale(std::vector<model::EffectMask>{effect_sun | effect_shadow | moving, effect_shadow | moving, effect_fog});
    ASSERT_EQ(both.size(), 3U);
    EXPECT_EQ(both[0].priced, effect_sun);
    EXPECT_EQ(both[1].own, effect_shadow);
    EXPECT_EQ(both[1].priced, effect_shadow | moving);
    EXPECT_EQ(both[2].priced, effect_fog);
    const std::vector<EffectGroup> of_sun = groups_for_sale(std::vector<model::EffectMask>{effect_sun | moving, moving});
    ASSERT_EQ(of_sun.size(), 1U) << "the map is an item by itself";
    EXPECT_EQ(of_sun[0].own, effect_sun);
    EXPECT_EQ(of_sun[0].priced, effect_sun | moving);
}

TEST(EffectWorth, IsTheMeanSquaredDifferenceOfTheColours) {
    SmallModel small;
    const auto lit = small.square(small.material(test::plain(0.5F, 0.4F, 0.2F, 1, effect_sun | effect_fog)), test::at(0, 0, -3));
    const auto bare = small.square(small.material(test::plain(0.5F, 0.4F, 0.2F)), test::at(5, 0, -3), 2);
    const model::Model m = small.finish();
    EffectWorth worth(m, groups_of(std::vector<model::EffectMask>{effect_sun, effect_fog}), {}, sky);
    ASSERT_TRUE(worth.any());
    // The square faces +z: half way from ground to sky, and the sun by its z.
    const dvec3 colour(0.5F, 0.4F, 0.2F), fog(0.5F, 0.6F, 0.7F);
    const dvec3 sun(0.56F, 0.53F, 0.47F), ground(0.34F, 0.32F, 0.30F), up(0.52F, 0.56F, 0.62F);
    const dvec3 shown = colour * (0.5 * (ground + up) + m.sun_direction.z * sun);
    EXPECT_NEAR(loss_at(worth, 0, lit, 0), mean_square(colour - shown), 1e-4);
    EXPECT_NEAR(loss_at(worth, 1, lit, 0), mean_square(fog - shown), 1e-4) << "as if nothing of its colour were left";
    EXPECT_EQ(loss_at(worth, 0, bare, 0), 0) << "it calls for none";
    EXPECT_EQ(loss_at(worth, 1, bare, 0), 0);
    // The bare square has four times the area.
    EXPECT_NEAR(loss_at(worth, 0, 0, 0), 0.2 * mean_square(colour - shown), 1e-4) << "a cluster has the mean of its leaves";
    EXPECT_TRUE(worth.at(0)[0].after.data() == worth.at(0)[0].before.data() && worth.at(0)[1].is_fog && !worth.at(0)[0].is_fog);
    EXPECT_TRUE(worth.at(0)[2].before.empty());
}

TEST(EffectWorth, FollowsTheHour) {
    SmallModel small;
    const auto node =
        small.square(small.material(test::plain(0.5F, 0.4F, 0.2F, 1, effect_sun | effect_lamps)), test::at(0, 0, -3));
    model::Model m = small.finish();
    m.lamp_light.assign(m.vertices.size(), {{255, 255, 128, 0}, {}});
    m.light.max_lamp_light = 0.5F;
    const std::vector<double> hours{0, 6, 12, 18, 24};
    const EffectWorth worth(m, groups_of(std::vector<model::EffectMask>{effect_sun, effect_lamps}), hours, sky);
    EXPECT_GT(loss_at(worth, 1, node, 0), 0.001F) << "lamps by night";
    EXPECT_EQ(loss_at(worth, 1, node, 12), 0) << "and none by day";
    EXPECT_GT(loss_at(worth, 0, node, 0), loss_at(worth, 0, node, 12)) << "without a sun, all is as bright as at no hour";
    EXPECT_NEAR(loss_at(worth, 1, node, 3), 0.5F * (loss_at(worth, 1, node, 0) + loss_at(worth, 1, node, 6)), 1e-6);
    EXPECT_EQ(loss_at(worth, 1, node, 24), loss_at(worth, 1, node, 0));
    const EffectWorth noon(m, groups_of(std::vector<model::EffectMask>{effect_sun, effect_lamps}), std::vector<double>{12}, sky);
    for (const float hour : {0.0F, 12.0F, 23.9F}) EXPECT_EQ(loss_at(noon, 0, node, hour), loss_at(worth, 0, node, 12));
}

TEST(EffectWorth, CountsForMoreWhereAllIsDark) {
    const std::vector<model::EffectMask> switches{effect_lamps};
    const auto loss = [&](float colour_of_other) {
        SmallModel small;
        const auto node =
            small.square(small.material(test::plain(0.1F, 0.1F, 0.1F, 1, effect_sun | effect_lamps)), test::at(0, 0, -3));
        const float c = colour_of_other;
        small.square(small.material(test::plain(c, c, c)), test::at(5, 0, -3));
        model::Model m = small.finish();
        m.lamp_light.assign(m.vertices.size(), {{128, 128, 128, 0}, {}});
        return loss_at(EffectWorth(m, groups_of(switches), std::vector<double>{0}, sky), 0, node, 0);
    };
    // A light of a quarter on a colour of 0.1. Beside a bright thing that is the same by night, hardly anything is darker.
    EXPECT_NEAR(loss(1), 0.00064, 0.00003);
    EXPECT_GT(loss(0), 3 * loss(1));
}

/// As a day goes on and back, lights are worked out ahead; at a jump they are at once. Neither changes what is returned.
TEST(EffectWorth, IsTheSameHoweverTheDayGoesAndAllocatesNothing) {
    SmallModel small;
    const auto material = small.material(test::plain(0.5F, 0.4F, 0.2F, 1, effect_sun | effect_lamps));
    for (int i = 0; i < 700; ++i) small.square(material, test::at(3 * i, 0, -3));
    model::Model m = small.finish();
    m.lamp_light.assign(m.vertices.size(), {{255, 255, 128, 0}, {}});
    m.light.max_lamp_light = 0.5F;
    std::vector<double> hours;
    for (int hour = 0; hour <= 24; ++hour) hours.push_back(hour);
    const EffectWorth fresh(m, groups_of(std::vector<model::EffectMask>{effect_sun, effect_lamps}), hours, sky);
    for (const float step : {0.25F, -0.4F, 7.3F}) {
        EffectWorth day = fresh;
        std::uint64_t allocated = 0;
        for (int i = 0; i < 120; ++i) {
            const float hour = std::fmod(48.0F * 24 + 12 + step * static_cast<float>(i), 24.0F);
            const std::uint64_t before = test::allocations();
            const auto losses = day.at(hour);
            allocated += test::allocations() - before;
            for (const std::size_t group : {0U, 1U}) {
                const prepare::EffectLoss& loss = losses[group];
                ASSERT_EQ(loss.before[5] + loss.between * (loss.after[5] - loss.before[5]), loss_at(fresh, group, 5, hour))
                    << hour;
            }
        }
        EXPECT_EQ(allocated, 0U);
    }
}

/// More leaves than a call works out, and every hour of the day.
EffectWorth worth_of_many(const model::Model& m) {
    std::vector<double> hours;
    for (int hour = 0; hour <= 24; ++hour) hours.push_back(hour);
    return {m, groups_of(std::vector<model::EffectMask>{effect_sun, effect_lamps}), hours, sky};
}

model::Model many_squares() {
    SmallModel small;
    const auto material = small.material(test::plain(0.5F, 0.4F, 0.2F, 1, effect_sun | effect_lamps));
    for (int i = 0; i < 7000; ++i) small.square(material, test::at(3 * i, 0, -3));
    model::Model m = small.finish();
    m.lamp_light.assign(m.vertices.size(), {{255, 255, 128, 0}, {}});
    m.light.max_lamp_light = 0.5F;
    return m;
}

TEST(EffectWorth, ACallDoesABoundedPartAndTheNearestKnownLightCountsMeanwhile) {
    const model::Model m = many_squares();
    const EffectWorth fresh = worth_of_many(m);
    EffectWorth day = fresh;
    EXPECT_EQ(day.at(12)[0].before[5], loss_at(fresh, 0, 5, 12)) << "the first call works out all";
    const float there = loss_at(fresh, 0, 5, 18.5F);
    const auto shown = [&day] {
        const prepare::EffectLoss loss = day.at(18.5F)[0];
        return loss.before[5] + loss.between * (loss.after[5] - loss.before[5]);
    };
    const prepare::EffectLoss first = day.at(18.5F)[0];
    EXPECT_EQ(first.before[5], loss_at(fresh, 0, 5, 13)) << "the nearest known one";
    EXPECT_EQ(first.after[5], first.before[5]);
    EXPECT_NE(first.before[5], there) << "the test would see it";
    int calls = 2;
    while (shown() != there && calls < 100) ++calls;
    EXPECT_GE(calls, 6) << "two lights of 7000 leaves, 2048 a call";
    EXPECT_LE(calls, 9);
    for (std::size_t node : {0U, 5U, 6999U})
        EXPECT_EQ(day.at(18)[0].before[node], loss_at(fresh, 0, node, 18)) << "as if it were done at once";
}

TEST(EffectWorth, ADayThatRunsFastShowsALightThatIsNearIt) {
    const model::Model m = many_squares();
    EffectWorth day = worth_of_many(m);
    for (int i = 0; i <= 40; ++i) static_cast<void>(day.at(0.4F * static_cast<float>(i)));
    const prepare::EffectLoss late = day.at(16.4F)[1];
    EXPECT_LT(late.before[5] + late.between * (late.after[5] - late.before[5]), 0.01F) << "lamps are not those of midnight";
    EXPECT_GT(day.at(0)[1].before[5], 0.01F);
}

TEST(EffectWorth, TheLightsThatComeNextAreWorkedOutFirst) {
    const model::Model m = many_squares();
    const EffectWorth fresh = worth_of_many(m);
    for (const float way : {1.0F, -1.0F}) {
        EffectWorth day = fresh;
        for (int i = 0; i < 40; ++i) static_cast<void>(day.at(12.5F + way * (0.02F * static_cast<float>(i) - 0.4F)));
        const float hour = 12.5F + way * 0.6F;
        const prepare::EffectLoss loss = day.at(hour)[0];
        EXPECT_EQ(loss.before[5] + loss.between * (loss.after[5] - loss.before[5]), loss_at(fresh, 0, 5, hour)) << way;
    }
}

/// Of 31 triangles one alone is lit by lamps: what the leaf loses without them.
float loss_of_lamp_on(std::size_t triangle) {
    SmallModel small;
    std::vector<model::Vertex> vertices;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < 31 * 3; ++i) {
        model::Vertex v{};
        const std::uint32_t row = i / 3;
        v.position[0] = static_cast<float>(row) + (i % 3 == 1 ? 1.0F : 0.0F);
        v.position[1] = i % 3 == 2 ? 1.0F : 0.0F;
        v.normal[2] = 127;
        vertices.push_back(v);
        indices.push_back(i);
    }
    const auto material = small.material(test::plain(0.5F, 0.5F, 0.5F, 1, effect_sun | effect_lamps));
    const auto node = small.object(vertices, indices, material, test::at(0, 0, -3));
    model::Model m = small.finish();
    m.lamp_light.resize(m.vertices.size());
    for (std::size_t corner = 0; corner < 3; ++corner) m.lamp_light[3 * triangle + corner] = {{255, 255, 255, 0}, {}};
    m.light.max_lamp_light = 0.5F;
    return loss_at(EffectWorth(m, groups_of(std::vector<model::EffectMask>{effect_lamps}), std::vector<double>{0}, sky), 0, node,
                   0);
}

TEST(EffectWorth, ShadesSixteenTrianglesOfALeafAtMost) {
    std::size_t shaded = 0;
    for (std::size_t triangle = 0; triangle < 31; ++triangle) shaded += loss_of_lamp_on(triangle) > 0 ? 1 : 0;
    EXPECT_EQ(shaded, 16U);
}

TEST(EffectWorth, OfOthersIsAllThatTheyShowWhereFogIsLeftOut) {
    SmallModel small;
    small.square(small.material(test::plain(0.5F, 0.4F, 0.2F, 1, effect_sun | effect_lamps | effect_fog)), test::at(0, 0, -3));
    model::Model m = small.finish();
    m.lamp_light.assign(m.vertices.size(), {{255, 255, 128, 0}, {}});
    m.light.fog_visibility_m = 50;
    EffectWorth worth(m, groups_of(std::vector<model::EffectMask>{effect_sun, effect_lamps, effect_fog}), {}, sky);
    const float density = model::daylight_of_model(m.sun_direction, m.light).fog_density;
    ASSERT_GT(density, 0);
    for (const model::EffectMask without : {0U, effect_lamps + 0U, effect_fog + 0U, effect_fog | effect_sun}) {
        const auto losses = worth.at(12, without);
        const bool clear = (without & effect_fog) != 0;
        EXPECT_EQ(losses[0].fog_density, clear ? 0 : density) << without;
        EXPECT_EQ(losses[1].fog_density, clear ? 0 : density) << without;
        EXPECT_EQ(losses[2].fog_density, density) << without << ": what fog itself would show";
    }
}

TEST(EffectWorth, OfShadowsIsWhatTheyTakeFromTheSun) {
    SmallModel small;
    const auto node = small.square(small.material(test::plain(1, 1, 1, 1, effect_sun | effect_shadow)), test::at(0, 0, -3));
    model::Model m = small.finish();
    m.sun_direction = dvec3(0, 0, 1);
    m.sun_seen.assign(m.vertices.size(), {{51, 255}});
    const std::vector<EffectGroup> groups = groups_of(std::vector<model::EffectMask>{effect_sun | effect_shadow, effect_shadow});
    const EffectWorth worth(m, groups, {}, sky);
    const dvec3 by_sun(0.56F, 0.53F, 0.47F), half = 0.5 * (dvec3(0.34F, 0.32F, 0.30F) + dvec3(0.52F, 0.56F, 0.62F));
    const dvec3 with = glm::min(half + 0.2 * by_sun, dvec3(1)), without = glm::min(half + by_sun, dvec3(1));
    EXPECT_NEAR(loss_at(worth, 1, node, 0), mean_square(with - without), 1e-4);
    EXPECT_NEAR(loss_at(worth, 0, node, 0), mean_square(with - dvec3(1)), 1e-4) << "without the sun there is no shadow either";
}

}  // namespace
}  // namespace surefoot
