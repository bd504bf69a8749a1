// One resolution of vertex clustering (vertex_grid.hpp).
#include "render/bake/vertex_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

namespace surefoot::bake {

namespace {

using Key = std::uint64_t;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

struct Cell {
    dmat3 planes{0.0};   ///< sum of area * n * n^T
    dvec3 offsets{0.0};  ///< sum of area * n * (n . p), positions relative to `low`
    dvec3 sum{0.0};
    double weight = 0;
    Box box;        ///< of its vertices
    vec3 place{0};  ///< representative position
    bool touched = false;
};

struct Corner {
    std::array<double, 4> colour{}, baked{};
    dvec3 normal{0.0};
    vec2 uv{0};
    double weight = 0;
    std::uint32_t cell = 0;
};

/// A collapsed strip between two cells: what its triangles were.
struct Strip {
    double area = 0;
    float moved = 0;
    std::uint32_t triangle = 0;  ///< the first
};

struct Triple {
    std::array<std::uint32_t, 3> cells;
    std::uint32_t triangle;
    bool operator<(const Triple& o) const { return cells < o.cells; }
};

std::uint32_t direction_of(const model::Vertex& v) {
    const int x = v.normal[0], y = v.normal[1], z = v.normal[2];
    const int ax = std::abs(x), ay = std::abs(y), az = std::abs(z);
    if (ax >= ay && ax >= az) return x < 0 ? 0 : 1;
    if (ay >= az) return y < 0 ? 2 : 3;
    return z < 0 ? 4 : 5;
}

class Builder {
public:
    Builder(const ClusterSource& source, std::uint32_t steps)
        : source_(source), g_(*source.geometry), cell_m_(source.longest / static_cast<float>(std::max(1U, steps))) {}

    GridMesh run() {
        assign_cells();
        place_cells();
        make_corners();
        mesh_.parts.resize(g_.parts.size());
        for (std::size_t p = 0; p < g_.parts.size(); ++p) mesh_.parts[p].material = g_.parts[p].material;
        bounds_.resize(g_.parts.size());
        mesh_.source_bound.assign(source_.triangles.size(), 0.0F);
        sort_triangles();
        make_strips();
        make_solids();
        for (const auto& part : bounds_) mesh_.out_bound.insert(mesh_.out_bound.end(), part.begin(), part.end());
        return std::move(mesh_);
    }

private:
    [[nodiscard]] vec3 at(std::uint32_t vertex) const { return position_of(g_.vertices[vertex]); }
    [[nodiscard]] float moved(std::uint32_t vertex) const { return glm::length(at(vertex) - cells_[cell_of_[vertex]].place); }
    [[nodiscard]] float moved(const SourceTriangle& t) const {
        return std::max({moved(t.vertex[0]), moved(t.vertex[1]), moved(t.vertex[2])});
    }

    // Cells are centred on the box's faces, not cut by them: a flat wall falls into one layer, and a box stays a box.
    void assign_cells() {
        std::vector<Key> keys(g_.vertices.size(), std::numeric_limits<Key>::max());
        for (const SourceTriangle& t : source_.triangles) {
            for (const std::uint32_t v : t.vertex) {
                const vec3 step = glm::floor((at(v) - source_.low) / std::max(cell_m_, 1e-20F) + 0.5F);
                keys[v] = static_cast<Key>(step.x) | static_cast<Key>(step.y) << 20U | static_cast<Key>(step.z) << 40U;
            }
        }
        std::vector<Key> known = keys;
        std::sort(known.begin(), known.end());
        known.erase(std::unique(known.begin(), known.end()), known.end());
        if (!known.empty() && known.back() == std::numeric_limits<Key>::max()) known.pop_back();
        cells_.resize(known.size());
        cell_of_.resize(keys.size());
        for (std::size_t v = 0; v < keys.size(); ++v) {
            cell_of_[v] = static_cast<std::uint32_t>(std::lower_bound(known.begin(), known.end(), keys[v]) - known.begin());
        }
    }

