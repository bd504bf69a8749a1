// How far a form's picture is off full detail, as measured by the bake, and how that depends on its size on the screen.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace surefoot::model {

/// The sky's colour, 0..1, where no setting names another.
constexpr std::array<float, 3> usual_sky = {0.62F, 0.72F, 0.82F};

/// The sizes for which forms are compared: square root of the outline's pixels, fine to coarse. Textures blur towards the last.
constexpr std::array<float, 3> loss_sizes_px = {512.0F, 64.0F, 8.0F};

/// Of one form, against its node's full detail. All zero: no difference was found.
struct PictureLoss {
    float coverage = 0;  ///< 0..1: pixels that one of the two pictures covers and the other does not, by those of full detail
    /// 0..1, by loss_sizes_px: squared difference of the colours (0..1, mean of three channels), for each pixel that full detail
    /// covers. Where only one of the pictures covers a pixel, the other shows any colour of the model.
    std::array<float, loss_sizes_px.size()> colour{};
};

/// Of one form on a part of its node, as PictureLoss.
struct LossOfGroup {
    std::array<float, loss_sizes_px.size()> colour{};
};

/// The colours that the leaves of a model show, 0..1.
struct ColourSpread {
    std::array<float, 3> mean{};
    float variance = 0;  ///< mean of three channels
};

/// The colour loss at a size; between the measured sizes by the size's logarithm, beyond them constant.
inline float loss_at(const PictureLoss& loss, float size_px) {
    constexpr float octaves = 3.0F;  // between two sizes
    const float at = std::log2(loss_sizes_px[0] / std::clamp(size_px, loss_sizes_px.back(), loss_sizes_px[0])) / octaves;
    const float within = std::max(0.0F, at);  // a size that is no number counts as the largest
    const auto from = std::min(static_cast<std::size_t>(within), loss_sizes_px.size() - 2);
    return loss.colour[from] + (loss.colour[from + 1] - loss.colour[from]) * (within - static_cast<float>(from));
}

}  // namespace surefoot::model
