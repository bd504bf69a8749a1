// The effects of a scene: found at bake with the reason, compiled and bound only if found. One file an effect.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/effects.hpp"
#include "render/model/model.hpp"

namespace surefoot::effects {

/// One effect: what asks for it and its share of the program. GLSL pieces go into the named slots of the bare program.
struct EffectModule {
    model::Effect bit;
    std::string_view name;
    std::string_view what;                                  ///< one line for people
    std::string_view asked_by;                              ///< what in a scene asks for it
    std::string_view vertex_declarations, vertex_code;      ///< may read `world_rows`, write `v_colour`
    std::string_view fragment_declarations, fragment_code;  ///< may change `colour`, discard
};

std::span<const EffectModule> all_effects();

/// Findings, one an effect, from a model's materials and geometry.
std::vector<model::EffectFinding> find_effects(const model::Model& model);

/// The program of one state class: the bare pipeline and the modules of its bits, nothing else.
gl::ProgramSource assemble_program(model::EffectMask mask);

}  // namespace surefoot::effects
