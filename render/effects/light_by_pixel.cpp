// Effect: light by the pixel. The code of light moves from the vertex program to that of pixels, where the normal comes
// interpolated and is made unit again. What is baked at the vertices is interpolated too. The assembler does all of it.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule light_by_pixel{
    .bit = model::effect_light_by_pixel,
    .name = "light_by_pixel",
    .help = "light worked out for each pixel, from a normal between those of the vertices",
    .requested_by = "extras.light of a glTF material with the value pixel, or bake --light-by-pixel",
    .have = "are lit by the pixel",
    .missing = "no lit material is to be lit by the pixel, by its extras or by bake --light-by-pixel",
    .not_here = "no material here is lit by the pixel",
    .called_for = [](const MaterialFacts& material) { return material.lit && material.light_by_pixel; },
    .priced_on = model::effect_texture | model::effect_sun,
    .usual_price = {model::effect_light_by_pixel, 4.2F, 9.8F, 1.6F},
    .not_everywhere = "light by the pixel is another light than that at the vertices",
};
const EffectModule light_by_pixel_module = light_by_pixel;

}  // namespace surefoot::effects
