// Counts leaves below each node, and lists for each node the ancestors of which it is a group.
#include "render/model/loss_groups.hpp"

namespace surefoot::model {

LossGroups::LossGroups(const Model& model)
    : nodes_(model.nodes),
      count_(model.nodes.size(), 0),
      first_(model.nodes.size() + 1, 0),
      slot_first_(model.nodes.size() + 1, 0),
      skipped_(model.nodes.size(), 0),
      depth_(model.nodes.size(), 0) {
    const auto n = static_cast<Index>(nodes_.size());
    for (Index i = 0; i < n; ++i) {  // parents come first
        if (nodes_[i].parent != none) depth_[i] = depth_[nodes_[i].parent] + 1;
        if (depth_[i] > max_depth) return;
    }
    std::vector<std::uint64_t> leaves(n, 0);
    for (Index i = n; i-- > 0;) {  // children come after their parents
        if (nodes_[i].child_count == 0) leaves[i] = 1;
        if (nodes_[i].parent != none) leaves[nodes_[i].parent] += leaves[i];
    }
    const auto small = [&](Index node, Index cluster) { return leaves[node] * parts <= leaves[cluster]; };
    for (Index i = 0; i < n; ++i) {
        const Index parent = nodes_[i].parent;
        for (Index a = parent; a != none && (a == parent || !small(parent, a)); a = nodes_[a].parent) {
            if (nodes_[i].child_count == 0 || small(i, a))
                slots_.push_back(count_[a]++);
            else
                ++skipped_[i];
        }
        slot_first_[i + 1] = slots_.size();
    }
    for (Index i = 0; i < n; ++i) first_[i + 1] = first_[i] + std::size_t{count_[i]} * nodes_[i].rep_count;
}

Index LossGroups::slot_of(Index leaf, Index cluster) const {
    for (Index node = leaf; node != cluster && node != none; node = nodes_[node].parent) {
        const std::uint32_t up = depth_[node] - depth_[cluster] - 1;  // 0: the cluster is the parent
        const Above at = above(node);
        if (up >= at.skipped && up - at.skipped < at.slots.size()) return at.slots[up - at.skipped];
    }
    return none;
}

}  // namespace surefoot::model
