// Boxes out of view: what they cost when they are seen, and what goes for a picture that is worth more.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "render/cache/walk_cache.hpp"

namespace surefoot::cache {

namespace {

constexpr double known_share = 0.5;   // of a box's distance: so far may the eye have moved since its cost was measured
constexpr float max_spent_share = 4;  // of the cost table's price, which is of all sides in the mean
constexpr float worth_factor = 2;     // a picture that goes for another must be worth so many times less

bool whole_in(const model::Frustum& frustum, const Box& box) {
    if (box.empty()) return true;
    const dvec3 centre = box.centre(), half = box.half();
    return std::all_of(frustum.planes.begin(), frustum.planes.end(), [&](const dvec4& p) {
        const double reach = std::abs(p.x) * half.x + std::abs(p.y) * half.y + std::abs(p.z) * half.z;
        return p.x * centre.x + p.y * centre.y + p.z * centre.z + p.w >= reach;
    });
}

bool overlap(const Slot& a, const Slot& b) {
    return a.layer == b.layer && a.column < b.column + b.texels && b.column < a.column + a.texels && a.row < b.row + b.texels &&
           b.row < a.row + a.texels;
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
/// in view say which.
void WalkCache::estimate(Index box, const PlanView& view) {
    if (!options_.surround) return;
    if (box == 0) {
        if (priced_us_ > 0) spent_share_ = std::min(static_cast<float>(known_us_ / priced_us_), max_spent_share);
        known_us_ = priced_us_ = 0;
    }
    const Box& filled = boxes_.filled(box);
    if (filled.empty() || !boxes_.may_have_picture(box)) return;
    const double distance = std::max(filled.distance(view.course.eye), model::near_plane_m);
    const bool known = glm::length(view.course.eye - known_from_[box]) <= known_share * distance;
    const bool is_leaf = boxes_.tree().boxes[box].child_count == 0;
    if (known && !(is_leaf && seen_now_[box])) return;
    float price_us = 0;
    if (is_leaf) price_us = us_of(view.combine, boxes_.capture_cost(box, 1 / (view.pixel_rad * distance)));
    if (!known) {
        across_us_[box] = spent_share_ * price_us;
        return;
    }
    known_us_ += static_cast<double>(across_us_[box]);
    priced_us_ += static_cast<double>(price_us);
}

/// What it saves in a frame, by how likely it is seen.
float WalkCache::worth_us(Index box, float net_us) const { return in_view_[box] ? net_us : share_out_of_view * net_us; }

/// For a picture that found no room, the place whose pictures are worth the least is left within a few frames: no further set is
/// told of them. In a full cache all others are valid, so that time alone would make no room.
void WalkCache::make_room_by_worth() {
    const Refused refused = std::exchange(refused_, {});
    if (!options_.surround || refused.texels == 0) return;
    std::fill(cell_worth_us_.begin(), cell_worth_us_.end(), 0.0F);
    const std::uint32_t side = refused.texels / min_slot_texels;
    const auto cells_of = [](std::uint32_t layer, std::uint32_t y) { return (layer * cells_a_side + y) * cells_a_side; };
    for (Index i = 0; i < held_.size(); ++i) {
        const HeldPicture& held = held_[i];
        if (!held.any()) continue;
        if (held.until != 0) return;  // there will be room
        const std::uint32_t across = held.slot.texels / min_slot_texels, shared = std::min(across, side) * std::min(across, side);
        const bool serves = last_covered_[i] + 1 >= frame_;
        const float each_us = serves ? worth_us(i, own_us_[i]) / static_cast<float>(shared) : 0.0F;
        const std::uint32_t column = held.slot.column / min_slot_texels, row = held.slot.row / min_slot_texels;
        for (std::uint32_t y = row; y < row + across; ++y)
            for (std::uint32_t x = column; x < column + across; ++x)
                cell_worth_us_[cells_of(held.slot.layer, y) + x] += is_pending(i) ? refused.worth_us : each_us;
    }
    Slot place;
    float min_us = refused.worth_us / worth_factor;
    for (std::uint32_t layer = 0; layer < slots_.layers(); ++layer) {
        for (std::uint32_t cell = 0; cell < cells_a_side * cells_a_side; cell += side) {
            const std::uint32_t row = cell / cells_a_side, column = cell % cells_a_side;
            if (row % side != 0) continue;
            float sum_us = 0;
            for (std::uint32_t y = row; y < row + side; ++y)
                for (std::uint32_t x = column; x < column + side; ++x) sum_us += cell_worth_us_[cells_of(layer, y) + x];
            if (!(sum_us < min_us)) continue;
            min_us = sum_us;
            place = {static_cast<std::uint16_t>(layer), static_cast<std::uint16_t>(column * min_slot_texels),
                     static_cast<std::uint16_t>(row * min_slot_texels), static_cast<std::uint16_t>(refused.texels)};
        }
    }
    if (place.texels == 0) return;
    for (HeldPicture& held : held_)
        if (held.any() && overlap(held.slot, place)) held.until = frame_ + relied_frames;
}

}  // namespace surefoot::cache
