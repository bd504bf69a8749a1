// The engine's effects as items: offered before a selection, and taken or left out after it.
#include <algorithm>
#include <cmath>

#include "render/effects/effects.hpp"
#include "render/engine_impl.hpp"

namespace surefoot {

void EffectDwell::answer(bool bought) {
    if (bought) {
        away_ = false;
        ++kept_;
        return;
    }
    if (away_) return;  // its wait is over, and it goes on
    const bool too_short = wait_ > 0 && kept_ < long_stay * wait_;
    if (frames_ < start_frames)
        left_ = start_wait;
    else
        left_ = wait_ = too_short ? std::min(2 * wait_, max_wait) : min_wait;
    kept_ = 0;
    away_ = true;
}

std::vector<model::Index> restless_nodes(const model::Model& model, const model::MovingNodes& moving) {
    std::vector<model::Index> nodes = moving.any() ? moving.roots() : std::vector<model::Index>{};
    const model::EffectMask moves = effects::moving_effects();
    if ((model.called_for() & moves) == 0) return nodes;
    for (model::Index n = 0; n < model.nodes.size(); ++n) {
        const model::Node& node = model.nodes[n];
        if (node.child_count == 0 && (model.reps[node.first_rep + node.rep_count - 1].effects & moves) != 0) nodes.push_back(n);
    }
    return nodes;
}

void Engine::Impl::reserve_effects() {
    const std::vector<EffectGroup> groups = groups_for_sale(options.device.switches);
    lever.count = std::min(groups.size(), lever.groups.size());
    std::copy_n(groups.begin(), lever.count, lever.groups.begin());
    worth = EffectWorth(model, lever.all(), options.effect_hours, options.device.sky);
}

/// Which effects the next sets have no price of: what pictures are drawn without, and all that frames buy.
void Engine::Impl::price_without() {
    const model::EffectMask bought = by_budget ? lever.every() : 0;
    without.store(always_without() | bought, std::memory_order_relaxed);
}

/// What a light may leave without anything to show gets switches of its own, as far as the device has room for them. Those of
/// the options stay apart: they alone are hidden by hide_effects(), and bought.
gl::DeviceOptions Engine::Impl::with_light_groups() {
    gl::DeviceOptions out = options.device;
    for (const model::EffectMask group : effects::groups_by_light(model.called_for())) {
        const bool has = std::find(out.switches.begin(), out.switches.end(), group) != out.switches.end();
        if (!has && out.switches.size() >= gl::max_switches) continue;
        if (!has) out.switches.push_back(group);
        by_light |= group;
    }
    return out;
}

/// After a change of switches or of the light.
void Engine::Impl::leave_out_unlit() {
    unlit = by_light & effects::without_effect_in(light);
    price_without();
    unseen.store(drawn_without(), std::memory_order_relaxed);
    device->draws.plays();
    device->hide_effects(always_without());
}

/// A set from before a change of the light has other prices than what is drawn now.
void Engine::Impl::price_light_change(const prepare::PreparedFrame& set) {
    const model::EffectMask bought = by_budget ? lever.every() : 0, off = drawn_without();
    priced_late = by_light & set.without & ~off & ~bought;
    priced_early = by_light & off & ~set.without;
}

namespace {

/// What more work adds to a frame with these sums, us.
float more_us(const model::FrameCombine& combine, const model::ItemCost& forms, const model::ItemCost& more) {
    return combine.frame_us(forms.submit_us + more.submit_us, forms.raster_us + more.raster_us) -
           combine.frame_us(forms.submit_us, forms.raster_us);
}

}  // namespace

model::ItemCost Engine::Impl::effects_of(model::Index rep, float surface_px, model::EffectMask effects) const {
    return preparer->item_costs().of_effects(rep, surface_px * drawn_resolution * drawn_resolution, effects);
}

/// What costs the group's time: without what another switch left out of it.
model::EffectMask Engine::Impl::priced_now(std::size_t g) const {
    const EffectGroup& group = lever.groups[g];
    return group.own | (group.priced & ~always_without());
}

/// By the forms of the last cut: a frame shows much of what the last one showed. Before there was one, by full detail.
void Engine::Impl::price_groups(const prepare::PreparedFrame& set) {
    if (lever.known) return;
    lever.forms = set.full_cost;
    lever.costs = {};
    for (const prepare::Candidate& candidate : set.candidates) {
        if (candidate.child_count > 0) continue;
        const prepare::Choice& finest = set.choices[candidate.first_choice + candidate.choice_count - 1];
        for (std::size_t g = 0; g < lever.count; ++g) lever.costs[g] += effects_of(finest.rep, finest.surface_px, priced_now(g));
    }
}

/// A group costs a share of the forms' time: the more of it they have, the more the group costs as well. So its price is what it
/// takes where forms and all groups fill the budget together, or where full detail has all of them.
void Engine::Impl::share_budget(const prepare::PreparedFrame& set, double room_us) {
    const model::FrameCombine combine = this->combine();
    const float forms_us = more_us(combine, {}, lever.forms), full_us = more_us(combine, {}, set.full_cost);
    float all = 1;
    for (std::size_t g = 0; g < lever.count; ++g) {
        const bool for_sale = may_show(g) && by_budget && set.effect_value[g] > 0.0F;
        lever.offered_us[g] = for_sale && forms_us > 0.0F ? more_us(combine, lever.forms, lever.costs[g]) / forms_us : 0.0F;
        all += lever.offered_us[g];
    }
    with_effects.store(all, std::memory_order_relaxed);
    const float of_forms_us = std::max(1.0F, std::min(static_cast<float>(room_us) / all, full_us));
    for (float& us : lever.offered_us) us *= of_forms_us;
}

void Engine::Impl::offer_effects(const prepare::PreparedFrame& set, double room_us) {
    if (lever.count == 0) return;
    price_groups(set);
    share_budget(set, room_us);
    for (std::size_t g = 0; g < lever.count; ++g) {
        EffectSale& sale = lever.sales[g];
        const EffectSale before = sale;
        sale = {lever.groups[g].mask};
        float& us = lever.offered_us[g];
        if (!(us > 0.0F)) continue;
        sale.dropped = before.dropped;
        sale.rate = before.dropped ? before.rate : set.effect_value[g] / us;
        EffectDwell& of_group = lever.dwell[g];
        sale.dropped = before.dropped || of_group.away();
        const float worth_now = (of_group.away() ? EffectDwell::value_share : 1.0F) * set.effect_value[g];
        if (!of_group.offer() || !offered.offer({select::ItemKind::effect, lever.groups[g].mask, us, worth_now})) us = 0;
    }
}

/// What costs nothing is shown; so is what shows nothing, unless that would cost something.
void Engine::Impl::take_effects(const prepare::PreparedFrame& set) {
    if (lever.count == 0) return;
    lever.left_out = lever.shown = 0;
    lever.spent_us = 0;
    std::array<bool, prepare::max_effect_groups> shows{};
    for (std::size_t g = 0; g < lever.count; ++g) {
        if (!by_budget || !may_show(g)) continue;
        shows[g] = lever.offered_us[g] > 0.0F ? was_bought({select::ItemKind::effect, lever.groups[g].mask})
                                              : !(more_us(combine(), lever.forms, lever.costs[g]) > 0.0F);
        if (!shows[g]) lever.left_out |= lever.groups[g].mask;
    }
    for (std::size_t g = 0; g < lever.count; ++g) {
        if (!by_budget || !may_show(g)) continue;
        const EffectGroup& group = lever.groups[g];
        EffectSale& sale = lever.sales[g];
        shows[g] = shows[g] && (group.own & ~lever.left_out) != 0;  // shadows go with the sun
        if (lever.offered_us[g] > 0.0F) {
            sale.fell = !shows[g] && !sale.dropped;
            if (shows[g] && sale.dropped) sale.rate = set.effect_value[g] / lever.offered_us[g];
            sale.dropped = !shows[g];
            lever.dwell[g].answer(shows[g]);
            if (shows[g]) lever.spent_us += static_cast<double>(lever.offered_us[g]);
        }
        if (shows[g]) lever.shown |= group.priced;
    }
    lever.shown &= ~(lever.left_out | hidden | unlit) & set.without;
    unseen.store(drawn_without(), std::memory_order_relaxed);
    learn_effects();
}

/// The forms of the new cut, and what the groups cost on them.
void Engine::Impl::learn_effects() {
    const std::vector<prepare::Choice>& choices = prepared->choices;
    lever.known = !cut.items.empty();  // where nothing was in view, the next frame goes by its set
    lever.forms = {};
    lever.costs = {};
    for (const select::CutItem& item : cut.items) {
        const prepare::Choice& choice = choices[item.choice];
        lever.forms += choice.cost;
        for (std::size_t g = 0; g < lever.count; ++g) lever.costs[g] += effects_of(choice.rep, choice.surface_px, priced_now(g));
    }
}

/// As what they hold is drawn.
void Engine::Impl::price_slices() {
    const std::span<const select::CutItem> order(plan.order), stand_ins(plan.stand_ins);
    for (select::Slice& slice : plan.slices) {
        slice.cost = slice.stand_in_cost = {};
        for (const select::CutItem& item : order.subspan(slice.first_item, slice.item_count))
            slice.cost += drawn_cost(prepared->choices[item.choice]);
        for (const select::CutItem& item : stand_ins.subspan(slice.first_stand_in, slice.stand_in_count))
            slice.stand_in_cost += drawn_cost(prepared->choices[item.choice]);
    }
}

bool Engine::Impl::was_bought(const select::ItemName& name) const {
    const std::span<const select::Item> list = offered.offered();
    for (std::size_t i = 0; i < list.size(); ++i)
        if (list[i].name() == name) return cut.bought.has(i);
    return false;
}

std::span<const EffectSale> Engine::effect_sales() const {
    impl_->draws.plays();
    return std::span(impl_->lever.sales).first(impl_->lever.count);
}

}  // namespace surefoot
