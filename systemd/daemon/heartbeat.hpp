// Decides when the watchdog is fed: only while frames run. Pure: time and the count of frames are arguments.
#pragma once

#include <cstdint>

namespace surefoot::daemon {

/// The result of one check.
struct Beat {
    bool ping = false;     ///< send WATCHDOG=1
    bool stalled = false;  ///< no frame for too long; true once per stall
    bool resumed = false;  ///< frames again after a stall; true once
};

/// The rule, with the state that it needs. Also reports stalls. One thread calls all members.
class Heartbeat {
public:
    /// timeout_ns: systemd's watchdog timeout; 0: no pings, but stalls are still reported. period_ns: of a frame.
    Heartbeat(std::int64_t timeout_ns, std::int64_t period_ns);

    /// Until frames_begin() a model is opened and no frame can come. Pings go on for at most open_limit_ns.
    void opening(std::int64_t now_ns, std::int64_t open_limit_ns);
    /// first_due_ns: of the first frame. It may lie ahead by more than a second, since a walk rehearses its first view.
    void frames_begin(std::int64_t first_due_ns, std::int64_t period_ns);

    /// Many times a second. frames: run so far, never less than before.
    Beat look(std::int64_t now_ns, std::uint64_t frames);

    /// A frame that takes longer than this is a stall.
    [[nodiscard]] std::int64_t stall_ns() const;

private:
    std::int64_t timeout_ns_, period_ns_;
    std::int64_t pinged_ns_ = 0, moved_ns_ = 0;
    std::uint64_t frames_ = 0;         ///< at the last look
    std::uint64_t frames_pinged_ = 0;  ///< at the last ping
    std::int64_t open_until_ns_ = 0;   ///< 0: frames are due
    bool ever_pinged_ = false, stalled_ = false;
};

}  // namespace surefoot::daemon
