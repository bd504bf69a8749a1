// Report cadence: silence of a streaming device is a fault; silence of a device that reports changes means "as before".
//
// A device that reports changes never sends the same report twice. A streaming device does, whenever the hand is still. So equal
// reports in close succession while deflected prove streaming. The noise of a fine control makes all reports different; then many
// reports within the hysteresis band prove it too. A gap while deflected that ends by itself disproves streaming, unless our own
// reader slept. Until streaming is proved, silence does not stop: that would stop every visitor who holds a pad and walks
// straight.
#pragma once

#include <algorithm>
#include <cstdint>

#include "input/map/mapping.hpp"

namespace surefoot::input {

struct Habit {
    std::uint32_t equal_reports = 0, still_reports = 0, gaps = 0;
    bool learned_streaming = false;
    bool barred = false;  ///< disproved twice: never learned again on this connection
    std::int64_t last_report_ns = -1, last_look_ns = -1, longest_look_ns = 0;
    bool was_deflected = false;
};

constexpr std::uint32_t equal_reports_that_prove = 16, still_reports_that_prove = 64;

/// What came since the last step.
struct News {
    bool fresh = false;  ///< reports did, the newest at stamp_ns
    bool equal = false;  ///< one of them was equal to the one before
    bool still = false;  ///< none moved a control beyond its hysteresis band, and noise would show (Mapper::still)
    bool deflected = false;
    std::int64_t stamp_ns = 0;
};

/// Once a step. Returns whether the device, deflected, has been silent for longer than the age limit although it streams.
inline bool silent(Habit& habit, Reporting declared, const News& news, std::int64_t now_ns, std::int64_t age_limit_ns) {
    if (habit.last_look_ns >= 0) habit.longest_look_ns = std::max(habit.longest_look_ns, now_ns - habit.last_look_ns);
    habit.last_look_ns = now_ns;
    if (news.fresh) {
        const std::int64_t gap = habit.last_report_ns < 0 ? 0 : news.stamp_ns - habit.last_report_ns;
        const bool held = habit.was_deflected && news.deflected, close = gap <= age_limit_ns / 2;
        if (held && news.equal && close && !habit.barred)
            habit.learned_streaming = ++habit.equal_reports >= equal_reports_that_prove || habit.learned_streaming;
        habit.still_reports = held && news.still && close ? habit.still_reports + 1 : 0;
        if (habit.still_reports >= still_reports_that_prove && !habit.barred) habit.learned_streaming = true;
        if (held && gap > age_limit_ns && habit.longest_look_ns <= age_limit_ns / 2) {
            habit.equal_reports = habit.still_reports = 0;
            habit.learned_streaming = false;
            habit.barred = ++habit.gaps >= 2;
        }
        habit.last_report_ns = news.stamp_ns;
        habit.longest_look_ns = 0;
        habit.was_deflected = news.deflected;
    }
    const bool streams = declared == Reporting::streaming || (declared == Reporting::learn && habit.learned_streaming);
    return streams && news.deflected && habit.last_report_ns >= 0 && now_ns - habit.last_report_ns > age_limit_ns;
}

}  // namespace surefoot::input
