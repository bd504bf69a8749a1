// What a bake's options mean for its levels of detail, its costs and its largest items.
#pragma once

#include <cstdint>

#include "render/bake/bake.hpp"
#include "render/bake/geometry.hpp"

namespace surefoot::bake {

ChainOptions chain_options(const BakeOptions& options, model::Index proxy);
/// Calibrated ones, else the built-in table.
model::CostModel costs_of(const BakeOptions& options);
/// The 1/16-frame rule: as many triangles as fit, seen near and over a quarter of the picture.
std::uint32_t max_triangles(const BakeOptions& options);

}  // namespace surefoot::bake
