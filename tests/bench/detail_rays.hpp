// Rays through a model's full detail, holes of masks included. Slow; it shares no code with what draws or bakes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::bench {

/// Where a ray ends.
struct RayHit {
    double away_m = 0;
    dvec3 normal{0.0};  ///< of the triangle's front, unit
    bool pane = false;  ///< what is transparent
};

/// All triangles where they stand at rest. The model must outlive it.
class DetailRays {
public:
    /// shown: what a picture shows, panes included; backs of one-sided materials let rays through. hiding: both sides of all that
    /// is not transparent.
    enum class Sides { shown, hiding };

    explicit DetailRays(const model::Model& model) : model_(model), middle_(model.nodes[0].box.centre()) {
        for (const model::Node& node : model.nodes)
            if (node.child_count == 0) add_form(model.reps[node.first_rep + node.rep_count - 1]);
        build();
    }
    [[nodiscard]] std::size_t triangles() const { return triangles_.size(); }

    /// way: unit.
    [[nodiscard]] std::optional<RayHit> nearest(const dvec3& from, const dvec3& way, Sides sides) const {
        Search s = search(from, way, sides);
        cross(s);
        return hit_of(s);
    }
    [[nodiscard]] bool blocked(const dvec3& from, const dvec3& way) const {
        Search s = search(from, way, Sides::hiding);
        s.any = true;
        cross(s);
        return s.found != model::none;
    }
    /// The same as nearest(), by trying every triangle.
    [[nodiscard]] std::optional<RayHit> tried(const dvec3& from, const dvec3& way, Sides sides) const {
        Search s = search(from, way, sides);
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) meet(s, t);
        return hit_of(s);
    }

