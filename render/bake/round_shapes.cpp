// Recognises spheres and cylinders, and tessellates them.
#include "render/bake/round_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>

namespace surefoot::bake {

namespace {

constexpr double pi = 3.14159265358979323846, tolerance = 1e-4;  // of the radius
constexpr std::size_t min_triangles = 48;                        // below, nothing is gained

/// A sphere, or a cylinder along `axis`.
struct Round {
    dvec3 centre{0.0};
    double radius = 0, half_height = 0;  ///< half_height 0: a sphere
    int axis = 1;
    double sag_m = 0;  ///< how far the geometry is inside the shape
};

using Corners = std::array<dvec3, 3>;

/// Seen from the middle of the shape.
void for_corners(const Geometry& g, const dvec3& centre, const std::function<void(const Corners&)>& use) {
    for (const GeometryPart& part : g.parts)
        for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
            Corners corners;
            for (std::size_t k = 0; k < 3; ++k) corners[k] = dvec3(position_of(g.vertices[part.indices[i + k]])) - centre;
            use(corners);
        }
}

/// Of the sphere, signed: over a closed surface round the middle they sum up to 4 pi. Source: Van Oosterom and Strackee 1983.
double solid_angle(const Corners& c) {
    const double a = glm::length(c[0]), b = glm::length(c[1]), d = glm::length(c[2]);
    const double volume = glm::dot(c[0], glm::cross(c[1], c[2]));
    const double sum = a * b * d + glm::dot(c[0], c[1]) * d + glm::dot(c[0], c[2]) * b + glm::dot(c[1], c[2]) * a;
    return 2 * std::atan2(volume, sum);
}

/// How far a triangle's plane is from the middle. The triangle itself is no nearer.
double plane_distance(const Corners& c) {
    const dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
    const double length = glm::length(normal);
    return length > 0 ? std::abs(glm::dot(normal, c[0])) / length : glm::length(c[0]);
}

/// The geometry's corners as points: those of one place count as one, within 10^-5 of the size.
class Welded {
public:
    Welded(const Geometry& g, double size) {
        std::map<std::array<std::int64_t, 3>, std::uint32_t> points;
        const double cell = 1e-5 * size;
        for (const std::uint32_t index : g.parts[0].indices) {
            const dvec3 at(position_of(g.vertices[index]));
            const std::array<std::int64_t, 3> key{std::llround(at.x / cell), std::llround(at.y / cell),
                                                  std::llround(at.z / cell)};
            const auto [entry, fresh] = points.try_emplace(key, static_cast<std::uint32_t>(points.size()));
            if (fresh) middle_ += at;
            of_.push_back(entry->second);
        }
        middle_ /= std::max<double>(1.0, static_cast<double>(points.size()));
    }
    /// The mean of all points: of a whole round shape with even sides, its middle.
    [[nodiscard]] const dvec3& middle() const { return middle_; }
    /// Whether each side of a triangle has just one neighbour, which goes along it the other way.
    [[nodiscard]] bool closed() const {
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
        for (std::size_t i = 0; i + 2 < of_.size(); i += 3) {
            const std::array<std::uint32_t, 3> p{of_[i], of_[i + 1], of_[i + 2]};
            if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;  // at a pole: no area
            for (std::size_t k = 0; k < 3; ++k)
                if (++sides[{p[k], p[(k + 1) % 3]}] > 1) return false;
        }
        return std::all_of(sides.begin(), sides.end(), [&](const auto& side) {
            return sides.contains({side.first.second, side.first.first});
        });
    }

private:
    std::vector<std::uint32_t> of_;  ///< by index of the part: its point
    dvec3 middle_{0.0};
};

/// Each direction from the middle meets the surface once, from within.
bool surrounds(const Geometry& g, const dvec3& centre) {
    double sum = 0;
    bool outward = true;
    for_corners(g, centre, [&](const Corners& c) {
        const double angle = solid_angle(c);
        outward = outward && angle > -1e-6;
        sum += angle;
    });
    return outward && std::abs(sum - 4 * pi) < 1e-2;
}

/// Whether the vertices' normals are those of the shape, to about six degrees: what is shaded flat looks otherwise.
bool has_round_normals(const Geometry& g, const Round& shape) {
    constexpr double alike = 0.994;
    const auto& indices = g.parts[0].indices;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const auto along = [&](std::size_t k) {
            return dvec3(position_of(g.vertices[indices[i + k]]))[shape.axis] - shape.centre[shape.axis];
        };
        const bool cap = shape.half_height > 0 && (along(0) > 0) == (along(1) > 0) && (along(1) > 0) == (along(2) > 0);
        for (std::size_t k = 0; k < 3; ++k) {
            const model::Vertex& v = g.vertices[indices[i + k]];
            dvec3 out = dvec3(position_of(v)) - shape.centre;
            if (cap) {
                const double up = out[shape.axis];
                out = dvec3(0);
                out[shape.axis] = up;
            } else if (shape.half_height > 0) {
                out[shape.axis] = 0;
            }
            const dvec3 normal(v.normal[0], v.normal[1], v.normal[2]);
            if (glm::dot(normal, out) < alike * glm::length(normal) * glm::length(out) || !(glm::length(normal) > 0))
                return false;
        }
    }
    return true;
}

