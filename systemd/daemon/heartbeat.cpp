// The rule: a ping needs a frame that was not there at the last ping.
#include "systemd/daemon/heartbeat.hpp"

#include <algorithm>

namespace surefoot::daemon {

Heartbeat::Heartbeat(std::int64_t timeout_ns, std::int64_t period_ns) : timeout_ns_(timeout_ns), period_ns_(period_ns) {}

void Heartbeat::opening(std::int64_t now_ns, std::int64_t open_limit_ns) {
    open_until_ns_ = now_ns + open_limit_ns;
    stalled_ = false;
}

void Heartbeat::frames_begin(std::int64_t first_due_ns, std::int64_t period_ns) {
    open_until_ns_ = 0;
    period_ns_ = period_ns;
    moved_ns_ = first_due_ns;
}

// A third of the timeout, so that one late ping is no death; never so short that a slow rate looks like a stall.
std::int64_t Heartbeat::stall_ns() const { return std::max<std::int64_t>({timeout_ns_ / 3, 3 * period_ns_, 1'000'000'000}); }

Beat Heartbeat::look(std::int64_t now_ns, std::uint64_t frames) {
    Beat beat;
    const bool opening = open_until_ns_ != 0;
    if (frames != frames_ || opening) {
        frames_ = frames;
        moved_ns_ = now_ns;
        beat.resumed = stalled_;
        stalled_ = false;
    } else if (!stalled_ && now_ns - moved_ns_ > stall_ns()) {
        beat.stalled = stalled_ = true;
    }
    if (timeout_ns_ == 0) return beat;
    const bool alive = opening ? now_ns < open_until_ns_ : frames_ != frames_pinged_;
    const bool due = !ever_pinged_ || now_ns - pinged_ns_ >= timeout_ns_ / 4;
    if (!alive || !due) return beat;
    beat.ping = ever_pinged_ = true;
    pinged_ns_ = now_ns;
    frames_pinged_ = frames_;
    return beat;
}

}  // namespace surefoot::daemon
