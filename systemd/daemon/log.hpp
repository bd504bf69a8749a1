// The daemon's log: structured datagrams to journald if it reads our stderr, else lines on stderr. It never waits: a line that
// cannot be written is dropped and counted, and the next line reports the count.
#pragma once

#include <atomic>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

#include "rt/base/mutex.hpp"

namespace surefoot::daemon {

/// As syslog counts them.
enum class Priority : int { error = 3, warning = 4, notice = 5, info = 6 };

/// What happened, for machines: SUREFOOT_EVENT and MESSAGE_ID.
struct Event {
    std::string_view name;
    std::string_view id;  ///< 32 hex digits
};

namespace event {
constexpr Event starting{"starting", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e01"};
constexpr Event walking{"walking", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e02"};
constexpr Event degraded{"degraded", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e03"};
constexpr Event misses{"misses", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e04"};
constexpr Event reloading{"reloading", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e05"};
constexpr Event refused{"configuration-refused", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e06"};
constexpr Event stalled{"stalled", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e07"};
constexpr Event resumed{"resumed", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e08"};
constexpr Event input{"input", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e09"};
constexpr Event fault{"fault", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e0a"};
constexpr Event stopping{"stopping", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e0b"};
constexpr Event uncalibrated{"uncalibrated", "6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e0c"};
}  // namespace event

/// A field of the journal; the name is of capital letters, digits and '_'.
struct Field {
    std::string_view name;
    std::string value;
};

/// Where lines go.
struct LogTarget {
    std::string journal_socket;  ///< empty: plain lines to `fd`
    int fd = 2;
    bool prefix = true;  ///< "<4>" before a plain line, as systemd reads it
};
/// journald where $JOURNAL_STREAM names our stderr; else stderr, with prefixes unless it is a terminal.
LogTarget default_target();

/// Any thread may call it.
class Log {
public:
    explicit Log(LogTarget target);
    ~Log();
    Log(const Log&) = delete;
    Log& operator=(const Log&) = delete;

    void write(Priority priority, const Event& event, std::string_view text, std::initializer_list<Field> fields = {});
    [[nodiscard]] std::uint64_t dropped() const { return dropped_.load(); }

private:
    bool to_journal(std::string_view message) REQUIRES(one_at_a_time_);
    bool to_stream(std::string_view line) const REQUIRES(one_at_a_time_);
    LogTarget target_;
    int socket_ = -1;
    Mutex one_at_a_time_;  // lines stay whole, and each dropped line is reported once
    std::atomic<std::uint64_t> dropped_{0};
    std::uint64_t dropped_reported_ GUARDED_BY(one_at_a_time_) = 0;
};

/// Pure: a message in journald's native format; values with line breaks go with their length, as it wants them.
std::string journal_message(Priority priority, const Event& event, std::string_view text, std::initializer_list<Field> fields,
                            std::uint64_t dropped);

}  // namespace surefoot::daemon
