// Parts of a cluster whose losses are measured apart: a form may be right on one and wrong on another.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::model {

/// Each leaf of a cluster is in one of its groups. Go down from the cluster: the first node that has a 32nd of its leaves or less
/// is a group, and so is a leaf.
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

    /// The ancestors of which a node is a group. Count them from the parent up: of the first `skipped` it is none, since they are
    /// too small. Of each after them it is one, by the slot that is listed.
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
