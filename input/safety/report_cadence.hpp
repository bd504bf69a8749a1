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

/// What is known of one device's cadence; kept from step to step.
struct ReportCadence {
    std::uint32_t equal_reports = 0, still_reports = 0, gaps = 0;
    bool learned_streaming = false;
    bool barred = false;  ///< disproved twice: never learned again on this connection
    std::int64_t last_report_ns = -1, last_look_ns = -1, longest_look_ns = 0;
    bool was_deflected = false;
};

constexpr std::uint32_t equal_reports_that_prove = 16, still_reports_that_prove = 64;

/// What came since the last step.
struct ReportActivity {
    bool fresh = false;  ///< reports did, the newest at stamp_ns
    bool equal = false;  ///< one of them was equal to the one before
    bool still = false;  ///< none moved a control beyond its hysteresis band, and noise would show (Mapper::still)
    bool deflected = false;
    std::int64_t stamp_ns = 0;
};

/// Once a step. Returns whether the device, deflected, has sent nothing for longer than the age limit although it streams.
inline bool timed_out(ReportCadence& cadence, Reporting declared, const ReportActivity& activity, std::int64_t now_ns,
                      std::int64_t age_limit_ns) {
    if (cadence.last_look_ns >= 0) cadence.longest_look_ns = std::max(cadence.longest_look_ns, now_ns - cadence.last_look_ns);
    cadence.last_look_ns = now_ns;
    if (activity.fresh) {
        const std::int64_t gap = cadence.last_report_ns < 0 ? 0 : activity.stamp_ns - cadence.last_report_ns;
        const bool held = cadence.was_deflected && activity.deflected, close = gap <= age_limit_ns / 2;
        if (held && activity.equal && close && !cadence.barred)
            cadence.learned_streaming = ++cadence.equal_reports >= equal_reports_that_prove || cadence.learned_streaming;
        cadence.still_reports = held && activity.still && close ? cadence.still_reports + 1 : 0;
        if (cadence.still_reports >= still_reports_that_prove && !cadence.barred) cadence.learned_streaming = true;
        if (held && gap > age_limit_ns && cadence.longest_look_ns <= age_limit_ns / 2) {
            cadence.equal_reports = cadence.still_reports = 0;
            cadence.learned_streaming = false;
            cadence.barred = ++cadence.gaps >= 2;
        }
        cadence.last_report_ns = activity.stamp_ns;
        cadence.longest_look_ns = 0;
        cadence.was_deflected = activity.deflected;
    }
    const bool streams = declared == Reporting::streaming || (declared == Reporting::learn && cadence.learned_streaming);
    return streams && activity.deflected && cadence.last_report_ns >= 0 && now_ns - cadence.last_report_ns > age_limit_ns;
}

}  // namespace surefoot::input
