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

float ResolutionChooser::trial() {
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
    const auto best = static_cast<std::uint32_t>(std::min_element(lost_.begin(), lost_.end()) - lost_.begin());
    const bool wins = lost_[best] < lost_now * (1.0 - (best > at_ ? softer : sharper)) - unseen;
    if (wins && (best == best_before_ || !decided_)) at_ = tried_ = best;
    decided_ = true;
    best_before_ = wins ? best : at_;
}

}  // namespace surefoot::prepare
