// Building by bins, and going down from near to far.
#include "render/bake/ray_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "render/model/ground/near.hpp"

namespace surefoot::bake {

namespace {

constexpr std::uint32_t leaf_triangles = 4;
constexpr std::size_t split_bins = 12;
constexpr float far_share = 2;          // above 1: nothing is hit
constexpr float rim_share = 1e-6F;      // triangles are so much wider, in shares of their sides: fewer rays slip between two
constexpr std::uint8_t max_depth = 44;  // deeper nodes are not split
constexpr float tiny = 1e-30F;          // in place of a component of 0: its inverse is finite

/// A way without zeros.
vec3 slanted(const dvec3& way) {
    vec3 out(way);
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(out[axis]) < tiny) out[axis] = out[axis] < 0 ? -tiny : tiny;
    return out;
}

/// The share of a way at which it comes into a box before `until`; far_share: nowhere.
[[gnu::always_inline]] inline float enters(const vec3& low, const vec3& high, const vec3& from, const vec3& inverse,
                                           float until) {
    const vec3 a = (low - from) * inverse, b = (high - from) * inverse;
    const vec3 near = glm::min(a, b), far = glm::max(a, b);
    const float enter = std::max(std::max(near.x, near.y), std::max(near.z, 0.0F));
    const float leave = std::min(std::min(far.x, far.y), std::min(far.z, until));
    return enter <= leave ? enter : far_share;
}

}  // namespace

/// Grown by what it holds.
struct RayTree::Bounds {
    vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
    void grow(const vec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
    void grow(const Bounds& other) { low = glm::min(low, other.low), high = glm::max(high, other.high); }
    [[nodiscard]] float half_area() const {
        const vec3 side = glm::max(high - low, vec3(0.0F));
        return side.x * side.y + side.y * side.z + side.z * side.x;
    }
};

/// A mesh's triangles while they are sorted into its nodes.
struct RayTree::Building {
    Mesh& mesh;
    std::vector<Bounds> bounds;
    std::vector<vec3> centre;
    std::vector<std::uint32_t> order;
    std::vector<std::uint8_t> depth;  ///< by node

    explicit Building(Mesh& of) : mesh(of) {
        for (const Triangle& t : mesh.triangles) {
            Bounds b;
            b.grow(t.corner), b.grow(t.corner + t.u), b.grow(t.corner + t.v);
            bounds.push_back(b);
            centre.push_back(0.5F * (b.low + b.high));
            order.push_back(static_cast<std::uint32_t>(order.size()));
        }
    }
    void build() {
        mesh.nodes.push_back({{}, {}, 0, static_cast<std::uint32_t>(order.size())});
        depth.push_back(0);
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
            const std::uint32_t first = mesh.nodes[n].first, count = mesh.nodes[n].count;
            const std::span<std::uint32_t> of(&order[first], count);
            Bounds all;
            for (const std::uint32_t t : of) all.grow(bounds[t]);
            const vec3 rim = 1e-5F * (all.high - all.low) + 1e-6F * glm::max(glm::abs(all.low), glm::abs(all.high)) + 1e-6F;
            mesh.nodes[n].low = all.low - rim;
            mesh.nodes[n].high = all.high + rim;
            const std::uint32_t left = count > leaf_triangles && depth[n] < max_depth ? split(of, all) : 0;
            if (left == 0) continue;
            const auto child = static_cast<std::uint32_t>(mesh.nodes.size());
            mesh.nodes[n].first = child;
            mesh.nodes[n].count = 0;
            depth.insert(depth.end(), 2, static_cast<std::uint8_t>(depth[n] + 1));
            mesh.nodes.push_back({{}, {}, first, left});
            mesh.nodes.push_back({{}, {}, first + left, count - left});
        }
        std::vector<Triangle> sorted;
        for (const std::uint32_t t : order) sorted.push_back(mesh.triangles[t]);
        mesh.triangles = std::move(sorted);
    }
    /// Sorts the triangles of a node into two halves, and returns how many are in the first; 0: they stay together.
    std::uint32_t split(std::span<std::uint32_t> of, const Bounds& all) const {
        Bounds middles;
        for (const std::uint32_t t : of) middles.grow(centre[t]);
        const vec3 extent = middles.high - middles.low;
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
        if (!(extent[axis] > 0.0F)) return 0;
        const auto bin_of = [&](std::uint32_t t) {
            const float at = (centre[t][axis] - middles.low[axis]) / extent[axis] * static_cast<float>(split_bins);
            return std::min(split_bins - 1, static_cast<std::size_t>(std::max(at, 0.0F)));
        };
        std::array<Bounds, split_bins> box;
        std::array<std::uint32_t, split_bins> number{};
        for (const std::uint32_t t : of) box[bin_of(t)].grow(bounds[t]), ++number[bin_of(t)];
        std::array<float, split_bins> after{};  // cost of all split_bins behind one
        Bounds behind;
        std::uint32_t there = 0;
        for (std::size_t b = split_bins; b-- > 1;) {
            behind.grow(box[b]);
            there += number[b];
            after[b] = there > 0 ? behind.half_area() * static_cast<float>(there) : 0.0F;
        }
        float lowest = std::numeric_limits<float>::max();
        std::size_t cut = 0;
        Bounds before;
        std::uint32_t here = 0;
        for (std::size_t b = 0; b + 1 < split_bins; ++b) {
            before.grow(box[b]);
            here += number[b];
            if (here == 0 || here == of.size()) continue;
            const float cost = before.half_area() * static_cast<float>(here) + after[b + 1];
            if (cost < lowest) lowest = cost, cut = b + 1;
        }
        const bool worth = lowest < all.half_area() * static_cast<float>(of.size()) || of.size() > 4 * leaf_triangles;
        if (cut == 0 || !worth) return 0;
        const auto half = std::stable_partition(of.begin(), of.end(), [&](std::uint32_t t) { return bin_of(t) < cut; });
        return static_cast<std::uint32_t>(half - of.begin());
    }
};

