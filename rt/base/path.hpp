// Recorded paths: poses over time, read from and written to CSV, interpolated in between.
#pragma once

#include <string>
#include <vector>

#include "rt/base/geometry.hpp"
#include "rt/base/result.hpp"

namespace surefoot {

/// One sample of a path.
struct PathSample {
    double time_s = 0.0;
    Pose pose;
};

/// At least one sample; times strictly increasing.
struct Path {
    std::vector<PathSample> samples;
    [[nodiscard]] double duration_s() const { return samples.empty() ? 0.0 : samples.back().time_s - samples.front().time_s; }
};

/// Limits of a row, either side of 0: time in seconds (Unix time fits), coordinates in metres (the Earth fits), quaternion parts.
constexpr double path_time_limit_s = 1e11, path_coordinate_limit_m = 1e9, path_quaternion_limit = 1e6;

/// CSV `time_s,x,y,z,qx,qy,qz,qw,fov_y_deg`; '#' starts a comment; a header row is allowed. The last column is optional.
/// It counts only if a comment or header names it fov_y_deg; in recorded drives it is the speed. Otherwise the field of view is
/// 60 degrees. Errors, with line number: not a number, not finite, beyond a limit, zero quaternion, time not increasing.
Result<Path> read_path(const std::string& file);
Result<void> write_path(const std::string& file, const Path& path);

/// The pose at `time_s` from the path's start: linear in position, slerp in orientation; clamped at both ends.
Pose sample_path(const Path& path, double time_s);

}  // namespace surefoot
