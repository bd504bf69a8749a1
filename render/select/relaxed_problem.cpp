// The Lagrangian of a frame's choices: one pass up the tree for given multipliers, and the search for the best multipliers.
#include "render/select/relaxed_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace surefoot::select {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double finite_or(double x, double instead) { return std::isfinite(x) ? x : instead; }

Gain gain_of(const prepare::Choice& choice, const model::FrameCombine& combine) {
    constexpr double never_us = 1e15;  // a cost that is no number
    const double submit = finite_or(static_cast<double>(choice.cost.submit_us), never_us);
    const double raster = finite_or(static_cast<double>(choice.cost.raster_us), never_us);
    const auto a = static_cast<double>(combine.submit_weight), b = static_cast<double>(combine.raster_weight),
               m = static_cast<double>(combine.max_weight);
    return {finite_or(static_cast<double>(choice.value), 0.0), (a + m) * submit + b * raster, a * submit + (b + m) * raster};
}

}  // namespace

Problem::Problem(const SelectInput& input, const Budget& budget)
    : candidates(static_cast<std::uint32_t>(input.prepared->candidates.size())), room_us(budget.room_us()) {
    const prepare::PreparedFrame& frame = *input.prepared;
    for (const prepare::Candidate& c : frame.candidates) {
        ProblemNode node{static_cast<std::uint32_t>(decisions.size()), c.choice_count + (c.child_count > 0 ? 1U : 0U), c.parent,
                         c.first_child, c.child_count};
        for (std::uint32_t k = 0; k < c.choice_count; ++k)
            decisions.push_back({gain_of(frame.choices[c.first_choice + k], budget.combine()), false});
        if (c.child_count > 0) decisions.push_back({{}, true});
        if (c.child_count == 0) ++leaves;
        nodes.push_back(node);
    }
    if (candidates > 0) roots.push_back(0);
    if (input.items == nullptr) return;
    for (const Item& item : input.items->offered()) {
        if (item.prepaid) fixed_value += static_cast<double>(item.value);
        // A prepaid item is a node too, so that nodes and items have one order. There is nothing to decide.
        const double cost_us = static_cast<double>(item.cost_us) / budget.per_item_us();
        roots.push_back(static_cast<std::uint32_t>(nodes.size()));
        nodes.push_back({static_cast<std::uint32_t>(decisions.size()), item.prepaid ? 1U : 2U, none, 0, 0});
        decisions.push_back({});
        if (!item.prepaid) decisions.push_back({{static_cast<double>(item.value), cost_us, cost_us}, false});
    }
}

Relaxation::Relaxation(const Problem& problem)
    : problem_(problem),
      best_(problem.nodes.size()),
      forbidden_(problem.decisions.size()),
      worth_(problem.nodes.size()),
      below_worth_(problem.nodes.size()),
      sums_(problem.nodes.size()),
      below_(problem.nodes.size()) {}

Gain Relaxation::solve(const Multipliers& multipliers) {
    multipliers_ = multipliers;
    std::fill(below_worth_.begin(), below_worth_.end(), 0.0);
    std::fill(below_.begin(), below_.end(), Gain{});
    for (std::size_t i = problem_.nodes.size(); i-- > 0;) {
        const ProblemNode& node = problem_.nodes[i];
        const auto decisions = problem_.decisions_of(static_cast<std::uint32_t>(i));
        worth_[i] = -infinity;
        for (std::uint32_t d = 0; d < decisions.size(); ++d) {
            if (forbidden_[node.first_decision + d] != 0) continue;
            const double worth = decisions[d].opens ? below_worth_[i] : multipliers.of(decisions[d].gain);
            if (!(worth > worth_[i])) continue;  // of equals the coarser one
            worth_[i] = worth;
            best_[i] = d;
            sums_[i] = decisions[d].opens ? below_[i] : decisions[d].gain;
        }
        if (node.parent == none) continue;
        below_worth_[node.parent] += worth_[i];
        below_[node.parent] += sums_[i];
    }
    Gain sum;
    double worth = 0, size = 0;
    for (const std::uint32_t root : problem_.roots) {
        sum += sums_[root];
        worth += worth_[root];
        size += std::abs(worth_[root]);
    }
    if (!std::isfinite(worth)) {  // nothing is allowed
        bound_ = -infinity;
        return {0, infinity, infinity};
    }
    const double price = multipliers.first + multipliers.second;
    const double given = price > 0.0 ? price * problem_.room_us : 0.0;
    bound_ = worth + given + 1e-9 * (size + std::abs(given));  // what rounding may have taken
    if (problem_.fits(sum) && (feasible_.empty() || sum.value > feasible_value_)) {
        feasible_ = best_;
        feasible_value_ = sum.value;
    }
    return sum;
}

