// The part of a period that a frame used: one formula for live figures and for the summary.
#pragma once

#include <algorithm>
#include <cstdint>

#include "rt/frame/record.hpp"

namespace surefoot::rt {

/// CPU time used by the frame, ns: that of the frame thread, plus that of the rasterisers divided by their number. If a CPU clock
/// is unknown (GPU, virtual clock): the wall time of that part minus stolen time.
inline double busy_ns(const FrameRecord& f, std::uint32_t rasterisers) {
    const double stolen = static_cast<double>(f.stolen_ns);
    const double raster_wall = std::max(0.0, static_cast<double>(f.rastered_ns - f.submitted_ns) - stolen);
    if (f.cpu_ns <= 0) return std::max(0.0, static_cast<double>(f.rastered_ns - f.woken_ns) - stolen);
    const double raster = f.raster_cpu_ns > 0 ? static_cast<double>(f.raster_cpu_ns) / std::max(1U, rasterisers) : raster_wall;
    return static_cast<double>(f.cpu_ns) + raster;
}

}  // namespace surefoot::rt
