// A histogram of nanoseconds over all 64 bits, with bins of 1/32 of their value. Never clips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace surefoot::rt {

/// Values 0 to 63 have a bin each; above, 32 bins an octave. Negative values have one bin below all. The sum over the bins is
/// always count(). Counts that are full (2^64 - 1) stay so. 15 KiB; add() never allocates.
class Histogram {
public:
    static constexpr int sub_bits = 5;
    static constexpr std::size_t bins = 1 + ((64 - sub_bits) << sub_bits);

    Histogram() = default;
    Histogram(const Histogram&) = default;
    /// Copies only the used range of bins: figures are published four times a second.
    Histogram& operator=(const Histogram& other);
    ~Histogram() = default;

    void add(std::int64_t value_ns, std::uint64_t times = 1);
    /// Adds first, first + step, ... (`times` values, step > 0), in at most one operation a bin. Values beyond the largest 64-bit
    /// number count as that number.
    void add_progression(std::int64_t first_ns, std::int64_t step_ns, std::uint64_t times);
    void merge(const Histogram& other);

    [[nodiscard]] std::uint64_t count() const { return count_; }
    [[nodiscard]] std::int64_t min() const { return count_ > 0 ? min_ : 0; }  ///< exact
    [[nodiscard]] std::int64_t max() const { return count_ > 0 ? max_ : 0; }  ///< exact
    [[nodiscard]] double sum() const { return sum_; }
    [[nodiscard]] double mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : 0; }
    /// The smallest value v such that at least q of all values are <= v, to within its bin; exact at q = 1. q is clamped to 0..1.
    [[nodiscard]] std::int64_t quantile(double q) const;
    /// Number of values in bins that lie wholly at or below value_ns; for cumulative counts.
    [[nodiscard]] std::uint64_t count_at_most(std::int64_t value_ns) const;

    [[nodiscard]] std::uint64_t bin_count(std::size_t bin) const { return counts_[bin]; }
    [[nodiscard]] static std::size_t bin_of(std::int64_t value_ns);
    [[nodiscard]] static std::int64_t bin_low(std::size_t bin);   ///< smallest value in it
    [[nodiscard]] static std::int64_t bin_high(std::size_t bin);  ///< largest value in it

private:
    std::array<std::uint64_t, bins> counts_{};
    std::uint64_t count_ = 0;
    std::int64_t min_ = 0, max_ = 0;
    double sum_ = 0;
};

}  // namespace surefoot::rt
