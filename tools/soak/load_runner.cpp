// One process that looks at the timetable fifty times a second and makes and ends the others by it.
#include "tools/soak/load_runner.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <new>
#include <utility>
#include <vector>

#include "rt/clock/clock.hpp"
#include "rt/threads/placement.hpp"

namespace surefoot::soak {

namespace {

volatile std::sig_atomic_t end_requested = 0;

void doze_20ms() {
    const timespec time{0, 20'000'000};
    nanosleep(&time, nullptr);
}

/// The child ends with its parent: the kernel sends `signal` when that dies, and if it has died already, there is nobody to
/// load the machine for. No child prints, reads, or is worth keeping when memory runs out.
void belong_to(pid_t parent, int signal) {
    prctl(PR_SET_PDEATHSIG, signal);
    if (getppid() != parent) _exit(0);
    prctl(PR_SET_NAME, "sf-load");
    if (const int fd = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); fd >= 0) {
        (void)!write(fd, "1000", 4);
        close(fd);
    }
}

/// Ctrl-C goes to the whole terminal: the soak hears it, and ends its children in good order.
void set_signals(void (*on_end)(int)) {
    std::signal(SIGINT, SIG_IGN);
    std::signal(SIGHUP, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    struct sigaction end {};
    end.sa_handler = on_end;
    sigaction(SIGTERM, &end, nullptr);
}

struct Worker {
    LoadKind kind = LoadKind::cpu;
    int number = 0;
    pid_t pid = -1;
};

/// Clock steps must undo what they did; the others have nothing to put in order.
int ending_signal(LoadKind kind) { return kind == LoadKind::clock ? SIGTERM : SIGKILL; }

pid_t start_worker(LoadKind kind, int number, LoadBoard& board, const LoadSettings& settings) {
    const pid_t parent = getpid();
    const pid_t child = fork();
    if (child != 0) return child;
    belong_to(parent, ending_signal(kind));
    set_signals(SIG_DFL);
    alarm(static_cast<unsigned>(std::ceil(settings.longest_s)));
    run_load(kind, number, board, settings);
    _exit(0);
}

class Workers {
public:
    Workers(LoadBoard& board, const LoadSettings& settings) : board_(board), settings_(settings) {}

    /// Starts what is wanted and does not run, ends what runs and is not wanted. What ended by itself (the system refused it) is
    /// not started again in the same phase.
    void match(LoadSet wanted) {
        reap();
        for (std::size_t i = 0; i < load_kinds; ++i) {
            const auto kind = static_cast<LoadKind>(i);
            const bool on = has_load(wanted, kind), was = has_load(running_, kind);
            if (on && !was) start(kind);
            if (!on && was) end(kind);
        }
        running_ = wanted;
    }

private:
    void start(LoadKind kind) {
        started_ns_[static_cast<std::size_t>(kind)] = rt::monotonic_ns();
        for (int n = 0; n < load_processes(kind, settings_); ++n) {
            const pid_t pid = start_worker(kind, n, board_, settings_);
            if (pid > 0) workers_.push_back({kind, n, pid});
            if (pid < 0) ++board_.of(kind).failures;
        }
    }
    void end(LoadKind kind) {
        for (const Worker& w : workers_)
            if (w.kind == kind) kill(w.pid, ending_signal(kind));
        for (const Worker& w : workers_)
            if (w.kind == kind) waitpid(w.pid, nullptr, 0);
        std::erase_if(workers_, [kind](const Worker& w) { return w.kind == kind; });
        board_.of(kind).on_ns += rt::monotonic_ns() - started_ns_[static_cast<std::size_t>(kind)];
    }
    void reap() {
        for (pid_t pid = waitpid(-1, nullptr, WNOHANG); pid > 0; pid = waitpid(-1, nullptr, WNOHANG))
            std::erase_if(workers_, [pid](const Worker& w) { return w.pid == pid; });
    }

    LoadBoard& board_;
    const LoadSettings& settings_;
    std::vector<Worker> workers_;
    LoadSet running_ = 0;
    std::array<std::int64_t, load_kinds> started_ns_{};
};

/// Ordinary scheduling, every core: what forked it may have been placed.
void be_ordinary() {
    rt::CpuMask all;
    for (int cpu = 0; cpu < sysconf(_SC_NPROCESSORS_CONF); ++cpu) all.add(cpu);
    (void)rt::place_thread(0, {.policy = rt::Policy::other, .priority = 0, .cpus = all, .name = "sf-load"});
}

void keep_timetable(const LoadPlan& plan, const LoadSettings& settings, LoadBoard& board, pid_t soak) {
    Workers workers(board, settings);
    const std::int64_t last_ns = rt::monotonic_ns() + static_cast<std::int64_t>(settings.longest_s * 1e9);
    while (end_requested == 0 && !board.stop.load() && getppid() == soak && rt::monotonic_ns() < last_ns) {
        const std::int64_t start_ns = board.start_ns.load();
        const double time_s = static_cast<double>(rt::monotonic_ns() - start_ns) * 1e-9;
        if (start_ns != 0) workers.match(time_s < plan.seconds ? plan.at(time_s) : proof_loads(plan.mix));
        doze_20ms();
    }
    workers.match(0);
    // What a worker had just forked when it was killed is ours since, and ends at once: nothing of the load outlives a soak.
    while (waitpid(-1, nullptr, 0) > 0 || errno == EINTR) {
    }
}

}  // namespace

LoadSet proof_loads(LoadSet mix) { return has_load(mix, LoadKind::cpu) ? load_bit(LoadKind::cpu) : mix; }

Result<LoadRunner> LoadRunner::start(const LoadPlan& plan, const LoadSettings& settings) {
    void* const memory = mmap(nullptr, sizeof(LoadBoard), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED)
        return Error{"soak", std::string("There is no shared memory for the load: ") + std::strerror(errno),
                     "Close other programs", ErrorKind::no_memory};
    auto* const board = new (memory) LoadBoard;
    const pid_t soak = getpid();
    const pid_t child = fork();
    if (child < 0) {
        munmap(memory, sizeof(LoadBoard));
        return Error{"soak", std::string("A process for the load cannot be started: ") + std::strerror(errno),
                     "Check the limit of processes (ulimit -u)", ErrorKind::out_of_limits};
    }
    if (child == 0) {
        belong_to(soak, SIGTERM);
        prctl(PR_SET_CHILD_SUBREAPER, 1);
        set_signals([](int) { end_requested = 1; });
        be_ordinary();
        keep_timetable(plan, settings, *board, soak);
        _exit(0);
    }
    return LoadRunner(board, child);
}

LoadRunner::LoadRunner(LoadRunner&& other) noexcept
    : board_(std::exchange(other.board_, nullptr)), pid_(std::exchange(other.pid_, -1)) {}

void LoadRunner::stop() {
    if (board_ != nullptr) board_->stop.store(true);
    if (pid_ > 0) {
        kill(pid_, SIGTERM);
        waitpid(pid_, nullptr, 0);
    }
    pid_ = -1;
}

LoadRunner::~LoadRunner() {
    stop();
    if (board_ != nullptr) munmap(board_, sizeof(LoadBoard));
}

}  // namespace surefoot::soak
