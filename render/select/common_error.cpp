// One pass up the tree for each error that is tried, and the selectors that go by it: `curve-budget` and `curve-accuracy`.
#include "render/select/common_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/model/view.hpp"
#include "render/select/entries.hpp"
#include "render/select/scratch.hpp"
#include "render/select/steps.hpp"

namespace surefoot::select {

namespace {

constexpr float no_limit = std::numeric_limits<float>::infinity();
constexpr float precision = 1 + 1.0F / 64, first_step = 1.06F;  // factors between errors
constexpr float tiny_error = 1e-9F, huge_error = 1e3F;
constexpr int max_passes = 20;  // then what fits is drawn

}  // namespace

CommonErrorCuts::CommonErrorCuts(const SelectInput& input, SelectState& state, CutBuilder& builder, const Budget& budget)
    : builder_(builder),
      budget_(budget),
      two_pixels_rad_(static_cast<float>(default_threshold_px * prepare::resolved_rad(*input.prepared))),
      shown_(state.shown),
      share_(fresh_share(state)),
      new_factor_(state.hysteresis > 1.0F ? 1.0F / shown_error_factor : 1.0F),
      weights_{static_cast<double>(budget.combine().submit_weight), static_cast<double>(budget.combine().raster_weight),
               static_cast<double>(budget.combine().max_weight)},
      below_(std::span(state.scratch().below).first(input.prepared->candidates.size())),
      worst_(std::span(state.scratch().lacks).first(input.prepared->candidates.size())),
      decisions_(std::span(state.scratch().links).first(input.prepared->candidates.size())) {}

CommonErrorCuts::Found CommonErrorCuts::find(float error_rad, float new_factor) {
    const float of_new = error_rad * new_factor;
    for (auto c = static_cast<Index>(decisions_.size()); c-- > 0;) {  // children come after their parents
        const prepare::Candidate& candidate = builder_.candidate(c);
        const auto choices = builder_.choices(c);
        std::uint32_t k = 0;
        while (k < choices.size() && !(builder_.weighted_error(c, choices[k]) <= of_new)) ++k;
        if (new_factor < 1.0F && shown_[candidate.node] != none)  // a coarser one may stay
            for (std::uint32_t i = 0; i < k && choices[i].rep <= shown_[candidate.node]; ++i)
                if (choices[i].rep == shown_[candidate.node] && builder_.weighted_error(c, choices[i]) <= error_rad) k = i;
        const bool suffices = k < choices.size();
        decisions_[c] = suffices ? k : static_cast<std::uint32_t>(choices.size()) - 1;
        const prepare::Choice& own = choices[decisions_[c]];
        Sum& best = below_[c] = {};
        best.add(own.cost);
        worst_[c] = builder_.weighted_error(c, own);
        if (candidate.child_count == 0) continue;
        Sum of_children;
        float worst = 0;
        for (Index child = candidate.first_child; child < candidate.first_child + candidate.child_count; ++child) {
            of_children = of_children + below_[child];
            worst = std::max(worst, worst_[child]);
        }
        const bool children_suffice = worst <= error_rad;
        const bool opens = suffices == children_suffice && (suffices || worst == worst_[c])
                               ? weights_.of(of_children) < weights_.of(best)
                               : (suffices ? false : children_suffice || worst < worst_[c]);
        if (!opens) continue;
        decisions_[c] = SelectState::opened;
        best = of_children;
        worst_[c] = worst;
    }
    return {below_[0], worst_[0]};
}

void CommonErrorCuts::take() {
    for (Index c = 0; c < decisions_.size(); ++c) {
        const Index parent = builder_.candidate(c).parent;
        builder_.choose(c, parent != none && builder_.chosen(parent) != SelectState::opened ? none : decisions_[c]);
    }
}

/// The worst error that the forms of the last frame have now, but for leaves that have nothing better; else two pixels.
float CommonErrorCuts::likely_error() const {
    float worst = 0;
    for (Index c = 0; c < builder_.size() && new_factor_ < 1.0F; ++c) {
        const Index shown = shown_[builder_.candidate(c).node];
        if (shown == none || shown == SelectState::opened) continue;
        auto better = builder_.choices(c);
        if (builder_.candidate(c).child_count == 0) better = better.first(better.size() - 1);
        for (const prepare::Choice& choice : better)
            if (choice.rep == shown) worst = std::max(worst, builder_.weighted_error(c, choice));
    }
    return worst > 0 && worst < no_limit ? worst : two_pixels_rad_;
}

/// From a likely error outwards in growing steps until one fits and a smaller one does not; then halving on logarithms. With
/// hysteresis the first may use all of the budget, and stays unless one that is smaller by a step fits the share of new forms.
bool CommonErrorCuts::find_within_budget(float min_error_rad) {
    const bool keeps = new_factor_ < 1.0F;
    int passes = 0;
    const auto fits = [&](float error_rad, double share) {
        ++passes;
        const Found found = find(error_rad);
        if (!budget_.fits(found.sum, share)) return false;
        take();
        taken_error_ = error_rad;
        taken_worst_ = found.worst_error_rad;
        return true;
    };
    const float start = std::max(likely_error(), min_error_rad);
    float fine = 0, coarse = start, step = keeps ? shown_error_factor : first_step;
    if (fits(start, 1.0)) {
        do {
            if (coarse <= min_error_rad) return true;
            fine = coarse / step > tiny_error ? std::max(coarse / step, min_error_rad) : min_error_rad;
            step *= step;
        } while (fits(fine, share_) && (coarse = fine, true));
        if (keeps && coarse == start) return true;
    } else {
        do {
            if (coarse == no_limit) return fits(no_limit, 1.0);
            fine = coarse;
            coarse = coarse * step < huge_error ? coarse * step : no_limit;
            step *= step;
        } while (!fits(coarse, share_));
        coarse = std::min(coarse, worst_[0]);
    }
    fine = std::max(fine, tiny_error);
    while (passes < max_passes && coarse > fine * precision) {
        const float middle = std::sqrt(fine * coarse);
        if (fits(middle, share_))
            coarse = std::min(middle, std::max(worst_[0], fine));
        else
            fine = middle;
    }
    return true;
}

bool CommonErrorCuts::start_with_taken() {
    const float limit = taken_limit_rad();
    if (!(limit < no_limit)) return false;
    (void)find(taken_error_);  // the decisions that were taken once more
    builder_.start_with(decisions_, limit);
    builder_.take_start();
    return true;
}

float CommonErrorCuts::coarsest_error() const {
    float worst = 0;
    for (Index c = 0; c < builder_.size(); ++c) worst = std::max(worst, builder_.weighted_error(c, builder_.choices(c).front()));
    return worst;
}

/// Costs are weighed node by node, so another weighing may find a cheaper cut where a frame takes the larger of two sums. That is
/// tried where the first one is near the budget.
rt::Guarantee CommonErrorCuts::guarantee(float max_error_rad) {
    constexpr double near = 1.3;
    if (coarsest_error() <= max_error_rad) return rt::Guarantee::kept;  // whatever is drawn
    Found found = find(max_error_rad);
    bool fits = budget_.fits(found.sum);
    const auto try_again = [&](Weights weights) {
        if (fits) return;
        weights_ = weights;
        found = find(max_error_rad, 1.0F);
        fits = budget_.fits(found.sum);
    };
    if (new_factor_ < 1.0F) try_again(weights_);
    const model::FrameCombine& combine = budget_.combine();
    if (combine.max_weight > 0.0F && budget_.fits(found.sum, near)) {
        const Weights usual = weights_;
        try_again({usual.submit + usual.larger, usual.raster, 0});
        try_again({usual.submit, usual.raster + usual.larger, 0});
        weights_ = usual;
    }
    if (fits) {
        builder_.start_with(decisions_, max_error_rad);
    } else if (budget_.fits(builder_.floor_sum()) && find_within_budget(max_error_rad)) {
        builder_.start_with(decisions_, find(taken_error_).worst_error_rad);  // the decisions that were taken once more
    }
    if (found.worst_error_rad > max_error_rad) return rt::Guarantee::no_form;
    return fits ? rt::Guarantee::kept : rt::Guarantee::over_budget;
}

void guarantee_error(const SelectInput& input, SelectState& state, CutBuilder& builder, const Budget& budget) {
    const float max_error_rad = builder.guaranteed_rad();
    if (!(max_error_rad > 0.0F)) return;
    builder.set_guarantee(CommonErrorCuts(input, state, builder, budget).guarantee(max_error_rad));
    builder.take_start();
}

namespace {

class CurveBudget final : public Selector {
public:
    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        clear(cut);
        if (!has_room(input, state, cut)) return;
        Budget budget(input);
        CutBuilder builder(input, state);
        builder.take_floor();
        guarantee_error(input, state, builder, budget);
        builder.buy_items(budget);
        const bool finest = full_detail_fits(input, state, budget) || builder.finest_is_cheapest(budget);
        if (finest && !builder.finest_breaks_guarantee()) return builder.finish(budget, builder.take_finest(), cut);
        if (find_start(input, state, builder, budget)) {
            const std::uint32_t refinements = fill_by_rate(input, state, builder, budget);
            return builder.finish(budget, refinements, cut);
        }
        builder.finish(budget, 0, cut);
    }

private:
    /// Gives the builder the cut of the smallest error. True: it is a start, and the rest of the budget goes by value. Where an
    /// accuracy is asked for, nothing more is.
    static bool find_start(const SelectInput& input, SelectState& state, CutBuilder& builder, const Budget& budget) {
        const auto target = static_cast<float>(input.target_error_rad > 0.0 ? input.target_error_rad : 0.0);
        const bool spends_rest = !(target > 0.0F);
        if (builder.guarantee() == rt::Guarantee::over_budget && builder.has_starts()) {  // that was looked for already
            builder.take_start();
            return spends_rest;
        }
        if (!budget.fits(builder.floor_sum())) return false;  // the floor is drawn
        CommonErrorCuts cuts(input, state, builder, budget);
        if (!cuts.find_within_budget(target)) return false;
        if (cuts.taken_limit_rad() > builder.max_error_rad()) {  // what was shown has more error than is guaranteed
            builder.take_start();
            return spends_rest;
        }
        return spends_rest && cuts.start_with_taken();
    }
};

class CurveAccuracy final : public Selector {
public:
    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        clear(cut);
        if (!has_room(input, state, cut)) return;
        Budget budget(input);
        CutBuilder builder(input, state);
        builder.buy_all_items(budget);
        builder.take_floor();
        CommonErrorCuts cuts(input, state, builder, budget);
        const float target = error_no_more_than(input.target_error_rad);
        const CommonErrorCuts::Found found = cuts.find(target > 0.0F ? target : cuts.two_pixels_rad());
        if (target > 0.0F) {
            builder.promise(target);
            builder.set_guarantee(found.worst_error_rad <= target ? rt::Guarantee::kept : rt::Guarantee::no_form);
        }
        cuts.take();
        builder.finish(budget, 0, cut);
    }
};

const Selector& make_curve_budget() {
    static const CurveBudget selector;
    return selector;
}
const Selector& make_curve_accuracy() {
    static const CurveAccuracy selector;
    return selector;
}

}  // namespace

const SelectorEntry curve_budget_entry{.name = "curve-budget",
                                       .help = "the greatest accuracy that all objects can share, within the budget",
                                       .make = make_curve_budget,
                                       .guarantees = true};
const SelectorEntry curve_accuracy_entry{.name = "curve-accuracy",
                                         .help = "the cheapest cut within one error for all objects; no budget",
                                         .goes_by = GoesBy::threshold,
                                         .compared = false,
                                         .make = make_curve_accuracy,
                                         .keeps_target = true};

}  // namespace surefoot::select
