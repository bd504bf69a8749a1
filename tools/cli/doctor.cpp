// surefoot doctor: is this machine fit? Checks with evidence and remedy, and a wake-up run.
#include <fmt/format.h>

#include <filesystem>
#include <tuple>

#include "config/settings.hpp"
#include "rt/threads/placement.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/doctor/check.hpp"
#include "tools/doctor/machine.hpp"
#include "tools/doctor/wake_up.hpp"
#include "tools/report/terminal.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::cli {

namespace {

struct DoctorArguments {
    std::string root, state;
    double seconds = 10;
    int frame_core = -1;
    bool quick = false, json = false;
};

nlohmann::ordered_json wake_json(const std::optional<doctor::WakeFigures>& f) {
    if (!f) return nullptr;
    nlohmann::ordered_json object = {{"seconds", f->seconds}, {"core", f->core},     {"fifo_priority", f->priority},
                                     {"slots", f->slots},     {"p50_us", f->p50_us}, {"p99_us", f->p99_us},
                                     {"p999_us", f->p999_us}, {"max_us", f->max_us}};
    if (f->source == "surefoot") object["skipped"] = f->skipped;
    if (f->steal_ms >= 0) object["steal_ms"] = f->steal_ms;
    return object;
}

nlohmann::ordered_json to_json(const doctor::Machine& machine, std::span<const doctor::Examined> examined) {
    nlohmann::ordered_json checks = nlohmann::ordered_json::array();
    for (const doctor::Examined& e : examined)
        checks.push_back({{"name", std::string(e.check.name)},
                          {"status", std::string(doctor::status_name(e.finding.status))},
                          {"evidence", e.finding.evidence},
                          {"remedy", e.finding.remedy}});
    const doctor::Summary s = doctor::summarise(examined);
    nlohmann::ordered_json core = nullptr;
    if (machine.frame_core()) core = *machine.frame_core();
    return {{"checks", checks},
            {"summary", {{"pass", s.pass}, {"fail", s.fail}, {"unknown", s.unknown}, {"fit", s.fail == 0}, {"frame_core", core}}},
            {"wake_up", wake_json(machine.probed().wake_up)},
            {"cyclictest", wake_json(machine.probed().cyclictest)}};
}

/// Ours first, while nothing else is loaded; then theirs, on the same core and priority.
void wake_up(const DoctorArguments& a, const Context& context, int core, doctor::Probed& probed) {
    doctor::WakeOptions options;
    options.seconds = a.seconds;
    options.core = core;
    options.priority = static_cast<int>(config::Settings{}.frame_priority);
    probed.wake_up = doctor::run_wake_up(options, terminal_progress(context));
    const auto program = doctor::find_program("cyclictest");
    if (program && !context.stop->load()) {
        options.priority = probed.wake_up->priority;
        auto theirs = doctor::run_cyclictest(*program, options, terminal_progress(context));
        if (theirs) probed.cyclictest = *theirs;
        if (!theirs && !context.stop->load()) note(theirs.error().text());
    }
    end_progress(context);
}

int run_doctor(const DoctorArguments& a, const Context& context) {
    doctor::Wanted wanted;
    wanted.frame_priority = static_cast<int>(config::Settings{}.frame_priority);
    wanted.state_folder = walk::state_directory(a.state);
    if (a.frame_core >= 0) wanted.frame_core = a.frame_core;
    std::error_code ignored;
    if (!a.root.empty() && !std::filesystem::is_directory(a.root, ignored))
        return misuse({"--root " + a.root, "is no folder", "name one that holds another machine's /proc, /sys and /etc"});
    const rt::CpuMask allowed = rt::allowed_cpus();
    if (a.root.empty() && a.frame_core >= 0 && !allowed.has(a.frame_core))
        return misuse(
            {fmt::format("--frame-core {}", a.frame_core), "this process may not use it", "choose one of " + allowed.text()});
    doctor::Probed probed;
    if (a.root.empty()) {
        const auto core = doctor::Machine("", wanted, {}).frame_core();
        if (!a.quick && core) wake_up(a, context, *core, probed);
        if (context.stop->load()) return fail({"doctor", "stopped before it was done", "--quick leaves the wake-up run out"});
        const auto figures = std::pair(probed.wake_up, probed.cyclictest);
        probed = doctor::probe_machine(wanted);
        std::tie(probed.wake_up, probed.cyclictest) = figures;
    }
    const doctor::Machine machine(a.root, wanted, std::move(probed));
    const auto examined = doctor::examine(machine);
    if (a.json) {
        print_json(to_json(machine, examined));
    } else {
        fmt::print("{}", doctor::table(machine, examined, report::terminal_look(context.colour, 120)));
    }
    return doctor::summarise(examined).fail == 0 ? exit_success : exit_failure;
}

}  // namespace

void add_doctor(CLI::App& app, Context& context) {
    auto a = std::make_shared<DoctorArguments>();
    CLI::App* c = add_command(
        app, "doctor", "Is this machine fit for keeping deadlines? What is not, and how to mend it",
        "surefoot doctor --quick\n\nExit status: 0 nothing fails, 1 something fails, 2 wrong use. What could not be told is "
        "'unknown': no pass, and no failure.",
        a->json);
    c->add_option("--root", a->root, "Look at the files of another machine below this folder; nothing is tried or measured");
    auto* seconds =
        c->add_option("--seconds", a->seconds, "How long to measure wake-ups; the same again by cyclictest where it is installed")
            ->check(number_within(1, 86400, "s"))
            ->capture_default_str();
    c->add_option("--frame-core", a->frame_core, "Core of the frame thread (else an isolated one, else the last)")
        ->check(whole_number_within(0, 1023));
    c->add_option("--state", a->state, "Folder of the cost table (else $STATE_DIRECTORY, else XDG state)");
    c->add_flag("--quick", a->quick, "Leave the wake-up run out");
    c->callback([&context, a, seconds] {
        context.run = [&context, a, given = seconds->count() > 0] {
            if (given && a->quick) return misuse({"--seconds", "says how long to measure, and --quick not to", "leave one out"});
            if (given && !a->root.empty())
                return misuse({"--seconds", "measures this machine, not the one below --root", "leave one out"});
            return run_doctor(*a, context);
        };
    });
}

}  // namespace surefoot::cli
