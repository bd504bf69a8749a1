// The value of a candidate's next step: search keys with hysteresis, and the two thresholds of the budget.
#pragma once

#include "render/select/cut_builder.hpp"

namespace surefoot::select {

/// What a search goes by.
enum class Key : std::uint8_t { benefit, subtree_benefit, rate };

/// The key of a candidate's next step, and whether the step is wanted.
class Steps {
public:
    Steps(const SelectInput& input, const SelectState& state, Key key)
        : shown_(state.shown),
          target_(static_cast<float>(input.target_error_rad > 0.0 ? input.target_error_rad : 0.0)),
          hysteresis_(state.hysteresis),
          key_(key) {}

    /// Rates as keys. The queue's keys end at 2: rates above 4096 px/us are equal.
    [[nodiscard]] static float rate_key(float rate) { return rate * 0x1p-12F; }
    /// Whether `now` has more error than the target.
    [[nodiscard]] bool wanted(const prepare::Choice& now) const { return target_ <= 0.0F || now.error_rad > target_; }
    [[nodiscard]] bool has_target() const { return target_ > 0.0F; }
    [[nodiscard]] float key(const prepare::Choice& now, bool refined) const {
        const float key = key_ == Key::rate              ? rate_key(now.rate)
                          : key_ == Key::subtree_benefit ? now.subtree_benefit
                                                         : now.benefit;
        return refined ? key * hysteresis_ : key;
    }
    /// The node's state in the last frame, for was_refined().
    [[nodiscard]] Index shown(Index node) const { return hysteresis_ == 1.0F ? none : shown_[node]; }
    /// Whether the last frame showed the node finer than `now`. Representations are stored coarse to fine, and `opened` is the
    /// largest value. Monotone: if a step was taken, so were those of its ancestors and coarser choices.
    [[nodiscard]] static bool was_refined(Index shown, const prepare::Choice& now) { return shown != none && shown > now.rep; }

private:
    std::span<const Index> shown_;
    float target_, hysteresis_;
    Key key_;
};

/// With hysteresis the budget has two thresholds, as a Schmitt trigger has. Steps of the last frame may use all of it, new steps
/// only this share. Smaller changes of cost switch nothing.
inline double fresh_share(const SelectState& state) {
    return state.hysteresis > 1.0F ? 1.0 - static_cast<double>(state.reserve_share) : 1.0;
}

/// If full detail fits, no search is needed.
inline bool full_detail_fits(const SelectInput& input, const SelectState& state, const Budget& budget) {
    Sum full;
    full.add(input.prepared->full_cost);
    return !(input.target_error_rad > 0.0) && budget.fits(full, fresh_share(state));
}

}  // namespace surefoot::select
