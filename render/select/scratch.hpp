// Room for the searches and the slice plan: what carries nothing from one frame to the next. Sized once, inside this room only.
#pragma once

#include <cstdint>
#include <vector>

#include "render/select/select.hpp"

namespace surefoot::select {

struct SelectState::Scratch {
    std::vector<std::uint32_t> chosen;       ///< a candidate: Cover's choices
    std::vector<std::uint32_t> list;         ///< a candidate: Cover's walk, then the search's stack or notes
    std::vector<std::uint32_t> links;        ///< a candidate: the queue's links, or steps put off
    std::vector<std::uint32_t> queue_heads;  ///< the queue's buckets
    std::vector<double> step_sums;           ///< two costs a bucket, new and shown before
};

struct SlicePlan::Scratch {
    std::vector<float> below_us;       ///< a candidate: predicted time of what lies below it in the cut; -1: nothing does
    std::vector<std::uint32_t> item;   ///< a candidate: its place in the cut's items, or none
    std::vector<std::uint32_t> units;  ///< subtrees that fit a slice
    std::vector<std::uint32_t> stack;
};

}  // namespace surefoot::select
