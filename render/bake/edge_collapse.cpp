// Half-edge collapses in the order of their quadric errors (edge_collapse.hpp).
#include "render/bake/edge_collapse.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <queue>
#include <unordered_map>

#include "render/bake/quadrics.hpp"

namespace surefoot::bake {

namespace {

constexpr std::uint32_t no_index = 0xffffffffU;
constexpr double max_cost = 1e300;
/// A place with more triangles is a hub: it stays, and nothing moves onto it. To look all round it again and again would take too
/// long.
constexpr std::size_t max_triangles_around = 64;

/// Two vertices of one material that differ in nothing are one corner.
struct CornerKey {
    model::Vertex vertex;
    model::Index material;
    bool operator==(const CornerKey& o) const {
        using Bits = std::array<std::uint32_t, sizeof(model::Vertex) / sizeof(std::uint32_t)>;
        return material == o.material && std::bit_cast<Bits>(vertex) == std::bit_cast<Bits>(o.vertex);
    }
};

std::uint64_t hash_bytes(const void* data, std::size_t bytes) {
    std::uint64_t h = 0xcbf29ce484222325ULL;
    const auto* at = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) h = (h ^ at[i]) * 0x100000001b3ULL;
    return h ^ (h >> 29U);
}

struct HashCorner {
    std::size_t operator()(const CornerKey& k) const { return hash_bytes(&k.vertex, sizeof(k.vertex)) * 31 + k.material; }
};
struct HashPlace {
    std::size_t operator()(const std::array<float, 3>& p) const { return hash_bytes(p.data(), sizeof(p)); }
};

}  // namespace

struct EdgeCollapse::Mesh {
    struct Corner {
        std::uint32_t vertex, place;
        model::Index material;
        Attributes shown{};
    };
    struct Triangle {
        std::array<std::uint32_t, 3> corner;  ///< dead: no_index
        std::uint32_t part;
    };
    struct Candidate {
        double cost;
        std::uint32_t place, stamp;
        bool operator<(const Candidate& o) const { return cost != o.cost ? cost > o.cost : place > o.place; }
    };
    struct Neighbour {
        std::uint32_t place, triangles;
    };
    /// From a corner that goes to the one that takes its place.
    struct Move {
        std::uint32_t from, to;
    };

    std::span<const model::Vertex> source;
    std::vector<model::Index> materials;
    std::vector<Corner> corners;
    std::vector<AttributeQuadric> looks;  ///< by corner
    std::vector<dvec3> positions;         ///< by place
    std::vector<PlaneQuadric> planes;     ///< by place
    std::vector<bool> fixed;              ///< by place
    std::vector<Triangle> triangles;
    std::vector<std::vector<std::uint32_t>> around;  ///< by place: its living triangles
    std::vector<std::uint32_t> stamps, targets;      ///< by place
    std::priority_queue<Candidate> queue;
    std::uint32_t alive = 0;

    Mesh(std::span<const model::Vertex> vertices, std::span<const GeometryPart> parts, const CollapseOptions& options);
    void add_corners(std::span<const GeometryPart> parts);
    void add_shown(const CollapseOptions& options);
    void add_quadrics(std::uint32_t triangle);
    void add_edges(const CollapseOptions& options);
    [[nodiscard]] std::vector<Neighbour> neighbours(std::uint32_t place) const;
    [[nodiscard]] bool has(const Triangle& t, std::uint32_t place) const {
        return corners[t.corner[0]].place == place || corners[t.corner[1]].place == place || corners[t.corner[2]].place == place;
    }
    [[nodiscard]] std::uint32_t corner_at(const Triangle& t, std::uint32_t place) const {
        for (const std::uint32_t c : t.corner)
            if (corners[c].place == place) return c;
        return no_index;
    }
    bool moves(std::uint32_t p, std::uint32_t q, std::vector<Move>& out) const;
    [[nodiscard]] double cost(std::uint32_t p, std::uint32_t q, const std::vector<Move>& moved) const;
    [[nodiscard]] bool keeps_topology(std::uint32_t p, std::uint32_t q) const;
    [[nodiscard]] bool keeps_sides(std::uint32_t p, std::uint32_t q) const;
    [[nodiscard]] bool allowed(std::uint32_t p, std::uint32_t q) const { return keeps_topology(p, q) && keeps_sides(p, q); }
    void evaluate(std::uint32_t p);
    void collapse(std::uint32_t p, std::uint32_t q, const std::vector<Move>& moved);
};

