// Judges distances, contacts, floors and crossings by closed forms. Shares no code with the product, which it checks.
#include "tests/ground/exact_ground.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/ground/exact_shapes.hpp"

namespace surefoot::exact {
namespace {

// --- Distances. Each candidate is a pair of true points, so that rounding never makes a distance too small. ---

using Real = long double;
using Point = glm::vec<3, Real>;
using Face = std::array<Point, 3>;
constexpr Real infinite = std::numeric_limits<Real>::infinity();

Point nearest_on(const Point& a, const Point& b, const Point& to) {
    const Point ab = b - a;
    const Real square = glm::dot(ab, ab);
    return square > 0 ? a + std::clamp<Real>(glm::dot(to - a, ab) / square, 0, 1) * ab : a;
}

/// Distance to the face's inside; infinite if the point does not lie over it.
Real gap_to_inside(const Face& face, const Point& from) {
    const Point ab = face[1] - face[0], ac = face[2] - face[0], to = from - face[0];
    const Point normal = glm::cross(ab, ac);
    const Real square = glm::dot(normal, normal);
    if (!(square > 0)) return infinite;
    const Real b = glm::dot(glm::cross(to, ac), normal) / square, c = glm::dot(glm::cross(ab, to), normal) / square;
    return b >= 0 && c >= 0 && b + c <= 1 ? glm::length(to - b * ab - c * ac) : infinite;
}

/// Distance of the segment p-q to the edge, near the place where their lines come nearest; the ends are for the caller.
Real gap_of_lines(const Point& p, const Point& q, const Point& a, const Point& b) {
    const Point d = q - p, e = b - a, r = a - p;
    const Real dd = glm::dot(d, d), ee = glm::dot(e, e), de = glm::dot(d, e);
    const Real area = dd * ee - de * de;
    if (!(area > 0)) return infinite;
    const Point at = p + std::clamp<Real>((glm::dot(d, r) * ee - glm::dot(e, r) * de) / area, 0, 1) * d;
    return glm::length(nearest_on(a, b, at) - at);
}

/// Distance of the upright segment to the triangle.
Real gap(const Face& face, const Point& low, Real length) {
    const Point high = low + Point(0, length, 0);
    Real smallest = std::min(gap_to_inside(face, low), gap_to_inside(face, high));
    for (std::size_t i = 0; i < 3; ++i) {
        const Point &a = face[i], &b = face[(i + 1) % 3];
        for (const Point& end : {low, high}) smallest = std::min(smallest, glm::length(nearest_on(a, b, end) - end));
        smallest = std::min(smallest, glm::length(nearest_on(low, high, a) - a));
        smallest = std::min(smallest, gap_of_lines(low, high, a, b));
    }
    const Point normal = glm::cross(face[1] - face[0], face[2] - face[0]);
    const Real under = glm::dot(normal, low - face[0]), over = glm::dot(normal, high - face[0]);
    if ((under < 0 && over > 0) || (under > 0 && over < 0))
        smallest = std::min(smallest, gap_to_inside(face, low + under / (under - over) * (high - low)));
    return smallest;
}

/// Seen from `origin`, which keeps the digits.
Face seen_from(const Corners& corners, const dvec3& origin) {
    return {Point(corners[0]) - Point(origin), Point(corners[1]) - Point(origin), Point(corners[2]) - Point(origin)};
}

constexpr Real noise_m = 1e-12L;

/// One triangle, as the segment's low end moves from 0 to `move`. Its distance is a convex function of the share of the move.
class Approach {
public:
    Approach(const Face& face, Real length, Real radius, const Point& move)
        : face_(face), length_(length), radius_(radius), move_(move) {}

    /// Share of the first contact up to `end`; ExactGround::none without.
    [[nodiscard]] double first(Real end) const {
        const Real start = at(0);
        if (start - glm::length(move_) * end > radius_) return ExactGround::none;
        const bool starts_within = start <= radius_;
        const Real lowest = nearest_share(end, starts_within ? -infinite : radius_ - noise_m);
        if (starts_within) return lowest > 1e-9L && at(lowest) < start - noise_m ? 0.0 : ExactGround::none;
        if (!(at(lowest) < radius_ - noise_m)) return ExactGround::none;
        Real outside = 0, within = lowest;
        while (within - outside > 1e-13L) {
            const Real middle = (outside + within) / 2;
            (at(middle) > radius_ ? outside : within) = middle;
        }
        return static_cast<double>(within);
    }

private:
    [[nodiscard]] Real at(Real share) const { return gap(face_, share * move_, length_); }

    /// Golden section. Stops at any share whose distance is under `enough`.
    [[nodiscard]] Real nearest_share(Real end, Real enough) const {
        constexpr Real golden = 0.6180339887498948482045868L;
        Real low = 0, high = end;
        Real a = high - golden * (high - low), b = low + golden * (high - low);
        Real at_a = at(a), at_b = at(b);
        while (high - low > 1e-13L && std::min(at_a, at_b) >= enough) {
            if (at_a <= at_b) {
                high = b;
                b = a;
                at_b = at_a;
                a = high - golden * (high - low);
                at_a = at(a);
            } else {
                low = a;
                a = b;
                at_a = at_b;
                b = low + golden * (high - low);
                at_b = at(b);
            }
        }
        const Real best = at_a <= at_b ? a : b;
        return std::min(at(0), at(end)) < at(best) ? (at(0) <= at(end) ? 0 : end) : best;
    }

