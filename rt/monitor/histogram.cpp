// Log-linear bins by bit arithmetic.
#include "rt/monitor/histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace surefoot::rt {

namespace {

constexpr std::uint64_t sub_bins = 1ULL << Histogram::sub_bits;

/// Octave 0 holds 0 to 63 (two times 32 bins of width 1); octave n > 0 has 32 bins of width 2^n.
constexpr std::uint64_t low_of(std::uint64_t index) {
    if (index < 2 * sub_bins) return index;
    const std::uint64_t octave = index / sub_bins - 1;
    return (sub_bins + index % sub_bins) << octave;
}

/// A full counter stays full: what wraps would say that nothing had happened.
std::uint64_t saturated(std::uint64_t a, std::uint64_t b) {
    return a > std::numeric_limits<std::uint64_t>::max() - b ? std::numeric_limits<std::uint64_t>::max() : a + b;
}

/// first + step * times for step, times > 0; the end of time where that lies beyond it.
std::int64_t along(std::int64_t first, std::int64_t step, std::uint64_t times) {
    std::uint64_t way = 0;
    if (__builtin_mul_overflow(static_cast<std::uint64_t>(step), times, &way)) return std::numeric_limits<std::int64_t>::max();
    const std::uint64_t room =
        static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) - static_cast<std::uint64_t>(first);
    return way > room ? std::numeric_limits<std::int64_t>::max()
                      : static_cast<std::int64_t>(static_cast<std::uint64_t>(first) + way);
}

}  // namespace

std::size_t Histogram::bin_of(std::int64_t value_ns) {
    if (value_ns < 0) return 0;
    const auto value = static_cast<std::uint64_t>(value_ns);
    if (value < 2 * sub_bins) return 1 + value;
    const auto octave = static_cast<std::uint64_t>(std::bit_width(value)) - sub_bits - 1;
    return 1 + (octave + 1) * sub_bins + ((value >> octave) - sub_bins);
}

std::int64_t Histogram::bin_low(std::size_t bin) {
    return bin == 0 ? std::numeric_limits<std::int64_t>::min() : static_cast<std::int64_t>(low_of(bin - 1));
}

std::int64_t Histogram::bin_high(std::size_t bin) {
    if (bin == 0) return -1;
    if (bin + 1 >= bins) return std::numeric_limits<std::int64_t>::max();
    return static_cast<std::int64_t>(low_of(bin) - 1);
}

// Outside the bins of its smallest and largest value a histogram is zero.
Histogram& Histogram::operator=(const Histogram& other) {
    if (this == &other) return *this;
    const auto at = [](std::size_t bin) { return static_cast<std::ptrdiff_t>(bin); };
    if (count_ > 0) std::fill(counts_.begin() + at(bin_of(min_)), counts_.begin() + at(bin_of(max_)) + 1, 0);
    if (other.count_ > 0) {
        const auto first = at(bin_of(other.min_)), end = at(bin_of(other.max_)) + 1;
        std::copy(other.counts_.begin() + first, other.counts_.begin() + end, counts_.begin() + first);
    }
    count_ = other.count_;
    min_ = other.min_;
    max_ = other.max_;
    sum_ = other.sum_;
    return *this;
}

void Histogram::add(std::int64_t value_ns, std::uint64_t times) {
    if (times == 0) return;
    std::uint64_t& bin = counts_[bin_of(value_ns)];
    bin = saturated(bin, times);
    min_ = count_ > 0 ? std::min(min_, value_ns) : value_ns;
    max_ = count_ > 0 ? std::max(max_, value_ns) : value_ns;
    count_ = saturated(count_, times);
    sum_ += static_cast<double>(value_ns) * static_cast<double>(times);
}

void Histogram::add_progression(std::int64_t first_ns, std::int64_t step_ns, std::uint64_t times) {
    for (std::uint64_t done = 0; done < times;) {
        const std::int64_t value = along(first_ns, step_ns, done);
        const bool at_end = value == std::numeric_limits<std::int64_t>::max();  // all that follow are there too
        const auto room = (static_cast<std::uint64_t>(bin_high(bin_of(value))) - static_cast<std::uint64_t>(value)) /
                              static_cast<std::uint64_t>(step_ns) +
                          1;
        const std::uint64_t here = at_end ? times - done : std::min(room, times - done);
        const std::int64_t last = along(value, step_ns, here - 1);
        // All in one bin: its count by the first, its sum by the mean, its ends by themselves.
        add(value, here);
        sum_ += (static_cast<double>(last) - static_cast<double>(value)) * 0.5 * static_cast<double>(here);
        max_ = std::max(max_, last);
        done += here;
    }
}

void Histogram::merge(const Histogram& other) {
    if (other.count_ == 0) return;
    for (std::size_t i = 0; i < bins; ++i) counts_[i] = saturated(counts_[i], other.counts_[i]);
    min_ = count_ > 0 ? std::min(min_, other.min_) : other.min_;
    max_ = count_ > 0 ? std::max(max_, other.max_) : other.max_;
    count_ = saturated(count_, other.count_);
    sum_ += other.sum_;
}

std::int64_t Histogram::quantile(double q) const {
    if (count_ == 0) return 0;
    const double wanted = std::ceil(std::clamp(q, 0.0, 1.0) * static_cast<double>(count_));
    const auto rank = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(wanted));
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
