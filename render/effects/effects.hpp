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

/// What a material, and the scene around it, call for effects by.
struct MaterialFacts {
    bool image = false, vertex_colours = false, lit = false;
    bool in_fog = false, water = false, light_by_pixel = false;
    model::AlphaMode alpha = model::AlphaMode::opaque;
};

/// What a scene calls for effects by that no material has.
struct SceneFacts {
    bool sky = false;
};

/// The effects of a material, and what all vertices that it is drawn with hold.
struct MaterialUse {
    model::EffectMask effects = 0;
    bool white = true;   ///< a colour that changes nothing
    bool open = true;    ///< nothing is hidden from them
    bool no_sky = true;  ///< openness leaves nothing of the sun
};

/// What light reads of a vertex: the GLSL type and the name of an attribute.
struct LightInput {
    std::string_view type, name;
};

/// One effect: what calls for it, its GLSL pieces for the named slots of the bare program, its price and its worth.
struct EffectModule {
    model::Effect bit;
    std::string_view name, help;     ///< help: one line for people
    std::string_view requested_by;   ///< what in a scene asks for it
    std::string_view have, missing;  ///< of a finding: "3 of 5 materials `have`", or why it is not called for
    std::string_view not_here = "no material here has it";  ///< why a region of a model that calls for it does not
    /// Whether a material calls for it. Null: a step of the bake measures it and gives it to materials.
    bool (*called_for)(const MaterialFacts& material) = nullptr;
    /// Of model::background_effects: whether the scene calls for it.
    bool (*called_for_by_scene)(const SceneFacts& scene) = nullptr;

    // Of model::background_effects, the pieces are a program of their own. It draws three vertices without attributes, which
    // cover the picture: vertex_code sets gl_Position, fragment_code makes `colour`, a vec3.
    std::string_view vertex_declarations = {}, vertex_code = {};      ///< may read `world_rows`, write `v_colour`
    std::string_view fragment_declarations = {}, fragment_code = {};  ///< may change `colour`, discard
    /// In place of fragment_code where pixels have several samples; sets `opacity` to the covered share. Empty: fragment_code.
    std::string_view fragment_code_samples = {};
    std::span<const gl::UniformSource> uniforms = {};  ///< that its pieces declare
    std::span<const gl::SamplerSource> samplers = {};
    bool varies_colour = false;  ///< vertices of a triangle may have different colours by it
    /// Of a module with light. Its code may read the normal `n`, whether it was `turned` to the eye, and its inputs. It writes
    /// `lit`, and of it the share `by_sun`. It stands in the vertex program, or in that of pixels (effect_light_by_pixel).
    std::string_view light_declarations = {}, light_code = {};
    std::span<const LightInput> light_inputs = {};
    [[nodiscard]] constexpr bool is_light() const { return !light_code.empty(); }
    /// vertex_code may read `n`; fragment_code may read `in_shadow`: the share of the light that is left without the sun.
    bool needs_sunless = false;
    int order = 0;  ///< of application; effects of the same order go by bit

    /// Its cost adds to that of a state class, and calibration measures it on this one. 0: grids of state classes hold its cost,
    /// or CostModel::background_ns_per_pixel.
    model::EffectMask priced_on = 0;
    /// Until it is measured: as on llvmpipe with two cores. `effect` is `bit` or, without a price, 0.
    model::EffectPrice usual_price = {};
    /// Of a module with light: what light_code does, on the processor. The difference that it makes is the effect's worth.
    void (*light)(const SurfacePoint& point, const model::Daylight& of_moment, SurfaceLight& out) = nullptr;
    bool moves = false;           ///< its picture changes with the time
    bool hides_by_depth = false;  ///< its worth: what is far shows the colour behind everything instead of its own
    /// Whether pictures in this light are the same to the bit without it. Null: it may always show something. Effects with the
    /// same function go together.
    bool (*shows_nothing)(const model::Daylight& light) = nullptr;

    /// Whether such a material may have it too, with the same picture. Null: no material may.
    bool (*changes_nothing)(const MaterialUse& material) = nullptr;
    std::string_view not_everywhere = {};  ///< why some may not
};

/// In bit order. To add one: a file in this folder, its bit (model/effects.hpp), and its line in modules.hpp.
std::span<const EffectModule> all_effects();
/// What a material calls for by itself.
model::EffectMask called_for_by(const MaterialFacts& material);
/// What a scene calls for that no material has.
model::EffectMask called_for_by(const SceneFacts& scene);
/// The effects whose pictures change with the time.
model::EffectMask moving_effects();
/// Whether any effect of the mask hides by depth.
bool hides_by_depth(model::EffectMask mask);
/// Of these effects, the groups that show nothing in some lights: those of a group in the same ones.
std::vector<model::EffectMask> groups_by_light(model::EffectMask mask);
/// All effects that show nothing in this light.
model::EffectMask without_effect_in(const model::Daylight& light);
/// The usual prices of those that have one, in bit order.
std::vector<model::EffectPrice> usual_prices();
/// "texture sun", or "bare".
std::string effects_text(model::EffectMask mask, std::string_view between = " ");

/// The program of one state class: the bare pipeline and the modules of its bits, nothing else. Of one background effect alone:
/// its own program. With others it adds nothing, as no material has it.
gl::ProgramSource assemble_program(model::EffectMask mask);

}  // namespace surefoot::effects
