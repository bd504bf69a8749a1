// Times one frame: CPU time of the frame thread, CPU time of the rasterisers, wall time.
#pragma once

#include <span>

#include "render/gl/device.hpp"
#include "render/measure/calibrate.hpp"
#include "rt/threads/usage.hpp"

namespace surefoot::measure {

/// us. submit: CPU time of the calling thread. raster: CPU time of the driver's busiest rasteriser; on a GPU, the wait after
/// the last call.
struct FrameTiming {
    double submit_us = 0, raster_us = 0, wall_us = 0;
};

/// CPU clocks of the driver's rasteriser threads, found by name. Empty for hardware.
class RasteriserClocks {
public:
    RasteriserClocks();
    [[nodiscard]] bool any() const { return clocks_.size() > 0; }
    void start() { clocks_.start(); }
    [[nodiscard]] double busiest_us() const { return 1e-3 * static_cast<double>(clocks_.spent().longest_ns); }

private:
    rt::ThreadClocks clocks_;
};

/// Draws the items in slices of slice_items, at most one slice ahead of the rasterisers. The engine's slices are longer. Then
/// pictures of the image cache, as one slice.
FrameTiming run_frame(gl::Device& device, RasteriserClocks& rasterisers, const Pose& pose, std::span<const gl::DrawItem> items,
                      std::size_t slice_items, float resolution = 1, std::span<const gl::CachePicture> pictures = {})
    REQUIRES(device.draws);

/// Measures the same work by timer query and by wall time. Draws `items` as one slice.
TimerQueryCheck check_timer(gl::Device& device, const Pose& pose, std::span<const gl::DrawItem> items) REQUIRES(device.draws);
/// Honest: the query is within 20 % of wall time.
TimerQueryCheck judge_timer(bool available, double query_ms, double wall_ms);

}  // namespace surefoot::measure
