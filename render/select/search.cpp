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

/// Buys steps until one does not fit. With memory (hysteresis above 1) the budget has two edges, as a Schmitt trigger: what was
/// shown in the last frame may use all of it, what is new only 1 - fresh_margin; costs that tremble by less flip nothing.
class Buyer {
public:
    enum class Answer { taken, left, stop };

    Buyer(Cover& cover, const Budget& budget, const Steps& steps, double fresh_share, const Sum& floor)
        : cover_(cover), budget_(budget), steps_(steps), fresh_share_(fresh_share), sum_(floor) {}

    Answer buy(Index c) {
        const prepare::Candidate& candidate = cover_.candidate(c);
        const std::uint32_t k = cover_.chosen(c);
        const auto choices = cover_.choices(c);
        const bool fresh = fresh_share_ < 1.0 && !steps_.was_refined(c, choices[k]);
        if (fresh && fresh_closed_) return Answer::left;
        const bool finer = k + 1 < candidate.choice_count;
        const Sum next = sum_.changed(choices[k].cost, finer ? choices[k + 1].cost : candidate.children_cost);
        if (!budget_.fits(next, fresh ? fresh_share_ : 1.0)) {
            if (!fresh) return Answer::stop;
            fresh_closed_ = true;  // from here on only what was shown before
            return Answer::left;
        }
        sum_ = next;
        ++steps_taken_;
        if (finer) {
            cover_.choose(c, k + 1);
        } else {
            cover_.open(c);
            for (Index child = 0; child < candidate.child_count; ++child) cover_.choose(candidate.first_child + child, 0);
        }
        return Answer::taken;
    }
    [[nodiscard]] std::uint32_t steps_taken() const { return steps_taken_; }

private:
    Cover& cover_;
    const Budget& budget_;
    const Steps& steps_;
    double fresh_share_;
    Sum sum_;
    bool fresh_closed_ = false;
    std::uint32_t steps_taken_ = 0;
};

double fresh_share(const SelectState& state) {
    constexpr double fresh_margin = 0.03;
    return state.hysteresis > 1.0F ? 1.0 - fresh_margin : 1.0;
}

Sum sum_of(const Cover& cover, std::span<const std::uint32_t> items) {
    Sum sum;
    for (const Index c : items) sum.add(cover.current(c).cost);
    return sum;
}

/// Where full detail fits there is nothing to search: the same cut, without the queue.
bool full_detail_fits(const SelectInput& input, const SelectState& state, const Budget& budget) {
    Sum full;
    full.add(input.prepared->full_cost);
    return !(input.target_error_rad > 0.0) && budget.fits(full, fresh_share(state));
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
        const auto floor = cover.take_floor();
        if (full_detail_fits(input, state, budget)) return cover.finish(budget, cover.take_finest(), cut);
        BucketQueue queue(state.scratch_head, state.scratch_next);
        Buyer buyer(cover, budget, steps, fresh_share(state), sum_of(cover, floor));
        for (const Index c : floor) {
            if (steps.wanted(c)) queue.push(steps.key(c), c);
        }
        while (!queue.empty()) {
            const Index c = queue.pop();
            const Buyer::Answer answer = buyer.buy(c);
            if (answer == Buyer::Answer::stop) break;
            if (answer == Buyer::Answer::left) continue;
            if (cover.chosen(c) != SelectState::opened) {
                if (steps.wanted(c)) queue.push(steps.key(c), c);
                continue;
            }
            const prepare::Candidate& candidate = cover.candidate(c);
            for (Index child = candidate.first_child; child < candidate.first_child + candidate.child_count; ++child) {
                if (steps.wanted(child)) queue.push(steps.key(child), child);
            }
        }
        cover.finish(budget, buyer.steps_taken(), cut);
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
        const auto floor = cover.take_floor();
        if (full_detail_fits(input, state, budget)) return cover.finish(budget, cover.take_finest(), cut);
        const auto better_last = [&](Index a, Index b) {
            const float ka = steps.key(a), kb = steps.key(b);
            return ka != kb ? ka < kb : a > b;
        };
        Buyer buyer(cover, budget, steps, fresh_share(state), sum_of(cover, floor));
        const auto stack = cover.scratch();
        std::size_t top = floor.size();
        std::sort(stack.begin(), stack.begin() + static_cast<std::ptrdiff_t>(top), better_last);
        while (top > 0) {
            const Index c = stack[top - 1];
            if (!steps.wanted(c)) {
                --top;
                continue;
            }
            const Buyer::Answer answer = buyer.buy(c);
            if (answer == Buyer::Answer::stop) break;
            if (answer == Buyer::Answer::left) --top;
            if (answer == Buyer::Answer::left || cover.chosen(c) != SelectState::opened) continue;
            const prepare::Candidate& candidate = cover.candidate(c);
            --top;
            for (Index k = 0; k < candidate.child_count; ++k) stack[top + k] = candidate.first_child + k;
            const auto first = stack.begin() + static_cast<std::ptrdiff_t>(top);
            top += candidate.child_count;
            std::sort(first, first + candidate.child_count, better_last);
        }
        cover.finish(budget, buyer.steps_taken(), cut);
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
