// The control of a walk: steal time of each block, the proof that the load is real, and the verdict.
#pragma once

#include <cstdint>
#include <vector>

#include "rt/frame/control.hpp"
#include "rt/frame/record.hpp"
#include "tools/walk/placing.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// Of all cores since boot, ms; 0 where the kernel does not say.
double total_steal_ms();

/// Counts of the blocks, and the steal time of each. The monitor thread calls it, and reads steal at the blocks' borders.
class ControlBlocks {
public:
    void on_record(const rt::FrameRecord& record);
    /// By block number; the last one ends now.
    [[nodiscard]] std::vector<rt::BlockTally> finish();

private:
    rt::BlockTallies tallies_;
    std::vector<double> steal_ms_;
    std::uint32_t block_ = 0;
    double at_start_ms_ = -1;
};

/// Fills outcome.summary.control from the blocks, by the permutation test. First runs the bare loop for 10 s under SCHED_OTHER,
/// on the frame core and with the same CPU time. The load counts only if that loop misses a fifth of its frames. burn_ns: the
/// CPU time of a bare frame.
void judge_control(const PlacingPlan& plan, std::int64_t period_ns, std::int64_t burn_ns, ControlBlocks& blocks,
                   WalkOutcome& outcome, const Progress& progress);

}  // namespace surefoot::walk
