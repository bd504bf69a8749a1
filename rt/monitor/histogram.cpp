// The lossless histogram.
#include "rt/monitor/histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace surefoot::rt {

// Bin 0: negative. Then an octave's worth of exact values (0 .. 2^(sub_bits + 1) - 1), then 2^sub_bits bins an octave.
std::size_t Histogram::bin_of(std::int64_t value_ns) {
    if (value_ns < 0) return 0;
    const auto v = static_cast<std::uint64_t>(value_ns);
    constexpr std::uint64_t exact = 2ULL << sub_bits;
    if (v < exact) return 1 + v;
    const int shift = static_cast<int>(std::bit_width(v)) - 1 - sub_bits;
    return 1 + (static_cast<std::size_t>(shift) << sub_bits) + static_cast<std::size_t>(v >> static_cast<unsigned>(shift));
}

std::int64_t Histogram::bin_low(std::size_t bin) {
    if (bin == 0) return std::numeric_limits<std::int64_t>::min();
    const std::size_t b = bin - 1;
    constexpr std::size_t exact = 2U << sub_bits;
    if (b < exact) return static_cast<std::int64_t>(b);
    const std::size_t shift = (b >> sub_bits) - 1;
    return static_cast<std::int64_t>((b - (shift << sub_bits)) << shift);
}

std::int64_t Histogram::bin_high(std::size_t bin) {
    if (bin == 0) return -1;
    return bin + 1 < bins ? bin_low(bin + 1) - 1 : std::numeric_limits<std::int64_t>::max();
}

void Histogram::add(std::int64_t value_ns, std::uint64_t times) {
    if (times == 0) return;
    counts_[bin_of(value_ns)] += times;
    min_ = count_ == 0 ? value_ns : std::min(min_, value_ns);
    max_ = count_ == 0 ? value_ns : std::max(max_, value_ns);
    count_ += times;
    sum_ += static_cast<double>(value_ns) * static_cast<double>(times);
}

void Histogram::merge(const Histogram& other) {
    if (other.count_ == 0) return;
    for (std::size_t i = 0; i < bins; ++i) counts_[i] += other.counts_[i];
    min_ = count_ == 0 ? other.min_ : std::min(min_, other.min_);
    max_ = count_ == 0 ? other.max_ : std::max(max_, other.max_);
    count_ += other.count_;
    sum_ += other.sum_;
}

std::int64_t Histogram::quantile(double q) const {
    if (count_ == 0) return 0;
    const double clamped = std::clamp(q, 0.0, 1.0);
    if (clamped >= 1.0) return max_;
    const auto rank = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil(clamped * static_cast<double>(count_))));
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < bins; ++i) {
        seen += counts_[i];
        if (seen >= rank) return std::clamp(bin_high(i), min_, max_);
    }
    return max_;
}

std::uint64_t Histogram::count_at_most(std::int64_t value_ns) const {
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < bins && bin_high(i) <= value_ns; ++i) seen += counts_[i];
    return seen;
}

}  // namespace surefoot::rt
