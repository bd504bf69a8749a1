// Lists of items: what may be offered, and what was bought.
#include "render/select/item.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::select {

namespace {

bool above_zero(float x) { return std::isfinite(x) && x > 0.0F; }

}  // namespace

bool ItemList::has_place_for(const Item& item) const {
    if (count_ == items_.size()) return false;
    const auto list = offered();
    return std::none_of(list.begin(), list.end(), [&](const Item& other) {
        return other.kind == item.kind && (other.what == item.what || (is_lever(item.kind) && other.what > item.what));
    });
}

bool ItemList::add(const Item& item, bool sound) {
    sound = sound && has_place_for(item);
    if (sound) {
        items_[count_++] = item;
    } else {
        ++refused_;
    }
    return sound;
}

bool ItemList::offer(const Item& item) { return add(item, above_zero(item.cost_us) && above_zero(item.value) && !item.prepaid); }

bool ItemList::prepay(Item item) {
    item.prepaid = true;
    return add(item, std::isfinite(item.cost_us) && item.cost_us >= 0.0F && std::isfinite(item.value));
}

void RememberedItems::remember(std::span<const Item> offered, const BoughtItems& bought) {
    clear();
    for (std::size_t i = 0; i < offered.size(); ++i)
        if (bought.has(i)) add(offered[i].name());
}

bool RememberedItems::has(const ItemName& name) const {
    const auto list = names();
    return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace surefoot::select
