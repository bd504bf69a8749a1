// The view of tests that work out pixels by hand: 1280 x 720 of them, 1000 a radian.
#pragma once

#include "render/model/pixels.hpp"

namespace surefoot::test {

inline model::ViewScale plain_view() {
    model::ViewScale scale;
    scale.tan_half_x = 0.64F;
    scale.tan_half_y = 0.36F;
    scale.pixels_per_radian = 1000.0F;
    return scale;
}

}  // namespace surefoot::test
