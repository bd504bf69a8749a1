// How long presenting takes: so much earlier than the grid a picture is handed over, so that it is shown on it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace surefoot::rt {

/// The median of the last 15 times, at most a tenth of the period. A display that waits now and then does not change it.
class PresentLead {
public:
    explicit PresentLead(std::int64_t period_ns) : max_ns_(period_ns / 10) {}
    /// 0 until the window is full.
    [[nodiscard]] std::int64_t ns() const { return lead_ns_; }
    void add(std::int64_t took_ns) {
        took_[count_++ % window] = took_ns;
        if (count_ < window) return;
        std::array<std::int64_t, window> sorted = took_;
        std::nth_element(sorted.begin(), sorted.begin() + window / 2, sorted.end());
        lead_ns_ = std::clamp<std::int64_t>(sorted[window / 2], 0, max_ns_);
    }

private:
    static constexpr std::size_t window = 15;
    std::array<std::int64_t, window> took_{};
    std::size_t count_ = 0;
    std::int64_t lead_ns_ = 0;
    std::int64_t max_ns_;
};

}  // namespace surefoot::rt
