// Online correction of predicted costs: one factor, bounded, deaf to outliers, never jumping. A plain struct.
#pragma once

#include <array>
#include <cstddef>

namespace surefoot::rt {

/// factor = median of the last 15 ratios actual / predicted, within [0.5, 2], moving by at most 6 % a frame: a step of 2 in true
/// cost is met within 8 + 12 frames, and up to 7 outliers in 15 frames change nothing.
class CostController {
public:
    static constexpr std::size_t window = 15;
    static constexpr double lowest = 0.5, highest = 2.0, slew = 1.06;

    /// predicted_us: uncorrected (factor 1). Pairs that are not positive and finite are ignored.
    void update(double predicted_us, double actual_us);
    [[nodiscard]] double factor() const { return factor_; }

private:
    std::array<double, window> ratios_{};
    std::size_t count_ = 0, next_ = 0;
    double factor_ = 1;
};

}  // namespace surefoot::rt
