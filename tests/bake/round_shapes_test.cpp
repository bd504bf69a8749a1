// Spheres and cylinders: recognised, and their levels within the errors that are computed for them.
#include "render/bake/round_shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "render/bake/mesh_surface.hpp"

namespace surefoot::bake {
namespace {

constexpr double pi = 3.14159265358979323846;

void add_plain_vertex(Geometry& g, const dvec3& at, const dvec3& normal) {
    model::Vertex v{};
    for (int k = 0; k < 3; ++k) v.normal[k] = static_cast<std::int8_t>(std::lround(127 * normal[k]));
    for (int k = 0; k < 3; ++k) v.position[k] = static_cast<float>(at[k]);
    for (int k = 0; k < 4; ++k) v.colour[k] = 200;
    g.vertices.push_back(v);
    g.baked.push_back({200, 200, 200, 255});
}

/// About y, of the radii in x, y and z; two triangles a quad but at the poles. Counter-clockwise from outside.
Geometry round_ball(int sides, int rings, const dvec3& radii = dvec3(2), const dvec3& middle = dvec3(5, 1, -3)) {
    Geometry g;
    g.parts.resize(1);
    for (int ring = 0; ring <= rings; ++ring)
        for (int side = 0; side < sides; ++side) {
            const double about = 2 * pi * side / sides, down = pi * ring / rings;
            const dvec3 out(std::sin(down) * std::cos(about), std::cos(down), std::sin(down) * std::sin(about));
            add_plain_vertex(g, middle + radii * out, out);
        }
    const auto at = [&](int side, int ring) { return static_cast<std::uint32_t>(ring * sides + side % sides); };
    for (int ring = 0; ring < rings; ++ring)
        for (int side = 0; side < sides; ++side) {
            const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                for (const std::uint32_t i : {a, b, c}) g.parts[0].indices.push_back(i);
            };
            if (ring + 1 < rings) add(at(side, ring), at(side + 1, ring + 1), at(side, ring + 1));
            if (ring > 0) add(at(side, ring), at(side + 1, ring), at(side + 1, ring + 1));
        }
    return g;
}

/// Along an axis: a fan in each cap, round its middle. twist: of the upper ring against the lower one, in sides.
Geometry round_drum(int sides, double radius, double half_height, int axis, double twist = 0) {
    Geometry g;
    g.parts.resize(1);
    const auto turned = [&](double along, double u, double w) {
        dvec3 at;
        at[axis] = along;
        at[(axis + 1) % 3] = w;
        at[(axis + 2) % 3] = u;
        return at;
    };
    for (const bool cap : {false, true})
        for (const double along : {-half_height, half_height})
            for (int side = 0; side < sides; ++side) {
                const double about = 2 * pi * (side + (along > 0 ? twist : 0)) / sides, u = std::cos(about), w = std::sin(about);
                add_plain_vertex(g, turned(along, radius * u, radius * w),
                                 cap ? turned(along > 0 ? 1 : -1, 0, 0) : turned(0, u, w));
            }
    for (const double along : {-half_height, half_height})
        add_plain_vertex(g, turned(along, 0, 0), turned(along > 0 ? 1 : -1, 0, 0));
    const auto n = static_cast<std::uint32_t>(sides);
    for (std::uint32_t s = 0; s < n; ++s) {
        const std::uint32_t t = (s + 1) % n;
        for (const std::uint32_t i : {n + s, t, s, n + s, n + t, t, 4 * n, 2 * n + s, 2 * n + t, 4 * n + 1, 3 * n + t, 3 * n + s})
            g.parts[0].indices.push_back(i);
    }
    return g;
}

double solid_angle_sum(const Geometry& g, const std::vector<GeometryPart>& parts, const dvec3& middle) {
    double sum = 0;
    for (const GeometryPart& part : parts)
        for (std::size_t i = 0; i < part.indices.size(); i += 3) {
            const dvec3 a = dvec3(position_of(g.vertices[part.indices[i]])) - middle,
                        b = dvec3(position_of(g.vertices[part.indices[i + 1]])) - middle,
                        c = dvec3(position_of(g.vertices[part.indices[i + 2]])) - middle;
            const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
            sum += 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                                  la * lb * lc + glm::dot(a, b) * lc + glm::dot(a, c) * lb + glm::dot(b, c) * la);
        }
    return sum;
}

/// A two-sided distance that there is, so no bound may be below it: by the measure that serves all other levels.
double measured_distance(const Geometry& g, const Level& level) {
    const MeshSurface full(g.vertices, g.parts), coarse(g.vertices, level.parts);
    const measure::TriangleTree full_tree(full.view()), coarse_tree(coarse.view());
    measure::DistanceLimits limits;
    limits.relative = 0.02F;
    return std::max(measure::directed_distance(full.view(), coarse_tree, limits).lower,
                    measure::directed_distance(coarse.view(), full_tree, limits).lower);
}

void expect_levels(Geometry g, const dvec3& middle, std::size_t min_levels) {
    ChainOptions options;
    options.ratio = 0.7;
    ASSERT_NEAR(solid_angle_sum(g, g.parts, middle), 4 * pi, 1e-3);
    const std::vector<Level> levels = round_levels(g, options);
    ASSERT_GE(levels.size(), min_levels);
    double triangles = static_cast<double>(g.triangles()), error_m = 0;
    for (const Level& level : levels) {
        std::size_t indices = 0;
        for (const GeometryPart& part : level.parts) indices += part.indices.size();
        EXPECT_EQ(indices, 3 * level.triangles);
        EXPECT_LE(level.triangles, 0.7 * triangles);
        EXPECT_GT(double{level.error_m}, error_m);
        EXPECT_NEAR(solid_angle_sum(g, level.parts, middle), 4 * pi, 1e-3) << level.triangles << " triangles are not closed";
        const double distance_m = measured_distance(g, level);
        EXPECT_LE(distance_m, double{level.error_m}) << level.triangles;
        EXPECT_GT(distance_m, 0.3 * double{level.error_m}) << level.triangles << ": the bound says little";
        for (const GeometryPart& part : level.parts)
            for (const std::uint32_t i : part.indices)
                EXPECT_GT(glm::dot(vec3(g.vertices[i].normal[0], g.vertices[i].normal[1], g.vertices[i].normal[2]),
                                   position_of(g.vertices[i]) - vec3(middle)),
                          0.0F);
        triangles = level.triangles;
        error_m = double{level.error_m};
    }
    EXPECT_LE(triangles, 24);
}

