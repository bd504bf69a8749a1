// Moving means by bins of the limit (frame_profile.hpp).
#include "render/select/frame_profile.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::select {

namespace {

constexpr double frames = 8;       // of the moving means
constexpr double min_tail = 0.02;  // of the limit: what is left of a frame says nothing when it is shorter
constexpr double max_sample = 4;   // and its inverse: one frame beside a burst of other work counts no more

std::size_t bin_of(double us, double limit_us) {
    const double at = us / limit_us * static_cast<double>(FrameProfile::bins);
    return at > 0 ? static_cast<std::size_t>(std::min(at, static_cast<double>(FrameProfile::bins - 1))) : 0;  // NaN: 0
}

void learn(double sample, double& mean) {
    if (std::isfinite(sample)) mean += (std::clamp(sample, 1 / max_sample, max_sample) - mean) / frames;
}

}  // namespace

FrameProfile::Usual FrameProfile::at(double finished_predicted_us, double limit_us) const {
    return usual_[bin_of(finished_predicted_us, limit_us)];
}

void FrameProfile::note(double finished_us, double finished_predicted_us, double wrong, double limit_us) {
    const std::size_t bin = bin_of(finished_predicted_us, limit_us);
    if (count_ == points_.size() || (count_ > 0 && points_[count_ - 1].bin >= bin)) return;
    points_[count_++] = {bin, finished_us, finished_predicted_us, wrong};
}

void FrameProfile::finish(double end_us, double end_predicted_us, double limit_us) {
    for (std::size_t i = 0; i < count_; ++i) {
        const Point& point = points_[i];
        learn(point.wrong, usual_[point.bin].wrong);
        const double predicted_us = end_predicted_us - point.predicted_us;
        if (predicted_us > min_tail * limit_us) learn((end_us - point.finished_us) / predicted_us, usual_[point.bin].tail);
    }
    count_ = 0;
}

}  // namespace surefoot::select
