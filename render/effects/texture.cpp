// Effect: base colour texture. Sampled as stored (sRGB bytes, no decoding): on software GL decoding costs more than it shows.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule texture{
    .bit = model::effect_texture,
    .name = "texture",
    .what = "base colour from an image, mipmapped",
    .asked_by = "a material with a texture",
    .vertex_declarations = "in vec2 uv;\nout vec2 v_uv;\n",
    .vertex_code = "    v_uv = uv;\n",
    .fragment_declarations = "in vec2 v_uv;\nuniform sampler2D base_colour;\n",
    .fragment_code = "    colour *= texture(base_colour, v_uv);\n",
};
const EffectModule texture_module = texture;

}  // namespace surefoot::effects
