// The effects: found at bake with a reason, compiled and bound only if found. One file an effect.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/cost.hpp"
#include "render/model/effects.hpp"
#include "render/model/model.hpp"

namespace surefoot::effects {

struct SurfacePoint;
struct SurfaceLight;

/// One effect: what asks for it, and its GLSL pieces for the named slots of the bare program.
struct EffectModule {
    model::Effect bit;
    std::string_view name, help;                            ///< help: one line for people
    std::string_view requested_by;                          ///< what in a scene asks for it
    std::string_view vertex_declarations, vertex_code;      ///< may read `world_rows`, write `v_colour`
    std::string_view fragment_declarations, fragment_code;  ///< may change `colour`, discard
    /// In place of fragment_code where pixels have several samples; sets `opacity` to the covered share. Empty: fragment_code.
    std::string_view fragment_code_samples = {};
    /// vertex_code may read the normal `n` and whether it was `turned` to the eye; write `lit`, and of it the share `by_sun`.
    bool is_light = false;
    int order = 0;  ///< of application; effects of the same order go by bit
    /// Of a module with light: what vertex_code does, on the processor. The difference that it makes is the effect's worth.
    void (*light)(const SurfacePoint& point, const model::Daylight& of_moment, SurfaceLight& out) = nullptr;
    /// Its cost adds to that of a state class, and calibration measures it on this one. 0: grids of state classes hold its cost.
    model::EffectMask priced_on = 0;
    /// Until it is measured: as on llvmpipe with two cores. `effect` is `bit` or, without a price, 0.
    model::EffectPrice usual_price = {};
};

/// In bit order. To add one: its bit, a file in this folder, and its line in modules.hpp and assemble.cpp.
std::span<const EffectModule> all_effects();
/// The usual prices of those that have one, in bit order.
std::vector<model::EffectPrice> usual_prices();
/// "texture sun", or "bare".
std::string effects_text(model::EffectMask mask, std::string_view between = " ");

/// The program of one state class: the bare pipeline and the modules of its bits, nothing else.
gl::ProgramSource assemble_program(model::EffectMask mask);

}  // namespace surefoot::effects
