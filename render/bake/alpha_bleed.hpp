// Alpha bleeding: the colour of texels that are never shown. Filters and mip levels mix it into what is drawn beside them, and
// many pictures have anything there: white, black, magenta.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "render/import/scene.hpp"

namespace surefoot::bake {

/// Which alphas there are in a picture.
using Alphas = std::array<bool, 256>;
Alphas alphas_of(const image::Image& image);

/// The largest alpha in the picture with which the material shows nothing: below a mask's cutoff, or 0 of what fades. None where
/// every texel is shown: of an opaque material, and of one without a picture.
std::optional<std::uint8_t> hidden_alpha(const importer::Material& material, const Alphas& there);
inline std::optional<std::uint8_t> hidden_alpha(const importer::Material& material, const image::Image& image) {
    return hidden_alpha(material, alphas_of(image));
}

/// Gives texels with alpha at most `hidden` the colour of the nearest that has more (steps along rows and columns; on over the
/// borders, unless `clamp`). Alphas stay, and so does all of a picture in which nothing has more. RGBA8, width * height texels,
/// at most 16384 a side.
void bleed_colours(std::span<std::uint8_t> rgba, std::uint32_t width, std::uint32_t height, bool clamp, std::uint8_t hidden);

}  // namespace surefoot::bake
