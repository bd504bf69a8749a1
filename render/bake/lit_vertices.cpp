// Ranges of vertices by their first, and starts that are moved a little into their triangles.
#include "render/bake/lit_vertices.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

namespace surefoot::bake {

namespace {

constexpr double inset_m = 0.05;  // from its border inwards, so that a corner does not start within its neighbour
constexpr std::size_t max_places = 4;
constexpr std::uint32_t task_vertices = 512;

dmat3 cofactor_of(const dmat3& m) { return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])}; }

}  // namespace

std::vector<VertexRange> lit_ranges(const model::Model& model, model::EffectMask any_of) {
    std::map<std::uint32_t, VertexRange> by_first;
    for (const model::Representation& rep : model.reps) {
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            const model::Part& part = model.parts[p];
            const model::Material& material = model.materials[part.material];
            if ((material.effects & any_of) == 0) continue;
            VertexRange& range = by_first[part.first_vertex];
            range.first = part.first_vertex;
            range.count = std::max(range.count, part.vertex_count);
            range.two_sided = range.two_sided || material.two_sided;
            if (range.parts.empty() || range.parts.back() != p) range.parts.push_back(p);
            if (range.placements.empty() || range.placements.back() != rep.placement) range.placements.push_back(rep.placement);
        }
    }
    std::vector<VertexRange> ranges;
    for (auto& [first, range] : by_first) {
        for (std::vector<model::Index>* list : {&range.parts, &range.placements}) {
            std::sort(list->begin(), list->end());
            list->erase(std::unique(list->begin(), list->end()), list->end());
        }
        const std::size_t count = range.placements.size();
        if (count > max_places) {
            std::vector<model::Index> spread;
            for (std::size_t i = 0; i < max_places; ++i) spread.push_back(range.placements[i * (count - 1) / (max_places - 1)]);
            range.placements = std::move(spread);
            range.all_places = false;
        }
        ranges.push_back(std::move(range));
    }
    return ranges;
}

std::vector<VertexTask> vertex_tasks(const std::vector<VertexRange>& ranges) {
    std::vector<VertexTask> tasks;
    for (std::uint32_t r = 0; r < ranges.size(); ++r)
        for (std::uint32_t from = 0; from < ranges[r].count; from += task_vertices)
            tasks.push_back({r, from, std::min(ranges[r].count, from + task_vertices)});
    return tasks;
}

std::vector<RayStart> ray_starts(const model::Model& model, const VertexRange& range) {
    std::vector<RayStart> starts(range.count);
    std::vector<std::uint32_t> triangles(range.count, 0);
    for (std::uint32_t v = 0; v < range.count; ++v) {
        const model::Vertex& vertex = model.vertices[range.first + v];
        starts[v].at = {vertex.position[0], vertex.position[1], vertex.position[2]};
        starts[v].normal = {vertex.normal[0], vertex.normal[1], vertex.normal[2]};
    }
    for (const model::Index p : range.parts) {
        const model::Part& part = model.parts[p];
        for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) {
            const std::uint32_t* corner = &model.indices[part.first_index + i];
            const vec3 middle = (starts[corner[0]].at + starts[corner[1]].at + starts[corner[2]].at) / 3.0F;
            for (int k = 0; k < 3; ++k) {
                starts[corner[k]].used = true;
                starts[corner[k]].inwards += middle - starts[corner[k]].at;
                ++triangles[corner[k]];
            }
        }
    }
    for (std::uint32_t v = 0; v < range.count; ++v)
        if (starts[v].used) starts[v].inwards *= 0.1F / static_cast<float>(triangles[v]);
    return starts;
}

