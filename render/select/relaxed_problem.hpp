// A frame's choices and items as one problem, and its Lagrangian: the upper bound of the oracle. In this room only.
//
//   greatest sum of values, so that   L1 = (a + m) * S + b * R <= room   and   L2 = a * S + (b + m) * R <= room
//
// S, R: sums of submit and raster time; a, b, m: the weights of FrameCombine. The larger of L1 and L2 is the predicted time,
// since a*S + b*R + m*max(S, R) is. So the two linear limits together are the budget itself, and not an estimate of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "render/select/budget.hpp"
#include "render/select/select.hpp"

namespace surefoot::select {

/// Value and the two costs, of a decision or of a sum of them.
struct Gain {
    double value = 0, first_us = 0, second_us = 0;
    Gain& operator+=(const Gain& more) {
        value += more.value;
        first_us += more.first_us;
        second_us += more.second_us;
        return *this;
    }
};

/// Multipliers of the two limits, value per us, >= 0.
struct Multipliers {
    double first = 0, second = 0;
    [[nodiscard]] double of(const Gain& g) const { return g.value - first * g.first_us - second * g.second_us; }
};

/// What may be decided of a node: one of its choices, or to open it.
struct Decision {
    Gain gain;  ///< of an opening: nothing
    bool opens = false;
};

/// A candidate or an item of the list. Items have two decisions: not bought, bought.
struct ProblemNode {
    std::uint32_t first_decision = 0, decision_count = 0;
    std::uint32_t parent = none, first_child = 0, child_count = 0;
};

/// The problem. Parents stand before their children. Nodes without a parent are roots: candidate 0 and the items.
struct Problem {
    Problem(const SelectInput& input, const Budget& budget);

    std::vector<ProblemNode> nodes;
    std::vector<Decision> decisions;
    std::vector<std::uint32_t> roots;
    std::uint32_t candidates = 0, leaves = 0;
    double room_us = 0;
    double fixed_value = 0;  ///< of prepaid items
    [[nodiscard]] bool fits(const Gain& sum) const { return sum.first_us <= room_us && sum.second_us <= room_us; }
    [[nodiscard]] std::span<const Decision> decisions_of(std::uint32_t node) const {
        return {&decisions[nodes[node].first_decision], nodes[node].decision_count};
    }
};

/// The best decision of each node for given multipliers, with all that is best below it.
class Relaxation {
public:
    explicit Relaxation(const Problem& problem);

    /// Restricts the problem to a part of it. Decisions are counted as in Problem::decisions.
    void allow_all() { std::fill(forbidden_.begin(), forbidden_.end(), std::uint8_t{0}); }
    void forbid(std::uint32_t decision) { forbidden_[decision] = 1; }

    /// Returns the sums over the best solution, which may exceed the limits.
    Gain solve(const Multipliers& multipliers);
    /// Upper bound of the problem by the last solve(): rounding included.
    [[nodiscard]] double bound() const { return bound_; }
    /// Finds the multipliers of the least bound, and solves for them. False: no solution fits, or none was found.
    bool minimise();
    [[nodiscard]] const Multipliers& multipliers() const { return multipliers_; }
    /// The least bound for one ratio of the multipliers, 0..1. False: no solution fits. bound() is of that ratio's best
    /// multiplier.
    bool minimise_for(double share);
    /// A node at which minimise_for() found two best solutions, one too dear and one that fits: the dear one's decision.
    /// Such a node is reached in both. False: there is none.
    bool find_tie(std::uint32_t& node, std::uint32_t& decision) const;
    /// Of the last solve(), for each node: its best decision, and the Lagrangian of its subtree.
    [[nodiscard]] std::span<const std::uint32_t> best() const { return best_; }
    [[nodiscard]] std::span<const double> worth() const { return worth_; }
    /// The best that fits among the solutions so far, a decision a node; empty: none.
    [[nodiscard]] const std::vector<std::uint32_t>& feasible() const { return feasible_; }

private:
    bool minimise_along(double share);
    Gain solve_along(double share, double multiplier);

    const Problem& problem_;
    Multipliers multipliers_, min_multipliers_;
    double bound_ = 0, min_bound_ = 0, feasible_value_ = 0;
    std::vector<std::uint32_t> best_, feasible_, dear_, cheap_;
    std::vector<std::uint8_t> forbidden_;
    std::vector<double> worth_, below_worth_;
    std::vector<Gain> sums_, below_;
};

}  // namespace surefoot::select
