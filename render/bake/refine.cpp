// Rounds by length: which edges change their light, then one cut of each triangle by its cut edges.
#include "render/bake/refine.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "render/bake/lit_vertices.hpp"
#include "render/model/sun_time.hpp"
#include "rt/base/hash.hpp"

namespace surefoot::bake {

namespace {

constexpr std::size_t max_cut_places = 4;
constexpr double max_round_m = 64, min_round_m = 1;  // edges of at least so much are cut, round by round
constexpr float max_off = 0.12F;                     // of light: between the mean of the ends and what is there
constexpr std::size_t sun_rays = 6;
constexpr std::uint64_t min_added = 20'000;
constexpr int rounds_of_keys = 3;  // a mesh that stands twice passes its cuts on

/// Shares of the sun's light at some moments, and the lamps' light.
using LightSample = std::array<float, sun_rays + 1>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;  ///< the lesser vertex first

Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// A mesh that may be cut, and where it stands.
struct CutMesh {
    std::size_t mesh = 0;
    importer::Mesh cut;
    std::vector<dmat4> places;
    std::vector<std::vector<Edge>> edges;  ///< by primitive: to be cut in this round, sorted
};

std::uint64_t key_of(const dvec3& a, const dvec3& b) {
    std::array<std::int64_t, 6> key{};
    const bool swapped = std::tie(a.x, a.y, a.z) > std::tie(b.x, b.y, b.z);
    const dvec3 &low = swapped ? b : a, &high = swapped ? a : b;
    for (int c = 0; c < 3; ++c) {
        key[static_cast<std::size_t>(c)] = std::llround(low[c] * 1000);
        key[static_cast<std::size_t>(c) + 3] = std::llround(high[c] * 1000);
    }
    return hash_bytes(std::as_bytes(std::span(key)));
}

dvec3 placed_at(const dmat4& world, const vec3& at) { return dvec3(world * dvec4(dvec3(at), 1.0)); }

class Refiner {
public:
    Refiner(const importer::Scene& scene, const RefineLight& light, const ForAll& for_all)
        : scene_(scene), light_(light), for_all_(for_all) {
        find_meshes();
        directions_[0] = light.sun;
        constexpr std::array<std::uint32_t, sun_rays - 1> at = {2, 5, 7, 9, 12};  // of the day's moments
        for (std::size_t i = 0; i < at.size(); ++i)
            directions_[1 + i] = model::towards_sun({model::hour_of_moment(at[i], light.facts.day, light.facts.latitude_deg),
                                                     light.facts.day, light.facts.latitude_deg});
    }

    void run(const std::function<bool()>& stop) {
        std::uint64_t left = std::max(triangles_ / 4, min_added);
        for (double length = max_round_m; length >= min_round_m && !stop(); length /= 2) {
            std::vector<std::vector<std::uint64_t>> keys(meshes_.size());
            for_all_(meshes_.size(), [&](std::size_t i) { keys[i] = find_changes(meshes_[i], length); });
            std::unordered_set<std::uint64_t> marked;
            for (const auto& of_mesh : keys) marked.insert(of_mesh.begin(), of_mesh.end());
            const std::uint64_t added = mark_edges(marked, length);
            if (added == 0) continue;
            if (added > left) break;
            left -= added;
            for_all_(meshes_.size(), [&](std::size_t i) { cut_edges(meshes_[i]); });
        }
    }

