// Scratch memory of the searches and the slice plan. Holds no state between frames. Sized once; used in this room only.
#pragma once

#include <cstdint>
#include <vector>

#include "render/select/budget.hpp"
#include "render/select/cut_builder.hpp"
#include "render/select/select.hpp"

namespace surefoot::select {

/// Scratch memory of a search.
struct SelectState::Scratch {
    std::vector<std::uint32_t> chosen;  ///< by candidate: CutBuilder's choices
    std::vector<std::uint32_t> list;    ///< by candidate: CutBuilder's walk, then the search's stack or scan state
    std::vector<std::uint32_t> links;   ///< by candidate: the queue's links, deferred steps, or CommonErrorCuts' decisions
    std::vector<std::uint32_t> saved;   ///< by candidate: the choices of the best cut so far
    std::vector<float> lacks;           ///< by candidate: CutBuilder::what_items_lack() and undo_losses(), or CommonErrorCuts
    std::vector<Sum> below;             ///< by candidate: CutBuilder::undo_losses(), or CommonErrorCuts
    std::vector<Start> starts;          ///< by candidate: CutBuilder::start_with()
    std::vector<std::uint32_t> queue_heads;  ///< the queue's buckets
    std::vector<double> step_sums;           ///< two costs a bucket: of new steps, and of those shown before
};

/// Scratch memory of the slice plan.
struct SlicePlan::Scratch {
    std::vector<float> below_us;       ///< by candidate: predicted time of the cut's items below it; -1: none
    std::vector<std::uint32_t> item;   ///< by candidate: its index in the cut's items, or none
    std::vector<std::uint32_t> units;  ///< subtrees that fit a slice
    std::vector<std::uint32_t> stack;
    std::vector<float> distance_m;  ///< by candidate: of its box from the eye; of units only
};

}  // namespace surefoot::select
