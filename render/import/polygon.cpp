// Triangulates simple polygons: a fan if convex, else ear clipping with exact orientation tests.
#include "render/import/polygon.hpp"

#include <array>
#include <cmath>
#include <numeric>

namespace surefoot::importer {
namespace {

/// Ear clipping takes time quadratic in the corners; larger polygons are rare and mostly wrong.
constexpr std::size_t max_corners = 5000;

/// Exact sum of doubles as a non-overlapping expansion, smallest first (Shewchuk, grow-expansion).
struct Expansion {
    std::array<double, 13> parts{};
    std::size_t count = 0;

    void add(double value) {
        double carry = value;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const double sum = carry + parts[i];
            const double shadow = sum - carry;
            const double rest = (carry - (sum - shadow)) + (parts[i] - shadow);
            if (rest != 0.0) parts[kept++] = rest;
            carry = sum;
        }
        if (carry != 0.0) parts[kept++] = carry;
        count = kept;
    }
    void add_product(double x, double y) {
        const double product = x * y;
        add(std::fma(x, y, -product));
        add(product);
    }
    [[nodiscard]] int sign() const { return count == 0 ? 0 : parts[count - 1] > 0 ? 1 : -1; }
};

/// Newell's normal: right for any simple polygon, planar or nearly so.
dvec3 newell_normal(std::span<const dvec3> corners) {
    dvec3 n(0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const dvec3 a = corners[i] - corners[0], b = corners[(i + 1) % corners.size()] - corners[0];
        n += glm::cross(a, b);
    }
    return n;
}

/// Drops the axis along which the polygon is flattest: coordinates stay the exact input, and turn counter-clockwise.
std::vector<dvec2> project(std::span<const dvec3> corners) {
    const dvec3 n = newell_normal(corners);
    const dvec3 a = glm::abs(n);
    const int drop = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    const int u = (drop + 1) % 3, v = (drop + 2) % 3;
    std::vector<dvec2> flat;
    flat.reserve(corners.size());
    for (const dvec3& c : corners) flat.push_back(n[drop] >= 0 ? dvec2(c[u], c[v]) : dvec2(c[v], c[u]));
    return flat;
}

/// Never turns right, and turns once in all: a pentagram never turns right either.
bool convex(const std::vector<dvec2>& p) {
    const std::size_t n = p.size();
    int turns_up = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const dvec2 &a = p[i], &b = p[(i + 1) % n], &c = p[(i + 2) % n];
        if (orientation(a, b, c) < 0) return false;
        if ((b.y > a.y || (b.y == a.y && b.x > a.x)) != (c.y > b.y || (c.y == b.y && c.x > b.x))) ++turns_up;
    }
    return turns_up <= 2;
}

bool inside(const dvec2& p, const dvec2& a, const dvec2& b, const dvec2& c) {
    return orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 && orientation(c, a, p) >= 0;
}

bool is_ear(const std::vector<dvec2>& p, const std::vector<std::uint32_t>& ring, std::size_t i) {
    const std::size_t n = ring.size();
    const dvec2 &a = p[ring[(i + n - 1) % n]], &b = p[ring[i]], &c = p[ring[(i + 1) % n]];
    if (orientation(a, b, c) <= 0) return false;
    for (std::size_t k = 2; k + 1 < n; ++k) {
        const dvec2& q = p[ring[(i + k) % n]];
        if (q != a && q != b && q != c && inside(q, a, b, c)) return false;
    }
    return true;
}

void cut(std::vector<std::uint32_t>& ring, std::size_t i, std::vector<std::uint32_t>& out) {
    const std::size_t n = ring.size();
    out.insert(out.end(), {ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
}

/// A corner that lies on the line through its neighbours: cut it off only when no ear is left, its triangle is empty.
std::size_t flat_corner(const std::vector<dvec2>& p, const std::vector<std::uint32_t>& ring) {
    const std::size_t n = ring.size();
    for (std::size_t i = 0; i < n; ++i) {
        if (orientation(p[ring[(i + n - 1) % n]], p[ring[i]], p[ring[(i + 1) % n]]) == 0) return i;
    }
    return n;
}

void fan(const std::vector<std::uint32_t>& ring, std::vector<std::uint32_t>& out) {
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) out.insert(out.end(), {ring[0], ring[i], ring[i + 1]});
}

}  // namespace

int orientation(const dvec2& a, const dvec2& b, const dvec2& c) {
    const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
    const double det = left - right;
    if (std::abs(det) > 4e-16 * (std::abs(left) + std::abs(right))) return det > 0 ? 1 : -1;
    Expansion exact;
    exact.add_product(a.x, b.y);
    exact.add_product(-a.y, b.x);
    exact.add_product(b.x, c.y);
    exact.add_product(-b.y, c.x);
    exact.add_product(c.x, a.y);
    exact.add_product(-c.y, a.x);
    return exact.sign();
}

bool triangulate(std::span<const dvec3> corners, std::vector<std::uint32_t>& out) {
    if (corners.size() < 3) return true;
    std::vector<std::uint32_t> ring(corners.size());
    std::iota(ring.begin(), ring.end(), 0U);
    if (corners.size() == 3 || corners.size() > max_corners) {
        fan(ring, out);
        return corners.size() == 3;
    }
    const std::vector<dvec2> flat = project(corners);
    if (convex(flat)) {
        fan(ring, out);
        return true;
    }
    std::size_t at = 0, tried = 0;
    while (ring.size() > 3) {
        const std::size_t n = ring.size();
        if (tried < n) {
            if (!is_ear(flat, ring, at % n)) {
                ++at;
                ++tried;
                continue;
            }
            cut(ring, at % n, out);
        } else if (const std::size_t i = flat_corner(flat, ring); i < n) {
            cut(ring, i, out);
        } else {
            fan(ring, out);
            return false;
        }
        tried = 0;
    }
    fan(ring, out);
    return true;
}

}  // namespace surefoot::importer
