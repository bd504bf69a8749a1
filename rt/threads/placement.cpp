// Placing threads through sched_setattr's simpler cousins, and reading them back from /proc/self/task.
#include "rt/threads/placement.hpp"

#include <dirent.h>
#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace surefoot::rt {

namespace {

Policy policy_of(int number) {
    switch (number & ~SCHED_RESET_ON_FORK) {
        case SCHED_OTHER: return Policy::other;
        case SCHED_BATCH: return Policy::batch;
        case SCHED_IDLE: return Policy::idle;
        case SCHED_FIFO: return Policy::fifo;
        case SCHED_RR: return Policy::round_robin;
        case 6: return Policy::deadline;
        default: return Policy::unknown;
    }
}

int number_of(Policy policy) {
    switch (policy) {
        case Policy::fifo: return SCHED_FIFO;
        case Policy::round_robin: return SCHED_RR;
        case Policy::batch: return SCHED_BATCH;
        case Policy::idle: return SCHED_IDLE;
        default: return SCHED_OTHER;
    }
}

std::uint64_t bits_of(const cpu_set_t& set) {
    std::uint64_t bits = 0;
    for (int core = 0; core < 64; ++core) {
        if (CPU_ISSET(core, &set)) bits |= 1ULL << static_cast<unsigned>(core);
    }
    return bits;
}

}  // namespace

std::string_view policy_name(Policy policy) {
    constexpr std::string_view names[] = {"other", "batch", "idle", "fifo", "rr", "deadline", "unknown"};
    return names[static_cast<int>(policy)];
}

pid_t own_tid() { return gettid(); }

void name_own_thread(const std::string& name) { pthread_setname_np(pthread_self(), name.substr(0, 15).c_str()); }

std::uint64_t process_cores() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(getpid(), sizeof(set), &set) != 0) return 1;
    const std::uint64_t bits = bits_of(set);
    return bits == 0 ? 1 : bits;
}

int core_count() { return std::popcount(process_cores()); }

Result<void> place_thread(pid_t tid, const Placement& placement) {
    const std::string place = fmt::format("thread {}", tid);
    if (placement.cores != 0) {
        cpu_set_t set;
        CPU_ZERO(&set);
        for (unsigned core = 0; core < 64; ++core) {
            if ((placement.cores >> core & 1U) != 0) CPU_SET(core, &set);
        }
        if (sched_setaffinity(tid, sizeof(set), &set) != 0) {
            return Error{place, fmt::format("cannot run on cores {:#x}: {}", placement.cores, std::strerror(errno)),
                         "choose cores that this machine has and this service may use"};
        }
    }
    sched_param parameter{};
    parameter.sched_priority = placement.priority;
    if (sched_setscheduler(tid, number_of(placement.policy), &parameter) != 0) {
        return Error{place, fmt::format("{} {} is refused: {}", policy_name(placement.policy), placement.priority, std::strerror(errno)),
                     "grant CAP_SYS_NICE, or LimitRTPRIO= in the unit, or `ulimit -r`"};
    }
    return {};
}

Result<void> make_neutral(pid_t tid, std::uint64_t cores) { return place_thread(tid, {Policy::other, 0, cores}); }

std::vector<ThreadInfo> list_threads() {
    std::vector<ThreadInfo> threads;
    DIR* dir = opendir("/proc/self/task");
    if (dir == nullptr) return threads;
    while (const dirent* entry = readdir(dir)) {
        if (entry->d_name[0] == '.') continue;
        ThreadInfo info;
        info.tid = std::atoi(entry->d_name);
        std::ifstream comm(fmt::format("/proc/self/task/{}/comm", info.tid));
        std::getline(comm, info.name);
        sched_param parameter{};
        const int policy = sched_getscheduler(info.tid);
        if (policy < 0 || sched_getparam(info.tid, &parameter) != 0) continue;  // it ended meanwhile
        info.placement.policy = policy_of(policy);
        info.placement.priority = parameter.sched_priority;
        cpu_set_t set;
        CPU_ZERO(&set);
        if (sched_getaffinity(info.tid, sizeof(set), &set) == 0) info.placement.cores = bits_of(set);
        threads.push_back(std::move(info));
    }
    closedir(dir);
    std::sort(threads.begin(), threads.end(), [](const ThreadInfo& a, const ThreadInfo& b) { return a.tid < b.tid; });
    return threads;
}

}  // namespace surefoot::rt
