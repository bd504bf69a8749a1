// The One-Euro filter: smooth for slow hands, fast for fast hands, with a bounded lag.
// Source: Casiez, Roussel & Vogel 2012, "1 EUR Filter: a simple speed-based low-pass filter for noisy input". Here with the exact
// discrete low pass 1 - exp(-2 pi fc dt), so that the response does not depend on the step rate.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rt/base/geometry.hpp"

namespace surefoot::input {

/// Parameters of the one-euro filter.
struct FilterSettings {
    double min_cutoff_hz = 4;   ///< for a hand that keeps still
    double slope = 3;           ///< Hz of cutoff per full deflection a second
    double rate_cutoff_hz = 2;  ///< of the speed estimate
};

inline double lag_of_cutoff_s(double cutoff_hz) { return 1 / (2 * std::numbers::pi * cutoff_hz); }
/// Lag behind a slow ramp, and an upper bound of the lag for every input; seconds.
inline double worst_lag_s(const FilterSettings& settings) { return lag_of_cutoff_s(settings.min_cutoff_hz); }

/// V: dvec2 or dvec3; one cutoff for all its parts, so that directions are kept.
template <class V>
struct OneEuro {
    V value{0.0}, last{0.0}, rate{0.0};

    /// dt_s > 0. The value stays in the convex hull of what went in. A still target at rest is reached exactly.
    const V& step(const FilterSettings& settings, const V& target, double dt_s) {
        const V speed = (target - last) / dt_s;
        last = target;
        rate += (speed - rate) * -std::expm1(-2 * std::numbers::pi * settings.rate_cutoff_hz * dt_s);
        const double cutoff_hz = settings.min_cutoff_hz + settings.slope * glm::length(rate);
        value += (target - value) * -std::expm1(-2 * std::numbers::pi * cutoff_hz * dt_s);
        if (target == V(0.0) && glm::length(value) < rest_below) value = V(0.0);
        return value;
    }
    void set(const V& to) {
        value = last = to;
        rate = V(0.0);
    }

    static constexpr double rest_below = 1.0 / 512;  ///< of full deflection: a low pass alone would creep for ever
};

}  // namespace surefoot::input
