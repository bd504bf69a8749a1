// Online correction of predicted costs: one bounded factor, robust against outliers, that changes slowly; and the headroom on it.
#pragma once

#include <array>
#include <cstddef>

namespace surefoot::rt {

/// factor: median of the last 15 ratios actual / predicted, within [0.25, 2], changing by at most 6 % a frame. Follows a step of
/// 2 within 8 + 12 frames. Up to 7 outliers in 15 frames change nothing. headroom: 90 % quantile of the last 64 ratios actual /
/// (predicted x factor). The headroom of a cost table covers any view of any scene. The next frame of a walk resembles the last,
/// so the table's headroom would leave much budget unspent.
class CostController {
public:
    static constexpr std::size_t window = 15, headroom_window = 64;
    static constexpr double lowest = 0.25, highest = 2.0, slew = 1.06;
    static constexpr double min_headroom = 1.04;

    /// predicted_us: uncorrected (factor 1). Pairs that are not positive and finite are ignored.
    void update(double predicted_us, double actual_us);
    [[nodiscard]] double factor() const { return factor_; }
    /// As if all actual times had been `by` times as long; by > 0. The factor stays within its range.
    void scale(double by);
    /// The headroom; at most the table's, which it equals for the first 58 frames. Falls as fast as it rises: a slow fall of 1 %
    /// a frame used more time and made frames no steadier.
    [[nodiscard]] double headroom(double of_table) const;

private:
    void update_headroom(double error);

    std::array<double, window> ratios_{};
    std::size_t count_ = 0, next_ = 0;
    double factor_ = 1;
    std::array<double, headroom_window> errors_{};
    std::size_t errors_count_ = 0, errors_next_ = 0;
    double headroom_ = highest;
};

}  // namespace surefoot::rt