private:
    struct Triangle {
        vec3 corner, u, v;  // counter-clockwise as its front shows
        std::uint32_t part;
        std::array<std::uint32_t, 3> vertex;
    };
    struct Node {
        vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
        std::uint32_t first = 0, count = 0;  // of triangles; 0: the first of two children
    };
    struct Search {
        vec3 from, way, inverse;
        Sides sides;
        bool any = false;
        float until = std::numeric_limits<float>::max();
        std::uint32_t found = model::none;
    };

    void add_form(const model::Representation& rep) {
        const model::Placement& place = model_.placements[rep.placement];
        const bool mirrored = glm::determinant(place.linear) < 0;
        for (std::uint32_t p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            const model::Part& part = model_.parts[p];
            for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) {
                std::array<std::uint32_t, 3> vertex{};
                for (std::uint32_t k = 0; k < 3; ++k) vertex[k] = part.first_vertex + model_.indices[part.first_index + i + k];
                if (mirrored) std::swap(vertex[1], vertex[2]);
                std::array<vec3, 3> at;
                for (std::size_t k = 0; k < 3; ++k) {
                    const float* const own = model_.vertices[vertex[k]].position;
                    at[k] = vec3(place.origin - middle_ + dvec3(place.linear * vec3(own[0], own[1], own[2])));
                }
                triangles_.push_back({at[0], at[1] - at[0], at[2] - at[0], p, vertex});
            }
        }
    }

    /// Halves by the middle triangle along the longest side.
    void build() {
        std::vector<std::uint32_t> order(triangles_.size());
        std::iota(order.begin(), order.end(), 0U);
        const auto centre = [&](std::uint32_t t, int axis) {
            const Triangle& of = triangles_[t];
            return of.corner[axis] + (of.u[axis] + of.v[axis]) / 3;
        };
        nodes_.emplace_back().count = static_cast<std::uint32_t>(order.size());
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            const std::uint32_t first = nodes_[n].first, count = nodes_[n].count;
            Node& node = nodes_[n];
            for (std::uint32_t i = first; i < first + count; ++i) {
                const Triangle& t = triangles_[order[i]];
                for (const vec3& corner : {t.corner, t.corner + t.u, t.corner + t.v}) {
                    node.low = glm::min(node.low, corner - 1e-3F);
                    node.high = glm::max(node.high, corner + 1e-3F);
                }
            }
            if (count <= 4) continue;
            const vec3 side = node.high - node.low;
            const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
            const std::uint32_t half = count / 2;
            const auto begin = order.begin() + first;
            std::nth_element(begin, begin + half, begin + count,
                             [&](std::uint32_t a, std::uint32_t b) { return centre(a, axis) < centre(b, axis); });
            node.first = static_cast<std::uint32_t>(nodes_.size());
            node.count = 0;
            for (const bool second : {false, true}) {
                Node& child = nodes_.emplace_back();
                child.first = second ? first + half : first;
                child.count = second ? count - half : half;
            }
        }
        std::vector<Triangle> sorted;
        sorted.reserve(order.size());
        for (const std::uint32_t t : order) sorted.push_back(triangles_[t]);
        triangles_ = std::move(sorted);
    }

    [[nodiscard]] Search search(const dvec3& from, const dvec3& way, Sides sides) const {
        Search s{vec3(from - middle_), vec3(way), vec3(0), sides};
        for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(s.way[axis]) < 1e-12F) s.way[axis] = 1e-12F;
            s.inverse[axis] = 1 / s.way[axis];
        }
        return s;
    }
    [[nodiscard]] std::optional<RayHit> hit_of(const Search& s) const {
        if (s.found == model::none) return {};
        const Triangle& t = triangles_[s.found];
        const bool pane = model_.materials[model_.parts[t.part].material].alpha == model::AlphaMode::blend;
        return RayHit{s.until, glm::normalize(glm::cross(dvec3(t.u), dvec3(t.v))), pane};
    }
    static bool enters(const Search& s, const Node& node) {
        const vec3 a = (node.low - s.from) * s.inverse, b = (node.high - s.from) * s.inverse;
        const vec3 near = glm::min(a, b), far = glm::max(a, b);
        return std::max({near.x, near.y, near.z, 0.0F}) <= std::min({far.x, far.y, far.z, s.until});
    }
    void cross(Search& s) const {
        std::array<std::uint32_t, 128> stack{};
        std::size_t depth = 1;
        while (depth > 0) {
            const Node& node = nodes_[stack[--depth]];
            if (!enters(s, node)) continue;
            for (std::uint32_t t = node.first; t < node.first + node.count; ++t) meet(s, t);
            if (s.any && s.found != model::none) return;
            if (node.count > 0) continue;
            const vec3 between =
                nodes_[node.first + 1].low + nodes_[node.first + 1].high - nodes_[node.first].low - nodes_[node.first].high;
            const std::uint32_t near = glm::dot(between, s.way) < 0 ? 1 : 0;
            stack[depth++] = node.first + 1 - near;
            stack[depth++] = node.first + near;
        }
    }
    /// Möller and Trumbore 1997.
    void meet(Search& s, std::uint32_t index) const {
        const Triangle& t = triangles_[index];
        const vec3 p = glm::cross(s.way, t.v);
        const float area = glm::dot(t.u, p);  // above 0: the front is met
        if (area == 0) return;
        const model::Material& material = model_.materials[model_.parts[t.part].material];
        if (s.sides == Sides::shown ? area < 0 && !material.two_sided : material.alpha == model::AlphaMode::blend) return;
        const vec3 off = s.from - t.corner;
        const float a = glm::dot(off, p) / area;
        if (!(a >= 0 && a <= 1)) return;
        const vec3 q = glm::cross(off, t.u);
        const float b = glm::dot(s.way, q) / area, away = glm::dot(t.v, q) / area;
        if (!(b >= 0 && a + b <= 1 && away > 0 && away < s.until)) return;
        if (material.alpha == model::AlphaMode::mask && alpha(t, material, a, b) < material.alpha_cutoff) return;
        s.until = away;
        s.found = index;
    }
    [[nodiscard]] float alpha(const Triangle& t, const model::Material& material, float a, float b) const {
        const std::array<float, 3> share{1 - a - b, a, b};
        float colour = 0;
        vec2 uv(0);
        for (std::size_t k = 0; k < 3; ++k) {
            const model::Vertex& vertex = model_.vertices[t.vertex[k]];
            colour += share[k] * static_cast<float>(vertex.colour[3]) / 255.0F;
            uv += share[k] * vec2(vertex.uv[0], vertex.uv[1]);
        }
        if ((material.effects & model::effect_vertex_colour) == 0) colour = 1;
        colour *= material.colour[3];
        return material.texture == model::none ? colour : colour * texel_alpha(model_.textures[material.texture], uv);
    }
    /// Bilinear, of the finest level.
    [[nodiscard]] float texel_alpha(const model::Texture& texture, const vec2& uv) const {
        const std::array<std::uint32_t, 2> size{texture.width, texture.height};
        std::array<std::array<std::uint32_t, 2>, 2> at{};
        std::array<float, 2> beyond{};
        for (int axis = 0; axis < 2; ++axis) {
            const auto i = static_cast<std::size_t>(axis);
            const auto texels = static_cast<float>(size[i]);
            const float in = texture.clamp ? std::clamp(uv[axis], 0.0F, 1.0F) : uv[axis] - std::floor(uv[axis]);
            const float first = std::floor(in * texels - 0.5F);
            beyond[i] = in * texels - 0.5F - first;
            for (std::size_t k = 0; k < 2; ++k) {
                const auto wanted = static_cast<std::int64_t>(first) + static_cast<std::int64_t>(k);
                const auto count = static_cast<std::int64_t>(size[i]);
                at[i][k] = static_cast<std::uint32_t>(texture.clamp ? std::clamp<std::int64_t>(wanted, 0, count - 1)
                                                                    : (wanted % count + count) % count);
            }
        }
        float sum = 0;
        for (std::size_t y = 0; y < 2; ++y)
            for (std::size_t x = 0; x < 2; ++x) {
                const std::size_t texel = std::size_t{at[1][y]} * texture.width + at[0][x];
                const auto byte = static_cast<std::uint8_t>(model_.texels[texture.first_byte + 4 * texel + 3]);
                sum += (x == 1 ? beyond[0] : 1 - beyond[0]) * (y == 1 ? beyond[1] : 1 - beyond[1]) * static_cast<float>(byte);
            }
        return sum / 255.0F;
    }

    const model::Model& model_;
    dvec3 middle_;
    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

}  // namespace surefoot::bench
