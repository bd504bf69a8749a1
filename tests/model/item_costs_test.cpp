// What an item is predicted to cost: every state class of its parts by its own cell, near triangle for triangle.
#include "render/model/item_costs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/model/two_triangles.hpp"

namespace surefoot::model {
namespace {

constexpr Viewport picture{640, 480};

/// raster_us = rate * pixels, submit_us = triangles: 2^0 to 2^12 and 2^0 to 2^24.
CostGrid grid(EffectMask effects, float rate) {
    CostGrid made{effects, 13, 25, {}};
    for (int t = 0; t < 13; ++t)
        for (int p = 0; p < 25; ++p) made.cells.push_back({std::ldexp(1.0F, t), rate * std::ldexp(1.0F, p)});
    return made;
}

constexpr EffectMask cheap = effect_texture, dear = effect_texture | effect_alpha_mask;

CostModel priced() {
    CostModel costs;
    costs.grids = {grid(cheap, 0.001F), grid(dear, 0.01F)};
    return costs;
}

/// Adds a square that faces +z, from (x0, -h) to (x1, h) at z = 0, as a part of a material with `effects`.
void add_square(Model& m, double x0, double x1, double h, EffectMask effects) {
    Material material;
    material.effects = effects;
    m.materials.push_back(material);
    const auto first_vertex = static_cast<std::uint32_t>(m.vertices.size());
    const auto first_index = static_cast<std::uint32_t>(m.indices.size());
    for (const dvec3& at : {dvec3(x0, -h, 0), dvec3(x1, -h, 0), dvec3(x1, h, 0), dvec3(x0, h, 0)}) {
        Vertex v{};
        for (int k = 0; k < 3; ++k) v.position[k] = static_cast<float>(at[k]);
        m.vertices.push_back(v);
        m.nodes[0].box.grow(at);
    }
    for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) m.indices.push_back(i);
    m.parts.push_back({static_cast<Index>(m.materials.size() - 1), first_index, 6, first_vertex, 4});
}

/// A wall from x = -4 to 2 and a masked poster beside it from 2 to 4, both 8 m high: three quarters and one quarter.
Model wall_and_poster() {
    Model m;
    m.placements.push_back({dvec3(0), mat3(1.0F)});
    m.nodes.emplace_back();
    add_square(m, -4, 2, 4, cheap);
    add_square(m, 2, 4, 4, dear);
    Representation rep;
    rep.part_count = 2;
    rep.triangles = 4;
    rep.effects = cheap | dear;
    m.reps.push_back(rep);
    m.reps[0].area_m2 = rasterised_area(m, m.reps[0]);
    m.nodes[0].rep_count = 1;
    return m;
}

ItemCost cost(const ItemCosts& costs, const Model& m, const Pose& pose, Index rep = 0) {
    return costs.of(rep, m.nodes[0].box, pose.position, make_view_scale(pose, picture));
}
Pose at(const dvec3& position) {
    Pose pose;
    pose.position = position;
    return pose;
}

TEST(ItemCosts, FarAwayAreThePixelsSharedOutByArea) {
    const Model m = wall_and_poster();
    const CostModel prices = priced();
    const ItemCosts costs(m, prices);
    const Pose far = at({0, 0, 60});
    const float pixels = rasterised_pixels(m.reps[0], m.nodes[0].box, far.position, make_view_scale(far, picture));
    ASSERT_GT(pixels, 1000.0F);
    const ItemCost found = cost(costs, m, far);
    EXPECT_NEAR(found.raster_us, pixels * (0.75F * 0.001F + 0.25F * 0.01F), 1e-3F * found.raster_us);
    EXPECT_NEAR(found.submit_us, 4, 1e-3);  // two triangles of each
}

TEST(ItemCosts, NearbyAreEachPartsOwnPixels) {
    const Model m = wall_and_poster();
    const CostModel prices = priced();
    const ItemCosts costs(m, prices);
    const double f = 240.0 / std::tan(0.5 * Pose{}.fov_y_rad);
    // One metre before the middle of each: it alone is seen.
    const double half_width = 320 / f;
    ASSERT_LT(half_width, 1.0);
    EXPECT_NEAR(cost(costs, m, at({-1, 0, 1})).raster_us, 640 * 480 * 0.001, 1);
    EXPECT_NEAR(cost(costs, m, at({3, 0, 1})).raster_us, 640 * 480 * 0.01, 5);
    // Before the border: half and half.
    EXPECT_NEAR(cost(costs, m, at({2, 0, 1})).raster_us, 320 * 480 * 0.011, 5);
    // From behind nothing is seen; a pixel is what the table counts at least.
    EXPECT_LT(cost(costs, m, at({3, 0, -1})).raster_us, 0.02);
}

TEST(ItemCosts, WithoutPartsAreByTheRepresentation) {
    Model m = wall_and_poster();
    m.reps[0].part_count = 0;
    m.reps[0].triangles = 100;
    m.reps[0].effects = dear;
    const CostModel prices = priced();
    for (const Pose& pose : {at({0, 0, 60}), at({0, 0, 1})}) {
        const float pixels = rasterised_pixels(m.reps[0], m.nodes[0].box, pose.position, make_view_scale(pose, picture));
        const ItemCost found = cost(ItemCosts(m, prices), m, pose);
        EXPECT_NEAR(found.raster_us, pixels * 0.01F, 1e-3F * found.raster_us);
        EXPECT_NEAR(found.submit_us, 100, 0.1);
    }
}

TEST(ItemCosts, OfARunOfPartsThatOthersShareAreTheSame) {
    Model m = wall_and_poster();
    m.reps.push_back(m.reps[0]);  // the same parts
    m.reps.push_back(m.reps[0]);
    m.reps[2].first_part = 1;  // the poster alone
    m.reps[2].part_count = 1;
    m.reps[2].triangles = 2;
    m.reps[2].area_m2 = rasterised_area(m, m.reps[2]);
    const CostModel prices = priced();
    const ItemCosts costs(m, prices);
    const Pose far = at({0, 0, 60});
    EXPECT_EQ(cost(costs, m, far, 1).raster_us, cost(costs, m, far, 0).raster_us);
    EXPECT_NEAR(cost(costs, m, far, 2).submit_us, 2, 1e-3);
    const float pixels = rasterised_pixels(m.reps[2], m.nodes[0].box, far.position, make_view_scale(far, picture));
    EXPECT_NEAR(cost(costs, m, far, 2).raster_us, pixels * 0.01F, 1e-4F * pixels);
}

TEST(ItemCosts, OfPartsWithoutAreaAreSharedEvenly) {
    Model m = wall_and_poster();
    for (Vertex& v : m.vertices) v.position[0] = 0;  // all of them lines
    const CostModel prices = priced();
    const ItemCosts costs(m, prices);
    const Pose far = at({0, 0, 60});
    const float pixels = rasterised_pixels(m.reps[0], m.nodes[0].box, far.position, make_view_scale(far, picture));
    ASSERT_GT(pixels, 1000.0F);
    EXPECT_NEAR(cost(costs, m, far).raster_us, pixels * (0.5F * 0.001F + 0.5F * 0.01F), 1e-5F * pixels);
    EXPECT_NEAR(cost(costs, m, far).submit_us, 4, 1e-3);
    EXPECT_LT(cost(costs, m, at({0, 0, 1})).raster_us, 0.02) << "nearby, where they are looked at, they cover nothing";
}

TEST(ItemCosts, OfEveryPixelAreAddedWhateverItsClass) {
    const Model m = wall_and_poster();
    const CostModel cells = priced();
    CostModel with_pixels = cells;
    with_pixels.ns_per_pixel = 2;
    for (const Pose& pose : {at({0, 0, 60}), at({2, 0, 1})}) {
        const ViewScale scale = make_view_scale(pose, picture);
        float pixels = 0;
        const ItemCost plain = ItemCosts(m, cells).of(0, m.nodes[0].box, pose.position, scale, pixels);
        const ItemCost more = ItemCosts(m, with_pixels).of(0, m.nodes[0].box, pose.position, scale);
        ASSERT_GT(pixels, 1000.0F);
        EXPECT_FLOAT_EQ(more.raster_us, plain.raster_us + 2e-3F * pixels);
        EXPECT_EQ(more.submit_us, plain.submit_us);
    }
    const CostModel smooth = at_quality(with_pixels, {4, rt::TextureFilter::bilinear, rt::TextureFilter::bilinear});
    EXPECT_FLOAT_EQ(smooth.ns_per_pixel, 2 * (1 + 3 * with_pixels.sample_share)) << "samples make each pixel dearer";
}

/// Prices of effects are in ns: the wall has shadows, the poster shadows and lamps. No grid holds either.
CostModel with_prices() {
    CostModel costs = priced();
    costs.prices = {{effect_shadow, 100, 50, 2}, {effect_lamps, 10, 0, 0}, {effect_fog, 1, 1, 1}, {effect_texture, 500, 0, 0.5F}};
    return costs;
}

Model with_light() {
    Model m = wall_and_poster();
    m.materials[0].effects |= effect_shadow;
    m.materials[1].effects |= effect_shadow | effect_lamps;
    return m;
}

TEST(ItemCosts, PricesOfEffectsAddUpOverPartsAndLeaveWithThem) {
    const Model m = with_light();
    const CostModel prices = with_prices(), none = priced();
    const ItemCosts costs(m, prices);
    EXPECT_EQ(costs.priced(), effect_shadow | effect_lamps | effect_texture) << "fog is nowhere";
    const Pose far = at({0, 0, 60});
    const auto of = [&](EffectMask hidden, float& pixels) {
        return costs.of(0, m.nodes[0].box, far.position, make_view_scale(far, picture), pixels, hidden);
    };
    float pixels = 0;
    const ItemCost bare = ItemCosts(m, none).of(0, m.nodes[0].box, far.position, make_view_scale(far, picture)),
                   all = of(0, pixels);
    ASSERT_GT(pixels, 1000.0F);
    // Four triangles with shadows, two with lamps. The grids hold the textures.
    EXPECT_NEAR(all.submit_us, bare.submit_us + 0.4F + 0.02F, 1e-5);
    EXPECT_NEAR(all.raster_us, bare.raster_us + 0.2F + 0.002F * pixels, 1e-4F * all.raster_us);
    EXPECT_NEAR(of(effect_lamps, pixels).submit_us, all.submit_us - 0.02F, 1e-5);
    EXPECT_NEAR(of(effect_shadow, pixels).submit_us, all.submit_us - 0.4F, 1e-5);
    EXPECT_NEAR(of(effect_shadow, pixels).raster_us, bare.raster_us, 1e-4F * all.raster_us);
    EXPECT_EQ(of(effect_fog | effect_sun, pixels).submit_us, all.submit_us) << "it has none of them";
    EXPECT_NEAR(of(effect_texture, pixels).submit_us, all.submit_us - 4 * 0.5F, 1e-5) << "what a grid holds goes as well";
    EXPECT_EQ(of(~EffectMask{0}, pixels).submit_us, std::max(0.0F, all.submit_us - 0.42F - 2.0F));
    const ItemCost added = costs.of_effects(0, pixels, effect_shadow | effect_lamps);
    EXPECT_NEAR(added.submit_us, all.submit_us - bare.submit_us, 1e-5);
    EXPECT_NEAR(added.raster_us, all.raster_us - bare.raster_us, 1e-4F * all.raster_us);
    const ItemCost of_lamps = costs.of_effects(0, pixels, effect_lamps);
    EXPECT_EQ(of_lamps.raster_us, 0.0F);
    EXPECT_FLOAT_EQ(of_lamps.submit_us, 0.02F);
}

TEST(ItemCosts, WithoutAnEffectThatHasAPriceAreToTheBitAsWithoutPrices) {
    const Model m = wall_and_poster();
    CostModel prices = with_prices();
    prices.prices.pop_back();  // of textures
    const CostModel none = priced();
    for (const Pose& pose : {at({0, 0, 60}), at({2, 0, 1})}) {
        const ItemCost a = cost(ItemCosts(m, prices), m, pose), b = cost(ItemCosts(m, none), m, pose);
        EXPECT_EQ(a.submit_us, b.submit_us);
        EXPECT_EQ(a.raster_us, b.raster_us);
    }
}

TEST(ItemCosts, OfARepresentationWithoutPartsHaveThePricesOfItsEffects) {
    Model m = wall_and_poster();
    m.reps[0].part_count = 0;
    m.reps[0].triangles = 100;
    m.reps[0].effects = dear | effect_lamps;
    const CostModel prices = with_prices(), none = priced();
    const Pose far = at({0, 0, 60});
    EXPECT_NEAR(cost(ItemCosts(m, prices), m, far).submit_us, cost(ItemCosts(m, none), m, far).submit_us + 1.0F, 1e-4);
}

}  // namespace
}  // namespace surefoot::model
