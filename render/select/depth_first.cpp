// The corrected depth-first search: from the floor upwards, each step priced as what it changes (total - own + new). It stops at
// the first upgrade that does not fit: skipping on flips levels as the eye moves.

#include <algorithm>

#include "render/select/cut_builder.hpp"
#include "render/select/entries.hpp"
#include "render/select/steps.hpp"

namespace surefoot::select {

namespace {

/// Buys steps until one does not fit.
class Buyer {
public:
    enum class Answer { taken, left, stop };

    Buyer(CutBuilder& builder, const Budget& budget, const Steps& steps, double fresh_share, const Sum& floor)
        : builder_(builder), budget_(budget), steps_(steps), fresh_share_(fresh_share), sum_(floor) {}

    Answer buy(Index c) {
        const prepare::Candidate& candidate = builder_.candidate(c);
        const std::uint32_t k = builder_.chosen(c);
        const auto choices = builder_.choices(c);
        const bool fresh = fresh_share_ < 1.0 && !Steps::was_refined(steps_.shown(candidate.node), choices[k]);
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
            builder_.choose(c, k + 1);
        } else {
            builder_.open(c);
            for (Index child = 0; child < candidate.child_count; ++child) builder_.choose(candidate.first_child + child, 0);
        }
        return Answer::taken;
    }
    [[nodiscard]] std::uint32_t steps_taken() const { return steps_taken_; }

private:
    CutBuilder& builder_;
    const Budget& budget_;
    const Steps& steps_;
    double fresh_share_;
    Sum sum_;
    bool fresh_closed_ = false;
    std::uint32_t steps_taken_ = 0;
};

class DepthFirst final : public Selector {
public:
    // A node is refined all the way down before its sibling: the stack's top is the most beneficial one left.
    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        clear(cut);
        if (!has_room(input, state, cut)) return;
        Budget budget(input);
        CutBuilder builder(input, state);
        const Steps steps(input, state, Key::benefit);
        builder.buy_items(budget);
        const auto floor = builder.take_floor();
        if (full_detail_fits(input, state, budget) || builder.finest_is_cheapest(budget))
            return builder.finish(budget, builder.take_finest(), cut);
        const auto key = [&](Index c) {
            const prepare::Choice& now = builder.current(c);
            return steps.key(now, Steps::was_refined(steps.shown(builder.candidate(c).node), now));
        };
        const auto better_last = [&](Index a, Index b) {
            const float ka = key(a), kb = key(b);
            return ka != kb ? ka < kb : a > b;
        };
        Buyer buyer(builder, budget, steps, fresh_share(state), builder.floor_sum());
        const auto stack = builder.scratch();
        std::size_t top = floor.size();
        std::sort(stack.begin(), stack.begin() + static_cast<std::ptrdiff_t>(top), better_last);
        while (top > 0) {
            const Index c = stack[top - 1];
            if (!builder.has_step(c) || !steps.wanted(builder.current(c))) {
                --top;
                continue;
            }
            const Buyer::Answer answer = buyer.buy(c);
            if (answer == Buyer::Answer::stop) break;
            if (answer == Buyer::Answer::left) --top;
            if (answer == Buyer::Answer::left || builder.chosen(c) != SelectState::opened) continue;
            const prepare::Candidate& candidate = builder.candidate(c);
            --top;
            for (Index k = 0; k < candidate.child_count; ++k) stack[top + k] = candidate.first_child + k;
            const auto first = stack.begin() + static_cast<std::ptrdiff_t>(top);
            top += candidate.child_count;
            std::sort(first, first + candidate.child_count, better_last);
        }
        builder.finish(budget, buyer.steps_taken(), cut);
    }
};

const Selector& make_depth_first() {
    static const DepthFirst selector;
    return selector;
}

}  // namespace

const SelectorEntry depth_first_entry{"depth-first", "one object to full detail before the next, within the budget",
                                      GoesBy::budget, true, make_depth_first};

}  // namespace surefoot::select
