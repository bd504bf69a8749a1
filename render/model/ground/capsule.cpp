// Distances of a vertical segment to a triangle, and the convex search for the first contact.
#include "render/model/ground/capsule.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::model {

namespace {

/// The nearest pair of a segment and a triangle so far.
struct Nearest {
    double distance2 = std::numeric_limits<double>::infinity();
    dvec3 apart{0.0};  ///< from the triangle to the segment

    void offer(const dvec3& on_segment, const dvec3& on_triangle) {
        const dvec3 d = on_segment - on_triangle;
        const double d2 = glm::dot(d, d);
        if (d2 < distance2) distance2 = d2, apart = d;
    }
};

/// Below it a triangle is a sliver: its normal, squared, over the fourth power of its sides.
constexpr double min_shape = 1e-6;

double part_of(double numerator, double denominator) {
    return denominator > 0 ? std::clamp(numerator / denominator, 0.0, 1.0) : 0.0;
}

/// Segment from p along u, edge from q along v (Ericson 2005, Real-Time Collision Detection, 5.1.9).
void offer_edge(Nearest& nearest, const dvec3& p, const dvec3& u, const dvec3& q, const dvec3& v) {
    const dvec3 r = p - q;
    const double uu = glm::dot(u, u), vv = glm::dot(v, v), uv = glm::dot(u, v), ur = glm::dot(u, r), vr = glm::dot(v, r);
    const double denominator = uu * vv - uv * uv;
    double s = denominator > 1e-12 * uu * vv ? std::clamp((uv * vr - ur * vv) / denominator, 0.0, 1.0) : 0.0;
    double t = vv > 0 ? (uv * s + vr) / vv : 0.0;
    if (t < 0 || t > 1) {
        t = std::clamp(t, 0.0, 1.0);
        s = part_of(uv * t - ur, uu);
    }
    nearest.offer(p + s * u, q + t * v);
}

/// Whether the triangle with normal n covers p, seen along n. On the rim either answer will do: there the edge is as near.
bool covers(const GroundTriangle& t, const dvec3& n, const dvec3& p) {
    return glm::dot(glm::cross(t.b - t.a, p - t.a), n) >= 0 && glm::dot(glm::cross(t.c - t.b, p - t.b), n) >= 0 &&
           glm::dot(glm::cross(t.a - t.c, p - t.c), n) >= 0;
}

}  // namespace

Separation separation(const Capsule& capsule, const GroundTriangle& t) {
    const dvec3 low = capsule.low, axis(0, capsule.length, 0), high = low + axis;
    const dvec3 n = glm::cross(t.b - t.a, t.c - t.a);
    const double n2 = glm::dot(n, n);
    Nearest nearest;
    bool within = false;  // of the triangle: no edge is nearer
    if (n2 > 0) {
        const double from_low = glm::dot(low - t.a, n), from_high = glm::dot(high - t.a, n);
        const bool crosses = (from_low < 0) != (from_high < 0);
        if (crosses) {
            const double s = from_low / (from_low - from_high);
            const dvec3 through = low + s * axis;
            if (covers(t, n, through)) return {0, n / std::sqrt(n2)};
        }
        const auto offer_end = [&](const dvec3& end, double from) {
            const bool covered = covers(t, n, end);
            if (covered) nearest.offer(end, end - n * (from / n2));
            return covered;
        };
        const bool low_is_nearer = std::abs(from_low) <= std::abs(from_high);
        const bool of_nearer = low_is_nearer ? offer_end(low, from_low) : offer_end(high, from_high);
        if (!of_nearer) (void)(low_is_nearer ? offer_end(high, from_high) : offer_end(low, from_low));
        // On one side of the plane no point of the segment is nearer to it than its nearer end. Slivers have no exact normal.
        const double sides2 = glm::dot(t.b - t.a, t.b - t.a) + glm::dot(t.c - t.a, t.c - t.a);
        within = of_nearer && !crosses && n2 > min_shape * sides2 * sides2;
    }
    if (!within) {
        offer_edge(nearest, low, axis, t.a, t.b - t.a);
        offer_edge(nearest, low, axis, t.b, t.c - t.b);
        offer_edge(nearest, low, axis, t.c, t.a - t.c);
    }
    const double distance = std::sqrt(nearest.distance2);
    if (distance > 0) return {distance, nearest.apart / distance};
    return {0, n2 > 0 ? n / std::sqrt(n2) : dvec3(0, 1, 0)};
}

