// Online corrections by state of the picture: predictions are wrong in another way at another resolution, or by another filter.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "rt/frame/controller.hpp"

namespace surefoot::rt {

/// A CostController for each state: a resolution and a filter. After its first frame a state keeps its own figures, so a return
/// finds what was left. Before that it has the last frame's. At another resolution a factor below 1 is a quarter larger then, up
/// to 1. A table that is too dear for one picture may be right for another.
class Corrections {
public:
    static constexpr std::size_t states = 10;

    /// As CostController::update(). States above the last are the last.
    void update(std::size_t state, double predicted_us, double actual_us) {
        state = std::min(state, states - 1);
        if (!known_[state]) start(state);
        in_state_ = known_[state] && state == last_ ? in_state_ + 1 : 0;
        if (in_state_ == 0) restart_drift();
        known_[state] = true;
        last_ = state;
        const double before = of_[state].factor();
        of_[state].update(predicted_us, actual_us);
        if (in_state_ > learnt_after) drift_ *= of_[state].factor() / before;
        left_[state] = drift_;
    }
    /// The factor of a state as it was left, or as it would start.
    [[nodiscard]] double factor(std::size_t state) const {
        state = std::min(state, states - 1);
        return of_[source_of(state)].factor() * caution(state);
    }
    /// The factor of a state, as it may be by now: what has changed since in the state that was drawn is the machine's doing.
    [[nodiscard]] double expected(std::size_t state) const {
        state = std::min(state, states - 1);
        if (!known_[state]) return factor(state);
        return std::clamp(of_[state].factor() * drift_ / left_[state], CostController::lowest, CostController::highest);
    }
    /// What the states from `first` on have learnt is old: they start again as if no frame had been drawn in them. The last
    /// frame's state must not be one of them.
    void forget_from(std::size_t first) { std::fill(known_.begin() + std::min(first, states), known_.end(), false); }
    /// The figures that a state has, or would start with but for its factor.
    [[nodiscard]] const CostController& of(std::size_t state) const { return of_[source_of(std::min(state, states - 1))]; }

private:
    /// Whose figures a state has.
    [[nodiscard]] std::size_t source_of(std::size_t state) const { return known_[state] ? state : last_; }
    /// Factor on these: above 1 for a resolution that was not drawn yet, once the drawn one's own error was learnt.
    [[nodiscard]] double caution(std::size_t state) const {
        constexpr std::size_t resolutions = states / 2;
        constexpr double dearer = 1.25;
        if (known_[state] || state % resolutions == last_ % resolutions || in_state_ <= learnt_after) return 1;
        return std::clamp(1 / of_[last_].factor(), 1.0, dearer);
    }
    void start(std::size_t state) {
        const double more = caution(state);
        of_[state] = of_[source_of(state)];
        of_[state].scale(more);
    }
    /// With each change of the state, so that what adds up over months stays a small number.
    void restart_drift() {
        constexpr double max_drift = 2;  // an older figure says no more
        for (double& left : left_) left = std::clamp(left / drift_, 1 / max_drift, max_drift);
        drift_ = 1;
    }

    std::array<CostController, states> of_{};
    static constexpr std::uint32_t learnt_after = 32;  // frames after which a state's own error is learnt

    std::array<bool, states> known_{};
    std::array<double, states> left_{};  ///< drift_ when it was drawn last
    std::size_t last_ = 0;
    std::uint32_t in_state_ = 0;  ///< frames
    double drift_ = 1;            ///< of the drawn state's factor, once its own error was learnt
};

}  // namespace surefoot::rt
