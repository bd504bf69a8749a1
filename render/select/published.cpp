// The three searches with the accounting as published: opening a node adds the cost of its children to the total, and the
// node's own stays in it. What does not fit is drawn as it is, and the search goes on with the rest of its list.
#include <algorithm>

#include "render/model/view.hpp"
#include "render/select/benefit_model.hpp"
#include "render/select/bucket_queue.hpp"
#include "render/select/cut_builder.hpp"
#include "render/select/entries.hpp"
#include "render/select/scratch.hpp"

namespace surefoot::select {

namespace {

/// "Compute its LOD" (figure 3.15) before the search: an object's form is fixed by its distance alone; a cluster has one form.
std::uint32_t fixed_form(const CutBuilder& builder, Index c, float threshold_rad) {
    if (builder.candidate(c).child_count > 0) return 0;
    const auto choices = builder.choices(c);
    std::uint32_t k = 0;
    while (k + 1 < choices.size() && choices[k].error_rad > threshold_rad) ++k;
    return k;
}

enum class Priority { depth, own, subtree };

/// Candidates, the greatest benefit first, the lowest number first among equals. For benefits that may rise down the tree.
class CandidateHeap {
public:
    CandidateHeap(std::span<std::uint32_t> memory, std::span<const float> benefits) : memory_(memory), later_{benefits} {}
    void push(float, Index c) {
        memory_[size_++] = c;
        std::push_heap(memory_.begin(), end(), later_);
    }
    Index pop() {
        std::pop_heap(memory_.begin(), end(), later_);
        return memory_[--size_];
    }
    [[nodiscard]] bool empty() const { return size_ == 0; }

private:
    struct Later {
        std::span<const float> benefits;
        bool operator()(Index a, Index b) const { return benefits[a] != benefits[b] ? benefits[a] < benefits[b] : a > b; }
    };
    [[nodiscard]] std::span<std::uint32_t>::iterator end() const { return memory_.begin() + static_cast<std::ptrdiff_t>(size_); }

    std::span<std::uint32_t> memory_;
    Later later_;
    std::size_t size_ = 0;
};

class Published final : public Selector {
public:
    explicit Published(Priority priority) : priority_(priority) {}

    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        clear(cut);
        if (!has_room(input, state, cut)) return;
        Budget budget(input);
        CutBuilder builder(input, state);
        builder.buy_items(budget);
        const double half_pixel = 0.5 * prepare::resolved_rad(*input.prepared);
        const auto threshold = static_cast<float>(input.target_error_rad > 0.0 ? input.target_error_rad : half_pixel);
        builder.take_root(fixed_form(builder, 0, threshold));
        Sum total;
        total.add(builder.current(0).cost);
        std::uint32_t refinements = 0;
        if (!budget.fits(total)) {
            builder.take_floor();  // not in the source: a root beyond the budget leaves it nothing to say
            if (builder.finest_is_cheapest(budget)) refinements = builder.take_finest();
        } else if (priority_ == Priority::depth) {
            refinements = depth_first(builder, budget, threshold, total);
        } else {
            refinements = best_first(input, builder, state, budget, threshold, total);
        }
        builder.finish(budget, refinements, cut);
    }

private:
    /// Total with the forms of the children added (the parent's stays).
    static Sum with_children(const CutBuilder& builder, Index c, float threshold, Sum total) {
        const prepare::Candidate& candidate = builder.candidate(c);
        for (Index child = candidate.first_child; child < candidate.first_child + candidate.child_count; ++child) {
            total.add(builder.choices(child)[fixed_form(builder, child, threshold)].cost);
        }
        return total;
    }
    static void open(CutBuilder& builder, Index c, float threshold) {
        const prepare::Candidate& candidate = builder.candidate(c);
        builder.open(c);
        for (Index child = candidate.first_child; child < candidate.first_child + candidate.child_count; ++child) {
            builder.choose(child, fixed_form(builder, child, threshold));
        }
    }
    // Figure 3.14. The children in their stored order, as printed.
    static std::uint32_t depth_first(CutBuilder& builder, const Budget& budget, float threshold, Sum total) {
        const auto stack = builder.scratch();
        std::size_t top = 0;
        std::uint32_t refinements = 0;
        stack[top++] = 0;
        while (top > 0) {
            const Index c = stack[--top];
            const prepare::Candidate& candidate = builder.candidate(c);
            if (candidate.child_count == 0) continue;
            const Sum next = with_children(builder, c, threshold, total);
            if (!budget.fits(next)) continue;
            total = next;
            open(builder, c, threshold);
            ++refinements;
            for (Index k = candidate.child_count; k-- > 0;) stack[top++] = candidate.first_child + k;
        }
        return refinements;
    }
    // Figures 3.15 and 3.19: the same loop, by the cluster's own benefit or by the greatest below it.
    std::uint32_t best_first(const SelectInput& input, CutBuilder& builder, SelectState& state, const Budget& budget,
                             float threshold, Sum total) const {
        const bool of_subtree = priority_ == Priority::subtree;
        if (input.benefit == BenefitModel::surefoot) {
            BucketQueue queue(state.scratch().queue_heads, state.scratch().links);
            return best_first_by(builder, budget, threshold, total, queue, [&](Index c) {
                const prepare::Choice& now = builder.current(c);
                return of_subtree ? now.subtree_benefit : now.benefit;
            });
        }
        const std::span<float> benefits = std::span(state.scratch().lacks).first(builder.size());
        find_benefits(input, of_subtree, benefits);
        CandidateHeap heap(std::span(state.scratch().links).first(builder.size()), benefits);
        return best_first_by(builder, budget, threshold, total, heap, [&](Index c) { return benefits[c]; });
    }
    template <class Queue, class Benefit>
    static std::uint32_t best_first_by(CutBuilder& builder, const Budget& budget, float threshold, Sum total, Queue& queue,
                                       const Benefit& benefit) {
        const auto push = [&](Index c) {
            if (builder.candidate(c).child_count > 0) queue.push(benefit(c), c);
        };
        std::uint32_t refinements = 0;
        push(0);
        while (!queue.empty() && budget.fits(total)) {
            const Index c = queue.pop();
            const prepare::Candidate& candidate = builder.candidate(c);
            const Sum next = with_children(builder, c, threshold, total);
            if (!budget.fits(next)) continue;
            total = next;
            open(builder, c, threshold);
            ++refinements;
            for (Index k = 0; k < candidate.child_count; ++k) push(candidate.first_child + k);
        }
        return refinements;
    }

    Priority priority_;
};

template <Priority priority>
const Selector& make_published() {
    static const Published selector(priority);
    return selector;
}

}  // namespace

// As printed in Maciel 1994, figures 3.14, 3.15 and 3.19.
const SelectorEntry depth_first_1994_entry{"depth-first-1994", "depth-first with the published accounting (Maciel 1994)",
                                           GoesBy::budget, false, make_published<Priority::depth>};
const SelectorEntry best_first_1994_entry{"best-first-1994", "best-first with the published accounting", GoesBy::budget, false,
                                          make_published<Priority::own>};
const SelectorEntry two_stage_1994_entry{"two-stage-1994", "two-stage with the published accounting", GoesBy::budget, false,
                                         make_published<Priority::subtree>};

}  // namespace surefoot::select
