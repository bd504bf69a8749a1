// glTF materials, textures and pictures to a Scene's.
#pragma once

#include <string>
#include <vector>

#include "render/import/scene.hpp"
#include "render/import/tinygltf.hpp"

namespace surefoot::importer {

/// What a primitive needs to know of its material's texture: which coordinates, and how they are moved.
struct TextureUse {
    int set = 0;               ///< TEXCOORD_<set>
    vec2 offset{0}, scale{1};  ///< KHR_texture_transform
    float rotation_rad = 0;
    [[nodiscard]] bool identity() const { return offset == vec2(0) && scale == vec2(1) && rotation_rad == 0; }
    [[nodiscard]] vec2 apply(vec2 uv) const;
};

/// Fills scene.materials (one a glTF material, then a default white one) and the images that they use. Returns a TextureUse a
/// material.
std::vector<TextureUse> read_materials(const tinygltf::Model& model, const std::string& file, Scene& scene,
                                       const Progress& progress);

}  // namespace surefoot::importer
