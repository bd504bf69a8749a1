// The service thread's loop: twenty looks a second, and one at every signal.
#include "systemd/daemon/service.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>

#include "rt/clock/clock.hpp"
#include "rt/threads/placement.hpp"
#include "rt/threads/runaway.hpp"
#include "systemd/daemon/configuration.hpp"
#include "systemd/daemon/exit_code.hpp"

namespace surefoot::daemon {

namespace {

constexpr int look_ms = 50;
constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::int64_t status_every_ns = 10 * second_ns, extend_every_ns = 5 * second_ns;
constexpr std::int64_t extend_us = 20'000'000;
constexpr std::int64_t stop_limit_ns = 1'600'000'000;  // the promise is two seconds

sigset_t service_signals() {
    sigset_t set;
    sigemptyset(&set);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&set, signal);
    return set;
}

}  // namespace

void block_service_signals() {
    const sigset_t set = service_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

Service::Service(const Options& options, Log& log, ServiceState& state, Notifier& notifier, std::int64_t watchdog_ns)
    : options_(options), log_(log), state_(state), notifier_(notifier), heartbeat_(watchdog_ns, 0) {
    const sigset_t set = service_signals();
    signals_ = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
    thread_ = std::thread([this] { run(); });
}

Service::~Service() {
    ending_.store(true);
    thread_.join();
    if (signals_ >= 0) ::close(signals_);
}

void Service::run() {
    // Only the name: the thread's place is its creator's, who is neutral.
    if (auto own = rt::read_thread(0)) {
        own->name = "sf-service";
        (void)rt::restore_thread(*own);
    }
    const rt::RealClock clock;
    while (!ending_.load()) {
        pollfd readable{signals_, POLLIN, 0};
        if (::poll(&readable, 1, look_ms) > 0) take_signals();
        const std::int64_t now_ns = clock.now_ns();
        guard(now_ns);
        notify_systemd(now_ns);
        feed(now_ns);
    }
}

void Service::take_signals() {
    signalfd_siginfo info{};
    while (::read(signals_, &info, sizeof info) == static_cast<ssize_t>(sizeof info)) {
        if (info.ssi_signo == SIGHUP)
            reload();
        else
            leave(static_cast<int>(info.ssi_signo));
    }
}

/// A good configuration ends the walk, and the main thread begins it anew; a bad one changes nothing.
void Service::reload() {
    if (state_.leaving.load()) return;
    const rt::RealClock clock;
    notifier_.send(fmt::format("RELOADING=1\nMONOTONIC_USEC={}", clock.now_ns() / 1000));
    Loaded loaded = load(options_);
    if (loaded.problems.empty()) {
        log_.write(Priority::notice, event::reloading, "The configuration was read again, and the walk restarts with it.",
                   {{"SUREFOOT_CONFIG", options_.config_file}});
        state_.refuse({});
        state_.put_next(std::move(loaded.configuration));
        ready_ = false;
        state_.stop_walk.store(true);
        return;
    }
    std::string why;
    for (const Error& problem : loaded.problems) why += (why.empty() ? "" : " ") + problem.text();
    log_.write(Priority::error, event::refused, "The configuration is refused, and the last good one stays in use. " + why,
               {{"SUREFOOT_CONFIG", options_.config_file}});
    state_.refuse(why);
    // Still opening: READY=1 comes with the first frame, as ever.
    if (ready_) send_status("READY=1\n");
}

void Service::leave(int signal) {
    if (state_.leaving.exchange(true)) return;
    const rt::RealClock clock;
    leaving_since_ns_ = clock.now_ns();
    state_.stopping();
    state_.stop_walk.store(true);
    send_status("STOPPING=1\n");
    notified_phase_ = Phase::stopping;
    log_.write(Priority::info, event::stopping,
               fmt::format("The service ends, because {} arrived.", signal == SIGTERM ? "SIGTERM" : "SIGINT"));
}

void Service::send_status(const std::string& first) {
    status_ = status_text(state_.facts());
    notifier_.send(first + "STATUS=" + one_line(status_));
    notified_ns_ = rt::RealClock().now_ns();
}

void Service::notify_systemd(std::int64_t now_ns) {
    const Facts facts = state_.facts();
    if (facts.phase != notified_phase_) {
        notified_phase_ = facts.phase;
        if (facts.phase == Phase::opening) {
            ready_ = false;
            opening_since_ns_ = now_ns;
            heartbeat_.opening(now_ns, facts.open_limit_ns);
            send_status(fmt::format("EXTEND_TIMEOUT_USEC={}\n", extend_us));
        } else if (facts.phase == Phase::walking) {
            heartbeat_.frames_begin(std::max(now_ns, facts.first_due_ns), facts.period_ns);
        }
    }
    if (facts.phase == Phase::opening && now_ns - notified_ns_ >= extend_every_ns &&
        now_ns - opening_since_ns_ < facts.open_limit_ns) {
        send_status(fmt::format("EXTEND_TIMEOUT_USEC={}\n", extend_us));
    }
    if (facts.phase != Phase::walking) return;
    if (!ready_ && facts.walk_frames > 0 && !state_.stop_walk.load()) {
        ready_ = true;
        send_status("READY=1\n");
        log_.write(Priority::notice, event::walking, fmt::format("The walk through {} began at {}.", facts.model, facts.in_short),
                   {{"SUREFOOT_MODEL", facts.model}});
    } else if (ready_ && now_ns - notified_ns_ >= status_every_ns) {
        send_status({});
    }
}

void Service::feed(std::int64_t now_ns) {
    if (notified_phase_ == Phase::stopping) return;
    const Beat beat = heartbeat_.look(now_ns, state_.frames());
    if (beat.ping) notifier_.send("WATCHDOG=1");
    if (!beat.stalled && !beat.resumed) return;
    state_.stalled.store(beat.stalled);
    if (beat.stalled) {
        log_.write(Priority::error, event::stalled,
                   fmt::format("No frame was presented for {:.1f} s, so the watchdog is no longer notified.",
                               static_cast<double>(heartbeat_.stall_ns()) * 1e-9));
    } else {
        log_.write(Priority::notice, event::resumed, "Frames are presented again.");
    }
    send_status({});
}

void Service::guard(std::int64_t now_ns) {
    if (const auto runaway = rt::runaway_seen()) {
        const std::string who = runaway->tid != 0 ? fmt::format("The thread {} ({})", runaway->name, runaway->tid) : "A thread";
        log_.write(Priority::error, event::fault,
                   fmt::format("{} ran without sleeping for too long. {} The service ends and is restarted.", who,
                               runaway->demoted ? "Its real-time priority was taken." : "It could not be stopped."),
                   {{"SUREFOOT_FAULT", "runaway"}});
        _exit(exit_runaway);
    }
    if (leaving_since_ns_ == 0 || now_ns - leaving_since_ns_ < stop_limit_ns) return;
    // What must be kept is on the disk already: a stop is written as it happens.
    log_.write(Priority::warning, event::stopping,
               "The walk did not end in time: a model is being opened, or the driver hangs. The service ends without it.");
    _exit(exit_success);
}

}  // namespace surefoot::daemon
