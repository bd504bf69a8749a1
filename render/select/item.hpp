// Items: what spends frame time beside the forms of nodes. They are bought in one order with the forms, from one budget.
//
// A caller offers an item before the selection, and reads afterwards whether it was bought:
//
//   engine.offer({ItemKind::filter, 1, cost_us, value});       every frame in which it could be used
//   engine.select(...);
//   if (engine.bought(ItemKind::filter, 1)) ...                spend the time, in this frame only
//
// cost_us: what the frame takes longer, before correction and headroom, as the cost table predicts forms.
// A lever that saves time is offered the other way round: its dear setting is the item.
// value: what it shows more, in the weighted pixels of Choice::value. A share of the picture is share *
// PreparedFrame::full_value.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace surefoot::select {

/// What an item spends its time on.
enum class ItemKind : std::uint8_t { resolution, filter, order, samples, upload, refresh, effect, pictures };
constexpr std::array<std::string_view, 8> item_kind_names{"resolution", "filter",  "order",  "samples",
                                                          "upload",     "refresh", "effect", "pictures"};

/// Steps of one lever: each needs the one before it, and is priced as the difference to it. The items of the other kinds are
/// independent of each other.
constexpr bool is_lever(ItemKind kind) { return kind <= ItemKind::samples; }

/// Names an item: a kind, and which of the kind (a step of resolution, a page, an impostor).
struct ItemName {
    ItemKind kind = ItemKind::effect;
    std::uint32_t what = 0;
    friend bool operator==(const ItemName&, const ItemName&) = default;
};

/// Something that may be bought for a frame.
struct Item {
    ItemKind kind = ItemKind::effect;
    std::uint32_t what = 0;
    float cost_us = 0;     ///< > 0
    float value = 0;       ///< > 0
    bool prepaid = false;  ///< the prepared set's prices hold only with it, and predictions include its cost already
    [[nodiscard]] ItemName name() const { return {kind, what}; }
};

/// The items that are offered to one frame. Fixed memory.
class ItemList {
public:
    static constexpr std::uint32_t capacity = 64;  ///< so that a set of them is a word of bits

    void clear() { count_ = refused_ = 0; }
    /// False: refused and counted. Cost and value must be finite and above zero. A name is offered once, the steps of a lever in
    /// rising order.
    bool offer(const Item& item);
    /// An item that is bought whatever its rate: its cost is part of all predictions already. Its value may be 0.
    bool prepay(Item item);
    [[nodiscard]] std::span<const Item> offered() const { return std::span(items_).first(count_); }
    [[nodiscard]] std::uint32_t refused() const { return refused_; }

private:
    [[nodiscard]] bool has_place_for(const Item& item) const;
    bool add(const Item& item, bool sound);
    std::array<Item, capacity> items_{};
    std::uint32_t count_ = 0, refused_ = 0;
};

/// What a selection bought.
struct BoughtItems {
    std::uint64_t set = 0;      ///< bit i: item i of the list
    std::uint32_t count = 0;    ///< prepaid ones included
    std::uint32_t refused = 0;  ///< of the list, by its offer()
    double cost_us = 0;         ///< without those that are prepaid
    double prepaid_us = 0;
    double value = 0;  ///< of all
    [[nodiscard]] bool has(std::size_t i) const { return (set >> i & 1U) != 0; }
    /// Item i of the list, which was bought, is not used after all. Its time stays free.
    void cancel(std::size_t i, const Item& item) {
        set &= ~(std::uint64_t{1} << i);
        --count;
        (item.prepaid ? prepaid_us : cost_us) -= static_cast<double>(item.cost_us);
        value -= static_cast<double>(item.value);
    }
};

/// The names of what the last frame bought, for hysteresis.
class RememberedItems {
public:
    void remember(std::span<const Item> offered, const BoughtItems& bought);
    void add(const ItemName& name) {
        if (count_ < names_.size()) names_[count_++] = name;
    }
    void clear() { count_ = 0; }
    [[nodiscard]] bool has(const ItemName& name) const;
    [[nodiscard]] std::span<const ItemName> names() const { return std::span(names_).first(count_); }

private:
    std::array<ItemName, ItemList::capacity> names_{};
    std::uint32_t count_ = 0;
};

}  // namespace surefoot::select
