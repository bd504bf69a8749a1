// One walk after another, each as the newest good configuration says.
#include "systemd/daemon/daemon.hpp"

#include <fmt/format.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "rt/base/file.hpp"
#include "rt/threads/memory.hpp"
#include "rt/threads/runaway.hpp"
#include "systemd/daemon/configuration.hpp"
#include "systemd/daemon/exit_code.hpp"
#include "systemd/daemon/log.hpp"
#include "systemd/daemon/misses.hpp"
#include "systemd/daemon/monitoring.hpp"
#include "systemd/daemon/service.hpp"
#include "systemd/daemon/service_state.hpp"
#include "tools/monitor/monitor.hpp"
#include "tools/walk/live_input.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::daemon {

namespace {

/// What a walk ended with.
struct Ending {
    bool failed = false;
    Error error;
    ExitCode code = exit_failure;
};

void log_lack(Log& log, ServiceState& state, const rt::Lack& lack) {
    if (!state.lacks(lack)) return;
    log.write(Priority::warning, event::degraded, "The walk is not fully real-time: " + lack.text(),
              {{"SUREFOOT_LACK", lack.what}, {"SUREFOOT_REMEDY", lack.remedy}});
}

void log_burst(Log& log, const std::optional<Burst>& burst) {
    if (!burst) return;
    log.write(Priority::warning, event::misses, burst->text(),
              {{"SUREFOOT_MISSES", std::to_string(burst->misses)},
               {"SUREFOOT_OWN_MISSES", std::to_string(burst->own_misses)},
               {"SUREFOOT_SKIPPED_SLOTS", std::to_string(burst->skipped)},
               {"SUREFOOT_FIRST_SLOT", std::to_string(burst->first_slot)},
               {"SUREFOOT_CAUSE", std::string(rt::cause_names[static_cast<std::size_t>(burst->main_cause())])},
               {"SUREFOOT_WORST_LATE_US", std::to_string(burst->worst_late_ns / 1000)}});
}

walk::WalkObserver observer_of(Log& log, ServiceState& state, Bursts& bursts, const walk::FaultHook& inject) {
    walk::WalkObserver observer;
    observer.on_step = [&](walk::WalkStep step) { state.step.store(step); };
    observer.on_started = [&](const walk::WalkStart& start) {
        for (const rt::Lack& lack : start.degraded) log_lack(log, state, lack);
        if (!start.uncalibrated.empty() && state.uncalibrated(start.uncalibrated))
            log.write(Priority::warning, event::uncalibrated, "The budget is uncalibrated: " + start.uncalibrated + ".");
        // After the session has raised its limits.
        if (auto ok = rt::guard_runaways(rt::runaway_limit_us(start.period_ns)); !ok)
            log_lack(log, state, {rt::LackKind::other, ok.error().place + ": " + ok.error().what, ok.error().remedy});
        state.walking(start.period_ns, start.t0_ns);
    };
    observer.on_record = [&](const rt::FrameRecord& record) {
        state.count(record);
        log_burst(log, bursts.add(record));
    };
    observer.on_degraded = [&](const rt::Lack& lack) { log_lack(log, state, lack); };
    observer.inject = inject;
    return observer;
}

/// Checks before the first frame that an emergency stop can be stored. Otherwise the next start would forget it.
Result<void> check_state(const walk::WalkRequest& request) {
    if (!walk::may_latch_stop(request)) return {};
    const std::string file = walk::state_directory(request.state_dir) + "/probe";
    auto probe = AtomicFile::create(file);
    if (!probe) return probe.error();
    const std::array<std::byte, 4096> page{};
    return probe->write(page);  // never committed: it goes away again
}

/// `first`: what the process was prepared for.
Ending walk(const config::Configuration& configuration, const walk::WalkRequest& first, const Options& options, Log& log,
            ServiceState& state, monitor::Monitor* monitor, const walk::FaultHook& inject) {
    walk::WalkRequest request = request_of(configuration, options.config_file);
    if (const std::string kept = walk::keep_process(first, request); !kept.empty())
        log.write(Priority::warning, event::reloading, kept, {{"SUREFOOT_CONFIG", options.config_file}});
    if (auto ok = check_state(request); !ok) {
        const Error& e = ok.error();
        return {true,
                {e.place, "The emergency stop cannot be stored in the state folder. " + e.what, e.remedy, e.kind},
                exit_cannot_write};
    }
    Progress progress;
    progress.stop = &state.stop_walk;
    progress.notify = [&](std::string_view text) {
        log.write(Priority::notice, event::input, text);
        if (monitor != nullptr) monitor->add_note(text);
    };
    Bursts bursts;
    walk::WalkObserver observer = observer_of(log, state, bursts, inject);
    if (monitor != nullptr) {
        monitor->set_state(monitor::ServicePhase::starting);
        monitor::attach_monitor(*monitor, request, observer);
    }
    auto outcome = walk::run_walk(request, progress, observer);
    log_burst(log, bursts.finish());
    if (!outcome) return {true, outcome.error(), exit_code_of(state.step.load())};
    for (const std::string& note : outcome->notes) log.write(Priority::notice, event::input, note);
    for (const Error& failure : outcome->failures) {
        if (outcome->lost) return {true, failure, exit_unavailable};
        log.write(Priority::error, event::fault, failure.text());
    }
    return {};
}

/// Walks until the end. If a configuration never shows a frame, the last one that did is used again.
ExitCode walk_on(config::Configuration current, const Options& options, Log& log, ServiceState& state, monitor::Monitor* monitor,
                 const walk::FaultHook& inject) {
    const walk::WalkRequest first = request_of(current, options.config_file);
    std::optional<config::Configuration> good;
    while (true) {
        // This order loses no signal: a request that arrives in between is seen below, or ends the walk at its start.
        state.open(current.values);
        state.stop_walk.store(false);
        if (state.leaving.load()) return exit_success;
        if (auto next = state.take_next()) {
            current = std::move(*next);
            state.open(current.values);
        }
        const Ending ending = walk(current, first, options, log, state, monitor, inject);
        rt::release_memory();  // the next walk claims its own
        if (state.leaving.load()) return exit_success;
        if (state.walk_frames() > 0) good = current;
        if (!ending.failed) {
            if (state.stop_walk.load()) continue;  // a reload
            log.write(Priority::error, event::fault, "The walk ended by itself, so the service ends and is restarted.");
            return exit_failure;
        }
        const bool newer = state.stop_walk.load();  // a reload came while this one failed
        if (state.walk_frames() == 0 && (good || newer)) {
            const std::string why = ending.error.text();
            log.write(Priority::error, event::refused,
                      "The new configuration cannot start a walk, so another one is used. " + why);
            if (newer) continue;
            state.refuse(why);
            current = *std::exchange(good, std::nullopt);
            continue;
        }
        log.write(Priority::error, event::fault, ending.error.text(), {{"SUREFOOT_EXIT_CODE", std::to_string(ending.code)}});
        return ending.code;
    }
}

int check(const Options& options) {
    const Loaded loaded = load(options);
    for (const Error& problem : loaded.problems) (void)std::fputs(("surefootd: " + problem.text() + "\n").c_str(), stderr);
    if (!loaded.problems.empty()) return loaded.misuse ? exit_usage : exit_failure;
    const bool written = std::printf("%s: OK\n", options.config_file.c_str()) >= 0 && std::fflush(stdout) == 0;
    return written ? exit_success : exit_failure;
}

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? std::string() : std::string(value);
}

}  // namespace

