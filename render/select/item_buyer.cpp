// The two rounds in which items are bought.
#include "render/select/item_buyer.hpp"

#include <algorithm>

#include "render/select/scratch.hpp"
#include "render/select/step_sums.hpp"

namespace surefoot::select {

/// All offered items that are not bought, the greatest rate first. A lever's step waits for the one before it.
std::span<ItemBuyer::Place> ItemBuyer::places(const SelectState& state) {
    const std::span<const Item> list = offered();
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < list.size(); ++i) {
        const Item& item = list[i];
        if (item.prepaid || bought_.has(i)) continue;
        const bool refined = state.hysteresis != 1.0F && state.bought.has(item.name());
        float key = Steps::rate_key(item.value / item.cost_us) * (refined ? state.hysteresis : 1.0F);
        for (const Place& before : std::span(places_).first(count))
            if (is_lever(item.kind) && list[before.item].kind == item.kind) key = std::min(key, before.key);
        places_[count++] = {i, BucketQueue::bucket_of(key), key, refined};
    }
    const std::span<Place> all = std::span(places_).first(count);
    std::sort(all.begin(), all.end(),
              [](const Place& a, const Place& b) { return a.key != b.key ? a.key > b.key : a.item < b.item; });
    return all;
}

bool ItemBuyer::step_before_is_bought(std::uint32_t i) const {
    const std::span<const Item> list = offered();
    if (!is_lever(list[i].kind)) return true;
    for (std::uint32_t before = i; before-- > 0;)
        if (list[before].kind == list[i].kind) return bought_.has(before);
    return true;
}

void ItemBuyer::take(std::uint32_t i, Budget& budget) {
    const Item& item = offered()[i];
    bought_.set |= std::uint64_t{1} << i;
    ++bought_.count;
    bought_.value += static_cast<double>(item.value);
    (item.prepaid ? bought_.prepaid_us : bought_.cost_us) += static_cast<double>(item.cost_us);
    if (!item.prepaid) budget.spend(static_cast<double>(item.cost_us));
}

bool ItemBuyer::try_item(const Place& place, const Sum& spent, double fresh, Budget& budget) {
    if (!step_before_is_bought(place.item)) return false;
    if (!budget.fits_with(spent, static_cast<double>(offered()[place.item].cost_us), place.refined ? 1.0 : fresh)) return false;
    take(place.item, budget);
    return true;
}

void ItemBuyer::buy_before_forms(const CutBuilder& builder, SelectState& state, Budget& budget) {
    count_refused();
    const std::span<const Item> list = offered();
    for (std::uint32_t i = 0; i < list.size(); ++i)
        if (list[i].prepaid) take(i, budget);
    const std::span<const Place> all = places(state);
    if (all.empty()) return;
    const double fresh = fresh_share(state);
    StepSums sums(state.scratch().step_sums);
    sum_steps(builder, Steps(input_, state, Key::rate), sums, state.scratch().list);
    Sum spent = builder.start_sum();
    auto next = all.begin();
    for (std::uint32_t bucket = 0; bucket < key_buckets && next != all.end(); ++bucket) {
        for (; next != all.end() && next->bucket == bucket; ++next) try_item(*next, spent, fresh, budget);
        const Sum with = spent + sums.fresh(bucket) + sums.refined(bucket);
        if (!budget.fits(with, nothing(sums.fresh(bucket)) ? 1.0 : fresh)) return;
        spent = with;
    }
}

void ItemBuyer::buy_all(Budget& budget) { buy_set(~std::uint64_t{0}, budget); }

void ItemBuyer::buy_set(std::uint64_t set, Budget& budget) {
    count_refused();
    const std::span<const Item> list = offered();
    for (std::uint32_t i = 0; i < list.size(); ++i)
        if (list[i].prepaid || (set >> i & 1U) != 0) take(i, budget);
}

void ItemBuyer::buy_down_to(float rate, const Sum& spent, Budget& budget) {
    while (!in_order_.empty()) {
        const Place place = in_order_.front();
        const Item& item = offered()[place.item];
        if (item.value / item.cost_us < rate) return;
        in_order_ = in_order_.subspan(1);
        try_item(place, spent, 1.0, budget);
    }
}

void ItemBuyer::buy_what_fits(const Sum& spent, const SelectState& state, Budget& budget) {
    if (offered().empty()) return;
    const double fresh = fresh_share(state);
    for (const Place& place : places(state)) try_item(place, spent, fresh, budget);
}

}  // namespace surefoot::select
