// Buys the items of a frame in one order with its forms: by value per us, from the one budget. In this room only.
#pragma once

#include <array>
#include <cstdint>

#include "render/select/budget.hpp"
#include "render/select/item.hpp"
#include "render/select/select.hpp"

namespace surefoot::select {

class CutBuilder;

/// Two rounds. Before the forms: what has a greater rate than the steps where the budget ends. After them: what still fits.
/// What the last frame bought counts for more, as a form that it showed. Nothing is done, and nothing changes, without items.
class ItemBuyer {
public:
    explicit ItemBuyer(const SelectInput& input) : input_(input) {}

    /// Without an item to buy: says how many were refused.
    void count_refused() { bought_.refused = input_.items != nullptr ? input_.items->refused() : 0; }
    /// The first round. Walks over all steps by rate; the builder holds the start. `budget` pays.
    void buy_before_forms(const CutBuilder& builder, SelectState& state, Budget& budget);
    /// For selectors without a budget: everything.
    void buy_all(Budget& budget);
    void buy_set(std::uint64_t set, Budget& budget);
    /// For a selector that goes down its own list of rates. Puts the items in their order, once. Then, before each step, buys
    /// those whose rate is at least that of the step. What does not fit is passed over.
    void put_in_order(const SelectState& state) { in_order_ = places(state); }
    void buy_down_to(float rate, const Sum& spent, Budget& budget);
    /// The second round. spent: the sums of the forms that are taken.
    void buy_what_fits(const Sum& spent, const SelectState& state, Budget& budget);

    [[nodiscard]] const BoughtItems& bought() const { return bought_; }
    [[nodiscard]] std::span<const Item> offered() const {
        return input_.items != nullptr ? input_.items->offered() : std::span<const Item>();
    }

private:
    /// An item that may be bought, and its place in the order of rates.
    struct Place {
        std::uint32_t item = 0, bucket = 0;
        float key = 0;
        bool refined = false;
    };
    std::span<Place> places(const SelectState& state);
    [[nodiscard]] bool step_before_is_bought(std::uint32_t i) const;
    bool try_item(const Place& place, const Sum& spent, double fresh, Budget& budget);
    void take(std::uint32_t i, Budget& budget);

    const SelectInput& input_;
    BoughtItems bought_;
    std::array<Place, ItemList::capacity> places_{};
    std::span<Place> in_order_;  ///< of places_: what put_in_order() left to be tried
};

}  // namespace surefoot::select
