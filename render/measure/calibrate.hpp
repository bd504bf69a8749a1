// Measures this machine's cost table and how items add up to a frame, and whether a timer query is honest.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/device.hpp"
#include "render/model/cost.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"

namespace surefoot::measure {

struct TimerQueryCheck {
    bool available = false, honest = false;
    double query_ms = 0, wall_ms = 0;  ///< the same work by query and by fence and wall time
};

struct CalibrationPoint {
    model::EffectMask effects = 0;
    double triangles = 0, pixels = 0;
    double submit_us = 0, raster_us = 0, wall_us = 0;
    double spread = 0;  ///< (p90 - p10) / p50 of the repeats
};

struct Calibration {
    model::CostModel costs;
    TimerQueryCheck timer;
    std::vector<CalibrationPoint> points;
    double frame_error_p50 = 0, frame_error_p90 = 0, frame_error_p99 = 0;  ///< of held-out whole frames
    double seconds = 0;
};

struct CalibrateOptions {
    gl::DeviceOptions device;
    bool quick = false;  ///< fewer classes and repeats: under 20 s; else under 2 min
    std::uint64_t seed = 1;
    /// Called once, on the calling thread, when the driver's threads exist: the place to give them the priorities and cores
    /// that a walk gives them. May be empty.
    std::function<void()> opened;
};

Result<Calibration> calibrate(const CalibrateOptions& options, const Progress& progress);

/// The table as a file: TOML text with a checksum in its first line. read refuses a file of which a byte was changed, and the
/// table of another machine than `machine` (empty: any machine's), by name.
/// The same for equal tables: which table a fit to a model was made from.
std::uint64_t hash_of(const model::CostModel& costs);
Result<void> write_costs(const std::string& file, const model::CostModel& costs);
Result<model::CostModel> read_costs(const std::string& file, const std::string& machine);
/// CPU model, core count, GL renderer, rasterisers (0: as many as the device takes): what a table is valid for.
std::string machine_identity(const std::string& gl_renderer, int rasterisers);

}  // namespace surefoot::measure
