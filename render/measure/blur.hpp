// Loss of value of enlarged pictures against full detail, as the chooser of the resolution counts it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "render/model/cost.hpp"
#include "rt/base/result.hpp"

namespace surefoot::measure {

/// Six times the mean squared error of R, G and B in 0..1; alpha is ignored. NaN if the pictures are empty or differ in size.
double blur_loss_of(std::span<const std::uint8_t> enlarged, std::span<const std::uint8_t> full);

/// Losses at one pose, by model::resolution_steps.
using PoseBlur = std::array<double, model::resolution_steps.size()>;

/// The mean over poses: 0 at full resolution, not falling towards lower ones, at most 1. An error if there is no pose, or if a
/// loss is negative or not finite.
Result<model::BlurLoss> mean_blur_loss(std::span<const PoseBlur> poses);

}  // namespace surefoot::measure