void EdgeCollapse::Mesh::add_corners(std::span<const GeometryPart> parts) {
    std::unordered_map<CornerKey, std::uint32_t, HashCorner> known;
    std::unordered_map<std::array<float, 3>, std::uint32_t, HashPlace> places;
    for (std::uint32_t p = 0; p < parts.size(); ++p) {
        const GeometryPart& part = parts[p];
        materials.push_back(part.material);
        for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
            Triangle t{{}, p};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t vertex = part.indices[i + k];
                const model::Vertex& v = source[vertex];
                const auto [corner, fresh] =
                    known.try_emplace(CornerKey{v, part.material}, static_cast<std::uint32_t>(corners.size()));
                if (fresh) {
                    // -0 and 0 are one place.
                    const std::array<float, 3> at{v.position[0] + 0.0F, v.position[1] + 0.0F, v.position[2] + 0.0F};
                    const auto [place, first] = places.try_emplace(at, static_cast<std::uint32_t>(positions.size()));
                    if (first) positions.emplace_back(at[0], at[1], at[2]);
                    corners.push_back({vertex, place->second, part.material, {}});
                }
                t.corner[k] = corner->second;
            }
            const std::uint32_t a = corners[t.corner[0]].place, b = corners[t.corner[1]].place, c = corners[t.corner[2]].place;
            if (a != b && b != c && c != a) triangles.push_back(t);  // others show nothing
        }
    }
    alive = static_cast<std::uint32_t>(triangles.size());
    around.resize(positions.size());
    for (std::uint32_t i = 0; i < triangles.size(); ++i)
        for (const std::uint32_t c : triangles[i].corner) around[corners[c].place].push_back(i);
}

/// Attributes in metres: texture coordinates by the mean size of their material's picture on the surface.
void EdgeCollapse::Mesh::add_shown(const CollapseOptions& options) {
    std::vector<double> area(materials.size(), 0.0), texture_area(materials.size(), 0.0);
    Box box;
    for (const dvec3& p : positions) box.grow(p);
    for (const Triangle& t : triangles) {
        std::array<dvec3, 3> p;
        std::array<dvec2, 3> uv;
        for (std::size_t k = 0; k < 3; ++k) {
            const Corner& c = corners[t.corner[k]];
            p[k] = positions[c.place];
            uv[k] = dvec2(source[c.vertex].uv[0], source[c.vertex].uv[1]);
        }
        area[t.part] += glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
        const dvec2 u = uv[1] - uv[0], v = uv[2] - uv[0];
        texture_area[t.part] += std::abs(u.x * v.y - u.y * v.x);
    }
    std::unordered_map<model::Index, double> metres;
    for (std::size_t p = 0; p < materials.size(); ++p)
        metres[materials[p]] = texture_area[p] > 1e-12 ? options.uv_weight * std::sqrt(area[p] / texture_area[p]) : 0.0;
    const double per_normal = options.normal_weight * box.diagonal() / 127,
                 per_colour = options.colour_weight * box.diagonal() / 255;
    for (Corner& c : corners) {
        const model::Vertex& v = source[c.vertex];
        for (std::size_t k = 0; k < 3; ++k) {
            c.shown[k] = per_normal * v.normal[k];
            c.shown[5 + k] = per_colour * v.colour[k];
        }
        for (std::size_t k = 0; k < 2; ++k) c.shown[3 + k] = metres[c.material] * static_cast<double>(v.uv[k]);
    }
}

