// Judging a stand-in, and its place among the levels (stand_ins.hpp).
#include "render/bake/stand_ins.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/bake/mesh_surface.hpp"
#include "render/bake/objects.hpp"
#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {

namespace {

/// How far a stand-in may reach beyond its object, as a share of the object's diagonal.
constexpr double max_overhang = 0.1;
/// How far it may be off its object anywhere, as a share of the same: a trunk does not stand for a tree.
constexpr double max_distance = 0.25;
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

/// Why it can be no form of the object, as far as numbers and boxes tell; empty if it can.
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

}  // namespace

void add_stand_ins(LodChain& chain, std::span<const ArtistStandIn> stand_ins, float slack, std::vector<std::string>& notes) {
    const MeshSurface full(chain.full.vertices, chain.levels.back().parts);
    const double diagonal_m = chain.full.box().diagonal();
    measure::DistanceLimits limits;
    limits.relative = slack;
    limits.absolute = static_cast<float>(0.0005 * diagonal_m);
    std::vector<Level> made = std::move(chain.levels), artists;
    for (const ArtistStandIn& one : stand_ins) {
        const auto left_out = [&](const std::string& why) {
            notes.push_back(fmt::format("Stand-in '{}' is left out: {}", one.name, why));
        };
        const MeshSurface coarse(one.geometry.vertices, one.geometry.parts, vec3(one.geometry.centre - chain.full.centre));
        const float distance_m = measure::two_sided_distance(full.view(), coarse.view(), limits).upper;
        const auto triangles = static_cast<std::uint32_t>(one.geometry.triangles());
        const bool same = std::any_of(artists.begin(), artists.end(), [&](const Level& l) { return l.triangles == triangles; });
        if (static_cast<double>(distance_m) > max_distance * diagonal_m)
            left_out(fmt::format("it is {:.3g} m off its object, which is {:.3g} m large", distance_m, diagonal_m));
        else if (same)
            left_out(fmt::format("another one of the same object has {} triangles, too", triangles));
        else  // distance says nothing of its picture
            artists.push_back({append_stand_in(chain.full, one.geometry), triangles,
                               std::max(distance_m, static_cast<float>(min_proxy_error * diagonal_m))});
    }
    Level full_detail = std::move(made.back());
    made.pop_back();
    std::erase_if(made, [&](const Level& level) {
        return std::any_of(artists.begin(), artists.end(), [&](const Level& artist) {
            const double share = static_cast<double>(level.triangles) / artist.triangles;
            return (share >= alike_from && share <= alike_to) || (share >= 1 && level.error_m >= artist.error_m);
        });
    });
    made.insert(made.end(), std::make_move_iterator(artists.begin()), std::make_move_iterator(artists.end()));
    std::sort(made.begin(), made.end(), [](const Level& a, const Level& b) { return a.triangles < b.triangles; });
    made.push_back(std::move(full_detail));
    raise_errors(made);
    chain.levels = std::move(made);
}

std::vector<ArtistStandIn> stand_ins_of(const importer::Scene& scene, importer::Index mesh, const model::Model& model,
                                        const Geometry& object, std::vector<std::string>& notes) {
    std::vector<ArtistStandIn> out;
    for (const importer::StandIn& one : scene.stand_ins) {
        if (one.of != mesh) continue;
        ArtistStandIn made{one.name, mesh_geometry(one.mesh, model)};
        if (const std::string why = why_no_stand_in(made.geometry, object); why.empty())
            out.push_back(std::move(made));
        else
            notes.push_back(fmt::format("Stand-in '{}' is left out: {}", one.name, why));
    }
    return out;
}

}  // namespace surefoot::bake
