// The walk's figures for a terminal: at most 100 columns, the verdict first.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tools/report/report.hpp"
#include "tools/report/svg.hpp"
#include "tools/report/verdict.hpp"

namespace surefoot::report {

namespace {

constexpr std::size_t max_columns = 100;
constexpr std::size_t label_columns = 16;

/// Columns on screen: code points (no wide characters are used here).
std::size_t width_of(std::string_view text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
}

/// The last columns of a word longer than a line: of a path, its end says more than its middle.
std::string end_of(const std::string& text, std::size_t columns) {
    std::size_t at = text.size();
    for (std::size_t kept = 0; at > 0 && kept + 1 < columns; --at)
        kept += (static_cast<unsigned char>(text[at - 1]) & 0xc0U) != 0x80U ? 1 : 0;
    return "…" + text.substr(at);
}

/// Builds lines, and colours only where asked to.
class Table {
public:
    explicit Table(bool colour) : colour_(colour) {}

    void raw(const std::string& line) { text_ += line + "\n"; }
    /// A label and words, wrapped under each other.
    void row(std::string_view label, std::string_view words, std::string_view code = {}) {
        std::string line;
        std::string_view shown = label;
        std::size_t at = 0;
        while (at < words.size()) {
            auto end = words.find(' ', at);
            if (end == std::string_view::npos) end = words.size();
            const auto word = words.substr(at, end - at);
            at = end + 1;
            if (!line.empty() && label_columns + width_of(line) + 1 + width_of(word) > max_columns) {
                put(shown, line, code);
                shown = {};
                line.clear();
            }
            if (!line.empty()) line += ' ';
            line += word;
        }
        put(shown, line, code);
    }
    [[nodiscard]] std::string coloured(std::string_view text, std::string_view code) const {
        if (!colour_ || code.empty()) return std::string(text);
        return fmt::format("\x1b[{}m{}\x1b[0m", code, text);
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    void put(std::string_view label, std::string line, std::string_view code) {
        if (label_columns + width_of(line) > max_columns) line = end_of(line, max_columns - label_columns);
        const std::string padded = fmt::format("{:<{}}", label, label_columns);
        raw(coloured(padded, "2") + coloured(line, code));
    }
    bool colour_;
    std::string text_;
};

void timing_rows(Table& table, const WalkSummary& s) {
    const auto row = [&](std::string_view label, const Quantiles& q, int decimals, std::string_view note) {
        std::string line = fmt::format("{:<{}}", label, label_columns);
        for (const double v : {q.p50, q.p90, q.p99, q.p999, q.max}) line += fmt::format("{:>10.{}f}", v, decimals);
        if (!note.empty()) line += fmt::format("   {}", note);
        table.raw(line);
    };
    table.raw(table.coloured(
        fmt::format("{:<{}}{:>10}{:>10}{:>10}{:>10}{:>10}", "", label_columns, "p50", "p90", "p99", "p99.9", "max"), "2"));
    row("frame, ms", s.frame_ms, 2, s.rate_hz > 0 ? fmt::format("deadline {:.2f}", 1000 / s.rate_hz) : "");
    row("wake, us", s.wake_us, 0, "");
    row("select, us", s.select_us, 0, "");
    row("submit, ms", s.submit_ms, 2, "");
    row("raster, ms", s.raster_ms, 2, "");
    row("prepare, us", s.prepare_cpu_us, 0, "CPU, workers");
    row("array age", s.prepared_age, 0, "frames");
    row("cost error, %",
        {s.cost_error.p50 * 100, s.cost_error.p90 * 100, s.cost_error.p99 * 100, s.cost_error.p999 * 100, s.cost_error.max * 100,
         0, 0},
        1, "");
}

void quality_rows(Table& table, const WalkSummary& s) {
    table.row("budget", fmt::format("{:.2f} ms a frame; used {} of the grid (p99 {}), {} of the budget by the clock on the wall",
                                    s.budget_ms, percent(s.budget_used_mean), percent(s.budget_used_p99),
                                    percent(s.budget_used_wall_mean)));
    table.row("accuracy",
              fmt::format("mean {} /rad ({}), worst {} /rad ({})", short_number(s.accuracy_mean), accuracy_words(s.accuracy_mean),
                          short_number(s.accuracy_min), accuracy_words(s.accuracy_min)));
    std::string triangles =
        fmt::format("mean {}, most {}", short_number(s.triangles_mean), short_number(static_cast<double>(s.triangles_max)));
    if (s.model_triangles > 0)
        triangles += fmt::format(" of the model's {}", short_number(static_cast<double>(s.model_triangles)));
    table.row("triangles", triangles);
    table.row("stability", fmt::format("{:.2f} switches a frame, {} slices drawn coarser, floor bound {} frames",
                                       s.switches_per_frame, s.downgrades, s.floor_bound_frames));
}

void real_time_rows(Table& table, const WalkSummary& s) {
    std::string causes;
    for (const auto& [cause, count] : s.miss_causes) causes += fmt::format("{}{} {}", causes.empty() ? "" : ", ", cause, count);
    if (!causes.empty()) table.row("misses", causes, "33");
    const auto mark = [](bool yes, std::string_view what) { return fmt::format("{}{}", yes ? "" : "not ", what); };
    table.row("real time", fmt::format("{}, {}, {}, {}; page faults {}, guard violations {}, stolen {:.1f} ms",
                                       mark(s.fifo, "FIFO"), mark(s.pinned, "pinned"), mark(s.isolated, "isolated"),
                                       mark(s.locked, "locked"), s.page_faults, s.guard_violations, s.steal_ms));
    table.row("driver", fmt::format("{:.1f} allocations and {:.2f} page faults a frame", s.driver_allocations_per_frame,
                                    s.frames == 0 ? 0.0 : static_cast<double>(s.driver_faults) / static_cast<double>(s.frames)));
    if (!s.threads.empty()) table.row("threads", threads_words(s.threads));
    for (const std::string& problem : s.census_problems) table.row("census", problem, "31");
    if (!s.uncalibrated.empty()) table.row("uncalibrated", s.uncalibrated, "33");
    for (const Degraded& d : s.degraded)
        table.row("degraded", d.remedy.empty() ? d.what : fmt::format("{}: {}", d.what, d.remedy), "33");
    if (s.control.ran) table.row("control", control_words(s.control), rule_broken(s.control) ? "31" : "");
}

}  // namespace

std::string to_table(const WalkSummary& s, bool colour) {
    Table table(colour);
    const Verdict verdict = verdict_of(s);
    table.row("walk", headline(s), verdict == Verdict::good ? "1;32" : verdict == Verdict::warn ? "1;33" : "1;31");
    table.row("model", s.path.empty()  ? s.model
                       : s.input.given ? fmt::format("{} steered by {}, from the start of {}", s.model, s.input.source, s.path)
                                       : fmt::format("{} along {}", s.model, s.path));
    if (s.input.given) table.row("input", input_words(s.input), s.input.stopped_frames > 0 ? "33" : "");
    table.row("drawn", fmt::format("{}x{} at {:.4g} Hz by {} on {} ({}), late: {}, clock: {}", s.width, s.height, s.rate_hz,
                                   s.selector, s.backend, s.renderer, s.late_policy, s.clock));
    table.raw("");
    timing_rows(table, s);
    table.raw("");
    quality_rows(table, s);
    real_time_rows(table, s);
    table.row("cut hash", s.cut_hash);
    return table.text();
}

}  // namespace surefoot::report