void EdgeCollapse::Mesh::add_quadrics(std::uint32_t triangle) {
    const Triangle& t = triangles[triangle];
    const dvec3 at = positions[corners[t.corner[0]].place];
    const dvec3 e = positions[corners[t.corner[1]].place] - at, f = positions[corners[t.corner[2]].place] - at;
    const dvec3 n = glm::cross(e, f);
    const double twice = glm::length(n), area = 0.5 * twice / 3;  // a third for each corner
    const double longest2 = std::max({glm::dot(e, e), glm::dot(f, f), glm::dot(e - f, e - f)});
    if (!(twice > 1e-12 * longest2)) return;
    const double plane_offset = -glm::dot(n, at) / twice;
    for (const std::uint32_t c : t.corner) planes[corners[c].place].add_plane(n / twice, plane_offset, area);
    // On a needle, gradients would be huge: there the mean stands for the attribute.
    const bool needle = twice < 0.02 * longest2;
    const double ee = glm::dot(e, e), ef = glm::dot(e, f), ff = glm::dot(f, f), det = twice * twice;
    AttributeQuadric q;
    q.weight = area;
    for (std::size_t i = 0; i < attributes; ++i) {
        const double s0 = corners[t.corner[0]].shown[i], s1 = corners[t.corner[1]].shown[i], s2 = corners[t.corner[2]].shown[i];
        dvec3 g(0.0);
        if (!needle) g = ((ff * (s1 - s0) - ef * (s2 - s0)) * e + (ee * (s2 - s0) - ef * (s1 - s0)) * f) / det;
        q.add_linear(i, g, needle ? (s0 + s1 + s2) / 3 : s0 - glm::dot(g, at), area);
    }
    for (const std::uint32_t c : t.corner) looks[c].add(q);
}

/// Planes through borders and seams, so that these stay where they are; places on fixed borders, and where more than two
/// triangles meet at an edge.
void EdgeCollapse::Mesh::add_edges(const CollapseOptions& options) {
    for (std::uint32_t p = 0; p < positions.size(); ++p) {
        for (const Neighbour& n : neighbours(p)) {
            if (n.triangles > 2) fixed[p] = true;
            if (n.place < p || n.triangles > 2) continue;
            std::array<std::uint32_t, 2> at{no_index, no_index};
            std::size_t found = 0;
            for (const std::uint32_t t : around[p])
                if (found < 2 && has(triangles[t], n.place)) at[found++] = t;
            const Triangle& first = triangles[at[0]];
            const bool border = n.triangles == 1;
            bool seam = false;
            if (!border) {
                const Triangle& second = triangles[at[1]];
                seam = corner_at(first, p) != corner_at(second, p) || corner_at(first, n.place) != corner_at(second, n.place);
            }
            if (border && options.fixed_borders) fixed[p] = fixed[n.place] = true;
            if (!border && !seam) continue;
            const dvec3 along = positions[n.place] - positions[p];
            std::array<dvec3, 3> c;
            for (std::size_t k = 0; k < 3; ++k) c[k] = positions[corners[first.corner[k]].place];
            const dvec3 across = glm::cross(along, glm::cross(c[1] - c[0], c[2] - c[0]));
            const double length = glm::length(across);
            if (!(length > 0)) continue;
            const double weight = (border ? options.border_weight : options.seam_weight) * glm::dot(along, along);
            const double offset = -glm::dot(across, positions[p]) / length;
            for (const std::uint32_t place : {p, n.place}) planes[place].add_plane(across / length, offset, weight);
        }
    }
}

EdgeCollapse::Mesh::Mesh(std::span<const model::Vertex> vertices, std::span<const GeometryPart> parts,
                         const CollapseOptions& options)
    : source(vertices) {
    add_corners(parts);
    add_shown(options);
    looks.resize(corners.size());
    planes.resize(positions.size());
    fixed.resize(positions.size(), false);
    stamps.resize(positions.size(), 0);
    targets.resize(positions.size(), no_index);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) add_quadrics(t);
    add_edges(options);
    for (std::uint32_t p = 0; p < positions.size(); ++p) evaluate(p);
}