std::optional<Round> find_sphere(const Geometry& g, const dvec3& middle) {
    Round shape;
    shape.centre = middle;
    shape.radius = glm::length(dvec3(position_of(g.vertices[g.parts[0].indices[0]])) - middle);
    double off = 0;
    for_corners(g, shape.centre, [&](const Corners& c) {
        for (const dvec3& corner : c) off = std::max(off, std::abs(glm::length(corner) - shape.radius));
        shape.sag_m = std::max(shape.sag_m, shape.radius - plane_distance(c));
    });
    if (off > tolerance * shape.radius || shape.sag_m > 0.25 * shape.radius) return std::nullopt;
    return shape;
}

std::optional<Round> find_cylinder(const Geometry& g, const Box& box, const dvec3& middle, int axis) {
    Round shape;
    shape.centre = middle;
    shape.centre[axis] = box.centre()[axis];
    shape.axis = axis;
    const int u = (axis + 1) % 3, w = (axis + 2) % 3;
    shape.half_height = box.half()[axis];
    for_corners(g, shape.centre, [&](const Corners& c) {
        for (const dvec3& corner : c) shape.radius = std::max(shape.radius, glm::length(dvec2(corner[u], corner[w])));
    });
    if (!(shape.half_height > 0)) return std::nullopt;
    bool fits = true;
    for_corners(g, shape.centre, [&](const Corners& c) {
        const double near = tolerance * shape.radius;
        double inner = shape.radius;
        bool cap = true, side = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const dvec2 round(c[k][u], c[k][w]), next(c[(k + 1) % 3][u], c[(k + 1) % 3][w]);
            if (std::abs(std::abs(c[k][axis]) - shape.half_height) > near) fits = false;
            cap = cap && (c[k][axis] > 0) == (c[0][axis] > 0) && glm::length(round) <= shape.radius + near;
            side = side && std::abs(glm::length(round) - shape.radius) <= near;
            inner = std::min(inner, glm::length(round + next) / 2);  // of a chord, its middle
        }
        if (!cap && !side) fits = false;
        if (!cap) shape.sag_m = std::max(shape.sag_m, shape.radius - inner);
    });
    if (!fits || shape.sag_m > 0.05 * shape.radius) return std::nullopt;  // below ten sides, or one side cut flat
    return shape;
}

std::optional<Round> find_round(const Geometry& g, const ChainOptions& options) {
    if (g.parts.size() != 1 || g.triangles() < min_triangles || options.is_piece) return std::nullopt;
    const model::Index material = g.parts[0].material;
    const bool pictured = material < options.pictures.size() && options.pictures[material] != Picture::none;
    const bool holed = material < options.cut_out.size() && options.cut_out[material];
    const auto coloured = [&](const model::Vertex& v) {
        return !std::equal(std::begin(v.colour), std::end(v.colour), std::begin(g.vertices[0].colour));
    };
    if (pictured || holed || std::any_of(g.vertices.begin(), g.vertices.end(), coloured)) return std::nullopt;
    const Box box = g.box();
    const dvec3 half = box.half();
    const double largest = std::max({half.x, half.y, half.z});
    if (!(largest > 0)) return std::nullopt;
    const auto alike = [&](double a, double b) { return std::abs(a - b) <= 0.15 * std::max(a, b); };  // sides may stand anyhow
    const bool cube = alike(half.x, half.y) && alike(half.y, half.z),
               prism = alike(half.x, half.y) || alike(half.y, half.z) || alike(half.z, half.x);
    if (!cube && !prism) return std::nullopt;
    const Welded welded(g, largest);
    std::optional<Round> found;
    if (cube) found = find_sphere(g, welded.middle());
    for (int axis = 0; axis < 3 && !found; ++axis)
        if (alike(half[(axis + 1) % 3], half[(axis + 2) % 3])) found = find_cylinder(g, box, welded.middle(), axis);
    if (!found || !welded.closed() || !surrounds(g, found->centre) || !has_round_normals(g, *found)) return std::nullopt;
    return found;
}

