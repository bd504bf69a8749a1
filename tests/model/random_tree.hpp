// Trees of clusters for tests: up to eight children each, breadth first, as bakes number them.
#pragma once

#include <algorithm>

#include "render/model/model.hpp"
#include "rt/base/random.hpp"

namespace surefoot::test {

/// At least `nodes` nodes, unless that is below two; forms are not set.
inline model::Model random_tree(Random& random, std::size_t nodes) {
    model::Model model;
    model.nodes.resize(1);
    for (model::Index at = 0; at < model.nodes.size() && model.nodes.size() < nodes; ++at) {
        const auto children = static_cast<std::uint32_t>(random.unit() * 9);
        if (children == 0 && at + 1 < model.nodes.size()) continue;
        model.nodes[at].first_child = static_cast<model::Index>(model.nodes.size());
        model.nodes[at].child_count = std::max(1U, children);
        for (std::uint32_t c = 0; c < model.nodes[at].child_count; ++c) model.nodes.emplace_back().parent = at;
    }
    return model;
}

}  // namespace surefoot::test
