// Chooses the resolution of the picture: a coarser one makes every pixel's share of the cost smaller, and buys detail for it.
#pragma once

#include <array>
#include <cstdint>

#include "render/model/cost.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// Compares what the budget buys at each resolution. Every third frame one other resolution is evaluated, in turns. When all have
/// been, the best one is taken if it wins by a margin, and won the round before too. Deterministic.
/// Source: dynamic video resolution, Montrym et al. 1997 (InfiniteReality); here it is priced like any form.
class ResolutionChooser {
public:
    [[nodiscard]] float resolution() const { return model::resolution_steps[at_]; }
    /// After a frame was prepared at resolution(): the resolution to evaluate beside it; 0: none this time.
    float trial();
    /// What the picture loses now, and what it would lose at the resolution of trial(), 0..1 each.
    void judge(double lost_now, double lost_tried);

    /// The share of the value that looks like what resolution() loses less than full resolution, by the newest of both; 0 at full
    /// resolution.
    [[nodiscard]] float gain() const;

private:
    static constexpr std::uint32_t every = 3;
    std::uint32_t at_ = 0, tried_ = 0, best_before_ = 0, frame_ = 0;
    std::array<double, model::resolution_steps.size()> lost_{};
};

/// Share of the value that is lost where `items_us` may be spent on items, 0..1.
double lost_share(const ValueCurve& curve, double items_us);

/// What a lost share of the value does to the picture, in the unit of CostModel::blur_loss: six times the mean squared error.
/// Measured: the error grows with the root of the lost share.
double picture_loss(double lost_share);
/// The inverse: the share of the value that looks as lost, 0..1.
double share_that_looks_lost(double picture_loss);

}  // namespace surefoot::prepare
