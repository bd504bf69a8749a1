// The cheapest cut within one angular error for all of its items. It says what an accuracy costs that all objects share.
// Source: Pasman & Jansen 2002, 3.3; page: common-error.md.
#pragma once

#include <algorithm>
#include <span>

#include "render/select/cut_builder.hpp"

namespace surefoot::select {

/// Shown forms may keep an error this many times that of new ones; without hysteresis they may not.
constexpr float shown_error_factor = 1.1F;
/// The error of selectors without a budget, where no accuracy is requested.
constexpr double default_threshold_px = 2.0;

/// Cuts of one frame by the error that all items share. Errors are times importance here: less is asked of what matters less.
/// Uses the state's scratch memory; allocates nothing.
class CommonErrorCuts {
public:
    CommonErrorCuts(const SelectInput& input, SelectState& state, CutBuilder& builder, const Budget& budget);

    /// A cut as it would be taken.
    struct Found {
        Sum sum;
        float worst_error_rad = 0;  ///< above what was wanted: some leaf has nothing better
    };
    /// The cheapest cut within `error_rad`, in radians; infinity: the cheapest of all. Where no form suffices, the best one
    /// counts. Costs are compared node by node, so the larger of two sums over a frame may make another cut a little cheaper.
    [[nodiscard]] Found find(float error_rad) { return find(error_rad, new_factor_); }
    /// Gives the builder the cut that was found last.
    void take();

    /// The cut of the smallest error, no smaller than `min_error_rad`, that fits the budget, to one part in 64: the builder has
    /// it. False: none fits, and the builder is as it was. Starts near what was shown, if there is hysteresis.
    [[nodiscard]] bool find_within_budget(float min_error_rad);

    /// Lets the builder start with the cut of `max_error_rad`: with hysteresis, without it where only that fits. If none fits,
    /// with that of the smallest error that does. The floor, if nothing does.
    [[nodiscard]] rt::Guarantee guarantee(float max_error_rad);

    /// Of the cut that find_within_budget() gave to the builder: its worst error. Leaves that have nothing better do not count.
    [[nodiscard]] float taken_limit_rad() const { return std::min(taken_error_, taken_worst_); }
    /// Lets the builder start with that cut: no item gets more error than this. False: it has no limit, and nothing changes.
    [[nodiscard]] bool start_with_taken();
    [[nodiscard]] float two_pixels_rad() const { return two_pixels_rad_; }

private:
    /// How costs are compared, node by node: as a frame's are.
    struct Weights {
        double submit, raster, larger;
        [[nodiscard]] double of(const Sum& sum) const {
            return submit * sum.submit_us + raster * sum.raster_us + larger * std::max(sum.submit_us, sum.raster_us);
        }
    };
    [[nodiscard]] Found find(float error_rad, float new_factor);
    [[nodiscard]] float likely_error() const;
    [[nodiscard]] float coarsest_error() const;

    CutBuilder& builder_;
    const Budget& budget_;
    float two_pixels_rad_;
    std::span<const Index> shown_;
    double share_;      ///< of the budget, for forms that were not shown
    float new_factor_;  ///< of the error, for forms that were not shown
    Weights weights_;
    float taken_error_ = 0, taken_worst_ = 0;
    std::span<Sum> below_;                ///< by candidate: of the cheapest cut of its subtree
    std::span<float> worst_;              ///< by candidate: its worst error
    std::span<std::uint32_t> decisions_;  ///< by candidate: a choice, or SelectState::opened
};

/// Before a search, with the floor in the builder: its start, so that no item has more than the input's `max_error_rad`. Nothing
/// changes if that is 0.
void guarantee_error(const SelectInput& input, SelectState& state, CutBuilder& builder, const Budget& budget);

/// Call it after CutBuilder::take_start(). Takes the steps of greatest value per cost that still fit the budget, in at most four
/// rounds, and undoes those that lose value. Returns how many were taken. Uses the state's scratch memory; allocates nothing.
std::uint32_t fill_by_rate(const SelectInput& input, SelectState& state, CutBuilder& builder, const Budget& budget);

}  // namespace surefoot::select
