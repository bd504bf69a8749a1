// Objects with their geometry (objects.hpp).
#include "render/bake/objects.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include <fmt/format.h>

#include "render/bake/baked_colours.hpp"
#include "render/bake/level_coverage.hpp"
#include "render/bake/prisms.hpp"

namespace surefoot::bake {

double largest_stretch(const dmat3& linear) {
    // Largest eigenvalue of the symmetric product, by its characteristic cubic's cosine form: a rigid placement gives 1, not
    // nearly 1, so that errors of shared forms stay in order.
    const dmat3 s = glm::transpose(linear) * linear;
    const double mean = (s[0][0] + s[1][1] + s[2][2]) / 3.0;
    const dmat3 off = s - dmat3(mean);
    double squares = 0;
    for (int i = 0; i < 3; ++i) squares += glm::dot(off[i], off[i]);
    const double spread = std::sqrt(squares / 6.0);
    double eigen = mean;
    if (spread > 0) {
        const double r = std::clamp(0.5 * glm::determinant(off / spread), -1.0, 1.0);
        eigen += 2.0 * spread * std::cos(std::acos(r) / 3.0);
    }
    return std::sqrt(std::max(eigen, 0.0)) * (1.0 + 1e-9);
}

Geometry mesh_geometry(const importer::Mesh& mesh, const model::Model& model) {
    Geometry g;
    Box box;
    for (const importer::Primitive& p : mesh.primitives) {
        for (const vec3& v : p.positions) box.grow(dvec3(v));
    }
    if (box.empty()) return g;
    g.centre = box.centre();
    for (const importer::Primitive& p : mesh.primitives) {
        if (p.indices.empty()) continue;
        const auto base = static_cast<std::uint32_t>(g.vertices.size());
        for (std::size_t i = 0; i < p.positions.size(); ++i) {
            model::Vertex v{};
            const dvec3 at = dvec3(p.positions[i]) - g.centre;
            const vec3 n = p.normals.empty() ? vec3(0, 1, 0) : p.normals[i];
            for (int k = 0; k < 3; ++k) {
                v.position[k] = static_cast<float>(at[k]);
                v.normal[k] = static_cast<std::int8_t>(std::lround(127.0F * std::clamp(n[k], -1.0F, 1.0F)));
            }
            for (std::size_t k = 0; k < 4; ++k) v.colour[k] = p.colours.empty() ? 255 : p.colours[i][k];
            if (!p.uvs.empty()) {
                v.uv[0] = p.uvs[i].x;
                v.uv[1] = p.uvs[i].y;
            }
            g.vertices.push_back(v);
        }
        const auto baked = baked_colours(model, p, std::span(g.vertices).subspan(base));
        g.baked.insert(g.baked.end(), baked.begin(), baked.end());
        GeometryPart part{p.material, p.indices};
        for (std::uint32_t& index : part.indices) index += base;
        const auto same =
            std::find_if(g.parts.begin(), g.parts.end(), [&](const GeometryPart& q) { return q.material == p.material; });
        if (same != g.parts.end()) {
            same->indices.insert(same->indices.end(), part.indices.begin(), part.indices.end());
        } else {
            g.parts.push_back(std::move(part));
        }
    }
    optimise(g);
    return g;
}

namespace {

struct Loose {
    std::uint32_t part, corner[3];
    vec3 centre;  ///< times three
    vec3 area;    ///< seen along each axis
    int facing;   ///< down and up along x, y, z
};

/// Whether triangles with this box and these areas hide each other in layers. The far side of a wall does not count as a layer.
bool hides_itself(const dvec3& size, const dvec3& area) {
    constexpr double layers = 1.25;
    for (int axis = 0; axis < 3; ++axis) {
        const double face = size[(axis + 1) % 3] * size[(axis + 2) % 3];
        if (0.5 * area[axis] > layers * face && face > 0) return true;  // half of it faces the other way
    }
    return false;
}

/// Whether the geometry must be cut, since drawing the whole for a visible part wastes time. It has too many triangles, or it is
/// too long, or it is long, has few triangles, and mostly hides itself.
bool is_cut(std::span<const Loose> triangles, const Geometry& whole, bool few, const CutLimits& limits, dvec3& size) {
    Box box;
    dvec3 area(0.0);
    for (const Loose& t : triangles) {
        for (const std::uint32_t c : t.corner) box.grow(dvec3(position_of(whole.vertices[c])));
        area += dvec3(t.area);
    }
    size = box.max - box.min;
    if (triangles.size() > std::max(limits.max_triangles, 32U)) return true;
    if (std::max({size.x, size.y, size.z}) <= limits.longest_m) return false;
    return triangles.size() >= 2 * limits.min_triangles ||
           (few && triangles.size() >= 2 * limits.min_hidden && hides_itself(size, area));
}

/// Some triangles of a geometry.
struct CutPiece {
    Geometry geometry;
    std::vector<std::uint32_t> used;  ///< vertices of the whole, ascending
};

CutPiece gather(const Geometry& whole, std::span<const Loose> triangles) {
    CutPiece out;
    std::vector<std::uint32_t>& used = out.used;  // a piece's place in it is its new number
    used.reserve(3 * triangles.size());
    for (const Loose& t : triangles) used.insert(used.end(), t.corner, t.corner + 3);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    Geometry& piece = out.geometry;
    piece.centre = whole.centre;
    for (const std::uint32_t vertex : used) {
        piece.vertices.push_back(whole.vertices[vertex]);
        piece.baked.push_back(whole.baked[vertex]);
    }
    for (std::uint32_t p = 0; p < whole.parts.size(); ++p) {
        GeometryPart part{whole.parts[p].material, {}};
        for (const Loose& t : triangles) {
            if (t.part != p) continue;
            for (const std::uint32_t corner : t.corner) {
                const auto at = std::lower_bound(used.begin(), used.end(), corner);
                part.indices.push_back(static_cast<std::uint32_t>(at - used.begin()));
            }
        }
        if (!part.indices.empty()) piece.parts.push_back(std::move(part));
    }
    optimise(piece);
    return out;
}

void cut_range(const Geometry& whole, std::span<Loose> triangles, bool few, const CutLimits& limits, std::vector<CutPiece>& out) {
    dvec3 size;
    if (!is_cut(triangles, whole, few, limits, size)) {
        out.push_back(gather(whole, triangles));
        return;
    }
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.z >= size.y ? 2 : 1;
    const auto half = static_cast<std::ptrdiff_t>(triangles.size() / 2);
    std::nth_element(triangles.begin(), triangles.begin() + half, triangles.end(), [axis](const Loose& a, const Loose& b) {
        if (a.centre[axis] != b.centre[axis]) return a.centre[axis] < b.centre[axis];
        return std::lexicographical_compare(a.corner, a.corner + 3, b.corner, b.corner + 3);
    });
    cut_range(whole, triangles.first(static_cast<std::size_t>(half)), few, limits, out);
    cut_range(whole, triangles.subspan(static_cast<std::size_t>(half)), few, limits, out);
}

}  // namespace

bool has_pictures(const Geometry& geometry, const ChainOptions& options) {
    return std::any_of(geometry.parts.begin(), geometry.parts.end(),
                       [&](const GeometryPart& part) { return options.pictures[part.material] != Picture::none; });
}

CutLimits cut_limits(const MeshInScene& mesh) {
    constexpr double parts_of_scene = 8, parts_if_fine = 100;
    constexpr std::uint64_t max_fine_triangles = 1U << 17U;  // about 2000 pieces
    CutLimits limits;
    limits.max_triangles = mesh.max_triangles;
    limits.stretch = mesh.stretch;
    const bool fine = mesh.textured && mesh.placed_triangles <= max_fine_triangles;
    if (mesh.has_stand_ins) return limits;
    limits.longest_m = mesh.scene_m / (fine ? parts_if_fine : parts_of_scene) / mesh.stretch;
    if (fine) limits.min_triangles = 64;
    return limits;
}

namespace {

std::vector<Loose> loose_triangles(const Geometry& whole) {
    std::vector<Loose> triangles;
    for (std::uint32_t p = 0; p < whole.parts.size(); ++p) {
        const auto& indices = whole.parts[p].indices;
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
            Loose t{p, {indices[i], indices[i + 1], indices[i + 2]}, {}, {}, 0};
            const vec3 a = position_of(whole.vertices[t.corner[0]]), b = position_of(whole.vertices[t.corner[1]]),
                       c = position_of(whole.vertices[t.corner[2]]);
            t.centre = a + b + c;
            const vec3 normal = glm::cross(b - a, c - a);
            t.area = 0.5F * glm::abs(normal);
            const int axis = t.area.x >= t.area.y && t.area.x >= t.area.z ? 0 : t.area.z >= t.area.y ? 2 : 1;
            t.facing = 2 * axis + (normal[axis] > 0 ? 1 : 0);
            triangles.push_back(t);
        }
    }
    return triangles;
}

/// Whether triangles that see no sky are worth pieces of their own: the walls of a room are, the underside of a bench is not.
bool are_walls_of_a_room(std::span<const Loose> closed, const SkySides& sides, double stretch) {
    constexpr std::size_t min_triangles = 16;
    constexpr double min_area_m2 = 4;
    double area_m2 = 0;
    std::size_t roomy = 0;
    for (const Loose& t : closed) {
        area_m2 += static_cast<double>(glm::length(t.area)) * stretch * stretch;
        roomy += std::any_of(t.corner, t.corner + 3, [&](std::uint32_t v) { return sides.roomy[v] != 0; }) ? 1 : 0;
    }
    return (closed.size() >= min_triangles || area_m2 >= min_area_m2) && 2 * roomy > closed.size();
}

/// Puts triangles that see no sky anywhere first, if they become pieces of their own. Returns their number.
std::size_t part_by_sky(std::vector<Loose>& triangles, const SkySides& sides, double stretch) {
    if (sides.empty()) return 0;
    std::vector<Loose> parted;
    const auto open = [&](const Loose& t) {
        return std::any_of(t.corner, t.corner + 3, [&](std::uint32_t v) { return sides.is_open(v); });
    };
    std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(parted), [&](const Loose& t) { return !open(t); });
    const std::size_t closed = parted.size();
    if (closed == 0 || closed == triangles.size() || !are_walls_of_a_room(parted, sides, stretch)) return 0;
    std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(parted), open);
    triangles = std::move(parted);
    return closed;
}