TEST(RoundShapes, LevelsOfSpheresAreWithinTheirErrors) {
    expect_levels(round_ball(64, 32), dvec3(5, 1, -3), 8);
    expect_levels(round_ball(18, 16, dvec3(0.01), dvec3(0)), dvec3(0), 4);
}

TEST(RoundShapes, LevelsOfCylindersAreWithinTheirErrors) {
    for (int axis = 0; axis < 3; ++axis) expect_levels(round_drum(24, 0.25, 2, axis), dvec3(0), 3);
    expect_levels(round_drum(29, 0.25, 2, 1), dvec3(0), 4);
    expect_levels(round_drum(40, 1, 1, 1, 0.5), dvec3(0), 5);
    expect_levels(round_drum(90, 3, 0.1, 2), dvec3(0), 6);
}

TEST(RoundShapes, OnlyWholeOnesOfOneColourAreRecognised) {
    ChainOptions options;
    const auto levels_of = [&](Geometry g) { return round_levels(g, options).size(); };
    EXPECT_GT(levels_of(round_ball(32, 16)), 0U);
    EXPECT_EQ(levels_of(round_ball(32, 16, dvec3(2, 1.8, 2))), 0U) << "an ellipsoid";
    EXPECT_EQ(levels_of(round_ball(6, 3)), 0U) << "too coarse to be meant as a sphere";
    Geometry open = round_ball(32, 16);
    open.parts[0].indices.resize(open.parts[0].indices.size() - 30);
    EXPECT_EQ(levels_of(open), 0U) << "a hole";
    Geometry pierced = round_ball(64, 32);
    pierced.parts[0].indices.resize(pierced.parts[0].indices.size() - 3);
    EXPECT_EQ(levels_of(pierced), 0U) << "one triangle is missing";
    Geometry doubled = round_ball(64, 32);
    std::copy_n(doubled.parts[0].indices.begin() + 300, 3, doubled.parts[0].indices.begin() + 900);
    EXPECT_EQ(levels_of(doubled), 0U) << "one triangle is there twice in place of another";
    Geometry pipe = round_drum(32, 0.01, 2, 1);
    EXPECT_GT(levels_of(pipe), 0U);
    std::vector<std::uint32_t> sides;
    for (std::size_t i = 0; i < pipe.parts[0].indices.size(); i += 12)
        for (std::size_t k = 0; k < 6; ++k) sides.push_back(pipe.parts[0].indices[i + k]);
    pipe.parts[0].indices = sides;
    EXPECT_EQ(levels_of(pipe), 0U) << "a thin pipe without caps";
    Geometry flat = round_drum(32, 0.25, 2, 1);
    for (model::Vertex& v : flat.vertices) v.normal[0] = 127, v.normal[1] = v.normal[2] = 0;
    EXPECT_EQ(levels_of(flat), 0U) << "other normals";
    Geometry inside_out = round_ball(32, 16);
    for (std::size_t i = 0; i < inside_out.parts[0].indices.size(); i += 3)
        std::swap(inside_out.parts[0].indices[i], inside_out.parts[0].indices[i + 1]);
    EXPECT_EQ(levels_of(inside_out), 0U) << "seen from within";
    Geometry coloured = round_ball(32, 16);
    coloured.vertices[40].colour[1] = 10;
    EXPECT_EQ(levels_of(coloured), 0U) << "a spot";
    Geometry dented = round_ball(32, 16);
    dented.vertices[200].position[1] += 0.05F;
    EXPECT_EQ(levels_of(dented), 0U) << "a dent";
    Geometry cone = round_drum(32, 0.25, 2, 1);
    for (model::Vertex& v : cone.vertices)
        if (v.position[1] > 0)
            for (const int k : {0, 2}) v.position[k] *= 0.5F;
    EXPECT_EQ(levels_of(cone), 0U) << "a cone";
    options.pictures = {Picture::repeats};
    EXPECT_EQ(levels_of(round_ball(32, 16)), 0U) << "a picture";
    options.pictures = {Picture::none};
    options.cut_out = {true};
    EXPECT_EQ(levels_of(round_ball(32, 16)), 0U) << "shapes are cut out of it";
    options.cut_out = {};
    options.is_piece = true;
    EXPECT_EQ(levels_of(round_ball(32, 16)), 0U) << "a piece";
}

TEST(RoundShapes, MakeTheChainOfARoundMesh) {
    Geometry g = round_ball(64, 32);
    ChainOptions options;
    const LodChain chain = make_chain(g, options);
    ASSERT_GE(chain.levels.size(), 5U);
    EXPECT_EQ(chain.levels.back().error_m, 0);
    for (std::size_t i = 1; i < chain.levels.size(); ++i) {
        EXPECT_LT(chain.levels[i].error_m, chain.levels[i - 1].error_m);
        EXPECT_GT(chain.levels[i].triangles, chain.levels[i - 1].triangles);
    }
}

}  // namespace
}  // namespace surefoot::bake