    [[nodiscard]] RefinedMeshes take() {
        RefinedMeshes out(scene_.meshes.size());
        for (CutMesh& one : meshes_) {
            std::size_t before = 0, after = 0;
            for (const importer::Primitive& p : scene_.meshes[one.mesh].primitives) before += p.indices.size();
            for (const importer::Primitive& p : one.cut.primitives) after += p.indices.size();
            if (after > before) out[one.mesh] = std::move(one.cut);
        }
        return out;
    }

private:
    void find_meshes();
    [[nodiscard]] bool may_cut(const importer::Primitive& p) const {
        const importer::Material& material = scene_.materials[p.material];
        return !material.unlit && material.alpha == model::AlphaMode::opaque && p.normals.size() == p.positions.size();
    }
    [[nodiscard]] LightSample light_at(const dvec3& at, const dvec3& normal) const;
    [[nodiscard]] static bool is_off(const LightSample& is, const LightSample& mean) {
        for (std::size_t i = 0; i < is.size(); ++i)
            if (std::abs(is[i] - mean[i]) > max_off) return true;
        return false;
    }
    [[nodiscard]] std::vector<std::uint64_t> find_changes(const CutMesh& mesh, double length) const;
    void find_changes(const importer::Primitive& p, const dmat4& place, double length, std::vector<std::uint64_t>& keys) const;
    std::uint64_t mark_edges(std::unordered_set<std::uint64_t>& marked, double length);
    static void cut_edges(CutMesh& mesh);

    const importer::Scene& scene_;
    const RefineLight& light_;
    const ForAll& for_all_;
    std::vector<CutMesh> meshes_;
    std::array<dvec3, sun_rays> directions_{};
    std::uint64_t triangles_ = 0;  ///< of the scene, as often as they stand
    double far_m_ = 0;
};

void Refiner::find_meshes() {
    std::vector<std::vector<dmat4>> places(scene_.meshes.size());
    std::vector<std::uint64_t> triangles(scene_.meshes.size(), 0);
    for (std::size_t m = 0; m < scene_.meshes.size(); ++m)
        for (const importer::Primitive& p : scene_.meshes[m].primitives) triangles[m] += p.indices.size() / 3;
    Box all;
    for (const importer::Node& node : scene_.nodes) {
        if (node.mesh == importer::none) continue;
        triangles_ += triangles[node.mesh];
        places[node.mesh].push_back(node.world);
        for (const importer::Primitive& p : scene_.meshes[node.mesh].primitives)
            for (const vec3& at : p.positions) all.grow(placed_at(node.world, at));
    }
    far_m_ = all.empty() ? 0 : 2 * all.diagonal();
    for (std::size_t m = 0; m < places.size(); ++m) {
        if (places[m].empty() || places[m].size() > max_cut_places) continue;
        const auto& primitives = scene_.meshes[m].primitives;
        if (std::none_of(primitives.begin(), primitives.end(), [&](const auto& p) { return may_cut(p); })) continue;
        meshes_.push_back({m, scene_.meshes[m], std::move(places[m]), {}});
    }
}

LightSample Refiner::light_at(const dvec3& at, const dvec3& normal) const {
    LightSample out{};
    const dvec3 from = at + ray_lift_m * normal;
    for (std::size_t i = 0; i < sun_rays; ++i) {
        const double faces = glm::dot(normal, directions_[i]);
        if (faces > 0 && directions_[i].y > 0 && !light_.opaque->is_blocked({from, directions_[i], far_m_}))
            out[i] = static_cast<float>(0.6 * faces * (light_.leaves->is_blocked({from, directions_[i], far_m_}) ? 0.33 : 1.0));
    }
    if (!light_.lamps->empty()) {
        const vec3 shown = shown_light(light_.lamps->lux_at(at, normal));
        out[sun_rays] = (shown.r + shown.g + shown.b) / 3;
    }
    return out;
}

void Refiner::find_changes(const importer::Primitive& p, const dmat4& place, double length,
                           std::vector<std::uint64_t>& keys) const {
    const dmat3 normals = glm::transpose(glm::inverse(dmat3(place)));
    std::vector<dvec3> at;
    for (const vec3& v : p.positions) at.push_back(placed_at(place, v));
    std::map<std::uint32_t, LightSample> known;
    const auto normal_of = [&](const vec3& n) {
        const dvec3 turned = normals * dvec3(n);
        const double size = glm::length(turned);
        return size > 0 ? turned / size : dvec3(0, 1, 0);
    };
    const auto at_vertex = [&](std::uint32_t v) -> const LightSample& {
        const auto [found, is_new] = known.try_emplace(v);
        if (is_new) found->second = light_at(at[v], normal_of(p.normals[v]));
        return found->second;
    };
    std::map<Edge, bool> changes;
    const auto edge_changes = [&](std::uint32_t a, std::uint32_t b) {
        const auto [found, is_new] = changes.try_emplace(edge_of(a, b), false);
        if (!is_new) return found->second;
        const LightSample &first = at_vertex(a), &last = at_vertex(b);
        for (const double t : {0.5, 0.25, 0.75}) {
            LightSample mean{};
            for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = first[i] + static_cast<float>(t) * (last[i] - first[i]);
            const vec3 n = p.normals[a] + static_cast<float>(t) * (p.normals[b] - p.normals[a]);
            if (is_off(light_at(at[a] + t * (at[b] - at[a]), normal_of(n)), mean)) return found->second = true;
        }
        return false;
    };
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
        const std::uint32_t* v = &p.indices[i];
        std::uint32_t longest = 0;
        double max_m = 0;
        bool any = false;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t a = v[k], b = v[(k + 1) % 3];
            const double size = glm::length(at[a] - at[b]);
            if (size > max_m) max_m = size, longest = k;
            if (size < length || !edge_changes(a, b)) continue;
            keys.push_back(key_of(at[a], at[b]));
            any = true;
        }
        if (any || max_m < length) continue;
        LightSample mean{};
        for (std::uint32_t k = 0; k < 3; ++k)
            for (std::size_t s = 0; s < mean.size(); ++s) mean[s] += at_vertex(v[k])[s] / 3;
        const dvec3 middle = (at[v[0]] + at[v[1]] + at[v[2]]) / 3.0;
        if (is_off(light_at(middle, normal_of(p.normals[v[0]] + p.normals[v[1]] + p.normals[v[2]])), mean))
            keys.push_back(key_of(at[v[longest]], at[v[(longest + 1) % 3]]));
    }
}

