// Chooses the vertex of each corner by its normal (corners.hpp).
#include "render/bake/corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace surefoot::bake {

namespace {

constexpr double min_aligned_cosine = 0.5;  // of 60 degrees: a normal that is farther from its triangle is across it

/// Of the triangle that begins at `i`; no length where it has no area.
dvec3 facing_of(const Geometry& g, const GeometryPart& part, std::size_t i) {
    const auto at = [&](std::size_t k) { return dvec3(position_of(g.vertices[part.indices[i + k]])); };
    const dvec3 cross = glm::cross(at(1) - at(0), at(2) - at(0));
    const double length = glm::length(cross);
    return length > 0 ? cross / length : dvec3(0.0);
}

/// Cosine between a vertex's normal and the triangle's.
double turn_of(const Geometry& g, std::uint32_t v, const dvec3& facing) {
    const dvec3 n(g.vertices[v].normal[0], g.vertices[v].normal[1], g.vertices[v].normal[2]);
    return glm::dot(n, facing) / std::max(glm::length(n), 1.0);
}

}  // namespace

CoincidentVertices::CoincidentVertices(const Geometry& g) {
    std::vector<std::uint32_t> part(g.vertices.size());
    for (std::uint32_t p = 0; p < g.parts.size(); ++p)
        for (const std::uint32_t v : g.parts[p].indices) part[v] = p;
    order_.resize(g.vertices.size());
    std::iota(order_.begin(), order_.end(), 0U);
    const auto key = [&](std::uint32_t v) {
        const float* p = g.vertices[v].position;
        return std::tuple(p[0], p[1], p[2], part[v], v);
    };
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    range_.resize(order_.size());
    const auto together = [&](std::uint32_t a, std::uint32_t b) {
        return part[a] == part[b] && position_of(g.vertices[a]) == position_of(g.vertices[b]);
    };
    custom_normal_.resize(order_.size());
    for (const GeometryPart& p : g.parts) {
        for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
            const dvec3 facing = facing_of(g, p, i);
            if (facing == dvec3(0.0)) continue;
            for (std::size_t k = 0; k < 3; ++k)
                if (std::abs(turn_of(g, p.indices[i + k], facing)) < min_aligned_cosine) custom_normal_[p.indices[i + k]] = true;
        }
    }
    for (std::uint32_t begin = 0, end = 1; begin < order_.size(); begin = end++) {
        while (end < order_.size() && together(order_[end], order_[begin])) ++end;
        for (std::uint32_t i = begin; i < end; ++i) range_[order_[i]] = {begin, end};
    }
}

void repair_corners(Geometry& g, const CoincidentVertices& coincident, GeometryPart& part) {
    std::map<std::pair<std::uint32_t, std::array<std::int8_t, 3>>, std::uint32_t> turned;
    for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
        const dvec3 facing = facing_of(g, part, i);
        if (facing == dvec3(0.0)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            std::uint32_t& index = part.indices[i + k];
            if (std::abs(turn_of(g, index, facing)) >= min_aligned_cosine || coincident.custom_normal(index)) continue;
            // If front and back of a sheet fit equally well, the front.
            const auto fit = [&](std::uint32_t v) { return std::pair(std::abs(turn_of(g, v, facing)), turn_of(g, v, facing)); };
            for (const std::uint32_t other : coincident.with(index))
                if (fit(other) > fit(index)) index = other;
            if (std::abs(turn_of(g, index, facing)) >= min_aligned_cosine) continue;
            std::array<std::int8_t, 3> normal{};
            for (int c = 0; c < 3; ++c)
                normal[static_cast<std::size_t>(c)] = static_cast<std::int8_t>(std::lround(127.0 * facing[c]));
            const auto [where, fresh] = turned.try_emplace({index, normal}, static_cast<std::uint32_t>(g.vertices.size()));
            if (fresh) {
                model::Vertex v = g.vertices[index];
                std::copy(normal.begin(), normal.end(), v.normal);
                g.vertices.push_back(v);
                const std::array<std::uint8_t, 4> colour = g.baked[index];
                g.baked.push_back(colour);
            }
            index = where->second;
        }
    }
}

}  // namespace surefoot::bake
