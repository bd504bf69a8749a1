// The Prometheus page: a family is a function or a row; what each number means stands in its HELP.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "tools/monitor/page.hpp"

namespace surefoot::monitor {

namespace {

using rt::Figures;
using rt::Series;

/// As the format wants numbers: shortest that reads back the same, +Inf, -Inf, NaN.
std::string sample_number(double value) {
    if (std::isnan(value)) return "NaN";
    if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
    return fmt::format("{}", value);
}

/// Nanoseconds as seconds, all digits kept.
std::string exact_seconds(std::int64_t ns) {
    std::string text = fmt::format("{}.{:09d}", ns / 1'000'000'000, ns % 1'000'000'000);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
}

std::string label_value(std::string_view text) {
    std::string out;
    for (const char c : text.substr(0, 200)) {
        if (c == '\\' || c == '"') out += '\\';
        if (c == '\n')
            out += "\\n";
        else
            out += static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e ? '?' : c;
    }
    return out;
}

class Exposition {
public:
    void family(std::string_view name, std::string_view type, std::string_view help) {
        put("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
        name_ = name;
    }
    /// labels: empty, or `name="value",…`
    void sample(double value, std::string_view labels = {}) { line({}, labels, sample_number(value)); }
    void counter(std::string_view name, std::string_view help, double value) {
        family(name, "counter", help);
        sample(value);
    }
    void counter(std::string_view name, std::string_view help, std::uint64_t value) {
        family(name, "counter", help);
        line({}, {}, fmt::format("{}", value));
    }
    void count(std::uint64_t value, std::string_view labels) { line({}, labels, fmt::format("{}", value)); }
    /// A gauge; left out where the value is not known (NaN): a missing series is not a zero.
    void gauge(std::string_view name, std::string_view help, double value) {
        if (std::isnan(value)) return;
        family(name, "gauge", help);
        sample(value);
    }
    void histogram(const rt::Distribution& d, const rt::Edges& edges, const std::string& labels = {}) {
        const std::string comma = labels.empty() ? "" : labels + ",";
        std::uint64_t below = 0;
        for (std::size_t i = 0; i < edges.ns().size(); ++i) {
            below += d.up_to[i];
            line("_bucket", comma + "le=\"" + exact_seconds(edges.ns()[i]) + "\"", fmt::format("{}", below));
        }
        line("_bucket", comma + "le=\"+Inf\"", fmt::format("{}", d.fine.count()));
        line("_sum", labels, sample_number(d.fine.sum() * 1e-9));
        line("_count", labels, fmt::format("{}", d.fine.count()));
    }
    void summary(const rt::Histogram& h, const std::array<std::pair<std::string_view, double>, 4>& quantiles) {
        for (const auto& [name, q] : quantiles)
            line({}, fmt::format("quantile=\"{}\"", name), sample_number(static_cast<double>(h.quantile(q)) * 1e-9));
        line("_sum", {}, sample_number(h.sum() * 1e-9));
        line("_count", {}, fmt::format("{}", h.count()));
    }
    std::string take() { return fmt::to_string(text_); }

private:
    void line(std::string_view suffix, std::string_view labels, std::string_view value) {
        if (labels.empty())
            put("{}{} {}\n", name_, suffix, value);
        else
            put("{}{}{{{}}} {}\n", name_, suffix, labels, value);
    }
    template <class... Args>
    void put(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    }
    std::string name_;
    fmt::memory_buffer text_;
};

void add_identity(Exposition& e, const MonitorPage& p) {
    e.family("surefoot_build_info", "gauge", "Always 1; the version is the label.");
    e.sample(1, fmt::format("version=\"{}\"", label_value(p.version)));
    if (!p.walk.model.empty()) {
        e.family("surefoot_walk_info", "gauge", "Always 1; what is walked, and by what, are the labels.");
        e.sample(1, fmt::format("model=\"{}\",selector=\"{}\",backend=\"{}\",renderer=\"{}\",clock=\"{}\",late=\"{}\"",
                                label_value(p.walk.model), label_value(p.walk.selector), label_value(p.walk.backend),
                                label_value(p.walk.renderer), label_value(p.walk.clock), rt::name_of(p.walk.setup.late)));
    }
    e.family("surefoot_state", "gauge", "1 for what the service does now, 0 for the others.");
    for (std::size_t i = 0; i < service_state_count; ++i) {
        const auto state = static_cast<ServicePhase>(i);
        e.sample(p.state == state ? 1 : 0, fmt::format("state=\"{}\"", service_phase_name(state)));
    }
    e.family("surefoot_degraded", "gauge",
             "1 if something that real time needs is refused or missing, by reason. `surefoot status` shows how to grant it.");
    for (const std::string_view reason : degraded_reasons()) {
        const bool lacking = std::any_of(p.degraded.begin(), p.degraded.end(),
                                         [&](const rt::Lack& lack) { return degraded_reason(lack.kind) == reason; });
        e.sample(lacking ? 1 : 0, fmt::format("reason=\"{}\"", reason));
    }
    e.gauge("surefoot_start_time_seconds", "When this monitor started, seconds since 1970.", p.started_unix_s);
}

void add_slots(Exposition& e, const Figures& f) {
    e.counter("surefoot_frames_total", "Frames run. Slots are frames + skipped + lost, exactly.", f.frames);
    e.counter("surefoot_skipped_slots_total", "Slots of the grid without a frame, because an earlier frame ran over them.",
              f.skipped_slots);
    e.counter("surefoot_lost_slots_total", "Slots whose record did not reach the monitor.", f.lost_slots);
    e.counter("surefoot_slots_total", "Slots of the grid that have passed.", f.slots());
    e.family("surefoot_misses_total", "counter", "Frames that were whole after their deadline, or shown too late, by cause.");
    for (int i = 1; i < rt::cause_count; ++i)
        e.count(f.misses[static_cast<std::size_t>(i)], fmt::format("cause=\"{}\"", rt::cause_names[static_cast<std::size_t>(i)]));
    e.counter("surefoot_own_misses_total", "Misses that would be late even without the time that the host or other threads took.",
              f.own_misses);
    if (f.core_steal_known)
        e.counter(
            "surefoot_core_steal_misses_total",
            "Misses that looked like work and are called stolen by the kernel's steal of the frame's cores (ticks of 10 ms).",
            f.core_steal_misses);
}

void add_times(Exposition& e, const Figures& f) {
    e.family("surefoot_phase_seconds", "histogram",
             "Time of a frame's phases: wake = due to awake, prepare = CPU time of the workers for its set, then the phases in "
             "their order.");
    for (const auto& [name, series] : {std::pair{"wake", Series::wake},
                                       {"prepare", Series::prepare},
                                       {"select", Series::select},
                                       {"submit", Series::submit},
                                       {"raster", Series::raster},
                                       {"present", Series::present}})
        e.histogram(f.of(series), f.edges, fmt::format("phase=\"{}\"", name));
    e.family("surefoot_frame_seconds", "histogram",
             "From when a frame was due until its picture was whole; the deadline is one period less what presenting takes.");
    e.histogram(f.of(Series::frame), f.edges);
    e.family("surefoot_slack_seconds", "histogram", "Time left before the deadline, for frames in time.");
    e.histogram(f.of(Series::slack), f.edges);
    e.family("surefoot_lateness_seconds", "histogram",
             "Of late frames: deadline to end. Of skipped slots: their deadline to the end of the next frame. Every slot is in "
             "this or in surefoot_slack_seconds.");
    e.histogram(f.of(Series::lateness), f.edges);
    e.family("surefoot_shown_interval_seconds", "histogram", "From one picture shown to the next one.");
    e.histogram(f.of(Series::shown_interval), f.edges);
    e.family("surefoot_shown_error_seconds", "histogram",
             "|shown - planned| of pictures that are planned for a point of the grid (late policy lock).");
    e.histogram(f.of(Series::shown_error), f.edges);
    e.family("surefoot_shown_frames_total", "counter", "Frames by who told when their picture was shown.");
    for (std::size_t i = 0; i < f.shown_by.size(); ++i) e.count(f.shown_by[i], fmt::format("by=\"{}\"", rt::shown_by_names[i]));
    e.family(
        "surefoot_animation_error_seconds", "histogram",
        "|(shown[n] - shown[n-1]) - (due[n] - due[n-1])|: PresentMon's animation error, a frame's pose being that of its due "
        "time.");
    e.histogram(f.of(Series::animation_error), f.edges);
    e.family("surefoot_input_age_seconds", "histogram",
             "Of frames with new reports: from the newest report's stamp until the frame was submitted.");
    e.histogram(f.of(Series::input_age), f.edges);
    e.family("surefoot_input_to_shown_seconds", "histogram",
             "Of frames with new reports whose picture was shown: from the newest report's stamp until then.");
    e.histogram(f.of(Series::input_to_shown), f.edges);

    e.family("surefoot_frame_time_quantile_seconds", "summary",
             "Quantiles of surefoot_frame_seconds since the start, from bins of 1/32 of their value; quantile 1 is the exact "
             "maximum.");
    e.summary(f.of(Series::frame).fine, {{{"0.5", 0.5}, {"0.99", 0.99}, {"0.999", 0.999}, {"1", 1.0}}});
    e.gauge("surefoot_one_percent_low_hertz", "1 / (99th percentile of surefoot_shown_interval_seconds since the start).",
            f.of(Series::shown_interval).fine.count() > 0 ? f.one_percent_low_hz() : std::nan(""));
}

void add_work(Exposition& e, const Figures& f) {
    e.counter("surefoot_slices_total", "Slices submitted.", f.slices);
    e.counter("surefoot_downgraded_slices_total", "Slices drawn by their coarser stand-in to keep the deadline.",
              f.downgraded_slices);
    e.counter("surefoot_floor_frames_total", "Frames whose coarsest picture exceeded the budget.", f.floor_frames);
    e.counter("surefoot_rest_frames_total", "Frames that drew no cut, because the eye was at rest.", f.rest_frames);
    e.counter("surefoot_broken_guarantees_total", "Frames below the accuracy that is guaranteed.", f.broken_guarantees);
    e.counter("surefoot_trilinear_frames_total", "Frames whose textures blend two mip levels.", f.trilinear_frames);
    e.counter("surefoot_pictures_shown_total", "Pictures of the image cache that frames showed.", f.pictures_shown);
    e.counter("surefoot_pictures_made_total", "Pictures that the image cache made.", f.pictures_made);
    e.counter("surefoot_picture_captures_seconds_total", "Predicted time of making these pictures.", f.captures_us * 1e-6);
    e.counter("surefoot_uncovered_items_total", "Items drawn in place of pictures that were not valid any more.",
              f.uncovered_items);
    e.counter("surefoot_switches_total", "Nodes whose form changed between frames.", f.switches);
    e.counter("surefoot_triangles_total", "Triangles drawn.", f.triangles);
    e.family("surefoot_page_faults_total", "counter", "Page faults of the frame thread in its own code.");
    e.count(f.minor_faults, "kind=\"minor\"");
    e.count(f.major_faults, "kind=\"major\"");
    e.counter("surefoot_driver_page_faults_total", "Page faults of the frame thread inside the graphics driver.",
              f.driver_faults);
    e.counter("surefoot_driver_allocations_total", "Allocations of the frame thread inside the graphics driver.",
              f.driver_allocations);
    e.counter("surefoot_guard_violations_total", "Allocations of the frame thread in its own code. There should be none.",
              f.guard_violations);
    e.counter("surefoot_continues_total", "Times that the process was stopped from outside and continued.", f.continues);
    e.counter("surefoot_input_reports_total", "Reports of input devices that reached a pose of a frame.", f.input_reports);
    e.counter("surefoot_stopped_frames_total", "Frames that stood still: emergency stop or dead-man.", f.stopped_frames);
    e.counter("surefoot_stolen_seconds_total", "Frame time that the host took: wall less CPU less known waits, no switch seen.",
              static_cast<double>(f.stolen_ns) * 1e-9);
    e.counter("surefoot_preempted_seconds_total", "Frame time that other threads took.",
              static_cast<double>(f.preempted_ns) * 1e-9);
    e.counter("surefoot_frame_cpu_seconds_total", "CPU time of the frame thread within frames.",
              static_cast<double>(f.frame_cpu_ns) * 1e-9);
    e.counter("surefoot_raster_cpu_seconds_total", "CPU time of the driver's rasterisers within frames.",
              static_cast<double>(f.raster_cpu_ns) * 1e-9);
    e.counter("surefoot_prepare_cpu_seconds_total", "CPU time of the workers for the sets that frames used.",
              f.prepare_cpu_us * 1e-6);
}

/// The means of the last frames, about 4 s at 60 Hz.
void add_now(Exposition& e, const MonitorPage& p) {
    const Figures& f = *p.figures;
    constexpr std::uint64_t look_back = 256;
    const std::uint64_t n = std::min({f.recent_count, look_back, std::uint64_t{Figures::max_recent}});
    double used = 0, min_accuracy = std::numeric_limits<double>::infinity();
    for (std::uint64_t i = f.recent_count - n; i < f.recent_count; ++i) {
        const rt::RecentFrame& r = f.recent[i % Figures::max_recent];
        used += double{r.used};
        if (!std::isnan(r.accuracy)) min_accuracy = std::min(min_accuracy, double{r.accuracy});
    }
    const double unknown = std::nan("");
    const bool any = n > 0;
    e.gauge("surefoot_period_seconds", "Period of the grid: a frame's deadline is one period after it is due.",
            static_cast<double>(f.setup.period_ns) * 1e-9);
    e.gauge("surefoot_budget_seconds", "What the newest frame could spend on drawing.",
            any ? double{f.last.budget_us} * 1e-6 : unknown);
    e.gauge("surefoot_budget_used_ratio",
            "(CPU time of the frame thread + that of the rasterisers / their number) / period: mean of the last 256 frames.",
            any ? used / static_cast<double>(n) : unknown);
    e.gauge("surefoot_accuracy_per_radian",
            "Accuracy that the newest frame reached: 1 / its largest angular error; +Inf where all was exact.",
            any ? double{f.last.accuracy} : unknown);
    e.gauge("surefoot_guaranteed_accuracy_per_radian", "Accuracy that frames guarantee; 0: none.",
            any ? double{f.last.guaranteed_accuracy} : unknown);
    e.gauge("surefoot_accuracy_least_per_radian", "Least accuracy of the last 256 frames.", any ? min_accuracy : unknown);
    e.gauge("surefoot_picture_memory_bytes", "Of all pictures that the image cache holds.",
            any ? static_cast<double>(f.last.picture_bytes) : unknown);
    e.gauge("surefoot_prepared_age_frames", "Age of the prepared set that the newest frame used; 1 is the newest possible.",
            any ? f.last.prepared_age : unknown);
    e.gauge("surefoot_last_frame_age_seconds", "Time since the end of the newest frame that the monitor has received.",
            p.last_frame_age_s >= 0 ? p.last_frame_age_s : unknown);
    e.gauge("surefoot_standing_still", "1 while the walk stands still: emergency stop or dead-man.",
            any ? (f.last.stopped ? 1.0 : 0.0) : 0.0);
    e.gauge("surefoot_emergency_stop", "1 while an emergency stop is latched.", p.input.emergency_stop ? 1 : 0);
    e.gauge("surefoot_input_devices", "Input devices that steer now.", p.input.live ? p.input.devices : std::nan(""));
}

void add_process(Exposition& e, const rt::ProcessFigures& p) {
    const auto known = [](std::int64_t value) { return value >= 0 ? static_cast<double>(value) : std::nan(""); };
    e.gauge("process_resident_memory_bytes", "Resident memory.", known(p.rss_bytes));
    e.gauge("process_virtual_memory_bytes", "Virtual memory.", known(p.virtual_bytes));
    e.gauge("surefoot_locked_memory_bytes", "Memory locked by this process.", known(p.locked_bytes));
    e.gauge("process_open_fds", "Open file descriptors.", known(p.descriptors));
    e.gauge("process_max_fds", "Limit of open file descriptors.", known(p.max_descriptors));
    e.gauge("process_threads", "Threads of this process.", known(p.threads));
    if (p.cpu_s >= 0) e.counter("process_cpu_seconds_total", "CPU time of the whole process, user and system.", p.cpu_s);
    if (p.steal_s >= 0)
        e.counter("surefoot_host_steal_seconds_total", "Time that the host took from all cores since boot (/proc/stat).",
                  p.steal_s);
}

void add_monitor(Exposition& e, const MonitorCounts& c) {
    e.counter("surefoot_monitor_scrapes_total", "Pages handed out by the monitor.", c.scrapes);
    e.counter("surefoot_monitor_refused_requests_total", "Requests answered with an error.", c.refused);
    e.family("surefoot_monitor_dropped_readers_total", "counter", "Readers dropped: too slow, or too many at once.");
    e.count(c.dropped_slow, "reason=\"slow\"");
    e.count(c.dropped_full, "reason=\"full\"");
    e.gauge("surefoot_monitor_open_readers", "Readers connected now.", static_cast<double>(c.open_readers));
    e.counter("surefoot_monitor_cpu_seconds_total", "CPU time of the monitor thread.", c.monitor_cpu_s);
    e.counter("surefoot_miss_bursts_total", "Bursts of misses.", c.bursts);
    e.family(
        "surefoot_incidents_total", "counter",
        "What became of bursts: written to disk; suppressed, by the limits of rate or because one was being written; failed.");
    e.count(c.incidents_written, "outcome=\"written\"");
    e.count(c.incidents_suppressed, "outcome=\"suppressed\"");
    e.count(c.incidents_failed, "outcome=\"failed\"");
}

}  // namespace

std::string prometheus_text(const MonitorPage& page) {
    Exposition e;
    add_identity(e, page);
    add_slots(e, *page.figures);
    add_times(e, *page.figures);
    add_work(e, *page.figures);
    add_now(e, page);
    std::uint64_t failed_checks = 0;
    for (const RareCheck& c : page.rare_checks) failed_checks += c.count;
    e.counter("surefoot_rare_checks_failed_total",
              "Failed checks of what cannot happen. There should be none; `surefoot status` names the places.", failed_checks);
    add_process(e, page.process);
    add_monitor(e, page.counts);
    return e.take();
}

}  // namespace surefoot::monitor
