// `soak --json` and soak.json: the verdict and all that it was judged from.
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/report/rounded.hpp"
#include "tools/soak/summary.hpp"

namespace surefoot::soak {

namespace {

using SoakJson = nlohmann::ordered_json;

SoakJson checks_of(const SoakSummary& s) {
    SoakJson checks = SoakJson::array();
    for (const SoakCheck& c : s.checks)
        checks.push_back({{"name", c.name}, {"judged", judged_name(c.judged)}, {"evidence", c.words}});
    return checks;
}

SoakJson loads_of(const SoakSummary& s) {
    SoakJson loads = SoakJson::array();
    for (const SoakLoad& l : s.loads)
        loads.push_back({{"name", l.name},
                         {"ran", l.ran},
                         {"real", l.real},
                         {"seconds", report::rounded(l.seconds)},
                         {"amount", report::rounded(l.amount)},
                         {"evidence", report::rounded(l.evidence)},
                         {"failures", l.failures},
                         {"proof", l.words}});
    return loads;
}

SoakJson phases_of(const SoakSummary& s) {
    SoakJson phases = SoakJson::array();
    for (const SoakPhase& p : s.phases)
        phases.push_back({{"from_s", report::rounded(p.from_s)},
                          {"to_s", report::rounded(p.to_s)},
                          {"loads", p.loads},
                          {"frames", p.frames},
                          {"misses", p.misses},
                          {"own_misses", p.own_misses},
                          {"skipped", p.skipped},
                          {"frame_ms_p99", report::rounded(p.frame_ms_p99)},
                          {"frame_ms_max", report::rounded(p.frame_ms_max)}});
    return phases;
}

SoakJson process_of(const SoakSummary& s) {
    SoakJson samples = SoakJson::array();
    for (const SoakSample& p : s.samples)
        samples.push_back({report::rounded(p.time_s), p.memory_kib, p.resident_kib, p.descriptors, p.threads});
    return {{"memory_kib_per_hour", s.memory.known ? report::rounded(s.memory.per_s * 3600) : SoakJson(nullptr)},
            {"warm_up_s", report::rounded(s.warm_up_s)},
            {"columns", {"time_s", "memory_kib", "resident_kib", "descriptors", "threads"}},
            {"samples", samples}};
}

SoakJson machine_of(const SoakMachine& m) {
    SoakJson interrupts = SoakJson::object(), pressure = SoakJson::object();
    for (const SoakCount& c : m.interrupts) interrupts[c.name] = c.count;
    for (const SoakCount& c : m.pressure) pressure[c.name] = report::rounded(c.count);
    return {{"kernel", m.kernel},
            {"kernel_command_line", m.kernel_command_line},
            {"processor", m.processor},
            {"cores", m.cores},
            {"steal_ms", report::rounded(m.steal_ms)},
            {"context_switches", m.context_switches},
            {"processes", m.processes},
            {"interrupts", interrupts},
            {"pressure", pressure}};
}

SoakJson misses_of(const SoakSummary& s) {
    SoakJson misses = SoakJson::array();
    for (const SoakMiss& m : s.misses)
        misses.push_back({{"time_s", report::rounded(m.time_s)},
                          {"frame_ms", report::rounded(m.frame_ms)},
                          {"cause", m.cause},
                          {"own", m.own},
                          {"skipped", m.skipped}});
    return misses;
}

}  // namespace

std::string soak_json(const SoakSummary& s) {
    // What a walk says of itself stands under "walk", as `walk --json` says it.
    SoakJson walk = SoakJson::parse(report::to_json(s.walk));
    for (const char* of_kept_records : {"cut_hash", "cost_error", "budget_used"}) walk.erase(of_kept_records);
    const SoakJson json = {
        {"verdict", judged_name(verdict_of(s))},
        {"checks", checks_of(s)},
        {"model", s.walk.model},
        {"path", s.walk.path},
        {"command_line", s.command_line},
        {"clock", s.walk.clock},
        {"seed", s.seed},
        {"asked_s", report::rounded(s.requested_s)},
        {"ran_s", report::rounded(s.ran_s)},
        {"stopped", s.stopped},
        {"grid",
         {{"run", s.slots_run},
          {"skipped", s.slots_skipped},
          {"elapsed", s.slots_elapsed},
          {"drift_ns", s.grid_drift_ns},
          {"records_lost", s.records_lost}}},
        {"loads", loads_of(s)},
        {"phases", phases_of(s)},
        {"misses", misses_of(s)},
        {"misses_untold", s.misses_unlisted},
        {"process", process_of(s)},
        {"machine", machine_of(s.machine)},
        {"walk", walk},
    };
    return json.dump(2, ' ', false, SoakJson::error_handler_t::replace) + "\n";
}

}  // namespace surefoot::soak
