// The thread census: compares the threads of the process with a declared table, and names every difference.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "rt/threads/placement.hpp"

namespace surefoot::rt {

/// A row of the table. A thread belongs to the row with the longest matching name.
struct DeclaredThread {
    std::string name;  ///< prefix of the thread's name, or the whole of it
    bool whole_name = false;
    Policy policy = Policy::other;
    int priority = 0;
    CpuMask cpus;  ///< exactly these; empty: not checked
    int min_count = 1;
    int max_count = 1;
};

/// Pure. Empty: all as declared. Otherwise one line a problem: thread missing, too many, undeclared, or of the wrong policy,
/// priority or cores.
std::vector<std::string> census(std::span<const DeclaredThread> declared, std::span<const ThreadInfo> found);

/// Threads that are alike: of one row of the table (or of none), placed the same way.
struct CensusRow {
    std::string name;  ///< of the row; of the thread, where it has no row
    std::uint32_t count = 0;
    Policy policy = Policy::other;
    int priority = 0;
    CpuMask cpus;
};

/// Pure: all threads found, by row in the order of the table, undeclared ones last.
std::vector<CensusRow> census_rows(std::span<const DeclaredThread> declared, std::span<const ThreadInfo> found);

}  // namespace surefoot::rt
