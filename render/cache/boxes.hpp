// The boxes of the image cache: a k-d tree of near-cubic boxes over the triangles of a scene.
// Source: Schaufler and Stuerzlinger 1996, section 4.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rt/base/geometry.hpp"
#include "rt/base/result.hpp"

namespace surefoot::cache {

using Index = std::uint32_t;
constexpr Index none = 0xffffffffU;

/// Corners in the world, m. It may have no area.
using Triangle = std::array<dvec3, 3>;

/// How a tree is made.
struct TreeOptions {
    std::uint32_t branching = 8;       ///< boxes that a box is split into: 2, 4, 8, 16, 32 or 64
    std::uint32_t levels = 4;          ///< with the root: 1 to max_levels
    std::uint32_t min_primitives = 0;  ///< a box with fewer triangles stays a leaf
};
constexpr std::uint32_t max_branching = 64, max_levels = 16;
/// A tree has no more boxes than this.
constexpr std::uint64_t max_boxes = 1ULL << 20U;

/// A box of the tree. Its children lie side by side and come after it; together they fill it, and no two overlap.
struct CacheBox {
    Box box;
    Index parent = none, first_child = none;
    std::uint32_t child_count = 0;                           ///< 0: a leaf
    std::uint32_t level = 0;                                 ///< of the root: 0
    std::uint32_t height = 0;                                ///< levels below it; of a leaf: 0
    std::uint32_t first_primitive = 0, primitive_count = 0;  ///< in BoxTree::primitives; a box without any shows nothing
};

/// The boxes, and the triangles that meet each of them. Constant while a walk runs; any thread may read it.
struct BoxTree {
    std::vector<CacheBox> boxes;    ///< level by level; the root is the first
    std::vector<Index> primitives;  ///< numbers of triangles, box by box, ascending in each
};

/// Boxes of a tree that is split down to its last level everywhere.
std::uint64_t full_box_count(const TreeOptions& options);

/// Splits the box of all triangles, each box along its longest side. A triangle is in every box that it meets, faces included.
/// Errors: options out of range, no triangle, a corner that is not finite.
Result<BoxTree> make_boxes(std::span<const Triangle> triangles, const TreeOptions& options);

/// The same of boxes that hold what the scene shows. A box is in every box of the tree that it meets, faces included.
Result<BoxTree> make_boxes_around(std::span<const Box> contents, const TreeOptions& options);

/// Calls draw(child) for the children of a box, so that none comes before one that it hides from the eye. Halves lie as they
/// were split: the upper half of the children is beyond the plane of its first one, and so on.
template <class Draw>
void back_to_front(const BoxTree& tree, Index first, std::uint32_t count, const dvec3& eye, const Draw& draw) {
    if (count == 0) return;
    if (count == 1) return draw(first);
    const Index beyond = first + count / 2;
    const dvec3 &low = tree.boxes[first].box.min, &high = tree.boxes[beyond].box.min;
    const int axis = high.x > low.x ? 0 : high.y > low.y ? 1 : 2;
    const bool low_is_farther = eye[axis] >= high[axis];
    back_to_front(tree, low_is_farther ? first : beyond, count / 2, eye, draw);
    back_to_front(tree, low_is_farther ? beyond : first, count / 2, eye, draw);
}

/// Whether two boxes meet, faces included.
bool meets(const Box& a, const Box& b);
/// Whether a triangle meets a box, its faces included. Rounding may make it true a hair outside, and never false inside.
/// Source: Akenine-Moller 2001, Fast 3D Triangle-Box Overlap Testing.
bool meets(const Triangle& triangle, const Box& box);

}  // namespace surefoot::cache
