// Pictures of the image cache on a device, against the same content drawn directly.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "render/gl/picture_faces.hpp"
#include "rt/base/random.hpp"
#include "tests/gl/picture_scene.hpp"

namespace surefoot::test {
namespace {

const Box cube_of_pictures{dvec3(-1, -1, -7), dvec3(1, 1, -5)};

/// Textured, masked, coloured by vertices, lit and plain surfaces inside of `cube_of_pictures`, some of them across each other.
PictureScene mixed_cube() {
    SmallModel small;
    auto leaf = plain(1, 1, 1, 1, model::effect_texture | model::effect_alpha_mask);
    leaf.texture = small.texture({30, 200, 60, 255}, {30, 90, 200, 0}, 16);
    leaf.two_sided = true;
    auto board = plain(1, 1, 1, 1, model::effect_texture | model::effect_sun);
    board.texture = small.texture({250, 240, 20, 255}, {90, 20, 200, 255}, 16);
    auto painted = plain(0.8F, 0.7F, 0.6F, 1, model::effect_vertex_colour);
    painted.two_sided = true;
    const std::array materials{small.material(leaf), small.material(board), small.material(painted),
                               small.material(plain(0.3F, 0.9F, 0.35F))};
    PictureScene scene;
    for (int i = 0; i < 16; ++i) {
        const int column = i % 4, row = i / 4;
        const mat3 turn(glm::mat3_cast(glm::angleAxis(0.05F * static_cast<float>(i - 8), vec3(0, 1, 0))));
        const auto node = small.square(materials[static_cast<std::size_t>(i) % 4],
                                       at(-0.55 + 0.36 * column, -0.55 + 0.36 * row, -6 + 0.05 * i, turn), 0.3F,
                                       {200, 120, static_cast<std::uint8_t>(15 * i), 255});
        scene.items.push_back({node, node - 1});
    }
    scene.model = small.finish();
    return scene;
}

TEST(CachePictures, from_the_eye_of_the_capture_a_picture_is_what_it_shows) {
    const PictureScene scene = mixed_cube();
    for (const auto kind : {gl::BackendKind::egl, gl::BackendKind::osmesa}) {
        auto options = with_layers(128, 128);
        options.kind = kind;
        const auto device = open_with_pictures(scene, options);
        if (!device) continue;
        gl::CachePicture picture = picture_from(cube_of_pictures, dvec3(0), {0, 128, 64, 128});
        ASSERT_NEAR(picture.low_m.x, -0.5 * picture.side_m, 1e-9);
        const Pose pose = pose_along(dvec3(0), picture, 2 * std::atan(0.5 * picture.side_m / picture.plane_m));
        const gl::PixelImage direct = frame_of(*device, pose, scene.items, {});
        capture(*device, picture, scene.items);
        const gl::PixelImage shown = frame_of(*device, pose, {}, {&picture, 1});
        EXPECT_GT(lit_pixels(direct), 128 * 128 / 4);
        int other = 0;
        for (int y = 0; y < 128; ++y)
            for (int x = 0; x < 128; ++x) other += difference(pixel_of(direct, x, y), pixel_of(shown, x, y)) > 2 ? 1 : 0;
        EXPECT_LE(other, 16) << "a texel a pixel";
        EXPECT_EQ(misplaced_pixels(direct, shown, 1, 2), 0);
        for (std::size_t i = 3; i < shown.rgba.size(); i += 4) ASSERT_EQ(shown.rgba[i], 255) << "the frame stays opaque";
        device->draws.plays();
        EXPECT_EQ(device->stats().pictures, 1U);
    }
}

/// White squares at the near and the far face, so that parallax is largest.
PictureScene near_and_far() {
    return squares({{vec3(1), dvec3(-0.5, 0.45, -5.001), 0.4F},
                    {vec3(1), dvec3(0.5, -0.45, -5.001), 0.4F},
                    {vec3(1), dvec3(-0.5, -0.45, -6.999), 0.4F},
                    {vec3(1), dvec3(0.5, 0.45, -6.999), 0.4F}});
}

TEST(CachePictures, of_an_eye_within_the_bound_show_nothing_more_than_a_pixel_beside_its_place) {
    const PictureScene scene = near_and_far();
    const auto device = open_with_pictures(scene, with_layers(96, 96));
    if (!device) GTEST_SKIP() << "no EGL";
    const gl::CachePicture mean = picture_from(cube_of_pictures, dvec3(0), {0, 0, 0, 256});
    const gl::CachePicture far = picture_from(cube_of_pictures, dvec3(0), {0, 0, 0, 256}, cache::PlanePlace::far_face);
    const double fov = 2 * std::atan(0.3);
    const double pixel = cache::pixel_angles(pose_along(dvec3(0), mean, fov), {96, 96}).smallest_rad;
    auto bound = *cache::picture_of(cube_of_pictures, dvec3(0));
    int bad_by_far = 0;
    for (int i = 0; i < 12; ++i) {
        dvec3 way = glm::normalize(dvec3(std::cos(0.55 * i), std::sin(0.55 * i), i % 3 == 0 ? 0.0 : i % 3 == 1 ? 0.4 : -0.4));
        double within = 0, beyond = 2;
        for (int step = 0; step < 40; ++step) {
            const double middle = 0.5 * (within + beyond);
            (cache::picture_errors(bound, middle * way).total() <= pixel ? within : beyond) = middle;
        }
        const Pose pose = pose_along(within * way, mean, fov);
        const gl::PixelImage direct = frame_of(*device, pose, scene.items, {});
        ASSERT_GT(lit_pixels(direct), 1000);
        capture(*device, mean, scene.items);
        const gl::PixelImage shown = in_two_colours(frame_of(*device, pose, {}, {&mean, 1}));
        EXPECT_EQ(misplaced_pixels(direct, shown, 1, 0), 0) << i;
        EXPECT_EQ(misplaced_pixels(shown, direct, 1, 0), 0) << i;
        capture(*device, far, scene.items);
        const gl::PixelImage wrong = in_two_colours(frame_of(*device, pose, {}, {&far, 1}));
        bad_by_far += misplaced_pixels(direct, wrong, 1, 0) + misplaced_pixels(wrong, direct, 1, 0) > 0 ? 1 : 0;
    }
    EXPECT_GE(bad_by_far, 8) << "a plane at the far face must be seen";
}

TEST(CachePictures, hide_what_is_behind_their_boxes_and_are_hidden_by_what_is_before_them) {
    // A leaf and a box side by side, both 4 to 5 m away. On the picture's plane, at 4.44 m, the picture would hide the leaf's
    // wall.
    const PictureScene scene = squares({{vec3(0, 0, 1), dvec3(0, 0, -4.8), 0.5F},      // of the leaf
                                        {vec3(1, 0, 0), dvec3(1, 0, -4.98), 0.5F},     // in the box
                                        {vec3(0, 1, 0), dvec3(1, 0.3, -3), 0.2F},      // before it
                                        {vec3(1, 1, 0), dvec3(1.2, 0.2, -8), 1.5F}});  // behind it
    const auto device = open_with_pictures(scene, with_layers(256, 128));
    if (!device) GTEST_SKIP() << "no EGL";
    const Box box{dvec3(0.5, -0.5, -5), dvec3(1.5, 0.5, -4)};
    const gl::CachePicture picture = picture_from(box, dvec3(0), {0, 0, 0, 256});
    const std::vector<gl::DrawItem> in_box{scene.items[1]}, others{scene.items[0], scene.items[2], scene.items[3]};
    capture(*device, picture, scene.items);  // the box cuts off what the others have
    Pose pose;
    pose.fov_y_rad = 2 * std::atan(0.125);  // 0.25 across 256 pixels: the leaf's wall ends 4 pixels inside the picture's square
    pose.orientation = glm::angleAxis(-0.15, dvec3(0, 1, 0));
    const gl::PixelImage direct = frame_of(*device, pose, scene.items, {});
    const gl::PixelImage shown = frame_of(*device, pose, others, {&picture, 1});
    EXPECT_EQ(misplaced_pixels(direct, shown, 1, 8), 0);
    EXPECT_EQ(misplaced_pixels(in_two_colours(shown), in_two_colours(direct), 1, 8), 0);
    const gl::PixelImage alone = frame_of(*device, pose, {}, {&picture, 1});
    const gl::PixelImage alone_directly = frame_of(*device, pose, in_box, {});
    EXPECT_EQ(misplaced_pixels(in_two_colours(alone), alone_directly, 1, 0), 0) << "cut by the box";
    EXPECT_EQ(misplaced_pixels(alone_directly, in_two_colours(alone), 1, 0), 0);
    std::array<int, 4> counts{};
    for (std::size_t i = 0; i < direct.rgba.size(); i += 4)
        for (std::size_t c = 0; c < 4; ++c) {
            const std::array<std::array<int, 3>, 4> colours{{{0, 0, 255}, {255, 0, 0}, {0, 255, 0}, {255, 255, 0}}};
            counts[c] +=
                direct.rgba[i] == colours[c][0] && direct.rgba[i + 1] == colours[c][1] && direct.rgba[i + 2] == colours[c][2];
        }
    for (const int count : counts) EXPECT_GT(count, 500) << "all four are seen";
}

TEST(CachePictures, of_boxes_side_by_side_leave_no_crack) {
    const PictureScene scene = squares({{vec3(1), dvec3(0, 0, -6), 1.0F}, {vec3(1), dvec3(0.1, 0.1, -5.2), 0.5F}});
    const auto device = open_with_pictures(scene, with_layers(160, 160));
    if (!device) GTEST_SKIP() << "no EGL";
    const double fov = 2 * std::atan(0.25);
    Pose pose;
    pose.fov_y_rad = fov;
    const double pixel = cache::pixel_angles(pose, {160, 160}).smallest_rad;
    std::vector<gl::CachePicture> pictures;
    for (const auto& [from, to, column] : {std::tuple{-1.0, 0.1, 0}, {0.1, 1.0, 128}}) {
        const Box box = grown({dvec3(from, -1, -7), dvec3(to, 1, -5)}, 7 * pixel);
        pictures.push_back(picture_from(box, dvec3(0), {0, static_cast<std::uint16_t>(column), 0, 128}));
        capture(*device, pictures.back(), scene.items);
    }
    Random random(7);
    for (int i = 0; i < 50; ++i) {
        dvec3 way = any_in(random, dvec3(-1), dvec3(1));
        for (const gl::CachePicture& picture : pictures) {
            const auto bound = *cache::picture_of(picture.box, dvec3(0));
            while (cache::picture_errors(bound, way).total() > pixel) way *= 0.9;
        }
        pose.position = way;
        const gl::PixelImage direct = frame_of(*device, pose, scene.items, {});
        const gl::PixelImage shown = frame_of(*device, pose, {}, pictures);
        int dark = 0, lit = 0;
        for (int y = 3; y < 157; ++y) {
            for (int x = 3; x < 157; ++x) {
                bool inside = true;
                for (int v = -3; v <= 3; ++v)
                    for (int u = -3; u <= 3; ++u) inside = inside && pixel_of(direct, x + u, y + v)[0] == 255;
                lit += inside ? 1 : 0;
                dark += inside && pixel_of(shown, x, y)[0] < 250 ? 1 : 0;
            }
        }
        EXPECT_GT(lit, 5000);
        EXPECT_EQ(dark, 0) << "seen through the wall from " << way.x << " " << way.y << " " << way.z;
    }
}

TEST(CachePictures, from_any_side_show_the_faces_that_look_at_the_eye) {
    const PictureScene scene = mixed_cube();
    const auto device = open_with_pictures(scene, with_layers(96, 96));
    if (!device) GTEST_SKIP() << "no EGL";
    for (int i = 0; i < 27; ++i) {
        const dvec3 side(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        const dvec3 eye = cube_of_pictures.centre() + 4.0 * side + 0.1 * dvec3(side.y, side.z, side.x);
        gl::CachePicture picture = picture_from(cube_of_pictures, eye, {0, 0, 0, 96});
        const dvec2 reach = glm::max(glm::abs(picture.low_m), glm::abs(picture.low_m + picture.side_m));
        picture.low_m = dvec2(-std::max(reach.x, reach.y));  // straight before the eye: a texel a pixel
        picture.side_m = -2 * picture.low_m.x;
        std::array<gl::PictureVertex, gl::max_picture_vertices> corners;
        const auto faces = static_cast<std::size_t>(std::abs(side.x) + std::abs(side.y) + std::abs(side.z));
        ASSERT_EQ(gl::add_picture(picture, eye, corners), 6 * faces) << i;
        if (faces == 0) {  // inside of the box
            const gl::PixelImage shown = frame_of(*device, Pose{eye}, {}, {&picture, 1});
            EXPECT_EQ(lit_pixels(shown), 0);
            device->draws.plays();
            EXPECT_EQ(device->stats().pictures, 0U);
            continue;
        }
        const Pose pose = pose_along(eye, picture, 2 * std::atan(0.5 * picture.side_m / picture.plane_m));
        capture(*device, picture, scene.items);
        const gl::PixelImage direct = frame_of(*device, pose, scene.items, {});
        const gl::PixelImage shown = frame_of(*device, pose, {}, {&picture, 1});
        EXPECT_EQ(misplaced_pixels(direct, shown, 1, 4), 0) << i;
        EXPECT_EQ(misplaced_pixels(shown, direct, 1, 4), 0) << i;
        EXPECT_GT(lit_pixels(direct), 100) << i;
    }
}

TEST(CachePictures, take_nothing_from_the_squares_beside_theirs) {
    const PictureScene scene = squares(
        {{vec3(1, 0, 0), dvec3(0, 0, -6), 3.0F}, {vec3(0, 1, 0), dvec3(0, 0, -6), 3.0F}, {vec3(0, 0, 1), dvec3(0, 0, -6), 3.0F}});
    const auto device = open_with_pictures(scene, with_layers(96, 96, 2));
    if (!device) GTEST_SKIP() << "no EGL";
    const auto place = [](int i) {
        return gl::PicturePlace{1, static_cast<std::uint16_t>(64 * (i % 3)), static_cast<std::uint16_t>(64 * (i / 3)), 64};
    };
    // No margin: the middle square is full up to its edge, as the others are.
    auto picture = picture_from(cube_of_pictures, dvec3(0), place(4));
    picture.low_m = dvec2(-0.8);
    picture.side_m = 1.6;
    for (int i = 0; i < 9; ++i) {
        picture.place = place(i);
        capture(*device, picture, {&scene.items[i == 4 ? 0U : 1U + static_cast<std::size_t>(i % 2)], 1});
    }
    picture.place = place(4);
    for (int i = 0; i < 16; ++i) {
        const dvec3 eye(0.5 * std::cos(0.4 * i), 0.5 * std::sin(0.4 * i), 0.3 * std::sin(1.0 * i));
        const gl::PixelImage shown = frame_of(*device, pose_along(eye, picture, 0.5), {}, {&picture, 1});
        EXPECT_GT(lit_pixels(shown), 2000);
        for (std::size_t p = 0; p < shown.rgba.size(); p += 4) ASSERT_EQ(int{shown.rgba[p + 1]} + int{shown.rgba[p + 2]}, 0);
    }
}

/// The children of a box that is halved along x, seen back to front from an eye beyond the upper half.
std::array<gl::CachePicture, 2> halves_from(const dvec3& eye, std::array<gl::PicturePlace, 2> places, double grown_by_m) {
    Box low = cube_of_pictures, high = cube_of_pictures;
    low.max.x = high.min.x = 0;
    return {picture_from(grown(low, grown_by_m), eye, places[0]), picture_from(grown(high, grown_by_m), eye, places[1])};
}

/// A board of squares of full colours, some of them in both halves, and two before it: nothing is as narrow as a pixel.
PictureScene full_colours() {
    std::vector<ColouredSquare> all;
    for (int i = 0; i < 15; ++i) {
        const int colour = i % 7 + 1, row = i / 5;
        all.push_back({vec3(colour & 1, colour / 2 & 1, colour / 4), dvec3(-0.8 + 0.4 * (i % 5), -0.5 + 0.5 * row, -6.2), 0.2F});
    }
    all.push_back({vec3(1, 0, 0), dvec3(-0.5, 0.1, -5.7), 0.15F});
    all.push_back({vec3(0, 1, 1), dvec3(0.3, -0.3, -5.5), 0.2F});
    return squares(all);
}

TEST(CachePictures, made_of_pictures_are_what_is_made_of_triangles_in_any_layer) {
    const PictureScene scene = full_colours();
    for (const auto kind : {gl::BackendKind::egl, gl::BackendKind::osmesa}) {
        auto options = with_layers(128, 128, 2);
        options.kind = kind;
        const auto device = open_with_pictures(scene, options);
        if (!device) continue;
        const dvec3 eye(1.2, 0.4, 0);
        for (const std::uint16_t layer : {std::uint16_t{0}, std::uint16_t{1}}) {
            const auto halves = halves_from(eye, {{{0, 0, 0, 128}, {0, 128, 0, 128}}}, 0.06);
            gl::CachePicture whole = picture_from(grown(cube_of_pictures, 0.06), eye, {layer, 0, 128, 128});
            const Pose pose = pose_along(eye, whole, 2 * std::atan(0.5 * whole.side_m / whole.plane_m));
            capture(*device, whole, scene.items);
            const gl::PixelImage captured = in_two_colours(frame_of(*device, pose, {}, {&whole, 1}));
            const gl::PixelImage direct = frame_of(*device, pose, scene.items, {});
            EXPECT_GT(lit_pixels(direct), 1500);
            for (const gl::CachePicture& half : halves) capture(*device, half, scene.items);
            capture(*device, whole, {}, halves);
            const gl::PixelImage combined = in_two_colours(frame_of(*device, pose, {}, {&whole, 1}));
            EXPECT_EQ(pixels_beyond(captured, direct, 1, 0), 0);
            EXPECT_EQ(pixels_beyond(combined, direct, 1, 0) + pixels_beyond(direct, combined, 1, 0), 0)
                << "an edge moves by half a texel each time";
            const gl::PixelImage shown = in_two_colours(frame_of(*device, pose, {}, halves));
            EXPECT_EQ(pixels_beyond(shown, direct, 1, 0), 0) << "the children are as they were";
            capture(*device, whole, {}, {halves.data(), 1});
            EXPECT_LT(lit_pixels(frame_of(*device, pose, {}, {&whole, 1})), lit_pixels(combined)) << "one half of it";
        }
    }
}

TEST(CachePictures, made_of_pictures_hold_the_latest_of_each_back_to_front) {
    // One of two squares hides the other: red before green, as the eye is beyond the upper half.
    const PictureScene scene =
        squares({{vec3(1, 0, 0), dvec3(0.5, 0, -5.5), 0.3F}, {vec3(0, 1, 0), dvec3(-0.5, 0.25, -6.5), 0.4F}});
    const auto device = open_with_pictures(scene, with_layers(96, 96));
    if (!device) GTEST_SKIP() << "no EGL";
    const dvec3 eye(2.5, 0, -3.5);
    const std::array<gl::PicturePlace, 2> places{{{0, 0, 0, 128}, {0, 128, 0, 128}}};
    const auto halves = halves_from(eye, places, 0.01);
    gl::CachePicture whole = picture_from(grown(cube_of_pictures, 0.01), eye, {0, 0, 0, 128});
    const Pose pose = pose_along(eye, whole, 0.6);
    const gl::PixelImage direct = frame_of(*device, pose, scene.items, {});
    // All wait for one frame; the whole takes the place of a half that it is made of.
    device->draws.plays();
    for (const gl::CachePicture& half : halves) EXPECT_TRUE(device->capture_picture(half, scene.items));
    EXPECT_TRUE(device->capture_picture(whole, {}, halves));
    const gl::PixelImage combined = in_two_colours(frame_of(*device, pose, {}, {&whole, 1}));
    EXPECT_EQ(device->stats().captures, 3U);
    EXPECT_EQ(pixels_beyond(combined, direct, 1, 0) + pixels_beyond(direct, combined, 1, 0), 0);
    const auto count_of = [](const gl::PixelImage& image, std::size_t channel) {
        int count = 0;
        for (std::size_t i = 0; i < image.rgba.size(); i += 4) count += image.rgba[i + channel] > 128 ? 1 : 0;
        return count;
    };
    ASSERT_GT(count_of(direct, 0), 300);
    ASSERT_GT(count_of(direct, 1), 30);
    for (const gl::CachePicture& half : halves) capture(*device, half, scene.items);
    const std::array turned{halves[1], halves[0]};
    whole.place = {0, 0, 128, 128};
    capture(*device, whole, {}, turned);
    const gl::PixelImage wrong = in_two_colours(frame_of(*device, pose, {}, {&whole, 1}));
    EXPECT_GT(pixels_beyond(wrong, direct, 1, 0), 30) << "front to back is wrong";
    capture(*device, whole, {scene.items.data(), 1}, {halves.data(), 1});
    const gl::PixelImage both = in_two_colours(frame_of(*device, pose, {}, {&whole, 1}));
    EXPECT_EQ(pixels_beyond(both, direct, 1, 0), 0) << "pictures behind triangles are hidden";
}

}  // namespace
}  // namespace surefoot::test
