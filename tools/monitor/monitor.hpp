// The monitor of a service: takes every record on the monitor thread, keeps the live figures, serves them, and writes incidents
// down. The daemon and `walk --monitor` make one.
//
//   monitor thread ──► figures ──► (latest copy) ──► sf-console: /metrics, /status.json   ordinary threads;
//                 └──► IncidentRecorder ──► (hand-over) ──► sf-incidents: folders on disk        the first waits for none
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "rt/base/mutex.hpp"
#include "rt/base/result.hpp"
#include "rt/monitor/incident_recorder.hpp"
#include "rt/monitor/telemetry.hpp"
#include "tools/monitor/incidents.hpp"
#include "tools/monitor/page.hpp"
#include "tools/monitor/server.hpp"

namespace surefoot::walk {
struct WalkRequest;
struct WalkObserver;
}  // namespace surefoot::walk

namespace surefoot::monitor {

/// Settings of the monitor.
struct MonitorOptions {
    std::string address;        ///< see parse_address(); empty: it listens nowhere
    std::string incidents_dir;  ///< empty: incidents are counted, and not written
    std::string version;
    rt::IncidentRecorderOptions incident_recorder;
    IncidentLimits incidents;
    ServerLimits server;
    std::function<void(std::string_view)> notify;  ///< gets what the user should know, once; on sf-incidents
};

/// Wired to a walk by attach_monitor(). Lives as long as the service, over many walks. Counters go on from walk to walk; with
/// another frame rate they start anew, as after a restart. Open it from a neutral thread, before memory is locked: its threads
/// inherit the caller's place.
class Monitor {
public:
    /// Errors: an address that is invalid, in use or not permitted; a folder that cannot be written.
    static Result<std::unique_ptr<Monitor>> open(MonitorOptions options);
    ~Monitor();  ///< call it after the last record; writes waiting incidents first
    Monitor(const Monitor&) = delete;
    Monitor& operator=(const Monitor&) = delete;

    /// Any thread but the monitor's, in any order:
    void begin_walk(const MonitoredWalk& walk);  ///< before its first record
    void end_walk();                             ///< after its last record
    void set_state(ServicePhase state);
    void set_degraded(std::vector<rt::Lack> degraded);
    void add_degraded(const rt::Lack& degraded);
    void set_input(const rt::InputState& input);
    void add_note(std::string_view text);  ///< for the user: the last few are shown

    /// A missed frame, for the incident that it belongs to.
    void offer(MissedFrame missed);

    /// The monitor thread: every record, in order. Never waits for a reader or for a disk.
    void on_record(const rt::FrameRecord& record);

    /// Where it listens, with the actual port; empty if it does not listen.
    [[nodiscard]] std::string address() const;
    [[nodiscard]] bool writes_incidents() const { return writer_ != nullptr; }
    /// The pages, as a reader gets them; one caller at a time.
    [[nodiscard]] std::optional<Server::Page> page(std::string_view path);

private:
    explicit Monitor(MonitorOptions options);
    void take_walk() REQUIRES(monitor_thread_) EXCLUDES(facts_mutex_);
    const MonitorPage& fill_page(bool with_threads) EXCLUDES(facts_mutex_);

    rt::Telemetry telemetry_;  ///< the monitor thread's, and (the published copy) the readers'
    MonitorOptions options_;
    // The monitor thread's.
    rt::IncidentRecorder incident_recorder_;
    [[no_unique_address]] ThreadRole monitor_thread_;
    std::atomic<bool> walk_waits_{false};                       ///< setup_ is to be taken before the next record
    std::atomic<std::int64_t> cpu_ns_{0};                       ///< of all walks' monitor threads
    std::int64_t cpu_read_ns_ GUARDED_BY(monitor_thread_) = 0;  ///< record time
    std::int64_t cpu_seen_ns_ GUARDED_BY(monitor_thread_) = 0;

    Mutex facts_mutex_;  ///< of data that callers set and readers copy; of all records, only a walk's first takes it
    rt::TelemetrySetup setup_ GUARDED_BY(facts_mutex_);
    MonitorPage facts_ GUARDED_BY(facts_mutex_);
    struct Note {
        std::int64_t at_ns = 0;
        std::string text;
    };
    std::deque<Note> recent_notes_ GUARDED_BY(facts_mutex_);

    // The readers'.
    struct Cached;
    std::unique_ptr<Cached> cached_;
    std::int64_t started_ns_ = 0;

    std::unique_ptr<IncidentWriter> writer_;
    /// The same for its own thread, which may call it before the pointer below is set and while it is being taken back.
    std::atomic<const Server*> serving_{nullptr};
    std::unique_ptr<Server> server_;  ///< last: its thread uses all the others
};

/// Adds the monitor to the observers of `watch`, after those it has. Monitor and request must outlive the walk.
void attach_monitor(Monitor& monitor, const walk::WalkRequest& request, walk::WalkObserver& observer);

}  // namespace surefoot::monitor
