// Topics, findings, remedies, and what a wake-up run measured.
#include "tools/doctor/check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "rt/base/text.hpp"

namespace surefoot::doctor {

namespace {

using report::Ink;
using report::inked;
using report::TerminalStyle;

constexpr std::size_t name_width = 17, what_width = 37, indent = 4 + name_width + what_width;

std::string mark(Status status, const TerminalStyle& style) {
    switch (status) {
        case Status::pass:
            return inked(style, Ink::good, style.unicode ? "✓" : "+");
        case Status::fail:
            return inked(style, Ink::strong_bad, style.unicode ? "✗" : "x");
        case Status::unknown:
            return inked(style, Ink::warn, "?");
    }
    return {};
}

/// With one space between words: what the kernel writes may hold more.
std::string single_spaced(std::string_view text) { return fmt::format("{}", fmt::join(split(text, " "), " ")); }

std::string row(const Examined& e, const TerminalStyle& style) {
    const std::string name(e.check.name.substr(e.check.name.find('.') + 1));
    std::string text = fmt::format("  {} {:<{}}{}", mark(e.finding.status, style), name, name_width,
                                   inked(style, Ink::dim, fmt::format("{:<{}}", e.check.what, what_width)));
    const auto lines =
        report::wrapped(single_spaced(e.finding.evidence), std::max<std::size_t>(style.width, indent + 30) - indent);
    for (std::size_t i = 0; i < lines.size(); ++i)
        text += (i == 0 ? "" : std::string(indent, ' ')) +
                (e.finding.status == Status::fail ? inked(style, Ink::bold, lines[i]) : lines[i]) + "\n";
    if (e.finding.status != Status::pass && !e.finding.remedy.empty())
        text += fmt::format("    {} {}\n", inked(style, Ink::hint, style.unicode ? "→" : "->"),
                            inked(style, Ink::hint, e.finding.remedy));
    return text;
}

const report::Columns wake_columns({{"", 13},
                                    {"time", -9, 0},
                                    {"p50", -9, 0},
                                    {"p99", -9, 0},
                                    {"p99.9", -9, 0},
                                    {"max", -9, 0},
                                    {"slots", -9, 0},
                                    {"skipped", -9, 0},
                                    {"stolen", -9, 0}});

std::string wake_row(const WakeFigures& f) {
    const std::string stolen = f.steal_ms >= 0 ? fmt::format("{:.0f} ms", f.steal_ms) : "-";
    const std::string skipped = f.source == "surefoot" ? std::to_string(f.skipped) : "-";
    const auto us = [](double value) { return fmt::format("{:.0f}", value); };
    return wake_columns.row({"  " + f.source, fmt::format("{:.1f} s", f.seconds), us(f.p50_us), us(f.p99_us), us(f.p999_us),
                             us(f.max_us), std::to_string(f.slots), skipped, stolen}) +
           "\n";
}

std::string wake_table(const Probed& probed, const TerminalStyle& style) {
    if (!probed.wake_up) return {};
    const WakeFigures& f = *probed.wake_up;
    std::string text =
        fmt::format("\n{}  {}\n", inked(style, Ink::bold, "wake-up"),
                    inked(style, Ink::dim,
                          fmt::format("every 1 ms on core {}, {}; lateness in us", f.core,
                                      f.priority > 0 ? fmt::format("SCHED_FIFO {}", f.priority) : "ordinary scheduling")));
    text += inked(style, Ink::dim, wake_columns.heading()) + "\n";
    text += wake_row(f);
    if (probed.cyclictest) text += wake_row(*probed.cyclictest);
    return text;
}

}  // namespace

std::string table(const Machine& machine, std::span<const Examined> examined, const TerminalStyle& style) {
    std::string text, topic;
    for (const Examined& e : examined) {
        const std::string its(e.check.name.substr(0, e.check.name.find('.')));
        if (its != topic) text += (topic.empty() ? "" : "\n") + inked(style, Ink::bold, its) + "\n";
        topic = its;
        text += row(e, style);
    }
    text += wake_table(machine.probed(), style);
    const Summary s = summarise(examined);
    const std::string counts = fmt::format("{} pass, {} fail, {} unknown", s.pass, s.fail, s.unknown);
    const std::string core = machine.frame_core() ? fmt::format("frame core {}", *machine.frame_core()) : "no frame core found";
    text += fmt::format("\n{} ({}): {}\n", inked(style, Ink::bold, counts), core,
                        s.fail > 0      ? inked(style, Ink::strong_bad, "not fit")
                        : s.unknown > 0 ? inked(style, Ink::warn, "nothing fails, but some checks are unknown")
                                        : inked(style, Ink::good, "fit"));
    return text;
}

}  // namespace surefoot::doctor
