// Programs from modules: the bare pipeline, and into its slots the pieces of a mask's effects and of no other.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "render/effects/modules.hpp"
#include "render/effects/surface_light.hpp"

namespace surefoot::effects {

namespace {

// Of programs with light. Normals go by the cofactor matrix, which serves non-uniform scales; its sign is the determinant's, so a
// mirrored placement turns it back. Normals of two-sided materials turn towards the eye.
constexpr std::string_view normal_declarations = "in vec3 normal;\nin float two_sided;\n";
constexpr std::string_view normal_code =
    "    vec3 cofactor_x = cross(world_rows[1].xyz, world_rows[2].xyz);\n"
    "    vec3 cofactor_y = cross(world_rows[2].xyz, world_rows[0].xyz);\n"
    "    vec3 cofactor_z = cross(world_rows[0].xyz, world_rows[1].xyz);\n"
    "    vec3 n = vec3(dot(cofactor_x, normal), dot(cofactor_y, normal), dot(cofactor_z, normal));\n"
    "    n *= inversesqrt(max(dot(n, n), 1e-30)) * sign(dot(world_rows[0].xyz, cofactor_x));\n";
constexpr std::string_view turn_code =
    "    bool turned = two_sided > 0.5 && dot(n, world) > 0.0;\n"
    "    if (turned) n = -n;\n";
// By the pixel, the fragment program has what light reads at a vertex, interpolated and under the same names.
constexpr std::string_view pixel_normal_out = "out vec3 v_normal;\nout vec3 v_lit_at;\nflat out float v_two_sided;\n";
constexpr std::string_view pixel_normal_sent = "    v_normal = n;\n    v_lit_at = world;\n    v_two_sided = two_sided;\n";
constexpr std::string_view pixel_normal_in = "in vec3 v_normal;\nin vec3 v_lit_at;\nflat in float v_two_sided;\n";
constexpr std::string_view pixel_normal_code =
    "    vec3 world = v_lit_at;\n"
    "    float two_sided = v_two_sided;\n"
    "    vec3 n = v_normal * inversesqrt(max(dot(v_normal, v_normal), 1e-30));\n";

}  // namespace

std::span<const EffectModule> all_effects() {
    static const std::vector<EffectModule> modules = [] {
        std::vector<EffectModule> all;
        all.reserve(registry.size());
        for (const EffectModule* const module : registry) all.push_back(*module);
        return all;
    }();
    return modules;
}

namespace {

/// What light adds to a program: before the code of modules, and after it.
struct LightText {
    std::string vertex_declarations, vertex_before, vertex_after, fragment_declarations, fragment_before;
};

/// All code of light. What needs the light without the sun's own part gets it once more, in a scope in which the sun is dark.
std::string lit_code(const std::string& code, bool needs_sunless) {
    const std::string begin = "    vec3 lit = vec3(1.0), by_sun = vec3(0.0)";
    if (!needs_sunless) return begin + ";\n" + code;
    return "    vec3 sunless;\n    {\n" + begin + ", sun_light = vec3(0.0), picture_sun = vec3(0.0);\n" + code +
           "    sunless = lit;\n    }\n" + begin + ";\n" + code;
}

/// What light reads of a vertex, each once.
std::vector<LightInput> inputs_of(std::span<const EffectModule* const> modules) {
    std::vector<LightInput> inputs;
    for (const EffectModule* const module : modules)
        for (const LightInput& input : module->light_inputs)
            if (std::none_of(inputs.begin(), inputs.end(), [&](const LightInput& i) { return i.name == input.name; }))
                inputs.push_back(input);
    return inputs;
}

LightText light_text(std::span<const EffectModule* const> modules, bool by_pixel) {
    LightText text;
    std::string declarations, code;
    bool has_light = false, needs_sunless = false;
    for (const EffectModule* const module : modules) {
        has_light = has_light || module->is_light() || module->needs_sunless;
        needs_sunless = needs_sunless || module->needs_sunless;
        declarations += module->light_declarations;
        code += module->light_code;
    }
    const std::vector<LightInput> inputs = inputs_of(modules);
    for (const auto& [type, name] : inputs) text.vertex_declarations += fmt::format("in {} {};\n", type, name);
    if (!has_light) return text;
    text.vertex_declarations += normal_declarations;
    text.vertex_before = normal_code;
    if (!by_pixel) {
        text.vertex_declarations += declarations;
        text.vertex_before += turn_code;
        text.vertex_before += lit_code(code, needs_sunless);
        text.vertex_after = "    v_colour.rgb *= lit;\n";
        if (!needs_sunless) return text;
        text.vertex_declarations += "out vec3 v_sunless;\n";
        text.vertex_after = "    v_sunless = v_colour.rgb * sunless;\n" + text.vertex_after;
        text.fragment_declarations = "in vec3 v_sunless;\n";
        text.fragment_before = "    vec3 in_shadow = v_sunless / max(v_colour.rgb, vec3(1e-4));\n";
        return text;
    }
    text.vertex_declarations += pixel_normal_out;
    text.vertex_before += pixel_normal_sent;
    text.fragment_declarations = pixel_normal_in;
    // A scope of its own: names of light are not those of modules.
    text.fragment_before = needs_sunless ? "    vec3 in_shadow;\n    {\n" : "    {\n";
    text.fragment_before += pixel_normal_code;
    for (const auto& [type, name] : inputs) {
        text.vertex_declarations += fmt::format("out {} v_{};\n", type, name);
        text.vertex_before += fmt::format("    v_{0} = {0};\n", name);
        text.fragment_declarations += fmt::format("in {} v_{};\n", type, name);
        text.fragment_before += fmt::format("    {0} {1} = v_{1};\n", type, name);
    }
    if (needs_sunless) text.vertex_before += turn_code;  // for the module's own code there
    text.fragment_declarations += declarations;
    text.fragment_before += turn_code;
    text.fragment_before += lit_code(code, needs_sunless) + "    colour.rgb *= lit;\n";
    if (needs_sunless) text.fragment_before += "    in_shadow = sunless / max(lit, vec3(1e-4));\n";
    text.fragment_before += "    }\n";
    return text;
}

/// The effects of a mask, in the order of application.
std::vector<const EffectModule*> modules_of(model::EffectMask mask) {
    std::vector<const EffectModule*> out;
    for (const EffectModule& module : all_effects())
        if ((mask & module.bit) != 0) out.push_back(&module);
    std::stable_sort(out.begin(), out.end(), [](const auto* a, const auto* b) { return a->order < b->order; });
    return out;
}

/// Those that the processor can shade. Sorted once: points are shaded by the hundred thousand.
std::span<const EffectModule* const> lights_in_order() {
    static const std::vector<const EffectModule*> lights = [] {
        std::vector<const EffectModule*> all = modules_of(~model::EffectMask{0});
        all.erase(std::remove_if(all.begin(), all.end(), [](const auto* module) { return module->light == nullptr; }), all.end());
        return all;
    }();
    return lights;
}

}  // namespace

std::vector<model::EffectPrice> usual_prices() {
    std::vector<model::EffectPrice> prices;
    for (const EffectModule& module : all_effects())
        if (module.priced_on != 0) prices.push_back(module.usual_price);
    return prices;
}

vec3 light_of(const SurfacePoint& point, model::EffectMask mask, const model::Daylight& light) {
    SurfaceLight out;
    for (const EffectModule* module : lights_in_order())
        if ((mask & module->bit) != 0) module->light(point, light, out);
    return out.lit;
}

model::EffectMask called_for_by(const MaterialFacts& material) {
    model::EffectMask mask = 0;
    for (const EffectModule& module : all_effects())
        if (module.called_for != nullptr && module.called_for(material)) mask |= module.bit;
    return mask;
}

model::EffectMask called_for_by(const SceneFacts& scene) {
    model::EffectMask mask = 0;
    for (const EffectModule& module : all_effects())
        if (module.called_for_by_scene != nullptr && module.called_for_by_scene(scene)) mask |= module.bit;
    return mask;
}

model::EffectMask moving_effects() {
    model::EffectMask mask = 0;
    for (const EffectModule& module : all_effects())
        if (module.moves) mask |= module.bit;
    return mask;
}

bool hides_by_depth(model::EffectMask mask) {
    return std::ranges::any_of(all_effects(), [&](const EffectModule& m) { return m.hides_by_depth && (mask & m.bit) != 0; });
}

std::vector<model::EffectMask> groups_by_light(model::EffectMask mask) {
    std::vector<model::EffectMask> groups;
    std::vector<decltype(EffectModule::shows_nothing)> of_group;
    for (const EffectModule& module : all_effects()) {
        if (module.shows_nothing == nullptr || (mask & module.bit) == 0) continue;
        const auto same = std::find(of_group.begin(), of_group.end(), module.shows_nothing);
        const auto at = static_cast<std::size_t>(same - of_group.begin());
        if (same == of_group.end()) {
            of_group.push_back(module.shows_nothing);
            groups.push_back(0);
        }
        groups[at] |= module.bit;
    }
    return groups;
}

model::EffectMask without_effect_in(const model::Daylight& light) {
    model::EffectMask mask = 0;
    for (const EffectModule& module : all_effects())
        if (module.shows_nothing != nullptr && module.shows_nothing(light)) mask |= module.bit;
    return mask;
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

namespace {

// Cuts what is outside of a box: in captures of the image cache alone.
constexpr std::string_view box_declarations = "uniform vec3 box_low, box_high;\nout float gl_ClipDistance[6];\n";
constexpr std::string_view box_code =
    "    for (int i = 0; i < 3; ++i) {\n"
    "        gl_ClipDistance[2 * i] = world[i] - box_low[i];\n"
    "        gl_ClipDistance[2 * i + 1] = box_high[i] - world[i];\n"
    "    }\n";

/// The program of an effect that is drawn behind everything.
gl::ProgramSource background_program(const EffectModule& module) {
    gl::ProgramSource source;
    source.name = module.name;
    source.uniforms.assign(module.uniforms.begin(), module.uniforms.end());
    source.vertex = "#version 430 core\n" + std::string(module.vertex_declarations) + "void main() {\n" +
                    std::string(module.vertex_code) + "}\n";
    source.fragment = "#version 430 core\n" + std::string(module.fragment_declarations) + "out vec4 pixel;\nvoid main() {\n" +
                      std::string(module.fragment_code) + "    pixel = vec4(colour, 1.0);\n}\n";
    return source;
}

}  // namespace

gl::ProgramSource assemble_program(model::EffectMask mask) {
    static_assert(std::has_single_bit(model::background_effects), "a device draws one program behind everything");
    for (const EffectModule& module : all_effects())
        if (mask == module.bit && (mask & model::background_effects) != 0) return background_program(module);
    mask &= ~model::background_effects;
    const std::vector<const EffectModule*> modules = modules_of(mask);
    const bool by_pixel = (mask & model::effect_light_by_pixel) != 0;
    const LightText light = light_text(modules, by_pixel);
    std::string vertex_declarations = light.vertex_declarations;
    std::string vertex_code = light.vertex_before;
    std::string fragment_declarations = light.fragment_declarations;
    std::string fragment_code;
    std::string fragment_code_samples;
    gl::ProgramSource source;
    bool covers = false, varies = false;
    for (const EffectModule* const one : modules) {
        const EffectModule& module = *one;
        vertex_declarations += module.vertex_declarations;
        vertex_code += module.vertex_code;
        fragment_declarations += module.fragment_declarations;
        fragment_code += module.fragment_code;
        const bool other = !module.fragment_code_samples.empty() && (mask & model::effect_blend) == 0;
        fragment_code_samples += other ? module.fragment_code_samples : module.fragment_code;
        covers = covers || other;
        varies = varies || (module.varies_colour && !(by_pixel && module.is_light()));
        source.uniforms.insert(source.uniforms.end(), module.uniforms.begin(), module.uniforms.end());
        source.samplers.insert(source.samplers.end(), module.samplers.begin(), module.samplers.end());
    }
    // A colour that no effect varies over the triangle needs no interpolation.
    const std::string flat = varies ? "" : "flat ";
    source.name = effects_text(mask);
    const auto vertex = [&](std::string_view cut_declarations, std::string_view cut_code) {
        return "#version 430 core\n"
               "in vec3 position;\n"
               "in vec4 world_rows[3];\n"
               "in vec4 material_colour;\n"
               "uniform mat4 view_projection;\n" +
               flat + "out vec4 v_colour;\n" + std::string(cut_declarations) + vertex_declarations +
               "void main() {\n"
               "    vec4 local = vec4(position, 1.0);\n"
               "    vec3 world = vec3(dot(world_rows[0], local), dot(world_rows[1], local), dot(world_rows[2], local));\n"
               "    v_colour = material_colour;\n" +
               vertex_code + light.vertex_after + std::string(cut_code) +
               "    gl_Position = view_projection * vec4(world, 1.0);\n"
               "}\n";
    };
    source.vertex = vertex({}, {});
    source.vertex_in_box = vertex(box_declarations, box_code);
    const auto fragment = [&](const std::string& code) {
        return "#version 430 core\n" + flat + "in vec4 v_colour;\n" + fragment_declarations +
               "out vec4 pixel;\n"
               "void main() {\n"
               "    vec4 colour = v_colour;\n"
               "    float opacity = 1.0;\n" +
               light.fragment_before + code +
               "    pixel = vec4(colour.rgb, opacity);\n"
               "}\n";
    };
    source.fragment = fragment(fragment_code);
    if (covers) source.fragment_samples = fragment(fragment_code_samples);
    return source;
}

}  // namespace surefoot::effects
