// Marks the boxes of a frame.
#include "render/cache/frame_boxes.hpp"

#include <algorithm>

#include "render/cache/in_view.hpp"
#include "render/cache/scene_boxes.hpp"

namespace surefoot::cache {

namespace {

/// Leaves in view below a box, up to what is shown. Their number. among: planes that the box above it lies across.
std::uint32_t mark_triangles(const SceneBoxes& boxes, Index i, const model::Frustum& frustum, unsigned among,
                             std::span<FrameBox> frame) {
    if (frame[i].shown || !boxes.has_contents(i)) return 0;
    const unsigned across = planes_across(frustum, boxes.filled(i), among);
    if (across == out_of_view) return 0;
    const CacheBox& box = boxes.tree().boxes[i];
    if (box.child_count == 0) {
        frame[i].as_triangles = true;
        return 1;
    }
    std::uint32_t count = 0;
    for (Index child = box.first_child; child < box.first_child + box.child_count; ++child)
        count += mark_triangles(boxes, child, frustum, across, frame);
    return count;
}

}  // namespace

FrameBoxCounts mark_boxes(const SceneBoxes& boxes, std::span<const Index> shown, std::span<const Index> made,
                          const model::Frustum& frustum, std::span<FrameBox> frame) {
    std::fill(frame.begin(), frame.end(), FrameBox{});
    if (frame.empty()) return {};
    for (const Index box : made) frame[box].made = true;
    FrameBoxCounts counts;
    for (const Index box : shown) {
        frame[box].shown = true;
        counts.reused += frame[box].made ? 0 : 1;
    }
    counts.as_triangles = mark_triangles(boxes, 0, frustum, all_planes, frame);
    return counts;
}

std::vector<SeenBox> seen_boxes(const SceneBoxes& boxes, std::span<const FrameBox> frame) {
    std::vector<SeenBox> seen;
    for (std::size_t i = 0; i < frame.size(); ++i) {
        const Box& box = boxes.tree().boxes[i].box;
        if (frame[i].shown) seen.push_back({box, frame[i].made ? BoxUse::fresh : BoxUse::reused, true});
        if (frame[i].as_triangles) seen.push_back({box, BoxUse::not_replaceable, true});
        if (frame[i].made && !frame[i].shown) seen.push_back({box, BoxUse::fresh, false});
    }
    return seen;
}

}  // namespace surefoot::cache
