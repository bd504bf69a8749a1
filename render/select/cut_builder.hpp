// Builds a cut: the choice of every candidate, from the cut that a search starts with to the finished list of items.
#pragma once

#include <limits>
#include <span>

#include "render/select/budget.hpp"
#include "render/select/item_buyer.hpp"
#include "render/select/select.hpp"

namespace surefoot::select {

/// What a candidate begins with when its parent is opened.
struct Start {
    std::uint32_t choice = 0;       ///< or SelectState::opened
    model::ItemCost children_cost;  ///< of the cut that its children begin with
    float value = 0, children_value = 0;
    float worst_rad = 0;
    bool may_open = true;  ///< its children have no more error than the start may have
};

/// chosen[candidate]: offset of its choice, SelectState::opened, or none (below an item). Uses the state's scratch memory.
class CutBuilder {
public:
    CutBuilder(const SelectInput& input, SelectState& state);

    /// Starts from the floor, the cheapest legal cut. Returns its items, ascending, in scratch().
    std::span<std::uint32_t> take_floor();
    /// From the floor to full detail, every leaf at its finest choice. Returns how many steps a search would have taken.
    std::uint32_t take_finest();
    /// Whether full detail costs less than the floor. Possible, since the floor is made bottom-up for each family, and the
    /// maximum of two sums is not additive. Call it after take_floor().
    [[nodiscard]] bool finest_is_cheapest(const Budget& budget) const;
    /// Starts with the root alone at choice `offset`.
    void take_root(std::uint32_t offset);

    /// From now on take_start() is a cut whose items have at most this error, but for those that have nothing better, and
    /// searches keep it. decisions: by candidate, the choice or SelectState::opened of the cut of its subtree. Call it after
    /// take_floor().
    void start_with(std::span<const std::uint32_t> decisions, float max_error_rad);
    /// The cut that searches start with: the floor, or that of start_with(). Returns its items, ascending, in scratch().
    std::span<std::uint32_t> take_start();
    /// Sum over the items of take_start().
    [[nodiscard]] const Sum& start_sum() const { return has_starts() ? start_ : floor_; }
    /// Largest weighted error of take_start(), where start_with() was called.
    [[nodiscard]] float start_worst_rad() const { return has_starts() ? starts_[0].worst_rad : 0.0F; }
    [[nodiscard]] bool has_starts() const { return max_error_rad_ < std::numeric_limits<float>::infinity(); }
    /// Whether full detail breaks the guarantee: where a limit cuts the tree off, a leaf may have more error than a form above.
    [[nodiscard]] bool finest_breaks_guarantee() const;
    /// What the input guarantees; 0: nothing.
    [[nodiscard]] float guaranteed_rad() const { return guaranteed_rad_; }
    [[nodiscard]] rt::Guarantee guarantee() const { return guarantee_; }
    /// The error that finish() judges by, where the input guarantees none.
    void promise(float error_rad) { guaranteed_rad_ = error_rad; }
    /// Told where the guarantee is bought; finish() writes it into the cut.
    void set_guarantee(rt::Guarantee guarantee) { guarantee_ = guarantee; }
    /// No item of a search has more error than this, but for those that have nothing better. Infinity: no limit.
    [[nodiscard]] float max_error_rad() const { return max_error_rad_; }
    /// The choice that a candidate begins with when its parent is opened, or SelectState::opened.
    [[nodiscard]] std::uint32_t first_choice(Index c) const { return has_starts() ? starts_[c].choice : 0; }
    /// What the children cost when the candidate is opened.
    [[nodiscard]] const model::ItemCost& children_cost(Index c) const {
        return has_starts() ? starts_[c].children_cost : candidate(c).children_cost;
    }
    /// Replaces a candidate by its children.
    void open_to_children(Index c);

    /// Sum over the items of take_floor().
    [[nodiscard]] const Sum& floor_sum() const { return floor_; }

    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(chosen_.size()); }
    [[nodiscard]] const prepare::Candidate& candidate(Index c) const { return prepared_.candidates[c]; }
    [[nodiscard]] std::span<const prepare::Choice> choices(Index c) const {
        return {&prepared_.choices[candidate(c).first_choice], candidate(c).choice_count};
    }
    /// Of a choice, times the candidate's importance: what common errors and guarantees are compared with.
    [[nodiscard]] float weighted_error(Index c, const prepare::Choice& choice) const {
        return choice.error_rad * candidate(c).importance;
    }
    [[nodiscard]] std::uint32_t chosen(Index c) const { return chosen_[c]; }
    [[nodiscard]] const prepare::Choice& current(Index c) const { return choices(c)[chosen_[c]]; }
    [[nodiscard]] bool may_open(Index c) const { return candidate(c).child_count > 0 && (!has_starts() || starts_[c].may_open); }
    [[nodiscard]] bool has_step(Index c) const { return chosen_[c] + 1 < candidate(c).choice_count || may_open(c); }
    void choose(Index c, std::uint32_t offset) { chosen_[c] = offset; }
    /// Value of the items so far.
    [[nodiscard]] double value() const;
    /// Value of the children when the candidate is opened.
    [[nodiscard]] float children_value(Index c) const;
    /// By candidate, 0..1: the share of its leaves' value that the item which shows it lacks. Of opened ones nothing is said.
    std::span<float> what_items_lack();
    /// Shows a form in place of the items below it where it has clearly more value and costs no more.
    /// `shown_counts`: what the items count where the last frame showed them.
    void undo_losses(float shown_counts);
    /// Keeps the choices as they are, and takes them again.
    void save();
    void restore();
    void open(Index c) { chosen_[c] = SelectState::opened; }
    [[nodiscard]] std::span<std::uint32_t> scratch() { return scratch_; }
    /// Before the search: buys the items whose rate is above that of the steps where the budget ends. Takes the start for it,
    /// where items are offered.
    void buy_items(Budget& budget);
    /// The same for selectors without a budget: everything.
    void buy_all_items(Budget& budget) { items_.buy_all(budget); }
    /// The items of a set, as BoughtItems::set, and what is prepaid.
    void put_items_in_order() { items_.put_in_order(state_); }
    void buy_items_down_to(float rate, const Sum& spent, Budget& budget) { items_.buy_down_to(rate, spent, budget); }
    void buy_items_of(std::uint64_t set, Budget& budget) { items_.buy_set(set, budget); }

    /// Writes the cut, its sums and hash, and stores it for the next frame's hysteresis. Buys the items that still fit.
    /// refinements: for the report.
    void finish(Budget& budget, std::uint32_t refinements, Cut& cut);

private:
    [[nodiscard]] bool switched(Index c, Index rep) const;
    void list_items(Budget& budget, Cut& cut);
    void remember(const Cut& cut);

    const prepare::PreparedFrame& prepared_;
    SelectState& state_;
    std::span<std::uint32_t> chosen_, saved_, scratch_;
    std::span<float> lacks_;
    std::span<Sum> below_;
    std::span<Start> starts_;
    Sum floor_, start_;
    float max_error_rad_ = std::numeric_limits<float>::infinity(), guaranteed_rad_;
    rt::Guarantee guarantee_ = rt::Guarantee::none;
    ItemBuyer items_;
};

/// As a float that is no larger; 0 where it is not above 0.
float error_no_more_than(double error_rad);

/// Empties a cut and keeps its capacity.
void clear(Cut& cut);

/// Whether the state is large enough for the prepared frame. If not, every selector returns an empty cut.
bool has_room(const SelectInput& input, const SelectState& state, const Cut& cut);

}  // namespace surefoot::select
