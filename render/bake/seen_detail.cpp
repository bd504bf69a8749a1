// Rays through the ground's trees, on the lattice of each mesh.
#include "render/bake/seen_detail.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "render/model/ground/near.hpp"

namespace surefoot::bake {

namespace {

constexpr int ray_headings = 16;
constexpr double ray_slopes[] = {0.0, 0.25};

constexpr double no_way = 1e300;  // stands for 1 / 0: a product with it is huge, or 0 where a side is touched

/// A ray origin + t * way, where 0 < t <= max_t.
struct ViewRay {
    dvec3 origin, way;
    double max_t;

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

/// Where a ray comes into boxes low + unit * (min .. max), each grown by `slack`.
struct BoxEntry {
    dvec3 scale, at_min, at_max;

    BoxEntry(const ViewRay& ray, const dvec3& low, const dvec3& unit, double slack) {
        for (int axis = 0; axis < 3; ++axis) {
            const double inverse = ray.way[axis] != 0 ? 1 / ray.way[axis] : no_way;
            scale[axis] = unit[axis] * inverse;
            at_min[axis] = (low[axis] - slack - ray.origin[axis]) * inverse;
            at_max[axis] = (low[axis] + slack - ray.origin[axis]) * inverse;
        }
    }
    /// Infinite: the box is missed, or further than max_t.
    [[nodiscard]] double of(const dvec3& min, const dvec3& max, double max_t) const {
        const dvec3 a = min * scale + at_min, b = max * scale + at_max;
        const dvec3 in = glm::min(a, b), out = glm::max(a, b);
        const double from = std::max({0.0, in.x, in.y, in.z}), to = std::min({max_t, out.x, out.y, out.z});
        return from <= to ? from : std::numeric_limits<double>::infinity();
    }
};

/// The leaves that a ray comes to before `max_t`, which use(leaf) makes smaller; the nearer half of each span first.
/// entry(node) -> where the ray comes into it.
template <class Entry, class Use>
void for_leaves_on_ray(std::uint32_t count, const double& max_t, const Entry& entry, const Use& use) {
    if (count == 0) return;
    struct Waiting {
        model::ground_tree::Span span;
        double from;
    };
    std::array<Waiting, 40> stack;  // halves: one waiting span a level, 32 levels at most
    std::size_t top = 0;
    stack[top++] = {{0, 0, count}, entry(0)};
    while (top > 0) {
        const auto [span, from] = stack[--top];
        if (!(from <= max_t)) continue;
        if (span.count == 1) {
            use(span.first);
            continue;
        }
        const std::uint32_t left = (span.count + 1) / 2, right = span.count / 2;
        const Waiting first{{span.node + 1, span.first, left}, entry(span.node + 1)};
        const Waiting second{{span.node + 2 * left, span.first + left, right}, entry(span.node + 2 * left)};
        const bool in_order = first.from <= second.from;
        stack[top++] = in_order ? second : first;
        stack[top++] = in_order ? first : second;
    }
}

/// The first block that the ray meets from its front, by numbers of its own for each instance. Else 0.
class FirstBlock {
public:
    FirstBlock(const model::Ground& ground, const ViewRay& ray) : ground_(ground), max_t_(ray.max_t) {
        in_mesh(ground.meshes[0], ray, 1);
        const BoxEntry entry(ray, dvec3(0.0), dvec3(1.0), 0);
        const auto entry_of = [&](std::uint32_t node) {
            return entry.of(ground.instance_boxes[node].min, ground.instance_boxes[node].max, max_t_);
        };
        for_leaves_on_ray(static_cast<std::uint32_t>(ground.instances.size()), max_t_, entry_of, [&](std::uint32_t number) {
            const model::GroundInstance& instance = ground.instances[number];
            const dmat3 inverse = glm::inverse(dmat3(instance.linear));
            in_mesh(ground.meshes[instance.mesh], {inverse * (ray.origin - instance.origin), inverse * ray.way, ray.max_t},
                    std::uint64_t{number} + 2);
        });
    }
    [[nodiscard]] std::uint64_t found() const { return found_; }

private:
    void in_mesh(const model::GroundMesh& mesh, const ViewRay& local, std::uint64_t owner) {
        ViewRay ray = {(local.origin - mesh.origin) / mesh.step_m, local.way / mesh.step_m, max_t_};
        const dvec3 low(mesh.min[0], mesh.min[1], mesh.min[2]);
        const BoxEntry entry(ray, low, (dvec3(mesh.max[0], mesh.max[1], mesh.max[2]) - low) / 65535.0, 1);
        const auto entry_of = [&](std::uint32_t node) {
            const model::GroundBox& box = ground_.boxes[mesh.first_node + node];
            return entry.of({box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}, ray.max_t);
        };
        for_leaves_on_ray(mesh.block_count, ray.max_t, entry_of, [&](std::uint32_t leaf) {
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
