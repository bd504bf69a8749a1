// Splits triangles at medians into blocks, and quantises them.
#include "render/bake/ground_build.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

namespace surefoot::bake {

namespace {

using Point = std::array<std::int32_t, 3>;
using Lattice = std::array<Point, 3>;  // a triangle

constexpr double max_lattice = 2147483000.0;

/// Largest power of two that is at most `value`.
double power_of_two(double value) { return std::exp2(std::floor(std::log2(value))); }

double step_for(const Box& box, double step_m) {
    const dvec3 sides = box.max - box.min;
    const double extent = std::max({sides.x, sides.y, sides.z, 1e-20});
    double step = power_of_two(std::min(step_m, extent / 65536));
    while (extent / step > max_lattice) step *= 2;
    return step;
}

/// Splits a range of triangles into as many blocks as it needs, left half first, as the implicit tree has them.
class Splitter {
public:
    Splitter(GroundTree& tree, const std::vector<Lattice>& triangles) : tree_(tree), triangles_(triangles) {}

    void split(std::span<std::uint32_t> order, std::uint32_t blocks) {
        if (blocks == 1) return add_block(order);
        const std::uint32_t left = (blocks + 1) / 2;
        const std::size_t middle = (order.size() * left + blocks - 1) / blocks;
        const std::size_t axis = widest(order);
        std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(middle), order.end(),
                         [&](std::uint32_t i, std::uint32_t j) {
                             const std::int64_t a = twice_centre(i, axis), b = twice_centre(j, axis);
                             return a < b || (a == b && i < j);
                         });
        split(order.first(middle), left);
        split(order.subspan(middle), blocks - left);
    }
    [[nodiscard]] const std::vector<std::array<Point, 2>>& boxes() const { return boxes_; }

private:
    [[nodiscard]] std::int64_t twice_centre(std::uint32_t i, std::size_t axis) const {
        const Lattice& t = triangles_[i];
        const auto [low, high] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
        return std::int64_t{low} + high;
    }
    [[nodiscard]] std::size_t widest(std::span<const std::uint32_t> order) const {
        std::size_t best = 0;
        std::int64_t extent = -1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::int64_t low = std::numeric_limits<std::int64_t>::max(), high = std::numeric_limits<std::int64_t>::min();
            for (const std::uint32_t i : order) {
                const std::int64_t c = twice_centre(i, axis);
                low = std::min(low, c), high = std::max(high, c);
            }
            if (high - low > extent) extent = high - low, best = axis;
        }
        return best;
    }
    void add_block(std::span<const std::uint32_t> order) {
        std::vector<Point> corners;
        std::vector<std::uint8_t> numbers;
        std::array<Point, 2> box{triangles_[order[0]][0], triangles_[order[0]][0]};
        for (const std::uint32_t i : order) {
            for (const Point& p : triangles_[i]) {
                auto at = std::find(corners.begin(), corners.end(), p);
                if (at == corners.end()) at = corners.insert(corners.end(), p);
                numbers.push_back(static_cast<std::uint8_t>(at - corners.begin()));
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    box[0][axis] = std::min(box[0][axis], p[axis]);
                    box[1][axis] = std::max(box[1][axis], p[axis]);
                }
            }
        }
        model::GroundBlock block;
        block.origin = box[0];
        block.first_byte = static_cast<std::uint32_t>(tree_.bytes.size());
        block.corners = static_cast<std::uint8_t>(corners.size());
        block.triangles = static_cast<std::uint8_t>(order.size());
        for (std::size_t axis = 0; axis < 3; ++axis) block.wide |= std::int64_t{box[1][axis]} - box[0][axis] > 65535;
        for (const Point& p : corners) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto offset = static_cast<std::uint32_t>(std::int64_t{p[axis]} - block.origin[axis]);
                const std::size_t size = block.wide ? 4 : 2, at = tree_.bytes.size();
                tree_.bytes.resize(at + size);
                std::memcpy(tree_.bytes.data() + at, &offset, size);  // little-endian
            }
        }
        for (const std::uint8_t n : numbers) tree_.bytes.push_back(std::byte{n});
        tree_.blocks.push_back(block);
        boxes_.push_back(box);
    }

    GroundTree& tree_;
    const std::vector<Lattice>& triangles_;
    std::vector<std::array<Point, 2>> boxes_;  // by block
};

model::GroundBox in_shares(const model::GroundMesh& mesh, const std::array<Point, 2>& box) {
    model::GroundBox out;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double low = mesh.min[axis], extent = static_cast<double>(mesh.max[axis]) - low;
        const double scale = extent > 0 ? 65535.0 / extent : 0.0;
        out.min[axis] = static_cast<std::uint16_t>(std::floor((box[0][axis] - low) * scale));
        out.max[axis] = static_cast<std::uint16_t>(std::min(65535.0, std::ceil((box[1][axis] - low) * scale)));
    }
    return out;
}

/// Boxes of the implicit tree below `node`; returns that of the node on the lattice.
std::array<Point, 2> fill_nodes(GroundTree& tree, const std::vector<std::array<Point, 2>>& of_blocks, std::size_t node,
                                std::size_t first, std::size_t count) {
    std::array<Point, 2> box = of_blocks[first];
    if (count > 1) {
        const std::size_t left = (count + 1) / 2;
        box = fill_nodes(tree, of_blocks, node + 1, first, left);
        const std::array<Point, 2> right = fill_nodes(tree, of_blocks, node + 2 * left, first + left, count - left);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box[0][axis] = std::min(box[0][axis], right[0][axis]);
            box[1][axis] = std::max(box[1][axis], right[1][axis]);
        }
    }
    tree.boxes[node] = in_shares(tree.mesh, box);
    return box;
}

