// Shared memory of the soak and the processes that load the machine: one page of counters, and the words start and stop.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "tools/soak/plan.hpp"

namespace surefoot::soak {

/// Of one kind of load; written by its processes, read by the soak. What amount and evidence count:
///
///   cpu      ms of CPU time burned         -
///   memory   MiB written                   page faults taken
///   io       KiB written and synced        KiB that went to the device, as the kernel says
///   forks    processes made and ended      processes made on this machine meanwhile, as the kernel says
///   devices  HID reports accepted          HID reports that were due
///   reloads  settings read and checked     -
///   caches   page caches dropped           KiB of them that were free afterwards
///   clock    steps of CLOCK_REALTIME       us by which it was off after the last step was undone, at most
struct LoadCounters {
    std::atomic<std::uint64_t> amount{0}, evidence{0};
    std::atomic<std::int64_t> on_ns{0};      ///< for which it ran; its runner keeps it
    std::atomic<std::int32_t> refused{0};    ///< errno of what the system does not permit; 0: nothing
    std::atomic<std::uint64_t> failures{0};  ///< attempts that failed
};

/// In shared memory; lock-free, so that a process that is killed leaves nothing locked.
struct LoadBoard {
    static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
    std::atomic<std::int64_t> start_ns{0};  ///< monotonic, of the first slot; 0: not yet
    std::atomic<bool> stop{false};
    std::array<LoadCounters, load_kinds> counters;

    LoadCounters& of(LoadKind kind) { return counters[static_cast<std::size_t>(kind)]; }
    [[nodiscard]] const LoadCounters& of(LoadKind kind) const { return counters[static_cast<std::size_t>(kind)]; }
};

/// Sizes of the loads.
struct LoadSettings {
    int cores = 1;                               ///< processes that burn CPU time
    std::uint64_t memory_bytes = 128ULL << 20U;  ///< that one memory process writes over and over
    std::uint64_t file_bytes = 64ULL << 20U;     ///< of the file that io writes
    std::string folder;                          ///< where that file is made, and removed at once
    double clock_step_s = 3600;
    int input_priority = 75;  ///< FIFO priority of the device storm, where it is granted: the input thread's
    double longest_s = 0;     ///< every process ends by itself after this, come what may
};

/// What one process of this kind does, until it is killed or `board.stop`. number: from 0, of its kind.
void run_load(LoadKind kind, int number, LoadBoard& board, const LoadSettings& settings);
/// How many processes a kind has.
int load_processes(LoadKind kind, const LoadSettings& settings);

/// The bodies that have files of their own.
void run_device_storm(LoadBoard& board, const LoadSettings& settings);
void run_clock_steps(LoadBoard& board, const LoadSettings& settings);

}  // namespace surefoot::soak
