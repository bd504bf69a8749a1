// Alpha bleeding: gives never-shown texels the colour of shown ones. Filters and mip levels mix hidden texels into their
// neighbours, and many images hold white, black or magenta there.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/import/scene.hpp"

namespace surefoot::bake {

/// [a]: whether some texel of the image has alpha a.
using Alphas = std::array<bool, 256>;
Alphas alphas_of(const image::Image& image);

/// The largest alpha in the image that the material does not show: below the cutoff of a mask, or 0 where it blends. None if
/// every texel is shown: an opaque material, or no image.
std::optional<std::uint8_t> hidden_alpha(const importer::Material& material, const Alphas& there);
inline std::optional<std::uint8_t> hidden_alpha(const importer::Material& material, const image::Image& image) {
    return hidden_alpha(material, alphas_of(image));
}

/// By material: whether its mask shows no texel of its image, so that nobody sees its triangles. A warning names each.
std::vector<bool> hidden_materials(const importer::Scene& scene, std::vector<std::string>& warnings);

/// Gives each texel with alpha <= `hidden` the colour of the nearest texel with a larger alpha. Distance: steps along rows and
/// columns, wrapping over the borders unless `clamp`. Alphas do not change. An image without shown texels does not change.
/// RGBA8, width * height texels, at most 16384 a side.
void bleed_colours(std::span<std::uint8_t> rgba, std::uint32_t width, std::uint32_t height, bool clamp, std::uint8_t hidden);

}  // namespace surefoot::bake
