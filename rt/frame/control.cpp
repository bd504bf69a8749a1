// The control: blocks, their tallies, the exact permutation test, the deadline rule.
#include "rt/frame/control.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace surefoot::rt {

ControlSchedule control_schedule(std::int64_t period_ns, double block_s, std::uint32_t pairs) {
    const double slots = std::round(block_s * 1e9 / static_cast<double>(period_ns));
    return {static_cast<std::uint64_t>(std::max(1.0, slots)), pairs};
}

std::vector<BlockTally> tally_blocks(std::span<const FrameRecord> records) {
    std::vector<BlockTally> blocks;
    for (const FrameRecord& r : records) {
        while (blocks.size() <= r.block) {
            BlockTally tally;
            tally.block = static_cast<std::uint32_t>(blocks.size());
            tally.walk = ControlSchedule::is_walk(tally.block);
            blocks.push_back(tally);
        }
        BlockTally& tally = blocks[r.block];
        ++tally.frames;
        tally.misses += r.missed ? 1 : 0;
        tally.own_misses += r.own_miss ? 1 : 0;
        // The slots that a late frame made skip belong to the block of the frame that ran over them.
        if (r.skipped_before > 0) {
            const std::size_t from = &r == records.data() ? r.block : (&r)[-1].block;
            blocks[from].skipped += r.skipped_before;
            blocks[from].misses += r.skipped_before;
        }
    }
    return blocks;
}

double sign_flip_p_value(std::span<const int> differences) {
    int reach = 0, seen = 0;
    std::vector<int> sizes;
    for (const int d : differences) {
        seen += d;
        if (d == 0) continue;  // both signs give the same sum
        sizes.push_back(std::abs(d));
        reach += std::abs(d);
    }
    if (sizes.empty()) return 1;
    // chance[s + reach]: that the flipped sum is s.
    std::vector<double> chance(static_cast<std::size_t>(2 * reach + 1), 0.0), next;
    chance[static_cast<std::size_t>(reach)] = 1;
    for (const int size : sizes) {
        next.assign(chance.size(), 0.0);
        for (std::size_t i = 0; i < chance.size(); ++i) {
            if (chance[i] <= 0) continue;
            next[i + static_cast<std::size_t>(size)] += 0.5 * chance[i];
            next[i - static_cast<std::size_t>(size)] += 0.5 * chance[i];
        }
        chance.swap(next);
    }
    double p = 0;
    for (int s = seen; s <= reach; ++s) p += chance[static_cast<std::size_t>(s + reach)];
    return std::min(1.0, p);
}

DeadlineVerdict judge(std::span<const BlockTally> blocks, double other_miss_share) {
    DeadlineVerdict v;
    std::vector<int> differences;
    for (const BlockTally& b : blocks) {
        (b.walk ? v.walk_frames : v.control_frames) += b.frames;
        (b.walk ? v.walk_misses : v.control_misses) += b.misses;
        if (b.walk) v.own_misses += b.own_misses;
    }
    for (std::size_t p = 0; p + 1 < blocks.size(); p += 2) {
        const BlockTally& walk = blocks[p].walk ? blocks[p] : blocks[p + 1];
        const BlockTally& bare = blocks[p].walk ? blocks[p + 1] : blocks[p];
        differences.push_back(static_cast<int>(walk.misses) - static_cast<int>(bare.misses));
    }
    v.pairs = static_cast<std::uint32_t>(differences.size());
    v.p_value = sign_flip_p_value(differences);
    v.own_holds = v.walk_frames > 0 && v.own_misses * 1800 <= 2 * v.walk_frames;
    v.control_holds = v.p_value >= 0.01;
    v.enough_pairs = v.pairs >= 90;
    v.load_counts = other_miss_share >= 0.2;
    v.holds = v.own_holds && v.control_holds && v.enough_pairs && v.load_counts;
    return v;
}

}  // namespace surefoot::rt
