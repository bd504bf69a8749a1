// The boxes of a walk: a tree over the leaves of a model, and what a node has to do with them.
#pragma once

#include <span>
#include <vector>

#include "render/cache/boxes.hpp"
#include "render/model/cost.hpp"
#include "render/model/covered_boxes.hpp"
#include "render/model/model.hpp"
#include "rt/base/result.hpp"

namespace surefoot::cache {

/// Boxes of the scene. A box contains a leaf of the model where it meets the leaf's box. Leaves that lie across more than
/// max_boxes_a_node leaves of the tree, as grounds do, are always drawn. Pictures hold what is seen of them beside other things.
/// Constant while a walk runs; any thread may read it.
class SceneBoxes final : public model::CoverTest {
public:
    SceneBoxes() = default;
    /// excluded: by node; true: no picture may show this leaf, so no box that it meets has one.
    /// Errors: options out of range or too many boxes for CoverBits, no leaf, a box that is not finite.
    static Result<SceneBoxes> make(const model::Model& model, const std::vector<bool>& excluded, const TreeOptions& options = {});

    [[nodiscard]] const BoxTree& tree() const { return tree_; }
    [[nodiscard]] Index size() const { return static_cast<Index>(tree_.boxes.size()); }
    /// Whether it contains a leaf that pictures can stand for.
    [[nodiscard]] bool has_contents(Index box) const { return ranges_[box].leaves > 0; }
    /// What of the box its contents fill: its picture shows this much.
    [[nodiscard]] const Box& filled(Index box) const { return filled_[box]; }
    /// Whether it may have a picture: it has contents, and meets nothing that is excluded.
    [[nodiscard]] bool may_have_picture(Index box) const { return may_have_picture_[box]; }
    /// Leaves of the model that its picture stands for.
    [[nodiscard]] std::span<const Index> leaves(Index box) const {
        return std::span(nodes_).subspan(ranges_[box].first, ranges_[box].leaves);
    }
    /// The same, and what is always drawn but in the picture too.
    [[nodiscard]] std::span<const Index> nodes(Index box) const {
        return std::span(nodes_).subspan(ranges_[box].first, ranges_[box].nodes);
    }
    /// The most important of these leaves. Only where it has contents.
    [[nodiscard]] Index important_leaf(Index box) const { return important_[box]; }
    [[nodiscard]] float importance(Index box) const { return importance_[box]; }
    [[nodiscard]] std::size_t first_node(Index box) const { return ranges_[box].first; }  ///< in nodes()
    /// Of all boxes, box by box.
    [[nodiscard]] std::span<const Index> nodes() const { return nodes_; }
    /// Leaves of the tree that a node of the model meets, if they are at most max_boxes_a_node; else none.
    [[nodiscard]] std::span<const Index> boxes_of(model::Index node) const {
        return std::span(boxes_of_node_).subspan(first_of_node_[node], first_of_node_[node + 1] - first_of_node_[node]);
    }
    static constexpr std::size_t max_boxes_a_node = 8;

    /// Boxes without contents.
    [[nodiscard]] const model::CoverBits& empty() const { return empty_; }
    /// Adds all boxes below those of the bits, then each box whose children are all there.
    void complete(model::CoverBits& bits) const;
    /// Whether all leaves of the tree that the node meets are among the bits. These must be complete. False where something in
    /// the node is always drawn.
    [[nodiscard]] bool covered(model::Index node, const model::CoverBits& bits) const override;

    /// Raster and submit time of drawing a box's contents as a picture with this many texels a metre. Interpolated between powers
    /// of two. What lies outside the box is clipped, so it counts for the submission only.
    void price_captures(const model::Model& model, const model::CostModel& costs);
    [[nodiscard]] model::ItemCost capture_cost(Index box, double texels_per_m) const;

private:
    /// Of nodes_: first the leaves that pictures stand for.
    struct Range {
        std::uint32_t first = 0, leaves = 0, nodes = 0;
    };
    void find_contents(std::span<const Index> leaves, const std::vector<bool>& excluded);

    BoxTree tree_;
    std::vector<Box> node_boxes_;  ///< of the model; empty: always drawn
    std::vector<bool> may_have_picture_;
    std::vector<Box> filled_;
    std::vector<Range> ranges_;
    std::vector<Index> important_;
    std::vector<float> importance_;
    std::vector<Index> nodes_;
    std::vector<Index> first_of_node_, boxes_of_node_;  ///< by node
    model::CoverBits empty_;
    std::vector<model::ItemCost> captures_;  ///< [box * density_steps + step]
};

}  // namespace surefoot::cache
