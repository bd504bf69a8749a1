// Slack and ratio of levels, and the largest item of a frame.
#include "render/bake/quality.hpp"

#include <algorithm>

namespace surefoot::bake {

ChainOptions chain_options(const BakeOptions& options, model::Index proxy) {
    ChainOptions chain;
    chain.slack = options.quality == Quality::full ? 0.1F : 0.3F;
    chain.ratio = options.quality == Quality::full ? 0.6 : 0.45;
    if (options.level_ratio > 0) {
        chain.ratio = options.level_ratio;
        chain.slack = std::min(chain.slack, static_cast<float>(1.0 - options.level_ratio));
    }
    chain.proxy_material = proxy;
    return chain;
}

model::CostModel costs_of(const BakeOptions& options) {
    return options.costs != nullptr && !options.costs->grids.empty() ? *options.costs : model::default_costs();
}

std::uint32_t max_triangles(const BakeOptions& options) {
    const model::CostModel costs = costs_of(options);
    const double limit_us = options.frame_us / 16.0;
    const model::CostGrid& grid = costs.grid_for(model::effect_texture | model::effect_sun);
    std::uint32_t max_found = 256;
    for (std::uint32_t n = 512; n <= 65536; n *= 2) {
        const model::ItemCost cost = costs.item(static_cast<float>(n), 60000.0F, grid);
        if (cost.submit_us + cost.raster_us > limit_us) break;
        max_found = n;
    }
    return max_found;
}

}  // namespace surefoot::bake
