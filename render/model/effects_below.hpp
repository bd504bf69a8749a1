// What each region of the hierarchy calls for: the effects of what is drawn at a node and below it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::model {

/// What a node and all below it need.
struct RegionEffects {
    EffectMask full = 0;                                    ///< of the full detail of its leaves
    EffectMask coarse = 0;                                  ///< of all other forms, its own included
    std::uint64_t triangles = 0;                            ///< of the full detail
    std::array<std::uint64_t, effect_count> with_effect{};  ///< of these, in bit order
    std::uint32_t leaves = 0;
    Index largest = none;  ///< the leaf with most triangles
};

/// One for each node. In one pass, children before their parents.
std::vector<RegionEffects> effects_below(const Model& model);

/// Whether what sees no sky is a tree of its own below the root, beside one that calls for the sun.
bool has_rooms_apart(const Model& model);

/// Nodes that cover all leaves once, at most max_count: the root, then what has most triangles gives way to its children. Those
/// with most triangles first.
std::vector<Index> main_regions(const Model& model, std::size_t max_count);

}  // namespace surefoot::model