std::vector<std::uint64_t> Refiner::find_changes(const CutMesh& mesh, double length) const {
    std::vector<std::uint64_t> keys;
    for (const importer::Primitive& p : mesh.cut.primitives)
        if (may_cut(p))
            for (const dmat4& place : mesh.places) find_changes(p, place, length, keys);
    return keys;
}

/// Marks every edge that lies where one is marked, wherever its mesh stands. Returns how many triangles that adds.
std::uint64_t Refiner::mark_edges(std::unordered_set<std::uint64_t>& marked, double length) {
    std::atomic<std::uint64_t> added{0};
    for (int round = 0; round < rounds_of_keys && !marked.empty(); ++round) {
        added = 0;
        std::vector<std::vector<std::uint64_t>> more(meshes_.size());
        for_all_(meshes_.size(), [&](std::size_t m) {
            CutMesh& mesh = meshes_[m];
            mesh.edges.assign(mesh.cut.primitives.size(), {});
            for (std::size_t i = 0; i < mesh.edges.size(); ++i) {
                const importer::Primitive& p = mesh.cut.primitives[i];
                if (!may_cut(p)) continue;
                for (std::size_t k = 0; k < p.indices.size(); ++k) {
                    const std::uint32_t a = p.indices[k], b = p.indices[k % 3 == 2 ? k - 2 : k + 1];
                    const auto key = [&](const dmat4& place) {
                        return key_of(placed_at(place, p.positions[a]), placed_at(place, p.positions[b]));
                    };
                    const double size = glm::length(dmat3(mesh.places[0]) * dvec3(p.positions[a] - p.positions[b]));
                    if (size < 0.5 * length) continue;
                    const auto is_marked = [&](const dmat4& place) { return marked.contains(key(place)); };
                    if (std::none_of(mesh.places.begin(), mesh.places.end(), is_marked)) continue;
                    ++added;
                    mesh.edges[i].push_back(edge_of(a, b));
                    for (const dmat4& place : mesh.places) more[m].push_back(key(place));
                }
                std::sort(mesh.edges[i].begin(), mesh.edges[i].end());
                mesh.edges[i].erase(std::unique(mesh.edges[i].begin(), mesh.edges[i].end()), mesh.edges[i].end());
            }
        });
        const std::size_t before = marked.size();
        for (const auto& keys : more) marked.insert(keys.begin(), keys.end());
        if (marked.size() == before) break;
    }
    return added;
}

