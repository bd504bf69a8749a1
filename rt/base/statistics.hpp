// Quantiles, robust estimates and a permutation test over plain numbers. Pure functions.
#pragma once

#include <span>
#include <vector>

namespace surefoot {

/// The value that a share q of all lie below, without interpolation: of n values the one of rank floor(q n), from 0. 0 for none.
double quantile_of(std::vector<double> values, double q);
/// The middle one, or the mean of the two in the middle; 0 for none.
double median_of(std::vector<double> values);

struct Quantiles {
    double p50 = 0, p90 = 0, p99 = 0, p999 = 0, max = 0, mean = 0, min = 0;
};
/// By nearest rank: the smallest value that at least a share q of all do not exceed, so never a value that did not occur. What is
/// not finite is left out; all 0 where nothing is left.
Quantiles quantiles(std::vector<double> values);

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

/// Huber's weight of a sample in a least-squares fit: 1 up to an error of `tolerated`, falling with 1 / error beyond it.
inline double huber_weight(double error, double tolerated) { return error <= tolerated ? 1.0 : tolerated / error; }

/// One-sided sign-flip permutation test: the chance, if both sides were the same, of a sum of differences at least as large as
/// the one seen. Exact (all 2^n sign patterns, by dynamic programming over sums). 1 for no differences.
double sign_flip_p_value(std::span<const int> differences);

}  // namespace surefoot
