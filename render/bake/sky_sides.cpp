// One array of all meshes in full detail, measured place by place.
#include "render/bake/sky_sides.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>

#include "render/bake/lit_vertices.hpp"
#include "render/bake/sky_rays.hpp"

namespace surefoot::bake {

namespace {

constexpr std::size_t max_placed_vertices = std::size_t{48} << 20U;  // a byte each
constexpr std::size_t few_places = 4, samples_of_place = 16;
constexpr double min_room = 0.3;                           // of its reach: what sees less is a gap
constexpr double between_m = 0.5;                          // of points between corners that lie within something
constexpr std::size_t min_between = 4, max_between = 128;  // along a side

/// What is found of a vertex in one place. A side that is within something takes what its neighbours see.
constexpr std::uint8_t front_open = 1, back_open = 2, any_open = 3, front_within = 4, back_within = 8, has_room = 16;

/// A mesh of the flat model, and what its vertices see.
struct Sided {
    VertexRange range;
    std::vector<RayStart> starts;
    std::vector<bool> shows_back;                  ///< by vertex
    std::vector<std::vector<std::uint8_t>> found;  ///< by place, by vertex
};

class SideFinder {
public:
    SideFinder(std::span<const MeshInPlaces> meshes, const std::vector<model::Material>& materials, const RayTree& opaque,
               double far_m);
    [[nodiscard]] std::size_t size() const { return sided_.size(); }
    void find_starts(std::size_t m);
    void measure(std::size_t m, std::size_t place);
    [[nodiscard]] SkySides take(std::size_t m);
    /// Instead of measure() and take().
    [[nodiscard]] bool is_closed(std::size_t m, std::size_t place);

private:
    [[nodiscard]] bool is_closed_between(const Sided& sided, std::size_t place, const std::uint32_t* corner, bool front) const;
    void add(const MeshInPlaces& mesh);
    void measure(Sided& sided, std::size_t place, std::uint32_t vertex) const;
    [[nodiscard]] std::uint8_t seen_on(const dvec3& at, const dvec3& normal, std::uint8_t open, std::uint8_t within) const;
    void fill(Sided& sided, std::size_t place) const;

