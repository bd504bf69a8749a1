// Online correction of predicted costs: one factor, bounded, deaf to outliers, never jumping; and how far frames lie above it.
// A plain struct.
#pragma once

#include <array>
#include <cstddef>

namespace surefoot::rt {

/// factor = median of the last 15 ratios actual / predicted, within [0.5, 2], moving by at most 6 % a frame: a step of 2 in true
/// cost is met within 8 + 12 frames, and up to 7 outliers in 15 frames change nothing.
/// upper = 90 % quantile of the last 64 actual / (predicted x the factor then): what a frame may be planned to cost. A table's
/// own upper factor is of any view of any scene; a walk's next frame is much like its last, and half of that was budget unspent.
class CostController {
public:
    static constexpr std::size_t window = 15, upper_window = 64;
    static constexpr double lowest = 0.5, highest = 2.0, slew = 1.06;
    static constexpr double least_upper = 1.04;

    /// predicted_us: uncorrected (factor 1). Pairs that are not positive and finite are ignored.
    void update(double predicted_us, double actual_us);
    [[nodiscard]] double factor() const { return factor_; }
    /// At most the table's, which it is until 58 frames have passed. It falls as fast as it rises: falling by 1 % a frame, it
    /// stood above the quantile, and frames were no steadier for it.
    [[nodiscard]] double upper(double of_table) const;

private:
    void update_upper(double error);

    std::array<double, window> ratios_{};
    std::size_t count_ = 0, next_ = 0;
    double factor_ = 1;
    std::array<double, upper_window> errors_{};
    std::size_t errors_count_ = 0, errors_next_ = 0;
    double upper_ = highest;
};

}  // namespace surefoot::rt
