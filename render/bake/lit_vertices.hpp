// The vertices that light is measured for: which parts use them, where they stand, and where rays from them begin.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::bake {

/// Chains share their vertices: one array of the model, the parts over it, and where it stands.
struct VertexRange {
    std::uint32_t first = 0, count = 0;
    std::vector<model::Index> parts;       ///< lit ones
    std::vector<model::Index> placements;  ///< at most four, spread over all
    bool two_sided = false, all_places = true;
};

/// Where rays of a vertex begin, and which way its front looks. In the range's own frame.
struct RayStart {
    vec3 at{0.0F}, inwards{0.0F}, normal{0.0F};
    bool used = false;  ///< by a lit triangle
};

/// The same in the world: a little off the border of its triangles, on the surface.
struct PlacedStart {
    dvec3 at{0.0}, normal{0.0};
};

/// Some vertices of a range: what one task measures.
struct VertexTask {
    std::uint32_t range, from, to;
};

constexpr double ray_lift_m = 0.02;  ///< off the surface that a vertex is on

/// Of the parts whose materials have any of these effects.
std::vector<VertexRange> lit_ranges(const model::Model& model, model::EffectMask any_of);
/// One for each vertex of the range.
std::vector<RayStart> ray_starts(const model::Model& model, const VertexRange& range);
std::vector<VertexTask> vertex_tasks(const std::vector<VertexRange>& ranges);
/// None where faces cancel each other: nothing is known there.
std::optional<PlacedStart> placed_start(const RayStart& start, const model::Placement& place);

/// What a vertex within something takes: the mean of others, which are filled before it.
struct VertexFill {
    std::uint32_t vertex = 0;
    std::vector<std::uint32_t> from;
};

/// For vertices of a range that lie within other things: by lit triangles that reach out of them. Where none does, the nearest
/// known vertex within 3 m that looks the same way serves. Those that have none are left out. unknown: by vertex of the range.
std::vector<VertexFill> vertex_fills(const model::Model& model, const VertexRange& range, const std::vector<bool>& unknown);

}  // namespace surefoot::bake