std::vector<EdgeCollapse::Mesh::Neighbour> EdgeCollapse::Mesh::neighbours(std::uint32_t place) const {
    std::vector<std::uint32_t> all;
    all.reserve(2 * around[place].size());
    for (const std::uint32_t t : around[place])
        for (const std::uint32_t c : triangles[t].corner)
            if (corners[c].place != place) all.push_back(corners[c].place);
    std::sort(all.begin(), all.end());
    std::vector<Neighbour> out;
    out.reserve(all.size() / 2 + 1);
    for (const std::uint32_t other : all) {
        if (out.empty() || out.back().place != other)
            out.push_back({other, 1});
        else
            ++out.back().triangles;
    }
    return out;
}

/// Which corner at q takes the place of each corner at p. A corner that shares a triangle with the edge goes to that triangle's
/// other corner; any other goes to what looks most alike. False: none at q has its material.
bool EdgeCollapse::Mesh::moves(std::uint32_t p, std::uint32_t q, std::vector<Move>& out) const {
    out.clear();
    for (const std::uint32_t t : around[p]) {
        const std::uint32_t from = corner_at(triangles[t], p), to = corner_at(triangles[t], q);
        if (to == no_index) continue;
        if (std::none_of(out.begin(), out.end(), [&](const Move& m) { return m.from == from; })) out.push_back({from, to});
    }
    for (const std::uint32_t t : around[p]) {
        const std::uint32_t from = corner_at(triangles[t], p);
        if (std::any_of(out.begin(), out.end(), [&](const Move& m) { return m.from == from; })) continue;
        std::uint32_t best = no_index;
        double difference = 0;
        for (const std::uint32_t other : around[q]) {
            const std::uint32_t to = corner_at(triangles[other], q);
            if (corners[to].material != corners[from].material || to == best) continue;
            const double d = looks[from].at(positions[q], corners[to].shown);
            if (best == no_index || d < difference) {
                best = to;
                difference = d;
            }
        }
        if (best == no_index) return false;
        out.push_back({from, best});
    }
    return true;
}

double EdgeCollapse::Mesh::cost(std::uint32_t p, std::uint32_t q, const std::vector<Move>& moved) const {
    double sum = planes[p].at(positions[q]);
    for (const Move& m : moved) sum += looks[m.from].at(positions[q], corners[m.to].shown);
    // Of steps that cost nothing, the shortest comes first.
    const dvec3 step = positions[q] - positions[p];
    const double length2 = glm::dot(step, step);
    const double all = std::max(sum, 0.0) + 1e-9 * length2 * length2;
    return all < max_cost ? all : max_cost;  // one that is not finite, too
}

/// A border moves only along itself; p and q have no neighbours in common but those at their edge; nothing vanishes or folds
/// flat.
bool EdgeCollapse::Mesh::keeps_topology(std::uint32_t p, std::uint32_t q) const {
    if (around[p].size() > max_triangles_around || around[q].size() > max_triangles_around) return false;
    const std::vector<Neighbour> of_p = neighbours(p), of_q = neighbours(q);
    std::uint32_t at_edge = 0, borders = 0;
    for (const Neighbour& n : of_p) {
        borders += n.triangles == 1 ? 1 : 0;
        if (n.place == q) at_edge = n.triangles;
        if (n.triangles > 2) return false;
    }
    if (at_edge == 0) return false;
    if (borders > 0 && (borders != 2 || at_edge != 1)) return false;
    std::vector<std::uint32_t> common;
    for (const Neighbour& n : of_p)
        if (std::any_of(of_q.begin(), of_q.end(), [&](const Neighbour& m) { return m.place == n.place; }))
            common.push_back(n.place);
    if (common.size() != at_edge) return false;
    if (around[p].size() == at_edge && around[q].size() == at_edge) return false;  // nothing would be left
    // Where each has a triangle with both common neighbours, these would lie on each other: a tetrahedron.
    const auto closes = [&](std::uint32_t place) {
        return std::any_of(around[place].begin(), around[place].end(),
                           [&](std::uint32_t t) { return has(triangles[t], common[0]) && has(triangles[t], common[1]); });
    };
    return at_edge != 2 || !closes(p) || !closes(q);
}