double min_separation(const Capsule& capsule, const GroundTriangle& t) {
    const dvec3 middle = (t.a + t.b + t.c) * (1.0 / 3.0), a = t.a - middle, b = t.b - middle, c = t.c - middle;
    const double y = std::clamp(middle.y, capsule.low.y, capsule.low.y + capsule.length);
    const dvec3 to_middle(middle.x - capsule.low.x, middle.y - y, middle.z - capsule.low.z);
    const double of_sphere = glm::length(to_middle) - std::sqrt(std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)}));
    const dvec3 n = glm::cross(t.b - t.a, t.c - t.a);
    const double low = glm::dot(capsule.low - t.a, n), high = low + capsule.length * n.y, n2 = glm::dot(n, n);
    if (!(low * high > 0) || !(n2 > 0)) return of_sphere;
    return std::max(of_sphere, std::min(std::abs(low), std::abs(high)) / std::sqrt(n2));
}

Contact first_contact(const Capsule& capsule, const dvec3& move, const GroundTriangle& triangle, double until) {
    constexpr double tolerance_m = 1e-9;
    constexpr int max_steps = 48;  // a grazing contact halves its error with each; any other doubles its digits
    const double length = glm::length(move);
    until = std::min(until, 1.0);
    if (!(length > 0) || min_separation(capsule, triangle) > capsule.radius + until * length + tolerance_m) return {};
    Contact contact;
    double share = 0;
    Capsule moved = capsule;
    for (int i = 0; i < max_steps; ++i) {
        const Separation s = separation(moved, triangle);
        const double approach = s.distance > 0 ? -glm::dot(s.away, move) : std::abs(glm::dot(s.away, move));  // m a move
        if (approach <= 1e-12 * length) return {};  // from here on it only gets away
        const double left = s.distance - capsule.radius;
        contact.away = s.distance > 0 || glm::dot(s.away, move) < 0 ? s.away : -s.away;
        if (left <= tolerance_m) break;
        share += left / approach;
        if (share > until) return {};
        moved.low = capsule.low + share * move;
    }
    contact.share = share;
    return contact;
}

double height_at(const GroundTriangle& t, double x, double z) {
    constexpr double no_height = -std::numeric_limits<double>::infinity();
    const dvec2 p(x, z), a(t.a.x, t.a.z), b(t.b.x, t.b.z), c(t.c.x, t.c.z);
    const auto cross = [](const dvec2& u, const dvec2& v) { return u.x * v.y - u.y * v.x; };
    const double of_c = cross(b - a, p - a), of_a = cross(c - b, p - b), of_b = cross(a - c, p - c), all = of_a + of_b + of_c;
    if (all == 0 || of_a * all < 0 || of_b * all < 0 || of_c * all < 0) return no_height;
    return (of_a * t.a.y + of_b * t.b.y + of_c * t.c.y) / all;
}

Crossing crossing_of(const dvec3& from, const dvec3& way, const GroundTriangle& t) {
    const dvec3 u = t.b - t.a, v = t.c - t.a, n = glm::cross(u, v);
    const double along = glm::dot(way, n);
    if (along == 0) return {};
    const double share = glm::dot(t.a - from, n) / along;
    if (!(share >= 0 && share <= 1)) return {};
    const dvec3 p = from + share * way;
    const bool inside = glm::dot(glm::cross(u, p - t.a), n) >= 0 && glm::dot(glm::cross(t.c - t.b, p - t.b), n) >= 0 &&
                        glm::dot(glm::cross(t.a - t.c, p - t.c), n) >= 0;
    return inside ? Crossing{share, along > 0} : Crossing{};
}

}  // namespace surefoot::model
