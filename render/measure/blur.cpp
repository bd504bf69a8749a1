// Loss of value by blur (blur.hpp).
#include "render/measure/blur.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/measure/image_metrics.hpp"

namespace surefoot::measure {

namespace {

constexpr double value_of_squared_error = 6;  // found proportional, see render/prepare
constexpr double white = 255;

}  // namespace

double blur_loss_of(std::span<const std::uint8_t> enlarged, std::span<const std::uint8_t> full) {
    if (full.empty() || enlarged.size() != full.size()) return std::numeric_limits<double>::quiet_NaN();
    return value_of_squared_error * snr(enlarged, full).mse / (white * white);
}

Result<model::BlurLoss> mean_blur_loss(std::span<const PoseBlur> poses) {
    const auto refuse = [](const char* what) {
        return Error{"blur", what, "Give another path with --path, or another backend", ErrorKind::misuse};
    };
    if (poses.empty()) return refuse("There is no pose to measure the blur at");
    PoseBlur mean{};
    for (const PoseBlur& pose : poses) {
        for (std::size_t step = 0; step < pose.size(); ++step) {
            if (!std::isfinite(pose[step]) || pose[step] < 0) return refuse("A measured loss is negative or not a finite number");
            mean[step] += pose[step] / static_cast<double>(poses.size());
        }
    }
    model::BlurLoss losses{};
    for (std::size_t step = 1; step < losses.size(); ++step)
        losses[step] = std::clamp(static_cast<float>(mean[step]), losses[step - 1], 1.0F);
    return losses;
}

}  // namespace surefoot::measure
