// The choice of the picture's resolution.
#include "render/prepare/resolution.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::prepare {

double lost_share(const ValueCurve& curve, double items_us) {
    if (!(curve.full_value > 0.0F)) return 0.0;
    const double lost =
        1.0 - static_cast<double>(curve.value_at(static_cast<float>(items_us))) / static_cast<double>(curve.full_value);
    return std::isfinite(lost) ? std::clamp(lost, 0.0, 1.0) : 0.0;
}

float ResolutionChooser::gain() const { return at_ == 0 ? 0.0F : static_cast<float>(lost_[0] - lost_[at_]); }

bool ResolutionChooser::time_changed() const {
    constexpr double far_off = 1.2;  // raster time changes by more from one resolution to the next
    const double ratio = planned_us_[at_] / decided_by_us_[at_];
    return ratio > far_off || ratio < 1 / far_off;  // of NaN, by 0/0: no
}

float ResolutionChooser::trial(const PlannedTimes& planned_us) {
    planned_us_ = planned_us;
    if (held_ > 0)
        --held_;
    else if (decided_ && time_changed())
        decided_ = false, judged_ = 0;  // the round begins anew
    if (++frame_ % every != 0 && decided_) return 0.0F;
    tried_ = (tried_ + 1) % model::resolution_steps.size();
    if (tried_ == at_) tried_ = (tried_ + 1) % model::resolution_steps.size();
    return model::resolution_steps[tried_];
}

void ResolutionChooser::judge(double lost_now, double lost_tried) {
    constexpr double softer = 0.4, sharper = 0.1;  // of what is lost now, by which another must win
    constexpr double unseen = 5e-4;
    lost_[at_] = lost_now;
    lost_[tried_] = lost_tried;
    if (++judged_ + 1 < lost_.size()) return;
    judged_ = 0;
    const bool first = !(decided_by_us_[at_] > 0.0), alone = !decided_ && (first || time_changed());
    const auto best = static_cast<std::uint32_t>(std::min_element(lost_.begin(), lost_.end()) - lost_.begin());
    const auto beats = [&](std::uint32_t step) {
        return step != at_ && lost_[step] < lost_[at_] * (1.0 - (step > at_ ? softer : sharper)) - unseen;
    };
    const bool wins = beats(best);
    // Where a view becomes cheaper or dearer, each round has another winner. Two on one side agree on the nearer one.
    const bool one_side = (best > at_) == (best_before_ > at_);
    const std::uint32_t nearer = best > at_ ? std::min(best, best_before_) : std::max(best, best_before_);
    const std::uint32_t agreed = alone ? best : nearer;
    const bool open = wins && !alone && !(one_side && beats(agreed));  // the next round decides
    if (wins && !open) {
        at_ = tried_ = agreed;
        if (alone && !first) held_ = hold;
    }
    decided_ = true;
    if (!open) decided_by_us_ = planned_us_;
    best_before_ = beats(best) ? best : at_;  // after a change: where it still wins
}

}  // namespace surefoot::prepare