/// A vertex halfway between two others.
std::uint32_t add_middle(importer::Primitive& p, const Edge& edge) {
    const auto [a, b] = edge;
    p.positions.push_back(0.5F * (p.positions[a] + p.positions[b]));
    const vec3 normal = p.normals[a] + p.normals[b];
    const float size = glm::length(normal);
    p.normals.push_back(size > 0 ? normal / size : p.normals[a]);
    if (!p.uvs.empty()) p.uvs.push_back(0.5F * (p.uvs[a] + p.uvs[b]));
    if (!p.colours.empty()) {
        std::array<std::uint8_t, 4> mean{};
        for (std::size_t c = 0; c < 4; ++c) mean[c] = static_cast<std::uint8_t>((p.colours[a][c] + p.colours[b][c] + 1) / 2);
        p.colours.push_back(mean);
    }
    return static_cast<std::uint32_t>(p.positions.size() - 1);
}

void Refiner::cut_edges(CutMesh& mesh) {
    for (std::size_t i = 0; i < mesh.edges.size(); ++i) {
        if (mesh.edges[i].empty()) continue;
        importer::Primitive& p = mesh.cut.primitives[i];
        std::map<Edge, std::uint32_t> middles;
        for (const Edge& edge : mesh.edges[i]) middles.emplace(edge, add_middle(p, edge));
        std::vector<std::uint32_t> out;
        out.reserve(p.indices.size() * 2);
        for (std::size_t t = 0; t + 2 < p.indices.size(); t += 3) {
            std::array<std::uint32_t, 3> v{p.indices[t], p.indices[t + 1], p.indices[t + 2]}, middle{};
            std::array<bool, 3> has{};
            int count = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto found = middles.find(edge_of(v[k], v[(k + 1) % 3]));
                has[k] = found != middles.end();
                if (has[k]) middle[k] = found->second, ++count;
            }
            // Turned until the first edge is the only one that is cut, or the only one that is not.
            while (count == 1 && !has[0]) {
                std::rotate(v.begin(), v.begin() + 1, v.end());
                std::rotate(middle.begin(), middle.begin() + 1, middle.end());
                std::rotate(has.begin(), has.begin() + 1, has.end());
            }
            while (count == 2 && has[0]) {
                std::rotate(v.begin(), v.begin() + 1, v.end());
                std::rotate(middle.begin(), middle.begin() + 1, middle.end());
                std::rotate(has.begin(), has.begin() + 1, has.end());
            }
            const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { out.insert(out.end(), {a, b, c}); };
            if (count == 0) add(v[0], v[1], v[2]);
            if (count == 1) add(v[0], middle[0], v[2]), add(middle[0], v[1], v[2]);
            if (count == 2) add(v[2], middle[2], middle[1]), add(v[0], v[1], middle[1]), add(v[0], middle[1], middle[2]);
            if (count == 3) {
                add(v[0], middle[0], middle[2]), add(middle[0], v[1], middle[1]), add(middle[2], middle[1], v[2]);
                add(middle[0], middle[1], middle[2]);
            }
        }
        p.indices = std::move(out);
    }
}

}  // namespace

RefinedMeshes refine_for_light(const importer::Scene& scene, const RefineLight& light, const ForAll& for_all,
                               const std::function<bool()>& stop) {
    Refiner refiner(scene, light, for_all);
    refiner.run(stop);
    return refiner.take();
}

}  // namespace surefoot::bake
