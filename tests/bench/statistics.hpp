// Middles and quantiles of a bench's figures.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace surefoot::bench {

/// The value that q of all lie below, no interpolation; v is not empty.
inline double quantile(std::vector<double> v, double q) {
    std::sort(v.begin(), v.end());
    return v[std::min(v.size() - 1, static_cast<std::size_t>(q * static_cast<double>(v.size())))];
}

/// The middle one, or the mean of the two in the middle; v is not empty.
inline double median(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    const std::size_t half = v.size() / 2;
    return v.size() % 2 == 1 ? v[half] : (v[half - 1] + v[half]) / 2;
}

}  // namespace surefoot::bench