/// A tessellation by its numbers, before it is made.
struct Tessellation {
    int sides = 0, rings = 0;  ///< rings 0: a cylinder
    double error_m = 0;
    [[nodiscard]] std::uint32_t triangles() const {
        return static_cast<std::uint32_t>(rings > 0 ? 2 * sides * (rings - 1) : 4 * sides - 4);
    }
};

/// On the unit sphere about y.
dvec3 on_sphere(const Tessellation& plan, int side, int ring) {
    const double about = 2 * pi * side / plan.sides, down = pi * ring / plan.rings;
    return {std::sin(down) * std::cos(about), std::cos(down), std::sin(down) * std::sin(about)};
}

/// Of one sector, all others being alike.
double sphere_sag(const Tessellation& plan) {
    double inner = 1;
    for (int ring = 0; ring < plan.rings; ++ring) {
        const dvec3 a = on_sphere(plan, 0, ring), b = on_sphere(plan, 0, ring + 1), c = on_sphere(plan, 1, ring + 1),
                    d = on_sphere(plan, 1, ring);
        if (ring + 1 < plan.rings) inner = std::min(inner, plane_distance({a, c, b}));
        if (ring > 0) inner = std::min(inner, plane_distance({a, d, c}));
    }
    return 1 - inner;
}

std::vector<Tessellation> all_tessellations(const Round& shape, std::size_t below) {
    std::vector<Tessellation> all;
    const auto add = [&](Tessellation plan, double sag) {
        plan.error_m = std::max(sag * shape.radius, shape.sag_m) + 2 * tolerance * shape.radius;
        if (plan.triangles() < below) all.push_back(plan);
    };
    const int max_sides = static_cast<int>(below) / 2;
    for (int sides = 3; sides <= std::min(max_sides, 512); ++sides) {
        if (shape.half_height > 0) {
            add({sides, 0, 0}, 1 - std::cos(pi / sides));
            continue;
        }
        for (int rings = std::max(2, sides / 2 - 1); rings <= sides / 2 + 2; ++rings)
            if (const Tessellation plan{sides, rings, 0}; plan.triangles() < below) add(plan, sphere_sag(plan));
    }
    return all;
}

/// Adds vertices and triangles of a level.
class LevelMaker {
public:
    LevelMaker(Geometry& g, const Round& shape) : g_(g), shape_(shape), first_(g.vertices[g.parts[0].indices[0]]) {}

    std::uint32_t vertex(const dvec3& unit, const dvec3& normal) {
        model::Vertex v = first_;
        const double height = shape_.half_height > 0 ? shape_.half_height : shape_.radius;
        const dvec3 at = turned({unit.x * shape_.radius, unit.y * height, unit.z * shape_.radius}), out = turned(normal);
        for (int k = 0; k < 3; ++k) {
            v.position[k] = static_cast<float>(shape_.centre[k] + at[k]);
            v.normal[k] = static_cast<std::int8_t>(std::lround(127 * out[k]));
        }
        g_.vertices.push_back(v);
        if (!g_.baked.empty()) g_.baked.push_back(g_.baked[g_.parts[0].indices[0]]);
        return static_cast<std::uint32_t>(g_.vertices.size() - 1);
    }
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        for (const std::uint32_t i : {a, b, c}) indices_.push_back(i);
    }
    Level take(double error_m) {
        Level level;
        level.triangles = static_cast<std::uint32_t>(indices_.size() / 3);
        level.error_m = static_cast<float>(error_m);
        level.parts.push_back({g_.parts[0].material, std::move(indices_)});
        return level;
    }

