// The soak's page: the verdict point by point first, then the hours, then what was done to the machine, and what it is.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "rt/base/file.hpp"
#include "rt/base/modes.hpp"
#include "tools/report/charts.hpp"
#include "tools/report/page_parts.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"
#include "tools/report/verdict.hpp"
#include "tools/soak/charts.hpp"
#include "tools/soak/summary.hpp"

namespace surefoot::soak {

namespace {

/// Rules of this page alone, after the house's.
constexpr std::string_view soak_rules = R"css(<style>
.checks{list-style:none;margin:26px 0 14px;padding:0;display:grid;gap:8px}
.checks li{display:grid;grid-template-columns:26px 118px 1fr;gap:4px 12px;align-items:baseline;background:var(--panel);border:1px solid var(--rule);border-radius:12px;padding:11px 16px}
.checks .mark{width:24px;height:24px;border-radius:50%;display:grid;place-items:center;font-size:14px;font-weight:700}
.checks .name{font-weight:630}
.checks .words{color:var(--soft);font-size:14.5px;overflow-wrap:anywhere}
.chart .load{opacity:.85}.chart .load.idle{opacity:.18}
.chart .l0{fill:var(--s1)}.chart .l1{fill:var(--s2)}.chart .l2{fill:var(--s3)}.chart .l3{fill:var(--s4)}.chart .l4{fill:var(--s5)}.chart .l5{fill:var(--s6)}.chart .l6{fill:var(--s0)}.chart .l7{fill:var(--s7)}
.chart .second{stroke:var(--s1)}
@media (max-width:760px){.checks li{grid-template-columns:26px 1fr}.checks .words{grid-column:1/-1}}
</style>
)css";

std::string_view css_of(Judged judged) { return judged == Judged::holds ? "good" : judged == Judged::broken ? "bad" : "warn"; }

std::string model_name(const std::string& path) { return report::escaped(std::filesystem::path(path).filename().string()); }

std::string header_of(const SoakSummary& s) {
    const Judged verdict = verdict_of(s);
    const std::string_view badge = verdict == Judged::holds    ? "the verdict holds"
                                   : verdict == Judged::broken ? "the verdict is broken"
                                                               : "nothing broken, not all judged";
    std::string out = fmt::format(
        "<header>\n<p class=\"brand\"><b>Surefoot</b> soak report</p>\n<div class=\"badge {}\"><i></i>{}</div>\n<h1>{}</h1>\n<p "
        "class=\"lead\"><b>{}</b>",
        css_of(verdict), badge, report::escaped(soak_headline(s)), model_name(s.walk.model));
    if (!s.walk.path.empty()) out += fmt::format(" along <b>{}</b>", model_name(s.walk.path));
    out += fmt::format(" at {:.4g} Hz and {}×{} pixels, drawn by {}", s.walk.rate_hz, s.walk.width, s.walk.height,
                       report::escaped(s.walk.renderer.empty() ? s.walk.backend : s.walk.renderer));
    if (s.walk.clock == rt::name_of(rt::ClockKind::virtual_time)) {
        out += ", on the virtual clock: times are predictions; growth, the grid and the counts are real.";
    } else {
        out += fmt::format(", while {} kinds of load took turns on {} cores.", s.loads.size(), s.machine.cores);
    }
    if (s.stopped) out += fmt::format(" The user stopped it; {} were requested.", duration_words(s.requested_s));
    return out + "</p>\n</header>\n";
}

std::string check_list(const SoakSummary& s) {
    std::string out = "<ul class=\"checks\">\n";
    for (const SoakCheck& c : s.checks) {
        const std::string_view mark = c.judged == Judged::holds ? "✓" : c.judged == Judged::broken ? "✗" : "?";
        out += fmt::format(
            "<li><span class=\"mark {}\" title=\"{}\">{}</span><span class=\"name\">{}</span><span "
            "class=\"words\">{}</span></li>\n",
            css_of(c.judged), judged_name(c.judged), mark, report::escaped(c.name), report::escaped(c.words));
    }
    return out + "</ul>\n";
}

std::string half_card(std::string_view title, std::string_view words, const std::string& chart) {
    return fmt::format("<div class=\"card\"><h3>{}</h3><p>{}</p>{}</div>\n", report::escaped(title), report::escaped(words),
                       chart);
}

std::string hours_section(const SoakSummary& s) {
    std::string out =
        "<h2>The soak from begin to end</h2>\n<p class=\"sub\">Each moment shows its fastest to its slowest frame, and every "
        "miss as a dot. A large dot is the walk's own doing; point at it for its cause. Below stands what loaded the machine at "
        "that time.</p>\n";
    out += fmt::format("<div class=\"card wide\">{}</div>\n", soak_time_chart(s));
    if (s.misses_unlisted > 0)
        out += fmt::format("<p class=\"sub\">The first {} misses are marked; {} more are in the figures alone.</p>\n",
                           s.misses.size(), s.misses_unlisted);
    out += "<div class=\"two\">\n";
    out +=
        half_card("Memory", "What the process has taken, the files that it shows left out. A leak climbs.", soak_memory_chart(s));
    out += half_card("Descriptors and threads", "Flat, or something is not given back.", soak_count_chart(s));
    out +=
        half_card("Worst accuracy", "Of each moment: one over the largest angular error. Load lowers it before it costs a frame.",
                  soak_accuracy_chart(s));
    out += half_card("Misses by load", "While it was on, alone or with others.", soak_load_chart(s));
    if (s.walk.misses > 0)
        out +=
            half_card("Misses by cause", "One cause per miss, from the measurements of that frame.", report::cause_chart(s.walk));
    return out + "</div>\n";
}

std::string load_section(const SoakSummary& s) {
    std::string out =
        "<h2>What was done to the machine</h2>\n<p class=\"sub\">A load counts only if it is known to have been there.</p>\n<div "
        "class=\"card scroll\"><table>\n<tr><th>load</th><th>seconds</th><th>real</th><th></th></tr>\n";
    for (const SoakLoad& l : s.loads)
        out += fmt::format("<tr><td>{}</td><td>{:.0f}</td><td>{}</td><td class=\"words\">{}</td></tr>\n", report::escaped(l.name),
                           l.seconds,
                           !l.ran   ? "not run"
                           : l.real ? "yes"
                                    : "too light",
                           report::escaped(l.words));
    return out + "</table></div>\n";
}

std::string control_part(const report::ControlSummary& control) {
    if (!control.ran) return {};
    return fmt::format(
        "<h2>Against a bare loop</h2>\n<p class=\"sub\">{}</p>\n<div class=\"card\"><div class=\"legend\"><span><i "
        "class=\"c0\"></i>walk</span><span><i class=\"c8\"></i>bare loop of the same cost</span></div>{}</div>\n",
        report::escaped(report::control_words(control)), report::control_chart(control));
}

std::string kernel_section(const SoakSummary& s) {
    const SoakMachine& m = s.machine;
    std::string out = "<h2>The kernel, and what it counted</h2>\n<div class=\"card scroll\"><table>\n";
    const auto row = [&](std::string_view name, const std::string& value) {
        out += fmt::format("<tr><td>{}</td><td class=\"words\">{}</td></tr>\n", name, report::escaped(value));
    };
    row("Kernel", m.kernel);
    row("Its command line", m.kernel_command_line);
    row("Processor", fmt::format("{} ({} cores)", m.processor, m.cores));
    row("This soak", fmt::format("{} (seed {})", s.command_line, s.seed));
    row("Stolen by the host", fmt::format("{:.0f} ms of {} cores", m.steal_ms, m.cores));
    row("Context switches, new processes",
        fmt::format("{}, {}", report::grouped(m.context_switches), report::grouped(m.processes)));
    std::string pressure;
    for (const SoakCount& c : m.pressure)
        pressure += fmt::format("{}{} {}", pressure.empty() ? "" : "; ", c.name, report::percent(c.count));
    row("Pressure (share of the time)", pressure.empty() ? "not told by this kernel" : pressure);
    out += "</table></div>\n<details><summary>Interrupts</summary><div class=\"card scroll\"><table>\n";
    for (const SoakCount& c : m.interrupts)
        out += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", report::escaped(c.name), report::grouped(c.count));
    return out + "</table></div></details>\n";
}

constexpr std::string_view soak_footer =
    "<footer><p>Beside this page: <a href=\"soak.json\">soak.json</a>, all of the figures.</p><p><b>Own miss</b>: late even with "
    "the time taken out that the host stole. <b>Trend</b>: the median of the slopes between all pairs of samples after the "
    "warm-up, which a few odd samples cannot move. <b>Bare loop</b>: blocks of a loop that only burns the walk's CPU time. It "
    "runs in turn with the walk, on the same core under the same load. <b>Pressure</b>: the share of the time in which some (or "
    "all) "
    "work "
    "waited for that resource.</p></footer>\n";

}  // namespace

Result<void> probe_soak_page(const std::string& dir) {
    if (auto ok = FileSet::probe(dir, {"index.html", "soak.json"}); !ok)
        return Error{"--report " + ok.error().place, ok.error().what, ok.error().remedy, ok.error().kind};
    return {};
}

Result<void> write_soak_page(const std::string& dir, const SoakSummary& s) {
    auto files = FileSet::create(dir);
    if (!files) return files.error();
    if (auto written = files->add("soak.json", soak_json(s)); !written) return written;
    const std::string body = std::string(soak_rules) + header_of(s) + report::degraded_notes(s.walk) + check_list(s) +
                             hours_section(s) + load_section(s) + control_part(s.walk.control) + kernel_section(s) +
                             std::string(soak_footer);
    const std::string title = fmt::format("Surefoot soak: {}", model_name(s.walk.model));
    if (auto written = files->add("index.html", report::page(title, body)); !written) return written;
    return files->commit();
}

}  // namespace surefoot::soak
