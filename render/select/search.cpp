// The mended searches: depth-first, best-first and two-stage best-first, from the floor upwards, each step priced as what it
// changes (total - own + new). They stop at the first upgrade that does not fit: skipping on flips levels as the eye moves.
#include "render/select/search.hpp"

#include <algorithm>

#include "render/select/cover.hpp"
#include "render/select/queue.hpp"

namespace surefoot::select {

namespace {

/// What the next step of a candidate is worth and costs.
class Steps {
public:
    Steps(const SelectInput& input, const SelectState& state, const Cover& cover, bool subtree)
        : cover_(cover),
          shown_(state.shown),
          target_(static_cast<float>(input.target_error_rad > 0.0 ? input.target_error_rad : 0.0)),
          hysteresis_(state.hysteresis),
          subtree_(subtree) {}

    /// Whether there is a finer form, and the error asks for it.
    [[nodiscard]] bool wanted(Index c) const {
        return cover_.has_step(c) && (target_ <= 0.0F || cover_.current(c).error_rad > target_);
    }
    [[nodiscard]] float key(Index c) const {
        const prepare::Choice& now = cover_.current(c);
        const float benefit = subtree_ ? now.subtree_benefit : now.benefit;
        return was_refined(c, now) ? benefit * hysteresis_ : benefit;
    }
    /// Both orders are monotone: a node that was refined has ancestors that were, and coarser forms that were.
    [[nodiscard]] bool was_refined(Index c, const prepare::Choice& now) const {
        if (hysteresis_ == 1.0F) return false;
        const Index before = shown_[cover_.candidate(c).node];
        return before != none && before > now.rep;  // forms are stored coarse to fine; `opened` is above all
    }

private:
    const Cover& cover_;
    std::span<const Index> shown_;
    float target_, hysteresis_;
    bool subtree_;
};

/// Takes the next step of `c` if it fits. Returns false when it does not.
bool take_step(Cover& cover, const Budget& budget, Index c, Sum& sum) {
    const prepare::Candidate& candidate = cover.candidate(c);
    const std::uint32_t k = cover.chosen(c);
    const auto choices = cover.choices(c);
    const bool finer = k + 1 < candidate.choice_count;
    const Sum next = sum.changed(choices[k].cost, finer ? choices[k + 1].cost : candidate.children_cost);
    if (!budget.fits(next)) return false;
    sum = next;
    if (finer) {
        cover.choose(c, k + 1);
        return true;
    }
    cover.open(c);
    for (Index child = candidate.first_child; child < candidate.first_child + candidate.child_count; ++child)
        cover.choose(child, 0);
    return true;
}

Sum sum_of(const Cover& cover, std::span<const std::uint32_t> items) {
    Sum sum;
    for (const Index c : items) sum.add(cover.current(c).cost);
    return sum;
}

class BenefitSearch final : public Selector {
public:
    BenefitSearch(std::string_view name, bool subtree) : name_(name), subtree_(subtree) {}
    [[nodiscard]] std::string_view name() const override { return name_; }

    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        clear(cut);
        if (!has_room(input, state, cut)) return;
        const Budget budget(input);
        Cover cover(input, state);
        const Steps steps(input, state, cover, subtree_);
        BucketQueue queue(state.scratch_head, state.scratch_next);
        const auto floor = cover.take_floor();
        Sum sum = sum_of(cover, floor);
        std::uint32_t refinements = 0;
        for (const Index c : floor) {
            if (steps.wanted(c)) queue.push(steps.key(c), c);
        }
        while (!queue.empty()) {
            const Index c = queue.pop();
            if (!take_step(cover, budget, c, sum)) break;
            ++refinements;
            if (cover.chosen(c) != SelectState::opened) {
                if (steps.wanted(c)) queue.push(steps.key(c), c);
                continue;
            }
            const prepare::Candidate& candidate = cover.candidate(c);
            for (Index child = candidate.first_child; child < candidate.first_child + candidate.child_count; ++child) {
                if (steps.wanted(child)) queue.push(steps.key(child), child);
            }
        }
        cover.finish(budget, refinements, cut);
    }

private:
    std::string_view name_;
    bool subtree_;
};

class DepthFirst final : public Selector {
public:
    [[nodiscard]] std::string_view name() const override { return "depth-first"; }

    // A node is refined all the way down before its sibling: the stack's top is the most beneficial one left.
    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        clear(cut);
        if (!has_room(input, state, cut)) return;
        const Budget budget(input);
        Cover cover(input, state);
        const Steps steps(input, state, cover, false);
        const auto better_last = [&](Index a, Index b) {
            const float ka = steps.key(a), kb = steps.key(b);
            return ka != kb ? ka < kb : a > b;
        };
        const auto floor = cover.take_floor();
        Sum sum = sum_of(cover, floor);
        const auto stack = cover.scratch();
        std::size_t top = floor.size();
        std::sort(stack.begin(), stack.begin() + static_cast<std::ptrdiff_t>(top), better_last);
        std::uint32_t refinements = 0;
        while (top > 0) {
            const Index c = stack[top - 1];
            if (!steps.wanted(c)) {
                --top;
                continue;
            }
            if (!take_step(cover, budget, c, sum)) break;
            ++refinements;
            if (cover.chosen(c) != SelectState::opened) continue;
            const prepare::Candidate& candidate = cover.candidate(c);
            --top;
            for (Index k = 0; k < candidate.child_count; ++k) stack[top + k] = candidate.first_child + k;
            const auto first = stack.begin() + static_cast<std::ptrdiff_t>(top);
            top += candidate.child_count;
            std::sort(first, first + candidate.child_count, better_last);
        }
        cover.finish(budget, refinements, cut);
    }
};

}  // namespace

void clear(Cut& cut) {
    cut.items.clear();
    cut.sum = {};
    cut.predicted_us = cut.floor_us = cut.worst_error_rad = 0;
    cut.floor_binds = false;
    cut.benefit = 0;
    cut.triangles = cut.hash = 0;
    cut.switches = cut.refinements = 0;
}

const Selector& depth_first() {
    static const DepthFirst selector;
    return selector;
}
const Selector& best_first() {
    static const BenefitSearch selector("best-first", false);
    return selector;
}
const Selector& two_stage() {
    static const BenefitSearch selector("two-stage", true);
    return selector;
}

}  // namespace surefoot::select
