// Makes the k-d tree of boxes.
#include "render/cache/boxes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace surefoot::cache {

namespace {

constexpr double overlap_slack = 1e-12;  ///< of the largest coordinate
constexpr double same_side = 1e-9;       ///< sides that differ by less are equal: the lower axis is split

/// Halves all parts along the longest side until there are enough. All parts have the same shape.
std::vector<Box> split_box(const Box& box, std::uint32_t branching) {
    std::vector<Box> parts{box};
    while (parts.size() < branching) {
        const dvec3 side = parts.front().max - parts.front().min;
        int axis = 0;
        for (const int other : {1, 2})
            if (side[other] > side[axis] * (1 + same_side)) axis = other;
        std::vector<Box> halves;
        halves.reserve(2 * parts.size());
        for (const Box& part : parts) {
            const double middle = 0.5 * (part.min[axis] + part.max[axis]);
            Box low = part, high = part;
            low.max[axis] = middle;
            high.min[axis] = middle;
            halves.push_back(low);
            halves.push_back(high);
        }
        parts = std::move(halves);
    }
    return parts;
}

bool is_finite(const dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

Result<void> check_options(const TreeOptions& options) {
    if (options.branching < 2 || options.branching > max_branching || !std::has_single_bit(options.branching))
        return Error{"boxes", fmt::format("A box cannot be split into {} boxes", options.branching),
                     fmt::format("Choose a power of two from 2 to {}", max_branching), ErrorKind::misuse};
    if (options.levels < 1 || options.levels > max_levels)
        return Error{"boxes", fmt::format("A tree of {} levels is out of range", options.levels),
                     fmt::format("Choose 1 to {}", max_levels), ErrorKind::misuse};
    if (full_box_count(options) > max_boxes)
        return Error{"boxes", fmt::format("The tree would have more than {} boxes", max_boxes), "Choose fewer levels",
                     ErrorKind::out_of_limits};
    return {};
}

/// Adds the children of a box, with the contents of the box that meet them.
template <class Content>
void add_children(BoxTree& tree, Index of, std::span<const Content> contents, std::uint32_t branching) {
    const CacheBox parent = tree.boxes[of];
    const std::vector<Box> parts = split_box(parent.box, branching);
    tree.boxes[of].first_child = static_cast<Index>(tree.boxes.size());
    tree.boxes[of].child_count = branching;
    for (const Box& part : parts) {
        CacheBox child;
        child.box = part;
        child.parent = of;
        child.level = parent.level + 1;
        child.first_primitive = static_cast<std::uint32_t>(tree.primitives.size());
        for (std::uint32_t i = 0; i < parent.primitive_count; ++i) {
            const Index content = tree.primitives[parent.first_primitive + i];
            if (meets(contents[content], part)) tree.primitives.push_back(content);
        }
        child.primitive_count = static_cast<std::uint32_t>(tree.primitives.size()) - child.first_primitive;
        tree.boxes.push_back(child);
    }
}

/// Splits the root, which holds all contents and their number.
template <class Content>
Result<BoxTree> split(const CacheBox& root, std::span<const Content> contents, const TreeOptions& options) {
    BoxTree tree;
    for (std::size_t i = 0; i < contents.size(); ++i) tree.primitives.push_back(static_cast<Index>(i));
    tree.boxes.push_back(root);
    for (Index i = 0; i < tree.boxes.size(); ++i) {
        const CacheBox& box = tree.boxes[i];
        if (box.level + 1 >= options.levels || box.primitive_count < options.min_primitives) continue;
        add_children(tree, i, contents, options.branching);
        if (tree.primitives.size() >= none)
            return Error{"boxes", "The boxes hold more triangles than they can number", "Choose fewer levels",
                         ErrorKind::out_of_limits};
    }
    for (auto box = tree.boxes.rbegin(); box != tree.boxes.rend(); ++box)
        if (box->parent != none) tree.boxes[box->parent].height = std::max(tree.boxes[box->parent].height, box->height + 1);
    return tree;
}

}  // namespace

std::uint64_t full_box_count(const TreeOptions& options) {
    std::uint64_t all = 0, of_level = 1;
    for (std::uint32_t level = 0; level < options.levels && all <= max_boxes; ++level) {
        all += of_level;
        of_level *= options.branching;
    }
    return all;
}

bool meets(const Box& a, const Box& b) {
    return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

bool meets(const Triangle& triangle, const Box& box) {
    const dvec3 centre = box.centre();
    const Triangle at = {triangle[0] - centre, triangle[1] - centre, triangle[2] - centre};
    double scale = 0;
    for (int axis = 0; axis < 3; ++axis) {
        scale = std::max({scale, std::abs(centre[axis]), box.half()[axis]});
        for (const dvec3& corner : at) scale = std::max(scale, std::abs(corner[axis]));
    }
    const dvec3 half = box.half() + dvec3(overlap_slack * scale);
    const auto apart = [&](const dvec3& axis) {
        const double a = glm::dot(axis, at[0]), b = glm::dot(axis, at[1]), c = glm::dot(axis, at[2]);
        const double reach = glm::dot(glm::abs(axis), half);
        return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
    };
    if (apart({1, 0, 0}) || apart({0, 1, 0}) || apart({0, 0, 1})) return false;
    const std::array<dvec3, 3> edges = {at[1] - at[0], at[2] - at[1], at[0] - at[2]};
    if (apart(glm::cross(edges[0], edges[1]))) return false;
    for (const dvec3& e : edges)
        if (apart({0, -e.z, e.y}) || apart({e.z, 0, -e.x}) || apart({-e.y, e.x, 0})) return false;
    return true;
}

Result<BoxTree> make_boxes(std::span<const Triangle> triangles, const TreeOptions& options) {
    if (auto ok = check_options(options); !ok) return ok.error();
    if (triangles.empty())
        return Error{"boxes", "The scene has no triangle", "Choose a scene that shows something", ErrorKind::misuse};
    if (triangles.size() >= none)
        return Error{"boxes", "The scene has more triangles than the boxes can number", "Choose a smaller scene",
                     ErrorKind::out_of_limits};
    CacheBox root;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        for (const dvec3& corner : triangles[i]) {
            if (!is_finite(corner))
                return Error{fmt::format("triangle {}", i), "A corner is not a finite number", "Repair the scene",
                             ErrorKind::damaged};
            root.box.grow(corner);
        }
    }
    root.primitive_count = static_cast<std::uint32_t>(triangles.size());
    return split(root, triangles, options);
}

Result<BoxTree> make_boxes_around(std::span<const Box> contents, const TreeOptions& options) {
    if (auto ok = check_options(options); !ok) return ok.error();
    if (contents.empty() || contents.size() >= none)
        return Error{"boxes", fmt::format("A tree cannot hold {} boxes", contents.size()), "Choose a scene that shows something",
                     ErrorKind::out_of_limits};
    CacheBox root;
    for (std::size_t i = 0; i < contents.size(); ++i) {
        if (contents[i].empty() || !is_finite(contents[i].min) || !is_finite(contents[i].max))
            return Error{fmt::format("box {}", i), "A side is not a finite number", "Repair the scene", ErrorKind::damaged};
        root.box.grow(contents[i]);
    }
    root.primitive_count = static_cast<std::uint32_t>(contents.size());
    return split(root, contents, options);
}

}  // namespace surefoot::cache
