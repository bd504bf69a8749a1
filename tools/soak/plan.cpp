// The timetable of loads.
#include "tools/soak/plan.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/random.hpp"

namespace surefoot::soak {

namespace {

constexpr double longest_phase_s = 30;

std::vector<LoadKind> kinds_in(LoadSet set) {
    std::vector<LoadKind> kinds;
    for (std::size_t i = 0; i < load_kinds; ++i) {
        if (has_load(set, static_cast<LoadKind>(i))) kinds.push_back(static_cast<LoadKind>(i));
    }
    return kinds;
}

/// One round: every kind leads once, then all together.
std::vector<LoadSet> one_round(LoadSet mix, Random& random) {
    std::vector<LoadKind> order = kinds_in(mix);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
    std::vector<LoadSet> round;
    for (const LoadKind leader : order) {
        LoadSet loads = load_bit(leader);
        const std::uint32_t companions = 1 + random.below(2);
        for (std::uint32_t i = 0; i < companions; ++i)
            loads |= load_bit(order[random.below(static_cast<std::uint32_t>(order.size()))]);
        round.push_back(loads);
    }
    round.push_back(mix);
    return round;
}

}  // namespace

Result<LoadSet> parse_mix(std::string_view text) {
    std::string all;
    for (const std::string_view name : load_names) all += (all.empty() ? "" : ", ") + std::string(name);
    LoadSet mix = 0;
    while (!text.empty()) {
        const std::string_view name = text.substr(0, text.find(','));
        text.remove_prefix(std::min(name.size() + 1, text.size()));
        const auto known = std::find(load_names.begin(), load_names.end(), name);
        if (known == load_names.end())
            return Error{"--mix", "There is no load '" + std::string(name) + "'", "Name some of " + all + ", separated by commas",
                         ErrorKind::misuse};
        mix |= 1U << static_cast<unsigned>(known - load_names.begin());
    }
    if (mix == 0) return Error{"--mix", "No load is named", "Name some of " + all + ", separated by commas", ErrorKind::misuse};
    return mix;
}

std::vector<std::string> names_of(LoadSet set) {
    std::vector<std::string> names;
    for (const LoadKind kind : kinds_in(set)) names.emplace_back(load_names[static_cast<std::size_t>(kind)]);
    return names;
}

LoadSet LoadPlan::at(double time_s) const {
    if (phases.empty() || time_s < 0 || time_s >= seconds) return 0;
    return phases[phase_at(time_s)].loads;
}

std::size_t LoadPlan::phase_at(double time_s) const {
    const auto after =
        std::upper_bound(phases.begin(), phases.end(), time_s, [](double t, const LoadPhase& phase) { return t < phase.from_s; });
    return after == phases.begin() ? 0 : static_cast<std::size_t>(after - phases.begin()) - 1;
}

LoadPlan plan_loads(LoadSet mix, double seconds, double pair_s, std::uint64_t seed) {
    LoadPlan plan{mix, seconds, {}};
    if (mix == 0) return plan;
    Random random(seed);
    const double round_phases = static_cast<double>(kinds_in(mix).size()) + 1;
    const double wanted_s = std::min(longest_phase_s, seconds / (2 * round_phases));
    const double phase_s = pair_s * std::max(1.0, std::floor(wanted_s / pair_s));
    std::vector<LoadSet> round;
    for (double at = 0; at < seconds; at += phase_s) {
        if (round.empty()) round = one_round(mix, random);
        plan.phases.push_back({at, std::min(at + phase_s, seconds), round.front()});
        round.erase(round.begin());
    }
    return plan;
}

}  // namespace surefoot::soak