    void place_cells() {
        for (const SourceTriangle& t : source_.triangles) {
            const dvec3 n(t.normal);
            const double d = glm::dot(n, dvec3(at(t.vertex[0]) - source_.low));
            for (const std::uint32_t v : t.vertex) {
                Cell& cell = cells_[cell_of_[v]];
                const double w = std::max<double>(t.area, 1e-20);
                cell.planes += w * glm::outerProduct(n, n);
                cell.offsets += w * d * n;
                cell.sum += w * dvec3(at(v) - source_.low);
                cell.weight += w;
                cell.box.grow(dvec3(at(v)));
            }
        }
        for (Cell& cell : cells_) {
            // Drawn to the mean where the planes leave a direction free; kept within what is really there.
            const dvec3 mean = cell.sum / cell.weight;
            const double pull = 0.02 * cell.weight;
            const dvec3 best = glm::inverse(cell.planes + dmat3(pull)) * (cell.offsets + pull * mean) + dvec3(source_.low);
            cell.place = vec3(glm::clamp(best, cell.box.min, cell.box.max));
        }
    }

    void make_corners() {
        corner_of_.assign(g_.vertices.size(), model::none);
        std::unordered_map<Key, std::uint32_t> known;
        for (const SourceTriangle& t : source_.triangles) {
            for (const std::uint32_t v : t.vertex) {
                if (corner_of_[v] != model::none) continue;
                // Cells and owners are far below 2^30: vertices are.
                const Key key =
                    ((static_cast<Key>(cell_of_[v]) << 32U | source_.owners[v]) * 6 + direction_of(g_.vertices[v])) * 64 +
                    t.part % 64;
                const auto [where, fresh] = known.try_emplace(key, static_cast<std::uint32_t>(corners_.size()));
                if (fresh) {
                    corners_.emplace_back();
                    corners_.back().cell = cell_of_[v];
                    corners_.back().uv = {g_.vertices[v].uv[0], g_.vertices[v].uv[1]};
                }
                corner_of_[v] = where->second;
                add(corners_[where->second], v);
            }
        }
    }

    void add(Corner& corner, std::uint32_t v) {
        const model::Vertex& vertex = g_.vertices[v];
        const double w = std::max<double>(source_.weight[v], 1e-20);
        for (std::size_t c = 0; c < 4; ++c) {
            corner.colour[c] += w * vertex.colour[c];
            corner.baked[c] += w * g_.baked[v][c];
        }
        corner.normal += w * dvec3(vertex.normal[0], vertex.normal[1], vertex.normal[2]);
        corner.weight += w;
    }

    std::uint32_t emit(const Corner& corner, const vec3& place) {
        model::Vertex vertex{};
        std::array<std::uint8_t, 4> baked{};
        const double length = std::max(glm::length(corner.normal), 1e-30);
        for (int k = 0; k < 3; ++k) {
            vertex.position[k] = place[k];
            vertex.normal[k] = static_cast<std::int8_t>(std::lround(127.0 * corner.normal[k] / length));
        }
        for (std::size_t c = 0; c < 4; ++c) {
            vertex.colour[c] = static_cast<std::uint8_t>(std::lround(std::clamp(corner.colour[c] / corner.weight, 0.0, 255.0)));
            baked[c] = static_cast<std::uint8_t>(std::lround(std::clamp(corner.baked[c] / corner.weight, 0.0, 255.0)));
        }
        vertex.uv[0] = corner.uv.x;
        vertex.uv[1] = corner.uv.y;
        mesh_.vertices.push_back(vertex);
        mesh_.baked.push_back(baked);
        return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
    }

    std::uint32_t shared_vertex(std::uint32_t source_vertex) {
        if (emitted_.empty()) emitted_.assign(corners_.size(), model::none);
        std::uint32_t& index = emitted_[corner_of_[source_vertex]];
        if (index == model::none)
            index = emit(corners_[corner_of_[source_vertex]], cells_[corners_[corner_of_[source_vertex]].cell].place);
        return index;
    }

    void add_triangle(std::uint32_t part, std::uint32_t a, std::uint32_t b, std::uint32_t c, float bound) {
        for (const std::uint32_t i : {a, b, c}) mesh_.parts[part].indices.push_back(i);
        bounds_[part].push_back(bound);
    }

