// Evaluation of the cost table, and the figures used where no machine was calibrated.
#include "render/model/cost.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace surefoot::model {

namespace {

/// Two neighbouring knots of an axis with knots at 2^0 .. 2^(steps-1), and the weight of the upper one.
struct Knots {
    std::uint32_t low = 0, high = 0;
    float weight = 0;
};

// The exponent is the knot and the mantissa the weight: no logarithm, since prepare asks this for every candidate of a frame.
Knots knots_of(float argument, std::uint32_t steps) {
    const float x = std::max(argument, 1.0F);
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t exponent = (bits >> 23U) - 127U;
    if (exponent + 1 < steps) {
        const float mantissa = std::bit_cast<float>((bits & 0x007fffffU) | 0x3f800000U);
        return {exponent, exponent + 1, mantissa - 1.0F};
    }
    if (steps < 2) return {0, 0, 0};
    const float last = std::ldexp(1.0F, static_cast<int>(steps) - 1);
    return {steps - 2, steps - 1, 1.0F + (x - last) / (0.5F * last)};
}

float mix(float a, float b, float t) { return a + (b - a) * t; }

ItemCost bilinear(const CostGrid& grid, Knots t, Knots p) {
    const auto cell = [&](std::uint32_t i, std::uint32_t j) { return grid.cells[i * grid.pixel_steps + j]; };
    const ItemCost a = cell(t.low, p.low), b = cell(t.low, p.high), c = cell(t.high, p.low), d = cell(t.high, p.high);
    return {mix(mix(a.submit_us, b.submit_us, p.weight), mix(c.submit_us, d.submit_us, p.weight), t.weight),
            mix(mix(a.raster_us, b.raster_us, p.weight), mix(c.raster_us, d.raster_us, p.weight), t.weight)};
}

struct ClassFigures {
    EffectMask effects;
    float raster_ns_per_pixel;
    float submit_us_per_triangle;
};

}  // namespace

ItemCost CostModel::item(float triangles, float pixels, const CostGrid& grid) const {
    if (grid.cells.empty()) return {};
    if (!std::isfinite(triangles) || !std::isfinite(pixels)) return grid.cells.back();
    Knots t = knots_of(triangles, grid.triangle_steps), p = knots_of(pixels, grid.pixel_steps);
    ItemCost cost = bilinear(grid, t, p);
    if (t.weight > 1.0F || p.weight > 1.0F) {  // measured noise must not make more work cheaper than the table's edge
        t.weight = std::min(t.weight, 1.0F);
        p.weight = std::min(p.weight, 1.0F);
        const ItemCost edge = bilinear(grid, t, p);
        cost = {std::max(cost.submit_us, edge.submit_us), std::max(cost.raster_us, edge.raster_us)};
    }
    return {std::max(cost.submit_us, 0.0F), std::max(cost.raster_us, 0.0F)};
}

const CostGrid& CostModel::grid_for(EffectMask effects) const {
    // What light all of them share, normals above all, is the sun's. What each adds is its price.
    EffectMask baked = effect_openness | effect_shadow | effect_lamps;
    const bool priced =
        std::any_of(prices.begin(), prices.end(), [](const EffectPrice& p) { return p.effect == effect_lit_picture; });
    if (!priced) baked |= effect_lit_picture;  // bakes and older tables: pictures read no normals, but their light is not free
    if ((effects & baked) != 0) effects = (effects & ~baked) | effect_sun;
    const CostGrid* best = &grids.front();
    int best_rank = -1000;
    for (const CostGrid& grid : grids) {
        if (grid.effects == effects) return grid;
        const int missing = std::popcount(effects & ~grid.effects), extra = std::popcount(grid.effects & ~effects);
        const int rank = -missing * 16 - extra;  // a class that does more is a safe stand-in, one that does less is not
        if (rank > best_rank) {
            best_rank = rank;
            best = &grid;
        }
    }
    return *best;
}

float CostModel::blur_loss_at(float resolution) const { return blur_loss[resolution_step(resolution)]; }