/// No triangle turns over or becomes a line.
bool EdgeCollapse::Mesh::keeps_sides(std::uint32_t p, std::uint32_t q) const {
    for (const std::uint32_t i : around[p]) {
        const Triangle& t = triangles[i];
        if (has(t, q)) continue;
        std::array<dvec3, 3> before, after;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t place = corners[t.corner[k]].place;
            before[k] = positions[place];
            after[k] = positions[place == p ? q : place];
        }
        const dvec3 n = glm::cross(before[1] - before[0], before[2] - before[0]);
        const dvec3 m = glm::cross(after[1] - after[0], after[2] - after[0]);
        if (glm::dot(n, m) < 0.3 * glm::length(n) * glm::length(m)) return false;
        const dvec3 a = after[1] - after[0], b = after[2] - after[0];
        if (!(glm::length(m) > 1e-4 * std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(b - a, b - a)}))) return false;
    }
    return true;
}

/// Finds the cheapest step of a place and queues it.
void EdgeCollapse::Mesh::evaluate(std::uint32_t p) {
    ++stamps[p];
    targets[p] = no_index;
    if (fixed[p] || around[p].empty() || around[p].size() > max_triangles_around) return;
    std::vector<std::pair<double, std::uint32_t>> collapses;
    std::vector<Move> moved;
    for (const Neighbour& n : neighbours(p))
        if (around[n.place].size() <= max_triangles_around && moves(p, n.place, moved))
            collapses.emplace_back(cost(p, n.place, moved), n.place);
    std::sort(collapses.begin(), collapses.end());
    for (const auto& [costs, q] : collapses) {
        if (!allowed(p, q)) continue;
        targets[p] = q;
        queue.push({costs, p, stamps[p]});
        return;
    }
}

void EdgeCollapse::Mesh::collapse(std::uint32_t p, std::uint32_t q, const std::vector<Move>& moved) {
    planes[q].add(planes[p]);
    for (const Move& m : moved) looks[m.to].add(looks[m.from]);
    const std::vector<std::uint32_t> old = std::move(around[p]);
    around[p].clear();
    for (const std::uint32_t i : old) {
        Triangle& t = triangles[i];
        if (has(t, q)) {
            for (const std::uint32_t c : t.corner)
                if (corners[c].place != p) std::erase(around[corners[c].place], i);
            t.corner.fill(no_index);
            --alive;
            continue;
        }
        for (std::uint32_t& c : t.corner) {
            if (corners[c].place != p) continue;
            c = std::find_if(moved.begin(), moved.end(), [&](const Move& m) { return m.from == c; })->to;
        }
        around[q].push_back(i);
    }
    ++stamps[p];
    const std::vector<Neighbour> changed = neighbours(q);
    evaluate(q);
    for (const Neighbour& n : changed) evaluate(n.place);
}

EdgeCollapse::EdgeCollapse(std::span<const model::Vertex> vertices, std::span<const GeometryPart> parts,
                           const CollapseOptions& options)
    : mesh_(std::make_unique<Mesh>(vertices, parts, options)) {}

EdgeCollapse::~EdgeCollapse() = default;

std::uint32_t EdgeCollapse::reduce_to(std::uint32_t triangles) {
    Mesh& m = *mesh_;
    std::vector<Mesh::Move> moved;
    while (m.alive > triangles && !m.queue.empty()) {
        const Mesh::Candidate next = m.queue.top();
        m.queue.pop();
        if (next.stamp != m.stamps[next.place]) continue;
        const std::uint32_t q = m.targets[next.place];
        // What lies beyond the neighbours may have changed since it was queued.
        if (!m.allowed(next.place, q) || !m.moves(next.place, q, moved))
            m.evaluate(next.place);
        else
            m.collapse(next.place, q, moved);
    }
    return m.alive;
}

std::vector<GeometryPart> EdgeCollapse::parts() const {
    std::vector<GeometryPart> out;
    for (const model::Index material : mesh_->materials) out.push_back({material, {}});
    for (const Mesh::Triangle& t : mesh_->triangles) {
        if (t.corner[0] == no_index) continue;
        for (const std::uint32_t c : t.corner) out[t.part].indices.push_back(mesh_->corners[c].vertex);
    }
    std::erase_if(out, [](const GeometryPart& part) { return part.indices.empty(); });
    return out;
}

}  // namespace surefoot::bake
