// When the watchdog may be fed: only while frames are being run. Pure: time and the count of frames are handed in.
#pragma once

#include <cstdint>

namespace surefoot::daemon {

/// What follows from one look.
struct Beat {
    bool ping = false;     ///< send WATCHDOG=1
    bool stalled = false;  ///< no frame for too long: said once
    bool resumed = false;  ///< frames again after a stall: said once
};

class Heartbeat {
public:
    /// timeout_ns: systemd's; 0: it wants no pings, stalls are told all the same. period_ns: of a frame.
    Heartbeat(std::int64_t timeout_ns, std::int64_t period_ns);

    /// No frame can come until frames_begin(): a model is opened. Pings are due for at most open_limit_ns.
    void opening(std::int64_t now_ns, std::int64_t open_limit_ns);
    void frames_begin(std::int64_t now_ns, std::int64_t period_ns);

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
