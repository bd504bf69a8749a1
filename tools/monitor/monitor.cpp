// Takes records and makes pages. A page is made at most a few times a second, however many readers there are.
#include "tools/monitor/monitor.hpp"

#include <unistd.h>

#include <chrono>

#include "rt/clock/clock.hpp"
#include "rt/threads/usage.hpp"

namespace surefoot::monitor {

namespace {

constexpr std::int64_t page_age_ns = 200'000'000;       // figures are published four times a second
constexpr std::int64_t process_age_ns = 1'000'000'000;  // reading /proc costs about a millisecond
constexpr std::size_t max_notes = 5, max_note_bytes = 300;
constexpr std::int64_t cpu_every_ns = 1'000'000'000;

}  // namespace

/// What was made for the last reader, and when.
struct Monitor::Cached {
    struct Text {
        std::shared_ptr<const std::string> text;
        std::int64_t made_ns = 0;
    };
    Text metrics, status;
    MonitorPage page;
    std::int64_t process_ns = 0;
};

Monitor::Monitor(MonitorOptions options)
    : options_(std::move(options)),
      incident_recorder_(options_.incident_recorder),
      cached_(std::make_unique<Cached>()),
      started_ns_(rt::monotonic_ns()) {
    facts_.version = options_.version;
    facts_.pid = ::getpid();
    const auto unix_time = std::chrono::system_clock::now().time_since_epoch();
    facts_.started_unix_s = static_cast<double>(std::chrono::duration_cast<std::chrono::milliseconds>(unix_time).count()) * 1e-3;
}

Result<std::unique_ptr<Monitor>> Monitor::open(MonitorOptions options) {
    std::optional<Address> address;
    if (!options.address.empty()) {
        auto parsed = parse_address(options.address);
        if (!parsed) return parsed.error();
        address = *parsed;
    }
    std::unique_ptr<Monitor> monitor(new Monitor(std::move(options)));
    const MonitorOptions& o = monitor->options_;
    if (!o.incidents_dir.empty()) {
        auto writer = IncidentWriter::start(o.incidents_dir, monitor->incident_recorder_, o.incidents, o.notify);
        if (!writer) return writer.error();
        monitor->writer_ = std::move(*writer);
    }
    if (address) {
        auto server = Server::listen(
            *address, [m = monitor.get()](std::string_view path) { return m->page(path); }, o.server);
        if (!server) return server.error();
        monitor->server_ = std::move(*server);
        monitor->serving_.store(monitor->server_.get(), std::memory_order_release);
    }
    return monitor;
}

Monitor::~Monitor() {
    server_.reset();
    writer_.reset();
}

void Monitor::offer(MissedFrame missed) {
    if (writer_) writer_->offer(std::move(missed));
}

std::string Monitor::address() const { return server_ ? server_->address().text() : std::string(); }

void Monitor::begin_walk(const MonitoredWalk& walk) {
    const MutexLock lock(facts_mutex_);
    facts_.walk = walk;
    facts_.state = ServicePhase::walking;
    setup_ = walk.setup;
    walk_waits_.store(true, std::memory_order_release);
}

void Monitor::end_walk() {
    // The monitor thread of that walk has ended: its part is ours.
    incident_recorder_.finish();
    telemetry_.publish();
    const MutexLock lock(facts_mutex_);
    facts_.state = ServicePhase::stopped;
}

void Monitor::set_state(ServicePhase state) {
    const MutexLock lock(facts_mutex_);
    facts_.state = state;
}

void Monitor::set_degraded(std::vector<rt::Lack> degraded) {
    const MutexLock lock(facts_mutex_);
    facts_.degraded = std::move(degraded);
}

void Monitor::add_degraded(const rt::Lack& degraded) {
    const MutexLock lock(facts_mutex_);
    facts_.degraded.push_back(degraded);
}

void Monitor::set_input(const rt::InputState& input) {
    const MutexLock lock(facts_mutex_);
    facts_.input = input;
}

void Monitor::add_note(std::string_view text) {
    const MutexLock lock(facts_mutex_);
    recent_notes_.push_back({rt::monotonic_ns(), std::string(text.substr(0, max_note_bytes))});
    if (recent_notes_.size() > max_notes) recent_notes_.pop_front();
}

void Monitor::take_walk() {
    rt::TelemetrySetup setup;
    {
        const MutexLock lock(facts_mutex_);
        setup = setup_;
        walk_waits_.store(false, std::memory_order_relaxed);
    }
    telemetry_.begin(setup);
    incident_recorder_.begin(setup.period_ns);
}

void Monitor::on_record(const rt::FrameRecord& record) {
    monitor_thread_.plays();
    if (walk_waits_.load(std::memory_order_acquire)) take_walk();
    telemetry_.add(record);
    incident_recorder_.add(record);
    if (record.complete_ns - cpu_read_ns_ < cpu_every_ns && record.complete_ns >= cpu_read_ns_) return;
    cpu_read_ns_ = record.complete_ns;
    const std::int64_t cpu_ns = rt::own_cpu_ns();  // another walk's monitor is another thread, and starts from zero
    cpu_ns_.fetch_add(cpu_ns >= cpu_seen_ns_ ? cpu_ns - cpu_seen_ns_ : cpu_ns, std::memory_order_relaxed);
    cpu_seen_ns_ = cpu_ns;
}

const MonitorPage& Monitor::fill_page(bool with_threads) {
    const std::int64_t now_ns = rt::monotonic_ns();
    MonitorPage& p = cached_->page;
    const rt::ProcessFigures process = p.process;
    {
        const MutexLock lock(facts_mutex_);
        p = facts_;
        for (const Note& n : recent_notes_) p.notes.push_back({static_cast<double>(now_ns - n.at_ns) * 1e-9, n.text});
    }
    p.process = process;
    if (cached_->process_ns == 0 || now_ns - cached_->process_ns >= process_age_ns) {
        p.process = rt::read_process();
        cached_->process_ns = now_ns;
    }
    if (with_threads) p.threads = rt::read_busy_threads();
    p.figures = &telemetry_.newest();
    p.rare_checks = rare_checks();
    p.up_s = static_cast<double>(now_ns - started_ns_) * 1e-9;
    p.last_frame_age_s = p.figures->frames > 0 && p.walk.clock == rt::name_of(rt::ClockKind::real)
                             ? static_cast<double>(std::max<std::int64_t>(now_ns - p.figures->last.complete_ns, 0)) * 1e-9
                             : -1;
    p.counts.monitor_cpu_s = static_cast<double>(cpu_ns_.load(std::memory_order_relaxed)) * 1e-9;
    p.counts.bursts = incident_recorder_.bursts();
    p.counts.incidents_suppressed = incident_recorder_.suppressed();
    if (writer_) {
        p.counts.incidents_written = writer_->written();
        p.counts.incidents_failed = writer_->failed();
    }
    if (const Server* server = serving_.load(std::memory_order_acquire)) {
        const ServerCounts c = server->counts();
        p.counts.scrapes = c.answered;
        p.counts.refused = c.refused;
        p.counts.dropped_slow = c.dropped_slow;
        p.counts.dropped_full = c.dropped_full;
        p.counts.open_readers = c.open;
    }
    return p;
}

std::optional<Server::Page> Monitor::page(std::string_view path) {
    static const auto index = std::make_shared<const std::string>(
        "surefoot\n\n/metrics      for Prometheus\n/status.json  for `surefoot status` and `surefoot top`\n");
    if (path == "/") return Server::Page{"text/plain; charset=utf-8", index};
    const bool metrics = path == "/metrics";
    if (!metrics && path != "/status.json") return std::nullopt;
    Cached::Text& kept = metrics ? cached_->metrics : cached_->status;
    const std::int64_t now_ns = rt::monotonic_ns();
    if (!kept.text || now_ns - kept.made_ns >= page_age_ns) {
        const MonitorPage& filled = fill_page(!metrics);
        kept.text = std::make_shared<const std::string>(metrics ? prometheus_text(filled) : status_json(filled));
        kept.made_ns = now_ns;
    }
    return Server::Page{metrics ? prometheus_content_type : "application/json", kept.text};
}

}  // namespace surefoot::monitor
