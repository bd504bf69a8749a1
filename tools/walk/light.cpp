// From switches and the hour to what the renderer draws.
#include "tools/walk/light.hpp"

#include <algorithm>
#include <cmath>

#include "render/model/daylight.hpp"

namespace surefoot::walk {

static_assert(rt::switch_count <= gl::max_switches);

model::EffectMask hidden_effects(const rt::Switches& on) {
    model::EffectMask hidden = 0;
    constexpr model::EffectMask shadows = model::effect_shadow | model::effect_moving_shadow;
    if (!on.sunlight) hidden |= model::effect_sun | shadows;
    if (!on.shadows) hidden |= shadows;
    if (!on.lamps) hidden |= model::effect_lamps;
    if (!on.fog) hidden |= model::effect_fog;
    return hidden;
}

namespace {

model::EffectMask group_of(const rt::Switch& one) {
    rt::Switches without;
    without.*one.on = false;
    return hidden_effects(without);
}

}  // namespace

std::vector<model::EffectMask> switch_groups(const rt::Switches& at_first, bool may_switch, model::EffectMask called_for) {
    std::vector<model::EffectMask> groups;
    for (const rt::Switch& one : rt::light_switches) {
        if (!may_switch && at_first.*one.on) continue;
        const model::EffectMask group = group_of(one) & called_for;
        if (group != 0 && std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
    }
    return groups;
}

float hour_at(const config::Settings& settings, double walk_s) {
    if (!(settings.hour >= 0)) return rt::no_hour;
    constexpr double steps_of_day = 24.0 * hour_steps;
    const double step = std::round((settings.hour + settings.hour_speed * walk_s / 60) * hour_steps);
    return static_cast<float>((step - steps_of_day * std::floor(step / steps_of_day)) / hour_steps);
}

void show_light(Engine& engine, const rt::ShownLight& light) {
    engine.hide_effects(hidden_effects(light.on));
    if (rt::has_hour(light))
        engine.set_light(model::daylight_at(static_cast<double>(light.hour), engine.model().light), light.hour);
}

std::vector<double> effect_hours(const config::Settings& settings) {
    if (!(settings.hour >= 0)) return {};
    if (settings.hour_speed == 0) return {static_cast<double>(hour_at(settings, 0))};
    std::vector<double> hours;
    for (int hour = 0; hour <= 24; ++hour) hours.push_back(hour);
    return hours;
}

std::array<rt::DroppedPart, rt::switch_count> dropped_parts(std::span<const EffectSale> sales, model::EffectMask called_for) {
    std::array<rt::DroppedPart, rt::switch_count> parts{};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const model::EffectMask group = group_of(rt::light_switches[i]) & called_for;
        for (const EffectSale& sale : sales)
            if (group != 0 && sale.group == group) parts[i] = {sale.dropped, sale.fell, sale.dropped ? sale.rate : 0.0F};
    }
    return parts;
}

}  // namespace surefoot::walk
