// Parts of a cluster whose losses are measured apart: a form may be right on one and wrong on another.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::model {

/// The groups of a cluster part its leaves. A group is a leaf below it, or the highest node with a 32nd of its leaves or less.
/// Model::group_losses has an entry for each cluster, form and group, in this order; groups are in the order of nodes.
class LossGroups {
public:
    /// The tree must be valid. One that is deeper than max_depth has no groups: a chain would have a slot for each pair of nodes.
    explicit LossGroups(const Model& model);
    explicit LossGroups(Model&&) = delete;  ///< it reads the model's nodes as long as it lives
    static constexpr std::uint32_t max_depth = 128;

    /// Groups of a cluster; 0 of a leaf.
    [[nodiscard]] Index count(Index cluster) const { return count_[cluster]; }
    /// The cluster's first entry. That of a form and a group: first + form * count + slot, forms from 0.
    [[nodiscard]] std::size_t first(Index cluster) const { return first_[cluster]; }
    /// Entries of all clusters.
    [[nodiscard]] std::size_t size() const { return first_.back(); }

    /// The clusters of which a node is a group: `skipped` of its ancestors are not, the parent first; then one slot an ancestor.
    struct Above {
        std::uint32_t skipped = 0;
        std::span<const Index> slots;
    };
    [[nodiscard]] Above above(Index node) const {
        return {skipped_[node], std::span(slots_).subspan(slot_first_[node], slot_first_[node + 1] - slot_first_[node])};
    }
    /// The slot of the cluster's group that holds a leaf below it.
    [[nodiscard]] Index slot_of(Index leaf, Index cluster) const;

    static constexpr std::uint32_t parts = 32;

private:
    const std::vector<Node>& nodes_;
    std::vector<Index> count_, slots_;
    std::vector<std::size_t> first_, slot_first_;  ///< one more than nodes
    std::vector<std::uint32_t> skipped_, depth_;
};

}  // namespace surefoot::model
