// Pixels of surfaces seen from nearby: what stands where, which way it faces, and how it is placed.
#include "render/model/pixel_estimator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "rt/base/random.hpp"

namespace surefoot::model {
namespace {

constexpr Viewport viewport{640, 480};
constexpr double pi = std::numbers::pi;

/// A model of one representation, its corners given three by three.
Model model_of(std::span<const dvec3> corners, bool two_sided = false, const mat3& linear = mat3(1.0F),
               const dvec3& origin = dvec3(0)) {
    Model m;
    m.materials.emplace_back().two_sided = two_sided;
    m.placements.push_back({origin, linear});
    m.nodes.emplace_back();
    for (const dvec3& corner : corners) {
        Vertex v{};
        for (int k = 0; k < 3; ++k) v.position[k] = static_cast<float>(corner[k]);
        m.indices.push_back(static_cast<std::uint32_t>(m.vertices.size()));
        m.vertices.push_back(v);
        m.nodes[0].box.grow(origin + dvec3(linear * vec3(corner)));
    }
    const auto count = static_cast<std::uint32_t>(corners.size());
    m.parts.push_back({0, 0, count, 0, count});
    Representation rep;
    rep.part_count = 1;
    rep.triangles = count / 3;
    rep.area_m2 = rasterised_area(m, rep);
    m.reps.push_back(rep);
    m.nodes[0].rep_count = 1;
    return m;
}

float pixels(const Model& m, const Pose& pose) {
    return PixelEstimator(m).surface_pixels(0, pose.position, make_view_scale(pose, viewport));
}
float mixed_pixels(const Model& m, const Pose& pose) {
    return PixelEstimator(m).pixels(m, 0, m.nodes[0].box, pose.position, make_view_scale(pose, viewport));
}
float box_pixels(const Model& m, const Pose& pose) {
    return rasterised_pixels(m.reps[0], m.nodes[0].box, pose.position, make_view_scale(pose, viewport));
}

Pose turned(const dvec3& at, double heading_rad) {
    Pose pose;
    pose.position = at;
    pose.orientation = glm::angleAxis(heading_rad, dvec3(0, 1, 0));
    return pose;
}

/// A wall of 20 by 20 m at z = -5 that faces +z, and a speck at z = 5: the box goes round the eye at 0.
std::vector<dvec3> wall_and_speck() {
    return {{-10, -10, -5}, {10, -10, -5}, {10, 10, -5}, {-10, -10, -5}, {10, 10, -5},
            {-10, 10, -5},  {0, 0, 5},     {1e-3, 0, 5}, {0, 1e-3, 5}};
}

std::vector<dvec3> ball(int rings, double radius, const dvec3& radii = dvec3(1)) {
    std::vector<dvec3> corners;
    const auto at = [&](int ring, int segment) {
        const double a = pi * ring / rings, b = pi * segment / rings;
        return radius * radii * dvec3(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
    };
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < 2 * rings; ++j) {
            if (i > 0) corners.insert(corners.end(), {at(i, j), at(i, j + 1), at(i + 1, j)});
            if (i + 1 < rings) corners.insert(corners.end(), {at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
        }
    }
    return corners;
}

TEST(PixelEstimator, OfAWallAreTheViewTowardsItAndNothingTheOtherWay) {
    const Model m = model_of(wall_and_speck());
    const double whole = 640 * 480;
    EXPECT_NEAR(pixels(m, turned(dvec3(0), 0)), whole, 1e-3 * whole);
    EXPECT_LT(pixels(m, turned(dvec3(0), pi)), 1.0F);
    // By the box alone it is as much on either side.
    EXPECT_GT(box_pixels(m, turned(dvec3(0), pi)), 0.2 * whole);
}

TEST(PixelEstimator, ThatFaceAwayCountOnlyWhereBothSidesAreDrawn) {
    std::vector<dvec3> corners = wall_and_speck();
    std::swap(corners[1], corners[2]);
    std::swap(corners[4], corners[5]);
    EXPECT_EQ(pixels(model_of(corners), turned(dvec3(0), 0)), 0.0F);
    EXPECT_NEAR(pixels(model_of(corners, true), turned(dvec3(0), 0)), 640 * 480, 300);
}

TEST(PixelEstimator, OfAWallCutByTheViewAreWhatIsInIt) {
    // Half of a wall: from the middle of the view to the right.
    const std::vector<dvec3> corners = {{0, -10, -5}, {10, -10, -5}, {10, 10, -5}, {0, -10, -5}, {10, 10, -5}, {0, 10, -5}};
    EXPECT_NEAR(pixels(model_of(corners), Pose{}), 0.5 * 640 * 480, 300);
}

TEST(PixelEstimator, OfABallOfManyTrianglesAreItsDisc) {
    const Model m = model_of(ball(40, 1.0));
    ASSERT_GT(m.reps[0].triangles, 3000U);  // sampled
    const double f = 240.0 / std::tan(0.5 * Pose{}.fov_y_rad);
    for (const double distance : {2.2, 3.0, 4.0, 5.0}) {
        const double radius = f / std::sqrt(distance * distance - 1);
        EXPECT_NEAR(pixels(m, turned({0, 0, distance}, 0)), pi * radius * radius, 0.1 * pi * radius * radius) << distance;
    }
    EXPECT_LT(pixels(m, turned({0, 0, 0}, 0)), 1.0F) << "from inside: all of it faces away";
}

TEST(PixelEstimator, AreWhereThePlacementPutsThem) {
    const dvec3 origin(100, -20, 7);
    for (const double mirror : {1.0, -1.0}) {
        const mat3 linear(vec3(0, 0, 2 * mirror), vec3(0, 1.5F, 0), vec3(-2, 0, 0));
        for (const int rings : {5, 24}) {  // whole, and sampled
            // Squeezed one way and another, so that a wrong turn shows.
            const std::vector<dvec3> corners = ball(rings, 1.0, rings == 5 ? dvec3(1.0, 0.6, 0.3) : dvec3(1.0, 0.8, 0.7));
            std::vector<dvec3> there;
            for (const dvec3& c : corners) there.push_back(origin + dvec3(linear * vec3(c)));
            if (mirror < 0)
                for (std::size_t i = 0; i + 2 < there.size(); i += 3) std::swap(there[i + 1], there[i + 2]);
            const Model placed = model_of(corners, false, linear, origin), baked = model_of(there);
            for (const double heading : {0.0, 0.4, 1.9, 3.3}) {
                const Pose pose = turned(origin + dvec3(4 * std::sin(heading), 0.3, 4 * std::cos(heading)), heading);
                const float expected = pixels(baked, pose);
                ASSERT_GT(expected, 1000.0F);
                // Samples are spread by area, and a stretched ball's are spread otherwise.
                EXPECT_NEAR(pixels(placed, pose), expected, (rings == 5 ? 0.001F : 0.15F) * expected) << heading;
            }
        }
    }
}

TEST(PixelEstimator, OfAMirroredWallIsItsOwnFront) {
    const std::vector<dvec3> wall = {{-50, -50, -5}, {50, -50, -5}, {50, 50, -5}, {-50, -50, -5}, {50, 50, -5}, {-50, 50, -5}};
    std::vector<dvec3> speckled = wall;  // so many triangles that they are sampled
    for (int i = -30; i < 30; ++i) {
        for (int j = -30; j < 30; ++j) {
            const double x = 0.5 * i, y = 0.5 * j;
            for (const dvec3& c : {dvec3(x, y, -5), dvec3(x + 0.5, y, -5), dvec3(x, y + 0.5, -5)}) speckled.push_back(c);
        }
    }
    mat3 mirror(1.0F);
    mirror[0][0] = -1;
    for (const auto& corners : {wall, speckled}) {
        const float in_front = pixels(model_of(corners), Pose{});
        ASSERT_GT(in_front, 1000.0F);
        EXPECT_NEAR(pixels(model_of(corners, false, mirror), Pose{}), in_front, 0.01F * in_front);
        EXPECT_EQ(pixels(model_of(corners, false, mirror), turned({0, 0, -10}, pi)), 0.0F) << "from behind";
    }
}

TEST(PixelEstimator, CountTwoThirdsNearbyAndNothingFarAwayOrWithoutTriangles) {
    const Model m = model_of(wall_and_speck());
    const Pose near = turned({0, 0, 30}, 0);  // half a diagonal is 15 m, three are 45
    for (const double heading : {0.0, 0.3, pi}) {
        const Pose pose = turned(near.position, heading);
        const float expected = (box_pixels(m, pose) + 2 * pixels(m, pose)) / 3;
        EXPECT_NEAR(mixed_pixels(m, pose), expected, 1e-3F * expected);
    }
    ASSERT_NE(pixels(m, near), box_pixels(m, near));
    const Pose far = turned({0, 0, 50}, 0);
    ASSERT_GT(pixels(m, far), 0.0F);
    ASSERT_NE(pixels(m, far), box_pixels(m, far));
    EXPECT_EQ(mixed_pixels(m, far), box_pixels(m, far));
    Model bare = m;
    bare.reps[0].part_count = 0;
    EXPECT_LT(pixels(bare, Pose{}), 0.0F);
    EXPECT_EQ(mixed_pixels(bare, Pose{}), box_pixels(m, Pose{}));
    Model flat = m;
    flat.placements[0].linear[2] = vec3(0);  // cannot be turned back
    EXPECT_LT(pixels(flat, Pose{}), 0.0F);
}

TEST(PixelEstimator, CountEveryTriangleWhereTheEyeIsCloseOrInside) {
    const Model m = model_of(wall_and_speck());
    for (const double heading : {0.0, 0.4, 1.0, pi}) {
        const Pose inside = turned(dvec3(0), heading);
        EXPECT_EQ(mixed_pixels(m, inside), pixels(m, inside)) << "three triangles: by the surface they are whole, too";
    }
    EXPECT_NE(mixed_pixels(m, Pose{}), box_pixels(m, Pose{}));
}

/// As model_of(), a part for every `triangles` of them.
Model in_parts(std::span<const dvec3> corners, std::uint32_t triangles) {
    Model m = model_of(corners);
    const Part whole = m.parts[0];
    m.parts.clear();
    for (std::uint32_t first = 0; first < whole.index_count; first += 3 * triangles)
        m.parts.push_back({0, first, std::min(3 * triangles, whole.index_count - first), 0, whole.vertex_count});
    m.reps[0].part_count = static_cast<std::uint32_t>(m.parts.size());
    return m;
}

bool part_pixels(const Model& m, const Pose& pose, std::span<float> of_part) {
    return PixelEstimator(m).part_pixels(m, 0, m.nodes[0].box, pose.position, make_view_scale(pose, viewport), of_part);
}

TEST(PixelEstimator, OfPartsAreEveryTriangleCutToTheView) {
    // A tunnel of three rings about the eye, 4 by 4 m: of each ring what lies ahead is seen, and nothing of one that lies behind.
    std::vector<dvec3> corners;
    for (const double z : {-40.0, -20.0, 2.0}) {
        for (int side = 0; side < 4; ++side) {
            const auto at = [&](int corner, double depth) {
                const double a = pi * (0.25 + 0.5 * corner);
                return dvec3(2 * std::numbers::sqrt2 * std::cos(a), 2 * std::numbers::sqrt2 * std::sin(a), depth);
            };
            const double end = z + (z > 0 ? 20 : 10);
            corners.insert(corners.end(), {at(side, z), at(side + 1, end), at(side + 1, z)});
            corners.insert(corners.end(), {at(side, z), at(side, end), at(side + 1, end)});
        }
    }
    const Model m = in_parts(corners, 8);
    ASSERT_EQ(m.parts.size(), 3U);
    std::array<float, PixelEstimator::max_parts> of_part{};
    ASSERT_TRUE(part_pixels(m, Pose{}, of_part));
    // A ring covers the frame between its near and its far opening; an opening at d is a square of 4 f / d.
    const double f = 240.0 / std::tan(0.5 * Pose{}.fov_y_rad);
    const auto opening = [&](double d) { return 16 * f * f / (d * d); };
    EXPECT_NEAR(of_part[0], opening(30) - opening(40), 1e-3 * opening(30));
    EXPECT_NEAR(of_part[1], opening(10) - opening(20), 1e-3 * opening(10));
    EXPECT_EQ(of_part[2], 0.0F);
    ASSERT_TRUE(part_pixels(m, turned(dvec3(0), pi), of_part));
    EXPECT_EQ(of_part[0] + of_part[1], 0.0F);
    EXPECT_NEAR(of_part[2], 640 * 480 - opening(22), 2);
}

TEST(PixelEstimator, OfPartsAreLeftToTheMixFarAwayAndOfMuch) {
    std::array<float, PixelEstimator::max_parts> of_part{};
    const Model few = in_parts(ball(15, 1.0), 100);  // 840 triangles; half a diagonal is 1.7 m
    EXPECT_TRUE(part_pixels(few, turned({0, 0, 2.5}, 0), of_part));
    EXPECT_FALSE(part_pixels(few, turned({0, 0, 2.7}, 0), of_part));
    EXPECT_FALSE(part_pixels(few, turned({0, 0, 2.5}, 0), std::span(of_part).first(8))) << "of nine parts";
    const Model many = in_parts(ball(34, 1.0), 100);
    ASSERT_GT(many.reps[0].triangles, 2048U);
    EXPECT_FALSE(part_pixels(many, turned({0, 0, 2.5}, 0), of_part));
    // A coarse form of a node whose fine one is not looked at is not either: which is dearer must not hang on how it was counted.
    Model both = few;
    both.reps.push_back(both.reps[0]);
    both.nodes[0].rep_count = 2;
    EXPECT_TRUE(part_pixels(both, turned({0, 0, 2.5}, 0), of_part));
    both.reps[1].triangles = 2049;
    EXPECT_FALSE(part_pixels(both, turned({0, 0, 2.5}, 0), of_part));
    Model bare = few;
    bare.reps[0].part_count = 0;
    EXPECT_FALSE(part_pixels(bare, turned({0, 0, 2.5}, 0), of_part));
    Model flat = few;
    flat.placements[0].linear[2] = vec3(0);  // cannot be turned back
    EXPECT_FALSE(part_pixels(flat, turned({0, 0, 2.5}, 0), of_part));
}

TEST(PixelEstimator, AreFiniteWhereverTheEyeIs) {
    Random random(7);
    int by_part = 0;
    const auto any = [&] {
        switch (random.below(4)) {
            case 0:
                return random.range(-1, 1);
            case 1:
                return random.range(-1, 1) * 1e-12;
            case 2:
                return random.range(-1, 1) * 1e12;
            default:
                return 0.0;
        }
    };
    for (int i = 0; i < 3000; ++i) {
        std::vector<dvec3> corners;
        const std::uint32_t count = 3 * (1 + random.below(4));
        for (std::uint32_t c = 0; c < count; ++c) {
            const double x = any(), y = any();
            corners.emplace_back(x, y, any());
        }
        const Model m = model_of(corners, i % 2 == 0);
        const double x = any(), y = any(), z = any();
        const float p = mixed_pixels(m, turned({x, y, z}, random.range(0, 6)));
        ASSERT_TRUE(std::isfinite(p) && p >= 0 && p <= max_pixels) << i << ": " << p;
        float of_part = 0;
        if (part_pixels(m, turned({x, y, z}, 0), std::span(&of_part, 1))) {
            ++by_part;
            ASSERT_TRUE(std::isfinite(of_part) && of_part >= 0) << i << ": " << of_part;
        }
    }
    EXPECT_GT(by_part, 300);
}

}  // namespace
}  // namespace surefoot::model