private:
    /// From about y to about the shape's axis, without mirroring.
    [[nodiscard]] dvec3 turned(const dvec3& v) const {
        dvec3 out;
        out[shape_.axis] = v.y;
        out[(shape_.axis + 1) % 3] = v.z;
        out[(shape_.axis + 2) % 3] = v.x;
        return out;
    }

    Geometry& g_;
    const Round& shape_;
    model::Vertex first_;
    std::vector<std::uint32_t> indices_;
};

Level make_sphere(Geometry& g, const Round& shape, const Tessellation& plan) {
    LevelMaker maker(g, shape);
    const std::uint32_t top = maker.vertex({0, 1, 0}, {0, 1, 0}), bottom = maker.vertex({0, -1, 0}, {0, -1, 0});
    std::vector<std::uint32_t> above, here;
    for (int ring = 1; ring < plan.rings; ++ring) {
        here.clear();
        for (int side = 0; side < plan.sides; ++side) {
            const dvec3 at = on_sphere(plan, side, ring);
            here.push_back(maker.vertex(at, at));
        }
        for (int side = 0; side < plan.sides; ++side) {
            const auto s = static_cast<std::size_t>(side), t = static_cast<std::size_t>((side + 1) % plan.sides);
            if (ring == 1) maker.triangle(top, here[t], here[s]);
            if (ring > 1) {
                maker.triangle(above[s], here[t], here[s]);
                maker.triangle(above[s], above[t], here[t]);
            }
            if (ring + 1 == plan.rings) maker.triangle(bottom, here[s], here[t]);
        }
        above = here;
    }
    return maker.take(plan.error_m);
}

Level make_cylinder(Geometry& g, const Round& shape, const Tessellation& plan) {
    LevelMaker maker(g, shape);
    const auto ring = [&](double y, const std::function<dvec3(const dvec3&)>& normal) {
        std::vector<std::uint32_t> made;
        for (int side = 0; side < plan.sides; ++side) {
            const double about = 2 * pi * side / plan.sides;
            const dvec3 out(std::cos(about), 0, std::sin(about));
            made.push_back(maker.vertex(out + dvec3(0, y, 0), normal(out)));
        }
        return made;
    };
    const auto outward = [](const dvec3& out) { return out; };
    const auto low = ring(-1, outward), high = ring(1, outward);
    for (std::size_t s = 0; s < low.size(); ++s) {
        const std::size_t t = (s + 1) % low.size();
        maker.triangle(high[s], low[t], low[s]);
        maker.triangle(high[s], high[t], low[t]);
    }
    const auto top = ring(1, [](const dvec3&) { return dvec3(0, 1, 0); });
    const auto bottom = ring(-1, [](const dvec3&) { return dvec3(0, -1, 0); });
    for (std::size_t s = 1; s + 1 < top.size(); ++s) {
        maker.triangle(top[0], top[s + 1], top[s]);
        maker.triangle(bottom[0], bottom[s], bottom[s + 1]);
    }
    return maker.take(plan.error_m);
}

}  // namespace

std::vector<Level> round_levels(Geometry& geometry, const ChainOptions& options) {
    const std::optional<Round> shape = find_round(geometry, options);
    if (!shape) return {};
    const std::vector<Tessellation> all = all_tessellations(*shape, geometry.triangles());
    std::vector<Level> levels;
    double before = static_cast<double>(geometry.triangles()), error_m = 0;
    while (true) {
        const Tessellation* best = nullptr;  // the least error within the step; of equal ones the fewest triangles
        for (const Tessellation& plan : all) {
            if (plan.triangles() > options.ratio * before || plan.error_m <= error_m) continue;
            if (best == nullptr || plan.error_m < best->error_m ||
                (plan.error_m == best->error_m && plan.triangles() < best->triangles()))
                best = &plan;
        }
        if (best == nullptr) break;
        levels.push_back(shape->half_height > 0 ? make_cylinder(geometry, *shape, *best) : make_sphere(geometry, *shape, *best));
        before = best->triangles();
        error_m = best->error_m;
        if (before <= options.smallest) break;
    }
    return levels;
}

}  // namespace surefoot::bake
