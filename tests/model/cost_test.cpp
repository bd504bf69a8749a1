// The cost table's evaluation: exact at knots, linear between, sane beyond, never negative.
#include "render/model/cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace surefoot::model {
namespace {

/// submit = triangles, raster = pixels, up to 2^3 and 2^2.
CostModel plain() {
    CostGrid grid{0, 4, 3, {}};
    for (int t = 0; t < 4; ++t) {
        for (int p = 0; p < 3; ++p) grid.cells.push_back({std::ldexp(1.0F, t), std::ldexp(1.0F, p)});
    }
    CostModel costs;
    costs.grids.push_back(grid);
    return costs;
}

TEST(Cost, LinearFiguresComeBackExactly) {
    const CostModel costs = plain();
    for (const float t : {1.0F, 1.5F, 2.0F, 3.0F, 7.0F, 8.0F, 40.0F}) {
        for (const float p : {1.0F, 2.5F, 4.0F, 100.0F}) {
            const ItemCost cost = costs.item(t, p, costs.grids[0]);
            EXPECT_FLOAT_EQ(cost.submit_us, t);
            EXPECT_FLOAT_EQ(cost.raster_us, p);
        }
    }
}

TEST(Cost, BelowOneCountsAsOne) { EXPECT_EQ(plain().item(0, -5, plain().grids[0]).raster_us, 1.0F); }

TEST(Cost, UndoneRasterTimeCountsAsInTheFrame) {
    const model::FrameCombine shared{400, 1.8F, 0.5F, 0.25F};
    EXPECT_FLOAT_EQ(shared.left_us(1000, 9000, 2000), 1500) << "the larger sum is the raster time: half and a quarter of it";
    EXPECT_FLOAT_EQ(shared.left_us(9000, 3000, 2000), 1000) << "submitting is the larger one";
    EXPECT_EQ(shared.left_us(1000, 9000, 0), 0.0F);
}

TEST(Cost, NotANumberCostsTheMost) {
    const CostModel costs = plain();
    EXPECT_EQ(costs.item(std::numeric_limits<float>::quiet_NaN(), 1, costs.grids[0]).submit_us, 8.0F);
    EXPECT_EQ(costs.item(1, std::numeric_limits<float>::infinity(), costs.grids[0]).submit_us, 8.0F);
}

// Noise can make the last knot cheaper than the one before: drawn out, the line would reach zero.
TEST(Cost, FallingLastKnotsDoNotMakeMoreWorkFree) {
    CostModel costs = plain();
    for (int p = 0; p < 3; ++p) costs.grids[0].cells[9 + static_cast<std::size_t>(p)].submit_us = 3;
    EXPECT_GE(costs.item(1000, 1, costs.grids[0]).submit_us, 3.0F);
}

TEST(Cost, ClassIsExactElseTheNextThatDoesMore) {
    CostModel costs = plain();
    const CostGrid base = costs.grids[0];
    for (const EffectMask mask : {EffectMask{effect_texture}, EffectMask{effect_texture | effect_sun | effect_alpha_mask}}) {
        costs.grids.push_back(base);
        costs.grids.back().effects = mask;
    }
    EXPECT_EQ(costs.grid_for(effect_texture).effects, effect_texture);
    EXPECT_EQ(costs.grid_for(0).effects, 0U);
    EXPECT_EQ(costs.grid_for(effect_sun).effects, effect_texture | effect_sun | effect_alpha_mask);
    EXPECT_EQ(costs.grid_for(effect_blend | effect_texture).effects, effect_texture);
}

TEST(Cost, OfClearingAndResolvingSamplesIsOfTheSizeThatIsDrawn) {
    CostModel costs = default_costs();
    costs.sample_pass_ns_per_pixel = 2;
    const Viewport picture{1000, 500};
    const CostModel smooth = at_quality(costs, {4, rt::TextureFilter::bilinear, rt::TextureFilter::bilinear});
    EXPECT_FLOAT_EQ(smooth.combine_at(1, picture).fixed_us, costs.combine.fixed_us + 3000);
    EXPECT_FLOAT_EQ(smooth.combine_at(0.5F, picture).fixed_us, costs.combine.fixed_us + 750);
    EXPECT_FLOAT_EQ(smooth.combine_at(0.6F, picture).fixed_us, costs.combine.fixed_us + 750) << "the step that is drawn";
    EXPECT_EQ(smooth.combine_at(0.5F, picture).raster_weight, costs.combine.raster_weight);
    EXPECT_EQ(costs.combine_at(0.5F, picture).fixed_us, costs.combine.fixed_us) << "one sample needs no pass";
    EXPECT_FLOAT_EQ(smooth.rest_pass_us(picture), costs.rest_pass_us(picture) + 3000) << "a picture at rest is whole";
}

TEST(Cost, OfAnEffectGrowsWithTheSamplesAsThatOfItems) {
    CostModel costs = default_costs();
    costs.sample_share = 0.5F;
    costs.prices = {{effect_lamps, 3, 4, 5}};
    const EffectPrice price = at_quality(costs, {4, rt::TextureFilter::bilinear, rt::TextureFilter::bilinear}).prices.at(0);
    EXPECT_FLOAT_EQ(price.submit_ns_per_triangle, 3);
    EXPECT_FLOAT_EQ(price.raster_ns_per_triangle, 10);
    EXPECT_FLOAT_EQ(price.raster_ns_per_pixel, 12.5F);
}

TEST(Cost, OfSamplesAndAFilterChangesRasterTimeAndThePasses) {
    using rt::TextureFilter;
    CostModel costs = default_costs();
    costs.sample_share = 0.5F;
    costs.sample_pass_ns_per_pixel = 2;
    costs.trilinear_factor = 1.5F;
    const auto raster = [](const CostModel& of, EffectMask mask) { return of.item(100, 1000, of.grid_for(mask)).raster_us; };
    const CostModel plain = at_quality(costs, {});
    EXPECT_EQ(raster(plain, effect_texture), raster(costs, effect_texture));
    EXPECT_EQ(plain.combine.fixed_us, costs.combine.fixed_us);
    const CostModel smooth = at_quality(costs, {4, TextureFilter::bilinear, TextureFilter::bilinear});
    EXPECT_FLOAT_EQ(raster(smooth, 0), 2.5F * raster(costs, 0));
    EXPECT_FLOAT_EQ(raster(smooth, effect_texture), 2.5F * raster(costs, effect_texture));
    EXPECT_EQ(smooth.item(100, 1000, smooth.grid_for(0)).submit_us, costs.item(100, 1000, costs.grid_for(0)).submit_us);
    EXPECT_FLOAT_EQ(smooth.combine_at(1, {1000, 500}).fixed_us,
                    costs.combine.fixed_us + 3000.0F);  // 3 samples, 2 ns, half a million pixels
    EXPECT_FLOAT_EQ(smooth.rest_pass_us({1000, 500}), costs.rest_pass_us({1000, 500}) + 3000.0F);
    const CostModel filtered = at_quality(costs, {1, TextureFilter::trilinear, TextureFilter::bilinear});
    EXPECT_EQ(raster(filtered, effect_sun), raster(costs, effect_sun)) << "no texture";
    EXPECT_FLOAT_EQ(raster(filtered, effect_texture), 1.5F * raster(costs, effect_texture));
    const CostModel cheaper = at_quality(costs, {1, TextureFilter::bilinear, TextureFilter::trilinear});
    EXPECT_FLOAT_EQ(raster(cheaper, effect_texture), raster(costs, effect_texture) / 1.5F);
    const CostModel same = at_quality(costs, {1, TextureFilter::trilinear, TextureFilter::trilinear});
    EXPECT_EQ(raster(same, effect_texture), raster(costs, effect_texture));
}

TEST(Cost, DefaultsGrowWithTrianglesAndPixels) {
    const CostModel costs = default_costs();
    for (const CostGrid& grid : costs.grids) {
        ASSERT_EQ(grid.cells.size(), grid.triangle_steps * grid.pixel_steps);
        EXPECT_LT(costs.item(10, 100, grid).submit_us, costs.item(1000, 100, grid).submit_us);
        EXPECT_LT(costs.item(10, 100, grid).raster_us, costs.item(10, 10000, grid).raster_us);
    }
    EXPECT_FALSE(costs.calibrated);
}

}  // namespace
}  // namespace surefoot::model
