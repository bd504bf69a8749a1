// Folders written under a temporary name and renamed; the oldest make room.
#include "tools/monitor/incidents.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "rt/base/file.hpp"
#include "rt/clock/clock.hpp"
#include "rt/threads/placement.hpp"
#include "tools/report/report.hpp"

namespace surefoot::monitor {

namespace {

namespace fs = std::filesystem;
constexpr const char* capture_name = "frame.capture";
constexpr std::string_view folder_prefix = "incident-", half_prefix = ".incident-";

std::uint64_t bytes_below(const fs::path& folder) {
    std::uint64_t bytes = 0;
    std::error_code problem;
    for (fs::recursive_directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
        std::error_code vanished;
        const auto size = at->is_regular_file(vanished) ? at->file_size(vanished) : 0;
        if (!vanished) bytes += size;
    }
    return bytes;
}

/// Names in `dir` that start with `prefix`, by rising name: by rising time.
std::vector<fs::path> folders_in(const std::string& dir, std::string_view prefix) {
    std::vector<fs::path> found;
    std::error_code problem;
    for (fs::directory_iterator at(dir, problem), end; !problem && at != end; at.increment(problem)) {
        std::error_code vanished;
        if (at->path().filename().string().starts_with(prefix) && at->is_directory(vanished)) found.push_back(at->path());
    }
    std::sort(found.begin(), found.end());
    return found;
}

/// The oldest go until one more folder of `coming` bytes is within the limits.
void make_room(const std::string& dir, std::uint64_t coming, const IncidentLimits& limits) {
    const auto folders = folders_in(dir, folder_prefix);
    std::uint64_t bytes = coming;
    for (const fs::path& folder : folders) bytes += bytes_below(folder);
    std::size_t left = folders.size();
    for (const fs::path& folder : folders) {
        if (left + 1 <= limits.folders && bytes <= limits.bytes) return;
        bytes -= std::min(bytes, bytes_below(folder));
        std::error_code ignored;
        fs::remove_all(folder, ignored);
        --left;
    }
}

std::string summary_json(const rt::IncidentRecorder::Incident& incident, std::string_view time, const MissedFrame* missed) {
    std::map<std::string, std::uint64_t> causes;
    std::uint64_t frames = 0, misses = 0, own = 0, skipped = 0;
    std::int64_t worst_ns = 0;
    for (const rt::FrameRecord& f : incident.records) {
        if (f.control) continue;
        ++frames;
        skipped += f.skipped_before;
        own += f.own_miss ? 1 : 0;
        worst_ns = std::max({worst_ns, f.complete_ns - f.due_ns, f.missed ? f.presented_ns - f.due_ns : 0});
        if (!f.missed) continue;
        ++misses;
        ++causes[std::string(rt::cause_of(f))];
    }
    nlohmann::ordered_json j = {{"time", time},
                                {"burst", incident.number},
                                {"first_frame", incident.first_frame},
                                {"period_ms", static_cast<double>(incident.period_ns) * 1e-6},
                                {"frames", frames},
                                {"skipped", skipped},
                                {"misses", misses},
                                {"own_misses", own},
                                {"miss_causes", causes},
                                {"worst_frame_ms", static_cast<double>(worst_ns) * 1e-6},
                                {"suppressed_so_far", incident.suppressed},
                                {"ledger", "ledger.csv"},
                                {"trace", "trace.json"}};
    if (missed != nullptr) j["capture"] = {{"frame", missed->frame}, {"file", capture_name}};
    return j.dump(2) + "\n";
}

bool belongs_to(const MissedFrame* missed, const rt::IncidentRecorder::Incident& incident) {
    return missed != nullptr && missed->write && !incident.records.empty() && missed->frame >= incident.first_frame &&
           missed->frame <= incident.records.back().frame;
}

Result<void> write_files(const fs::path& folder, const rt::IncidentRecorder::Incident& incident, std::string_view time,
                         const MissedFrame* missed) {
    if (!belongs_to(missed, incident)) missed = nullptr;
    if (auto ok = report::write_ledger(folder / "ledger.csv", incident.records); !ok) return ok;
    if (auto ok = report::write_trace(folder / "trace.json", incident.records); !ok) return ok;
    if (missed != nullptr) {
        if (auto ok = missed->write(folder / capture_name); !ok) return ok;
    }
    return write_text(folder / "incident.json", summary_json(incident, time, missed));
}

}  // namespace

Result<std::string> write_incident(const std::string& dir, const rt::IncidentRecorder::Incident& incident,
                                   const IncidentLimits& limits, std::int64_t unix_s, const MissedFrame* missed) {
    const std::string time = fmt::format("{:%Y%m%dT%H%M%SZ}", fmt::gmtime(static_cast<std::time_t>(unix_s)));
    const std::string name = fmt::format("{}{}-{:06}", folder_prefix, time, incident.number);
    const fs::path half = fs::path(dir) / ("." + name), whole = fs::path(dir) / name;
    std::error_code problem;
    fs::create_directories(half, problem);
    if (problem)
        return Error{half.string(), "The folder cannot be made: " + problem.message(),
                     "Check the free space of its disk and who may write there", ErrorKind::unwritable};
    const auto give_up = [&](const Error& error) {
        std::error_code ignored;
        fs::remove_all(half, ignored);
        return error;
    };
    if (auto ok = write_files(half, incident, time, missed); !ok) return give_up(ok.error());
    const std::uint64_t bytes = bytes_below(half);
    if (bytes > limits.bytes)
        return give_up({half.string(), fmt::format("The incident takes {} bytes, {} are allowed", bytes, limits.bytes),
                        "Allow more", ErrorKind::out_of_limits});
    make_room(dir, bytes, limits);
    fs::rename(half, whole, problem);
    if (problem)
        return give_up(
            {whole.string(), "The folder cannot be renamed: " + problem.message(), "Check its disk", ErrorKind::unwritable});
    return whole.string();
}

IncidentWriter::IncidentWriter(std::string dir, rt::IncidentRecorder& recorder, const IncidentLimits& limits,
                               std::function<void(std::string_view)> notify)
    : dir_(std::move(dir)), recorder_(recorder), limits_(limits), notify_(std::move(notify)) {}

Result<std::unique_ptr<IncidentWriter>> IncidentWriter::start(const std::string& dir, rt::IncidentRecorder& recorder,
                                                              const IncidentLimits& limits,
                                                              std::function<void(std::string_view)> notify) {
    std::error_code problem;
    fs::create_directories(dir, problem);
    if (problem)
        return Error{dir, "The folder cannot be made: " + problem.message(), "Name a folder that can be written",
                     ErrorKind::unwritable};
    if (auto ok = probe_writable((fs::path(dir) / "incident.json").string()); !ok) return ok.error();
    for (const fs::path& half : folders_in(dir, half_prefix)) fs::remove_all(half, problem);
    std::unique_ptr<IncidentWriter> writer(new IncidentWriter(dir, recorder, limits, std::move(notify)));
    writer->thread_ = std::thread([w = writer.get()] { w->run(); });
    return writer;
}

IncidentWriter::~IncidentWriter() {
    recorder_.stop();
    if (thread_.joinable()) thread_.join();
}

void IncidentWriter::run() {
    writes_.plays();
    if (auto own = rt::read_thread(0)) {
        own->name = "sf-incidents";
        (void)rt::restore_thread(*own);
    }
    while (const rt::IncidentRecorder::Incident* incident = recorder_.wait()) {
        const bool done = write(*incident);
        recorder_.done();
        (done ? written_ : failed_).fetch_add(1, std::memory_order_release);  // whoever sees it may offer the next
    }
}

void OfferedFrames::add(MissedFrame missed, std::int64_t now_ns) {
    while (!kept_.empty() && now_ns - kept_.front().at_ns > kept_ns) kept_.pop_front();
    if (!kept_.empty() && missed.frame < kept_.back().missed.frame) kept_.clear();  // another walk began
    if (!kept_.empty() && now_ns - kept_.back().at_ns < apart_ns) return;
    kept_.push_back({now_ns, std::move(missed)});
}

const MissedFrame* OfferedFrames::last_of(std::uint64_t first, std::uint64_t last) const {
    for (auto at = kept_.rbegin(); at != kept_.rend(); ++at)
        if (at->missed.frame >= first && at->missed.frame <= last) return &at->missed;
    return nullptr;
}

void IncidentWriter::offer(MissedFrame missed) {
    const MutexLock lock(missed_mutex_);
    missed_.add(std::move(missed), rt::monotonic_ns());
}

bool IncidentWriter::write(const rt::IncidentRecorder::Incident& incident) {
    MissedFrame missed;
    {
        const MutexLock lock(missed_mutex_);
        const std::uint64_t last = incident.records.empty() ? incident.first_frame : incident.records.back().frame;
        if (const MissedFrame* of_burst = missed_.last_of(incident.first_frame, last)) missed = *of_burst;
    }
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto folder =
        write_incident(dir_, incident, limits_, std::chrono::duration_cast<std::chrono::seconds>(now).count(), &missed);
    if (folder) {
        if (notify_) notify_(fmt::format("A burst of misses from frame {} on was recorded: {}.", incident.first_frame, *folder));
        failing_ = false;
        return true;
    }
    if (!failing_ && notify_) notify_("A burst of misses could not be recorded. " + folder.error().text());
    failing_ = true;
    return false;
}

}  // namespace surefoot::monitor