RayTree::RayTree(const model::Ground& ground) : ground_(ground) {
    for (const model::GroundMesh& mesh : ground.meshes) meshes_.push_back(make_mesh(ground, mesh));
    for (const model::GroundInstance& instance : ground.instances) inverse_.push_back(glm::inverse(dmat3(instance.linear)));
    for (const Box& box : ground.instance_boxes) around_.push_back({box.centre(), vec3(box.half()) * 1.00001F + 1e-5F});
}

RayTree::Mesh RayTree::make_mesh(const model::Ground& ground, const model::GroundMesh& mesh) {
    Mesh out;
    dvec3 low(mesh.min[0], mesh.min[1], mesh.min[2]), high(mesh.max[0], mesh.max[1], mesh.max[2]);
    out.middle = mesh.origin + mesh.step_m * 0.5 * (low + high);
    for (std::uint32_t b = mesh.first_block; b < mesh.first_block + mesh.block_count; ++b)
        model::ground_tree::in_block(
            ground, mesh, ground.blocks[b], [](const dvec3& p) { return p; }, [](const auto&) { return true; },
            [&](const model::GroundTriangle& t) {
                out.triangles.push_back({vec3(t.a - out.middle), vec3(t.b - t.a), vec3(t.c - t.a)});
            });
    if (!out.triangles.empty()) Building(out).build();
    return out;
}

/// Lowers `share` to the nearest hit that is not beyond it, or to any. False: there is none.
bool RayTree::cross_mesh(const Mesh& mesh, const LocalRay& ray, bool any, float& share) {
    if (mesh.nodes.empty()) return false;
    bool found = false;
    const vec3 inverse = 1.0F / ray.way;
    struct Waiting {
        std::uint32_t node;
        float at;
    };
    std::array<Waiting, 2 * max_depth + 4> stack;  // not filled with zeros for each ray
    std::size_t top = 0;
    const auto push = [&](std::uint32_t n) {
        const float at = enters(mesh.nodes[n].low, mesh.nodes[n].high, ray.from, inverse, share);
        if (at < far_share) stack[top++] = {n, at};
    };
    push(0);
    while (top > 0) {
        const auto [n, at] = stack[--top];
        if (at > share) continue;
        const Node& node = mesh.nodes[n];
        if (node.count == 0) {
            const std::size_t before = top;
            push(node.first);
            push(node.first + 1);
            if (top == before + 2 && stack[before].at < stack[before + 1].at) std::swap(stack[before], stack[before + 1]);
            continue;
        }
        for (std::uint32_t t = node.first; t < node.first + node.count; ++t) {
            const Triangle& triangle = mesh.triangles[t];
            const vec3 p = glm::cross(ray.way, triangle.v);
            const float det = glm::dot(triangle.u, p);
            if (!(std::abs(det) > 0.0F)) continue;
            const float over = 1.0F / det;
            const vec3 to = ray.from - triangle.corner;
            const float u = glm::dot(to, p) * over;
            if (!(u >= -rim_share && u <= 1.0F + rim_share)) continue;
            const vec3 q = glm::cross(to, triangle.u);
            const float v = glm::dot(ray.way, q) * over;
            if (!(v >= -rim_share && u + v <= 1.0F + rim_share)) continue;
            const float hit = glm::dot(triangle.v, q) * over;
            if (!(hit >= 0.0F && hit <= share)) continue;
            share = hit;
            found = true;
            if (any) return true;
        }
    }
    return found;
}

float RayTree::first_share(const Ray& ray, bool any) const {
    const dvec3 way = ray.max_m * ray.direction;
    float share = far_share;
    if (meshes_.empty()) return share;
    float limit = 1;  // of what counts
    const auto cross = [&](const Mesh& mesh, const dvec3& from, const dvec3& local_way) {
        if (cross_mesh(mesh, {vec3(from - mesh.middle), slanted(local_way)}, any, limit)) share = limit;
    };
    cross(meshes_[0], ray.from, way);
    const dvec3 to = ray.from + way;
    const Box box{glm::min(ray.from, to), glm::max(ray.from, to)};
    const vec3 inverse = 1.0F / slanted(way);
    model::ground_tree::for_leaves(
        static_cast<std::uint32_t>(ground_.instances.size()),
        [&](std::uint32_t node) {
            if (any && share <= 1) return false;
            if (!model::ground_tree::overlap(box, ground_.instance_boxes[node])) return false;
            const Around& around = around_[node];
            return enters(-around.half, around.half, vec3(ray.from - around.middle), inverse, limit) < far_share;
        },
        [&](std::uint32_t number) {
            const model::GroundInstance& instance = ground_.instances[number];
            cross(meshes_[instance.mesh], inverse_[number] * (ray.from - instance.origin), inverse_[number] * way);
        });
    return share;
}

double RayTree::nearest_hit_m(const Ray& ray) const {
    const float share = first_share(ray, false);
    return share <= 1 ? double{share} * ray.max_m : std::numeric_limits<double>::infinity();
}

bool RayTree::is_blocked(const Ray& ray) const { return first_share(ray, true) <= 1; }

}  // namespace surefoot::bake
