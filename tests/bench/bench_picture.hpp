// Pictures that benches compare: what a device shows, and full detail without jagged edges.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "render/engine.hpp"
#include "render/measure/image_metrics.hpp"
#include "tools/report/report.hpp"

namespace surefoot::bench {

using Pixels = std::vector<std::uint8_t>;  ///< R, G, B, A bytes

/// Empty if the device has no picture.
inline Pixels shown(gl::Device& device) {
    device.draws.plays();
    auto image = device.read_pixels();
    return image ? image->rgba : Pixels{};
}

inline double psnr_db(const Pixels& a, const Pixels& b) { return report::psnr_db(measure::snr(a, b).mse); }

/// The mean of 8 x 8 pictures of `items`, moved over a pixel.
inline Pixels grid_of_64(gl::Device& device, const Pose& pose, const std::vector<gl::DrawItem>& items) {
    device.draws.plays();
    std::vector<double> sum;
    for (int i = 0; i < 64; ++i) {
        const int column = i % 8, row = i / 8;
        device.begin_rest(pose, {(column + 0.5) / 8 - 0.5, (row + 0.5) / 8 - 0.5});
        for (const gl::Parts parts : {gl::Parts::opaque, gl::Parts::blended}) device.draw_rest(items, parts);
        device.show_rest(1);
        device.finish_rest_frame();
        const Pixels one = shown(device);
        sum.resize(one.size());
        for (std::size_t p = 0; p < one.size(); ++p) sum[p] += double(one[p]);
    }
    Pixels mean(sum.size());
    for (std::size_t p = 0; p < sum.size(); ++p) mean[p] = static_cast<std::uint8_t>(std::lround(sum[p] / 64));
    return mean;
}

}  // namespace surefoot::bench
