// Times derived from one frame record. Ledger, summary, trace and page all use these, so they agree.
#pragma once

#include <cstdint>

#include "rt/frame/record.hpp"

namespace surefoot::report {

inline double us_between(std::int64_t from_ns, std::int64_t to_ns) { return static_cast<double>(to_ns - from_ns) * 1e-3; }

inline double wake_us(const rt::FrameRecord& f) { return us_between(f.due_ns, f.woken_ns); }
inline double select_us(const rt::FrameRecord& f) { return us_between(f.woken_ns, f.selected_ns); }
inline double submit_us(const rt::FrameRecord& f) { return us_between(f.selected_ns, f.submitted_ns); }
inline double raster_us(const rt::FrameRecord& f) { return us_between(f.submitted_ns, f.rastered_ns); }
/// Where pictures are not presented: what was left after the last fence.
inline double present_us(const rt::FrameRecord& f) {
    return f.handed_ns > 0 ? us_between(f.handed_ns, f.presented_ns) : us_between(f.rastered_ns, f.complete_ns);
}
inline double slack_us(const rt::FrameRecord& f) { return us_between(0, rt::slack_ns(f)); }
/// From when the frame was due (not from when it woke) to its end: comparable with the period.
inline double frame_ms(const rt::FrameRecord& f) { return us_between(f.due_ns, f.complete_ns) * 1e-3; }

using rt::busy_ns;

/// Wall time spent over the budget that the frame had; 0 where it had none.
inline double share_of_budget(const rt::FrameRecord& f) {
    return f.budget_us > 0 ? double{f.actual_us} / double{f.budget_us} : 0;
}

}  // namespace surefoot::report
