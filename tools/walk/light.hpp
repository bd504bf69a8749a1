// From switches and the hour to what the renderer draws.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "config/settings.hpp"
#include "render/engine.hpp"
#include "render/gl/device.hpp"
#include "render/model/effects.hpp"
#include "rt/base/light.hpp"

namespace surefoot::walk {

/// The effects that are left out. Without sunlight nothing has a shadow. Shadows of what moves go with those of what stands.
model::EffectMask hidden_effects(const rt::Switches& on);

/// gl::DeviceOptions::switches of a walk: for each switch, what it hides of the effects that the model calls for. Only of those
/// that are off at first, or that a visitor may use. So a model without an effect compiles nothing for its switch.
std::vector<model::EffectMask> switch_groups(const rt::Switches& at_first, bool may_switch, model::EffectMask called_for);

/// The light changes in steps of two minutes.
constexpr int hour_steps = 30;

/// The hour at a time of the walk, in steps, from 0 to below 24. rt::no_hour where the settings have none.
float hour_at(const config::Settings& settings, double walk_s);

/// EngineOptions::effect_hours of a walk: its hour, or every hour of the day where that runs.
std::vector<double> effect_hours(const config::Settings& settings);

/// Which switches' parts of the light a selection left out, by rt::light_switches.
std::array<rt::DroppedPart, rt::switch_count> dropped_parts(std::span<const EffectSale> sales, model::EffectMask called_for);

/// Draws the next pictures in this light. Without an hour, the light of before stays. Between pictures, on the thread that draws.
void show_light(Engine& engine, const rt::ShownLight& light);

}  // namespace surefoot::walk
