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

/// Our own wake-up run first, before other libraries are loaded; then cyclictest, on the same core at the same priority.
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
        if (!theirs && !context.stop->load()) notify(theirs.error().text());
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
        return misuse({"--root " + a.root, "This is not a folder", "Name one that holds another machine's /proc, /sys and /etc",
                       ErrorKind::not_found});
    const rt::CpuMask allowed = rt::allowed_cpus();
    if (a.root.empty() && a.frame_core >= 0 && !allowed.has(a.frame_core))
        return misuse({fmt::format("--frame-core {}", a.frame_core), "This process may not use the core",
                       "Choose one of " + allowed.text(), ErrorKind::misuse});
    doctor::Probed probed;
    if (a.root.empty()) {
        const auto core = doctor::Machine("", wanted, {}).frame_core();
        if (!a.quick && core) wake_up(a, context, *core, probed);
        if (context.stop->load())
            return fail(
                {"doctor", "The checks were stopped before the end", "Use --quick to skip the wake-up run", ErrorKind::stopped});
        const auto figures = std::pair(probed.wake_up, probed.cyclictest);
        probed = doctor::probe_machine(wanted);
        std::tie(probed.wake_up, probed.cyclictest) = figures;
    }
    const doctor::Machine machine(a.root, wanted, std::move(probed));
    const auto examined = doctor::examine(machine);
    if (a.json) {
        print_json(to_json(machine, examined));
    } else {
        fmt::print("{}", doctor::table(machine, examined, report::terminal_style(context.colour, 120)));
    }
    return doctor::summarise(examined).fail == 0 ? exit_success : exit_failure;
}

}  // namespace

void add_doctor(CLI::App& app, Context& context) {
    auto a = std::make_shared<DoctorArguments>();
    CLI::App* c = add_command(app, "doctor", "Check whether this machine can keep deadlines, and show how to fix what fails",
                              "surefoot doctor --quick\n\nExit status: 0 nothing fails, 1 something fails, 2 wrong use.\nA check "
                              "without an answer is 'unknown': "
                              "neither a pass nor a failure.",
                              a->json);
    c->add_option("--root", a->root, "Check the files of another machine below this folder; nothing is tried or measured");
    auto* seconds =
        c->add_option("--seconds", a->seconds, "Duration of the wake-up run; cyclictest runs as long, if it is installed")
            ->check(number_within(1, 86400, "s"))
            ->capture_default_str();
    c->add_option("--frame-core", a->frame_core, "Core of the frame thread (else an isolated core, else the last core)")
        ->check(whole_number_within(0, 1023));
    c->add_option("--state", a->state, "Folder of the cost table (else $STATE_DIRECTORY, else the XDG state folder)");
    c->add_flag("--quick", a->quick, "Skip the wake-up run");
    c->callback([&context, a, seconds] {
        context.run = [&context, a, given = seconds->count() > 0] {
            if (given && a->quick)
                return misuse({"--seconds", "--quick measures nothing, so it has no length", "Remove --seconds or --quick",
                               ErrorKind::misuse});
            if (given && !a->root.empty())
                return misuse({"--seconds", "Only this machine can be measured, not the one below --root",
                               "Remove --seconds or --root", ErrorKind::misuse});
            return run_doctor(*a, context);
        };
    });
}

}  // namespace surefoot::cli
