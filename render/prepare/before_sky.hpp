// How many pixels of each candidate have nothing but the sky behind them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/prepare/evaluate.hpp"
#include "render/prepare/item_buffer.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// A node that is no candidate, since others hide it.
struct HiddenNode {
    Outline outline;
    Index parent = 0;  ///< the candidate that it is below
};

/// Pixels before the sky. What is missing there shows the sky, and the sky differs more from things than they differ from each
/// other.
struct SkyPixels {
    /// [candidate] px that a leaf shows where all that covers them has a common ancestor below the root. 0 of other candidates.
    std::span<const float> of_leaf;
    /// [candidate] px, times their Weight::pixel_weight, where this is the deepest common ancestor. 0 of a root with children.
    std::span<const float> at;
};

/// Leaves are ranked in the order of the tree, so that each subtree is a range. Each point of the item buffer keeps the range of
/// all leaves that cover it, in front or behind. If their deepest common ancestor is missing, the point shows the sky.
/// A hidden node has a rank too, right after its parent's. Blocks of 10 x 10 points say where it is.
class BeforeSky {
public:
    static constexpr int block = 10, across = ItemBuffer::columns / block, down = ItemBuffer::rows / block;  ///< points a side

    /// Reserves for this many candidates and hidden nodes. Nothing below allocates up to that.
    void reserve(std::uint32_t max_candidates, std::uint32_t max_hidden);
    /// Begins a frame. The candidates must stay until its last show().
    void begin(std::span<const Candidate> candidates, std::span<const HiddenNode> hidden);
    [[nodiscard]] std::uint32_t rank(std::uint32_t leaf) const { return first_[leaf]; }
    /// A leaf without points in the buffer covers the blocks whose middles lie in its outline.
    void cover(const Outline& outline, std::uint32_t rank);
    /// Adds pixels that a leaf shows at a point. weight: Weight::pixel_weight of the leaf. Call it when all leaves are drawn.
    void show(std::uint32_t leaf, float pixels, float weight, const ItemBuffer& buffer, int x, int y);
    /// Valid until the next begin().
    [[nodiscard]] SkyPixels pixels() const;

private:
    /// The deepest common ancestor of two leaves, by rank; 0 is the root.
    [[nodiscard]] std::uint32_t common_ancestor(std::uint32_t first, std::uint32_t last) const;

    std::span<const Candidate> candidates_;
    std::vector<std::uint32_t> first_, count_;  ///< [candidate]: ranks of what is below it
    std::vector<std::uint32_t> hidden_;         ///< [candidate]: of these, hidden nodes right below it
    std::vector<std::uint32_t> at_rank_;        ///< [rank]: the leaf, or a hidden node's parent
    std::vector<ItemBuffer::Point> blocks_;
    std::vector<float> of_leaf_, at_;
};

}  // namespace surefoot::prepare
