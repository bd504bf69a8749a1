// Makes the boxes of a walk, and says what of the scene is covered.
#include "render/cache/scene_boxes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace surefoot::cache {

namespace {

constexpr std::size_t density_steps = 16;
constexpr int min_density_log = -5;  // of texels a metre

/// Leaves of the tree with contents that a box meets. False: there are more than the limit.
bool leaves_met(const BoxTree& tree, Index i, const Box& box, std::size_t limit, std::vector<Index>& met) {
    const CacheBox& of = tree.boxes[i];
    if (of.primitive_count == 0 || !meets(of.box, box)) return true;
    if (of.child_count == 0) {
        if (met.size() == limit) return false;
        met.push_back(i);
        return true;
    }
    for (Index child = of.first_child; child < of.first_child + of.child_count; ++child)
        if (!leaves_met(tree, child, box, limit, met)) return false;
    return true;
}

/// Whether all leaves of the tree below a box that another box meets are among the bits.
bool covers(const BoxTree& tree, Index i, const Box& box, const model::CoverBits& bits) {
    const CacheBox& of = tree.boxes[i];
    if (bits[i] || !meets(of.box, box)) return true;
    if (of.child_count == 0) return false;
    for (Index child = of.first_child; child < of.first_child + of.child_count; ++child)
        if (!covers(tree, child, box, bits)) return false;
    return true;
}

/// Of a box's volume, what lies within another one. Flat boxes have none on their axis.
float share_within(const Box& box, const Box& other) {
    double share = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double side = box.max[axis] - box.min[axis];
        if (side > 0)
            share *= std::max(0.0, std::min(box.max[axis], other.max[axis]) - std::max(box.min[axis], other.min[axis])) / side;
    }
    return static_cast<float>(share);
}

}  // namespace

Result<SceneBoxes> SceneBoxes::make(const model::Model& model, const std::vector<bool>& excluded, const TreeOptions& options) {
    if (full_box_count(options) > model::max_cover_boxes)
        return Error{"boxes", fmt::format("A walk has at most {} boxes", model::max_cover_boxes), "Choose fewer levels",
                     ErrorKind::out_of_limits};
    std::vector<Index> leaves;
    std::vector<Box> contents;
    for (Index n = 0; n < model.nodes.size(); ++n) {
        if (model.nodes[n].child_count > 0 || model.nodes[n].box.empty()) continue;
        leaves.push_back(n);
        contents.push_back(model.nodes[n].box);
    }
    auto tree = make_boxes_around(contents, options);
    if (!tree) return tree.error();
    SceneBoxes boxes;
    boxes.tree_ = std::move(*tree);
    std::vector<Index> met;
    boxes.node_boxes_.reserve(model.nodes.size());
    for (const model::Node& node : model.nodes) {
        boxes.first_of_node_.push_back(static_cast<Index>(boxes.boxes_of_node_.size()));
        boxes.node_boxes_.push_back(node.box);
        met.clear();
        if (!node.box.empty() && leaves_met(boxes.tree_, 0, node.box, max_boxes_a_node, met))
            boxes.boxes_of_node_.insert(boxes.boxes_of_node_.end(), met.begin(), met.end());
        else if (node.child_count == 0)
            boxes.node_boxes_.back() = {};
    }
    boxes.first_of_node_.push_back(static_cast<Index>(boxes.boxes_of_node_.size()));
    boxes.find_contents(leaves, excluded);
    for (Index i = 0; i < boxes.size(); ++i) {
        const std::span<const Index> shown = boxes.leaves(i);
        const auto first = std::max_element(
            shown.begin(), shown.end(), [&](Index a, Index b) { return model.nodes[a].importance < model.nodes[b].importance; });
        boxes.important_.push_back(first == shown.end() ? none : *first);
        boxes.importance_.push_back(first == shown.end() ? 0.0F : model.nodes[*first].importance);
    }
    for (auto n = static_cast<Index>(model.nodes.size()); n-- > 1;)  // children come after their parents
        if (boxes.node_boxes_[n].empty() && model.nodes[n].parent != model::none) boxes.node_boxes_[model.nodes[n].parent] = {};
    return boxes;
}

