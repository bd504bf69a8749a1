// Quantiles, robust estimates and a permutation test over plain numbers. Pure functions.
#pragma once

#include <span>
#include <vector>

namespace surefoot {

/// The value of rank floor(q n), from 0, of n values in ascending order; no interpolation. 0 if there are none.
double quantile_of(std::vector<double> values, double q);
/// The middle value, or the mean of the two middle ones; 0 if there are none.
double median_of(std::vector<double> values);

/// Quantiles and extremes of a set of values, in its unit.
struct Quantiles {
    double p50 = 0, p90 = 0, p99 = 0, p999 = 0, max = 0, mean = 0, min = 0;
};
/// By nearest rank: the smallest value v such that at least a share q of all values are <= v. So it always is one of the values.
/// Non-finite values are ignored; all results are 0 if none is left.
Quantiles quantiles(std::vector<double> values);

/// One point of a series whose trend is fitted.
struct TrendPoint {
    double time_s = 0, value = 0;
};

/// A line through the points: value = at_s0 + per_s * time_s.
struct Trend {
    bool known = false;  ///< at least two points at different times
    double per_s = 0;    ///< median of the slopes between all pairs of points
    double at_s0 = 0;    ///< median of value - per_s * time_s
};

/// Theil-Sen estimator: tolerates up to 29 % outliers. More than 512 points are first replaced by the medians of 512 groups of
/// equal length in time. Source: Sen 1968, "Estimates of the regression coefficient based on Kendall's tau".
Trend robust_trend(std::span<const TrendPoint> points);

/// Huber's weight of a sample in a least-squares fit: 1 up to an error of `tolerated`, falling with 1 / error beyond it.
inline double huber_weight(double error, double tolerated) { return error <= tolerated ? 1.0 : tolerated / error; }

/// One-sided sign-flip permutation test: the probability of a sum at least as large as the observed one, if both sides were
/// equal. Exact: all 2^n sign patterns, by dynamic programming over sums. 1 if there are no differences.
double sign_flip_p_value(std::span<const int> differences);

}  // namespace surefoot
