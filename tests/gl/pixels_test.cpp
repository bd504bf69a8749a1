// The shared pixel estimate: finite everywhere, nothing outside the view, and near what GL really rasterises.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "render/effects/effects.hpp"
#include "render/gl/device.hpp"
#include "render/model/pixels.hpp"
#include "rt/base/random.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

constexpr model::Viewport viewport{640, 480};

Box cube(const dvec3& centre, double half) {
    Box box;
    box.grow(centre - dvec3(half));
    box.grow(centre + dvec3(half));
    return box;
}

/// A closed ball of the box's size, culled: pi r^2 from every side.
model::Representation ball(double radius) {
    model::Representation rep;
    rep.area_m2.fill(static_cast<float>(std::numbers::pi * radius * radius));
    return rep;
}

TEST(Pixels, of_a_far_ball_are_its_disc) {
    const auto scale = model::make_view_scale(Pose{}, viewport);
    const double f = 240.0 / std::tan(0.5 * Pose{}.fov_y_rad);
    const float pixels = model::rasterised_pixels(ball(1), cube({0, 0, -50}, 1), dvec3(0), scale);
    EXPECT_NEAR(pixels, std::numbers::pi * f * f / 2500, 0.02 * std::numbers::pi * f * f / 2500);
}

TEST(Pixels, fall_with_distance) {
    const auto scale = model::make_view_scale(Pose{}, viewport);
    float before = std::numeric_limits<float>::infinity();
    for (double distance = 1.1; distance < 1e5; distance *= 1.02) {  // 1: the eye is inside, and sees half of what is around it
        const float pixels = model::rasterised_pixels(ball(1), cube({0, 0, -distance}, 1), dvec3(0), scale);
        EXPECT_LE(pixels, before) << distance;
        before = pixels;
    }
}

TEST(Pixels, of_a_wall_at_the_nose_are_the_view) {
    const auto scale = model::make_view_scale(Pose{}, viewport);
    model::Representation wall;
    wall.area_m2 = {0, 0, 100};
    Box box;
    box.grow(dvec3(-5, -5, -0.2));
    box.grow(dvec3(5, 5, -0.2));
    EXPECT_NEAR(model::rasterised_pixels(wall, box, dvec3(0), scale) / scale.viewport_pixels, 1.0, 0.05);
}

TEST(Pixels, of_the_ground_under_the_eye_are_about_half_the_view) {
    const auto scale = model::make_view_scale(Pose{}, viewport);
    model::Representation ground;
    ground.area_m2 = {0, 4e6F, 0};
    Box box;
    box.grow(dvec3(-1000, -1.7, -1000));
    box.grow(dvec3(1000, -1.7, 1000));
    const float share = model::rasterised_pixels(ground, box, dvec3(0), scale) / scale.viewport_pixels;
    EXPECT_GT(share, 0.25F);
    EXPECT_LT(share, 1.0F);
}

TEST(Pixels, of_the_ground_do_not_depend_on_how_the_view_is_turned) {
    model::Representation ground;
    ground.area_m2 = {0, 4e6F, 0};
    Box box;
    box.grow(dvec3(-1000, -1.7, -1000));
    box.grow(dvec3(1000, -1.7, 1000));
    for (double pitch = -1.2; pitch < -0.6; pitch += 0.1) {
        for (double yaw = 0; yaw < 6; yaw += 0.3) {
            Pose pose;
            pose.orientation = glm::angleAxis(yaw, dvec3(0, 1, 0)) * glm::angleAxis(pitch, dvec3(1, 0, 0));
            const auto scale = model::make_view_scale(pose, viewport);
            EXPECT_NEAR(model::rasterised_pixels(ground, box, dvec3(0), scale) / scale.viewport_pixels, 1.0, 0.1)
                << pitch << ' ' << yaw;
        }
    }
}

