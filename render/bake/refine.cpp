// Rounds by length: which edges change their light, then one cut of each triangle by its cut edges.
#include "render/bake/refine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <unordered_set>
#include <utility>

#include "render/bake/lit_vertices.hpp"
#include "render/bake/objects.hpp"
#include "render/model/sun_time.hpp"
#include "rt/base/hash.hpp"

namespace surefoot::bake {

namespace {

constexpr std::size_t max_cut_places = 4;
constexpr double max_round_m = 64, min_round_m = 1;  // edges of at least so much are cut, round by round
constexpr float max_off = 0.12F;                     // of light: between the mean of the ends and what is there
constexpr std::size_t sun_rays = 6, sky_rays = 8;
constexpr double one_degree = std::numbers::pi / 180;
constexpr std::uint64_t min_added = 20'000;
constexpr double key_slack_m = 0.02;  // edges of one key differ less in length

/// Shares of the sun's light at some moments, the lamps' light, and that of the sky.
using LightSample = std::array<float, sun_rays + 2>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;  ///< the lesser vertex first

Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// What earlier rounds found of a primitive in one place. Cuts only add vertices, so it stays right.
struct KnownLight {
    std::map<std::uint32_t, LightSample> at_vertex;
    std::map<Edge, bool> changes;
    std::set<std::array<std::uint32_t, 3>> even;  ///< triangles without changes inside
};

/// A mesh that may be cut, and where it stands.
struct CutMesh {
    std::size_t mesh = 0;
    importer::Mesh cut;
    std::vector<dmat4> places;
    double longest_m = 0;                  ///< no edge is longer, wherever it stands
    std::vector<std::vector<Edge>> edges;  ///< by primitive: to be cut in this round, sorted
    std::vector<KnownLight> known;         ///< by primitive, and in it by place
};

/// Which step of a few millimetres a coordinate is in. Round numbers of metres lie within one, not between two.
double steps_of(double value_m) { return value_m * 251 + 0.2871; }

using Ends = std::array<std::array<std::int64_t, 3>, 2>;

std::uint64_t key_of(Ends ends) {
    if (ends[1] < ends[0]) std::swap(ends[0], ends[1]);
    return hash_bytes(std::as_bytes(std::span(ends)));
}

/// Where an edge lies, whichever end comes first.
std::uint64_t key_of(const dvec3& a, const dvec3& b) {
    Ends ends{};
    for (int c = 0; c < 3; ++c) {
        ends[0][static_cast<std::size_t>(c)] = std::llround(std::floor(steps_of(a[c])));
        ends[1][static_cast<std::size_t>(c)] = std::llround(std::floor(steps_of(b[c])));
    }
    return key_of(ends);
}

/// Its key, and those that the same edge of another mesh may have by rounding.
void add_keys(const dvec3& a, const dvec3& b, std::vector<std::uint64_t>& keys) {
    constexpr double slack = 0.05;  // a fifth of a millimetre
    std::array<std::array<std::int64_t, 2>, 6> may{};
    unsigned differ = 0;
    for (unsigned i = 0; i < 6; ++i) {
        const double at = steps_of(i < 3 ? a[static_cast<int>(i)] : b[static_cast<int>(i) - 3]);
        may[i] = {std::llround(std::floor(at - slack)), std::llround(std::floor(at + slack))};
        if (may[i][0] != may[i][1]) differ |= 1U << i;
    }
    for (unsigned choice = 0; choice < 64; ++choice) {
        if ((choice & ~differ) != 0) continue;
        Ends ends{};
        for (unsigned i = 0; i < 6; ++i) ends[i / 3][i % 3] = may[i][choice >> i & 1U];
        keys.push_back(key_of(ends));
    }
}

std::vector<dvec3> placed_points(const importer::Primitive& p, const dmat4& world) {
    std::vector<dvec3> out;
    out.reserve(p.positions.size());
    for (const vec3& at : p.positions) out.emplace_back(world * dvec4(dvec3(at), 1.0));
    return out;
}

/// Between two samples two metres, if that makes no less and not very many of them.
int steps_along(double size_m, int min_steps) { return static_cast<int>(std::clamp(size_m / 2, min_steps * 1.0, 16.0)); }

LightSample mean_of(const LightSample& a, const LightSample& b, const LightSample& c, const vec3& weights) {
    LightSample out{};
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = weights.x * a[i] + weights.y * b[i] + weights.z * c[i];
    return out;
}

class Refiner {
public:
    Refiner(const importer::Scene& scene, const RefineLight& light, const ForAll& for_all)
        : scene_(scene), light_(light), for_all_(for_all) {
        find_meshes();
        directions_[0] = light.sun;
        for (std::size_t i = 0; i < sky_rays; ++i) {
            const double around = 2 * std::numbers::pi * static_cast<double>(i) / sky_rays,
                         up = (i % 2 == 0 ? 20 : 55) * one_degree;
            sky_[i] = {std::cos(up) * std::cos(around), std::sin(up), std::cos(up) * std::sin(around)};
        }
        constexpr std::array<std::uint32_t, sun_rays - 1> at = {2, 5, 7, 9, 12};  // of the day's moments
        for (std::size_t i = 0; i < at.size(); ++i)
            directions_[1 + i] = model::towards_sun({model::hour_of_moment(at[i], light.facts.day, light.facts.latitude_deg),
                                                     light.facts.day, light.facts.latitude_deg});
    }

