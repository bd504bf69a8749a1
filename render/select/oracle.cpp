// Branch and bound over the decisions of a frame. A partial solution's bound is the root's, less what its decisions lose against
// the best of the Lagrangian.
#include "render/select/oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "render/select/bound_search.hpp"
#include "render/select/cut_builder.hpp"
#include "render/select/relaxed_problem.hpp"

namespace surefoot::select {

namespace {

/// A whole solution: a decision a node (those below a form are of no account), and its sums.
struct Solution {
    std::vector<std::uint32_t> decision;
    Gain sum;
};

/// Calls use(node, decision) for all nodes that a solution reaches.
template <class Use>
void for_reached(const Problem& problem, const std::vector<std::uint32_t>& decision, const Use& use) {
    std::vector<std::uint32_t> stack = problem.roots;
    while (!stack.empty()) {
        const std::uint32_t n = stack.back();
        stack.pop_back();
        use(n, decision[n]);
        const ProblemNode& node = problem.nodes[n];
        if (!problem.decisions_of(n)[decision[n]].opens) continue;
        for (std::uint32_t k = 0; k < node.child_count; ++k) stack.push_back(node.first_child + k);
    }
}

Gain sum_of(const Problem& problem, const std::vector<std::uint32_t>& decision) {
    Gain sum;
    for_reached(problem, decision, [&](std::uint32_t n, std::uint32_t d) { sum += problem.decisions_of(n)[d].gain; });
    return sum;
}

/// A selector's cut as a solution.
Solution solution_of(const Problem& problem, const SelectInput& input, const Cut& cut) {
    Solution s{std::vector<std::uint32_t>(problem.nodes.size(), 0), {}};
    for (std::uint32_t n = 0; n < problem.candidates; ++n)
        if (problem.nodes[n].child_count > 0) s.decision[n] = problem.nodes[n].decision_count - 1;
    for (const CutItem& item : cut.items)
        s.decision[item.candidate] = item.choice - input.prepared->candidates[item.candidate].first_choice;
    for (std::size_t n = problem.candidates; n < problem.nodes.size(); ++n)
        s.decision[n] = problem.nodes[n].decision_count > 1 && cut.bought.has(n - problem.candidates) ? 1 : 0;
    s.sum = sum_of(problem, s.decision);
    return s;
}

class BranchAndBound {
public:
    BranchAndBound(const Problem& problem, Relaxation& relaxation, const Multipliers& multipliers)
        : problem_(problem),
          multipliers_(multipliers),
          worth_(relaxation.worth().begin(), relaxation.worth().end()),
          bound_(relaxation.bound()) {
        find_least_costs();
    }

    /// Takes a solution that fits if it is better than the best so far.
    void offer(const Solution& s) {
        if (problem_.fits(s.sum) && (!best_ || s.sum.value > best_->sum.value)) best_ = s;
    }
    [[nodiscard]] const std::optional<Solution>& best() const { return best_; }
    [[nodiscard]] std::uint64_t steps() const { return steps_; }

    /// Searches on from the best so far. True: to the end, so that the best is the optimum.
    bool search(std::uint64_t max_steps);

private:
    /// A node of which something remains to be decided, and what was decided before it.
    struct Level {
        std::uint32_t node, pending, arena, next = 0;  // next: which of the node's admitted decisions is tried
        Gain sum, min_cost;                            // decided; the least that the pending nodes cost
        double lost;
    };
    struct Pending {
        std::uint32_t node, next;
    };
    struct Admitted {
        std::uint32_t decision;
        double lost;
    };

    [[nodiscard]] double lost_by(std::uint32_t n, const Decision& d) const;
    /// What a better solution may lose at most. Smaller gains than 10^-7 are not looked for: ties would be endless.
    [[nodiscard]] double gap() const {
        return best_ ? bound_ - best_->sum.value - 1e-7 * std::abs(bound_) : std::numeric_limits<double>::infinity();
    }
    void find_least_costs();
    void admit();
    void push(std::uint32_t n, Level& to);
    bool decide(Level& level, Level& below);
    void keep(const std::vector<Level>& levels, const Gain& sum);