TEST(Pixels, are_none_behind_the_eye_or_beside_the_view) {
    const auto scale = model::make_view_scale(Pose{}, viewport);
    EXPECT_EQ(model::rasterised_pixels(ball(1), cube({0, 0, 5}, 1), dvec3(0), scale), 0);
    EXPECT_EQ(model::rasterised_pixels(ball(1), cube({50, 0, -5}, 1), dvec3(0), scale), 0);
    EXPECT_EQ(model::rasterised_pixels(ball(1), Box{}, dvec3(0), scale), 0);
}

TEST(Pixels, of_a_ball_at_the_edge_are_a_part) {
    const auto scale = model::make_view_scale(Pose{}, viewport);
    const float whole = model::rasterised_pixels(ball(1), cube({0, 0, -10}, 1), dvec3(0), scale);
    const double edge = 10 * std::tan(0.5 * Pose{}.fov_y_rad);
    const float cut = model::rasterised_pixels(ball(1), cube({0, edge, -10}, 1), dvec3(0), scale);
    EXPECT_GT(cut / whole, 0.4F);
    EXPECT_LT(cut / whole, 0.8F);  // seen from its corner, a thing of the same three areas may show more
}

TEST(Pixels, are_finite_and_not_negative_for_anything) {
    Random random(3);
    const double worst[] = {0, 1e-300, 1e-9, 1, 1e9, 1e300, -1e9, std::numeric_limits<double>::infinity(), std::nan("")};
    for (int i = 0; i < 100000; ++i) {
        const auto any = [&] { return worst[random.below(9)] * (random.unit() < 0.5 ? 1 : random.unit()); };
        Pose pose;
        pose.fov_y_rad = any();
        Box box;
        box.min = dvec3(any(), any(), any());
        box.max = dvec3(any(), any(), any());
        model::Representation rep;
        for (float& a : rep.area_m2) a = static_cast<float>(any());
        const float pixels =
            model::rasterised_pixels(rep, box, dvec3(any(), any(), any()), model::make_view_scale(pose, viewport));
        ASSERT_TRUE(std::isfinite(pixels) && pixels >= 0) << pixels;
    }
}

TEST(Pixels, agree_with_what_gl_rasterises) {
    gl::DeviceOptions options;
    options.viewport = viewport;
    options.sky = {0, 0, 0};
    auto device = gl::open_device(options);
    if (!device) GTEST_SKIP() << device.error().text();
    Random random(5);
    for (int i = 0; i < 30; ++i) {
        const double size = random.range(0.3, 3);
        const auto angle = static_cast<float>(random.range(-1.0, 1.0));
        const mat3 turn(glm::mat3_cast(glm::angleAxis(angle, glm::normalize(vec3(1, 2, 0.5F)))));
        test::SmallModel scene;
        const auto node = scene.square(scene.material(test::plain(1, 1, 1)),
                                       test::at(random.range(-2, 2), random.range(-2, 2), random.range(-12, -2), turn),
                                       static_cast<float>(size));
        auto model = scene.finish();
        // The square's normal is the third column; every |component| of the area counts.
        for (int k = 0; k < 3; ++k)
            model.reps[0].area_m2[static_cast<std::size_t>(k)] = static_cast<float>(4 * size * size) * std::abs(turn[2][k]);
        (*device)->draws.plays();
        ASSERT_TRUE((*device)->load(model, effects::assemble_program).ok());
        (*device)->begin_frame(Pose{});
        const gl::DrawItem item{node, 0};
        (*device)->draw({&item, 1});
        (*device)->finish_frame();
        const auto image = (*device)->read_pixels();
        ASSERT_TRUE(image.ok());
        double drawn = 0;
        for (std::size_t p = 0; p < image->rgba.size(); p += 4) drawn += image->rgba[p] > 128 ? 1 : 0;
        const float estimate =
            model::rasterised_pixels(model.reps[0], model.nodes[node].box, dvec3(0), model::make_view_scale(Pose{}, viewport));
        EXPECT_LT(estimate, 2.5 * drawn + 2000) << i;
        EXPECT_GT(estimate, 0.4 * drawn - 2000) << i;
    }
}

}  // namespace
}  // namespace surefoot
