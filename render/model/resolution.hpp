// Steps of resolution: the shares of the picture's width and height at which a frame may be drawn, before it is enlarged.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "render/model/view.hpp"

namespace surefoot::model {

/// Descending. A device has a target for each of them.
constexpr std::array<float, 5> resolution_steps{1.0F, 0.875F, 0.75F, 0.625F, 0.5F};

/// Index of the largest step that is not above `wanted`, else of the least. NaN, zero and negative values mean 1.
inline std::size_t resolution_step(float wanted) {
    if (!(wanted > 0)) return 0;
    std::size_t step = 0;
    while (step + 1 < resolution_steps.size() && resolution_steps[step] > wanted) ++step;
    return step;
}

/// Size of what is drawn at a step, in pixels: at least one each way.
inline Viewport viewport_of_step(Viewport viewport, std::size_t step) {
    const auto part = [&](std::uint32_t side) {
        return std::max(1U, static_cast<std::uint32_t>(std::lround(static_cast<float>(side) * resolution_steps[step])));
    };
    viewport.width = part(viewport.width);
    viewport.height = part(viewport.height);
    return viewport;
}

}  // namespace surefoot::model