    void run(const std::function<bool()>& stop) {
        std::uint64_t left = std::max(triangles_ / 4, min_added);
        for (double length = max_round_m; length >= min_round_m && !stop(); length /= 2) {
            std::vector<std::vector<std::uint64_t>> keys(meshes_.size());
            for_all_(meshes_.size(), [&](std::size_t i) {
                if (!stop()) keys[i] = find_changes(meshes_[i], length);
            });
            if (stop()) break;
            Marks marks{{}, length};
            for (const auto& of_mesh : keys) marks.keys.insert(of_mesh.begin(), of_mesh.end());
            const std::uint64_t added = mark_edges(marks, left);
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
    [[nodiscard]] double longest_edge_m(const importer::Mesh& mesh, const std::vector<dmat4>& places) const;
    [[nodiscard]] bool may_cut(const importer::Primitive& p) const {
        const importer::Material& material = scene_.materials[p.material];
        return !material.unlit && material.alpha == model::AlphaMode::opaque && p.normals.size() == p.positions.size();
    }
    [[nodiscard]] LightSample light_at(const dvec3& at, const dvec3& normal) const;
    [[nodiscard]] float sky_at(const dvec3& from, const dvec3& normal) const;
    [[nodiscard]] static bool is_off(const LightSample& is, const LightSample& mean) {
        for (std::size_t i = 0; i < is.size(); ++i)
            if (std::abs(is[i] - mean[i]) > max_off) return true;
        return false;
    }
    [[nodiscard]] std::vector<std::uint64_t> find_changes(CutMesh& mesh, double length) const;
    void find_changes(const importer::Primitive& p, const dmat4& place, double length, KnownLight& known,
                      std::vector<std::uint64_t>& keys) const;
    /// Edges to be cut, by where they lie.
    struct Marks {
        std::unordered_set<std::uint64_t> keys;
        double shortest_m = 0;  ///< of them
    };
    /// Edges of one mesh that lie where one is marked.
    struct MarkedHere {
        std::vector<std::uint64_t> keys;  ///< wherever the mesh stands
        double shortest_m = 0;
        std::uint64_t added = 0;  ///< triangles
    };
    std::uint64_t mark_edges(Marks& marks, std::uint64_t left);
    [[nodiscard]] MarkedHere mark_edges(CutMesh& mesh, const Marks& marks) const;
    static void cut_edges(CutMesh& mesh);

    const importer::Scene& scene_;
    const RefineLight& light_;
    const ForAll& for_all_;
    std::vector<CutMesh> meshes_;
    std::array<dvec3, sun_rays> directions_{};
    std::array<dvec3, sky_rays> sky_{};  ///< all around, 20 and 55 degrees high in turns
    std::uint64_t triangles_ = 0;        ///< of the scene, as often as they stand
    double far_m_ = 0;
};

void Refiner::find_meshes() {
    std::vector<std::vector<dmat4>> places(scene_.meshes.size());
    std::vector<std::uint64_t> triangles(scene_.meshes.size(), 0);
    std::vector<Box> boxes(scene_.meshes.size());
    for (std::size_t m = 0; m < scene_.meshes.size(); ++m)
        for (const importer::Primitive& p : scene_.meshes[m].primitives) {
            triangles[m] += p.indices.size() / 3;
            for (const vec3& at : p.positions) boxes[m].grow(dvec3(at));
        }
    Box all;
    for (const importer::Node& node : scene_.nodes) {
        if (node.mesh == importer::none || boxes[node.mesh].empty()) continue;
        triangles_ += triangles[node.mesh];
        places[node.mesh].push_back(node.world);
        const Box& box = boxes[node.mesh];
        for (unsigned c = 0; c < 8; ++c) {
            const dvec3 corner((c & 1U) != 0 ? box.max.x : box.min.x, (c & 2U) != 0 ? box.max.y : box.min.y,
                               (c & 4U) != 0 ? box.max.z : box.min.z);
            all.grow(dvec3(node.world * dvec4(corner, 1.0)));
        }
    }
    far_m_ = all.empty() ? 0 : 2 * all.diagonal();
    for (std::size_t m = 0; m < places.size(); ++m) {
        if (places[m].empty() || places[m].size() > max_cut_places) continue;
        const double longest_m = longest_edge_m(scene_.meshes[m], places[m]);
        if (longest_m >= min_round_m) meshes_.push_back({m, scene_.meshes[m], std::move(places[m]), longest_m, {}, {}});
    }
}

/// Of what may be cut, or more: most meshes have short ones alone, and need no copy.
double Refiner::longest_edge_m(const importer::Mesh& mesh, const std::vector<dmat4>& places) const {
    float squared = 0;
    for (const importer::Primitive& p : mesh.primitives) {
        if (!may_cut(p)) continue;
        for (std::size_t k = 0; k < p.indices.size(); ++k) {
            const vec3 way = p.positions[p.indices[k]] - p.positions[p.indices[k % 3 == 2 ? k - 2 : k + 1]];
            squared = std::max(squared, glm::dot(way, way));
        }
    }
    double stretch = 0;
    for (const dmat4& place : places) stretch = std::max(stretch, largest_stretch(dmat3(place)));
    return 1.0001 * stretch * std::sqrt(static_cast<double>(squared));
}

/// What openness makes of the sky that is seen: a little is enough, and none is a room.
float Refiner::sky_at(const dvec3& from, const dvec3& normal) const {
    int faced = 0, open = 0;
    for (const dvec3& way : sky_) {
        if (glm::dot(normal, way) < 0.05) continue;
        ++faced;
        open += light_.opaque->is_blocked({from, way, far_m_}) ? 0 : 1;
    }
    return faced > 0 ? 0.4F * std::min(1.0F, 4.0F * static_cast<float>(open) / static_cast<float>(faced)) : 0.0F;
}

LightSample Refiner::light_at(const dvec3& at, const dvec3& normal) const {
    LightSample out{};
    const dvec3 from = at + ray_lift_m * normal;
    for (std::size_t i = 0; i < sun_rays; ++i) {
        const double faces = glm::dot(normal, directions_[i]);
        if (faces > 0 && directions_[i].y > 0 && !light_.opaque->is_blocked({from, directions_[i], far_m_}))
            out[i] = static_cast<float>(
                0.6 * faces *
                (light_.leaves != nullptr && light_.leaves->is_blocked({from, directions_[i], far_m_}) ? 0.33 : 1.0));
    }
    if (!light_.lamps->empty()) {
        const vec3 shown = shown_light(light_.lamps->lux_at(at, normal));
        out[sun_rays] = (shown.r + shown.g + shown.b) / 3;
    }
    out[sun_rays + 1] = sky_at(from, normal);
    return out;
}

void Refiner::find_changes(const importer::Primitive& p, const dmat4& place, double length, KnownLight& known,
                           std::vector<std::uint64_t>& keys) const {
    const dmat3 normals = glm::transpose(glm::inverse(dmat3(place)));
    const std::vector<dvec3> at = placed_points(p, place);
    const auto normal_of = [&](const vec3& n) {
        const dvec3 turned = normals * dvec3(n);
        const double size = glm::length(turned);
        return size > 0 && std::isfinite(size) ? turned / size : dvec3(0, 1, 0);
    };
    const auto at_vertex = [&](std::uint32_t v) -> const LightSample& {
        const auto [found, is_new] = known.at_vertex.try_emplace(v);
        if (is_new) found->second = light_at(at[v], normal_of(p.normals[v]));
        return found->second;
    };
    const auto edge_changes = [&](std::uint32_t a, std::uint32_t b) {
        const auto [found, is_new] = known.changes.try_emplace(edge_of(a, b), false);
        if (!is_new) return found->second;
        const LightSample &first = at_vertex(a), &last = at_vertex(b);
        const int steps = steps_along(glm::length(at[a] - at[b]), 4);
        for (int k = 1; k < steps; ++k) {
            const float t = static_cast<float>(k) / static_cast<float>(steps);
            const vec3 n = p.normals[a] + t * (p.normals[b] - p.normals[a]);
            const dvec3 there = at[a] + static_cast<double>(t) * (at[b] - at[a]);
            if (is_off(light_at(there, normal_of(n)), mean_of(first, last, last, {1 - t, t, 0}))) return found->second = true;
        }
        return false;
    };
    const auto inside_changes = [&](const std::uint32_t* v, double longest_m) {
        if (!known.even.insert({v[0], v[1], v[2]}).second) return false;
        const LightSample &a = at_vertex(v[0]), &b = at_vertex(v[1]), &c = at_vertex(v[2]);
        const int steps = steps_along(longest_m, 3);
        for (int i = 1; i + 1 < steps; ++i)
            for (int j = 1; i + j < steps; ++j) {
                const vec3 w = vec3(i, j, steps - i - j) / static_cast<float>(steps);
                const dvec3 there = dvec3(w.x) * at[v[0]] + dvec3(w.y) * at[v[1]] + dvec3(w.z) * at[v[2]];
                const vec3 n = w.x * p.normals[v[0]] + w.y * p.normals[v[1]] + w.z * p.normals[v[2]];
                if (is_off(light_at(there, normal_of(n)), mean_of(a, b, c, w))) return true;
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
            add_keys(at[a], at[b], keys);
            any = true;
        }
        if (!any && max_m >= length && inside_changes(v, max_m)) add_keys(at[v[longest]], at[v[(longest + 1) % 3]], keys);
    }
}

std::vector<std::uint64_t> Refiner::find_changes(CutMesh& mesh, double length) const {
    std::vector<std::uint64_t> keys;
    if (mesh.longest_m < length) return keys;
    const std::size_t places = mesh.places.size();
    mesh.known.resize(mesh.cut.primitives.size() * places);
    for (std::size_t i = 0; i < mesh.cut.primitives.size(); ++i)
        for (std::size_t n = 0; n < places && may_cut(mesh.cut.primitives[i]); ++n)
            find_changes(mesh.cut.primitives[i], mesh.places[n], length, mesh.known[i * places + n], keys);
    return keys;
}

Refiner::MarkedHere Refiner::mark_edges(CutMesh& mesh, const Marks& marks) const {
    MarkedHere here{{}, marks.shortest_m, 0};
    mesh.edges.assign(mesh.cut.primitives.size(), {});
    const double min_m = marks.shortest_m - key_slack_m;
    if (mesh.longest_m < min_m) return here;
    for (std::size_t i = 0; i < mesh.edges.size(); ++i) {
        const importer::Primitive& p = mesh.cut.primitives[i];
        if (!may_cut(p)) continue;
        std::vector<std::vector<dvec3>> placed;
        for (const dmat4& place : mesh.places) placed.push_back(placed_points(p, place));
        for (std::size_t k = 0; k < p.indices.size(); ++k) {
            const std::uint32_t a = p.indices[k], b = p.indices[k % 3 == 2 ? k - 2 : k + 1];
            const auto is_marked = [&](const std::vector<dvec3>& at) {
                return glm::length(at[a] - at[b]) >= min_m && marks.keys.contains(key_of(at[a], at[b]));
            };
            if (std::none_of(placed.begin(), placed.end(), is_marked)) continue;
            here.added += mesh.places.size();
            mesh.edges[i].push_back(edge_of(a, b));
            for (const std::vector<dvec3>& at : placed) {
                const double size_m = glm::length(at[a] - at[b]);
                if (size_m < key_slack_m) continue;  // squeezed flat
                add_keys(at[a], at[b], here.keys);
                here.shortest_m = std::min(here.shortest_m, size_m);
            }
        }
        std::sort(mesh.edges[i].begin(), mesh.edges[i].end());
        mesh.edges[i].erase(std::unique(mesh.edges[i].begin(), mesh.edges[i].end()), mesh.edges[i].end());
    }
    return here;
}

/// Marks every edge that lies where one is marked, wherever its mesh stands, until none is added. Returns how many triangles that
/// adds; where it is more than what is left, some may be missing.
std::uint64_t Refiner::mark_edges(Marks& marks, std::uint64_t left) {
    while (!marks.keys.empty()) {
        std::vector<MarkedHere> here(meshes_.size());
        for_all_(meshes_.size(), [&](std::size_t m) { here[m] = mark_edges(meshes_[m], marks); });
        const std::size_t before = marks.keys.size();
        std::uint64_t added = 0;
        for (const MarkedHere& one : here) {
            marks.keys.insert(one.keys.begin(), one.keys.end());
            marks.shortest_m = std::min(marks.shortest_m, one.shortest_m);
            added += one.added;
        }
        if (marks.keys.size() == before || added > left) return added;
    }
    return 0;
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

/// One triangle, or what it falls into: edges alone decide, so its neighbours fit.
void cut_triangle(const std::uint32_t* corners, const std::map<Edge, std::uint32_t>& middles, std::vector<std::uint32_t>& out) {
    std::array<std::uint32_t, 3> v{corners[0], corners[1], corners[2]}, middle{};
    std::array<bool, 3> has{};
    int count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto found = middles.find(edge_of(v[k], v[(k + 1) % 3]));
        has[k] = found != middles.end();
        if (has[k]) middle[k] = found->second, ++count;
    }
    // Turned until the first edge is the only one that is cut, or the only one that is not.
    while ((count == 1 && !has[0]) || (count == 2 && has[0])) {
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

void Refiner::cut_edges(CutMesh& mesh) {
    for (std::size_t i = 0; i < mesh.edges.size(); ++i) {
        if (mesh.edges[i].empty()) continue;
        importer::Primitive& p = mesh.cut.primitives[i];
        std::map<Edge, std::uint32_t> middles;
        for (const Edge& edge : mesh.edges[i]) middles.emplace(edge, add_middle(p, edge));
        std::vector<std::uint32_t> out;
        out.reserve(p.indices.size() * 2);
        for (std::size_t t = 0; t + 2 < p.indices.size(); t += 3) cut_triangle(&p.indices[t], middles, out);
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
