// Boxes out of view: what they cost when they are seen.
#include <algorithm>
#include <cmath>

#include "render/cache/walk_cache.hpp"

namespace surefoot::cache {

namespace {

constexpr double known_share = 0.5;   // of a box's distance: so far may the eye have moved since its cost was measured
constexpr float max_spent_share = 4;  // of the cost table's price, which is of all sides in the mean

bool whole_in(const model::Frustum& frustum, const Box& box) {
    if (box.empty()) return true;
    const dvec3 centre = box.centre(), half = box.half();
    return std::all_of(frustum.planes.begin(), frustum.planes.end(), [&](const dvec4& p) {
        const double reach = std::abs(p.x) * half.x + std::abs(p.y) * half.y + std::abs(p.z) * half.z;
        return p.x * centre.x + p.y * centre.y + p.z * centre.z + p.w >= reach;
    });
}

}  // namespace

/// Whether the last cut says what the box costs when it is seen: all of it was in view, or what was costs more than is known.
bool WalkCache::measured(Index box) {
    if (!options_.surround) return true;
    seen_now_[box] = planned_ && whole_in(seen_, boxes_.filled(box));
    if (!seen_now_[box] && !(planned_ && cost_us_[box] > across_us_[box])) return false;
    known_from_[box] = seen_from_;
    return true;
}

/// The cost table's price stands for a cost that no cut has told, or one from too far away. Cuts spend a share of it: the boxes
/// in view say which. What is shown there is estimated alike, by the pixels of the box's faces.
void WalkCache::estimate(Index box, const PlanView& view) {
    if (!options_.surround) return;
    if (box == 0) {
        if (priced_us_ > 0) spent_share_ = std::min(static_cast<float>(known_us_ / priced_us_), max_spent_share);
        if (known_px_ > 0) value_a_px_ = static_cast<float>(known_value_ / known_px_);
        known_us_ = priced_us_ = known_value_ = known_px_ = 0;
    }
    const Box& filled = boxes_.filled(box);
    if (filled.empty() || !boxes_.may_have_picture(box)) return;
    const double distance = std::max(filled.distance(view.course.eye), model::near_plane_m);
    const bool known = glm::length(view.course.eye - known_from_[box]) <= known_share * distance;
    const bool is_leaf = boxes_.tree().boxes[box].child_count == 0;
    if (known && !(is_leaf && seen_now_[box])) return;
    float price_us = 0;
    double pixels = 0;
    if (is_leaf) {
        price_us = us_of(view.combine, boxes_.capture_cost(box, 1 / (view.pixel_rad * distance)));
        pixels = std::min(view.view_px, faces_sr(filled, view.course.eye) / (view.pixel_rad * view.pixel_rad));
    }
    if (!known) {
        across_us_[box] = spent_share_ * price_us;
        if (is_leaf && !set_[box]) value_[box] = {value_a_px_ * static_cast<float>(pixels), 0};
        return;
    }
    known_us_ += static_cast<double>(across_us_[box]);
    priced_us_ += static_cast<double>(price_us);
    known_value_ += static_cast<double>(value_[box].full);
    known_px_ += pixels;
}

}  // namespace surefoot::cache
