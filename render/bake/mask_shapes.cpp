// Marks what each mip level can make show, texel by texel.
#include "render/bake/mask_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace surefoot::bake {

namespace {

constexpr std::uint32_t shape_levels = 4;      // mip levels that count
constexpr std::uint32_t max_shape_side = 512;  // texels of a shape

/// Where shapes are made: by texel of the shape, whether something may show there.
struct Marks {
    std::uint32_t width, height;
    std::vector<bool> shows;

    /// Marks all that a texel of a mip level can make show: alpha is bilinear between the middles of texels. For levels that are
    /// larger than the shape.
    void add(std::uint32_t x, std::uint32_t y, std::uint32_t level_width, std::uint32_t level_height) {
        const auto range = [](std::uint32_t at, std::uint32_t of, std::uint32_t size) {
            const double scale = static_cast<double>(size) / of;
            const auto from = static_cast<std::int64_t>(std::floor((at - 0.5) * scale + 1e-6));
            const auto to = static_cast<std::int64_t>(std::ceil((at + 1.5) * scale - 1e-6));
            return std::pair(from, std::min(to, from + size));
        };
        const auto wrapped = [](std::int64_t i, std::uint32_t n) { return static_cast<std::size_t>((i % n + n) % n); };
        const auto [left, right] = range(x, level_width, width);
        const auto [low, high] = range(y, level_height, height);
        for (std::int64_t j = low; j < high; ++j)
            for (std::int64_t i = left; i < right; ++i) shows[wrapped(j, height) * width + wrapped(i, width)] = true;
    }
};

/// Between which two texels of `count` the middle and both ends of each of `parts` equal parts lie, and how near to the second.
struct Between {
    std::uint32_t first = 0, second = 0;
    float share = 0;
};
std::vector<Between> places_between(std::uint32_t parts, std::uint32_t count) {
    std::vector<Between> places(std::size_t{2} * parts + 1);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double at = static_cast<double>(i) / (2.0 * parts) * count - 0.5, below = std::floor(at);
        const auto first = static_cast<std::uint32_t>((static_cast<std::int64_t>(below) + count) % count);
        places[i] = {first, (first + 1) % count, static_cast<float>(at - below)};
    }
    return places;
}

/// Marks where a mip level shows something. Its alpha is highest at a texel's middle, on the middle of an edge, or in a corner.
/// For levels that are no larger than the shape.
void add_level(const std::byte* rgba, std::uint32_t width, std::uint32_t height, float needed, Marks& marks) {
    const std::vector<Between> across = places_between(marks.width, width), down = places_between(marks.height, height);
    for (std::size_t y = 0; y < down.size(); ++y) {
        const std::byte *low = rgba + std::size_t{4} * down[y].first * width,
                        *high = rgba + std::size_t{4} * down[y].second * width;
        for (std::size_t x = 0; x < across.size(); ++x) {
            const auto along = [&](const std::byte* row) {
                const auto a = static_cast<float>(std::to_integer<int>(row[std::size_t{4} * across[x].first + 3]));
                const auto b = static_cast<float>(std::to_integer<int>(row[std::size_t{4} * across[x].second + 3]));
                return a + (b - a) * across[x].share;
            };
            constexpr float rounding = 0.5F;
            const float below = along(low);
            if (below + (along(high) - below) * down[y].share < needed - rounding) continue;
            // A place within a texel, or between two.
            for (std::size_t j = y > 0 ? (y - 1) / 2 : 0; j <= y / 2 && j < marks.height; ++j)
                for (std::size_t i = x > 0 ? (x - 1) / 2 : 0; i <= x / 2 && i < marks.width; ++i)
                    marks.shows[j * marks.width + i] = true;
        }
    }
}

MaskShape shape_of(const Marks& marks) {
    const auto nothing = static_cast<std::uint16_t>(marks.width);
    MaskShape shape{marks.width, marks.height, {}, {}};
    shape.next.resize(marks.shows.size());
    shape.last.resize(marks.shows.size());
    for (std::size_t row = 0; row < marks.shows.size(); row += marks.width) {
        std::uint16_t found = nothing;
        for (std::uint32_t x = 0; x < marks.width; ++x) {
            if (marks.shows[row + x]) found = static_cast<std::uint16_t>(x);
            shape.last[row + x] = found;
        }
        found = nothing;
        for (std::uint32_t x = marks.width; x-- > 0;) {
            if (marks.shows[row + x]) found = static_cast<std::uint16_t>(x);
            shape.next[row + x] = found;
        }
    }
    return shape;
}

/// needed: the alpha, 0..255, from which something shows.
MaskShape mask_shape(const model::Model& model, const model::Texture& texture, float needed) {
    Marks marks{texture.width, texture.height, {}};
    while (marks.width > max_shape_side) marks.width = (marks.width + 1) / 2;
    while (marks.height > max_shape_side) marks.height = (marks.height + 1) / 2;
    marks.shows.assign(std::size_t{marks.width} * marks.height, false);
    const std::byte* rgba = model.texels.data() + texture.first_byte;
    std::uint32_t width = texture.width, height = texture.height;
    for (std::uint32_t level = 0; level < std::min(shape_levels, texture.levels); ++level) {
        const bool fits = width <= marks.width && height <= marks.height;
        if (fits) add_level(rgba, width, height, needed, marks);
        for (std::uint32_t y = 0; y < height && !fits; ++y) {
            for (std::uint32_t x = 0; x < width; ++x)
                if (static_cast<float>(std::to_integer<int>(rgba[std::size_t{4} * (std::size_t{y} * width + x) + 3])) >= needed)
                    marks.add(x, y, width, height);
        }
        rgba += std::size_t{4} * width * height;
        width = std::max(1U, width / 2);
        height = std::max(1U, height / 2);
    }
    return shape_of(marks);
}

}  // namespace

MaskShapes::MaskShapes(const model::Model& model, const std::vector<bool>& wanted) {
    std::map<std::pair<model::Index, float>, std::size_t> known;
    of_material_.assign(model.materials.size(), ~std::size_t{0});
    for (std::size_t m = 0; m < std::min(wanted.size(), model.materials.size()); ++m) {
        const model::Material& material = model.materials[m];
        if (!wanted[m] || material.alpha != model::AlphaMode::mask || material.texture == model::none) continue;
        const model::Texture& texture = model.textures[material.texture];
        if (texture.clamp) continue;  // beyond its border the picture goes on for ever
        const float needed = 255.0F * material.alpha_cutoff / std::max(material.colour[3], 1e-6F);
        const auto [at, fresh] = known.try_emplace({material.texture, needed}, shapes_.size());
        if (fresh) shapes_.push_back(mask_shape(model, texture, needed));
        of_material_[m] = at->second;
    }
}

}  // namespace surefoot::bake
