// Recorded paths: poses over time, read from and written to CSV (DESIGN 6), sampled in between.
#pragma once

#include <string>
#include <vector>

#include "rt/base/geometry.hpp"
#include "rt/base/result.hpp"

namespace surefoot {

struct PathSample {
    double time_s = 0.0;
    Pose pose;
};

/// At least one sample; times strictly increasing.
struct Path {
    std::vector<PathSample> samples;
    [[nodiscard]] double duration_s() const { return samples.empty() ? 0.0 : samples.back().time_s - samples.front().time_s; }
};

/// Of a path's rows: times in seconds (Unix time fits), coordinates in metres (the Earth fits), quaternion parts.
constexpr double path_time_limit_s = 1e11, path_coordinate_limit_m = 1e9, path_quaternion_limit = 1e6;

/// CSV `time_s,x,y,z,qx,qy,qz,qw,fov_y_deg`; '#' comments; a header row is allowed. A last column that is missing, or
/// that is not named fov_y_deg in a comment or header (recorded drives: speed), means 60 degrees.
/// Bad rows (not numbers, not finite, beyond the limits below, zero quaternion, time not increasing) are an error with their
/// line number.
Result<Path> read_path(const std::string& file);
Result<void> write_path(const std::string& file, const Path& path);

/// The pose at `time_s` from the path's start: linear in position, slerp in orientation; clamped at both ends.
Pose sample_path(const Path& path, double time_s);

}  // namespace surefoot
