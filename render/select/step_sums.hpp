// Costs of all steps by bucket of their key: whoever adds them up sees where a budget ends, without a queue. In this room only.
#pragma once

#include <algorithm>
#include <span>

#include "render/select/bucket_queue.hpp"
#include "render/select/cut_builder.hpp"
#include "render/select/steps.hpp"

namespace surefoot::select {

constexpr std::uint32_t key_buckets = BucketQueue::buckets;

inline bool nothing(const Sum& sum) { return sum.submit_us == 0.0 && sum.raster_us == 0.0; }

/// Cost changes of all steps by bucket of their key: those that are new, and those that were shown in the last frame.
class StepSums {
public:
    explicit StepSums(std::span<double> room) : room_(room.first(std::size_t{4} * key_buckets)) { clear(); }
    void clear() { std::fill(room_.begin(), room_.end(), 0.0); }
    void add(std::uint32_t bucket, bool refined, const model::ItemCost& away, const model::ItemCost& in) {
        double* at = &room_[std::size_t{4} * bucket + (refined ? 2U : 0U)];
        at[0] += static_cast<double>(in.submit_us) - static_cast<double>(away.submit_us);
        at[1] += static_cast<double>(in.raster_us) - static_cast<double>(away.raster_us);
    }
    [[nodiscard]] Sum fresh(std::uint32_t bucket) const { return {room_[4 * bucket], room_[4 * bucket + 1]}; }
    [[nodiscard]] Sum refined(std::uint32_t bucket) const { return {room_[4 * bucket + 2], room_[4 * bucket + 3]}; }

private:
    std::span<double> room_;
};

/// A step's place in the order, and whether the last frame had taken it.
struct StepPlace {
    std::uint32_t bucket;
    bool refined;
};
inline StepPlace place_of(const Steps& steps, const prepare::Choice& now, Index shown) {
    const bool refined = Steps::was_refined(shown, now);
    return {BucketQueue::bucket_of(steps.key(now, refined)), refined};
}

/// Calls use(offset of the choice, whether the step opens the children) for every step of a candidate, in order, until it
/// returns false. True: all steps were used, the opening one included.
template <class Use>
bool for_steps(const CutBuilder& builder, const Steps& steps, Index c, const Use& use) {
    const prepare::Candidate& candidate = builder.candidate(c);
    const auto choices = builder.choices(c);
    for (std::uint32_t k = 0; k < candidate.choice_count; ++k) {
        const bool last = k + 1 == candidate.choice_count;
        if ((last && !builder.may_open(c)) || !steps.wanted(choices[k]) || !use(k, last)) return false;
    }
    return true;
}

/// What the walk over all steps noted of a candidate.
constexpr std::uint32_t last_bucket = key_buckets - 1;  ///< mask: the bucket of its last step
constexpr std::uint32_t opens_below = 1U << 16U;        ///< its children may be opened: no limit of errors forbids it
constexpr std::uint32_t refined_before = 1U << 17U;     ///< its first step was taken in the last frame

/// Adds up all steps behind what the builder holds: the start, or forms that a search starts from. notes: one a candidate.
inline void sum_steps(const CutBuilder& builder, const Steps& steps, StepSums& sums, std::span<std::uint32_t> notes) {
    for (Index c = 0; c < builder.size(); ++c) {
        if (builder.chosen(c) == SelectState::opened) continue;  // above the start
        const prepare::Candidate& candidate = builder.candidate(c);
        const auto choices = builder.choices(c);
        const Index shown = steps.shown(candidate.node);
        const std::uint32_t flags = Steps::was_refined(shown, choices[0]) ? refined_before : 0;
        if ((steps.has_target() || builder.has_starts()) && builder.chosen(c) == none &&
            (notes[candidate.parent] & opens_below) == 0) {
            notes[c] = flags;
            continue;
        }
        std::uint32_t last = 0;
        const std::uint32_t from = builder.chosen(c) == none ? builder.first_choice(c) : builder.chosen(c);
        if (from == SelectState::opened) {  // it has no step of its own: it opens with its parent
            notes[c] = flags | opens_below;
            continue;
        }
        const bool passed = for_steps(builder, steps, c, [&](std::uint32_t k, bool opens) {
            if (k < from) return true;
            const StepPlace step = place_of(steps, choices[k], shown);
            last = step.bucket;
            sums.add(step.bucket, step.refined, choices[k].cost, opens ? builder.children_cost(c) : choices[k + 1].cost);
            return true;
        });
        notes[c] = flags | last | (passed ? opens_below : 0);
    }
}

}  // namespace surefoot::select
