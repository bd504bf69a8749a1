// Counting blocks and judging them: sums over records, the deadline rule.
#include "rt/frame/control.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/statistics.hpp"

namespace surefoot::rt {

namespace {

constexpr double own_misses_per_frame = 2.0 / 1800.0;
constexpr double significance = 0.01;
constexpr std::uint32_t pairs_wanted = 90;
constexpr double load_share = 0.2;

int missed_slots(const BlockTally& block) { return static_cast<int>(block.misses); }

}  // namespace

ControlSchedule control_schedule(std::int64_t period_ns, double block_s, std::uint32_t pairs) {
    ControlSchedule schedule;
    const double slots = std::round(block_s * 1e9 / static_cast<double>(std::max<std::int64_t>(period_ns, 1)));
    schedule.slots_per_block = slots >= 1 ? static_cast<std::uint64_t>(slots) : 1;
    schedule.pairs = pairs;
    return schedule;
}

void BlockTallies::add(const FrameRecord& r) {
    const bool first = blocks_.empty();
    while (blocks_.size() <= r.block) {
        const auto number = static_cast<std::uint32_t>(blocks_.size());
        blocks_.push_back({.block = number, .walk = ControlSchedule::is_walk(number)});
    }
    // A skipped slot belongs to the late frame before it, whichever block the next frame fell into.
    if (!first) {
        blocks_[last_block_].skipped += r.skipped_before;
        blocks_[last_block_].misses += r.skipped_before;
    }
    BlockTally& block = blocks_[r.block];
    ++block.frames;
    block.misses += r.missed ? 1U : 0U;
    block.own_misses += r.own_miss ? 1U : 0U;
    last_block_ = r.block;
}

DeadlineVerdict judge(std::span<const BlockTally> blocks, double other_miss_share) {
    DeadlineVerdict v;
    for (const BlockTally& block : blocks) {
        (block.walk ? v.walk_frames : v.control_frames) += block.frames;
        (block.walk ? v.walk_misses : v.control_misses) += block.misses;
        if (block.walk) v.own_misses += block.own_misses;
    }
    std::vector<int> differences;
    for (std::size_t i = 0; i + 1 < blocks.size(); i += 2) {
        const BlockTally& a = blocks[i];
        const BlockTally& b = blocks[i + 1];
        if (a.frames == 0 || b.frames == 0 || a.walk == b.walk) continue;
        differences.push_back((a.walk ? 1 : -1) * (missed_slots(a) - missed_slots(b)));
    }
    v.pairs = static_cast<std::uint32_t>(differences.size());
    v.p_value = sign_flip_p_value(differences);
    v.own_holds = static_cast<double>(v.own_misses) <= own_misses_per_frame * static_cast<double>(v.walk_frames);
    v.control_holds = v.p_value >= significance;
    v.enough_pairs = v.pairs >= pairs_wanted;
    v.load_counts = other_miss_share >= load_share;
    v.holds = v.own_holds && v.control_holds && v.enough_pairs && v.load_counts;
    return v;
}

}  // namespace surefoot::rt
