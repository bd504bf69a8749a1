// The ledger: one row a frame, bare control frames included and marked. A column is one line of the table below.
#include <fmt/format.h>

#include <array>
#include <iterator>
#include <string>

#include "rt/base/file.hpp"
#include "tools/report/report.hpp"
#include "tools/report/times.hpp"

namespace surefoot::report {

namespace {

using rt::FrameRecord;

struct Column {
    std::string_view name;
    void (*put)(fmt::memory_buffer& row, const FrameRecord& f);
};

template <class... Args>
void add(fmt::memory_buffer& row, fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(row), format, std::forward<Args>(args)...);
}

/// Names of the dropped parts of the light, between blanks; or of those that this frame dropped, each with its value per us.
void put_dropped(fmt::memory_buffer& row, const FrameRecord& f, bool fell) {
    const char* between = "";
    for (std::size_t i = 0; i < rt::switch_count; ++i) {
        const rt::DroppedPart& part = f.dropped_parts[i];
        if (!part.dropped || (fell && !part.fell)) continue;
        add(row, "{}{}", between, rt::light_switches[i].name);
        if (fell) add(row, ":{:.4g}", part.fell_at);
        between = " ";
    }
}

// clang-format off
constexpr std::array<Column, 100> columns = {{
    {"frame", [](auto& r, auto& f) { add(r, "{}", f.frame); }},
    {"slot", [](auto& r, auto& f) { add(r, "{}", f.slot); }},
    {"due_ns", [](auto& r, auto& f) { add(r, "{}", f.due_ns); }},
    {"wake_us", [](auto& r, auto& f) { add(r, "{:.3f}", wake_us(f)); }},
    {"select_us", [](auto& r, auto& f) { add(r, "{:.3f}", select_us(f)); }},
    {"submit_us", [](auto& r, auto& f) { add(r, "{:.3f}", submit_us(f)); }},
    {"raster_us", [](auto& r, auto& f) { add(r, "{:.3f}", raster_us(f)); }},
    {"present_us", [](auto& r, auto& f) { add(r, "{:.3f}", present_us(f)); }},
    {"slack_us", [](auto& r, auto& f) { add(r, "{:.3f}", slack_us(f)); }},
    {"frame_us", [](auto& r, auto& f) { add(r, "{:.3f}", us_between(f.due_ns, f.complete_ns)); }},
    {"shown_by", [](auto& r, auto& f) { add(r, "{}", rt::name_of(f.shown_by)); }},
    {"shown_us", [](auto& r, auto& f) { if (f.shown_by != rt::ShownBy::nothing) add(r, "{:.3f}", us_between(f.due_ns, f.shown_ns)); }},
    {"shown_error_us", [](auto& r, auto& f) { if (f.shown_by != rt::ShownBy::nothing) add(r, "{:.3f}", us_between(f.show_ns, f.shown_ns)); }},
    {"predicted_us", [](auto& r, auto& f) { add(r, "{:.1f}", f.predicted_us); }},
    {"actual_us", [](auto& r, auto& f) { add(r, "{:.1f}", f.actual_us); }},
    {"budget_us", [](auto& r, auto& f) { add(r, "{:.1f}", f.budget_us); }},
    {"floor_us", [](auto& r, auto& f) { add(r, "{:.1f}", f.floor_us); }},
    {"correction", [](auto& r, auto& f) { add(r, "{:.4f}", f.correction); }},
    {"nodes", [](auto& r, auto& f) { add(r, "{}", f.items); }},
    {"draws", [](auto& r, auto& f) { add(r, "{}", f.draws); }},
    {"triangles", [](auto& r, auto& f) { add(r, "{}", f.triangles); }},
    {"accuracy", [](auto& r, auto& f) { add(r, "{:.3f}", f.accuracy); }},
    {"value", [](auto& r, auto& f) { add(r, "{:.5f}", f.value); }},
    {"resolution", [](auto& r, auto& f) { add(r, "{:.3f}", f.resolution); }},
    {"samples", [](auto& r, auto& f) { add(r, "{}", f.samples); }},
    {"other_samples", [](auto& r, auto& f) { add(r, "{:d}", f.other_samples); }},
    {"filter", [](auto& r, auto& f) { add(r, "{}", rt::name_of(f.filter)); }},
    {"bought_items", [](auto& r, auto& f) { add(r, "{}", f.bought_items); }},
    {"bought_us", [](auto& r, auto& f) { add(r, "{:.1f}", f.bought_us); }},
    {"refused_items", [](auto& r, auto& f) { add(r, "{}", f.refused_items); }},
    {"at_rest", [](auto& r, auto& f) { add(r, "{:d}", f.at_rest); }},
    {"rest_samples", [](auto& r, auto& f) { add(r, "{}", f.rest_samples); }},
    {"switches", [](auto& r, auto& f) { add(r, "{}", f.switches); }},
    {"slices", [](auto& r, auto& f) { add(r, "{}", f.slices); }},
    {"downgraded_slices", [](auto& r, auto& f) { add(r, "{}", f.downgraded_slices); }},
    {"candidates", [](auto& r, auto& f) { add(r, "{}", f.candidates); }},
    {"visits", [](auto& r, auto& f) { add(r, "{}", f.visits); }},
    {"hidden", [](auto& r, auto& f) { add(r, "{}", f.hidden); }},
    {"prepared_age", [](auto& r, auto& f) { add(r, "{}", f.prepared_age); }},
    {"prepare_cpu_us", [](auto& r, auto& f) { add(r, "{:.1f}", f.prepare_cpu_us); }},
    {"cpu_us", [](auto& r, auto& f) { add(r, "{:.3f}", us_between(0, f.cpu_ns)); }},
    {"raster_cpu_us", [](auto& r, auto& f) { add(r, "{:.3f}", us_between(0, f.raster_cpu_ns)); }},
    {"stolen_us", [](auto& r, auto& f) { add(r, "{:.3f}", us_between(0, f.stolen_ns)); }},
    {"preempted_us", [](auto& r, auto& f) { add(r, "{:.3f}", us_between(0, f.preempted_ns)); }},
    {"core_steal_us", [](auto& r, auto& f) { if (f.core_steal_ns >= 0) add(r, "{:.0f}", us_between(0, f.core_steal_ns)); }},
    {"by_core_steal", [](auto& r, auto& f) { if (f.core_steal_ns >= 0) add(r, "{:d}", f.by_core_steal); }},
    {"waited_us", [](auto& r, auto& f) { add(r, "{:.3f}", us_between(0, f.waited_ns)); }},
    {"upload_us", [](auto& r, auto& f) { add(r, "{:.3f}", us_between(0, f.upload_ns)); }},
    {"voluntary", [](auto& r, auto& f) { add(r, "{}", f.voluntary); }},
    {"involuntary", [](auto& r, auto& f) { add(r, "{}", f.involuntary); }},
    {"minor_faults", [](auto& r, auto& f) { add(r, "{}", f.minor_faults); }},
    {"major_faults", [](auto& r, auto& f) { add(r, "{}", f.major_faults); }},
    {"driver_faults", [](auto& r, auto& f) { add(r, "{}", f.driver_faults); }},
    {"driver_allocations", [](auto& r, auto& f) { add(r, "{}", f.driver_allocations); }},
    {"guard_violations", [](auto& r, auto& f) { add(r, "{}", f.guard_violations); }},
    {"skipped_before", [](auto& r, auto& f) { add(r, "{}", f.skipped_before); }},
    {"missed", [](auto& r, auto& f) { add(r, "{:d}", f.missed); }},
    {"own_miss", [](auto& r, auto& f) { add(r, "{:d}", f.own_miss); }},
    {"cause", [](auto& r, auto& f) { add(r, "{}", rt::cause_of(f)); }},
    {"floor_binds", [](auto& r, auto& f) { add(r, "{:d}", f.floor_binds); }},
    {"floor_share", [](auto& r, auto& f) { add(r, "{:.3f}", f.floor_share); }},
    {"floor_frame", [](auto& r, auto& f) { add(r, "{:d}", f.floor_frame); }},
    {"control", [](auto& r, auto& f) { add(r, "{:d}", f.control); }},
    {"block", [](auto& r, auto& f) { add(r, "{}", f.block); }},
    {"input_age_us", [](auto& r, auto& f) { if (f.input_stamp_ns > 0) add(r, "{:.3f}", us_between(f.input_stamp_ns, f.submitted_ns)); }},
    {"input_reports", [](auto& r, auto& f) { add(r, "{}", f.input_reports); }},
    {"stopped", [](auto& r, auto& f) { add(r, "{:d}", f.stopped); }},
    {"cut_hash", [](auto& r, auto& f) { add(r, "{:016x}", f.cut_hash); }},
    {"guaranteed_accuracy", [](auto& r, auto& f) { add(r, "{:.3f}", f.guaranteed_accuracy); }},
    {"reached_accuracy", [](auto& r, auto& f) { add(r, "{:.3f}", f.reached_accuracy); }},
    {"guarantee", [](auto& r, auto& f) { add(r, "{}", rt::name_of(f.guarantee)); }},
    {"binding_node", [](auto& r, auto& f) { if (f.binding_node != rt::no_node) add(r, "{}", f.binding_node); }},
    {"one_more_ms", [](auto& r, auto& f) { add(r, "{:.5f}", f.one_more_ms); }},
    {"dropped_objects", [](auto& r, auto& f) { add(r, "{}", f.dropped_objects); }},
    {"sunlight", [](auto& r, auto& f) { add(r, "{:d}", f.light.on.sunlight); }},
    {"shadows", [](auto& r, auto& f) { add(r, "{:d}", f.light.on.shadows); }},
    {"lamps", [](auto& r, auto& f) { add(r, "{:d}", f.light.on.lamps); }},
    {"fog", [](auto& r, auto& f) { add(r, "{:d}", f.light.on.fog); }},
    {"hour", [](auto& r, auto& f) { if (rt::has_hour(f.light)) add(r, "{:.4f}", f.light.hour); }},
    {"dropped_parts", [](auto& r, auto& f) { put_dropped(r, f, false); }},
    {"fell_at", [](auto& r, auto& f) { put_dropped(r, f, true); }},
    {"shadow_refreshed", [](auto& r, auto& f) { add(r, "{:d}", f.shadow_refreshed); }},
    {"shadow_shown", [](auto& r, auto& f) { add(r, "{:d}", f.shadow_shown); }},
    {"pictures", [](auto& r, auto& f) { add(r, "{}", f.pictures); }},
    {"pictures_made", [](auto& r, auto& f) { add(r, "{}", f.pictures_made); }},
    {"pictures_reused", [](auto& r, auto& f) { add(r, "{}", f.pictures_reused); }},
    {"boxes_as_triangles", [](auto& r, auto& f) { add(r, "{}", f.boxes_as_triangles); }},
    {"pictures_us", [](auto& r, auto& f) { add(r, "{:.1f}", f.pictures_us); }},
    {"captures_us", [](auto& r, auto& f) { add(r, "{:.1f}", f.captures_us); }},
    {"picture_bytes", [](auto& r, auto& f) { add(r, "{}", f.picture_bytes); }},
    {"uncovered_items", [](auto& r, auto& f) { add(r, "{}", f.uncovered_items); }},
    {"snapped", [](auto& r, auto& f) { add(r, "{:d}", f.snapped); }},
    {"cost_scale", [](auto& r, auto& f) { add(r, "{:.4f}", f.cost_scale); }},
    {"x", [](auto& r, auto& f) { add(r, "{:.4f}", f.eye[0]); }},
    {"y", [](auto& r, auto& f) { add(r, "{:.4f}", f.eye[1]); }},
    {"z", [](auto& r, auto& f) { add(r, "{:.4f}", f.eye[2]); }},
    {"qx", [](auto& r, auto& f) { add(r, "{:.6f}", f.orientation[0]); }},
    {"qy", [](auto& r, auto& f) { add(r, "{:.6f}", f.orientation[1]); }},
    {"qz", [](auto& r, auto& f) { add(r, "{:.6f}", f.orientation[2]); }},
    {"qw", [](auto& r, auto& f) { add(r, "{:.6f}", f.orientation[3]); }},
}};
// clang-format on

}  // namespace

Result<void> write_ledger(AtomicFile& out, std::span<const FrameRecord> records) {
    fmt::memory_buffer rows;
    for (const Column& column : columns) add(rows, "{}{}", &column == columns.data() ? "" : ",", column.name);
    rows.push_back('\n');
    for (const FrameRecord& f : records) {
        for (const Column& column : columns) {
            if (&column != columns.data()) rows.push_back(',');
            column.put(rows, f);
        }
        rows.push_back('\n');
        if (rows.size() < (1U << 20U)) continue;
        if (auto written = out.write(std::string_view(rows.data(), rows.size())); !written) return written;
        rows.clear();
    }
    return out.write(std::string_view(rows.data(), rows.size()));
}

Result<void> write_ledger(const std::string& file, std::span<const FrameRecord> records) {
    auto out = AtomicFile::create(file);
    if (!out) return out.error();
    if (auto written = write_ledger(*out, records); !written) return written;
    return out->commit();
}

}  // namespace surefoot::report