void SceneBoxes::find_contents(std::span<const Index> leaves, const std::vector<bool>& excluded) {
    ranges_.resize(tree_.boxes.size());
    filled_.resize(tree_.boxes.size());
    may_have_picture_.resize(tree_.boxes.size(), false);
    for (Index i = 0; i < size(); ++i) {
        const CacheBox& box = tree_.boxes[i];
        const auto contents = std::span(tree_.primitives).subspan(box.first_primitive, box.primitive_count);
        Range& range = ranges_[i];
        range.first = static_cast<std::uint32_t>(nodes_.size());
        bool may_have = true;
        const auto use = [&](Index n) { may_have = may_have && !(n < excluded.size() && excluded[n]); };
        for (const Index primitive : contents) {
            const Index n = leaves[primitive];
            const Box& of = node_boxes_[n];
            if (of.empty()) continue;
            nodes_.push_back(n);
            filled_[i].grow(Box{glm::max(of.min, box.box.min), glm::min(of.max, box.box.max)});
            use(n);
        }
        range.leaves = range.nodes = static_cast<std::uint32_t>(nodes_.size()) - range.first;
        if (range.leaves == 0) {
            empty_.set(i);
            continue;
        }
        for (const Index primitive : contents) {
            const Index n = leaves[primitive];
            if (!node_boxes_[n].empty()) continue;
            nodes_.push_back(n);
            use(n);
        }
        range.nodes = static_cast<std::uint32_t>(nodes_.size()) - range.first;
        may_have_picture_[i] = may_have;
    }
}

void SceneBoxes::complete(model::CoverBits& bits) const {
    for (Index i = 1; i < size(); ++i)  // parents come first
        if (bits[tree_.boxes[i].parent]) bits.set(i);
    for (Index i = size(); i-- > 0;) {
        const CacheBox& box = tree_.boxes[i];
        bool all = box.child_count > 0;
        for (Index child = box.first_child; all && child < box.first_child + box.child_count; ++child) all = bits[child];
        if (all) bits.set(i);
    }
}

/// Most nodes are not covered, and of small ones the leaves of the tree that they meet are known.
bool SceneBoxes::covered(model::Index node, const model::CoverBits& bits) const {
    for (const Index leaf : boxes_of(node))
        if (!bits[leaf]) return false;
    const Box& box = node_boxes_[node];
    return !tree_.boxes.empty() && !box.empty() && covers(tree_, 0, box, bits);
}

void SceneBoxes::price_captures(const model::Model& model, const model::CostModel& costs) {
    captures_.assign(tree_.boxes.size() * density_steps, {});
    for (std::size_t step = 0; step < density_steps; ++step) {
        const double texels_per_m = std::exp2(static_cast<double>(step) + min_density_log);
        const double per_m2 = texels_per_m * texels_per_m;
        for (Index i = 0; i < size(); ++i) {
            model::ItemCost& sum = captures_[i * density_steps + step];
            for (const Index n : nodes(i)) {
                const model::Node& node = model.nodes[n];
                const model::Representation& rep = model.reps[node.first_rep + node.rep_count - 1];
                // Seen from all sides, in the mean.
                const auto pixels = static_cast<float>(0.5 * per_m2) * (rep.area_m2[0] + rep.area_m2[1] + rep.area_m2[2]);
                model::ItemCost cost = costs.item(static_cast<float>(rep.triangles), pixels, costs.grid_for(rep.effects));
                cost.raster_us += 1e-3F * costs.ns_per_pixel * pixels;
                sum += {cost.submit_us, share_within(node.box, filled_[i]) * cost.raster_us};
            }
        }
    }
}

model::ItemCost SceneBoxes::capture_cost(Index box, double texels_per_m) const {
    if (captures_.empty()) return {};
    const double at = std::log2(std::max(texels_per_m, 1e-3)) - min_density_log;
    const double clamped = std::clamp(at, 0.0, static_cast<double>(density_steps - 1));
    const auto low = std::min(static_cast<std::size_t>(clamped), density_steps - 2);
    const auto share = static_cast<float>(clamped - static_cast<double>(low));
    const model::ItemCost *const a = &captures_[box * density_steps + low], *const b = a + 1;
    return {a->submit_us + share * (b->submit_us - a->submit_us), a->raster_us + share * (b->raster_us - a->raster_us)};
}

}  // namespace surefoot::cache
