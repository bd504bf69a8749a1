// Timing one frame (calibrate_run.hpp).
#include "render/measure/calibrate_run.hpp"

#include <dirent.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

namespace surefoot::measure {

namespace {

std::int64_t clock_ns(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

/// The kernel's clock id of another thread's CPU time (CPUCLOCK_SCHED per thread), as pthread_getcpuclockid makes it.
clockid_t thread_clock(int thread) { return static_cast<clockid_t>((~static_cast<unsigned>(thread) << 3U) | 6U); }

double us(std::int64_t ns) { return 1e-3 * static_cast<double>(ns); }

}  // namespace

RasteriserClocks::RasteriserClocks() {
    DIR* folder = opendir("/proc/self/task");
    if (folder == nullptr) return;
    const std::string rasteriser = gl::driver_thread_prefixes().front();
    while (const dirent* entry = readdir(folder)) {
        std::ifstream file(std::string("/proc/self/task/") + entry->d_name + "/comm");
        std::string name;
        if (std::getline(file, name) && name.starts_with(rasteriser)) threads_.push_back(std::atoi(entry->d_name));
    }
    closedir(folder);
    before_.resize(threads_.size());
}

void RasteriserClocks::start() {
    for (std::size_t i = 0; i < threads_.size(); ++i) before_[i] = clock_ns(thread_clock(threads_[i]));
}

double RasteriserClocks::busiest_us() const {
    double most = 0;
    for (std::size_t i = 0; i < threads_.size(); ++i) most = std::max(most, us(clock_ns(thread_clock(threads_[i])) - before_[i]));
    return most;
}

FrameTiming run_frame(gl::Device& device, RasteriserClocks& rasterisers, const Pose& pose, std::span<const gl::DrawItem> items,
                      std::size_t slice_items) {
    rasterisers.start();
    const std::int64_t cpu = clock_ns(CLOCK_THREAD_CPUTIME_ID);
    const std::int64_t wall = clock_ns(CLOCK_MONOTONIC);
    device.begin_frame(pose);
    for (std::size_t i = 0; i < items.size(); i += slice_items) {
        device.draw(items.subspan(i, std::min(slice_items, items.size() - i)));
        device.end_slice();
        device.wait_slices(1);
    }
    device.end_items();
    const std::int64_t submitted = clock_ns(CLOCK_MONOTONIC);
    device.finish_frame();
    const std::int64_t end = clock_ns(CLOCK_MONOTONIC);
    FrameTiming timing;
    timing.wall_us = us(end - wall);
    timing.submit_us = us(clock_ns(CLOCK_THREAD_CPUTIME_ID) - cpu);
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
    const std::int64_t wall = clock_ns(CLOCK_MONOTONIC);
    const bool available = device.begin_timer();
    device.draw(items);
    device.end_slice();
    device.wait_slices(0);
    const double wall_ms = 1e-3 * us(clock_ns(CLOCK_MONOTONIC) - wall);
    const double query_ms = available ? device.end_timer_ms() : 0.0;
    device.finish_frame();
    return judge_timer(available, query_ms, wall_ms);
}

}  // namespace surefoot::measure
