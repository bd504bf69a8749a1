// By when a frame is to be done, so that the real-time threads together leave the kernel its share of each core.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "render/prepare/prepared.hpp"

namespace surefoot::walk {

/// Linux gives ordinary threads 5 % of each core (fair server from 6.12, real-time throttling before). If real-time threads leave
/// them less, it takes the rest by force. It does so in one piece of up to 50 ms a second, and a frame is late. Rasterisers and
/// workers share cores: what preparing takes, frames may not. One thread makes a set beside the frames, and a set serves two
/// frames. What is left of two periods has to be enough for it. The frame thread calls all members.
class FrameLimit {
public:
    static constexpr double real_time_share = 0.90;  ///< of a core
    static constexpr double min_share = 0.5;         ///< of the period: preparing may not take more from frames

    /// limit_us: without preparing, from the due time. shared_cores: of rasterisers and workers; 0: they share none.
    FrameLimit(double limit_us, double period_us, int shared_cores)
        : limit_us_(limit_us), period_us_(period_us), shared_cores_(shared_cores) {}

    /// Call it once a frame, with the set that it has: a set that is new has cost its CPU time.
    void count(const prepare::PreparedFrame& set) {
        const bool fresh = !any_ || set.frame != newest_;
        const double spent_us = fresh && std::isfinite(set.cpu_us) ? set.cpu_us : 0.0;
        if (fresh) set_us_ = any_ ? set_us_ + (spent_us - set_us_) / sets : std::min(spent_us, 0.5 * period_us_);
        mean_us_ = any_ ? mean_us_ + (spent_us - mean_us_) / frames : spent_us;
        newest_ = set.frame;
        any_ = true;
    }
    /// Call it after each frame: when it ended, us after it was due.
    void ended(double end_us) {
        if (std::isfinite(end_us)) left_us_ = std::clamp(left_us_ + us() - end_us, 0.0, max_left * period_us_);
    }
    /// As a mean of frames.
    [[nodiscard]] double us() const {
        if (shared_cores_ <= 0) return limit_us_;
        const double left_us =
            std::min(real_time_share * period_us_ - mean_us_ / shared_cores_, period_us_ - set_share * set_us_);
        return std::min(limit_us_, std::max(left_us, min_share * period_us_));
    }
    /// By when the next frame is to be done. The kernel counts by seconds, so one frame may take what others have left. If frames
    /// end by it, that is half a period at most beyond the mean. A later one is late for another reason, and costs others
    /// nothing.
    [[nodiscard]] double next_us() const { return std::min(limit_us_, us() + left_us_); }
    /// What a cut may take by its prediction with headroom, if it is begun spent_us after it was due. Expected, it ends by us();
    /// with headroom and margin by the limit of any frame. Then the check may still make its last slices coarse.
    [[nodiscard]] double plan_us(double spent_us, double margin_us, double headroom) const {
        const double expected_us = (us() - spent_us) * std::max(headroom, 1.0);
        return std::max(0.0, std::min(limit_us_ - margin_us - spent_us, expected_us));
    }

private:
    static constexpr double max_left = 0.5;   ///< of a period, that is kept for later frames
    static constexpr double set_share = 0.6;  ///< of a set's time, that a frame leaves: half, and 0.1 for its start
    static constexpr double frames = 32;      ///< that the mean is of, about: the kernel counts by seconds
    static constexpr double sets = 8;         ///< that the mean of set_us_ is of, about

    double limit_us_, period_us_;
    int shared_cores_;
    double mean_us_ = 0;  ///< CPU time of preparing, a frame
    double set_us_ = 0;   ///< CPU time of preparing, a set
    double left_us_ = 0;  ///< by frames that ended before the limit
    std::uint64_t newest_ = 0;
    bool any_ = false;
};

}  // namespace surefoot::walk
