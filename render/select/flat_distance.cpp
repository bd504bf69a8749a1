// The selectors without a budget that walk from the root: `flat` and `distance`.
#include "render/model/view.hpp"
#include "render/select/common_error.hpp"
#include "render/select/cut_builder.hpp"
#include "render/select/entries.hpp"

namespace surefoot::select {

namespace {

/// Walks from the root; opens what `stops` does not stop, and draws the rest in the form that it says.
template <class Stops>
void walk(const SelectInput& input, SelectState& state, Cut& cut, const Stops& stops) {
    clear(cut);
    if (!has_room(input, state, cut)) return;
    Budget budget(input);
    CutBuilder builder(input, state);
    builder.buy_all_items(budget);
    builder.take_root(0);
    std::uint32_t refinements = 0;
    for (Index c = 0; c < builder.size(); ++c) {  // breadth-first order: a child comes after its parent opened it
        if (builder.chosen(c) == none) continue;
        const std::uint32_t form = stops(builder, c);
        if (form != none) {
            builder.choose(c, form);
            continue;
        }
        const prepare::Candidate& candidate = builder.candidate(c);
        builder.open(c);
        ++refinements;
        for (Index k = 0; k < candidate.child_count; ++k) builder.choose(candidate.first_child + k, 0);
    }
    builder.finish(budget, refinements, cut);
}

class Flat final : public Selector {
public:
    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        walk(input, state, cut, [](const CutBuilder& builder, Index c) {
            const prepare::Candidate& candidate = builder.candidate(c);
            return candidate.child_count > 0 ? none : candidate.choice_count - 1;
        });
    }
};

class ByDistance final : public Selector {
public:
    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        const double pixel = prepare::resolved_rad(*input.prepared);
        const auto threshold =
            static_cast<float>(input.target_error_rad > 0.0 ? input.target_error_rad : default_threshold_px * pixel);
        walk(input, state, cut, [threshold](const CutBuilder& builder, Index c) {
            const auto choices = builder.choices(c);
            for (std::uint32_t k = 0; k < choices.size(); ++k) {
                if (choices[k].error_rad <= threshold) return k;
            }
            return builder.candidate(c).child_count > 0 ? none : static_cast<Index>(choices.size() - 1);
        });
    }
};

const Selector& make_flat() {
    static const Flat selector;
    return selector;
}
const Selector& make_by_distance() {
    static const ByDistance selector;
    return selector;
}

}  // namespace

const SelectorEntry flat_entry{full_detail_selector, "everything in full detail, whatever the cost", GoesBy::nothing, false,
                               make_flat};
const SelectorEntry by_distance_entry{"distance", "level of detail by distance, at a fixed angle; no budget", GoesBy::threshold,
                                      true, make_by_distance};

}  // namespace surefoot::select
