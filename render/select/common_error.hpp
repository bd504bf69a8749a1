// The cheapest cut of which every item is within one angular error: what an accuracy that all objects share costs.
// Source: Pasman & Jansen 2002, 3.3; page: common-error.md.
#pragma once

#include <span>

#include "render/select/cut_builder.hpp"

namespace surefoot::select {

/// Shown forms may keep an error this many times that of new ones; 1 without hysteresis.
constexpr float shown_error_factor = 1.1F;

/// Cuts of one frame by the error that all items share. Uses the state's scratch memory; allocates nothing.
class CommonErrorCuts {
public:
    CommonErrorCuts(const SelectInput& input, SelectState& state, CutBuilder& builder, const Budget& budget);

    /// A cut as it would be taken.
    struct Found {
        Sum sum;
        float worst_error_rad = 0;  ///< above what was wanted: some leaf has nothing better
    };
    /// The cheapest cut within `error_rad`, in radians; infinity: the cheapest of all. Where no form suffices, the best one
    /// counts. Sums fall as the error rises, but for what the larger of two sums makes of it.
    [[nodiscard]] Found find(float error_rad);
    /// Gives the builder the cut that was found last.
    void take();

    /// The cut of the smallest error, no smaller than `min_error_rad`, that fits the budget, to one part in 64: the builder has
    /// it. False: none fits, and the builder is as it was.
    [[nodiscard]] bool find_within_budget(float min_error_rad);

    [[nodiscard]] float two_pixels_rad() const { return two_pixels_rad_; }

private:
    [[nodiscard]] float likely_error() const;

    CutBuilder& builder_;
    const Budget& budget_;
    float two_pixels_rad_;
    std::span<const Index> shown_;
    float new_factor_;                    ///< of the error, for forms that were not shown
    std::span<Sum> below_;                ///< by candidate: of the cheapest cut of its subtree
    std::span<float> worst_;              ///< by candidate: its worst error
    std::span<std::uint32_t> decisions_;  ///< by candidate: a choice, or SelectState::opened
};

}  // namespace surefoot::select
