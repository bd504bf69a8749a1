// What a device's silence means: a fault where it streams, "as before" where it reports changes only.
//
// A device that reports changes only never sends the same report twice; one that streams does, whenever the hand keeps still (or
// when it tells its controls in turns). So equal reports in close succession while deflected prove streaming. A deflected gap
// that ends by itself disproves it, unless our own reader was the one that slept. Until it is proved, silence does not stop:
// stopping a pad that is simply held would take the walk from every visitor who walks straight on.
#pragma once

#include <algorithm>
#include <cstdint>

#include "input/map/mapping.hpp"

namespace surefoot::input {

struct Habit {
    std::uint32_t equal_reports = 0, gaps = 0;
    bool learned_streaming = false;
    bool barred = false;  ///< disproved twice: never learned again on this connection
    std::int64_t last_report_ns = -1, last_look_ns = -1, longest_look_ns = 0;
    bool was_deflected = false;
};

constexpr std::uint32_t equal_reports_that_prove = 16;

/// Once a step. `fresh`: reports came since the last step, the newest at stamp_ns; `equal`: one of them repeated its forerunner.
/// Returns whether the device, deflected, has been silent for longer than the age limit although it streams.
inline bool silent(Habit& habit, Reporting declared, bool fresh, bool equal, bool deflected, std::int64_t stamp_ns,
                   std::int64_t now_ns, std::int64_t age_limit_ns) {
    if (habit.last_look_ns >= 0) habit.longest_look_ns = std::max(habit.longest_look_ns, now_ns - habit.last_look_ns);
    habit.last_look_ns = now_ns;
    if (fresh) {
        const std::int64_t gap = habit.last_report_ns < 0 ? 0 : stamp_ns - habit.last_report_ns;
        const bool held = habit.was_deflected && deflected;
        if (held && equal && gap <= age_limit_ns / 2 && !habit.barred)
            habit.learned_streaming = ++habit.equal_reports >= equal_reports_that_prove || habit.learned_streaming;
        if (held && gap > age_limit_ns && habit.longest_look_ns <= age_limit_ns / 2) {
            habit.equal_reports = 0;
            habit.learned_streaming = false;
            habit.barred = ++habit.gaps >= 2;
        }
        habit.last_report_ns = stamp_ns;
        habit.longest_look_ns = 0;
        habit.was_deflected = deflected;
    }
    const bool streams = declared == Reporting::streaming || (declared == Reporting::learn && habit.learned_streaming);
    return streams && deflected && habit.last_report_ns >= 0 && now_ns - habit.last_report_ns > age_limit_ns;
}

}  // namespace surefoot::input
