// The verdict of a soak, point by point: pure functions of its figures.
#pragma once

#include "tools/soak/plan.hpp"
#include "tools/soak/summary.hpp"

namespace surefoot::soak {

/// How long a process settles before its growth counts: a fifth of the soak, at most five minutes.
double warm_up_of(double seconds);

/// Judges the counters of a kind of load: whether it was real, and the proof in words. other_miss_share: of the bare loop
/// under SCHED_OTHER beside the CPU load; negative: not measured.
struct LoadFigures {
    LoadKind kind = LoadKind::cpu;
    double seconds = 0, amount = 0, evidence = 0;
    int refused = 0;  ///< errno
    std::uint64_t failures = 0;
    int cores = 1;
};
SoakLoad describe_load(const LoadFigures& figures, double other_miss_share);

/// Fills in warm_up_s, memory and checks. Needs all the rest.
///
///   deadlines    own misses at most 2 per 1800 frames. With a control: over at least 90 pairs, walk minus control is not above
///                zero. The load counts only if the bare loop under SCHED_OTHER misses a fifth of its frames
///   load         every load that was requested and permitted was real
///   grid         run + skipped = elapsed, every due time on the grid, no record lost
///   memory       slope at most 64 KiB an hour after the warm-up; judged from ten minutes on
///   descriptors  the lowest count of the last quarter is that of the first, after the warm-up; threads likewise
///   real time    FIFO, locked memory, the frame's own code without faults and allocations; not on a virtual clock
void judge_soak(SoakSummary& summary);

}  // namespace surefoot::soak
