// Which things lie in exactly one place, and who of them shows: a rank for each, by their order in the model.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::draw {

/// Ranks of a representation's parts: ranks[first_of_rep[rep] + k] for its k-th part. 0: in nobody's place, or the first there.
struct TieRanks {
    std::vector<std::uint32_t> first_of_rep;
    std::vector<std::uint8_t> ranks;
};

/// Leaves whose parts fill the same box (a game's two banners on one pole), and flat parts across an axis that overlap in one
/// plane (a poster on its wall): each gets the least rank that none before it there has. Forms of one leaf with the same parts
/// have the same ranks, so that a change of form changes nothing; with other parts they have the first part's. O(n log n).
TieRanks tie_ranks(const model::Model& model);

}  // namespace surefoot::draw
