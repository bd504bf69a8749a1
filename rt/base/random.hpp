// Seeded random numbers with the same sequence on every machine and library: SplitMix64 seeding xoshiro256**.
#pragma once

#include <array>
#include <cstdint>

#include "rt/base/geometry.hpp"

namespace surefoot {

/// Deterministic generator. Source: Blackman & Vigna, xoshiro256** 1.0 (public domain reference algorithm).
class Random {
public:
    explicit Random(std::uint64_t seed) {
        for (auto& word : state_) {
            seed += 0x9e3779b97f4a7c15ULL;
            std::uint64_t z = seed;
            z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
            z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
            word = z ^ (z >> 31U);
        }
    }
    std::uint64_t next() {
        const std::uint64_t result = rotl(state_[1] * 5, 7) * 9;
        const std::uint64_t t = state_[1] << 17U;
        state_[2] ^= state_[0];
        state_[3] ^= state_[1];
        state_[1] ^= state_[2];
        state_[0] ^= state_[3];
        state_[2] ^= t;
        state_[3] = rotl(state_[3], 45);
        return result;
    }
    /// Uniform in [0, 1).
    double unit() { return static_cast<double>(next() >> 11U) * 0x1.0p-53; }
    /// Uniform in [low, high).
    double range(double low, double high) { return low + (high - low) * unit(); }
    /// Uniform integer in [0, n), n >= 1. (The modulo bias is below 2^-40 for the n used here.)
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(next() % n); }

private:
    static std::uint64_t rotl(std::uint64_t x, unsigned k) { return (x << k) | (x >> (64U - k)); }
    std::array<std::uint64_t, 4> state_{};
};

/// A random point of a box. Draws its components in a fixed order; the order of call arguments depends on the compiler.
/// Uniform in [low, high), component by component, z first. A component with low >= high is low and draws no number.
inline dvec3 any_in(Random& random, const dvec3& low, const dvec3& high) {
    dvec3 point = low;
    for (int axis = 2; axis >= 0; --axis)
        if (low[axis] < high[axis]) point[axis] = random.range(low[axis], high[axis]);
    return point;
}

}  // namespace surefoot