    /// Triangles that keep three cells; of several between the same cells the largest stays.
    void sort_triangles() {
        std::vector<Triple> kept;
        for (std::uint32_t i = 0; i < source_.triangles.size(); ++i) {
            const SourceTriangle& t = source_.triangles[i];
            std::array<std::uint32_t, 3> c{cell_of_[t.vertex[0]], cell_of_[t.vertex[1]], cell_of_[t.vertex[2]]};
            mesh_.source_bound[i] = moved(t);
            if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) {
                std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
                if (!source_.one_sided[t.part] && c[1] > c[2]) std::swap(c[1], c[2]);
                kept.push_back({c, i});
            } else if (c[0] != c[1] || c[1] != c[2]) {
                const std::uint32_t a = c[0], b = c[1] != c[0] ? c[1] : c[2];
                collapsed_.push_back({Edge{std::min(a, b), std::max(a, b)}, i});
            } else {
                points_.push_back(i);
            }
        }
        std::sort(kept.begin(), kept.end(), [&](const Triple& x, const Triple& y) {
            if (x.cells != y.cells) return x.cells < y.cells;
            const float ax = source_.triangles[x.triangle].area, ay = source_.triangles[y.triangle].area;
            return ax != ay ? ax > ay : x.triangle < y.triangle;
        });
        for (std::size_t i = 0; i < kept.size(); ++i) {
            if (i > 0 && kept[i].cells == kept[i - 1].cells) continue;
            const SourceTriangle& t = source_.triangles[kept[i].triangle];
            add_triangle(t.part, shared_vertex(t.vertex[0]), shared_vertex(t.vertex[1]), shared_vertex(t.vertex[2]), moved(t));
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t a = kept[i].cells[k], b = kept[i].cells[(k + 1) % 3];
                cells_[a].touched = true;
                edges_.push_back({std::min(a, b), std::max(a, b)});
            }
        }
        std::sort(edges_.begin(), edges_.end());
    }

    /// Poles, wires and edges of thin objects become two crossed blades each, unless a triangle is there or both ends have
    /// neighbours.
    void make_strips() {
        std::map<Edge, Strip> strips;
        for (const auto& [edge, i] : collapsed_) {
            if (std::binary_search(edges_.begin(), edges_.end(), edge)) continue;
            Strip& strip = strips.try_emplace(edge, Strip{0, 0, i}).first->second;
            strip.area += source_.triangles[i].area;
            strip.moved = std::max(strip.moved, mesh_.source_bound[i]);
        }
        std::map<Edge, float> skipped;
        for (const auto& [edge, strip] : strips) {
            const vec3 a = cells_[edge.first].place, b = cells_[edge.second].place;
            const float length = glm::length(b - a);
            if (cells_[edge.first].touched && cells_[edge.second].touched && length <= 1.8F * cell_m_) {
                skipped[edge] = 0.5F * length;
            } else {
                add_blades(edge, strip, a, b);
            }
        }
        for (const auto& [edge, strip] : strips) {
            if (skipped.find(edge) == skipped.end()) cells_[edge.first].touched = cells_[edge.second].touched = true;
        }
        for (const auto& [edge, i] : collapsed_) {
            const auto at = skipped.find(edge);
            if (at != skipped.end()) mesh_.source_bound[i] += at->second;
        }
    }

    void add_blades(const Edge& edge, const Strip& strip, const vec3& a, const vec3& b) {
        const SourceTriangle& t = source_.triangles[strip.triangle];
        const auto corner_in = [&](std::uint32_t cell) {
            for (const std::uint32_t v : t.vertex) {
                if (cell_of_[v] == cell) return corner_of_[v];
            }
            return corner_of_[t.vertex[0]];
        };
        const Corner &ca = corners_[corner_in(edge.first)], &cb = corners_[corner_in(edge.second)];
        const vec3 along = b - a;
        const float length = std::max(glm::length(along), 1e-20F);
        // A closed tube of that area is this wide; a sheet seen edge-on is a little narrower.
        const float width = std::clamp(static_cast<float>(strip.area) / (2.0F * length), 1e-4F * cell_m_, 0.5F * cell_m_);
        const vec3 other = std::abs(along.y) < 0.9F * length ? vec3(0, 1, 0) : vec3(1, 0, 0);
        const vec3 u = glm::normalize(glm::cross(along, other)) * (0.5F * width);
        const vec3 w = glm::normalize(glm::cross(along, u)) * (0.5F * width);
        const float bound = strip.moved + 0.5F * width;
        add_triangle(t.part, emit(ca, a - u), emit(ca, a + u), emit(cb, b), bound);
        add_triangle(t.part, emit(cb, b - w), emit(cb, b + w), emit(ca, a), bound);
    }

