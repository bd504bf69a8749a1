// Chooses the resolution of the picture: a coarser one makes every pixel's share of the cost smaller, and buys detail for it.
#pragma once

#include <array>
#include <cstdint>

#include "render/model/cost.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// Predicted time that a cut may take, us, by model::resolution_steps.
using PlannedTimes = std::array<double, model::resolution_steps.size()>;

/// Compares what the budget buys at each resolution. With every third set one other resolution is evaluated, in turns. When all
/// have been, the best one is taken if it wins by a margin, and won the round before too. If both rounds have sharper winners, or
/// softer ones, the nearer of the two is taken. The margin is larger for a softer picture. The first round takes each set, and
/// decides alone. So does a round after the planned time has changed by far, if it has not come back meanwhile. After such a
/// decision the next ones take two rounds for a while. Deterministic. Source: dynamic video resolution, Montrym et al. 1997
/// (InfiniteReality); here it is priced like any form.
class ResolutionChooser {
public:
    [[nodiscard]] float resolution() const { return model::resolution_steps[at_]; }
    /// After a frame was prepared at resolution(): the resolution to evaluate beside it; 0: none this time.
    /// planned_us: predicted time that a cut may take, by step of resolution.
    float trial(const PlannedTimes& planned_us);
    /// Shares of the value that are lost now, and that would be at the resolution of trial(): 0..1, with the blur's.
    void judge(double lost_now, double lost_tried);

    /// The share of the value that resolution() loses less than full resolution, by the newest of both; 0 at full resolution.
    [[nodiscard]] float gain() const;

private:
    [[nodiscard]] bool time_changed() const;  ///< by far, since the last decision

    static constexpr std::uint32_t every = 3, hold = 12;  // sets
    std::uint32_t at_ = 0, tried_ = 0, best_before_ = 0, frame_ = 0;
    std::array<double, model::resolution_steps.size()> lost_{};
    std::uint32_t judged_ = 0;                     ///< of this round
    bool decided_ = false;                         ///< by about the present time
    std::uint32_t held_ = 0;                       ///< sets from now on in which no round decides alone
    PlannedTimes planned_us_{}, decided_by_us_{};  ///< the newest; of the last decision
};

/// Share of the value that is lost where `items_us` may be spent on items, 0..1.
double lost_share(const ValueCurve& curve, double items_us);

}  // namespace surefoot::prepare
