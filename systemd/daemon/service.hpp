// The service thread: signals, notifications of systemd, the watchdog, and exits that cannot wait for the walk.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

#include "systemd/daemon/heartbeat.hpp"
#include "systemd/daemon/log.hpp"
#include "systemd/daemon/notify.hpp"
#include "systemd/daemon/options.hpp"
#include "systemd/daemon/service_state.hpp"

namespace surefoot::daemon {

/// Blocks SIGTERM, SIGINT and SIGHUP in the calling thread and all that it makes, so that only the service thread gets them.
/// Call before any thread is made.
void block_service_signals();

/// The running service: starts, reloads and ends walks.
class Service {
public:
    /// Make it on a neutral thread, after block_service_signals(). All must outlive it. Once a stop has taken longer than it may,
    /// or a real-time thread has run away, the process ends here, whatever the other threads do.
    Service(const Options& options, Log& log, ServiceState& state, Notifier& notifier, std::int64_t watchdog_ns);
    ~Service();
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;

private:
    void run();
    void take_signals();
    void reload();
    void leave(int signal);
    void notify_systemd(std::int64_t now_ns);
    void feed(std::int64_t now_ns);
    void guard(std::int64_t now_ns);
    void send_status(const std::string& first);

    const Options& options_;
    Log& log_;
    ServiceState& state_;
    Notifier& notifier_;
    Heartbeat heartbeat_;
    int signals_ = -1;
    Phase notified_phase_ = Phase::stopping;  ///< the phase that systemd and the log know of
    bool ready_ = false;                      ///< of this walk
    std::string status_;                      ///< the last one that systemd was notified of
    std::int64_t notified_ns_ = 0, opening_since_ns_ = 0, leaving_since_ns_ = 0;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

}  // namespace surefoot::daemon
