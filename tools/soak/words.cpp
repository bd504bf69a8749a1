// A soak's verdict in words, and its table for a terminal.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rt/base/modes.hpp"
#include "tools/report/svg.hpp"
#include "tools/report/terminal.hpp"
#include "tools/report/verdict.hpp"
#include "tools/soak/summary.hpp"

namespace surefoot::soak {

std::string_view judged_name(Judged judged) {
    switch (judged) {
        case Judged::holds:
            return "holds";
        case Judged::broken:
            return "broken";
        case Judged::not_judged:
            break;
    }
    return "not judged";
}

Judged verdict_of(const SoakSummary& s) {
    Judged all = s.checks.empty() ? Judged::not_judged : Judged::holds;
    for (const SoakCheck& check : s.checks) {
        if (check.judged == Judged::broken) return Judged::broken;
        if (check.judged == Judged::not_judged) all = Judged::not_judged;
    }
    return all;
}

std::string duration_words(double seconds) {
    if (seconds < 119.5) return fmt::format("{:.0f} seconds", seconds);
    if (seconds < 7170) return fmt::format("{:.3g} minutes", std::round(seconds / 6) / 10);
    return fmt::format("{:.3g} hours", std::round(seconds / 360) / 10);
}

std::string soak_headline(const SoakSummary& s) {
    if (s.walk.frames == 0) return "No frame was drawn.";
    const bool on_virtual_clock = s.walk.clock == rt::name_of(rt::ClockKind::virtual_time);
    std::string text =
        fmt::format("{} {}: {} frames", duration_words(s.ran_s), on_virtual_clock ? "of virtual time" : "under load",
                    report::grouped(static_cast<double>(s.walk.frames)));
    if (s.walk.misses == 0) return text + ", none missed.";
    text += fmt::format(", {} missed", report::grouped(static_cast<double>(s.walk.misses)));
    if (s.walk.own_misses == 0) return text + (s.walk.misses == 1 ? ", and not by its own doing." : ", none by its own doing.");
    return text + fmt::format(", {} by its own doing.", report::grouped(static_cast<double>(s.walk.own_misses)));
}

namespace {

report::Ink ink_of(Judged judged) {
    return judged == Judged::holds ? report::Ink::good : judged == Judged::broken ? report::Ink::bad : report::Ink::warn;
}

}  // namespace

std::string soak_table(const SoakSummary& s, bool colour) {
    report::LabelledText table(colour);
    const Judged verdict = verdict_of(s);
    table.row("soak", soak_headline(s), report::strong(ink_of(verdict)));
    if (s.stopped)
        table.row("", fmt::format("stopped by the user; {} were requested", duration_words(s.requested_s)), report::Ink::warn);
    for (const SoakCheck& check : s.checks)
        table.row(check.name, fmt::format("{}: {}", judged_name(check.judged), check.words), ink_of(check.judged));
    for (const SoakLoad& load : s.loads)
        table.row("load " + load.name, load.words, load.ran && !load.real ? report::Ink::warn : report::Ink::plain);
    std::string causes;
    for (const auto& [cause, count] : s.walk.miss_causes)
        causes += fmt::format("{}{} {}", causes.empty() ? "" : ", ", cause, count);
    if (!causes.empty()) table.row("misses", causes);
    table.row("frame", fmt::format("p50 {:.2f}, p99 {:.2f}, p99.9 {:.2f}, max {:.2f} ms; deadline {:.2f} ms", s.walk.frame_ms.p50,
                                   s.walk.frame_ms.p99, s.walk.frame_ms.p999, s.walk.frame_ms.max,
                                   s.walk.rate_hz > 0 ? 1000 / s.walk.rate_hz : 0));
    table.row("accuracy", fmt::format("mean {} /rad ({}), worst {} /rad ({})", report::short_number(s.walk.accuracy_mean),
                                      report::accuracy_words(s.walk.accuracy_mean), report::short_number(s.walk.accuracy_min),
                                      report::accuracy_words(s.walk.accuracy_min)));
    if (s.walk.guarantee.accuracy > 0) table.row("guarantee", report::guarantee_words(s.walk.guarantee));
    table.row("machine", fmt::format("{}; {:.0f} ms stolen by the host", s.machine.kernel, s.machine.steal_ms));
    if (!s.walk.uncalibrated.empty()) table.row("uncalibrated", s.walk.uncalibrated, report::Ink::warn);
    for (const rt::Lack& d : s.walk.degraded) table.row("degraded", d.text(), report::Ink::warn);
    const std::string last = verdict == Judged::holds    ? "the verdict holds"
                             : verdict == Judged::broken ? "the verdict is broken"
                                                         : "no rule is broken, but some cannot be judged";
    table.row("verdict", last, report::strong(ink_of(verdict)));
    return table.text();
}

}  // namespace surefoot::soak
