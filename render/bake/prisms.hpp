// Stacks of prisms as coarse levels of an object, where they look more like it than its other levels do.
#pragma once

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Adds stacks to the chain. One stays if, seen from all round and above, it loses a tenth less than each level of as many
/// triangles or fewer. Levels that look worse by about as many triangles go. Needs options.looks and a proxy material, else does
/// nothing. Its error is the bound of its two-sided distance to full detail, at least min_proxy_error; coarser levels get errors
/// above it.
void add_prisms(LodChain& chain, const ChainOptions& options);

}  // namespace surefoot::bake
