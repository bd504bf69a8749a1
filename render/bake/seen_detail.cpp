// Rays through the ground's trees, on the lattice of each mesh.
#include "render/bake/seen_detail.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "render/model/ground/near.hpp"

namespace surefoot::bake {

namespace {

constexpr int ray_headings = 16;
constexpr double ray_slopes[] = {0.0, 0.25};

/// A ray origin + t * way, where 0 < t <= max_t.
struct ViewRay {
    dvec3 origin, way;
    double max_t;

    [[nodiscard]] bool meets(const Box& box) const {
        double from = 0, to = max_t;
        for (int axis = 0; axis < 3; ++axis) {
            if (way[axis] == 0) {
                if (origin[axis] < box.min[axis] || origin[axis] > box.max[axis]) return false;
                continue;
            }
            const double a = (box.min[axis] - origin[axis]) / way[axis], b = (box.max[axis] - origin[axis]) / way[axis];
            from = std::max(from, std::min(a, b)), to = std::min(to, std::max(a, b));
        }
        return from <= to;
    }
    /// Shortens the ray where it meets the triangle, from either side. > 0: its front; < 0: its back; 0: it misses.
    [[nodiscard]] double shorten(const model::GroundTriangle& t) {
        const dvec3 ab = t.b - t.a, ac = t.c - t.a, across = glm::cross(way, ac);
        const double area = glm::dot(ab, across);
        if (area == 0) return 0;
        const dvec3 from = origin - t.a, up = glm::cross(from, ab);
        const double u = glm::dot(from, across) / area, v = glm::dot(way, up) / area, at = glm::dot(ac, up) / area;
        if (!(u >= 0 && v >= 0 && u + v <= 1 && at > 0 && at < max_t)) return 0;
        max_t = at;
        return area;
    }
};

/// The first block that the ray meets from its front, by numbers of its own for each instance. Else 0.
class FirstBlock {
public:
    FirstBlock(const model::Ground& ground, const ViewRay& ray) : ground_(ground), max_t_(ray.max_t) {
        in_mesh(ground.meshes[0], ray, 1);
        const auto passes = [&](std::uint32_t node) { return shortened(ray).meets(ground.instance_boxes[node]); };
        model::ground_tree::for_leaves(static_cast<std::uint32_t>(ground.instances.size()), passes, [&](std::uint32_t number) {
            const model::GroundInstance& instance = ground.instances[number];
            const dmat3 inverse = glm::inverse(dmat3(instance.linear));
            in_mesh(ground.meshes[instance.mesh], {inverse * (ray.origin - instance.origin), inverse * ray.way, ray.max_t},
                    std::uint64_t{number} + 2);
        });
    }
    [[nodiscard]] std::uint64_t found() const { return found_; }

private:
    [[nodiscard]] ViewRay shortened(ViewRay ray) const {
        ray.max_t = max_t_;
        return ray;
    }
    void in_mesh(const model::GroundMesh& mesh, const ViewRay& local, std::uint64_t owner) {
        ViewRay ray = {(local.origin - mesh.origin) / mesh.step_m, local.way / mesh.step_m, max_t_};
        const dvec3 low(mesh.min[0], mesh.min[1], mesh.min[2]);
        const dvec3 unit = (dvec3(mesh.max[0], mesh.max[1], mesh.max[2]) - low) / 65535.0;
        const auto passes = [&](std::uint32_t node) {
            const model::GroundBox& box = ground_.boxes[mesh.first_node + node];
            return ray.meets({low + unit * dvec3(box.min[0], box.min[1], box.min[2]) - 1.0,
                              low + unit * dvec3(box.max[0], box.max[1], box.max[2]) + 1.0});
        };
        model::ground_tree::for_leaves(mesh.block_count, passes, [&](std::uint32_t leaf) {
            const std::uint32_t block = mesh.first_block + leaf;
            // On the lattice: no triangle is placed, each shortens the ray or not.
            const auto shorten = [&](const model::GroundTriangle& t) {
                const double side = ray.shorten(t);
                if (side != 0) found_ = side > 0 ? owner << 32U | block : 0;
                return false;
            };
            model::ground_tree::in_block(
                ground_, mesh, ground_.blocks[block], [](const dvec3& p) { return p; }, shorten,
                [](const model::GroundTriangle&) {});
        });
        max_t_ = ray.max_t;
    }

    const model::Ground& ground_;
    double max_t_;
    std::uint64_t found_ = 0;
};

}  // namespace

std::size_t blocks_seen(const model::Ground& ground, const dvec3& eye, double reach_m) {
    if (ground.empty()) return 0;
    std::vector<std::uint64_t> blocks;
    for (const double slope : ray_slopes) {
        for (int i = 0; i < ray_headings; ++i) {
            const double heading =
                2 * std::numbers::pi * (i + slope) / ray_headings;  // rows of rays do not stand above each other
            const dvec3 way = glm::normalize(dvec3(std::cos(heading), slope, std::sin(heading)));
            if (const std::uint64_t block = FirstBlock(ground, {eye, way, reach_m}).found(); block != 0) blocks.push_back(block);
        }
    }
    std::sort(blocks.begin(), blocks.end());
    return static_cast<std::size_t>(std::unique(blocks.begin(), blocks.end()) - blocks.begin());
}

}  // namespace surefoot::bake
