// What a frame took of its grid: one formula, for the live figures and for the summary after the walk.
#pragma once

#include <algorithm>
#include <cstdint>

#include "rt/frame/record.hpp"

namespace surefoot::rt {

/// CPU time that the frame took of its grid: the frame thread's, and the rasterisers' as spread over their threads. Where a
/// clock is not known (a GPU, the virtual clock), the wall time of that part less what was stolen.
inline double busy_ns(const FrameRecord& f, std::uint32_t rasterisers) {
    const double stolen = static_cast<double>(f.stolen_ns);
    const double raster_wall = std::max(0.0, static_cast<double>(f.rastered_ns - f.submitted_ns) - stolen);
    if (f.cpu_ns <= 0) return std::max(0.0, static_cast<double>(f.rastered_ns - f.woken_ns) - stolen);
    const double raster = f.raster_cpu_ns > 0 ? static_cast<double>(f.raster_cpu_ns) / std::max(1U, rasterisers) : raster_wall;
    return static_cast<double>(f.cpu_ns) + raster;
}

}  // namespace surefoot::rt
