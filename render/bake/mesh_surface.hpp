// Positions and indices of parts, in the layout of measure::MeshView.
#pragma once

#include <cstdint>
#include <vector>

#include "render/bake/geometry.hpp"
#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {

/// Owns the arrays that a measure::MeshView points to.
class MeshSurface {
public:
    MeshSurface() = default;
    MeshSurface(const std::vector<model::Vertex>& vertices, const std::vector<GeometryPart>& parts,
                const vec3& moved_by = vec3(0)) {
        add(vertices, parts, moved_by);
    }

    /// Parts over these vertices.
    void add(const std::vector<model::Vertex>& vertices, const std::vector<GeometryPart>& parts, const vec3& moved_by = vec3(0)) {
        const auto base = static_cast<std::uint32_t>(positions_.size());
        positions_.reserve(positions_.size() + vertices.size());
        for (const model::Vertex& v : vertices) positions_.push_back(position_of(v) + moved_by);
        for (const GeometryPart& part : parts)
            for (const std::uint32_t index : part.indices) indices_.push_back(base + index);
    }
    [[nodiscard]] measure::MeshView view() const { return {positions_, indices_}; }

private:
    std::vector<vec3> positions_;
    std::vector<std::uint32_t> indices_;
};

}  // namespace surefoot::bake
