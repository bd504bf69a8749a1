// Taking, replaying and comparing captured frames.
#include "render/capture/capture.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "render/select/oracle.hpp"

namespace surefoot::capture {

Capture take(const select::SelectInput& input, std::string_view selector, Memory memory, const select::Cut& cut) {
    Capture c;
    c.prepared = *input.prepared;
    c.selector = selector;
    c.budget_us = input.budget_us;
    c.correction = input.correction;
    c.target_error_rad = input.target_error_rad;
    c.max_error_rad = input.max_error_rad;
    c.slice_us = input.slice_us;
    c.combine = input.costs->combine_at(input.prepared->resolution, input.prepared->viewport);
    c.headroom = static_cast<float>(select::headroom_of(input));
    c.slice_end_us = input.costs->slice_us;
    c.enlarge_ns_per_pixel = input.costs->enlarge_ns_per_pixel;
    c.hysteresis = memory.hysteresis;
    c.reserve_share = memory.reserve_share;
    c.node_count = static_cast<std::uint32_t>(input.model->nodes.size());
    c.memory = std::move(memory.shown);
    const auto bought = memory.bought.names();
    c.bought_before.assign(bought.begin(), bought.end());
    if (input.items != nullptr) {
        c.offered.assign(input.items->offered().begin(), input.items->offered().end());
    }
    c.items = cut.items;
    c.hash = cut.hash;
    c.predicted_us = cut.predicted_us;
    return c;
}

select::ItemList items_of(const Capture& capture) {
    select::ItemList items;
    for (const select::Item& item : capture.offered) {
        if (item.prepaid) {
            items.prepay(item);
        } else {
            items.offer(item);
        }
    }
    return items;
}

Result<select::Cut> replay(const Capture& capture, std::string_view selector_name) {
    const std::string_view name = selector_name.empty() ? std::string_view(capture.selector) : selector_name;
    const select::Selector* selector = select::find_offline_selector(name);
    if (selector == nullptr) {
        return Error{"selector '" + std::string(name) + "'", "There is no such selector", "Name one that this version knows",
                     ErrorKind::misuse};
    }
    const auto candidates = static_cast<std::uint32_t>(std::max(capture.prepared.candidates.size(), capture.memory.size()));
    model::Model nodes_only;  // selection asks the model for nothing but its size
    nodes_only.nodes.resize(capture.node_count);
    select::SelectState state;
    state.reserve(nodes_only, candidates);
    state.hysteresis = capture.hysteresis;
    state.reserve_share = capture.reserve_share;
    for (const select::Shown& m : capture.memory) state.shown[m.node] = m.form;
    state.touched = capture.memory;
    for (const select::ItemName& bought : capture.bought_before) state.bought.add(bought);
    const select::ItemList items = items_of(capture);
    model::CostModel costs;
    costs.combine = capture.combine;
    costs.headroom = capture.headroom;
    costs.slice_us = capture.slice_end_us;
    costs.enlarge_ns_per_pixel = capture.enlarge_ns_per_pixel;
    select::SelectInput input{&nodes_only,
                              &capture.prepared,
                              &costs,
                              capture.budget_us,
                              capture.correction,
                              capture.target_error_rad,
                              capture.slice_us,
                              0,
                              &items,
                              capture.max_error_rad};
    for (const select::Item& item : items.offered())
        if (item.prepaid && item.kind == select::ItemKind::pictures) input.beside_us += static_cast<double>(item.cost_us);
    select::Cut cut;
    select::reserve(cut, candidates);
    selector->run(input, state, cut);
    return cut;
}

Result<void> verify(const Capture& capture) {
    auto cut = replay(capture);
    if (!cut) return cut.error();
    const std::size_t n = std::min(cut->items.size(), capture.items.size());
    for (std::size_t i = 0; i < n; ++i) {
        const select::CutItem &a = capture.items[i], &b = cut->items[i];
        if (a.node != b.node || a.rep != b.rep) {
            return Error{
                fmt::format("item {}", i),
                fmt::format("The capture shows node {} by form {}, the replay node {} by form {}", a.node, a.rep, b.node, b.rep),
                "Replay with the version that captured it: the selectors differ", ErrorKind::failed};
        }
    }
    if (cut->hash != capture.hash || cut->items.size() != capture.items.size()) {
        return Error{"cut", fmt::format("The capture holds {} items, the replay {}", capture.items.size(), cut->items.size()),
                     "Replay with the version that captured it: the selectors differ", ErrorKind::failed};
    }
    return {};
}

}  // namespace surefoot::capture
