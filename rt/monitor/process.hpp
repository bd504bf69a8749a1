// Resource usage of this process: memory, descriptors, threads, CPU time. Read from /proc, by a thread that may wait.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rt/threads/placement.hpp"

namespace surefoot::rt {

/// A number that cannot be read is -1.
struct ProcessFigures {
    std::int64_t rss_bytes = -1, virtual_bytes = -1, locked_bytes = -1;
    std::int64_t descriptors = -1, max_descriptors = -1;
    std::int64_t threads = -1;
    double cpu_s = -1;      ///< user and system, all threads, ended ones included
    double started_s = -1;  ///< since boot
    double steal_s = -1;    ///< of all cores since boot
};
/// root: where /proc lies, for tests.
ProcessFigures read_process(const std::string& root = "");

/// A thread, with the CPU time that it has taken so far.
struct BusyThread {
    ThreadInfo info;
    std::int64_t cpu_ns = 0;
};
/// Threads of this process, by ascending tid.
std::vector<BusyThread> read_busy_threads();

}  // namespace surefoot::rt
