// The three searches with the accounting as published: opening a node adds the cost of its children to the total, and the
// node's own stays in it. What does not fit is drawn as it is, and the search goes on with the rest of its list.
#include <algorithm>

#include "render/model/view.hpp"
#include "render/select/cover.hpp"
#include "render/select/entries.hpp"
#include "render/select/queue.hpp"
#include "render/select/scratch.hpp"

namespace surefoot::select {

namespace {

/// "Compute its LOD" (figure 3.15) before the search: an object's form is fixed by its distance alone; a cluster has one form.
std::uint32_t fixed_form(const Cover& cover, Index c, float threshold_rad) {
    if (cover.candidate(c).child_count > 0) return 0;
    const auto choices = cover.choices(c);
    std::uint32_t k = 0;
    while (k + 1 < choices.size() && choices[k].error_rad > threshold_rad) ++k;
    return k;
}

enum class Order { depth, own, subtree };

class Published final : public Selector {
public:
    explicit Published(Order order) : order_(order) {}

    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        clear(cut);
        if (!has_room(input, state, cut)) return;
        const Budget budget(input);
        Cover cover(input, state);
        const double half_pixel = 0.5 * model::pixel_angle(input.prepared->region.centre, input.prepared->viewport);
        const auto threshold = static_cast<float>(input.target_error_rad > 0.0 ? input.target_error_rad : half_pixel);
        cover.take_root(fixed_form(cover, 0, threshold));
        Sum total;
        total.add(cover.current(0).cost);
        std::uint32_t refinements = 0;
        if (!budget.fits(total)) {
            cover.take_floor();  // not in the source: a root beyond the budget leaves it nothing to say
            if (cover.finest_is_cheapest(budget)) refinements = cover.take_finest();
        } else if (order_ == Order::depth) {
            refinements = depth_first(cover, budget, threshold, total);
        } else {
            refinements = best_first(cover, state, budget, threshold, total);
        }
        cover.finish(budget, refinements, cut);
    }

private:
    /// Total with the forms of the children added (the parent's stays).
    static Sum with_children(const Cover& cover, Index c, float threshold, Sum total) {
        const prepare::Candidate& candidate = cover.candidate(c);
        for (Index child = candidate.first_child; child < candidate.first_child + candidate.child_count; ++child) {
            total.add(cover.choices(child)[fixed_form(cover, child, threshold)].cost);
        }
        return total;
    }
    static void open(Cover& cover, Index c, float threshold) {
        const prepare::Candidate& candidate = cover.candidate(c);
        cover.open(c);
        for (Index child = candidate.first_child; child < candidate.first_child + candidate.child_count; ++child) {
            cover.choose(child, fixed_form(cover, child, threshold));
        }
    }
    // Figure 3.14. The children in their stored order, as printed.
    static std::uint32_t depth_first(Cover& cover, const Budget& budget, float threshold, Sum total) {
        const auto stack = cover.scratch();
        std::size_t top = 0;
        std::uint32_t refinements = 0;
        stack[top++] = 0;
        while (top > 0) {
            const Index c = stack[--top];
            const prepare::Candidate& candidate = cover.candidate(c);
            if (candidate.child_count == 0) continue;
            const Sum next = with_children(cover, c, threshold, total);
            if (!budget.fits(next)) continue;
            total = next;
            open(cover, c, threshold);
            ++refinements;
            for (Index k = candidate.child_count; k-- > 0;) stack[top++] = candidate.first_child + k;
        }
        return refinements;
    }
    // Figures 3.15 and 3.19: the same loop, by the cluster's own benefit or by the greatest below it.
    std::uint32_t best_first(Cover& cover, SelectState& state, const Budget& budget, float threshold, Sum total) const {
        BucketQueue queue(state.scratch().queue_heads, state.scratch().links);
        const auto push = [&](Index c) {
            const prepare::Choice& now = cover.current(c);
            if (cover.candidate(c).child_count > 0) queue.push(order_ == Order::subtree ? now.subtree_benefit : now.benefit, c);
        };
        std::uint32_t refinements = 0;
        push(0);
        while (!queue.empty() && budget.fits(total)) {
            const Index c = queue.pop();
            const prepare::Candidate& candidate = cover.candidate(c);
            const Sum next = with_children(cover, c, threshold, total);
            if (!budget.fits(next)) continue;
            total = next;
            open(cover, c, threshold);
            ++refinements;
            for (Index k = 0; k < candidate.child_count; ++k) push(candidate.first_child + k);
        }
        return refinements;
    }

    Order order_;
};

template <Order order>
const Selector& make_published() {
    static const Published selector(order);
    return selector;
}

}  // namespace

// As printed in Maciel 1994, figures 3.14, 3.15 and 3.19.
const SelectorEntry depth_first_1994_entry{"depth-first-1994", "depth-first with the published accounting (Maciel 1994)",
                                           GoesBy::budget, false, make_published<Order::depth>};
const SelectorEntry best_first_1994_entry{"best-first-1994", "best-first with the published accounting", GoesBy::budget, false,
                                          make_published<Order::own>};
const SelectorEntry two_stage_1994_entry{"two-stage-1994", "two-stage with the published accounting", GoesBy::budget, false,
                                         make_published<Order::subtree>};

}  // namespace surefoot::select
