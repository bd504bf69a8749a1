// The SIGXCPU handler, and what it stores for runaway_seen().
#include "rt/threads/runaway.hpp"

#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>

namespace surefoot::rt {

namespace {

// A signal handler reaches nothing else.
std::atomic<pid_t> runaway_tid{0};
std::atomic<bool> runaway_claimed{false}, runaway_reported{false}, runaway_demoted{false};
std::array<char, 16> runaway_name{};

/// On the thread that ran too long, as the kernel delivers it there; system calls only.
void on_runaway(int) {
    const int before = errno;
    const int policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
    const bool real_time = policy == SCHED_FIFO || policy == SCHED_RR;
    const sched_param ordinary{0};
    const bool demoted = real_time && sched_setscheduler(0, SCHED_OTHER | SCHED_RESET_ON_FORK, &ordinary) == 0;
    if (!runaway_claimed.exchange(true)) {
        if (real_time) {
            prctl(PR_GET_NAME, runaway_name.data());
            runaway_tid.store(static_cast<pid_t>(syscall(SYS_gettid)));
        }
        runaway_demoted.store(demoted);
        runaway_reported.store(true, std::memory_order_release);
    }
    errno = before;
}

}  // namespace

std::int64_t runaway_limit_us(std::int64_t period_ns) { return std::clamp<std::int64_t>(period_ns / 500, 500'000, 900'000); }

Result<void> guard_runaways(std::int64_t limit_us) {
    struct sigaction action {};
    action.sa_handler = on_runaway;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGXCPU, &action, nullptr);
    rlimit limit{};
    getrlimit(RLIMIT_RTTIME, &limit);
    limit.rlim_cur = std::min<rlim_t>(static_cast<rlim_t>(limit_us), limit.rlim_max);
    if (setrlimit(RLIMIT_RTTIME, &limit) == 0) return {};
    return Error{"runaway guard",
                 std::string("RLIMIT_RTTIME cannot be set: ") + std::strerror(errno),  // NOLINT(concurrency-mt-unsafe)
                 "Allow this limit: without it, a real-time thread that never sleeps is not stopped", ErrorKind::no_real_time};
}

std::optional<Runaway> runaway_seen() {
    if (!runaway_reported.load(std::memory_order_acquire)) return std::nullopt;
    return Runaway{runaway_tid.load(), runaway_name.data(), runaway_demoted.load()};
}

}  // namespace surefoot::rt
