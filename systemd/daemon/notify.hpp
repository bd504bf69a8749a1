// Notifies systemd as sd_notify(3) does, without libsystemd: one datagram a message to $NOTIFY_SOCKET.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace surefoot::daemon {

/// Sends messages to systemd (sd_notify). Never blocks.
class Notifier {
public:
    /// `socket`: a path, or '@' and an abstract name; empty: nobody listens, and every message succeeds.
    explicit Notifier(std::string socket);
    ~Notifier();
    Notifier(const Notifier&) = delete;
    Notifier& operator=(const Notifier&) = delete;

    [[nodiscard]] bool active() const { return !socket_.empty(); }
    /// Lines "KEY=value" joined by '\n'. Waits at most half a second where the receiver is slow. False: not taken.
    bool send(std::string_view message);

private:
    std::string socket_;
    int fd_ = -1;
};

/// A text as one line of a message: line breaks become blanks, and it ends, at a whole character, where systemd would cut it.
std::string one_line(std::string_view text);

/// WATCHDOG_USEC, where WATCHDOG_PID is this process or not set; 0: no watchdog.
std::int64_t watchdog_timeout_ns();

}  // namespace surefoot::daemon
