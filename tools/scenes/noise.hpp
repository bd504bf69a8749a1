// Smooth noise from a seed: the same everywhere, with or without a period (for textures that tile).
#pragma once

#include <cmath>
#include <cstdint>

#include "rt/base/hash.hpp"

namespace surefoot::scenes {

/// 0..1 at a lattice point.
inline double lattice(std::int64_t x, std::int64_t y, std::uint64_t seed) {
    std::uint64_t h = fnv1a(fnv1a(fnv1a(fnv_start, seed), static_cast<std::uint64_t>(x)), static_cast<std::uint64_t>(y));
    h = (h ^ (h >> 31U)) * 0x9e3779b97f4a7c15ULL;
    return static_cast<double>(h >> 11U) * 0x1.0p-53;
}

/// Value noise, 0..1; lattice cells of 1. `period` > 0: repeats after so many cells.
inline double noise(double x, double y, std::uint64_t seed, std::int64_t period = 0) {
    const double fx = std::floor(x), fy = std::floor(y);
    const double tx = x - fx, ty = y - fy;
    const double sx = tx * tx * (3 - 2 * tx), sy = ty * ty * (3 - 2 * ty);
    const auto wrap = [period](std::int64_t i) { return period > 0 ? ((i % period) + period) % period : i; };
    const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
    const double a = lattice(wrap(ix), wrap(iy), seed), b = lattice(wrap(ix + 1), wrap(iy), seed);
    const double c = lattice(wrap(ix), wrap(iy + 1), seed), d = lattice(wrap(ix + 1), wrap(iy + 1), seed);
    return (a + (b - a) * sx) * (1 - sy) + (c + (d - c) * sx) * sy;
}

/// Four octaves, 0..1.
inline double rough_noise(double x, double y, std::uint64_t seed, std::int64_t period = 0) {
    double sum = 0, weight = 0.5;
    for (std::uint64_t octave = 0; octave < 4; ++octave) {
        sum += weight * noise(x, y, seed + octave, period);
        x *= 2;
        y *= 2;
        period *= 2;
        weight *= 0.5;
    }
    return sum / 0.9375;
}

}  // namespace surefoot::scenes
