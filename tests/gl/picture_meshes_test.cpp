// Pictures on meshes of their own depths, against the same content drawn directly.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "render/cache/depth_mesh.hpp"
#include "render/gl/picture_faces.hpp"
#include "tests/gl/picture_scene.hpp"

namespace surefoot::test {
namespace {

const Box meshed_cube{dvec3(-1, -1, -7), dvec3(1, 1, -5)};

/// A slope, a far wall and a near square. None hides another: what is uncovered was not captured.
PictureScene meshed_scene() {
    SmallModel small;
    const std::array materials{small.material(plain(0.9F, 0.8F, 0.1F)), small.material(plain(0.2F, 0.9F, 0.3F)),
                               small.material(plain(0.9F, 0.2F, 0.3F))};
    PictureScene scene;
    const mat3 leaning(glm::mat3_cast(glm::angleAxis(-0.7F, vec3(1, 0, 0))));
    const auto slope = small.square(materials[1], at(-0.5, -0.5, -6, leaning), 0.35F);
    const auto wall = small.square(materials[0], at(0.45, 0.45, -6.8), 0.4F);
    const auto near = small.square(materials[2], at(0.4, -0.5, -5.2), 0.25F);
    for (const auto node : {slope, wall, near}) scene.items.push_back({node, node - 1});
    scene.model = small.finish();
    return scene;
}

gl::DeviceOptions with_meshes(std::uint32_t width, std::uint32_t height) {
    auto options = with_layers(width, height);
    options.mesh_triangles = 4096;
    return options;
}

/// Inverse depths of a picture, as they are read back.
std::vector<float> depths_of(gl::Device& device, const gl::CachePicture& picture, std::span<const gl::DrawItem> items) {
    std::vector<float> depths(std::size_t{picture.place.texels} * picture.place.texels, -1.0F);
    device.draws.plays();
    EXPECT_TRUE(device.capture_depths(picture, items, depths));
    device.begin_frame(Pose{});
    device.finish_frame();
    for (float& depth : depths) depth /= static_cast<float>(gl::nearest_depth_m(picture));
    return depths;
}

/// A mesh that may be shown.
struct Meshed {
    std::vector<gl::MeshCorner> corners;
    std::vector<std::uint16_t> indices;
};
Meshed mesh_of(const gl::CachePicture& picture, const std::vector<float>& depths, double share) {
    cache::DepthMesher mesher(256, 4096);
    const auto made = cache::picture_of(picture.box, picture.eye);
    const auto tolerance = static_cast<float>(cache::mesh_tolerance(*made, share));
    EXPECT_EQ(mesher.make(depths, picture.place.texels, {tolerance, 4096}), cache::DepthMeshResult::made);
    Meshed meshed;
    for (const cache::DepthCorner& corner : mesher.corners()) {
        const dvec2 at = (picture.low_m + dvec2(corner.x, corner.y) * (picture.side_m / picture.place.texels)) / picture.plane_m;
        const dvec3 ray = picture.right * at.x + picture.up * at.y + picture.forward;
        meshed.corners.push_back({vec3(ray / static_cast<double>(corner.inverse_depth)), vec2(corner.at_x, corner.at_y)});
    }
    meshed.indices.assign(mesher.indices().begin(), mesher.indices().end());
    return meshed;
}

gl::PixelImage frame_with_mesh(gl::Device& device, const Pose& pose, std::span<const gl::DrawItem> items,
                               const gl::CachePicture& picture, const Meshed& meshed, float resolution = 1) {
    device.draws.plays();
    const gl::PictureMesh mesh{picture.place, picture.eye, meshed.corners, meshed.indices};
    device.begin_frame(pose, resolution);
    device.draw_picture_meshes({&mesh, 1});
    device.draw(items);
    device.end_slice();
    device.end_items();
    device.finish_frame();
    auto image = device.read_pixels();
    EXPECT_TRUE(image.ok());
    return image.ok() ? *image : gl::PixelImage{};
}

TEST(PictureMeshes, have_the_depths_of_what_was_captured) {
    const PictureScene scene = squares({{vec3(1), dvec3(0, 0, -6), 0.5F}, {vec3(1), dvec3(0.2, 0, -5.5), 0.1F}});
    for (const auto kind : {gl::BackendKind::egl, gl::BackendKind::osmesa}) {
        auto options = with_meshes(64, 64);
        options.kind = kind;
        const auto device = open_with_pictures(scene, options);
        if (!device) continue;
        EXPECT_TRUE(device->draws_meshes());
        const gl::CachePicture picture = picture_from(meshed_cube, dvec3(0), {0, 64, 128, 64});
        const std::vector<float> depths = depths_of(*device, picture, scene.items);
        int far = 0, near = 0, none = 0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                const dvec2 ray = (picture.low_m + (dvec2(x, y) + 0.5) * (picture.side_m / 64)) / picture.plane_m;
                const auto inside = [&](const dvec2& middle, double half, double depth) {
                    const dvec2 off = glm::abs(ray * depth - middle);
                    return std::max(off.x, off.y) < half;
                };
                const float depth = depths[std::size_t{64} * static_cast<std::size_t>(y) + static_cast<std::size_t>(x)];
                if (inside(dvec2(0.2, 0), 0.1, 5.5)) {
                    ASSERT_NEAR(1 / depth, 5.5F, 1e-4F);
                    ++near;
                } else if (inside(dvec2(0), 0.5, 6)) {
                    ASSERT_NEAR(1 / depth, 6.0F, 1e-4F);
                    ++far;
                } else {
                    ASSERT_EQ(depth, 0.0F) << x << ", " << y;
                    ++none;
                }
            }
        }
        for (const int count : {far, near, none}) EXPECT_GT(count, 20);
    }
}