namespace {

/// Of a wall of many squares, those in between may touch no known vertex: they take what the nearest one that looks the same way
/// has.
void add_nearest(const model::Model& model, const VertexRange& range, const std::vector<bool>& open,
                 const std::vector<bool>& unknown, std::vector<VertexFill>& out) {
    constexpr float max_m = 3, min_alike = 0.9F;
    const auto at = [&](std::uint32_t v) {
        const float* p = model.vertices[range.first + v].position;
        return vec3(p[0], p[1], p[2]);
    };
    const auto normal = [&](std::uint32_t v) {
        const std::int8_t* n = model.vertices[range.first + v].normal;
        return vec3(n[0], n[1], n[2]) / 127.0F;
    };
    if (std::none_of(open.begin(), open.end(), [](bool o) { return o; })) return;
    std::vector<bool> used(range.count, false);
    for (const model::Index p : range.parts)
        for (std::uint32_t i = 0; i < model.parts[p].index_count; ++i) used[model.indices[model.parts[p].first_index + i]] = true;
    std::vector<std::pair<float, std::uint32_t>> known;  // by x
    for (std::uint32_t v = 0; v < range.count; ++v)
        if (used[v] && !unknown[v]) known.emplace_back(at(v).x, v);
    std::sort(known.begin(), known.end());
    for (std::uint32_t v = 0; v < range.count; ++v) {
        if (!open[v]) continue;
        const vec3 here = at(v);
        float min_m = max_m;
        std::uint32_t nearest = range.count;
        const auto look_at = [&](std::uint32_t other) {
            const float distance = glm::length(at(other) - here);
            if (distance < min_m && glm::dot(normal(v), normal(other)) >= min_alike) min_m = distance, nearest = other;
        };
        // Outwards: what is near ends the search.
        auto up = std::lower_bound(known.begin(), known.end(), std::pair(here.x, std::uint32_t{0})), down = up;
        while (true) {
            const bool more_up = up != known.end() && up->first - here.x < min_m;
            const bool more_down = down != known.begin() && here.x - std::prev(down)->first < min_m;
            if (!more_up && !more_down) break;
            if (more_up) look_at((up++)->second);
            if (more_down) look_at((--down)->second);
        }
        if (nearest < range.count) out.push_back({v, {nearest}});
    }
}

}  // namespace

std::vector<VertexFill> vertex_fills(const model::Model& model, const VertexRange& range, const std::vector<bool>& unknown) {
    std::vector<VertexFill> out;
    if (std::none_of(unknown.begin(), unknown.end(), [](bool u) { return u; })) return out;
    std::vector<bool> open = unknown;
    while (true) {
        std::map<std::uint32_t, std::vector<std::uint32_t>> layer;
        for (const model::Index p : range.parts) {
            const model::Part& part = model.parts[p];
            for (std::uint32_t i = 0; i < part.index_count; ++i) {
                const std::uint32_t triangle = part.first_index + i - i % 3, v = model.indices[part.first_index + i];
                if (!open[v]) continue;
                for (std::uint32_t k = 0; k < 3; ++k)
                    if (!open[model.indices[triangle + k]]) layer[v].push_back(model.indices[triangle + k]);
            }
        }
        if (layer.empty()) break;
        for (auto& [v, from] : layer) {
            std::sort(from.begin(), from.end());
            from.erase(std::unique(from.begin(), from.end()), from.end());
            open[v] = false;
            out.push_back({v, std::move(from)});
        }
    }
    add_nearest(model, range, open, unknown, out);
    return out;
}

std::optional<PlacedStart> placed_start(const RayStart& start, const model::Placement& place) {
    const dmat3 linear(place.linear);
    const dvec3 turned = (glm::determinant(linear) < 0 ? -1.0 : 1.0) * (cofactor_of(linear) * dvec3(start.normal));
    const double length = glm::length(turned);
    if (!(length > 0)) return {};
    const dvec3 inwards = linear * dvec3(start.inwards);
    const double by = glm::length(inwards);
    return PlacedStart{place.origin + linear * dvec3(start.at) + (by > inset_m ? inset_m / by : 1.0) * inwards, turned / length};
}

}  // namespace surefoot::bake
