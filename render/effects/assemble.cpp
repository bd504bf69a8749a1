// Programs from modules: the bare pipeline, and into its slots the pieces of a mask's effects and of no other.
#include <array>

#include "render/effects/modules.hpp"

namespace surefoot::effects {

namespace {

constexpr model::EffectMask varying_colour = model::effect_vertex_colour | model::effect_sun;

}  // namespace

std::span<const EffectModule> all_effects() {
    static const std::array<EffectModule, model::effect_count> modules{texture_module, vertex_colour_module, sun_module,
                                                                       alpha_mask_module, blend_module};
    return modules;
}

std::string effects_text(model::EffectMask mask, std::string_view between) {
    std::string text;
    for (const EffectModule& module : all_effects()) {
        if ((mask & module.bit) == 0) continue;
        if (!text.empty()) text += between;
        text += module.name;
    }
    return text.empty() ? "bare" : text;
}

gl::ProgramSource assemble_program(model::EffectMask mask) {
    std::string vertex_declarations;
    std::string vertex_code;
    std::string fragment_declarations;
    std::string fragment_code;
    std::string fragment_code_samples;
    bool covers = false;
    for (const EffectModule& module : all_effects()) {
        if ((mask & module.bit) == 0) continue;
        vertex_declarations += module.vertex_declarations;
        vertex_code += module.vertex_code;
        fragment_declarations += module.fragment_declarations;
        fragment_code += module.fragment_code;
        const bool other = !module.fragment_code_samples.empty() && (mask & model::effect_blend) == 0;
        fragment_code_samples += other ? module.fragment_code_samples : module.fragment_code;
        covers = covers || other;
    }
    // A colour that no effect varies over the triangle needs no interpolation.
    const std::string flat = (mask & varying_colour) == 0 ? "flat " : "";
    gl::ProgramSource source;
    source.name = effects_text(mask);
    source.vertex =
        "#version 430 core\n"
        "in vec3 position;\n"
        "in vec4 world_rows[3];\n"
        "in vec4 material_colour;\n"
        "uniform mat4 view_projection;\n" +
        flat + "out vec4 v_colour;\n" + vertex_declarations +
        "void main() {\n"
        "    vec4 local = vec4(position, 1.0);\n"
        "    vec3 world = vec3(dot(world_rows[0], local), dot(world_rows[1], local), dot(world_rows[2], local));\n"
        "    v_colour = material_colour;\n" +
        vertex_code +
        "    gl_Position = view_projection * vec4(world, 1.0);\n"
        "}\n";
    const auto fragment = [&](const std::string& code) {
        return "#version 430 core\n" + flat + "in vec4 v_colour;\n" + fragment_declarations +
               "out vec4 pixel;\n"
               "void main() {\n"
               "    vec4 colour = v_colour;\n"
               "    float opacity = 1.0;\n" +
               code +
               "    pixel = vec4(colour.rgb, opacity);\n"
               "}\n";
    };
    source.fragment = fragment(fragment_code);
    if (covers) source.fragment_samples = fragment(fragment_code_samples);
    return source;
}

}  // namespace surefoot::effects
