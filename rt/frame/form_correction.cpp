// The correction by kind of form.
#include "rt/frame/form_correction.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::rt {

namespace {

constexpr double common_drift = 0.03, ratio_drift = 0.01;  // a frame, of each factor
constexpr double noise = 0.1, max_surprise = 0.25;         // of a frame's time
constexpr double reversion = 0.002;                        // towards equal factors, a frame
constexpr double lowest = 0.1, highest = 8.0;

}  // namespace

void FormCorrection::update(double full_us, double coarse_us, double other_us, double actual_us) {
    const double items_us = actual_us - other_us;
    if (!(full_us >= 0) || !(coarse_us >= 0) || !(full_us + coarse_us > 0) || !(items_us > 0)) return;
    if (!std::isfinite(full_us) || !std::isfinite(coarse_us) || !std::isfinite(items_us)) return;
    const double away = 0.5 * reversion * (full_ - coarse_);
    full_ -= away;
    coarse_ += away;
    // What is known of their difference fades alike, so that frames of one kind do not let it grow without end.
    const double sum = 0.25 * (var_full_ + var_coarse_ + 2 * covariance_), stay = 1 - reversion;
    const double difference = 0.25 * (var_full_ + var_coarse_ - 2 * covariance_) * stay * stay;
    const double tilt = 0.5 * (var_full_ - var_coarse_) * stay;
    var_full_ = sum + difference + tilt;
    var_coarse_ = sum + difference - tilt;
    covariance_ = sum - difference;
    const double both = common_drift * common_drift, apart = ratio_drift * ratio_drift;
    var_full_ += both + apart;
    var_coarse_ += both + apart;
    covariance_ += both - apart;
    // In shares of the frame's predicted time, so that the numbers are about 1.
    const double unit = full_us + coarse_us, h_full = full_us / unit, h_coarse = coarse_us / unit, seen = items_us / unit;
    const double gain_full = var_full_ * h_full + covariance_ * h_coarse;
    const double gain_coarse = covariance_ * h_full + var_coarse_ * h_coarse;
    const double spread = h_full * gain_full + h_coarse * gain_coarse + noise * seen * noise * seen;
    const double surprise = std::clamp(seen - h_full * full_ - h_coarse * coarse_, -max_surprise * seen, max_surprise * seen);
    full_ = std::clamp(full_ + gain_full / spread * surprise, lowest, highest);
    coarse_ = std::clamp(coarse_ + gain_coarse / spread * surprise, lowest, highest);
    var_full_ -= gain_full * gain_full / spread;
    var_coarse_ -= gain_coarse * gain_coarse / spread;
    covariance_ -= gain_full * gain_coarse / spread;
}

double FormCorrection::ratio() const { return std::clamp(full_ / coarse_, 1.0 / max_ratio, max_ratio); }

}  // namespace surefoot::rt
