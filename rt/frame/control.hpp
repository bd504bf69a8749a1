// The control: a bare loop in alternate blocks (ABBA), and the deadline rule that judges a walk against it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rt/frame/record.hpp"

namespace surefoot::rt {

/// Blocks of equal length in the order walk, bare, bare, walk, walk, bare, ... Blocks 2p and 2p + 1 are pair p.
struct ControlSchedule {
    std::uint64_t slots_per_block = 60;
    std::uint32_t pairs = 90;

    [[nodiscard]] constexpr std::uint32_t blocks() const { return 2 * pairs; }
    [[nodiscard]] constexpr std::uint64_t slots() const { return blocks() * slots_per_block; }
    [[nodiscard]] constexpr std::uint32_t block_of(std::uint64_t slot) const {
        return static_cast<std::uint32_t>(slot / slots_per_block);
    }
    [[nodiscard]] static constexpr bool is_walk(std::uint32_t block) { return block % 4 == 0 || block % 4 == 3; }
};
/// block_s is rounded to whole slots, at least one.
ControlSchedule control_schedule(std::int64_t period_ns, double block_s, std::uint32_t pairs);

/// CPU time that the bare loop burns: the mean of the walk's frames on the frame core so far. The mean, not a replay: a walk
/// frame that overran by its own fault must not make the control late too.
struct BurnMeter {
    std::int64_t sum_ns = 0;
    std::int64_t frames = 0;
    void add(std::int64_t cpu_ns) { sum_ns += cpu_ns, ++frames; }
    [[nodiscard]] std::int64_t mean_ns() const { return frames > 0 ? sum_ns / frames : 0; }
};

/// One block's counts. missed: late frames and the slots they made skip.
struct BlockTally {
    std::uint32_t block = 0;
    bool walk = false;
    std::uint32_t frames = 0, misses = 0, own_misses = 0, skipped = 0;
    double steal_ms = 0;  ///< filled by the reader of /proc/stat
};
/// Counts record by record, for walks that do not keep their records.
class BlockTallies {
public:
    /// In order of time.
    void add(const FrameRecord& record);
    /// By block number, from 0 to the last block seen.
    [[nodiscard]] const std::vector<BlockTally>& blocks() const { return blocks_; }

private:
    std::vector<BlockTally> blocks_;
    std::uint32_t last_block_ = 0;
};

/// The deadline rule.
struct DeadlineVerdict {
    std::uint64_t walk_frames = 0, walk_misses = 0, own_misses = 0, control_frames = 0, control_misses = 0;
    std::uint32_t pairs = 0;
    double p_value = 1;          ///< of walk minus control misses over the pairs
    bool own_holds = false;      ///< own misses <= 2 per 1800 walk frames
    bool control_holds = false;  ///< p_value >= 0.01
    bool enough_pairs = false;   ///< >= 90
    bool load_counts = false;    ///< the control under SCHED_OTHER missed a fifth
    bool holds = false;          ///< all of these
};
/// other_miss_share: misses per slot of the bare loop under SCHED_OTHER and the same load; negative: not measured.
DeadlineVerdict judge(std::span<const BlockTally> blocks, double other_miss_share);

}  // namespace surefoot::rt
