// The budget test: predicted time of a frame from the two sums over its items.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/select/select.hpp"

namespace surefoot::select {

/// Sums over items. In double, because thousands of upgrades a frame add and subtract.
struct Sum {
    double submit_us = 0, raster_us = 0;
    void add(const model::ItemCost& cost) {
        submit_us += static_cast<double>(cost.submit_us);
        raster_us += static_cast<double>(cost.raster_us);
    }
    [[nodiscard]] Sum changed(const model::ItemCost& away, const model::ItemCost& in) const {
        return {submit_us + (static_cast<double>(in.submit_us) - static_cast<double>(away.submit_us)),
                raster_us + (static_cast<double>(in.raster_us) - static_cast<double>(away.raster_us))};
    }
};
inline Sum operator+(const Sum& a, const Sum& b) { return {a.submit_us + b.submit_us, a.raster_us + b.raster_us}; }

/// Whole-frame prediction: (FrameCombine of the sums + cost of ending slices) x correction x headroom.
class Budget {
public:
    explicit Budget(const SelectInput& input) {
        const model::CostModel& costs = *input.costs;
        combine_ = costs.combine_at(input.prepared->resolution, input.prepared->viewport);
        const double correction = input.correction > 0.0 && std::isfinite(input.correction) ? input.correction : 1.0;
        factor_ = correction * headroom_of(input);
        // 1 + items / slice_us is never less than the number of slices that plan_slices makes.
        const double slice_end_us = static_cast<double>(costs.combine.submit_weight) * static_cast<double>(costs.slice_us);
        const float enlarge_us = costs.enlarge_us(input.prepared->resolution, input.prepared->viewport);
        fixed_us_ = static_cast<double>(combine_.fixed_us) + slice_end_us + static_cast<double>(enlarge_us) + input.beside_us;
        per_item_us_ = 1.0 + (input.slice_us > 0.0 ? slice_end_us / input.slice_us : 0.0);
        budget_us_ = input.budget_us > 0.0 ? input.budget_us : 0.0;  // NaN too: then the floor is drawn
    }
    [[nodiscard]] double items_us(const Sum& sum) const {
        return static_cast<double>(combine_.submit_weight) * sum.submit_us +
               static_cast<double>(combine_.raster_weight) * sum.raster_us +
               static_cast<double>(combine_.max_weight) * std::max(sum.submit_us, sum.raster_us);
    }
    [[nodiscard]] double predicted_us(const Sum& sum) const {
        return (fixed_us_ + bought_us_ + items_us(sum) * per_item_us_) * factor_;
    }
    /// The same before anything but forms was bought.
    [[nodiscard]] double forms_us(const Sum& sum) const { return (fixed_us_ + items_us(sum) * per_item_us_) * factor_; }
    /// Takes the time of an item, before correction and headroom.
    void spend(double item_us) { bought_us_ += item_us; }
    [[nodiscard]] bool fits_with(const Sum& sum, double item_us, double share) const {
        return fits_us(predicted_us(sum) + item_us * factor_, share);
    }
    /// What the sums of forms may come to: items_us() within it fits. Negative: nothing does.
    [[nodiscard]] double room_us() const { return (budget_us_ / (1.0 + 1e-6) / factor_ - fixed_us_ - bought_us_) / per_item_us_; }
    [[nodiscard]] double per_item_us() const { return per_item_us_; }
    [[nodiscard]] const model::FrameCombine& combine() const { return combine_; }
    /// Within `share` of the budget. The margin of 1e-6 covers rounding: the final sum of the cut, computed in float, fits too.
    [[nodiscard]] bool fits(const Sum& sum, double share = 1.0) const { return fits_us(predicted_us(sum), share); }
    [[nodiscard]] bool fits_us(double predicted_us, double share = 1.0) const {
        return predicted_us * (1.0 + 1e-6) <= budget_us_ * share;
    }
    [[nodiscard]] double budget_us() const { return budget_us_; }

private:
    model::FrameCombine combine_;
    double factor_ = 1, fixed_us_ = 0, per_item_us_ = 1, budget_us_ = 0, bought_us_ = 0;
};

}  // namespace surefoot::select
