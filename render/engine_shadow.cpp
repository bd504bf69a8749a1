// The engine's shadow map of what moves: offered before a selection, drawn or kept after it.
#include "render/engine_impl.hpp"

namespace surefoot {

ShadowScene Engine::Impl::shadow_scene() { return {model, moving, poses, light, time_s}; }

/// Where it may be seen from until the next one is planned. None is offered while pictures are drawn without it.
void Engine::Impl::offer_shadow(const prepare::PreparedFrame& set) {
    shadow_due = false;
    if (!shadow.any()) return;
    shadow_eye = {set.region.centre, set.viewport, set.region.radius_m, set.region.angle_rad};
    if ((drawn_without() & model::effect_moving_shadow) != 0 || !shadow.plan(shadow_scene(), shadow_eye)) return;
    const float us = shadow.price_us(model, costs), worth_now = shadow.value(shadow_scene(), shadow_eye);
    if (worth_now > 0.0F) offered.offer({select::ItemKind::refresh, shadow_item, us, worth_now});
}

/// After the effects. Where the same selection left its group out, the map is not drawn, and its time stays free.
void Engine::Impl::take_shadow() {
    shadow_due = shadow.any() && was_bought({select::ItemKind::refresh, shadow_item});
    if (!shadow_due || (drawn_without() & model::effect_moving_shadow) == 0) return;
    shadow_due = false;
    const std::span<const select::Item> list = offered.offered();
    for (std::size_t i = 0; i < list.size(); ++i)
        if (list[i].name() == select::ItemName{select::ItemKind::refresh, shadow_item}) cut.bought.cancel(i, list[i]);
}

/// The price of the map that this frame bought.
float Engine::Impl::shadow_map_us() const {
    for (const select::Item& item : offered.offered())
        if (item.kind == select::ItemKind::refresh && item.what == shadow_item) return item.cost_us;
    return 0;
}

/// Before a picture begins: the bought map is drawn with it. An old one is shown while it is good enough.
void Engine::Impl::begin_shadow(const Pose& pose, SubmitReport& report) {
    if (!shadow.any()) return;
    device->draws.plays();
    const bool hidden_now = (drawn_without() & model::effect_moving_shadow) != 0;
    if (shadow_due && !use_last && !hidden_now) {
        device->refresh_shadow(shadow.view(), shadow.items());
        shadow.drawn(time_s);
        report.shadow_refreshed = true;
    }
    shadow_due = false;
    report.shadow_shown = !hidden_now && shadow.usable(shadow_scene(), {pose, options.device.viewport});
    shadow_shown = report.shadow_shown;
    device->show_shadow(shadow_shown);
}

bool Engine::refresh_shadow(const Pose& pose) {
    Impl& e = *impl_;
    e.draws.plays();
    if ((e.always_without() & model::effect_moving_shadow) != 0 || !e.shadow.any() ||
        !e.shadow.plan(e.shadow_scene(), {pose, e.options.device.viewport}))
        return false;
    e.device->draws.plays();
    e.device->refresh_shadow(e.shadow.view(), e.shadow.items());
    e.shadow.drawn(e.time_s);
    e.shadow_unbudgeted = true;
    return true;
}

void Engine::forget_shadow() {
    Impl& e = *impl_;
    e.draws.plays();
    e.shadow.forget();
    e.shadow_unbudgeted = false;
    e.shadow_due = e.shadow.any() && e.offers_used && e.was_bought({select::ItemKind::refresh, Impl::shadow_item});
}

}  // namespace surefoot
