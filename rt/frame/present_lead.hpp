// How long before its time a picture is handed to the display, so that it is shown in time.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace surefoot::rt {

/// What presenting takes: the median of the last 15 times, at most a quarter of the period. So a display that waits now and then
/// does not change it. Where the display tells when it shows pictures, that is the time until it had them, and a margin comes on
/// top. The margin is a millisecond, and half as much again after each picture that was not early enough. It is at most a fifth
/// of the period. A thousand pictures in time take an eighth of it back.
class PresentLead {
public:
    /// display_reports: when it shows pictures. Until the window is full, the lead is the margin alone, or 0.
    PresentLead(std::int64_t period_ns, bool display_reports) : period_ns_(period_ns) {
        if (display_reports) add_flip(false);
    }
    [[nodiscard]] std::int64_t ns() const { return std::min(taken_ns_ + margin_ns_, std::max(margin_ns_, period_ns_ / 4)); }
    /// Presenting took so long.
    void add(std::int64_t took_ns) {
        took_[count_++ % window] = took_ns;
        if (count_ < window) return;
        std::array<std::int64_t, window> sorted = took_;
        std::nth_element(sorted.begin(), sorted.begin() + window / 2, sorted.end());
        taken_ns_ = std::clamp<std::int64_t>(sorted[window / 2], 0, period_ns_ / 4);
    }
    /// The display told of a picture that was handed over as early as planned. late: it missed its refresh all the same.
    void add_flip(bool late) {
        constexpr std::int64_t first_ns = 1'000'000;
        constexpr std::size_t taken_back_after = 1000;
        std::int64_t wanted_ns = margin_ns_;
        if (late) {
            wanted_ns += margin_ns_ / 2;
            in_time_ = 0;
        } else if (++in_time_ == taken_back_after) {
            wanted_ns -= margin_ns_ / 8;
            in_time_ = 0;
        }
        margin_ns_ = std::min(std::max(wanted_ns, first_ns), period_ns_ / 5);
    }

private:
    static constexpr std::size_t window = 15;
    std::array<std::int64_t, window> took_{};
    std::size_t count_ = 0, in_time_ = 0;
    std::int64_t taken_ns_ = 0, margin_ns_ = 0;
    std::int64_t period_ns_;
};

}  // namespace surefoot::rt
