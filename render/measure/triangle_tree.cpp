// Nearest triangle by a tree of boxes (mesh_distance.hpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "render/measure/mesh_distance.hpp"

namespace surefoot::measure {

namespace {

constexpr std::uint32_t leaf_triangles = 4;

// Distance to a triangle by region (Ericson, Real-Time Collision Detection 5.1.5). The nearest point is a combination of the
// corners with weights in 0..1: however thin the triangle, it lies on it, so the distance is never too small. In double: on
// slivers the regions' signs drown in float, and the distance came out several per cent too large.
double distance2(const vec3& point, const vec3& corner_a, const vec3& corner_b, const vec3& corner_c) {
    const dvec3 p(point), a(corner_a), b(corner_b), c(corner_c);
    const auto along = [](double num, double den) { return den > 0 ? std::clamp(num / den, 0.0, 1.0) : 0.0; };
    const auto to = [&p](const dvec3& q) { return glm::dot(p - q, p - q); };
    const dvec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return to(a);
    const dvec3 bp = p - b;
    const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return to(b);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return to(a + along(d1, d1 - d3) * ab);
    const dvec3 cp = p - c;
    const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return to(c);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return to(a + along(d2, d2 - d6) * ac);
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return to(b + along(d4 - d3, (d4 - d3) + (d5 - d6)) * (c - b));
    const double sum = va + vb + vc;
    const double v = along(vb, sum), w = std::min(along(vc, sum), 1.0 - v);
    const double inside = to(a + v * ab + w * ac);
    // Where all of it is what rounding left (and that differs with every compiler's way of rounding), the weights are anybody's:
    // so thin a triangle is its edges.
    const double terms =
        std::abs(d1 * d4) + std::abs(d3 * d2) + std::abs(d5 * d2) + std::abs(d1 * d6) + std::abs(d3 * d6) + std::abs(d5 * d4);
    if (sum > 1e-9 * terms) return inside;
    const auto edge = [&](const dvec3& from, const dvec3& way) {
        return to(from + along(glm::dot(p - from, way), glm::dot(way, way)) * way);
    };
    return std::min({inside, edge(a, ab), edge(a, ac), edge(b, c - b)});
}

float box_distance2(const vec3& p, const vec3& low, const vec3& high) {
    const vec3 away = glm::max(glm::max(low - p, p - high), vec3(0.0F));
    return glm::dot(away, away);
}

}  // namespace

TriangleTree::TriangleTree(const MeshView& mesh) {
    std::vector<Corners> source(mesh.triangles());
    std::vector<vec3> centres(mesh.triangles());
    for (std::size_t i = 0; i < source.size(); ++i) {
        source[i] = {mesh.positions[mesh.indices[3 * i]], mesh.positions[mesh.indices[3 * i + 1]],
                     mesh.positions[mesh.indices[3 * i + 2]]};
        centres[i] = 0.5F * (glm::min(glm::min(source[i].a, source[i].b), source[i].c) +
                             glm::max(glm::max(source[i].a, source[i].b), source[i].c));
    }
    std::vector<std::uint32_t> order(source.size());
    std::iota(order.begin(), order.end(), 0U);
    corners_.reserve(source.size());
    nodes_.reserve(source.size() / 2 + 1);
    if (!order.empty()) build(order, source, centres);
    if (!nodes_.empty()) diagonal_ = glm::length(nodes_[0].max - nodes_[0].min);
}

std::uint32_t TriangleTree::build(std::span<std::uint32_t> order, const std::vector<Corners>& source,
                                  const std::vector<vec3>& centres) {
    const auto self = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    Node node{vec3(std::numeric_limits<float>::infinity()), vec3(-std::numeric_limits<float>::infinity())};
    vec3 low = node.min, high = node.max;
    for (const std::uint32_t i : order) {
        const Corners& t = source[i];
        node.min = glm::min(node.min, glm::min(glm::min(t.a, t.b), t.c));
        node.max = glm::max(node.max, glm::max(glm::max(t.a, t.b), t.c));
        low = glm::min(low, centres[i]);
        high = glm::max(high, centres[i]);
    }
    if (order.size() <= leaf_triangles) {
        node.first = static_cast<std::uint32_t>(corners_.size());
        node.count = static_cast<std::uint32_t>(order.size());
        for (const std::uint32_t i : order) corners_.push_back(source[i]);
        in_mesh_.insert(in_mesh_.end(), order.begin(), order.end());
    } else {
        const vec3 extent = high - low;
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
        const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
        std::nth_element(order.begin(), middle, order.end(), [&](std::uint32_t i, std::uint32_t j) {
            return centres[i][axis] < centres[j][axis] || (centres[i][axis] == centres[j][axis] && i < j);
        });
        build(order.first(order.size() / 2), source, centres);
        node.first = build(order.subspan(order.size() / 2), source, centres);
    }
    nodes_[self] = node;
    return self;
}

float TriangleTree::distance_to(std::uint32_t triangle, const vec3& p) const {
    const Corners& t = corners_[triangle];
    return static_cast<float>(std::sqrt(distance2(p, t.a, t.b, t.c)));
}

TriangleTree::Hit TriangleTree::nearest(const vec3& p, std::uint32_t hint) const {
    Hit best;
    if (hint < corners_.size()) best = {distance_to(hint, p), hint};
    float best2 = best.distance * best.distance;
    struct StackEntry {
        std::uint32_t node;
        float distance2;
    };
    std::array<StackEntry, 64> stack;  // median splits halve: depth <= 32 and one waiting sibling a level
    std::size_t top = 0;
    stack[top++] = {0, box_distance2(p, nodes_[0].min, nodes_[0].max)};
    while (top > 0) {
        const StackEntry visit = stack[--top];
        if (visit.distance2 >= best2) continue;
        const Node& node = nodes_[visit.node];
        if (node.count > 0) {
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                const auto d2 = static_cast<float>(distance2(p, corners_[i].a, corners_[i].b, corners_[i].c));
                if (d2 < best2) {
                    best2 = d2;
                    best.triangle = i;
                }
            }
            continue;
        }
        StackEntry left{visit.node + 1, 0}, right{node.first, 0};
        left.distance2 = box_distance2(p, nodes_[left.node].min, nodes_[left.node].max);
        right.distance2 = box_distance2(p, nodes_[right.node].min, nodes_[right.node].max);
        if (left.distance2 > right.distance2) std::swap(left, right);
        if (right.distance2 < best2) stack[top++] = right;
        if (left.distance2 < best2) stack[top++] = left;
    }
    best.distance = std::sqrt(best2);
    return best;
}

}  // namespace surefoot::measure