    const Problem& problem_;
    Multipliers multipliers_;
    std::vector<double> worth_;
    double bound_;
    std::vector<Gain> min_costs_;  ///< of each subtree, the costs apart
    std::vector<Admitted> admitted_;
    std::vector<std::uint32_t> first_admitted_;
    std::vector<std::uint8_t> settled_;  ///< one way is left in the whole subtree
    std::vector<Gain> settled_sum_;
    std::vector<Pending> arena_;
    std::optional<Solution> best_;
    std::uint64_t steps_ = 0;
};

double BranchAndBound::lost_by(std::uint32_t n, const Decision& d) const {
    if (!d.opens) return std::max(0.0, worth_[n] - multipliers_.of(d.gain));
    double below = 0;
    for (std::uint32_t k = 0; k < problem_.nodes[n].child_count; ++k) below += worth_[problem_.nodes[n].first_child + k];
    return std::max(0.0, worth_[n] - below);
}

void BranchAndBound::find_least_costs() {
    min_costs_.assign(problem_.nodes.size(), {});
    std::vector<Gain> below(problem_.nodes.size());
    for (std::size_t i = problem_.nodes.size(); i-- > 0;) {
        Gain min_cost{0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
        for (const Decision& d : problem_.decisions_of(static_cast<std::uint32_t>(i))) {
            const Gain& g = d.opens ? below[i] : d.gain;
            min_cost.first_us = std::min(min_cost.first_us, g.first_us);
            min_cost.second_us = std::min(min_cost.second_us, g.second_us);
        }
        min_costs_[i] = min_cost;
        if (problem_.nodes[i].parent != none) below[problem_.nodes[i].parent] += min_cost;
    }
}

/// Leaves out what loses more than the gap. Subtrees in which one way is left become constants.
void BranchAndBound::admit() {
    const std::size_t count = problem_.nodes.size();
    admitted_.clear();
    first_admitted_.assign(count + 1, 0);
    settled_.assign(count, 0);
    settled_sum_.assign(count, {});
    for (std::uint32_t n = 0; n < count; ++n) {
        first_admitted_[n] = static_cast<std::uint32_t>(admitted_.size());
        const auto decisions = problem_.decisions_of(n);
        for (std::uint32_t d = 0; d < decisions.size(); ++d)
            if (const double lost = lost_by(n, decisions[d]); lost < gap()) admitted_.push_back({d, lost});
        std::sort(admitted_.begin() + first_admitted_[n], admitted_.end(), [](const Admitted& a, const Admitted& b) {
            return a.lost != b.lost ? a.lost < b.lost : a.decision > b.decision;
        });
    }
    first_admitted_[count] = static_cast<std::uint32_t>(admitted_.size());
    for (std::size_t n = count; n-- > 0;) {
        if (first_admitted_[n + 1] - first_admitted_[n] != 1) continue;
        const Decision& only = problem_.decisions_of(static_cast<std::uint32_t>(n))[admitted_[first_admitted_[n]].decision];
        settled_[n] = 1;
        settled_sum_[n] = only.gain;
        for (std::uint32_t k = 0; only.opens && k < problem_.nodes[n].child_count; ++k) {
            const std::uint32_t child = problem_.nodes[n].first_child + k;
            if (settled_[child] == 0) settled_[n] = 0;
            settled_sum_[n] += settled_sum_[child];
        }
    }
}

/// Adds a node to those that are pending at a level, or what it comes to where only one way is left.
void BranchAndBound::push(std::uint32_t n, Level& to) {
    if (settled_[n] != 0) {
        to.sum += settled_sum_[n];
        return;
    }
    arena_.push_back({n, to.pending});
    to.pending = static_cast<std::uint32_t>(arena_.size() - 1);
    to.min_cost += min_costs_[n];
}

/// Makes the level's next decision that may lead to something better. False: there is none.
bool BranchAndBound::decide(Level& level, Level& below) {
    const std::uint32_t n = level.node;
    while (first_admitted_[n] + level.next < first_admitted_[n + 1]) {
        const Admitted& admitted = admitted_[first_admitted_[n] + level.next++];
        if (!(level.lost + admitted.lost < gap())) return false;  // the next ones lose more
        ++steps_;
        arena_.resize(level.arena);
        const Decision& decision = problem_.decisions_of(n)[admitted.decision];
        below = {none, level.pending, 0, 0, level.sum, level.min_cost, level.lost + admitted.lost};
        below.sum += decision.gain;
        for (std::uint32_t k = 0; decision.opens && k < problem_.nodes[n].child_count; ++k)
            push(problem_.nodes[n].first_child + k, below);
        const Gain min_cost{0, below.sum.first_us + below.min_cost.first_us, below.sum.second_us + below.min_cost.second_us};
        if (problem_.fits(min_cost)) return true;
    }
    return false;
}

void BranchAndBound::keep(const std::vector<Level>& levels, const Gain& sum) {
    if (!problem_.fits(sum) || (best_ && !(sum.value > best_->sum.value))) return;
    Solution s{std::vector<std::uint32_t>(problem_.nodes.size(), 0), sum};
    for (std::size_t n = 0; n < problem_.nodes.size(); ++n)
        if (first_admitted_[n] < first_admitted_[n + 1]) s.decision[n] = admitted_[first_admitted_[n]].decision;
    for (const Level& level : levels) s.decision[level.node] = admitted_[first_admitted_[level.node] + level.next - 1].decision;
    s.sum = sum_of(problem_, s.decision);
    best_ = std::move(s);
}

bool BranchAndBound::search(std::uint64_t max_steps) {
    admit();
    arena_.clear();
    Level now{none, none, 0, 0, {}, {}, 0};
    for (const std::uint32_t root : problem_.roots) push(root, now);
    std::vector<Level> levels;
    bool deeper = true;
    while (true) {
        if (deeper && now.pending == none) {
            keep(levels, now.sum);
            deeper = false;
        }
        if (deeper) {
            const Pending& pending = arena_[now.pending];
            Level level = now;
            level.node = pending.node;
            level.pending = pending.next;
            level.arena = static_cast<std::uint32_t>(arena_.size());
            level.min_cost.first_us -= min_costs_[level.node].first_us;
            level.min_cost.second_us -= min_costs_[level.node].second_us;
            levels.push_back(level);
        }
        if (levels.empty()) return true;
        deeper = decide(levels.back(), now);
        if (!deeper) levels.pop_back();
        if (steps_ >= max_steps) return levels.empty();
    }
}

/// Improves a solution that fits by the step of the greatest value per us that still fits, again and again.
void fill(const Problem& problem, const Relaxation& relaxation, Solution& s) {
    struct Move {
        std::uint32_t node, decision;
        Gain gain;
    };
    const std::vector<std::uint32_t> best(relaxation.best().begin(), relaxation.best().end());
    while (true) {
        std::optional<Move> taken;
        double rate = 0;
        for_reached(problem, s.decision, [&](std::uint32_t n, std::uint32_t now) {
            const auto decisions = problem.decisions_of(n);
            if (decisions[now].opens) return;
            for (std::uint32_t d = 0; d < decisions.size(); ++d) {
                if (decisions[d].opens) continue;
                const Gain& a = decisions[now].gain;
                const Gain& b = decisions[d].gain;
                const Gain change{b.value - a.value, b.first_us - a.first_us, b.second_us - a.second_us};
                Gain sum = s.sum;
                sum += change;
                if (!(change.value > 0.0) || !problem.fits(sum)) continue;
                const double per_us = change.value / std::max(1e-9, std::max(change.first_us, change.second_us));
                if (per_us > rate) {
                    rate = per_us;
                    taken = Move{n, d, change};
                }
            }
        });
        if (!taken) return;
        s.decision[taken->node] = taken->decision;
        s.sum += taken->gain;
    }
}

/// The cuts of all selectors that keep the budget.
void offer_selectors(const Problem& problem, const SelectInput& input, const Relaxation& relaxation, BranchAndBound& search) {
    SelectInput free = input;
    free.target_error_rad = 0;
    SelectState state;
    state.reserve(*input.model, problem.candidates);
    state.hysteresis = 1;
    Cut cut;
    reserve(cut, problem.candidates);
    for (const SelectorEntry& entry : selectors()) {
        if (entry.goes_by != GoesBy::budget) continue;
        entry.make().run(free, state, cut);
        Solution s = solution_of(problem, input, cut);
        if (!problem.fits(s.sum)) continue;
        fill(problem, relaxation, s);
        search.offer(s);
    }
}

/// A bound that is no greater than `bound`. What fits on the way may be the new best.
double reduce_bound(const Problem& problem, Relaxation& relaxation, const OracleLimits& limits, BranchAndBound& search,
                    double bound) {
    const Multipliers m = relaxation.multipliers();
    const double sum = m.first + m.second;
    BoundSearch parts(problem, relaxation, sum > 0.0 ? m.first / sum : 0.5);
    const auto offer = [&](const std::vector<std::uint32_t>& decision) {
        Solution s{decision, sum_of(problem, decision)};
        if (problem.fits(s.sum)) fill(problem, relaxation, s);
        search.offer(s);
        return search.best() ? search.best()->sum.value : -std::numeric_limits<double>::infinity();
    };
    const double best = search.best() ? search.best()->sum.value : -std::numeric_limits<double>::infinity();
    return std::min(bound, parts.search(limits.max_parts, best, offer));
}

/// Gives the solution to the builder.
void build(const Problem& problem, const Solution& s, CutBuilder& builder, Budget& budget) {
    builder.take_root(0);
    std::uint64_t bought = 0;
    for_reached(problem, s.decision, [&](std::uint32_t n, std::uint32_t d) {
        if (n >= problem.candidates) {
            if (d == 1) bought |= std::uint64_t{1} << (n - problem.candidates);
        } else if (problem.decisions_of(n)[d].opens) {
            builder.open(n);
        } else {
            builder.choose(n, d);
        }
    });
    builder.buy_items_of(bought, budget);
}

class Oracle final : public Selector {
public:
    void run(const SelectInput& input, SelectState& state, Cut& cut) const override { find_optimum(input, state, cut); }
};

const Selector& make_oracle() {
    static const Oracle selector;
    return selector;
}

}  // namespace

Optimum find_optimum(const SelectInput& input, SelectState& state, Cut& cut, const OracleLimits& limits) {
    Optimum optimum;
    clear(cut);
    if (!has_room(input, state, cut)) return optimum;
    Budget budget(input);
    CutBuilder builder(input, state);
    const Problem problem(input, budget);
    Relaxation relaxation(problem);
    const bool may_fit = relaxation.minimise();
    double bound = relaxation.bound();
    BranchAndBound search(problem, relaxation, relaxation.multipliers());
    if (may_fit) {
        if (!relaxation.feasible().empty()) {
            Solution s{relaxation.feasible(), sum_of(problem, relaxation.feasible())};
            fill(problem, relaxation, s);
            search.offer(s);
        }
        offer_selectors(problem, input, relaxation, search);
        optimum.proven = search.search(problem.leaves <= limits.exact_leaves ? ~std::uint64_t{0} : limits.max_steps);
        if (!optimum.proven) bound = reduce_bound(problem, relaxation, limits, search, bound);
        optimum.proven = optimum.proven || (search.best() && bound <= search.best()->sum.value * (1.0 + 1e-6));
    }
    optimum.steps = search.steps();
    optimum.floor_binds = !search.best().has_value();
    if (optimum.floor_binds) {  // nothing fits: what is drawn is the floor
        builder.buy_items_of(0, budget);
        builder.take_floor();
        optimum.proven = !may_fit || optimum.proven;
    } else {
        build(problem, *search.best(), builder, budget);
    }
    builder.finish(budget, 0, cut);
    optimum.value = cut.value + cut.bought.value;
    optimum.bound = optimum.floor_binds || optimum.proven ? optimum.value : std::max(bound + problem.fixed_value, optimum.value);
    return optimum;
}

const SelectorEntry oracle_entry{oracle_name, "the greatest value within the budget, off line: it takes seconds", GoesBy::budget,
                                 false, make_oracle};

const Selector* find_offline_selector(std::string_view name) {
    return name == oracle_name ? &oracle_entry.make() : find_selector(name);
}

}  // namespace surefoot::select