FrameCombine CostModel::combine_at(float resolution, const Viewport& picture) const {
    const Viewport drawn = viewport_of_step(picture, resolution_step(resolution));
    FrameCombine all = combine;
    all.fixed_us += 1e-3F * drawn_pass_ns_per_pixel * static_cast<float>(drawn.width) * static_cast<float>(drawn.height);
    return all;
}

CostModel at_quality(CostModel costs, const Quality& quality) {
    const float more = quality.samples > 1 ? static_cast<float>(quality.samples - 1) : 0.0F;
    const float by_samples = 1.0F + costs.sample_share * more;
    const bool dearer = quality.filter == rt::TextureFilter::trilinear && quality.of_table != rt::TextureFilter::trilinear;
    const bool cheaper = quality.filter != rt::TextureFilter::trilinear && quality.of_table == rt::TextureFilter::trilinear;
    const float by_filter = dearer ? costs.trilinear_factor : cheaper ? 1.0F / costs.trilinear_factor : 1.0F;
    for (CostGrid& grid : costs.grids) {
        const float factor = (grid.effects & effect_texture) != 0 ? by_samples * by_filter : by_samples;
        for (ItemCost& cell : grid.cells) cell.raster_us *= factor;
    }
    for (EffectPrice& price : costs.prices) {
        price.raster_ns_per_triangle *= by_samples;
        price.raster_ns_per_pixel *= by_samples;
    }
    costs.ns_per_pixel *= by_samples;
    costs.drawn_pass_ns_per_pixel += costs.sample_pass_ns_per_pixel * more;
    costs.rest_pass_ns_per_pixel += costs.sample_pass_ns_per_pixel * more;
    return costs;
}

CostModel with_background(CostModel costs) {
    costs.drawn_pass_ns_per_pixel += costs.background_ns_per_pixel;
    costs.behind_ns_per_pixel = costs.background_ns_per_pixel;
    return costs;
}

CostModel default_costs() {
    // Orders of magnitude of llvmpipe on two cores at 1280x720; `surefoot calibrate` replaces them.
    constexpr std::array<ClassFigures, 12> classes = {{
        {0, 1.5F, 0.050F},
        {effect_vertex_colour, 1.8F, 0.060F},
        {effect_sun, 1.8F, 0.065F},
        {effect_vertex_colour | effect_sun, 1.9F, 0.070F},
        {effect_texture, 3.0F, 0.060F},
        {effect_texture | effect_sun, 3.2F, 0.070F},
        {effect_texture | effect_vertex_colour | effect_sun, 3.3F, 0.075F},
        {effect_texture | effect_alpha_mask, 3.6F, 0.060F},
        {effect_texture | effect_alpha_mask | effect_vertex_colour | effect_sun, 3.8F, 0.075F},
        {effect_blend | effect_vertex_colour | effect_sun, 3.0F, 0.080F},
        {effect_texture | effect_blend, 4.0F, 0.070F},
        {effect_texture | effect_blend | effect_vertex_colour | effect_sun, 4.2F, 0.085F},
    }};
    constexpr float draw_us = 3.0F, raster_us_per_triangle = 0.03F;
    CostModel costs;
    for (const ClassFigures& figures : classes) {
        CostGrid grid{figures.effects, 21, 25, {}};
        for (std::uint32_t t = 0; t < grid.triangle_steps; ++t) {
            for (std::uint32_t p = 0; p < grid.pixel_steps; ++p) {
                const float triangles = std::ldexp(1.0F, static_cast<int>(t)), pixels = std::ldexp(1.0F, static_cast<int>(p));
                grid.cells.push_back({draw_us + figures.submit_us_per_triangle * triangles,
                                      raster_us_per_triangle * triangles + 0.001F * figures.raster_ns_per_pixel * pixels});
            }
        }
        costs.grids.push_back(std::move(grid));
    }
    costs.machine = "built-in defaults (llvmpipe, 2 cores)";
    return costs;
}

}  // namespace surefoot::model
