// Judging a stand-in, and its place among the levels (stand_ins.hpp).
#include "render/bake/stand_ins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "render/bake/mesh_surface.hpp"
#include "render/bake/objects.hpp"
#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {

namespace {

/// How far a stand-in may reach beyond its object, as a share of the object's diagonal.
constexpr double max_overhang = 0.1;
/// Levels with so many times its triangles are no steps of their own.
constexpr double alike_from = 0.8, alike_to = 1.25;

/// The stand-in's vertices behind those of full detail, about the same centre.
std::vector<GeometryPart> append_stand_in(Geometry& full, const Geometry& stand_in) {
    const auto base = static_cast<std::uint32_t>(full.vertices.size());
    const dvec3 shift = stand_in.centre - full.centre;
    for (model::Vertex v : stand_in.vertices) {
        const dvec3 at = dvec3(position_of(v)) + shift;
        for (int k = 0; k < 3; ++k) v.position[k] = static_cast<float>(at[k]);
        full.vertices.push_back(v);
    }
    full.baked.insert(full.baked.end(), stand_in.baked.begin(), stand_in.baked.end());
    std::vector<GeometryPart> parts = stand_in.parts;
    for (GeometryPart& part : parts)
        for (std::uint32_t& index : part.indices) index += base;
    return parts;
}

}  // namespace

std::string why_no_stand_in(const Geometry& stand_in, const Geometry& object) {
    if (stand_in.triangles() == 0) return "it has no triangles";
    if (stand_in.triangles() >= object.triangles())
        return fmt::format("it has {} triangles, and the object {}", stand_in.triangles(), object.triangles());
    const Box own = stand_in.box(), whole = object.box();
    const dvec3 low = whole.min + object.centre - own.min - stand_in.centre,
                high = own.max + stand_in.centre - whole.max - object.centre;
    const double overhang = std::max({low.x, low.y, low.z, high.x, high.y, high.z, 0.0});
    if (overhang > max_overhang * whole.diagonal())
        return fmt::format("it reaches {:.3g} m beyond the object, which is {:.3g} m large", overhang, whole.diagonal());
    return {};
}

void add_stand_in(LodChain& chain, const Geometry& stand_in, float slack) {
    std::vector<Level>& levels = chain.levels;
    const MeshSurface full(chain.full.vertices, levels.back().parts);
    const double diagonal_m = chain.full.box().diagonal();
    Level level{append_stand_in(chain.full, stand_in), static_cast<std::uint32_t>(stand_in.triangles()), 0};
    const MeshSurface coarse(chain.full.vertices, level.parts);
    measure::DistanceLimits limits;
    limits.relative = slack;
    limits.absolute = static_cast<float>(0.0005 * diagonal_m);
    // Distance says nothing of its picture.
    level.error_m = std::max(measure::two_sided_distance(full.view(), coarse.view(), limits).upper,
                             static_cast<float>(min_proxy_error * diagonal_m));
    Level full_detail = std::move(levels.back());
    levels.pop_back();
    std::erase_if(levels, [&](const Level& other) {
        const double share = static_cast<double>(other.triangles) / level.triangles;
        return (share >= alike_from && share <= alike_to) || (share >= 1 && other.error_m >= level.error_m);
    });
    const auto place = std::find_if(levels.begin(), levels.end(), [&](const Level& l) { return l.triangles > level.triangles; });
    levels.insert(place, std::move(level));
    float above_m = 0;  // from fine to coarse, errors rise
    for (std::size_t i = levels.size(); i-- > 0;) {
        above_m = std::nextafter(above_m, std::numeric_limits<float>::infinity());
        levels[i].error_m = above_m = std::max(levels[i].error_m, above_m);
    }
    levels.push_back(std::move(full_detail));
}

std::vector<ArtistStandIn> stand_ins_of(const importer::Scene& scene, importer::Index mesh, const model::Model& model) {
    std::vector<ArtistStandIn> out;
    for (const importer::StandIn& one : scene.stand_ins)
        if (one.of == mesh) out.push_back({one.name, mesh_geometry(one.mesh, model)});
    return out;
}

}  // namespace surefoot::bake
