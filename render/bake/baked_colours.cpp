// Means over corners of triangles: samples on an even grid of each triangle count for the corner that they are nearest to, and
// corners for their vertex by the area of their triangle.
#include "render/bake/baked_colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/bake/materials.hpp"

namespace surefoot::bake {

namespace {

constexpr int steps = 6;  ///< along an edge: 21 samples a triangle, about 7 a corner

/// One mip level of a texture.
struct MipLevel {
    const std::byte* texels;
    std::uint32_t width, height;
    bool clamp;

    [[nodiscard]] std::size_t place(float uv, std::uint32_t size) const {
        const float inside = clamp ? std::clamp(uv, 0.0F, 1.0F) : uv - std::floor(uv);
        return std::min(size - 1, static_cast<std::uint32_t>(inside * static_cast<float>(size)));
    }
    [[nodiscard]] const std::byte* texel(const vec2& uv) const {
        return texels + (place(uv.y, height) * width + place(uv.x, width)) * 4;
    }
    [[nodiscard]] dvec3 at(const vec2& uv) const {
        const std::byte* c = texel(uv);
        return {std::to_integer<int>(c[0]), std::to_integer<int>(c[1]), std::to_integer<int>(c[2])};
    }
};

/// The level whose texels are about as far apart as the samples of a triangle of that area (uv) across its narrower way: a
/// coarser one shows what lies beside the triangle.
MipLevel level_for(const model::Model& model, const model::Texture& texture, const std::array<vec2, 3>& uv) {
    const dvec2 a = dvec2(uv[1]) - dvec2(uv[0]), b = dvec2(uv[2]) - dvec2(uv[0]);
    const double texels = 0.5 * std::abs(a.x * b.y - a.y * b.x) * texture.width * texture.height;
    double wide = std::sqrt(std::max(texels, 0.0)) / steps;
    std::uint64_t at = texture.first_byte;
    std::uint32_t w = texture.width, h = texture.height;
    for (std::uint32_t level = 0; level + 1 < texture.levels && wide > 1.5; ++level, wide *= 0.5) {
        at += static_cast<std::uint64_t>(w) * h * 4;
        w = std::max(1U, w / 2);
        h = std::max(1U, h / 2);
    }
    return {model.texels.data() + at, w, h, texture.clamp};
}

/// Barycentric places on an even grid of a triangle.
template <class Visitor>
void each_sample(const Visitor& visit) {
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; i + j < steps; ++j)
            visit(std::array<float, 3>{(static_cast<float>(i) + 1.0F / 3) / steps, (static_cast<float>(j) + 1.0F / 3) / steps,
                                       (static_cast<float>(steps - 1 - i - j) + 1.0F / 3) / steps});
    }
}

struct Mean {
    dvec3 sum{0.0};
    double weight = 0;
};

void add_triangle(const model::Model& model, const model::Texture& texture, const importer::Primitive& p,
                  std::span<const std::uint32_t, 3> corners, std::vector<Mean>& means) {
    const auto at = [&](int k) { return dvec3(p.positions[corners[static_cast<std::size_t>(k)]]); };
    const double area = 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
    if (!(area > 0) || !std::isfinite(area)) return;
    std::array<vec2, 3> uv;
    for (std::size_t k = 0; k < 3; ++k) uv[k] = p.uvs[corners[k]];
    const MipLevel level = level_for(model, texture, uv);
    std::array<Mean, 3> near;
    each_sample([&](const std::array<float, 3>& share) {
        Mean& corner = near[static_cast<std::size_t>(std::max_element(share.begin(), share.end()) - share.begin())];
        corner.sum += level.at(share[0] * uv[0] + share[1] * uv[1] + share[2] * uv[2]);
        corner.weight += 1;
    });
    for (std::size_t k = 0; k < 3; ++k) {
        means[corners[k]].sum += near[k].sum * (area / near[k].weight);
        means[corners[k]].weight += area;
    }
}

}  // namespace

std::vector<std::array<std::uint8_t, 4>> baked_colours(const model::Model& model, const importer::Primitive& primitive,
                                                       std::span<const model::Vertex> vertices) {
    const model::Material& material = model.materials[primitive.material];
    std::vector<Mean> means(vertices.size());
    if (material.texture != model::none && material.alpha == model::AlphaMode::opaque && !primitive.uvs.empty()) {
        const std::span<const std::uint32_t> indices(primitive.indices);
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
            add_triangle(model, model.textures[material.texture], primitive, indices.subspan(i).first<3>(), means);
    }
    std::vector<std::array<std::uint8_t, 4>> out;
    out.reserve(vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        if (means[v].weight > 0)
            out.push_back(tinted(material, vertices[v], vec3(means[v].sum / means[v].weight)));
        else
            out.push_back(baked_colour(model, material, vertices[v]));
    }
    return out;
}

}  // namespace surefoot::bake
