// Timing one frame (calibrate_run.hpp).
#include "render/measure/calibrate_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "rt/clock/clock.hpp"
#include "rt/threads/placement.hpp"

namespace surefoot::measure {

namespace {

double us(std::int64_t ns) { return 1e-3 * static_cast<double>(ns); }

}  // namespace

RasteriserClocks::RasteriserClocks() {
    const auto threads = rt::read_threads();
    if (!threads) return;
    const std::string rasteriser = gl::driver_thread_prefixes().front();
    std::vector<pid_t> found;
    for (const rt::ThreadInfo& thread : *threads)
        if (thread.name.starts_with(rasteriser)) found.push_back(thread.tid);
    clocks_ = rt::ThreadClocks(found);
}

FrameTiming run_frame(gl::Device& device, RasteriserClocks& rasterisers, const Pose& pose, std::span<const gl::DrawItem> items,
                      std::size_t slice_items, float resolution, std::span<const gl::CachePicture> pictures) {
    rasterisers.start();
    const std::int64_t cpu = rt::own_cpu_ns();
    const std::int64_t wall = rt::monotonic_ns();
    device.begin_frame(pose, resolution);
    for (std::size_t i = 0; i < items.size(); i += slice_items) {
        device.draw(items.subspan(i, std::min(slice_items, items.size() - i)));
        device.end_slice();
        device.wait_slices(1);
    }
    if (!pictures.empty()) {
        device.draw_pictures(pictures);
        device.end_slice();
        device.wait_slices(1);
    }
    device.end_items();
    const std::int64_t submitted = rt::monotonic_ns();
    device.finish_frame();
    const std::int64_t end = rt::monotonic_ns();
    FrameTiming timing;
    timing.wall_us = us(end - wall);
    timing.submit_us = us(rt::own_cpu_ns() - cpu);
    timing.raster_us = rasterisers.any() ? rasterisers.busiest_us() : us(end - submitted);
    return timing;
}

TimerQueryCheck judge_timer(bool available, double query_ms, double wall_ms) {
    TimerQueryCheck check{available, false, query_ms, wall_ms};
    check.honest = available && wall_ms > 0 && std::abs(query_ms - wall_ms) <= 0.2 * wall_ms;
    return check;
}

TimerQueryCheck check_timer(gl::Device& device, const Pose& pose, std::span<const gl::DrawItem> items) {
    device.begin_frame(pose);  // clears first: neither clock shall see it
    device.end_slice();
    device.wait_slices(0);
    const std::int64_t wall = rt::monotonic_ns();
    const bool available = device.begin_timer();
    device.draw(items);
    device.end_slice();
    device.wait_slices(0);
    const double wall_ms = 1e-3 * us(rt::monotonic_ns() - wall);
    const double query_ms = available ? device.end_timer_ms() : 0.0;
    device.finish_frame();
    return judge_timer(available, query_ms, wall_ms);
}

}  // namespace surefoot::measure
