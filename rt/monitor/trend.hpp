// The trend of a figure over hours: a slope that a few odd samples cannot move.
#pragma once

#include <span>

namespace surefoot::rt {

struct TrendPoint {
    double time_s = 0, value = 0;
};

/// A line through the points: value = at_s0 + per_s * time_s.
struct Trend {
    bool known = false;  ///< at least two points at different times
    double per_s = 0;    ///< median of the slopes between all pairs of points
    double at_s0 = 0;    ///< median of what is left
};

/// Theil and Sen's estimator: up to 29 % of the points may be anything. More points than 512 are first put into 512 groups of
/// equal length in time, each of which counts by its median. Source: Sen 1968, "Estimates of the regression coefficient based on
/// Kendall's tau".
Trend robust_trend(std::span<const TrendPoint> points);

}  // namespace surefoot::rt
