// Nearest shown texels by the exact city-block distance transform (Rosenfeld & Pfaltz 1966): it is separable, so sweeps along the
// rows and then along the columns, there and back, carry distances and colours.
#include "render/bake/alpha_bleed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

namespace surefoot::bake {

namespace {

/// No texel is as far from another: two sides of at most 16384. One step more still fits.
constexpr std::uint16_t nowhere = 0xfffe;

struct Field {
    std::uint32_t width, height;
    std::vector<std::uint32_t> texels;    ///< as they lie in memory
    std::vector<std::uint16_t> distance;  ///< to the shown texel whose colour this one has
};

constexpr auto colour_bits = std::bit_cast<std::uint32_t>(std::array<std::uint8_t, 4>{255, 255, 255, 0});

/// True where `to` is nearer by way of `from`, one step away.
bool step(Field& field, std::size_t from, std::size_t to) {
    const auto by_way = static_cast<std::uint16_t>(field.distance[from] + 1);
    if (by_way >= field.distance[to]) return false;
    field.distance[to] = by_way;
    field.texels[to] = (field.texels[from] & colour_bits) | (field.texels[to] & ~colour_bits);
    return true;
}

void sweep_row(Field& field, std::uint32_t y, bool clamp) {
    const std::size_t first = static_cast<std::size_t>(y) * field.width, last = first + field.width - 1;
    for (std::size_t i = first; i < last; ++i) step(field, i, i + 1);
    for (std::size_t i = last; i > first; --i) step(field, i, i - 1);
    if (clamp) return;
    // Over the border, and on as far as that is nearer: after the sweeps every other texel is within a step of its neighbours.
    if (step(field, last, first))
        for (std::size_t i = first; i < last && step(field, i, i + 1);) ++i;
    if (step(field, first, last))
        for (std::size_t i = last; i > first && step(field, i, i - 1);) --i;
}

/// A row from the one beside it. Without branches, so that it runs on several texels at a time.
bool step_row(Field& field, std::uint32_t from, std::uint32_t to) {
    const std::uint16_t* from_distance = field.distance.data() + static_cast<std::size_t>(from) * field.width;
    const std::uint32_t* from_texel = field.texels.data() + static_cast<std::size_t>(from) * field.width;
    std::uint16_t* distance = field.distance.data() + static_cast<std::size_t>(to) * field.width;
    std::uint32_t* texel = field.texels.data() + static_cast<std::size_t>(to) * field.width;
    std::uint32_t any = 0;
    for (std::uint32_t x = 0; x < field.width; ++x) {
        const auto by_way = static_cast<std::uint16_t>(from_distance[x] + 1);
        const bool nearer = by_way < distance[x];
        const std::uint32_t taken = nearer ? colour_bits : 0;
        distance[x] = nearer ? by_way : distance[x];
        texel[x] = (from_texel[x] & taken) | (texel[x] & ~taken);
        any |= taken;
    }
    return any != 0;
}

void sweep_columns(Field& field, bool clamp) {
    const std::uint32_t last = field.height - 1;
    for (std::uint32_t y = 0; y < last; ++y) step_row(field, y, y + 1);
    for (std::uint32_t y = last; y > 0; --y) step_row(field, y, y - 1);
    if (clamp || last == 0) return;
    if (step_row(field, last, 0))
        for (std::uint32_t y = 0; y < last && step_row(field, y, y + 1);) ++y;
    if (step_row(field, 0, last))
        for (std::uint32_t y = last; y > 0 && step_row(field, y, y - 1);) --y;
}

}  // namespace

Alphas alphas_of(const image::Image& image) {
    Alphas there{};
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) there[image.rgba[i]] = true;
    return there;
}

std::optional<std::uint8_t> hidden_alpha(const importer::Material& material, const Alphas& there) {
    if (material.alpha == model::AlphaMode::opaque) return {};
    // Rounding leaves open on which side of the cutoff a texel lies that is at it: it counts as shown.
    const float cutoff = material.alpha == model::AlphaMode::mask ? material.alpha_cutoff * 0.9999F : 1e-9F;
    for (std::size_t a = 256; a-- > 0;) {
        if (there[a] && material.colour[3] * static_cast<float>(a) / 255.0F < cutoff) return static_cast<std::uint8_t>(a);
    }
    return {};
}

std::vector<bool> hidden_materials(const importer::Scene& scene, std::vector<std::string>& warnings) {
    std::vector<bool> out;
    for (const importer::Material& material : scene.materials) {
        out.push_back(false);
        if (material.alpha != model::AlphaMode::mask || material.image == importer::none) continue;
        const Alphas there = alphas_of(scene.images[material.image]);
        const auto hidden = hidden_alpha(material, there);
        out.back() = hidden && std::none_of(there.begin() + *hidden + 1, there.end(), [](bool is) { return is; });
        if (out.back()) warnings.push_back(fmt::format("Material '{}': its mask hides all of its picture", material.name));
    }
    return out;
}

void bleed_colours(std::span<std::uint8_t> rgba, std::uint32_t width, std::uint32_t height, bool clamp, std::uint8_t hidden) {
    const std::size_t texels = static_cast<std::size_t>(width) * height;
    if (texels == 0) return;
    Field field{width, height, std::vector<std::uint32_t>(texels), std::vector<std::uint16_t>(texels)};
    std::memcpy(field.texels.data(), rgba.data(), texels * 4);
    for (std::size_t i = 0; i < texels; ++i) field.distance[i] = rgba[4 * i + 3] > hidden ? 0 : nowhere;
    for (std::uint32_t y = 0; y < height; ++y) sweep_row(field, y, clamp);
    sweep_columns(field, clamp);
    std::memcpy(rgba.data(), field.texels.data(), texels * 4);
}

}  // namespace surefoot::bake
