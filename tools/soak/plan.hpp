// The timetable of a soak's loads: phases in an order given by a seed, so the same for every process that reads it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::soak {

enum class LoadKind : std::uint8_t { cpu, memory, io, forks, devices, reloads, caches, clock };
constexpr std::size_t load_kinds = 8;
constexpr std::array<std::string_view, load_kinds> load_names = {"cpu",     "memory",  "io",     "forks",
                                                                 "devices", "reloads", "caches", "clock"};

/// A set of kinds: bit 1 << kind.
using LoadSet = std::uint32_t;
constexpr LoadSet load_bit(LoadKind kind) { return 1U << static_cast<unsigned>(kind); }
constexpr bool has_load(LoadSet set, LoadKind kind) { return (set & load_bit(kind)) != 0; }
/// All but clock, which steps the time of day for the whole machine: it runs only if it is named.
constexpr LoadSet usual_loads = (1U << load_kinds) - 1U - load_bit(LoadKind::clock);
/// Loads that make sense on a virtual clock: those that make work in this process, not contention for a core.
constexpr LoadSet virtual_loads = load_bit(LoadKind::reloads);

/// "cpu,io": names apart by commas. Error: an unknown name, with what is allowed; nothing at all.
Result<LoadSet> parse_mix(std::string_view text);
std::vector<std::string> names_of(LoadSet set);

/// Times in seconds from the first slot.
struct LoadPhase {
    double from_s = 0, to_s = 0;
    LoadSet loads = 0;
};

/// The order of the loads over the soak.
struct LoadPlan {
    LoadSet mix = usual_loads;
    double seconds = 0;
    std::vector<LoadPhase> phases;  ///< gapless from 0 to `seconds`

    /// 0 outside.
    [[nodiscard]] LoadSet at(double time_s) const;
    /// The phase of a time; the last one from its beginning on for ever.
    [[nodiscard]] std::size_t phase_at(double time_s) const;
};

/// The plan consists of rounds. In a round each kind leads one phase, with one or two other kinds, in an order by `seed`. The
/// last phase of a round has all kinds at once. Phases last 30 s, or less where two rounds would not fit. They are whole
/// multiples of pair_s, the length of a pair of control blocks, so that no pair sees two loads.
LoadPlan plan_loads(LoadSet mix, double seconds, double pair_s, std::uint64_t seed);

}  // namespace surefoot::soak
