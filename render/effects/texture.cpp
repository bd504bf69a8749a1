// Effect: base colour texture, a layer of an array: images of one size are one state, and so one batch. Sampled as stored (sRGB
// bytes, no decoding): on software GL decoding costs more than it shows.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

namespace {

constexpr std::array<gl::SamplerSource, 1> texture_samplers{{{"base_colour", gl::material_unit}}};

}  // namespace

constexpr EffectModule texture{
    .bit = model::effect_texture,
    .name = "texture",
    .help = "base colour from an image, mipmapped",
    .requested_by = "a material with a texture",
    .have = "have an image",
    .missing = "no material has an image",
    .not_here = "no material here has an image",
    .called_for = [](const MaterialFacts& material) { return material.image; },
    .vertex_declarations = "in vec2 uv;\nin float texture_layer;\nout vec2 v_uv;\nflat out float v_layer;\n",
    .vertex_code = "    v_uv = uv;\n    v_layer = texture_layer;\n",
    .fragment_declarations = "in vec2 v_uv;\nflat in float v_layer;\nuniform sampler2DArray base_colour;\n",
    .fragment_code = "    colour *= texture(base_colour, vec3(v_uv, v_layer));\n",
    .samplers = texture_samplers,
    .changes_nothing = [](const MaterialUse&) { return true; },
};
const EffectModule texture_module = texture;

}  // namespace surefoot::effects
