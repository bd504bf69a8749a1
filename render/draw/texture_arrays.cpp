// Grouping textures (texture_arrays.hpp).
#include "render/draw/texture_arrays.hpp"

#include <algorithm>

namespace surefoot::draw {

namespace {

constexpr std::size_t max_layers = 256;

bool fits(const TextureArray& array, const model::Texture& texture, std::uint32_t levels) {
    return array.width == texture.width && array.height == texture.height && array.levels == levels &&
           array.clamp == texture.clamp && array.layers.size() < max_layers;
}

}  // namespace

TextureLayout lay_out_textures(const model::Model& model) {
    TextureLayout layout;
    for (std::uint32_t t = 0; t < model.textures.size(); ++t) {
        const model::Texture& texture = model.textures[t];
        const std::uint32_t levels = std::max(1U, texture.levels);
        const auto found = std::find_if(layout.arrays.begin(), layout.arrays.end(),
                                        [&](const TextureArray& array) { return fits(array, texture, levels); });
        const auto index = static_cast<std::size_t>(found - layout.arrays.begin());
        if (found == layout.arrays.end()) layout.arrays.push_back({texture.width, texture.height, levels, texture.clamp, {}});
        TextureArray& array = layout.arrays[index];
        layout.slots.push_back({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(array.layers.size())});
        array.layers.push_back(t);
    }
    return layout;
}

}  // namespace surefoot::draw
