// Frustum and projection: no visible box is lost, few invisible ones are kept, a region holds all its poses.
#include "render/model/view.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rt/base/random.hpp"

namespace surefoot::model {
namespace {

constexpr Viewport hd{1280, 720};

dquat random_rotation(Random& random) {
    return glm::normalize(dquat(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)));
}

/// Whether the pose's own camera sees the point: through the projection, not through the planes under test.
bool sees(const Pose& pose, const dvec3& point) {
    const dvec3 local = glm::conjugate(pose.orientation) * (point - pose.position);
    if (-local.z < near_plane_m) return false;
    const double t = std::tan(0.5 * pose.fov_y_rad);
    return std::abs(local.y) <= -local.z * t && std::abs(local.x) <= -local.z * t * 1280.0 / 720.0;
}

dvec3 random_in(Random& random, const Box& box) {
    return {random.range(box.min.x, box.max.x), random.range(box.min.y, box.max.y), random.range(box.min.z, box.max.z)};
}

Box random_box(Random& random, double reach, double size) {
    const dvec3 centre(random.range(-reach, reach), random.range(-reach, reach), random.range(-reach, reach));
    const dvec3 half(random.range(0, size), random.range(0, size), random.range(0, size));
    return {centre - half, centre + half};
}

TEST(Frustum, NeverLosesABoxWithAVisiblePoint) {
    Random random(11);
    int seen = 0;
    for (int i = 0; i < 20000; ++i) {
        const Pose pose{{random.range(-50, 50), 0, random.range(-50, 50)}, random_rotation(random)};
        const Box box = random_box(random, 200, 100);
        if (!sees(pose, random_in(random, box))) continue;
        ++seen;
        EXPECT_TRUE(visible(make_frustum(pose, hd, 1000), box));
    }
    EXPECT_GT(seen, 1000);
}

TEST(Frustum, BoxThatEnclosesTheFrustumIsVisible) {
    EXPECT_TRUE(visible(make_frustum(Pose{}, hd, 100), Box{dvec3(-1e7), dvec3(1e7)}));
}

TEST(Frustum, BoxBeyondFarIsStillVisible) {
    EXPECT_TRUE(visible(make_frustum(Pose{}, hd, 100), Box{{-1, -1, -1e6}, {1, 1, -9e5}}));
}

TEST(Frustum, BoxesBehindAndBesideAreNot) {
    const Frustum frustum = make_frustum(Pose{}, hd, 100);
    EXPECT_FALSE(visible(frustum, {{-1, -1, 1}, {1, 1, 2}}));
    EXPECT_FALSE(visible(frustum, {{100, -1, -11}, {101, 1, -10}}));
    EXPECT_FALSE(visible(frustum, Box{}));
}

// Six planes alone keep this box: no plane has it wholly outside, yet it lies behind the eye's corner.
TEST(Frustum, LargeBoxAcrossTwoPlanesIsDropped) {
    Pose pose;
    pose.orientation = glm::angleAxis(0.785398, dvec3(0, 1, 0));  // looks along -x-z
    pose.fov_y_rad = 0.6;
    EXPECT_FALSE(visible(make_frustum(pose, hd, 1000), {{0.5, -300, -300}, {600, 300, 600}}));
}

TEST(Frustum, KeepsFewInvisibleBoxes) {
    Random random(5);
    int invisible = 0, kept = 0;
    for (int i = 0; i < 20000; ++i) {
        const Pose pose{dvec3(0), random_rotation(random)};
        const Box box = random_box(random, 300, 100);
        bool any = false;
        for (int k = 0; k < 300 && !any; ++k) any = sees(pose, random_in(random, box));
        if (any) continue;
        ++invisible;
        kept += visible(make_frustum(pose, hd, 1000), box) ? 1 : 0;
    }
    EXPECT_LT(kept, invisible / 25);  // sampled: some of these are in truth visible; six planes alone keep 13 %
}

TEST(Frustum, RegionHoldsEveryPoseInIt) {
    Random random(7);
    int seen = 0;
    for (int i = 0; i < 30000; ++i) {
        const Pose centre{dvec3(random.range(-5, 5)), random_rotation(random), random.range(0.3, 1.4)};
        const double radius = random.range(0, 3), angle = random.range(0, 0.3);
        Pose pose = centre;
        const dvec3 way = glm::normalize(dvec3(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)));
        pose.position += way * random.range(0, radius);
        const dvec3 axis = glm::normalize(dvec3(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)));
        pose.orientation = glm::normalize(glm::angleAxis(random.range(0, angle), axis) * centre.orientation);
        const dvec3 point = pose.position + dvec3(random.range(-20, 20), random.range(-20, 20), random.range(-20, 20));
        if (!sees(pose, point)) continue;
        ++seen;
        EXPECT_TRUE(visible(make_frustum(centre, hd, 100, radius, angle), Box{point, point}));
    }
    EXPECT_GT(seen, 1000);
}

TEST(Frustum, FarFromTheOriginNothingIsLost) {
    Random random(9);
    const dvec3 far(6.378e6, -4e6, 5e6);
    for (int i = 0; i < 5000; ++i) {
        const Pose pose{far, random_rotation(random)};
        const dvec3 point = far + dvec3(random.range(-50, 50), random.range(-50, 50), random.range(-50, 50));
        if (!sees(pose, point)) continue;
        EXPECT_TRUE(visible(make_frustum(pose, hd, 100), Box{point, point}));
    }
}

TEST(Projection, ReversedDepthFromOneToZero) {
    const mat4 m = projection(Pose{}, hd);
    const vec4 at_near = m * vec4(0, 0, -static_cast<float>(near_plane_m), 1), far = m * vec4(0, 0, -1e7F, 1);
    EXPECT_FLOAT_EQ(at_near.z / at_near.w, 1.0F);
    EXPECT_GT(far.z / far.w, 0.0F);
    EXPECT_LT(far.z / far.w, 1e-7F);
    const vec4 corner = m * vec4(std::tan(0.5F * 1.04719755F) * 1280 / 720, std::tan(0.5F * 1.04719755F), -1, 1);
    EXPECT_NEAR(corner.x / corner.w, 1, 1e-5);
    EXPECT_NEAR(corner.y / corner.w, 1, 1e-5);
}

TEST(Projection, ViewLooksAlongItsMinusZ) {
    Pose pose;
    pose.orientation = glm::angleAxis(1.57079632679, dvec3(0, 1, 0));  // looks along -x
    const vec4 ahead = view_rotation(pose) * vec4(-5, 0, 0, 1);
    EXPECT_NEAR(ahead.z, -5, 1e-5);
}

TEST(Projection, PixelAngleTimesHeightIsNearTheField) {
    EXPECT_NEAR(pixel_angle(Pose{}, hd), 2 * std::tan(0.5 * 1.0471975511965976) / 720, 1e-6);
}

}  // namespace
}  // namespace surefoot::model
