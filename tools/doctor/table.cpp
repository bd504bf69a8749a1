// Plain text; colour only where it is asked for.
#include "tools/doctor/table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/doctor/words.hpp"

namespace surefoot::doctor {

namespace {

constexpr std::size_t name_width = 17, what_width = 37, indent = 4 + name_width + what_width;

class Pen {
public:
    explicit Pen(const TableOptions& options) : options_(options) {}
    [[nodiscard]] std::string paint(std::string_view code, std::string_view text) const {
        return options_.colour ? fmt::format("\033[{}m{}\033[0m", code, text) : std::string(text);
    }
    [[nodiscard]] std::string bold(std::string_view text) const { return paint("1", text); }
    [[nodiscard]] std::string dim(std::string_view text) const { return paint("2", text); }
    [[nodiscard]] std::string mark(Status status) const {
        switch (status) {
            case Status::pass:
                return paint("32", options_.utf8 ? "✓" : "+");
            case Status::fail:
                return paint("1;31", options_.utf8 ? "✗" : "x");
            case Status::unknown:
                return paint("33", "?");
        }
        return {};
    }
    [[nodiscard]] std::string arrow() const { return options_.utf8 ? "→" : "->"; }

private:
    const TableOptions& options_;
};

/// Words in lines of at most `width`; a longer word has a line of its own.
std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
    std::vector<std::string> lines(1);
    for (const std::string_view word : split(text, " ")) {
        if (!lines.back().empty() && lines.back().size() + 1 + word.size() > width) lines.emplace_back();
        lines.back() += (lines.back().empty() ? "" : " ") + std::string(word);
    }
    return lines;
}

std::string row(const Examined& e, const Pen& pen, std::size_t width) {
    const std::string name(e.check.name.substr(e.check.name.find('.') + 1));
    std::string text = fmt::format("  {} {:<{}}{}", pen.mark(e.finding.status), name, name_width,
                                   pen.dim(fmt::format("{:<{}}", e.check.what, what_width)));
    const auto lines = wrapped(e.finding.evidence, std::max<std::size_t>(width, indent + 30) - indent);
    for (std::size_t i = 0; i < lines.size(); ++i)
        text +=
            (i == 0 ? "" : std::string(indent, ' ')) + (e.finding.status == Status::fail ? pen.bold(lines[i]) : lines[i]) + "\n";
    if (e.finding.status != Status::pass && !e.finding.remedy.empty())
        text += fmt::format("    {} {}\n", pen.paint("36", pen.arrow()), pen.paint("36", e.finding.remedy));
    return text;
}

std::string wake_row(const WakeFigures& f) {
    const std::string stolen = f.steal_ms >= 0 ? fmt::format("{:.0f} ms", f.steal_ms) : "-";
    const std::string skipped = f.source == "surefoot" ? std::to_string(f.skipped) : "-";
    return fmt::format("  {:<11}{:>7.1f} s{:>9.0f}{:>9.0f}{:>9.0f}{:>9.0f}{:>9}{:>9}{:>9}\n", f.source, f.seconds, f.p50_us,
                       f.p99_us, f.p999_us, f.max_us, f.slots, skipped, stolen);
}

std::string wake_table(const Probed& probed, const Pen& pen) {
    if (!probed.wake_up) return {};
    const WakeFigures& f = *probed.wake_up;
    std::string text =
        fmt::format("\n{}  {}\n", pen.bold("wake-up"),
                    pen.dim(fmt::format("every 1 ms on core {}, {}; lateness in us", f.core,
                                        f.priority > 0 ? fmt::format("SCHED_FIFO {}", f.priority) : "ordinary scheduling")));
    text += pen.dim(fmt::format("  {:<11}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}", "", "time", "p50", "p99", "p99.9", "max",
                                "slots", "skipped", "stolen")) +
            "\n";
    text += wake_row(f);
    if (probed.cyclictest) text += wake_row(*probed.cyclictest);
    return text;
}

}  // namespace

std::string table(const Machine& machine, std::span<const Examined> examined, const TableOptions& options) {
    const Pen pen(options);
    std::string text, topic;
    for (const Examined& e : examined) {
        const std::string its(e.check.name.substr(0, e.check.name.find('.')));
        if (its != topic) text += (topic.empty() ? "" : "\n") + pen.bold(its) + "\n";
        topic = its;
        text += row(e, pen, options.width);
    }
    text += wake_table(machine.probed(), pen);
    const Summary s = summarise(examined);
    const std::string counts = fmt::format("{} pass, {} fail, {} unknown", s.pass, s.fail, s.unknown);
    const std::string core = machine.frame_core() ? fmt::format("frame core {}", *machine.frame_core()) : "no frame core found";
    text += fmt::format("\n{} ({}): {}\n", pen.bold(counts), core,
                        s.fail > 0      ? pen.paint("1;31", "not fit")
                        : s.unknown > 0 ? pen.paint("33", "nothing fails, but some checks are unknown")
                                        : pen.paint("32", "fit"));
    return text;
}

}  // namespace surefoot::doctor
