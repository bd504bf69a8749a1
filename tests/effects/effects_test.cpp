// A scene pays only for what it calls for: programs hold their effects' code and no other's.
#include <gtest/gtest.h>

#include <bit>
#include <string>
#include <string_view>
#include <vector>

#include "render/effects/effects.hpp"

namespace surefoot {
namespace {

std::string text_of(model::EffectMask mask) {
    const auto source = effects::assemble_program(mask);
    return source.vertex + source.fragment;
}

/// Of all programs: what materials may have, and each effect behind everything by itself.
std::vector<model::EffectMask> program_masks() {
    std::vector<model::EffectMask> masks;
    for (model::EffectMask mask = 0; mask < 1U << model::effect_count; ++mask)
        if ((mask & model::background_effects) == 0 || std::has_single_bit(mask)) masks.push_back(mask);
    return masks;
}

TEST(Programs, hold_the_code_of_their_effects_and_of_no_other) {
    for (const model::EffectMask mask : program_masks()) {
        const std::string text = text_of(mask);
        for (const auto& module : effects::all_effects()) {
            for (const auto piece : {module.vertex_declarations, module.vertex_code, module.fragment_declarations,
                                     module.fragment_code, module.light_declarations, module.light_code}) {
                if (piece.empty()) continue;
                EXPECT_EQ(text.find(piece) != std::string::npos, (mask & module.bit) != 0) << module.name << " in mask " << mask;
            }
        }
    }
}

bool holds(const std::string& text, std::string_view piece) { return text.find(piece) != std::string::npos; }

TEST(Programs, have_light_at_the_vertices_or_in_the_pixels_and_never_in_both) {
    for (const model::EffectMask mask : program_masks()) {
        const auto source = effects::assemble_program(mask);
        const bool by_pixel = (mask & model::effect_light_by_pixel) != 0;
        bool has_light = (mask & model::effect_moving_shadow) != 0;
        for (const auto& module : effects::all_effects()) {
            if ((mask & module.bit) == 0 || !module.is_light()) continue;
            has_light = true;
            EXPECT_EQ(holds(source.vertex, module.light_code), !by_pixel) << module.name << " in mask " << mask;
            EXPECT_EQ(holds(source.fragment, module.light_code), by_pixel) << module.name << " in mask " << mask;
            for (const auto& [type, name] : module.light_inputs) {
                const std::string input = std::string(type) + " " + std::string(name) + ";\n";
                EXPECT_TRUE(holds(source.vertex, "in " + input)) << mask;
            }
            if (source.fragment_samples.empty()) continue;
            EXPECT_EQ(holds(source.fragment_samples, module.light_code), by_pixel) << module.name << " in mask " << mask;
        }
        EXPECT_EQ(holds(source.fragment, "v_normal"), by_pixel && has_light) << mask;
        EXPECT_EQ(holds(source.vertex, "v_normal"), by_pixel && has_light) << mask;
        const bool turns_vertices = has_light && (!by_pixel || (mask & model::effect_moving_shadow) != 0);  // for its bias
        EXPECT_EQ(holds(source.vertex, "if (turned) n = -n;"), turns_vertices) << mask;
        EXPECT_EQ(holds(source.fragment, "if (turned) n = -n;"), by_pixel && has_light) << mask;
        if (!by_pixel || has_light) continue;
        const auto without = effects::assemble_program(mask & ~model::effect_light_by_pixel);
        EXPECT_EQ(source.vertex, without.vertex) << "nothing is lit in mask " << mask;
        EXPECT_EQ(source.fragment, without.fragment) << mask;
    }
}

TEST(Programs, of_light_by_the_pixel_interpolate_no_colour_that_is_the_materials) {
    using namespace model;
    const auto fragment = [](EffectMask mask) { return effects::assemble_program(mask).fragment; };
    EXPECT_TRUE(holds(fragment(effect_sun), "\nin vec4 v_colour"));
    EXPECT_TRUE(holds(fragment(effect_sun | effect_light_by_pixel), "flat in vec4 v_colour"));
    EXPECT_TRUE(holds(fragment(effect_sun | effect_vertex_colour | effect_light_by_pixel), "\nin vec4 v_colour"));
}

TEST(Programs, of_an_alpha_test_cover_part_of_a_pixel_where_pixels_have_several_samples) {
    for (const model::EffectMask mask : program_masks()) {
        const auto source = effects::assemble_program(mask);
        const bool tested = (mask & model::effect_alpha_mask) != 0, blended = (mask & model::effect_blend) != 0;
        EXPECT_EQ(source.fragment_samples.empty(), !tested || blended) << mask << ": a blended alpha is no coverage";
        for (const auto& module : effects::all_effects()) {
            if (source.fragment_samples.empty() || (mask & module.bit) == 0) continue;
            const auto code = module.fragment_code_samples.empty() ? module.fragment_code : module.fragment_code_samples;
            EXPECT_NE(source.fragment_samples.find(code), std::string::npos) << module.name << " in mask " << mask;
        }
    }
}

TEST(Programs, of_what_is_behind_everything_are_their_own_and_add_nothing_to_others) {
    std::size_t behind = 0;
    for (const auto& module : effects::all_effects()) {
        EXPECT_EQ(module.called_for_by_scene != nullptr, (module.bit & model::background_effects) != 0) << module.name;
        if ((module.bit & model::background_effects) == 0) continue;
        ++behind;
        EXPECT_EQ(module.priced_on, 0U) << module.name << ": calibration would give it to materials";
        EXPECT_EQ(text_of(module.bit).find("world_rows"), std::string::npos) << module.name;
        for (const model::EffectMask mask : program_masks()) {
            if (mask == 0 || (mask & model::background_effects) != 0) continue;
            EXPECT_EQ(text_of(mask | module.bit), text_of(mask)) << module.name << " in mask " << mask;
        }
    }
    EXPECT_GT(behind, 0U);
}

TEST(Programs, the_bare_one_mentions_no_effect) {
    const std::string text = text_of(0);
    for (const std::string word :
         {"uv", "normal", "sun", "discard", "cutoff", "sampler", "texture", "vertex_colour", "opacity = colour"}) {
        EXPECT_EQ(text.find(word), std::string::npos) << word;
    }
}

TEST(Programs, the_bare_one_is_what_one_writes_by_hand) {
    const auto source = effects::assemble_program(0);
    EXPECT_EQ(source.vertex, R"(#version 430 core
in vec3 position;
in vec4 world_rows[3];
in vec4 material_colour;
uniform mat4 view_projection;
flat out vec4 v_colour;
void main() {
    vec4 local = vec4(position, 1.0);
    vec3 world = vec3(dot(world_rows[0], local), dot(world_rows[1], local), dot(world_rows[2], local));
    v_colour = material_colour;
    gl_Position = view_projection * vec4(world, 1.0);
}
)");
    EXPECT_EQ(source.fragment, R"(#version 430 core
flat in vec4 v_colour;
out vec4 pixel;
void main() {
    vec4 colour = v_colour;
    float opacity = 1.0;
    pixel = vec4(colour.rgb, opacity);
}
)");
    EXPECT_TRUE(source.uniforms.empty());
    EXPECT_TRUE(source.fragment_samples.empty());
}

TEST(Modules, are_one_a_bit_in_bit_order) {
    const auto modules = effects::all_effects();
    ASSERT_EQ(modules.size(), static_cast<std::size_t>(model::effect_count));
    for (std::size_t i = 0; i < modules.size(); ++i) {
        EXPECT_EQ(modules[i].bit, 1U << i);
        EXPECT_EQ(effects::effects_text(modules[i].bit), modules[i].name);
        EXPECT_GT(modules[i].help.size(), 10U) << modules[i].name;
    }
    EXPECT_EQ(effects::effects_text(0), "bare");
    EXPECT_EQ(effects::effects_text(3, " + "), std::string(modules[0].name) + " + " + std::string(modules[1].name));
}

}  // namespace
}  // namespace surefoot