    Face face_;
    Real length_, radius_;
    Point move_;
};

Box grown(const Box& box, double by) { return {box.min - by, box.max + by}; }

bool meet(const Box& a, const Box& b) {
    return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

/// Share of a-b at which it goes through the triangle.
std::optional<Real> crossing(const Corners& corners, const dvec3& a, const dvec3& b) {
    const Face face = seen_from(corners, a);
    const Point to = Point(b) - Point(a);
    const Point normal = glm::cross(face[1] - face[0], face[2] - face[0]);
    const Real from_a = glm::dot(normal, -face[0]), from_b = glm::dot(normal, to - face[0]);
    if (!((from_a < 0 && from_b > 0) || (from_a > 0 && from_b < 0))) return {};
    const Real u = glm::dot(to, glm::cross(face[1], face[2])), v = glm::dot(to, glm::cross(face[2], face[0]));
    const Real w = glm::dot(to, glm::cross(face[0], face[1]));
    if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) return {};
    const Real share = from_a / (from_a - from_b);
    const dvec3 at(Point(a) + share * to);
    if (!meet(grown(box_of(corners), 1e-9), {at, at})) return {};  // rounding, for a segment in the triangle's plane
    return share;
}

/// No triangle whose sphere is further than this from the way of the segment's middle can be touched.
bool surely_missed(const Corners& t, const dvec3& low, double length, double radius, const dvec3& move) {
    const dvec3 centre = (t[0] + t[1] + t[2]) / 3.0, middle = low + dvec3(0.0, length / 2, 0.0);
    double sphere = 0;
    for (const dvec3& corner : t) sphere = std::max(sphere, glm::length(corner - centre));
    const double squared = glm::dot(move, move);
    const double share = squared > 0 ? std::clamp(glm::dot(centre - middle, move) / squared, 0.0, 1.0) : 0.0;
    return glm::length(middle + share * move - centre) > sphere + length / 2 + radius + 1e-6;
}

}  // namespace

void Bins::add(const Box& box, std::uint32_t number) {
    const dvec3 size = box.max - box.min;
    const double longest = std::max({size.x, size.y, size.z});
    const int level = longest > 0.0078125 ? std::ilogb(longest) + 1 : -7;
    const dvec3 bin = glm::floor(box.min / std::ldexp(1.0, level));
    levels_[level].push_back({{bin.x, bin.z, bin.y}, number});
}

void Bins::sort() {
    for (auto& [level, entries] : levels_) std::sort(entries.begin(), entries.end());
}

std::vector<std::uint32_t> Bins::near(const Box& box) const {
    std::vector<std::uint32_t> found;
    for (const auto& [level, entries] : levels_) {
        const dvec3 first = glm::floor(box.min / std::ldexp(1.0, level)) - 1.0;  // a box reaches into the next bin
        const dvec3 last = glm::floor(box.max / std::ldexp(1.0, level));
        const auto from = [&sorted = entries](double x, double z, double y) {
            return std::lower_bound(sorted.begin(), sorted.end(), Entry{{x, z, y}, 0});
        };
        auto entry = from(first.x, first.z, first.y);
        while (entry != entries.end() && entry->bin[0] <= last.x) {
            const auto [x, z, y] = entry->bin;
            if (z > last.z)
                entry = from(x + 1.0, first.z, first.y);
            else if (z < first.z)
                entry = from(x, first.z, first.y);
            else if (y > last.y)
                entry = from(x, z + 1.0, first.y);
            else if (y < first.y)
                entry = from(x, z, first.y);
            else
                found.push_back((entry++)->number);
        }
    }
    return found;
}

void Columns::build(std::span<const Box> boxes) {
    constexpr std::size_t max_columns = 4096;  // of one box
    boxes_.assign(boxes.begin(), boxes.end());
    Box all;
    for (const Box& box : boxes) all.grow(box);
    if (boxes.empty()) return;
    sides_ = std::min<std::size_t>(1024, 2 + static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(boxes.size()))));
    first_.assign(sides_ * sides_ + 1, 0);
    const auto sides = static_cast<double>(sides_);
    low_x_ = all.min.x;
    low_z_ = all.min.z;
    side_m_ = std::max({(all.max.x - all.min.x) / (sides - 1), (all.max.z - all.min.z) / (sides - 1), 1e-6});
    const auto cell_of = [&](double at, double low) {
        return static_cast<std::size_t>(std::clamp(std::floor((at - low) / side_m_), 0.0, sides - 1));
    };
    const auto each_cell = [&](const Box& box, const auto& use) {
        const std::size_t x0 = cell_of(box.min.x, low_x_), x1 = cell_of(box.max.x, low_x_);
        const std::size_t z0 = cell_of(box.min.z, low_z_), z1 = cell_of(box.max.z, low_z_);
        if ((x1 - x0 + 1) * (z1 - z0 + 1) > max_columns) return false;
        for (std::size_t z = z0; z <= z1; ++z)
            for (std::size_t x = x0; x <= x1; ++x) use(z * sides_ + x);
        return true;
    };
    for (std::uint32_t i = 0; i < boxes_.size(); ++i)
        if (!each_cell(boxes_[i], [&](std::size_t cell) { ++first_[cell + 1]; })) wide_.push_back(i);
    for (std::size_t cell = 0; cell < sides_ * sides_; ++cell) first_[cell + 1] += first_[cell];
    numbers_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < boxes_.size(); ++i) each_cell(boxes_[i], [&](std::size_t cell) { numbers_[next[cell]++] = i; });
}

