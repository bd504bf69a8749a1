// Calibration: measures this machine's cost table, how items add up to a frame, and whether timer queries are reliable.
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

/// Whether timer queries of the driver agree with wall time.
struct TimerQueryCheck {
    bool available = false, honest = false;
    double query_ms = 0, wall_ms = 0;  ///< the same work, by timer query and by fence and wall time
};

/// One measured point of the cost table.
struct CalibrationPoint {
    model::EffectMask effects = 0;
    double triangles = 0, pixels = 0;
    double submit_us = 0, raster_us = 0, wall_us = 0;
    double spread = 0;  ///< (p90 - p10) / p50 of the repeats
};

/// The result of a calibration.
struct Calibration {
    model::CostModel costs;
    TimerQueryCheck timer;
    std::vector<CalibrationPoint> points;
    double frame_error_p50 = 0, frame_error_p90 = 0,
           frame_error_p99 = 0;  ///< relative error of predicted whole frames that the fit did not see
    double seconds = 0;
};

/// Settings of a calibration.
struct CalibrateOptions {
    gl::DeviceOptions device;
    bool quick = false;  ///< fewer classes and repeats: under 20 s; else under 2 min
    std::uint64_t seed = 1;
    /// Called once, on the calling thread, when the driver's threads exist. Place them here as a walk does: priorities and
    /// cores. May be empty.
    std::function<void()> opened;
};

Result<Calibration> calibrate(const CalibrateOptions& options, const Progress& progress);

/// Largest time of enlarging, or of what is behind everything, in a table: ns for a pixel of the whole picture.
constexpr double max_enlarge_ns = 100;
/// Largest CostModel::ns_per_pixel.
constexpr double max_ns_per_pixel = 100;
/// Of EffectPrice, for a triangle.
constexpr double max_effect_ns_per_triangle = 1e5;
/// Of CostModel::sample_share, sample_pass_ns_per_pixel and trilinear_factor.
constexpr double max_sample_share = 4, max_sample_pass_ns = 100, max_trilinear_factor = 4;

/// Of CostModel::picture_us and capture_us. Nothing is free.
constexpr double min_picture_us = 0.01, max_picture_us = 1e5;
/// Least of CostModel::picture_ns_per_pixel and capture_ns_per_texel.
constexpr double min_picture_ns = 0.01;

/// Equal for equal tables. Tells from which table a fit to a model was made.
std::uint64_t hash_of(const model::CostModel& costs);
/// The table as a file: TOML text with a checksum in its first line.
/// read_costs refuses a file that was changed, and a table measured on another machine than `machine` (empty: any).
Result<void> write_costs(const std::string& file, const model::CostModel& costs);
Result<model::CostModel> read_costs(const std::string& file, const std::string& machine);
/// The machine that a table is valid for: CPU model, core count, GL renderer, rasterisers (0: the device's default).
std::string machine_identity(const std::string& gl_renderer, int rasterisers);

}  // namespace surefoot::measure
