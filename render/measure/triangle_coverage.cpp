// Subtraction of convex polygons in a triangle's plane (triangle_coverage.hpp).
#include "render/measure/triangle_coverage.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::measure {

namespace {

constexpr std::size_t max_pieces = 96;

/// A corner over the plane: place in it, and height.
using Raised = dvec3;

struct Slab {
    std::array<Raised, 8> points;
    std::size_t count = 0;
};

/// Keeps what has sign * height <= limit (Sutherland & Hodgman).
Slab clip(const Slab& from, double sign, double limit) {
    Slab to;
    for (std::size_t i = 0; i < from.count; ++i) {
        const Raised &a = from.points[i], &b = from.points[(i + 1) % from.count];
        const double da = limit - sign * a.z, db = limit - sign * b.z;
        if (da >= 0) to.points[to.count++] = a;
        if ((da < 0) != (db < 0)) {
            Raised cut = a + (da / (da - db)) * (b - a);
            cut.z = sign * limit;
            to.points[to.count++] = cut;
        }
    }
    return to;
}

double cross(const dvec2& a, const dvec2& b) { return a.x * b.y - a.y * b.x; }

double area2(const Slab& slab) {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < slab.count; ++i) {
        sum += cross(dvec2(slab.points[i] - slab.points[0]), dvec2(slab.points[i + 1] - slab.points[0]));
    }
    return sum;
}

}  // namespace

void TriangleCoverage::Polygon::measure() {
    low = high = points[0];
    for (std::size_t i = 1; i < count; ++i) {
        low = glm::min(low, points[i]);
        high = glm::max(high, points[i]);
    }
}

TriangleCoverage::TriangleCoverage(const vec3& a, const vec3& b, const vec3& c, double margin) : origin_(a), margin_(margin) {
    const dvec3 ab = dvec3(b) - dvec3(a), ac = dvec3(c) - dvec3(a);
    u_ = ab / std::max(glm::length(ab), 1e-300);
    const dvec3 n = glm::cross(ab, ac);
    normal_ = n / std::max(glm::length(n), 1e-300);
    v_ = glm::cross(normal_, u_);
    Polygon whole;
    whole.points[0] = {0, 0};
    whole.points[1] = {glm::dot(ab, u_), 0};
    whole.points[2] = {glm::dot(ac, u_), glm::dot(ac, v_)};
    whole.count = 3;
    whole.measure();
    left_.push_back(whole);
}

void TriangleCoverage::split(Polygon& inside, const dvec2& from, const dvec2& to, std::vector<Polygon>& outside) const {
    const dvec2 along = to - from;
    const double length = std::max(glm::length(along), 1e-300);
    std::array<double, 16> side{};
    bool any_out = false, any_in = false;
    for (std::size_t i = 0; i < inside.count; ++i) {
        side[i] = cross(along, inside.points[i] - from) / length + margin_;
        any_out = any_out || side[i] < 0;
        any_in = any_in || side[i] >= 0;
    }
    if (!any_out) return;
    Polygon in, out;
    for (std::size_t i = 0; any_in && i < inside.count; ++i) {
        const std::size_t k = (i + 1) % inside.count;
        (side[i] >= 0 ? in : out).points[(side[i] >= 0 ? in : out).count++] = inside.points[i];
        if ((side[i] < 0) != (side[k] < 0)) {
            const dvec2 cut = inside.points[i] + (side[i] / (side[i] - side[k])) * (inside.points[k] - inside.points[i]);
            in.points[in.count++] = cut;
            out.points[out.count++] = cut;
        }
    }
    if (!any_in) std::swap(out, inside);
    out.measure();
    outside.push_back(out);
    inside = in;
}

bool TriangleCoverage::subtract(const vec3& a, const vec3& b, const vec3& c, double within) {
    Slab slab;
    for (const vec3& corner : {a, b, c}) {
        const dvec3 away = dvec3(corner) - origin_;
        slab.points[slab.count++] = {glm::dot(away, u_), glm::dot(away, v_), glm::dot(away, normal_)};
    }
    slab = clip(clip(slab, 1.0, within), -1.0, within);
    if (slab.count < 3) return true;
    const double area = area2(slab);
    if (std::abs(area) <= margin_ * margin_) return true;
    if (area < 0) std::reverse(slab.points.begin(), slab.points.begin() + static_cast<std::ptrdiff_t>(slab.count));
    double highest = 0;
    dvec2 low(slab.points[0]), high(slab.points[0]);
    for (std::size_t i = 0; i < slab.count; ++i) {
        highest = std::max(highest, std::abs(slab.points[i].z));
        low = glm::min(low, dvec2(slab.points[i]));
        high = glm::max(high, dvec2(slab.points[i]));
    }
    next_.clear();
    bool hit = false;
    for (const Polygon& polygon : left_) {
        if (glm::any(glm::lessThan(polygon.high, low)) || glm::any(glm::greaterThan(polygon.low, high))) {
            next_.push_back(polygon);
            continue;
        }
        Polygon inside = polygon;
        parts_.clear();
        for (std::size_t i = 0; i < slab.count && inside.count > 0; ++i) {
            if (inside.count + 2 > inside.points.size()) return false;
            split(inside, dvec2(slab.points[i]), dvec2(slab.points[(i + 1) % slab.count]), parts_);
        }
        if (inside.count < 3) {  // it does not reach here: leave the piece in one
            next_.push_back(polygon);
            continue;
        }
        hit = true;
        next_.insert(next_.end(), parts_.begin(), parts_.end());
        if (next_.size() > max_pieces) return false;
    }
    if (hit) {
        std::swap(left_, next_);
        reach_ = std::max(reach_, highest);
    }
    return true;
}

vec3 TriangleCoverage::uncovered() const {
    dvec2 middle(0);
    const Polygon& polygon = left_.front();
    for (std::size_t i = 0; i < polygon.count; ++i) middle += polygon.points[i];
    middle /= static_cast<double>(polygon.count);
    return vec3(origin_ + middle.x * u_ + middle.y * v_);
}

}  // namespace surefoot::measure
