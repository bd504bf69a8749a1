// What the next step of a candidate is worth, shared by the mended searches: keys with hysteresis, and the budget's two edges.
#pragma once

#include "render/select/cover.hpp"

namespace surefoot::select {

/// What the next step of a candidate is worth, and whether it is asked for.
class Steps {
public:
    Steps(const SelectInput& input, const SelectState& state, bool subtree)
        : shown_(state.shown),
          target_(static_cast<float>(input.target_error_rad > 0.0 ? input.target_error_rad : 0.0)),
          hysteresis_(state.hysteresis),
          subtree_(subtree) {}

    /// Whether the error asks for more than `now`.
    [[nodiscard]] bool wanted(const prepare::Choice& now) const { return target_ <= 0.0F || now.error_rad > target_; }
    [[nodiscard]] bool has_target() const { return target_ > 0.0F; }
    [[nodiscard]] float key(const prepare::Choice& now, bool refined) const {
        const float benefit = subtree_ ? now.subtree_benefit : now.benefit;
        return refined ? benefit * hysteresis_ : benefit;
    }
    /// What the last frame showed of a node, for was_refined.
    [[nodiscard]] Index shown(Index node) const { return hysteresis_ == 1.0F ? none : shown_[node]; }
    /// Forms are stored coarse to fine, and `opened` is above all. Monotone, as the benefits are: a node that was refined has
    /// ancestors that were, and coarser forms that were.
    [[nodiscard]] static bool was_refined(Index shown, const prepare::Choice& now) { return shown != none && shown > now.rep; }

private:
    std::span<const Index> shown_;
    float target_, hysteresis_;
    bool subtree_;
};

/// With memory (hysteresis above 1) the budget has two edges, as a Schmitt trigger: what was shown in the last frame may use
/// all of it, what is new only this share; costs that tremble by less flip nothing.
inline double fresh_share(const SelectState& state) {
    constexpr double fresh_margin = 0.03;
    return state.hysteresis > 1.0F ? 1.0 - fresh_margin : 1.0;
}

/// Where full detail fits there is nothing to search.
inline bool full_detail_fits(const SelectInput& input, const SelectState& state, const Budget& budget) {
    Sum full;
    full.add(input.prepared->full_cost);
    return !(input.target_error_rad > 0.0) && budget.fits(full, fresh_share(state));
}

}  // namespace surefoot::select