    model::Model flat_;
    SkyRays rays_;
    std::vector<Sided> sided_;
};

SideFinder::SideFinder(std::span<const MeshInPlaces> meshes, const std::vector<model::Material>& materials, const RayTree& opaque,
                       double far_m)
    : rays_(opaque, far_m) {
    flat_.materials = materials;
    for (const MeshInPlaces& mesh : meshes) add(mesh);
}

void SideFinder::add(const MeshInPlaces& mesh) {
    Sided sided;
    VertexRange& range = sided.range;
    const Geometry& g = *mesh.geometry;
    range.first = static_cast<std::uint32_t>(flat_.vertices.size());
    range.count = static_cast<std::uint32_t>(g.vertices.size());
    for (const dmat4& world : mesh.places) {
        range.placements.push_back(static_cast<model::Index>(flat_.placements.size()));
        flat_.placements.push_back({dvec3(world * dvec4(g.centre, 1.0)), mat3(dmat3(world))});
    }
    for (const GeometryPart& part : g.parts) {
        const model::Material& material = flat_.materials[part.material];
        if ((material.effects & model::effect_sun) == 0) continue;
        range.parts.push_back(static_cast<model::Index>(flat_.parts.size()));
        range.two_sided = range.two_sided || material.two_sided;
        flat_.parts.push_back({part.material, static_cast<std::uint32_t>(flat_.indices.size()),
                               static_cast<std::uint32_t>(part.indices.size()), range.first, range.count});
        flat_.indices.insert(flat_.indices.end(), part.indices.begin(), part.indices.end());
    }
    if (!range.parts.empty()) flat_.vertices.insert(flat_.vertices.end(), g.vertices.begin(), g.vertices.end());
    sided_.push_back(std::move(sided));
}

void SideFinder::find_starts(std::size_t m) {
    Sided& sided = sided_[m];
    if (sided.range.parts.empty()) return;
    sided.starts = ray_starts(flat_, sided.range);
    sided.shows_back.assign(sided.range.count, false);
    for (const model::Index p : sided.range.parts) {
        const model::Part& part = flat_.parts[p];
        if (!flat_.materials[part.material].two_sided) continue;
        for (std::uint32_t i = 0; i < part.index_count; ++i) sided.shows_back[flat_.indices[part.first_index + i]] = true;
    }
    sided.found.assign(sided.range.placements.size(), {});
}

std::uint8_t SideFinder::seen_on(const dvec3& at, const dvec3& normal, std::uint8_t open, std::uint8_t within) const {
    const std::optional<double> room = rays_.room_without_sky(at, normal);
    if (!room) return open;
    if (SkyRays::hidden_byte(*room) >= within_share) return within;
    return *room >= min_room ? has_room : std::uint8_t{0};
}

void SideFinder::measure(Sided& sided, std::size_t place, std::uint32_t vertex) const {
    std::uint8_t& found = sided.found[place][vertex];
    const RayStart& start = sided.starts[vertex];
    const std::optional<PlacedStart> placed =
        start.used ? placed_start(start, flat_.placements[sided.range.placements[place]]) : std::nullopt;
    if (!placed) {  // nothing is known, and nothing is hidden
        found = any_open;
        return;
    }
    found = seen_on(placed->at, placed->normal, front_open, front_within);
    if (!sided.shows_back[vertex]) return;
    if (found == front_open)
        found |= back_open;  // its triangles are in the open whatever their back sees
    else
        found |= seen_on(placed->at, -placed->normal, back_open, back_within);
}

void SideFinder::measure(std::size_t m, std::size_t place) {
    Sided& sided = sided_[m];
    const std::uint32_t count = sided.range.count;
    if (sided.range.parts.empty()) return;
    sided.found[place].assign(count, 0);
    if (sided.range.placements.size() > few_places && count > samples_of_place) {
        // Of thousands of trees none is closed: some vertices tell.
        bool any_closed = false;
        for (std::size_t i = 0; i < samples_of_place && !any_closed; ++i) {
            const auto v = static_cast<std::uint32_t>(i * (count - 1) / (samples_of_place - 1));
            if (!sided.starts[v].used) continue;
            measure(sided, place, v);
            any_closed = (sided.found[place][v] & (any_open)) == 0;
        }
        if (!any_closed) {
            std::fill(sided.found[place].begin(), sided.found[place].end(), any_open);
            return;
        }
    }
    for (std::uint32_t v = 0; v < count; ++v) measure(sided, place, v);
    fill(sided, place);
}

void SideFinder::fill(Sided& sided, std::size_t place) const {
    std::vector<std::uint8_t>& found = sided.found[place];
    for (const bool front : {true, false}) {
        const std::uint8_t open = front ? front_open : back_open, within = front ? front_within : back_within;
        std::vector<bool> unknown(sided.range.count, false);
        for (std::uint32_t v = 0; v < sided.range.count; ++v) unknown[v] = (found[v] & within) != 0;
        for (const VertexFill& one : vertex_fills(flat_, sided.range, unknown))
            if (std::any_of(one.from.begin(), one.from.end(), [&](std::uint32_t v) { return (found[v] & open) != 0; }))
                found[one.vertex] |= open;
    }
}

/// Ends at the first vertex that sees sky. Light is measured at vertices, so what lies between two that see no sky is dark in any
/// case. One within something takes its light from its neighbours: points between tell there.
bool SideFinder::is_closed(std::size_t m, std::size_t place) {
    Sided& sided = sided_[m];
    if (sided.range.parts.empty()) return false;
    std::vector<std::uint8_t>& found = sided.found[place];
    found.assign(sided.range.count, 0);
    for (std::uint32_t v = 0; v < sided.range.count; ++v) {
        measure(sided, place, v);
        if ((found[v] & any_open) != 0) return false;
    }
    for (const model::Index p : sided.range.parts) {
        const model::Part& part = flat_.parts[p];
        for (std::uint32_t i = part.first_index; i + 2 < part.first_index + part.index_count; i += 3) {
            const std::uint32_t* corner = &flat_.indices[i];
            const auto within = static_cast<std::uint8_t>(found[corner[0]] | found[corner[1]] | found[corner[2]]);
            if ((within & front_within) != 0 && !is_closed_between(sided, place, corner, true)) return false;
            if ((within & back_within) != 0 && !is_closed_between(sided, place, corner, false)) return false;
        }
    }
    return true;
}

/// Of one side of a triangle: whether no point of a grid over it sees sky. A triangle that is too large counts as open.
bool SideFinder::is_closed_between(const Sided& sided, std::size_t place, const std::uint32_t* corner, bool front) const {
    const model::Placement& at = flat_.placements[sided.range.placements[place]];
    std::array<dvec3, 3> corners;
    RayStart mean;
    for (std::size_t k = 0; k < 3; ++k) {
        const RayStart& start = sided.starts[corner[k]];
        corners[k] = at.origin + dmat3(at.linear) * dvec3(start.at);
        mean.normal += start.normal;
    }
    const std::optional<PlacedStart> placed = placed_start(mean, at);
    const dvec3 along = corners[1] - corners[0], across = corners[2] - corners[0];
    const double longest_m = std::max({glm::length(along), glm::length(across), glm::length(across - along)});
    if (!placed || !(longest_m <= max_between * between_m)) return false;
    const dvec3 normal = front ? placed->normal : -placed->normal;
    const auto rows = std::max(min_between, static_cast<std::size_t>(std::ceil(longest_m / between_m)));
    const auto share = [&](std::size_t n) { return (static_cast<double>(n) + 1.0 / 3) / static_cast<double>(rows); };
    for (std::size_t i = 0; i < rows; ++i)
        for (std::size_t k = 0; k + i < rows; ++k)
            if (rays_.sees_sky(corners[0] + share(i) * along + share(k) * across, normal)) return false;
    return true;
}

SkySides SideFinder::take(std::size_t m) {
    Sided& sided = sided_[m];
    SkySides out;
    if (sided.range.parts.empty()) return out;
    out.vertices = sided.range.count;
    out.places = sided.found.size();
    out.open.reserve(out.vertices * out.places);
    out.roomy.assign(out.vertices, 1);
    for (const std::vector<std::uint8_t>& found : sided.found)
        for (std::size_t v = 0; v < out.vertices; ++v) {
            const bool open = (found[v] & (any_open)) != 0;
            out.open.push_back(open ? 1 : 0);
            if (!open && (found[v] & has_room) == 0) out.roomy[v] = 0;
        }
    sided = {};
    return out;
}

}  // namespace

std::size_t sky_steps(std::span<const MeshInPlaces> meshes) {
    std::size_t steps = 0;
    for (const MeshInPlaces& mesh : meshes) steps += mesh.places.size();
    return steps;
}

namespace {

double far_from(std::span<const MeshInPlaces> meshes) {
    Box all;
    for (const MeshInPlaces& mesh : meshes)
        for (const dmat4& world : mesh.places)
            for (const model::Vertex& v : mesh.geometry->vertices)
                all.grow(dvec3(world * dvec4(mesh.geometry->centre + dvec3(position_of(v)), 1.0)));
    return all.empty() ? 0 : 2 * all.diagonal();
}

/// For each mesh in each place, large meshes first; on many threads.
using MeasurePlace = std::function<void(std::size_t mesh, std::size_t place)>;

/// False: `step` ended it.
bool for_places(std::span<const MeshInPlaces> meshes, const ForAll& for_all, const std::function<bool()>& step,
                const MeasurePlace& measure) {
    std::vector<std::pair<std::size_t, std::size_t>> tasks;
    for (std::size_t m = 0; m < meshes.size(); ++m)
        for (std::size_t p = 0; p < meshes[m].places.size(); ++p) tasks.emplace_back(m, p);
    std::stable_sort(tasks.begin(), tasks.end(), [&](const auto& a, const auto& b) {
        return meshes[a.first].geometry->vertices.size() > meshes[b.first].geometry->vertices.size();
    });
    std::atomic<bool> go{true};
    for_all(tasks.size(), [&](std::size_t t) {
        if (!go) return;
        measure(tasks[t].first, tasks[t].second);
        if (!step()) go = false;
    });
    return go;
}

bool are_too_many(std::span<const MeshInPlaces> meshes) {
    std::size_t placed = 0;
    for (const MeshInPlaces& mesh : meshes) placed += mesh.places.size() * mesh.geometry->vertices.size();
    return placed > max_placed_vertices;
}

}  // namespace

std::vector<SkySides> find_sky_sides(std::span<const MeshInPlaces> meshes, const std::vector<model::Material>& materials,
                                     const RayTree& opaque, const ForAll& for_all, const std::function<bool()>& step) {
    std::vector<SkySides> out(meshes.size());
    if (are_too_many(meshes)) return out;
    SideFinder finder(meshes, materials, opaque, far_from(meshes));
    for_all(meshes.size(), [&](std::size_t m) { finder.find_starts(m); });
    const auto measure = [&](std::size_t m, std::size_t place) { finder.measure(m, place); };
    if (for_places(meshes, for_all, step, measure)) for_all(meshes.size(), [&](std::size_t m) { out[m] = finder.take(m); });
    return out;
}

std::vector<std::vector<bool>> find_closed(std::span<const MeshInPlaces> meshes, const std::vector<model::Material>& materials,
                                           const RayTree& opaque, double far_m, const ForAll& for_all,
                                           const std::function<bool()>& step) {
    if (are_too_many(meshes)) return std::vector<std::vector<bool>>(meshes.size());
    SideFinder finder(meshes, materials, opaque, far_m);
    for_all(meshes.size(), [&](std::size_t m) { finder.find_starts(m); });
    std::vector<std::vector<std::uint8_t>> closed(meshes.size());
    for (std::size_t m = 0; m < meshes.size(); ++m) closed[m].assign(meshes[m].places.size(), 0);
    const auto measure = [&](std::size_t m, std::size_t place) { closed[m][place] = finder.is_closed(m, place) ? 1 : 0; };
    std::vector<std::vector<bool>> out(meshes.size());
    if (!for_places(meshes, for_all, step, measure)) closed.assign(meshes.size(), {});
    for (std::size_t m = 0; m < meshes.size(); ++m) out[m].assign(closed[m].begin(), closed[m].end());
    return out;
}

}  // namespace surefoot::bake
