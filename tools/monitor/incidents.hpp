// Incidents on disk: each incident of the recorder becomes a folder with a ledger and a trace. Their number and bytes are
// limited. An ordinary thread writes them; a full disk is logged once and does no other harm.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "rt/base/mutex.hpp"
#include "rt/base/result.hpp"
#include "rt/monitor/incident_recorder.hpp"

namespace surefoot::monitor {

/// Limits of the stored incidents.
struct IncidentLimits {
    std::size_t folders = 20;             ///< the oldest is removed for a new one
    std::uint64_t bytes = 256ULL << 20U;  ///< of all of them together; an incident that alone is larger is not kept
};

/// A missed frame for `surefoot replay`, and the function that writes it into a file.
struct MissedFrame {
    std::uint64_t frame = 0;  ///< of the walk
    std::function<Result<void>(const std::string& file)> write;
};

/// The missed frames of the last seconds, for an incident that is written later. One each half second is kept: then those of a
/// burst outlive the misses after it, and no more than nine are held. Pure; one thread at a time.
class OfferedFrames {
public:
    static constexpr std::int64_t apart_ns = 500'000'000, kept_ns = 4'000'000'000;
    /// `now_ns` never goes back; a smaller frame number is of a new walk. The frame is dropped if the last one was kept less than
    /// half a second ago.
    void add(MissedFrame missed, std::int64_t now_ns);
    /// The last one kept of frames `first` to `last`; null if there is none.
    [[nodiscard]] const MissedFrame* last_of(std::uint64_t first, std::uint64_t last) const;

private:
    /// A frame, and when it was offered.
    struct Offered {
        std::int64_t at_ns = 0;
        MissedFrame missed;
    };
    std::deque<Offered> kept_;
};

/// DIR/incident-20260102T030405Z-000017/{incident.json, ledger.csv, trace.json, frame.capture}: a folder appears only when
/// it is complete. Other files in DIR are not touched.
class IncidentWriter {
public:
    /// Creates the folder if it is missing, and removes unfinished incidents of an earlier process. Its thread, sf-incidents,
    /// inherits the caller's place. `notify` gets what the user should know, once; on that thread. `recorder` must
    /// outlive it.
    static Result<std::unique_ptr<IncidentWriter>> start(const std::string& dir, rt::IncidentRecorder& recorder,
                                                         const IncidentLimits& limits,
                                                         std::function<void(std::string_view)> notify);
    ~IncidentWriter();  ///< writes waiting incidents first
    IncidentWriter(const IncidentWriter&) = delete;
    IncidentWriter& operator=(const IncidentWriter&) = delete;

    /// Any thread. The frame goes into the next incident that it belongs to, as OfferedFrames chooses.
    void offer(MissedFrame missed) EXCLUDES(missed_mutex_);

    [[nodiscard]] std::uint64_t written() const { return written_.load(std::memory_order_acquire); }
    [[nodiscard]] std::uint64_t failed() const { return failed_.load(std::memory_order_acquire); }

private:
    IncidentWriter(std::string dir, rt::IncidentRecorder& recorder, const IncidentLimits& limits,
                   std::function<void(std::string_view)> notify);
    void run();
    /// False: it failed, and that was logged.
    bool write(const rt::IncidentRecorder::Incident& incident) REQUIRES(writes_) EXCLUDES(missed_mutex_);

    std::string dir_;
    rt::IncidentRecorder& recorder_;
    IncidentLimits limits_;
    std::function<void(std::string_view)> notify_;
    [[no_unique_address]] ThreadRole writes_;  ///< the thread below
    bool failing_ GUARDED_BY(writes_) = false;
    Mutex missed_mutex_;
    OfferedFrames missed_ GUARDED_BY(missed_mutex_);
    std::atomic<std::uint64_t> written_{0}, failed_{0};
    std::thread thread_;
};

/// One incident into `dir`, within the limits; the new folder's name. `unix_s`: now, seconds since 1970. `missed`: written too,
/// if it is one of the burst; may be null.
Result<std::string> write_incident(const std::string& dir, const rt::IncidentRecorder::Incident& incident,
                                   const IncidentLimits& limits, std::int64_t unix_s, const MissedFrame* missed = nullptr);

}  // namespace surefoot::monitor
