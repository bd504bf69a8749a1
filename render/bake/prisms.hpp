// Stacks of prisms as coarse levels of an object, where they look more like it than its other levels do.
#pragma once

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Adds up to two stacks to the chain. One stays if, seen from all round and above, it loses a tenth less than each level of as
/// many triangles or fewer. Levels that look no better and take about as long go. Without options.looks or a proxy material it
/// does nothing. Its error is at least the bound of its two-sided distance to full detail, and min_proxy_error.
void add_prisms(LodChain& chain, const ChainOptions& options);

}  // namespace surefoot::bake
