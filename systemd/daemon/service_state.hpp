// The state of the daemon's walk, shared by its threads, and its line in `systemctl status`.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "config/settings.hpp"
#include "rt/base/mutex.hpp"
#include "rt/threads/capability.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::daemon {

enum class Phase : std::uint8_t { opening, walking, stopping };

/// A copy of all that STATUS= speaks of.
struct Facts {
    Phase phase = Phase::opening;
    std::string model, in_short;    ///< in_short: rate, size, backend
    std::int64_t period_ns = 0;     ///< of the walk that runs or starts
    std::int64_t first_due_ns = 0;  ///< of its first frame, monotonic, once it walks
    std::int64_t open_limit_ns = 0;
    std::uint64_t walk_frames = 0;                      ///< of this walk
    std::uint64_t frames = 0, misses = 0, skipped = 0;  ///< since the daemon's start
    std::vector<std::string> lacks;                     ///< of real time
    bool uncalibrated = false;                          ///< predictions are built-in figures
    std::string refused;                                ///< why the newest configuration is not in force; empty: it is
    bool stalled = false;
};

/// Pure: one line, the most important first.
std::string status_text(const Facts& facts);

/// Between the session (main thread), its monitor thread and the service thread.
class ServiceState {
public:
    std::atomic<bool> stop_walk{false};  ///< the walk is to end, for good or to begin anew
    std::atomic<bool> leaving{false};    ///< for good
    std::atomic<bool> stalled{false};
    std::atomic<walk::WalkStep> step{walk::WalkStep::request};

    // The session's.
    void open(const config::Settings& settings);
    void walking(std::int64_t period_ns, std::int64_t first_due_ns);
    void count(const rt::FrameRecord& record);
    /// Adds a lack of this walk. True if it is new in this process and must be logged.
    bool lacks(const rt::Lack& lack);
    /// The same for the cost table.
    bool uncalibrated(const std::string& why);
    /// The configuration that a reload brought, once.
    std::optional<config::Configuration> take_next();

    // The service's.
    void put_next(config::Configuration configuration);
    void stopping();

    // Both.
    void refuse(const std::string& why);  ///< empty: the newest configuration is in force
    [[nodiscard]] Facts facts() const;
    [[nodiscard]] std::uint64_t frames() const { return frames_.load(); }
    [[nodiscard]] std::uint64_t walk_frames() const { return walk_frames_.load(); }

private:
    mutable Mutex mutex_;  // no real-time thread comes here
    Facts facts_ GUARDED_BY(mutex_);
    std::set<std::string> logged_ GUARDED_BY(mutex_);
    std::optional<config::Configuration> next_ GUARDED_BY(mutex_);
    std::atomic<std::uint64_t> frames_{0}, walk_frames_{0}, misses_{0}, skipped_{0};
};

}  // namespace surefoot::daemon