int run(const Options& options, const walk::FaultHook& inject) {
    if (options.check) return check(options);
    block_service_signals();
    Log log(default_target());
    // Until the first walk sets its own limit: without the handler SIGXCPU would end the process without a word.
    (void)rt::guard_runaways(rt::runaway_limit_us(1'000'000'000));
    Loaded loaded = load(options);
    for (const Error& problem : loaded.problems) log.write(Priority::error, event::refused, problem.text());
    if (!loaded.problems.empty()) return loaded.misuse ? exit_usage : exit_config;
    walk::prepare_process(request_of(loaded.configuration, options.config_file));  // no other thread is there yet
    Notifier notifier(environment("NOTIFY_SOCKET"));
    ServiceState state;
    state.open(loaded.configuration.values);
    log.write(Priority::info, event::starting,
              fmt::format("{}: The service starts with {} at {}.", options.config_file, loaded.configuration.values.model_file,
                          in_short(loaded.configuration.values)));
    const std::unique_ptr<monitor::Monitor> monitor = open_monitor(loaded.configuration, log);
    const Service service(options, log, state, notifier, watchdog_timeout_ns());
    return walk_on(std::move(loaded.configuration), options, log, state, monitor.get(), inject);
}

int run_main(int argc, char** argv, const walk::FaultHook& inject) {
    keep_standard_files();
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is an error of that file; it must not end the program
    int code = exit_failure;
    const auto options = read_options(argc, argv, code);
    if (!options) return code;
    try {
        return run(*options, inject);
    } catch (const std::bad_alloc&) {
        (void)std::fputs("surefootd: memory: There is not enough memory for this model\n", stderr);
    } catch (const std::exception& error) {
        (void)std::fprintf(stderr, "surefootd: An unexpected error happened: %s\n", error.what());
    }
    return exit_failure;
}

}  // namespace surefoot::daemon
