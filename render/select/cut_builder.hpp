// Builds a cut: the choice of every candidate, from the cheapest cut to the finished list of items.
#pragma once

#include <span>

#include "render/select/budget.hpp"
#include "render/select/item_buyer.hpp"
#include "render/select/select.hpp"

namespace surefoot::select {

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

    /// Sum over the items of take_floor().
    [[nodiscard]] const Sum& floor_sum() const { return floor_; }

    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(chosen_.size()); }
    [[nodiscard]] const prepare::Candidate& candidate(Index c) const { return prepared_.candidates[c]; }
    [[nodiscard]] std::span<const prepare::Choice> choices(Index c) const {
        return {&prepared_.choices[candidate(c).first_choice], candidate(c).choice_count};
    }
    [[nodiscard]] std::uint32_t chosen(Index c) const { return chosen_[c]; }
    [[nodiscard]] const prepare::Choice& current(Index c) const { return choices(c)[chosen_[c]]; }
    [[nodiscard]] bool has_step(Index c) const {
        return chosen_[c] + 1 < candidate(c).choice_count || candidate(c).child_count > 0;
    }
    void choose(Index c, std::uint32_t offset) { chosen_[c] = offset; }
    /// Value of the items so far.
    [[nodiscard]] double value() const;
    /// Value of the children's first choices.
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
    /// Before the search: buys the items whose rate is above that of the steps where the budget ends. Takes the floor for it,
    /// where items are offered.
    void buy_items(Budget& budget);
    /// The same for selectors without a budget: everything.
    void buy_all_items(Budget& budget) { items_.buy_all(budget); }
    /// The items of a set, as BoughtItems::set, and what is prepaid.
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
    Sum floor_;
    ItemBuyer items_;
};

/// Empties a cut and keeps its capacity.
void clear(Cut& cut);

/// Whether the state is large enough for the prepared frame. If not, every selector returns an empty cut.
bool has_room(const SelectInput& input, const SelectState& state, const Cut& cut);

}  // namespace surefoot::select