/// Orders triangles by the planes that they lie in, roughly, and returns where each plane ends. What is left over comes last. The
/// outer side of a building in one piece would be a box round all of it, which nothing hides from within.
std::vector<std::size_t> part_by_planes(std::span<Loose> triangles, double stretch) {
    constexpr double apart_m = 0.3, min_area_m2 = 0.25;
    const auto offset = [](const Loose& t) { return t.centre[t.facing / 2]; };
    std::sort(triangles.begin(), triangles.end(), [&](const Loose& a, const Loose& b) {
        if (a.facing != b.facing) return a.facing < b.facing;
        if (offset(a) != offset(b)) return offset(a) < offset(b);
        return std::lexicographical_compare(a.corner, a.corner + 3, b.corner, b.corner + 3);
    });
    std::vector<Loose> parted, rest;
    std::vector<std::size_t> ends;
    for (std::size_t from = 0, to = 0; from < triangles.size(); from = to) {
        double area_m2 = 0;
        for (to = from; to < triangles.size(); ++to) {
            const Loose& t = triangles[to];
            const bool same = to == from || (t.facing == triangles[from].facing &&
                                             static_cast<double>(offset(t) - offset(triangles[to - 1])) * stretch < 3 * apart_m);
            if (!same) break;
            area_m2 += static_cast<double>(glm::length(t.area)) * stretch * stretch;
        }
        const auto group = triangles.subspan(from, to - from);
        std::vector<Loose>& into = area_m2 < min_area_m2 ? rest : parted;
        into.insert(into.end(), group.begin(), group.end());
        if (&into == &parted) ends.push_back(parted.size());
    }
    if (!rest.empty()) ends.push_back(triangles.size());
    std::copy(rest.begin(), rest.end(), std::copy(parted.begin(), parted.end(), triangles.begin()));
    return ends;
}

