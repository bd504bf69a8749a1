// Coincident surfaces (z-fighting): ranks them by their order in the model; the first in the model wins.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::draw {

/// Ranks of parts: ranks[first_of_rep[rep] + k] for the k-th part of rep. 0: not coincident, or first of its group.
struct DepthBiasRanks {
    std::vector<std::uint32_t> first_of_rep;
    std::vector<std::uint8_t> ranks;
};

/// Finds two kinds of coincident parts. Some fill the same box, as two banners on one pole. Some are flat and overlap in one
/// axis-aligned plane, as a poster on a wall. Each gets the smallest rank that no earlier part of its group has. O(n log n).
/// Representations of one leaf with the same parts have the same ranks, so that a switch does not change the winner.
/// Representations with other parts have the rank of the first part.
DepthBiasRanks depth_bias_ranks(const model::Model& model);

}  // namespace surefoot::draw
