// Bursts of misses.
#include "systemd/daemon/misses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace surefoot::daemon {

std::optional<Burst> Bursts::add(const rt::FrameRecord& record) {
    const bool bad = record.missed || record.skipped_before > 0;
    const bool open = open_.misses + open_.skipped > 0;
    std::optional<Burst> closed;
    if (open && record.due_ns - open_.last_ns >= quiet_ns) {
        closed = std::exchange(open_, {});
    } else if (open && record.due_ns - open_.began_ns >= longest_ns) {
        open_.goes_on = true;
        closed = std::exchange(open_, {});
    }
    if (!bad) return closed;
    if (open_.misses + open_.skipped == 0) {
        open_.began_ns = record.due_ns;
        open_.first_slot = record.slot;
    }
    open_.last_ns = std::max(record.due_ns, record.complete_ns);
    open_.last_slot = record.slot;
    open_.skipped += record.skipped_before;
    if (!record.missed) return closed;
    ++open_.misses;
    open_.own_misses += record.own_miss ? 1 : 0;
    ++open_.causes[static_cast<std::size_t>(record.cause)];
    open_.worst_late_ns = std::max(open_.worst_late_ns, late_ns(record));
    return closed;
}

std::optional<Burst> Bursts::finish() {
    if (open_.misses + open_.skipped == 0) return std::nullopt;
    return std::exchange(open_, {});
}

rt::Cause Burst::main_cause() const {
    const auto largest = std::max_element(causes.begin(), causes.end());
    return *largest == 0 ? rt::Cause::none : static_cast<rt::Cause>(largest - causes.begin());
}

std::string Burst::text() const {
    const double seconds = static_cast<double>(last_ns - began_ns) * 1e-9;
    const auto counted = [](std::uint64_t count, const char* what) {
        return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
    };
    std::string line = misses > 0 ? counted(misses, "frame") + " missed" : std::string();
    if (misses > 1) line += fmt::format(" in {:.1f} s", seconds);
    if (skipped > 0) line += (misses > 0 ? ", " : "") + counted(skipped, "slot") + " skipped";
    if (misses > 0) line += fmt::format(", at worst {:.1f} ms late", static_cast<double>(worst_late_ns) * 1e-6);
    std::string why;
    for (std::size_t i = 0; i < causes.size(); ++i) {
        if (causes[i] > 0) why += fmt::format("{}{} {}", why.empty() ? ": " : ", ", rt::cause_names[i], causes[i]);
    }
    return line + why + (goes_on ? "; the burst goes on" : "");
}

}  // namespace surefoot::daemon