/// Cuts triangles that see sky, of a mesh whose others are walls of rooms.
void cut_outer_side(const Geometry& whole, std::span<Loose> triangles, bool few, CutLimits limits, std::vector<CutPiece>& out) {
    constexpr double building_m = 8;
    Box box;
    for (const Loose& t : triangles)
        for (const std::uint32_t c : t.corner) box.grow(dvec3(position_of(whole.vertices[c])));
    const dvec3 size = (box.max - box.min) * limits.stretch;
    if (std::max({size.x, size.y, size.z}) < building_m) {
        cut_range(whole, triangles, few, limits, out);
        return;
    }
    limits.longest_m = std::max(limits.longest_m, building_m / limits.stretch);
    limits.min_triangles = std::min(limits.min_triangles, 4U);
    std::size_t from = 0;
    for (const std::size_t end : part_by_planes(triangles, limits.stretch)) {
        cut_range(whole, triangles.subspan(from, end - from), few, limits, out);
        from = end;
    }
}

/// Empty if the whole stays one.
std::vector<CutPiece> cut_by_sky(const Geometry& whole, const CutLimits& limits, const SkySides& sides) {
    std::vector<Loose> triangles = loose_triangles(whole);
    const bool few = triangles.size() < limits.max_hidden;
    std::vector<CutPiece> pieces;
    const std::size_t closed = part_by_sky(triangles, sides, limits.stretch);
    const std::span<Loose> all(triangles);
    dvec3 size;
    if (closed > 0) {
        cut_range(whole, all.first(closed), few, limits, pieces);
        cut_outer_side(whole, all.subspan(closed), few, limits, pieces);
    } else if (is_cut(all, whole, few, limits, size)) {
        cut_range(whole, all, few, limits, pieces);
    }
    return pieces;
}

}  // namespace

