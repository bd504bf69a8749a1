// Rows: polygons that ear clipping gets wrong, and the exact sign that it rests on.
#include <array>
#include <cmath>
#include <vector>

#include "render/import/polygon.hpp"
#include "rt/base/random.hpp"
#include "tools/selftest/families.hpp"

namespace surefoot::selftest {

namespace {

double signed_area(const std::vector<dvec3>& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const dvec3 &a = p[i], &b = p[(i + 1) % p.size()];
        sum += (a.x - p[0].x) * (b.y - p[0].y) - (b.x - p[0].x) * (a.y - p[0].y);
    }
    return 0.5 * sum;
}

/// Areas of the triangles, and how many are wound against the polygon.
struct Cut {
    bool whole = false;
    std::size_t triangles = 0, wrong_indices = 0, reversed = 0;
    double area = 0;
};

Cut cut(const std::vector<dvec3>& p) {
    std::vector<std::uint32_t> out;
    Cut c;
    c.whole = importer::triangulate(p, out);
    c.triangles = out.size() / 3;
    const double all = signed_area(p);
    for (std::size_t i = 0; i + 2 < out.size(); i += 3) {
        if (out[i] >= p.size() || out[i + 1] >= p.size() || out[i + 2] >= p.size()) {
            ++c.wrong_indices;
            continue;
        }
        const double area = signed_area({p[out[i]], p[out[i + 1]], p[out[i + 2]]});
        c.area += std::abs(area);
        c.reversed += area * all < 0 ? 1 : 0;
    }
    return c;
}

std::vector<dvec3> spiral(int turns, double at) {
    std::vector<dvec3> p;
    const int n = 24 * turns;
    const auto arm = [&](int i, double out) {
        const double a = 6.283185307179586 * i / 24.0, r = 1 + 0.1 * i + out;
        return dvec3(at + r * std::cos(a), r * std::sin(a), 0);
    };
    for (int i = 0; i <= n; ++i) p.push_back(arm(i, 0));
    for (int i = n; i >= 0; --i) p.push_back(arm(i, 1.0));
    return p;
}

std::vector<dvec3> comb(int teeth, double depth) {
    std::vector<dvec3> p{{0, 0, 0}, {2.0 * teeth, 0, 0}};
    for (int i = teeth; i-- > 0;) {
        p.insert(p.end(), {{2.0 * i + 2, depth, 0}, {2.0 * i + 1, 1e-9, 0}});
    }
    p.push_back({0, depth, 0});
    return p;
}

/// A square with every edge divided: most corners lie on a line.
std::vector<dvec3> divided(int parts) {
    std::vector<dvec3> p;
    const std::array<dvec3, 4> corner{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
    for (std::size_t side = 0; side < 4; ++side) {
        for (int i = 0; i < parts; ++i)
            p.push_back(glm::mix(corner[side], corner[(side + 1) % 4], static_cast<double>(i) / parts));
    }
    return p;
}

/// A square with a hole, joined by a bridge that is walked twice; `gap` from the outer edge, 0: the hole touches it.
std::vector<dvec3> holed(double gap) {
    return {{0, 0, 0},     {10, 0, 0},  {10, 10, 0}, {0, 10, 0},  {0, 0, 0},
            {gap, gap, 0}, {gap, 5, 0}, {5, 5, 0},   {5, gap, 0}, {gap, gap, 0}};
}

void simple(const Effort& effort, Outcome& out) {
    std::vector<std::vector<dvec3>> polygons{spiral(3, 0), spiral(12, 0), spiral(4, 1e7), comb(40, 3), divided(1), divided(30)};
    Random random(7);
    for (std::uint64_t i = 0; i < effort.count(3000, 200); ++i) {  // stars: simple by construction
        std::vector<dvec3> star;
        const std::uint32_t n = 3 + random.below(30);
        for (std::uint32_t k = 0; k < n; ++k) {
            const double a = 6.283185307179586 * k / n, r = random.below(4) == 0 ? 1e-6 : random.range(0.1, 1);
            star.push_back({r * std::cos(a), r * std::sin(a), 0});
        }
        polygons.push_back(star);
    }
    double worst = 0;
    std::uint64_t wrong = 0;
    for (const auto& p : polygons) {
        const Cut c = cut(p);
        const double area = std::abs(signed_area(p));
        worst = std::max(worst, std::abs(c.area - area) / area);
        wrong += c.whole && c.wrong_indices == 0 && c.triangles == p.size() - 2 ? 0 : 1;
        out.digest_of(c.triangles * 2 + (c.whole ? 1 : 0));
    }
    out.at_most("area off, relative", worst, 1e-9);
    out.none_of("polygons not cut into n - 2 triangles", wrong);
}

void improper(const Effort&, Outcome& out) {
    const double nan = std::nan("");
    struct Case {
        std::vector<dvec3> polygon;
        double area;  ///< even-odd; negative: not checked
    };
    const std::vector<Case> cases{
        {holed(1), 84},
        {holed(1e-9), 75},
        {holed(0), 75},
        {{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}}, 16},  // corners twice
        {{{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {1, 0, 0}, {3, 0, 0}}, 0},              // on one line
        {{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}, {1, 1, 0}}, 0},                         // one point
        {{{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 4, 0}}, -1},                        // a bow tie
        {{{0, 0, 0}, {nan, 0, 0}, {1, 1, 0}, {0, 1, 0}}, -1},
        {{{0, 0, 0}, {INFINITY, 0, 0}, {1, 1, 0}, {0, 1, 0}}, -1},
        {{{0, 0, 0}, {1e200, 0, 0}, {1e200, 1e200, 0}, {3e199, 2e199, 0}, {0, 1e200, 0}}, -1},
        {{{0, 0, 0}, {1e-200, 0, 0}, {1e-200, 1e-200, 0}, {3e-201, 2e-201, 0}, {0, 1e-200, 0}}, -1},
    };
    std::uint64_t wrong = 0;
    double worst = 0;
    for (const Case& c : cases) {
        const Cut made = cut(c.polygon);
        wrong += made.wrong_indices + (made.triangles == c.polygon.size() - 2 ? 0 : 1);
        if (c.area >= 0) worst = std::max(worst, std::abs(made.area - c.area));
        out.digest_of(made.triangles * 2 + (made.whole ? 1 : 0));
    }
    std::vector<std::uint32_t> none;
    wrong += importer::triangulate({}, none) && none.empty() ? 0 : 1;
    out.none_of("polygons with an index out of range or not n - 2 triangles", wrong);
    out.at_most("area off where there is one", worst, 1e-6, "m2");
}

/// Sign of the area where plain arithmetic cannot tell: points on a line, but for some units in the last place.
void exact_sign(const Effort& effort, Outcome& out) {
    Random random(8);
    std::uint64_t wrong = 0, plain_wrong = 0, tried = 0;
    const std::uint64_t wanted = effort.count(1'000'000, 20'000);
    for (; tried < wanted && !effort.stopped(); ++tried) {
        // Whole numbers of 40 bits as coordinates: the true sign follows from 128-bit arithmetic.
        const auto whole = [&] { return static_cast<std::int64_t>(random.next() >> 24U); };
        const std::int64_t ax = whole(), ay = whole(), dx = whole() >> 12U, dy = whole() >> 12U;
        const auto k = static_cast<std::int64_t>(random.below(1000)), l = static_cast<std::int64_t>(random.below(1000));
        const std::int64_t bx = ax + k * dx, by = ay + k * dy, cx = ax + l * dx + static_cast<std::int64_t>(random.below(3)) - 1,
                           cy = ay + l * dy;
        const auto det = static_cast<__int128>(ax - cx) * (by - cy) - static_cast<__int128>(ay - cy) * (bx - cx);
        const int truth = det > 0 ? 1 : det < 0 ? -1 : 0;
        constexpr double unit = 0x1p-40;
        const dvec2 a(static_cast<double>(ax) * unit, static_cast<double>(ay) * unit),
            b(static_cast<double>(bx) * unit, static_cast<double>(by) * unit),
            c(static_cast<double>(cx) * unit, static_cast<double>(cy) * unit);
        wrong += importer::orientation(a, b, c) == truth && importer::orientation(b, c, a) == truth &&
                         importer::orientation(b, a, c) == -truth
                     ? 0
                     : 1;
        const double plain = a.x * (b.y - c.y) + b.x * (c.y - a.y) + c.x * (a.y - b.y);
        plain_wrong += (plain > 0) - (plain < 0) == truth ? 0 : 1;
    }
    out.none_of("signs wrong, in any order of the corners", wrong);
    out.at_least("of them plain arithmetic gets wrong", static_cast<double>(plain_wrong), 1);
    out.digest_of(plain_wrong == 0 ? 0 : 1);
}

}  // namespace

std::span<const Row> polygon_rows() {
    static constexpr std::array<Row, 3> table = {{
        {"N7a", "polygons", "spirals, combs, divided edges, thin stars, also 10 000 km from the origin",
         "all of the area, in n - 2 triangles", simple},
        {"N7b", "polygons", "holes that touch, corners twice, lines, points, bow ties, not a number, 1e200 and 1e-200 m",
         "it ends with n - 2 triangles of the polygon's corners, and the even-odd area where there is one", improper},
        {"N7c", "polygons", "three points on a line, but for the last place", "the exact sign, whatever the order of the corners",
         exact_sign},
    }};
    return table;
}

}  // namespace surefoot::selftest
