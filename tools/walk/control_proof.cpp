// The control's side of a walk: steal a block, the proof that the load is real, and the verdict.
#include "tools/walk/control_proof.hpp"

#include <thread>

#include "rt/clock/clock.hpp"
#include "rt/clock/grid.hpp"
#include "rt/frame/control.hpp"
#include "rt/threads/usage.hpp"

namespace surefoot::walk {

double total_steal_ms() {
    auto steal = rt::read_steal();
    return steal ? steal->total_ms : 0.0;
}

void ControlBlocks::on_record(const rt::FrameRecord& record) {
    tallies_.add(record);
    if (at_start_ms_ >= 0 && record.block == block_) return;
    const double now_ms = total_steal_ms();
    if (at_start_ms_ >= 0) {
        steal_ms_.resize(block_ + 1, 0.0);
        steal_ms_[block_] = now_ms - at_start_ms_;
    }
    at_start_ms_ = now_ms;
    block_ = record.block;
}

std::vector<rt::BlockTally> ControlBlocks::finish() {
    steal_ms_.resize(block_ + 1, 0.0);
    if (at_start_ms_ >= 0) steal_ms_[block_] = total_steal_ms() - at_start_ms_;
    std::vector<rt::BlockTally> blocks = tallies_.blocks();
    for (rt::BlockTally& block : blocks) block.steal_ms = block.block < steal_ms_.size() ? steal_ms_[block.block] : 0.0;
    return blocks;
}

namespace {

/// Share of slots that a bare loop under SCHED_OTHER misses or skips, burning `burn_ns` a slot on the frame core.
double missed_under_other(const PlacingPlan& plan, std::int64_t period_ns, std::int64_t burn_ns) {
    double share = 0;
    std::thread([&] {
        rt::Placement placement;
        placement.cpus = rt::CpuMask{plan.frame_core};
        placement.name = "sf-frame";
        (void)rt::place_thread(0, placement);
        rt::RealClock clock;
        const rt::Grid grid{clock.now_ns() + period_ns, period_ns};
        const std::uint64_t slots = static_cast<std::uint64_t>(10'000'000'000 / period_ns);
        std::uint64_t bad = 0, slot = 0;
        while (slot < slots) {
            clock.sleep_until_ns(grid.due_ns(slot));
            clock.burn_ns(burn_ns);
            const rt::NextSlot next = rt::next_slot(grid, rt::LatePolicy::lock, slot, clock.now_ns());
            bad += (next.missed ? 1U : 0U) + next.skipped;
            slot = next.slot;
        }
        share = static_cast<double>(bad) / static_cast<double>(slot);
    }).join();
    return share;
}

}  // namespace

void judge_control(const PlacingPlan& plan, std::int64_t period_ns, std::int64_t burn_ns, ControlBlocks& blocks,
                   WalkOutcome& outcome, const Progress& progress) {
    const std::vector<rt::BlockTally> tallied = blocks.finish();
    progress.update("control under SCHED_OTHER", 0.5);
    report::ControlSummary& c = outcome.summary.control;
    c.ran = true;
    c.burn_ms = static_cast<double>(burn_ns) * 1e-6;
    c.other_miss_share = missed_under_other(plan, period_ns, burn_ns);
    c.verdict = rt::judge(tallied, c.other_miss_share);
    for (const rt::BlockTally& block : tallied)
        c.blocks.push_back({block.walk, block.frames, block.misses, block.own_misses, block.steal_ms});
}

}  // namespace surefoot::walk
