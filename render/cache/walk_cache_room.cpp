// Room in a full cache: what goes for a picture that is worth more, and what waits for its place.
#include <algorithm>
#include <limits>

#include "render/cache/walk_cache.hpp"

namespace surefoot::cache {

namespace {

constexpr float worth_factor = 2;        // a picture that goes for another must be worth so many times less
constexpr std::size_t max_searches = 2;  // for a place, in a frame

bool overlap(const Slot& a, const Slot& b) {
    return a.layer == b.layer && a.column < b.column + b.texels && b.column < a.column + a.texels && a.row < b.row + b.texels &&
           b.row < a.row + a.texels;
}

}  // namespace

/// What a picture whose box was refused is worth; it waits until a place for it is found and left.
void WalkCache::refuse(Index box, std::uint32_t texels) {
    if (frame_ < no_place_until_[size_of(texels)] || refused_.size() == max_refused) return;
    if (std::any_of(refused_.begin(), refused_.end(), [&](const Refused& other) { return other.box == box; })) return;
    refused_.push_back({box, texels, own_us_[box], 0});
}

/// A place that is left for a picture is not for one that is worth less, nor is a part of it that is free already.
bool WalkCache::takes_place_of_waiting(const Candidate& candidate, std::uint32_t texels) const {
    if (held_[candidate.box].slot.texels == texels) return false;  // it has a place of its own
    bool less = false;
    for (const Refused& each : refused_) {
        if (each.until == 0) continue;
        if (each.box == candidate.box) return false;
        less = less || candidate.net_us < each.worth_us;
    }
    return less;
}

/// Whether a picture of a larger box is drawn in place of the box's own.
bool WalkCache::shown_by_larger(Index box) const {
    for (Index i = boxes_.tree().boxes[box].parent; i != none; i = boxes_.tree().boxes[i].parent)
        if (held_[i].any() && held_[i].until == 0 && last_covered_[i] + 1 >= frame_) return true;
    return false;
}

/// By square of 64 texels: what its pictures save in a frame, shared so that a place of `side` squares sums up to what goes with
/// it. What goes already, or waits to be captured, is not to go for another.
void WalkCache::sum_up_worth(std::uint32_t side) {
    std::fill(cell_worth_us_.begin(), cell_worth_us_.end(), 0.0F);
    for (Index i = 0; i < held_.size(); ++i) {
        const HeldPicture& held = held_[i];
        if (!held.any()) continue;
        const std::uint32_t across = held.slot.texels / min_slot_texels, shared = std::min(across, side) * std::min(across, side);
        const bool serves = last_covered_[i] + 1 >= frame_ && !shown_by_larger(i);
        float worth_us = serves ? own_us_[i] / static_cast<float>(shared) : 0.0F;
        if (held.until != 0 || is_pending(i)) worth_us = std::numeric_limits<float>::infinity();
        const std::uint32_t column = held.slot.column / min_slot_texels, row = held.slot.row / min_slot_texels;
        for (std::uint32_t y = row; y < row + across; ++y)
            for (std::uint32_t x = column; x < column + across; ++x) cell_worth_us_[cell_of(held.slot.layer, y, x)] = worth_us;
    }
}

/// The place whose pictures are worth the least, if that is less than a share of what was refused. Else Slot::texels is 0.
Slot WalkCache::place_for(const Refused& refused) const {
    const std::uint32_t side = refused.texels / min_slot_texels;
    Slot place;
    float min_us = refused.worth_us / worth_factor;
    for (std::uint32_t layer = 0; layer < slots_.layers(); ++layer) {
        for (std::uint32_t cell = 0; cell < cells_a_side * cells_a_side; cell += side) {
            const std::uint32_t row = cell / cells_a_side, column = cell % cells_a_side;
            if (row % side != 0) continue;
            float sum_us = 0;
            for (std::uint32_t y = row; y < row + side; ++y)
                for (std::uint32_t x = column; x < column + side; ++x) sum_us += cell_worth_us_[cell_of(layer, y, x)];
            if (!(sum_us < min_us)) continue;
            min_us = sum_us;
            place = {static_cast<std::uint16_t>(layer), static_cast<std::uint16_t>(column * min_slot_texels),
                     static_cast<std::uint16_t>(row * min_slot_texels), static_cast<std::uint16_t>(refused.texels)};
        }
    }
    return place;
}

/// For pictures that found no room, the places whose pictures are worth the least are left within a few frames: no further set is
/// told of them. In a full cache others may all be valid, so that time alone would make no room.
void WalkCache::make_room_by_worth() {
    std::erase_if(refused_, [&](const Refused& each) { return each.until != 0 && frame_ > each.until + 1; });
    std::size_t searches = 0;
    for (Refused& refused : refused_) {
        if (refused.until != 0 || frame_ < no_place_until_[size_of(refused.texels)]) continue;
        if (++searches > max_searches) break;
        sum_up_worth(refused.texels / min_slot_texels);
        const Slot place = place_for(refused);
        if (place.texels == 0) {
            no_place_until_[size_of(refused.texels)] = frame_ + options_.kept_frames;
            continue;
        }
        refused.until = frame_ + relied_frames;
        for (Index i = 0; i < held_.size(); ++i) {
            if (!held_[i].any() || !overlap(held_[i].slot, place)) continue;
            held_[i].until = refused.until;
            if (i != refused.box) out_until_[i] = refused.until + options_.kept_frames;
        }
    }
    std::erase_if(refused_,
                  [&](const Refused& each) { return each.until == 0 && frame_ < no_place_until_[size_of(each.texels)]; });
}

}  // namespace surefoot::cache
