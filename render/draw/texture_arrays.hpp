// Textures of equal size, levels and wrap become layers of one array texture. A layer is data of the draw and costs nothing; a
// change of texture costs a software driver about 8 us.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::draw {

/// One texture array: textures of equal size and wrapping, a layer each.
struct TextureArray {
    std::uint32_t width = 0, height = 0, levels = 1;
    bool clamp = false;
    std::vector<std::uint32_t> layers;  ///< indices in Model::textures
};
/// Array and layer of a texture of the model.
struct TextureSlot {
    std::uint32_t array = 0, layer = 0;
};
/// Which array and layer holds each texture of the model.
struct TextureLayout {
    std::vector<TextureArray> arrays;
    std::vector<TextureSlot> slots;  ///< one a texture of the model
};

/// Arrays in order of first use; none has more than 256 layers (OpenGL 4.3 promises 2048).
TextureLayout lay_out_textures(const model::Model& model);

}  // namespace surefoot::draw