ExactGround::ExactGround(const importer::Scene& scene, const std::vector<std::vector<bool>>& blocking) {
    for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
        if (blocking.at(n).empty()) continue;
        std::uint32_t t = 0;
        for (const importer::Primitive& primitive : scene.meshes.at(scene.nodes[n].mesh).primitives) {
            for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3, ++t) {
                Triangle triangle{{}, {n, t}};
                for (std::size_t c = 0; c < 3; ++c) {
                    const dvec3 corner(primitive.positions.at(primitive.indices[i + c]));
                    triangle.corners[c] = dvec3(scene.nodes[n].world * dvec4(corner, 1.0));
                }
                if (!blocking[n].at(t) || !is_finite(triangle.corners)) continue;
                bins_.add(box_of(triangle.corners), static_cast<std::uint32_t>(triangles_.size()));
                triangles_.push_back(triangle);
            }
        }
    }
    bins_.sort();
    std::vector<Box> boxes;
    for (const Triangle& triangle : triangles_) boxes.push_back(box_of(triangle.corners));
    columns_.build(boxes);
}

double ExactGround::distance(const dvec3& low, double length, double up_to) const {
    const Box segment{low, low + dvec3(0.0, length, 0.0)};
    for (double within = up_to / 16.0;; within = std::min(2.0 * within, up_to)) {
        Real smallest = infinite;
        const Box around = grown(segment, within);
        for (const std::uint32_t t : bins_.near(around))
            if (meet(box_of(triangles_[t].corners), around) &&
                !surely_missed(triangles_[t].corners, low, length, std::min(static_cast<double>(smallest), within), dvec3(0.0)))
                smallest = std::min(smallest, gap(seen_from(triangles_[t].corners, low), Point(0), length));
        if (smallest <= within) return static_cast<double>(smallest);
        if (!(within < up_to)) return std::numeric_limits<double>::infinity();
    }
}

double ExactGround::penetration(const dvec3& low, double length, double radius) const {
    return std::max(0.0, radius - distance(low, length, radius));
}

double ExactGround::first_contact(const dvec3& low, double length, double radius, const dvec3& move) const {
    Box swept{low, low + dvec3(0.0, length, 0.0)};
    swept.grow(Box{swept.min + move, swept.max + move});
    const Box around = grown(swept, radius + 1e-9);
    double first = none;
    for (const std::uint32_t t : bins_.near(around)) {
        if (!meet(box_of(triangles_[t].corners), around)) continue;
        if (surely_missed(triangles_[t].corners, low, length, radius, move)) continue;
        const Approach approach(seen_from(triangles_[t].corners, low), length, radius, Point(move));
        first = std::min(first, approach.first(std::min(first, 1.0)));
        if (first <= 0.0) break;
    }
    return first;
}

std::vector<double> ExactGround::floors_at(double x, double z, double min_normal_y) const {
    std::vector<double> heights;
    columns_.at(x, z, [&](std::uint32_t t) {
        const Face face = seen_from(triangles_[t].corners, triangles_[t].corners[0]);
        const Point normal = glm::cross(face[1], face[2]);
        if (!(std::abs(normal.y) >= min_normal_y * glm::length(normal))) return;
        if (const std::optional<double> height = height_at(triangles_[t].corners, x, z)) heights.push_back(*height);
    });
    std::sort(heights.begin(), heights.end());
    return heights;
}

std::optional<Hit> ExactGround::crosses(const dvec3& a, const dvec3& b) const {
    const int pieces = static_cast<int>(std::clamp(std::ceil(glm::length(b - a) / 2.0), 1.0, 1000.0));
    const dvec3 step = (b - a) / static_cast<double>(pieces);
    std::optional<Hit> hit;
    Real first = infinite;
    for (int piece = 0; piece < pieces; ++piece) {
        Box box;
        box.grow(a + step * static_cast<double>(piece));
        box.grow(a + step * static_cast<double>(piece + 1));
        const Box around = grown(box, 1e-6);
        for (const std::uint32_t t : bins_.near(around)) {
            if (!meet(box_of(triangles_[t].corners), around)) continue;
            const std::optional<Real> share = crossing(triangles_[t].corners, a, b);
            if (share && *share < first) {
                first = *share;
                hit = triangles_[t].id;
            }
        }
        if (first * pieces <= piece + 1) break;
    }
    return hit;
}

}  // namespace surefoot::exact