std::vector<Geometry> cut(const Geometry& whole, const CutLimits& limits) {
    std::vector<Geometry> out;
    for (CutPiece& piece : cut_by_sky(whole, limits, {})) out.push_back(std::move(piece.geometry));
    return out;
}

namespace {

MeshForm make_form(Geometry geometry, const ChainOptions& options) {
    MeshForm form;
    form.triangles = geometry.triangles();
    const Box local = geometry.box();
    form.box.min = local.min + geometry.centre;
    form.box.max = local.max + geometry.centre;
    form.chain = make_chain(std::move(geometry), options);
    std::vector<Level> poor = take_poor_levels(form.chain, options);
    add_prisms(form.chain, options);
    put_back_poor_level(form.chain, std::move(poor));
    return form;
}

void add_form(MeshForm form, const std::vector<std::uint32_t>& used, const SkySides& sides, std::vector<MeshForm>& out) {
    for (std::size_t p = 0; p < sides.places; ++p)
        form.closed_in.push_back(std::none_of(used.begin(), used.end(), [&](std::uint32_t v) { return sides.is_open(p, v); }));
    out.push_back(std::move(form));
}

std::vector<std::uint32_t> all_vertices(const Geometry& geometry) {
    std::vector<std::uint32_t> out(geometry.vertices.size());
    std::iota(out.begin(), out.end(), 0U);
    return out;
}

}  // namespace

std::vector<MeshForm> make_forms(Geometry geometry, const CutLimits& limits, const ChainOptions& options,
                                 std::span<const ArtistStandIn> stand_ins, std::vector<std::string>* notes,
                                 const SkySides& sides) {
    const SkySides unknown;
    std::vector<CutPiece> pieces = cut_by_sky(geometry, limits, stand_ins.empty() ? sides : unknown);
    std::vector<MeshForm> forms;
    std::vector<std::string> unheard;
    std::vector<std::string>& lines = notes != nullptr ? *notes : unheard;
    if (pieces.empty()) {
        const std::vector<std::uint32_t> used = all_vertices(geometry);
        MeshForm form = make_form(std::move(geometry), options);
        if (!stand_ins.empty()) add_stand_ins(form.chain, stand_ins, options.slack, lines);
        add_form(std::move(form), used, sides, forms);
        return forms;
    }
    for (const ArtistStandIn& one : stand_ins)
        lines.push_back(fmt::format("Stand-in '{}' is left out: its object of {} triangles is cut into {} pieces", one.name,
                                    geometry.triangles(), pieces.size()));
    ChainOptions of_piece = options;
    of_piece.is_piece = true;
    for (CutPiece& piece : pieces) add_form(make_form(std::move(piece.geometry), of_piece), piece.used, sides, forms);
    return forms;
}

std::vector<MeshForm> share_places(std::vector<MeshForm> forms) {
    std::vector<MeshForm> out;
    for (MeshForm& form : forms) {
        std::vector<bool> closed = std::move(form.closed_in);
        const auto count = static_cast<std::size_t>(std::count(closed.begin(), closed.end(), true));
        form.closed = count > 0 && count == closed.size();
        if (count == 0 || form.closed) {
            out.push_back(std::move(form));
            continue;
        }
        MeshForm in_rooms = form;
        in_rooms.closed = true;
        in_rooms.serves = closed;
        closed.flip();
        form.serves = std::move(closed);
        out.push_back(std::move(in_rooms));
        out.push_back(std::move(form));
    }
    return out;
}

Box placed_box(const Box& box, const dmat4& world) {
    Box out;
    for (unsigned c = 0; c < 8; ++c) {
        const dvec3 corner((c & 1U) != 0 ? box.max.x : box.min.x, (c & 2U) != 0 ? box.max.y : box.min.y,
                           (c & 4U) != 0 ? box.max.z : box.min.z);
        out.grow(dvec3(world * dvec4(corner, 1.0)));
    }
    return out;
}

std::vector<PlacedObject> with_forms(const std::vector<PlacedObject>& objects, const std::vector<MeshForm>& forms,
                                     std::span<const std::uint32_t> first, std::span<const std::uint32_t> count) {
    std::vector<std::size_t> places(first.size(), 0);
    std::vector<PlacedObject> placed;
    for (const PlacedObject& object : objects) {
        const std::size_t place = places[object.mesh]++, from = placed.size();
        for (std::uint32_t f = first[object.mesh]; f < first[object.mesh] + count[object.mesh]; ++f) {
            if (!forms[f].serves.empty() && !forms[f].serves[place]) continue;
            PlacedObject one = object;
            one.mesh = f;
            one.box = placed_box(forms[f].box, object.world);
            placed.push_back(std::move(one));
        }
        for (std::size_t i = from; i < placed.size(); ++i) placed[i].piece = placed.size() - from > 1;
    }
    return placed;
}

}  // namespace surefoot::bake
