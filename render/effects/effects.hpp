// The effects: found at bake with a reason, compiled and bound only if found. One file an effect.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/effects.hpp"
#include "render/model/model.hpp"

namespace surefoot::effects {

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
};

/// In bit order. To add one: its bit, a file in this folder, and its line in modules.hpp and assemble.cpp.
std::span<const EffectModule> all_effects();
/// "texture sun", or "bare".
std::string effects_text(model::EffectMask mask, std::string_view between = " ");

/// The program of one state class: the bare pipeline and the modules of its bits, nothing else.
gl::ProgramSource assemble_program(model::EffectMask mask);

}  // namespace surefoot::effects
