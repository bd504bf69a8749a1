// The status page as JSON, and the words of the monitor's page.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "tools/monitor/page.hpp"

namespace surefoot::monitor {

namespace {

using nlohmann::ordered_json;
using rt::Figures;
using rt::Series;

/// By rt::LackKind.
constexpr std::array<std::string_view, 10> reasons = {"fifo",       "memory_lock",  "isolated_core", "throttled", "placing",
                                                      "cost_table", "switched_off", "census",        "sanitizer", "other"};

ordered_json known(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }
ordered_json counted(std::int64_t value) { return value >= 0 ? ordered_json(value) : ordered_json(nullptr); }

ordered_json distribution_json(const rt::Histogram& h, double ns_per_unit) {
    if (h.count() == 0) return nullptr;
    const auto at = [&](double q) { return static_cast<double>(h.quantile(q)) / ns_per_unit; };
    return {{"min", at(0)}, {"p50", at(0.5)}, {"p99", at(0.99)}, {"p999", at(0.999)}, {"max", at(1)}, {"count", h.count()}};
}

/// Exact quantiles of a few values; changes their order.
ordered_json few_json(std::vector<double> values) {
    const Quantiles q = quantiles(std::move(values));
    return {{"min", q.min}, {"p50", q.p50}, {"p99", q.p99}, {"max", q.max}, {"mean", q.mean}};
}

/// The last seconds, for live views: figures of them, and the frames themselves.
ordered_json recent_json(const Figures& f) {
    constexpr double look_back_s = 10;
    const auto max_frames = static_cast<std::uint64_t>(std::ceil(look_back_s * 1e9 / static_cast<double>(f.setup.period_ns)));
    const std::uint64_t n =
        std::min({f.recent_count, std::max<std::uint64_t>(max_frames, 30), std::uint64_t{Figures::max_recent}});
    std::vector<double> frame, wake, slack, used, accuracy, resolution;
    ordered_json frames = ordered_json::array(), causes = ordered_json::object();
    std::uint64_t misses = 0, skipped = 0;
    for (std::uint64_t i = f.recent_count - n; i < f.recent_count; ++i) {
        const rt::RecentFrame& r = f.recent[i % Figures::max_recent];
        frame.push_back(double{r.frame_us} * 1e-3);
        wake.push_back(double{r.wake_us});
        slack.push_back(double{r.slack_us} * 1e-3);
        used.push_back(double{r.used});
        resolution.push_back(double{r.resolution});
        accuracy.push_back(double{r.accuracy});
        misses += r.missed ? 1 : 0;
        skipped += r.skipped_before;
        if (r.missed) {
            const std::string cause(rt::cause_names[static_cast<std::size_t>(r.cause)]);
            causes[cause] = causes.value(cause, 0) + 1;
        }
        // Skipped slots stand before the frame that came after them: a gap is a gap.
        frames.push_back({std::round(double{r.frame_us}) * 1e-3, r.skipped_before, r.missed});
    }
    ordered_json j = {{"frames", n}, {"seconds", static_cast<double>((n + skipped) * f.setup.period_ns) * 1e-9}};
    j["misses"] = misses;
    j["skipped"] = skipped;
    j["miss_causes"] = causes;
    j["frame_ms"] = few_json(frame);
    j["wake_us"] = few_json(wake);
    j["slack_ms"] = few_json(slack);
    j["budget_used"] = few_json(used);
    // Frames that were exact have no error to give a figure of.
    const bool all_exact = std::none_of(accuracy.begin(), accuracy.end(), [](double a) { return std::isfinite(a); });
    j["accuracy"] = all_exact ? ordered_json(nullptr) : few_json(accuracy);
    j["resolution"] = few_json(resolution);
    j["frame_ms_skipped_missed"] = frames;
    return j;
}

ordered_json totals_json(const Figures& f) {
    ordered_json causes = ordered_json::object();
    for (std::size_t i = 1; i < rt::cause_count; ++i)
        if (f.misses[i] > 0) causes[std::string(rt::cause_names[i])] = f.misses[i];
    ordered_json j = {{"frames", f.frames}, {"slots", f.slots()}, {"skipped", f.skipped_slots}, {"lost", f.lost_slots}};
    j["misses"] = f.all_misses();
    j["own_misses"] = f.own_misses;
    j["miss_causes"] = causes;
    j["core_steal_misses"] = f.core_steal_known ? ordered_json(f.core_steal_misses) : ordered_json(nullptr);
    j["downgrades"] = f.downgraded_slices;
    j["switches"] = f.switches;
    j["page_faults"] = f.minor_faults + f.major_faults;
    j["driver_faults"] = f.driver_faults;
    j["driver_allocations"] = f.driver_allocations;
    j["guard_violations"] = f.guard_violations;
    j["input_reports"] = f.input_reports;
    j["stopped_frames"] = f.stopped_frames;
    j["floor_bound_frames"] = f.floor_frames;
    j["rest_frames"] = f.rest_frames;
    j["trilinear_frames"] = f.trilinear_frames;
    j["broken_guarantees"] = f.broken_guarantees;
    j["pictures_shown"] = f.pictures_shown;
    j["pictures_made"] = f.pictures_made;
    j["captures_ms"] = f.captures_us * 1e-3;
    j["uncovered_items"] = f.uncovered_items;
    j["stolen_ms"] = static_cast<double>(f.stolen_ns) * 1e-6;
    j["preempted_ms"] = static_cast<double>(f.preempted_ns) * 1e-6;
    return j;
}

/// Parts of the light that the frame had no time for.
ordered_json dropped_json(const rt::FrameRecord& frame) {
    ordered_json names = ordered_json::array();
    for (std::size_t i = 0; i < rt::switch_count; ++i)
        if (frame.dropped_parts[i].dropped) names.push_back(std::string(rt::light_switches[i].name));
    return names;
}

/// The image cache in the newest frame; null where the walk has none.
ordered_json pictures_json(const MonitorPage& p) {
    const rt::FrameRecord& f = p.figures->last;
    if (!p.walk.cache || p.figures->frames == 0) return nullptr;
    return {{"shown", f.pictures},
            {"made", f.pictures_made},
            {"reused", f.pictures_reused},
            {"boxes_as_triangles", f.boxes_as_triangles},
            {"bytes", f.picture_bytes},
            {"draw_ms", double{f.pictures_us} * 1e-3},
            {"make_ms", double{f.captures_us} * 1e-3},
            {"uncovered_items", f.uncovered_items}};
}

ordered_json times_json(const Figures& f) {
    constexpr double to_ms = 1e6, to_us = 1e3;  // divided by: 33333333 ns are 33.333333 ms, no digit more
    ordered_json j;
    for (const auto& [name, series, per_ns] : {std::tuple{"frame_ms", Series::frame, to_ms},
                                               {"wake_us", Series::wake, to_us},
                                               {"prepare_cpu_us", Series::prepare, to_us},
                                               {"select_us", Series::select, to_us},
                                               {"submit_ms", Series::submit, to_ms},
                                               {"raster_ms", Series::raster, to_ms},
                                               {"present_ms", Series::present, to_ms},
                                               {"slack_ms", Series::slack, to_ms},
                                               {"lateness_ms", Series::lateness, to_ms},
                                               {"shown_interval_ms", Series::shown_interval, to_ms},
                                               {"shown_error_us", Series::shown_error, to_us},
                                               {"animation_error_ms", Series::animation_error, to_ms},
                                               {"input_age_ms", Series::input_age, to_ms},
                                               {"input_to_shown_ms", Series::input_to_shown, to_ms}})
        j[name] = distribution_json(f.of(series).fine, per_ns);
    const rt::ShownBy by = f.shown_by_whom();
    j["shown_by"] = by == rt::ShownBy::nothing ? ordered_json(nullptr) : ordered_json(rt::name_of(by));
    j["one_percent_low_hz"] = f.of(Series::shown_interval).fine.count() > 0 ? ordered_json(f.one_percent_low_hz()) : nullptr;
    return j;
}

ordered_json walk_json(const MonitoredWalk& w) {
    if (w.model.empty()) return nullptr;
    return {{"model", w.model},
            {"path", w.path},
            {"selector", w.selector},
            {"backend", w.backend},
            {"renderer", w.renderer},
            {"clock", w.clock},
            {"rate_hz", w.rate_hz},
            {"cache", w.cache},
            {"period_ms", static_cast<double>(w.setup.period_ns) / 1e6},
            {"late", std::string(rt::name_of(w.setup.late))},
            {"rt",
             {{"fifo", w.granted.fifo},
              {"locked", w.granted.locked},
              {"isolated", w.granted.isolated},
              {"frame_core", w.granted.frame_core}}}};
}

ordered_json threads_json(const std::vector<rt::BusyThread>& threads) {
    ordered_json all = ordered_json::array();
    for (const rt::BusyThread& t : threads) {
        all.push_back({{"tid", t.info.tid},
                       {"name", t.info.name},
                       {"policy", std::string(rt::policy_name(t.info.policy))},
                       {"priority", t.info.priority},
                       {"cores", t.info.cpus.text()},
                       {"cpu_s", static_cast<double>(t.cpu_ns) * 1e-9}});
    }
    return all;
}

ordered_json monitor_json(const MonitorCounts& c) {
    return {{"scrapes", c.scrapes},
            {"refused", c.refused},
            {"dropped_slow", c.dropped_slow},
            {"dropped_full", c.dropped_full},
            {"open_readers", c.open_readers},
            {"cpu_s", c.monitor_cpu_s},
            {"bursts", c.bursts},
            {"incidents",
             {{"written", c.incidents_written}, {"suppressed", c.incidents_suppressed}, {"failed", c.incidents_failed}}}};
}

}  // namespace

std::string_view service_phase_name(ServicePhase state) {
    constexpr std::array<std::string_view, service_state_count> names = {"starting", "walking", "stopped", "failed"};
    return names[static_cast<std::size_t>(state)];
}

std::span<const std::string_view> degraded_reasons() { return reasons; }

std::string_view degraded_reason(rt::LackKind kind) { return reasons[static_cast<std::size_t>(kind)]; }

std::string status_json(const MonitorPage& p) {
    const Figures& f = *p.figures;
    ordered_json degraded = ordered_json::array(), notes = ordered_json::array();
    for (const rt::Lack& d : p.degraded)
        degraded.push_back({{"reason", std::string(degraded_reason(d.kind))}, {"what", d.what}, {"remedy", d.remedy}});
    for (const MonitoredNote& n : p.notes) notes.push_back({{"age_s", n.age_s}, {"text", n.text}});
    ordered_json j = {{"version", p.version}, {"pid", p.pid}, {"state", std::string(service_phase_name(p.state))}};
    j["up_s"] = p.up_s;
    j["last_frame_age_s"] = p.last_frame_age_s >= 0 ? ordered_json(p.last_frame_age_s) : ordered_json(nullptr);
    j["walk"] = walk_json(p.walk);
    j["totals"] = totals_json(f);
    j["times"] = times_json(f);
    j["recent"] = recent_json(f);
    j["now"] = {{"accuracy", f.frames > 0 ? known(double{f.last.accuracy}) : ordered_json(nullptr)},
                {"guaranteed_accuracy", f.frames > 0 && f.last.guaranteed_accuracy > 0 ? ordered_json(f.last.guaranteed_accuracy)
                                                                                       : ordered_json(nullptr)},
                {"reached_accuracy", f.frames > 0 ? known(double{f.last.reached_accuracy}) : ordered_json(nullptr)},
                {"guarantee", std::string(rt::name_of(f.last.guarantee))},
                {"binding_node", f.last.binding_node != rt::no_node ? ordered_json(f.last.binding_node) : ordered_json(nullptr)},
                {"value", f.last.value > 0 ? known(double{f.last.value}) : ordered_json(nullptr)},
                {"one_more_ms_value", f.last.value > 0 ? known(double{f.last.one_more_ms}) : ordered_json(nullptr)},
                {"exact", f.frames > 0 && std::isinf(f.last.accuracy)},
                {"budget_ms", f.frames > 0 ? known(double{f.last.budget_us} * 1e-3) : ordered_json(nullptr)},
                {"resolution", f.frames > 0 ? known(double{f.last.resolution}) : ordered_json(nullptr)},
                {"samples", f.frames > 0 ? ordered_json(f.last.samples) : ordered_json(nullptr)},
                {"filter", f.frames > 0 ? ordered_json(rt::name_of(f.last.filter)) : ordered_json(nullptr)},
                {"at_rest", f.last.at_rest},
                {"rest_samples", f.last.rest_samples},
                {"dropped_parts", dropped_json(f.last)},
                {"pictures", pictures_json(p)},
                {"triangles", f.last.triangles},
                {"nodes", f.last.items},
                {"standing_still", f.last.stopped}};
    j["input"] = {{"live", p.input.live},
                  {"devices", p.input.devices},
                  {"emergency_stop", p.input.emergency_stop},
                  {"walking", p.input.walking},
                  {"barrier", p.input.barrier.empty() ? ordered_json(nullptr) : ordered_json(p.input.barrier)},
                  {"barrier_text", p.input.barrier.empty() ? ordered_json(nullptr) : ordered_json(p.input.barrier_help)}};
    j["degraded"] = degraded;
    j["notes"] = notes;
    j["process"] = {{"rss_bytes", counted(p.process.rss_bytes)},
                    {"locked_bytes", counted(p.process.locked_bytes)},
                    {"descriptors", counted(p.process.descriptors)},
                    {"threads", counted(p.process.threads)},
                    {"cpu_s", p.process.cpu_s >= 0 ? ordered_json(p.process.cpu_s) : ordered_json(nullptr)},
                    {"host_steal_s", p.process.steal_s >= 0 ? ordered_json(p.process.steal_s) : ordered_json(nullptr)}};
    j["threads"] = threads_json(p.threads);
    j["rare_checks"] = ordered_json::array();
    for (const RareCheck& c : p.rare_checks)
        j["rare_checks"].push_back({{"place", c.place}, {"sentence", c.sentence}, {"count", c.count}});
    j["monitor"] = monitor_json(p.counts);
    return j.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace surefoot::monitor
