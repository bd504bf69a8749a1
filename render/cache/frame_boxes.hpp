// What a frame of a walk does with each box: for its figures, and for a view from above after the walk.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/cache/birds_eye.hpp"
#include "render/cache/boxes.hpp"

namespace surefoot::model {
struct Frustum;
}

namespace surefoot::cache {

class SceneBoxes;

/// A box in a frame. What lies below a shown box has none of these.
struct FrameBox {
    bool shown = false;         ///< by its picture
    bool made = false;          ///< it got a picture; a frame may make one that only later ones show
    bool as_triangles = false;  ///< a leaf of the tree in view whose contents are drawn as forms
};

/// Boxes of a frame by what was done with them. New pictures are counted as they are made.
struct FrameBoxCounts {
    std::uint32_t reused = 0;  ///< shown by pictures of earlier frames
    std::uint32_t as_triangles = 0;
};

/// Fills `frame`, which is as long as there are boxes. shown, made: boxes whose pictures the frame draws, and makes. Contents:
/// what pictures could stand for; grounds, which are always drawn, are none. Allocates nothing.
FrameBoxCounts mark_boxes(const SceneBoxes& boxes, std::span<const Index> shown, std::span<const Index> made,
                          const model::Frustum& frustum, std::span<FrameBox> frame);

/// The same boxes for birds_eye_view(). Allocates.
std::vector<SeenBox> seen_boxes(const SceneBoxes& boxes, std::span<const FrameBox> frame);

}  // namespace surefoot::cache
