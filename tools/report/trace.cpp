// A trace that Perfetto opens: what every frame was promised, what it took, its phases, and every miss with its cause.
// Format: Chrome trace events (JSON); "expected" and "actual" tracks as in Perfetto's FrameTimeline.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <string>

#include "rt/base/file.hpp"
#include "tools/report/report.hpp"
#include "tools/report/times.hpp"

namespace surefoot::report {

namespace {

using rt::FrameRecord;

enum Track : int { expected = 1, actual = 2, phases = 3, misses = 4, bare = 5 };

constexpr std::array<std::pair<Track, std::string_view>, 5> tracks = {
    {{expected, "expected"}, {actual, "actual"}, {phases, "phases"}, {misses, "misses"}, {bare, "control: bare loop"}}};

/// Writes events as they come; the file is complete only after finish().
class TraceWriter {
public:
    TraceWriter(AtomicFile& file, std::int64_t start_ns) : file_(file), start_ns_(start_ns) {
        put("{{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n"
            "{{\"ph\":\"M\",\"pid\":1,\"name\":\"process_name\",\"args\":{{\"name\":\"surefoot walk\"}}}}");
        for (const auto& [track, name] : tracks) {
            put(",\n{{\"ph\":\"M\",\"pid\":1,\"tid\":{},\"name\":\"thread_name\",\"args\":{{\"name\":\"{}\"}}}}", int{track},
                name);
            put(",\n{{\"ph\":\"M\",\"pid\":1,\"tid\":{0},\"name\":\"thread_sort_index\",\"args\":{{\"sort_index\":{0}}}}}",
                int{track});
        }
    }
    /// A slice; `args` is the inside of a JSON object.
    void slice(Track track, std::string_view category, std::string_view name, std::int64_t from_ns, std::int64_t to_ns,
               std::string_view args = {}, std::string_view colour = {}) {
        if (to_ns < from_ns) to_ns = from_ns;
        put(",\n{{\"ph\":\"X\",\"pid\":1,\"tid\":{},\"cat\":\"{}\",\"name\":\"{}\",\"ts\":{},\"dur\":{}", int{track}, category,
            name, us(from_ns - start_ns_), us(to_ns - from_ns));
        if (!colour.empty()) put(",\"cname\":\"{}\"", colour);
        if (!args.empty()) put(",\"args\":{{{}}}", args);
        put("}}");
    }
    void instant(Track track, std::string_view category, std::string_view name, std::int64_t at_ns, std::string_view args) {
        put(",\n{{\"ph\":\"i\",\"s\":\"g\",\"pid\":1,\"tid\":{},\"cat\":\"{}\",\"name\":\"{}\",\"ts\":{},\"args\":{{{}}}}}",
            int{track}, category, name, us(at_ns - start_ns_), args);
    }
    void counter(std::string_view name, std::int64_t at_ns, double value) {
        if (std::isfinite(value))
            put(",\n{{\"ph\":\"C\",\"pid\":1,\"name\":\"{}\",\"ts\":{},\"args\":{{\"value\":{:.3f}}}}}", name,
                us(at_ns - start_ns_), value);
    }
    Result<void> flush_if(std::size_t bytes) {
        if (text_.size() < bytes) return {};
        auto written = file_.write(std::string_view(text_.data(), text_.size()));
        text_.clear();
        return written;
    }
    Result<void> finish() {
        put("\n]}}\n");
        if (auto written = flush_if(0); !written) return written;
        return file_.commit();
    }

private:
    /// Microseconds with all nanoseconds kept, without a detour through floating point.
    static std::string us(std::int64_t ns) {
        const std::int64_t magnitude = ns < 0 ? -ns : ns;
        return fmt::format("{}{}.{:03d}", ns < 0 ? "-" : "", magnitude / 1000, magnitude % 1000);
    }
    template <class... Args>
    void put(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    }
    AtomicFile& file_;
    std::int64_t start_ns_;
    fmt::memory_buffer text_;
};

std::string frame_args(const FrameRecord& f) {
    return fmt::format(
        "\"slot\":{},\"cause\":\"{}\",\"missed\":{},\"own_miss\":{},\"slack_us\":{:.1f},\"predicted_us\":{:.1f},\"actual_us\":{:."
        "1f},"
        "\"budget_us\":{:.1f},\"nodes\":{},\"triangles\":{},\"switches\":{},\"downgraded_slices\":{},\"prepared_age\":{},"
        "\"stolen_us\":{:.1f}",
        f.slot, rt::cause_of(f), f.missed, f.own_miss, slack_us(f), f.predicted_us, f.actual_us, f.budget_us, f.items,
        f.triangles, f.switches, f.downgraded_slices, f.prepared_age, us_between(0, f.stolen_ns));
}

void write_frame(TraceWriter& trace, const FrameRecord& f) {
    const std::string name = fmt::format("frame {}", f.frame);
    const std::int64_t slot_ns = f.deadline_ns - f.due_ns;  // about
    if (f.skipped_before > 0)
        trace.slice(expected, "skipped", fmt::format("skipped {}", f.skipped_before), f.due_ns - slot_ns * f.skipped_before,
                    f.due_ns, {}, "terrible");
    trace.slice(expected, "expected", name, f.due_ns, f.deadline_ns);
    if (f.control) {
        trace.slice(bare, "frame", name, f.woken_ns, f.complete_ns, frame_args(f), f.missed ? "terrible" : "grey");
        return;
    }
    trace.slice(actual, "frame", name, f.woken_ns, f.complete_ns, frame_args(f), f.missed ? "terrible" : "good");
    trace.slice(phases, "phase", "wake", f.due_ns, f.woken_ns);
    trace.slice(phases, "phase", "select", f.woken_ns, f.selected_ns);
    trace.slice(phases, "phase", "submit", f.selected_ns, f.submitted_ns);
    trace.slice(phases, "phase", "raster", f.submitted_ns, f.rastered_ns);
    trace.slice(phases, "phase", "present", f.handed_ns > 0 ? f.handed_ns : f.rastered_ns,
                f.handed_ns > 0 ? f.presented_ns : f.complete_ns);
    trace.counter("budget spent, %", f.woken_ns, 100 * share_of_budget(f));
    trace.counter("accuracy, 1/rad", f.woken_ns, double{f.accuracy});
    trace.counter("resolution, %", f.woken_ns, 100 * double{f.resolution});
    trace.counter("triangles", f.woken_ns, static_cast<double>(f.triangles));
}

}  // namespace

Result<void> write_trace(const std::string& file, std::span<const FrameRecord> records) {
    auto out = AtomicFile::create(file);
    if (!out) return out.error();
    TraceWriter trace(*out, records.empty() ? 0 : records.front().due_ns);
    for (const FrameRecord& f : records) {
        write_frame(trace, f);
        if (f.missed)
            trace.instant(misses, "miss", rt::cause_of(f), f.complete_ns > f.deadline_ns ? f.deadline_ns : f.show_ns,
                          fmt::format("\"frame\":{},\"late_us\":{:.1f},\"own\":{}", f.frame, -slack_us(f), f.own_miss));
        if (auto written = trace.flush_if(1U << 20U); !written) return written;
    }
    return trace.finish();
}

}  // namespace surefoot::report