    /// Geometry inside one cell that no other triangle reaches becomes a tetrahedron of its size.
    void make_solids() {
        std::map<std::uint32_t, std::uint32_t> alone;
        for (const std::uint32_t i : points_) {
            const std::uint32_t cell = cell_of_[source_.triangles[i].vertex[0]];
            if (cells_[cell].touched) continue;
            alone.try_emplace(cell, i);
            mesh_.source_bound[i] = static_cast<float>(cells_[cell].box.diagonal());
        }
        for (const auto& [cell, i] : alone) {
            const vec3 min_half(0.5e-3F * cell_m_);
            const vec3 low = vec3(cells_[cell].box.min) - min_half, high = vec3(cells_[cell].box.max) + min_half;
            const SourceTriangle& t = source_.triangles[i];
            const Corner& corner = corners_[corner_of_[t.vertex[0]]];
            const std::array<std::uint32_t, 4> v{emit(corner, low), emit(corner, {high.x, high.y, low.z}),
                                                 emit(corner, {high.x, low.y, high.z}), emit(corner, {low.x, high.y, high.z})};
            const float bound = glm::length(high - low);
            add_triangle(t.part, v[0], v[1], v[2], bound);
            add_triangle(t.part, v[0], v[3], v[1], bound);
            add_triangle(t.part, v[0], v[2], v[3], bound);
            add_triangle(t.part, v[1], v[3], v[2], bound);
        }
    }

    const ClusterSource& source_;
    const Geometry& g_;
    float cell_m_;
    std::vector<Cell> cells_;
    std::vector<std::uint32_t> cell_of_, corner_of_, emitted_;
    std::vector<Corner> corners_;
    std::vector<Edge> edges_;
    std::vector<std::pair<Edge, std::uint32_t>> collapsed_;
    std::vector<std::uint32_t> points_;
    std::vector<std::vector<float>> bounds_;
    GridMesh mesh_;
};

}  // namespace

ClusterSource make_source(const Geometry& g, std::span<const std::uint32_t> owners, const std::vector<bool>& two_sided) {
    ClusterSource source;
    source.geometry = &g;
    source.owners = owners;
    source.weight.assign(g.vertices.size(), 0.0F);
    vec3 low(std::numeric_limits<float>::infinity()), high(-std::numeric_limits<float>::infinity());
    for (std::uint32_t p = 0; p < g.parts.size(); ++p) {
        source.one_sided.push_back(!two_sided[g.parts[p].material]);
        const auto& indices = g.parts[p].indices;
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
            SourceTriangle t{{indices[i], indices[i + 1], indices[i + 2]}, p};
            const vec3 a = position_of(g.vertices[t.vertex[0]]), b = position_of(g.vertices[t.vertex[1]]),
                       c = position_of(g.vertices[t.vertex[2]]);
            const dvec3 cross = glm::cross(dvec3(b) - dvec3(a), dvec3(c) - dvec3(a));
            const double length = glm::length(cross);
            t.area = static_cast<float>(0.5 * length);
            if (length > 0) t.normal = vec3(cross / length);
            for (const std::uint32_t v : t.vertex) source.weight[v] += t.area;
            low = glm::min(low, glm::min(glm::min(a, b), c));
            high = glm::max(high, glm::max(glm::max(a, b), c));
            source.triangles.push_back(t);
        }
    }
    source.low = low;
    const vec3 extent = high - low;
    source.longest = std::max({extent.x, extent.y, extent.z});
    return source;
}

GridMesh grid_mesh(const ClusterSource& source, std::uint32_t steps) { return Builder(source, steps).run(); }

}  // namespace surefoot::bake
