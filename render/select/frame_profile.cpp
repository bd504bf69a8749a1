// Means that rise and fall at different speeds, by bins of the period (frame_profile.hpp).
#include "render/select/frame_profile.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::select {

namespace {

constexpr double slowly = 1.0 / 8;  // of a sample counts where that makes frames look better
constexpr double min_tail = 0.15;   // of the limit: what is left of a frame says nothing when it is shorter
constexpr double max_ratio = 4;
constexpr double stall_ratio = 2;  // of a rest: in one frame alone it is a stall of the machine

std::size_t bin_of(double us, double limit_us) {
    const double at = us / limit_us * static_cast<double>(FrameProfile::bins);
    return at > 0 ? static_cast<std::size_t>(std::min(at, static_cast<double>(FrameProfile::bins - 1))) : 0;  // NaN: 0
}

void learn(double sample, double speed_up, double speed_down, double& mean) {
    if (!std::isfinite(sample)) return;
    const double off = std::clamp(sample, 1.0, max_ratio) - mean;
    mean += off * (off > 0 ? speed_up : speed_down);
}

}  // namespace

FrameProfile::Usual FrameProfile::at(double finished_predicted_us, double limit_us) const {
    return usual_[bin_of(finished_predicted_us, limit_us)];
}

void FrameProfile::note(double finished_us, double finished_predicted_us, double limit_us) {
    const std::size_t bin = bin_of(finished_predicted_us, limit_us);
    if (count_ == points_.size() || (count_ > 0 && points_[count_ - 1].bin >= bin)) return;
    points_[count_++] = {bin, finished_us, finished_predicted_us};
}

void FrameProfile::finish(double end_us, double end_predicted_us, double limit_us) {
    for (std::size_t i = 0; i < count_; ++i) {
        const Point& point = points_[i];
        Usual& usual = usual_[point.bin];
        if (point.predicted_us > 0) learn(point.finished_us / point.predicted_us, slowly, 1.0, usual.head);
        const double predicted_us = end_predicted_us - point.predicted_us;
        if (!(predicted_us > min_tail * limit_us)) {
            learn(1.0, 1.0, slowly, usual.tail);  // it may be wrong by now, and this frame could not tell
            continue;
        }
        const double tail = (end_us - point.finished_us) / predicted_us;
        const bool stalled = tail > stall_ratio;
        if (!stalled || stalled_[point.bin]) learn(tail, 1.0, slowly, usual.tail);
        stalled_[point.bin] = stalled;
    }
    count_ = 0;
}

}  // namespace surefoot::select