TEST(PictureMeshes, show_what_direct_drawing_shows_and_stand_within_a_pixel) {
    const PictureScene scene = meshed_scene();
    const auto device = open_with_pictures(scene, with_meshes(96, 96));
    if (!device) GTEST_SKIP() << "no EGL";
    const gl::CachePicture picture = picture_from(meshed_cube, dvec3(0), {0, 0, 0, 256});
    const double fov = 2 * std::atan(0.22);
    const double pixel = cache::pixel_angles(pose_along(dvec3(0), picture, fov), {96, 96}).smallest_rad;
    const auto bound = *cache::picture_of(meshed_cube, dvec3(0));
    const Meshed meshed = mesh_of(picture, depths_of(*device, picture, scene.items), 0.5);
    EXPECT_LT(meshed.indices.size() / 3, 4000U);
    for (int i = 0; i < 9; ++i) {
        const dvec3 way = glm::normalize(dvec3(std::cos(0.7 * i), std::sin(0.7 * i), i % 3 == 1 ? 0.4 : 0.0));
        double within = 0, beyond = i == 0 ? 0 : 2;
        for (int step = 0; step < 40; ++step) {
            const double middle = 0.5 * (within + beyond);
            (cache::picture_errors(bound, middle * way).total() <= pixel ? within : beyond) = middle;
        }
        const Pose pose = pose_along(within * way, picture, fov);
        const gl::PixelImage direct = frame_of(*device, pose, scene.items, {});
        const gl::PixelImage shown = frame_with_mesh(*device, pose, {}, picture, meshed);
        EXPECT_EQ(device->stats().meshes, 1U);
        ASSERT_GT(lit_pixels(direct), 1500);
        EXPECT_EQ(pixels_beyond(shown, direct, 1, 8), 0) << i;
        EXPECT_EQ(misplaced_pixels(in_two_colours(direct), in_two_colours(shown), 1, 0), 0) << i;
        for (std::size_t a = 3; a < shown.rgba.size(); a += 4) ASSERT_EQ(shown.rgba[a], 255) << "the frame stays opaque";
        (void)frame_with_mesh(*device, pose, {}, picture, meshed, 0.625F);
    }
}

TEST(PictureMeshes, hide_and_are_hidden_by_their_own_depth) {
    // The post stands inside of the box, between the two walls of the picture: no plane or face would be right.
    const PictureScene scene = squares({{vec3(1, 0, 0), dvec3(-0.4, 0, -5.2), 0.3F},
                                        {vec3(0, 0, 1), dvec3(0.4, 0, -6.8), 0.5F},
                                        {vec3(0, 1, 0), dvec3(0, 0.1, -6), 0.2F}});
    const auto device = open_with_pictures(scene, with_meshes(128, 128));
    if (!device) GTEST_SKIP() << "no EGL";
    const gl::CachePicture picture = picture_from(meshed_cube, dvec3(0), {0, 0, 0, 256});
    const std::vector<gl::DrawItem> captured{scene.items[0], scene.items[1]}, post{scene.items[2]};
    const Meshed meshed = mesh_of(picture, depths_of(*device, picture, captured), 0.25);
    const Pose pose = pose_along(dvec3(0), picture, 2 * std::atan(0.18));
    const gl::PixelImage direct = frame_of(*device, pose, scene.items, {});
    const gl::PixelImage shown = frame_with_mesh(*device, pose, post, picture, meshed);
    EXPECT_EQ(misplaced_pixels(direct, shown, 1, 8), 0);
    EXPECT_EQ(misplaced_pixels(shown, direct, 1, 8), 0);
}

TEST(PictureMeshes, are_left_out_where_they_cannot_be_drawn) {
    const PictureScene scene = meshed_scene();
    const auto plain_device = open_with_pictures(scene, with_layers(32, 32));
    if (!plain_device) GTEST_SKIP() << "no EGL";
    EXPECT_FALSE(plain_device->draws_meshes());
    const auto device = open_with_pictures(scene, with_meshes(32, 32));
    ASSERT_TRUE(device);
    EXPECT_EQ(device->program_listing(), plain_device->program_listing()) << "no program of a state class changes";
    std::vector<float> few(16);
    gl::CachePicture picture = picture_from(meshed_cube, dvec3(0), {0, 0, 0, 64});
    device->draws.plays();
    EXPECT_FALSE(device->capture_depths(picture, scene.items, few)) << "no room for all depths";
    const std::array<gl::MeshCorner, 3> corners{
        gl::MeshCorner{vec3(0, 0, -6), vec2(1)}, {vec3(1, 0, -6), vec2(9)}, {vec3(0, 1, -6), vec2(4)}};
    const std::array<std::uint16_t, 3> one{0, 1, 2};
    const std::vector<std::uint16_t> too_many(std::size_t{3} * 4097);
    const std::array<gl::PictureMesh, 4> meshes{
        gl::PictureMesh{picture.place, dvec3(0), corners, too_many}, gl::PictureMesh{{9, 0, 0, 64}, dvec3(0), corners, one},
        gl::PictureMesh{picture.place, dvec3(0), {}, {}}, gl::PictureMesh{picture.place, dvec3(0), corners, one}};
    device->begin_frame(Pose{});
    device->draw_picture_meshes(meshes);
    device->finish_frame();
    EXPECT_EQ(device->stats().meshes, 1U);
    std::vector<gl::PictureMesh> many(10'000, meshes.back());
    device->begin_frame(Pose{});
    device->draw_picture_meshes(many);
    device->finish_frame();
    EXPECT_EQ(device->stats().meshes, 10'000U) << "in parts";
}

}  // namespace
}  // namespace surefoot::test