Gain Relaxation::solve_along(double share, double multiplier) {
    const Gain sum = solve({multiplier * share, multiplier * (1.0 - share)});
    if (bound_ < min_bound_) {
        min_bound_ = bound_;
        min_multipliers_ = multipliers_;
    }
    return sum;
}

/// The least bound for multipliers of one ratio: the dual is convex and piecewise linear. Between a multiplier that spends too
/// much and one that spends too little, the next trial is where their two lines meet; where that moves little, it is the middle.
bool Relaxation::minimise_along(double share) {
    const auto cost = [share](const Gain& g) { return share * g.first_us + (1.0 - share) * g.second_us; };
    Gain rich = solve_along(share, 0.0), poor;
    cheap_ = dear_ = best_;
    if (cost(rich) <= problem_.room_us) return true;
    if (!std::isfinite(bound_)) return false;
    double low = 0, high = 1e-9 * (1.0 + std::abs(rich.value)) / std::max(1e-9, std::abs(cost(rich)));
    for (int i = 0;; ++i) {
        poor = solve_along(share, high);
        (cost(poor) <= problem_.room_us ? cheap_ : dear_) = best_;
        if (cost(poor) <= problem_.room_us) break;
        if (i == 60) return false;
        low = high;
        rich = poor;
        high *= 4.0;
    }
    for (int i = 0; i < 60 && high - low > 1e-12 * high; ++i) {
        const double spread = cost(rich) - cost(poor);
        double next = spread > 0.0 ? (rich.value - poor.value) / spread : 0.5 * (low + high);
        if (i % 3 == 2 || !(next > low && next < high)) next = 0.5 * (low + high);
        const double expected = rich.value - next * cost(rich);
        const Gain sum = solve_along(share, next);
        if (sum.value - next * cost(sum) <= expected + 1e-12 * std::abs(expected) && i % 3 != 2)
            return true;  // the lines' corner
        const bool fits = cost(sum) <= problem_.room_us;
        (fits ? high : low) = next;
        (fits ? poor : rich) = sum;
        (fits ? cheap_ : dear_) = best_;
    }
    return true;
}

bool Relaxation::minimise_for(double share) {
    min_bound_ = infinity;
    feasible_.clear();
    const bool any = minimise_along(share);
    bound_ = any ? min_bound_ : -infinity;
    return any;
}

bool Relaxation::find_tie(std::uint32_t& node, std::uint32_t& decision) const {
    std::vector<std::uint32_t> stack = problem_.roots;
    while (!stack.empty()) {
        node = stack.back();
        stack.pop_back();
        decision = dear_[node];
        if (decision != cheap_[node]) return true;
        if (!problem_.decisions_of(node)[decision].opens) continue;
        for (std::uint32_t k = 0; k < problem_.nodes[node].child_count; ++k)
            stack.push_back(problem_.nodes[node].first_child + k);
    }
    return false;
}

bool Relaxation::minimise() {
    min_bound_ = infinity;
    const bool one = minimise_along(1.0), other = minimise_along(0.0);
    double low = 0, high = 1;
    const auto bound_along = [&](double share) {
        const double before = std::exchange(min_bound_, infinity);
        const Multipliers multipliers = min_multipliers_;
        minimise_along(share);
        const double found = min_bound_;
        if (!(found < before)) {
            min_bound_ = before;
            min_multipliers_ = multipliers;
        }
        return found;
    };
    for (int i = 0; one && other && i < 16; ++i) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        if (bound_along(a) < bound_along(b)) {
            high = b;
        } else {
            low = a;
        }
    }
    solve(min_multipliers_);
    return one && other;
}

}  // namespace surefoot::select
