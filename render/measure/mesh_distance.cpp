// Two-sided distance of meshes: a box tree for nearest points, a convexity bound with subdivision on top.
#include "render/measure/mesh_distance.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/random.hpp"

namespace surefoot::measure {

namespace {

float box_distance2(const vec3& p, const vec3& lo, const vec3& hi) {
    const vec3 d = glm::max(glm::max(lo - p, p - hi), vec3(0));
    return glm::dot(d, d);
}

/// Closest point on a triangle, after Ericson, Real-Time Collision Detection, 5.1.5.
vec3 closest_point(const vec3& p, const vec3& a, const vec3& b, const vec3& c) {
    const vec3 ab = b - a, ac = c - a, ap = p - a;
    const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const vec3 bp = p - b;
    const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / std::max(d1 - d3, 1e-30F));
    const vec3 cp = p - c;
    const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / std::max(d2 - d6, 1e-30F));
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        return b + (c - b) * ((d4 - d3) / std::max((d4 - d3) + (d5 - d6), 1e-30F));
    }
    const float denominator = va + vb + vc;
    if (denominator <= 0) return a;  // degenerate: its edges were tried above
    return a + ab * (vb / denominator) + ac * (vc / denominator);
}

}  // namespace

float point_triangle_distance(const vec3& p, const TriangleTree::Triangle& t) {
    return glm::length(p - closest_point(p, t.a, t.b, t.c));
}

TriangleTree::TriangleTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
    if (triangles_.empty()) return;
    nodes_.reserve(triangles_.size());
    nodes_.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(triangles_.size()), 0);
}

void TriangleTree::build(std::uint32_t node, std::uint32_t first, std::uint32_t count, int depth) {
    vec3 lo(1e30F), hi(-1e30F), centre_lo(1e30F), centre_hi(-1e30F);
    for (std::uint32_t i = first; i < first + count; ++i) {
        const Triangle& t = triangles_[i];
        lo = glm::min(lo, glm::min(t.a, glm::min(t.b, t.c)));
        hi = glm::max(hi, glm::max(t.a, glm::max(t.b, t.c)));
        const vec3 centre = t.a + t.b + t.c;
        centre_lo = glm::min(centre_lo, centre);
        centre_hi = glm::max(centre_hi, centre);
    }
    nodes_[node].min = lo;
    nodes_[node].max = hi;
    if (count <= 4 || depth > 40) {
        nodes_[node].first = first;
        nodes_[node].count = count;
        return;
    }
    const vec3 size = centre_hi - centre_lo;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto key = [axis](const Triangle& t) { return t.a[axis] + t.b[axis] + t.c[axis]; };
    const std::uint32_t half = count / 2;
    std::nth_element(triangles_.begin() + first, triangles_.begin() + first + half, triangles_.begin() + first + count,
                     [&](const Triangle& a, const Triangle& b) { return key(a) < key(b); });
    const auto children = static_cast<std::uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[node].first = children;
    nodes_[node].count = 0;
    build(children, first, half, depth + 1);
    build(children + 1, first + half, count - half, depth + 1);
}

TriangleTree::Nearest TriangleTree::nearest(const vec3& p, float start) const {
    float best2 = start * start;
    Nearest found{start, 0};
    struct Open {
        std::uint32_t node;
        float distance2;
    };
    std::array<Open, 96> stack;
    std::size_t depth = 0;
    stack[depth++] = {0, box_distance2(p, nodes_[0].min, nodes_[0].max)};
    while (depth > 0) {
        const Open open = stack[--depth];
        if (open.distance2 >= best2) continue;
        const Node& node = nodes_[open.node];
        if (node.count > 0) {
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                const Triangle& t = triangles_[i];
                const vec3 d = p - closest_point(p, t.a, t.b, t.c);
                const float d2 = glm::dot(d, d);
                if (d2 < best2) {
                    best2 = d2;
                    found = {std::sqrt(d2), i};
                }
            }
            continue;
        }
        Open l{node.first, box_distance2(p, nodes_[node.first].min, nodes_[node.first].max)};
        Open r{node.first + 1, box_distance2(p, nodes_[node.first + 1].min, nodes_[node.first + 1].max)};
        if (l.distance2 < r.distance2) std::swap(l, r);
        stack[depth++] = l;  // the nearer is looked at first
        stack[depth++] = r;
    }
    return found;
}

namespace {

struct BoundWalk {
    const TriangleTree& to;
    float slack, floor_m;
    float proven = 0;  ///< largest distance of any point seen: a lower bound
    float bound = 0;

    void visit(const TriangleTree::Triangle& t, int depth);
};

void BoundWalk::visit(const TriangleTree::Triangle& t, int depth) {
    constexpr float far = 1e15F;
    const TriangleTree::Nearest near[4] = {to.nearest(t.a, far), to.nearest(t.b, far), to.nearest(t.c, far),
                                           to.nearest((t.a + t.b + t.c) * (1.0F / 3.0F), far)};
    for (const auto& n : near) proven = std::max(proven, n.distance);
    float upper = far;
    for (const auto& n : near) {
        const TriangleTree::Triangle& s = to.triangles()[n.triangle];
        upper = std::min(upper, std::max({point_triangle_distance(t.a, s), point_triangle_distance(t.b, s), point_triangle_distance(t.c, s)}));
    }
    if (upper <= bound || upper <= floor_m || upper <= proven * slack || depth == 5) {
        bound = std::max(bound, upper);
        return;
    }
    const vec3 ab = 0.5F * (t.a + t.b), bc = 0.5F * (t.b + t.c), ca = 0.5F * (t.c + t.a);
    visit({t.a, ab, ca}, depth + 1);
    visit({ab, t.b, bc}, depth + 1);
    visit({ca, bc, t.c}, depth + 1);
    visit({ab, bc, ca}, depth + 1);
}

}  // namespace

float directed_bound(const TriangleTree& from, const TriangleTree& to, float slack, float floor_m) {
    if (from.empty() || to.empty()) return from.empty() ? 0.0F : 1e15F;
    BoundWalk walk{to, slack, floor_m};
    for (const TriangleTree::Triangle& t : from.triangles()) walk.visit(t, 0);
    return walk.bound;
}

float two_sided_bound(const TriangleTree& a, const TriangleTree& b, float slack, float floor_m) {
    return std::max(directed_bound(a, b, slack, floor_m), directed_bound(b, a, slack, floor_m));
}

float sampled_distance(const TriangleTree& from, const TriangleTree& to, std::uint32_t n, std::uint64_t seed) {
    if (from.empty() || to.empty()) return 0;
    std::vector<double> sums;
    double sum = 0;
    for (const auto& t : from.triangles()) sums.push_back(sum += 0.5 * glm::length(glm::cross(t.b - t.a, t.c - t.a)));
    Random random(seed);
    float worst = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
        const auto at = std::lower_bound(sums.begin(), sums.end(), random.unit() * sum) - sums.begin();
        const auto& t = from.triangles()[std::min<std::size_t>(static_cast<std::size_t>(at), sums.size() - 1)];
        const float r = std::sqrt(static_cast<float>(random.unit())), s = static_cast<float>(random.unit());
        worst = std::max(worst, to.nearest(t.a * (1 - r) + t.b * (r * (1 - s)) + t.c * (r * s), 1e15F).distance);
    }
    return worst;
}

}  // namespace surefoot::measure
