// Of each triangle, every texel that a linear filter may read, on every level.
#include "render/bake/opaque_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace surefoot::bake {

namespace {

constexpr float rounding_texels = 1 / 64.0F;  // of coordinates, in a driver
constexpr std::uint8_t unread = 0;            // such an alpha never passes

/// Texels of one axis, first and last, that lie next to some place between two coordinates.
std::pair<std::uint32_t, std::uint32_t> texels_between(float from, float to, std::uint32_t count) {
    const auto last = static_cast<float>(count - 1);
    const float low = std::floor(from * static_cast<float>(count) - 0.5F - rounding_texels);
    const float high = std::floor(to * static_cast<float>(count) - 0.5F + rounding_texels) + 1;
    return {static_cast<std::uint32_t>(std::clamp(low, 0.0F, last)), static_cast<std::uint32_t>(std::clamp(high, 0.0F, last))};
}

/// The alpha of all texels of one level within these coordinates, or `unread` where they differ.
std::uint8_t one_alpha(const std::byte* texels, std::uint32_t width, std::uint32_t height, const vec2& low, const vec2& high) {
    const auto [left, right] = texels_between(low.x, high.x, width);
    const auto [bottom, top] = texels_between(low.y, high.y, height);
    const auto alpha = [&](std::uint32_t x, std::uint32_t y) {
        return std::to_integer<std::uint8_t>(texels[4 * (static_cast<std::size_t>(y) * width + x) + 3]);
    };
    const std::uint8_t first = alpha(left, bottom);
    for (std::uint32_t y = bottom; y <= top; ++y)
        for (std::uint32_t x = left; x <= right; ++x)
            if (alpha(x, y) != first) return unread;
    return first;
}

bool passes_everywhere(const model::Model& m, const model::Material& material, const vec2& low, const vec2& high) {
    const model::Texture& texture = m.textures[material.texture];
    if (!texture.clamp) return false;  // no picture of a box
    const std::byte* texels = m.texels.data() + texture.first_byte;
    std::uint32_t width = texture.width, height = texture.height;
    for (std::uint32_t level = 0; level < texture.levels; ++level) {
        const auto alpha = static_cast<float>(one_alpha(texels, width, height, low, high));
        if (!(material.colour[3] * alpha > 255 * material.alpha_cutoff)) return false;
        texels += std::size_t{4} * width * height;
        width = std::max(1U, width / 2);
        height = std::max(1U, height / 2);
    }
    return true;
}

bool shows_no_hole(const model::Model& m, const model::Part& part) {
    const model::Material& material = m.materials[part.material];
    for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) {
        vec2 low(0), high(0);
        for (std::uint32_t k = 0; k < 3; ++k) {
            const float* at = m.vertices[part.first_vertex + m.indices[part.first_index + i + k]].uv;
            const vec2 uv(at[0], at[1]);
            low = k == 0 ? uv : glm::min(low, uv);
            high = k == 0 ? uv : glm::max(high, uv);
        }
        if (!passes_everywhere(m, material, low, high)) return false;
    }
    return true;
}

bool is_masked_picture(const model::Material& material) {
    constexpr model::EffectMask both = model::effect_texture | model::effect_alpha_mask;
    return (material.effects & both) == both && material.texture != model::none;
}

/// By material: whether only boxes have it, and none of them shows a hole.
std::vector<bool> needless_masks(const model::Model& m) {
    std::vector<bool> of_boxes(m.materials.size(), false), needed(m.materials.size(), false);
    for (const model::Representation& rep : m.reps) {
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            const model::Part& part = m.parts[p];
            if (needed[part.material] || !is_masked_picture(m.materials[part.material])) continue;
            of_boxes[part.material] = true;
            needed[part.material] = rep.kind != model::RepKind::textured_box || !shows_no_hole(m, part);
        }
    }
    for (std::size_t i = 0; i < of_boxes.size(); ++i) of_boxes[i] = of_boxes[i] && !needed[i];
    return of_boxes;
}

}  // namespace

std::size_t drop_needless_masks(model::Model& model) {
    const std::vector<bool> needless = needless_masks(model);
    for (std::size_t i = 0; i < needless.size(); ++i) {
        if (!needless[i]) continue;
        model.materials[i].alpha = model::AlphaMode::opaque;
        model.materials[i].effects &= ~static_cast<model::EffectMask>(model::effect_alpha_mask);
    }
    for (model::Representation& rep : model.reps) {
        if (rep.kind != model::RepKind::textured_box) continue;
        rep.effects = 0;
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
            rep.effects |= model.materials[model.parts[p].material].effects;
    }
    return static_cast<std::size_t>(std::count(needless.begin(), needless.end(), true));
}

}  // namespace surefoot::bake
