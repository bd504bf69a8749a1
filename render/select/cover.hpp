// A cut in the making: which choice every candidate has, from the cheapest cut to the finished list.
#pragma once

#include <span>

#include "render/select/budget.hpp"
#include "render/select/select.hpp"

namespace surefoot::select {

/// chosen[candidate]: offset of its choice, SelectState::opened, or none (below an item). Lives in the state's scratch.
class Cover {
public:
    Cover(const SelectInput& input, SelectState& state);

    /// Starts from the cheapest legal cut (PreparedFrame's floor). Returns its items, ascending, in scratch().
    std::span<std::uint32_t> take_floor();
    /// From the floor to full detail: every leaf's finest choice. Returns the number of steps that a search would have taken.
    std::uint32_t take_finest();
    /// Full detail costs less than the floor: the floor is made bottom-up, each family by itself, and the larger of two sums
    /// does not add up so. To be asked after take_floor().
    [[nodiscard]] bool finest_is_cheapest(const Budget& budget) const;
    /// Starts with the root alone at choice `offset`.
    void take_root(std::uint32_t offset);

    /// Of the items that take_floor() found.
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
    void open(Index c) { chosen_[c] = SelectState::opened; }
    [[nodiscard]] std::span<std::uint32_t> scratch() { return scratch_; }

    /// Writes the list, its sums and its hash, and remembers it for the next frame. refinements: for the report.
    void finish(const Budget& budget, std::uint32_t refinements, Cut& cut);

private:
    [[nodiscard]] bool switched(Index c, Index rep) const;
    void list_items(const Budget& budget, Cut& cut);
    void remember(const Cut& cut);

    const prepare::PreparedFrame& prepared_;
    SelectState& state_;
    std::span<std::uint32_t> chosen_, scratch_;
    Sum floor_;
};

/// Empties a cut and keeps its room.
void clear(Cut& cut);

/// Whether the state is large enough for the prepared frame; every selector gives an empty cut otherwise.
bool has_room(const SelectInput& input, const SelectState& state, const Cut& cut);

}  // namespace surefoot::select
