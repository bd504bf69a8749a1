// The list of a frame's drawn items: memory reserved at open, and never more.
#pragma once

#include <vector>

#include "render/gl/device.hpp"
#include "rt/base/check.hpp"

namespace surefoot {

/// Appends without allocating. False if the reserved memory is full: the item is left out, and the check counts it.
inline bool push_within(std::vector<gl::DrawItem>& drawn, const gl::DrawItem& item) {
    if (!CHECK_RARE(drawn.size() < drawn.capacity(), "A cut and its stand-ins are at most twice the candidates")) return false;
    drawn.push_back(item);
    return true;
}

}  // namespace surefoot