void order_range(const std::vector<dvec3>& centres, std::span<std::uint32_t> order) {
    if (order.size() < 2) return;
    Box box;
    for (const std::uint32_t i : order) box.grow(centres[i]);
    const dvec3 sides = box.max - box.min;
    const int axis = sides.x >= sides.y && sides.x >= sides.z ? 0 : (sides.y >= sides.z ? 1 : 2);
    const std::size_t left = (order.size() + 1) / 2;
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(left), order.end(),
                     [&](std::uint32_t i, std::uint32_t j) {
                         return centres[i][axis] < centres[j][axis] || (centres[i][axis] == centres[j][axis] && i < j);
                     });
    order_range(centres, order.first(left));
    order_range(centres, order.subspan(left));
}

}  // namespace

GroundTree build_tree(std::span<const model::GroundTriangle> triangles, double step_m) {
    GroundTree tree;
    Box box;
    for (const model::GroundTriangle& t : triangles) box.grow(t.a), box.grow(t.b), box.grow(t.c);
    if (box.empty()) return tree;
    tree.mesh.step_m = step_for(box, step_m);
    for (int axis = 0; axis < 3; ++axis)  // on multiples of the step, so that what lies on its lattice stays where it is
        tree.mesh.origin[axis] = tree.mesh.step_m * std::floor(box.min[axis] / tree.mesh.step_m);
    const auto on_lattice = [&](const dvec3& p) {
        const dvec3 at = (p - tree.mesh.origin) / tree.mesh.step_m;
        return Point{static_cast<std::int32_t>(std::lround(at.x)), static_cast<std::int32_t>(std::lround(at.y)),
                     static_cast<std::int32_t>(std::lround(at.z))};
    };
    std::vector<Lattice> on;
    on.reserve(triangles.size());
    for (const model::GroundTriangle& t : triangles) {
        const Lattice l{on_lattice(t.a), on_lattice(t.b), on_lattice(t.c)};
        if (l[0] != l[1] && l[1] != l[2] && l[2] != l[0]) on.push_back(l);
    }
    tree.triangles = on.size();
    if (on.empty()) return tree;
    const auto blocks = static_cast<std::uint32_t>((on.size() + model::max_block_triangles - 1) / model::max_block_triangles);
    std::vector<std::uint32_t> order(on.size());
    std::iota(order.begin(), order.end(), 0U);
    Splitter splitter(tree, on);
    splitter.split(order, blocks);
    tree.mesh.block_count = blocks;
    tree.mesh.min = splitter.boxes()[0][0], tree.mesh.max = splitter.boxes()[0][1];
    for (const auto& of : splitter.boxes()) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            tree.mesh.min[axis] = std::min(tree.mesh.min[axis], of[0][axis]);
            tree.mesh.max[axis] = std::max(tree.mesh.max[axis], of[1][axis]);
        }
    }
    tree.boxes.resize(2 * std::size_t{blocks} - 1);
    fill_nodes(tree, splitter.boxes(), 0, 0, blocks);
    return tree;
}

void append(model::Ground& ground, GroundTree&& tree) {
    tree.mesh.first_block = static_cast<std::uint32_t>(ground.blocks.size());
    tree.mesh.first_node = static_cast<std::uint32_t>(ground.boxes.size());
    const auto before = static_cast<std::uint32_t>(ground.bytes.size());
    for (model::GroundBlock& block : tree.blocks) block.first_byte += before;
    ground.meshes.push_back(tree.mesh);
    ground.blocks.insert(ground.blocks.end(), tree.blocks.begin(), tree.blocks.end());
    ground.boxes.insert(ground.boxes.end(), tree.boxes.begin(), tree.boxes.end());
    ground.bytes.insert(ground.bytes.end(), tree.bytes.begin(), tree.bytes.end());
    ground.triangles += tree.triangles;
}

std::vector<std::uint32_t> order_instances(model::Ground& ground) {
    std::vector<dvec3> centres;
    for (const model::GroundInstance& instance : ground.instances) centres.push_back(model::box_of(ground, instance).centre());
    std::vector<std::uint32_t> order(centres.size());
    std::iota(order.begin(), order.end(), 0U);
    order_range(centres, order);
    std::vector<model::GroundInstance> sorted;
    sorted.reserve(order.size());
    for (const std::uint32_t i : order) sorted.push_back(ground.instances[i]);
    ground.instances = std::move(sorted);
    model::index_instances(ground);
    return order;
}

void append_moving(model::Model& model, std::span<const model::GroundTriangle> at_rest, const dvec3& pivot,
                   std::span<const model::MotionKey> keys) {
    model::Ground& rest = model.moving_ground.rest;
    if (rest.meshes.empty()) append(rest, {});  // the ground's own mesh, of which nothing moves
    append(rest, build_tree(at_rest, made_lattice_m));
    const auto number = static_cast<std::uint32_t>(model.motions.size());
    rest.instances.push_back({dvec3(0.0), mat3(1.0F), static_cast<std::uint32_t>(rest.meshes.size() - 1)});
    model.moving_ground.motions.push_back(number);
    model.motions.push_back({pivot, static_cast<std::uint32_t>(model.motion_keys.size()), static_cast<std::uint32_t>(keys.size()),
                             keys.back().time_s});
    model.motion_keys.insert(model.motion_keys.end(), keys.begin(), keys.end());
}

}  // namespace surefoot::bake
