// Boxes with pictures for the tests of the image cache on a device: content, eyes, frames with and without pictures.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/cache/validity.hpp"
#include "render/effects/effects.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot::test {

/// A model whose items are all that is drawn.
struct PictureScene {
    model::Model model;
    std::vector<gl::DrawItem> items;
};

/// Squares of one colour each, in the plane z, facing +z.
struct ColouredSquare {
    vec3 colour;
    dvec3 middle;
    float half;
};
inline PictureScene squares(const std::vector<ColouredSquare>& all) {
    SmallModel small;
    PictureScene scene;
    for (const ColouredSquare& one : all) {
        const auto material = small.material(plain(one.colour.r, one.colour.g, one.colour.b));
        const auto node = small.square(material, at(one.middle.x, one.middle.y, one.middle.z), one.half);
        scene.items.push_back({node, node - 1});
    }
    scene.model = small.finish();
    return scene;
}

/// Null: no such back end here.
inline std::unique_ptr<gl::Device> open_with_pictures(const PictureScene& scene, const gl::DeviceOptions& options) {
    auto device = gl::open_device(options);
    if (!device.ok()) {
        EXPECT_EQ(device.error().kind, ErrorKind::unsupported) << device.error().text();
        return nullptr;
    }
    (*device)->draws.plays();
    const auto loaded = (*device)->load(scene.model, effects::assemble_program);
    EXPECT_TRUE(loaded.ok()) << loaded.error().text();
    EXPECT_EQ((*device)->picture_layers(), options.picture_layers) << (*device)->picture_reason();
    return std::move(*device);
}

inline gl::DeviceOptions with_layers(std::uint32_t width, std::uint32_t height, std::uint32_t layers = 1) {
    gl::DeviceOptions options;
    options.viewport = {width, height};
    options.sky = {0, 0, 0};
    options.max_items = 4096;
    options.picture_layers = layers;
    return options;
}

/// The picture of a box from an eye, with a margin of a texel. Without a picture: one without size.
inline gl::CachePicture picture_from(const Box& box, const dvec3& eye, gl::PicturePlace place,
                                     cache::PlanePlace plane = cache::PlanePlace::harmonic_mean) {
    const auto made = cache::picture_of(box, eye, plane);
    if (!made) return {place, eye, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 1, dvec2(0), 0, box};
    const double side = made->side_m * place.texels / (place.texels - 2.0);
    return {place, made->eye, made->right, made->up, made->forward, made->plane_m, made->low_m - dvec2(side / place.texels),
            side,  box};
}

/// A view along a direction, upright as pictures are.
inline Pose pose_along(const dvec3& eye, const gl::CachePicture& like, double fov_y_rad) {
    Pose pose;
    pose.position = eye;
    pose.orientation = glm::quat_cast(dmat3(like.right, like.up, -like.forward));
    pose.fov_y_rad = fov_y_rad;
    return pose;
}

inline Box grown(Box box, double by_m) { return {box.min - by_m, box.max + by_m}; }

/// A frame with these triangles and pictures.
inline void draw_frame(gl::Device& device, const Pose& pose, std::span<const gl::DrawItem> items,
                       std::span<const gl::CachePicture> pictures, float resolution = 1) {
    device.draws.plays();
    device.begin_frame(pose, resolution);
    device.draw(items);
    device.end_slice();
    device.draw_pictures(pictures);
    device.end_slice();
    device.end_items();
    device.finish_frame();
}

inline gl::PixelImage frame_of(gl::Device& device, const Pose& pose, std::span<const gl::DrawItem> items,
                               std::span<const gl::CachePicture> pictures, float resolution = 1) {
    draw_frame(device, pose, items, pictures, resolution);
    device.draws.plays();
    auto image = device.read_pixels();
    EXPECT_TRUE(image.ok());
    return image.ok() ? *image : gl::PixelImage{};
}

inline void capture(gl::Device& device, const gl::CachePicture& picture, std::span<const gl::DrawItem> items,
                    std::span<const gl::CachePicture> pictures = {}) {
    device.draws.plays();
    EXPECT_TRUE(device.capture_picture(picture, items, pictures));
    device.begin_frame(Pose{});
    EXPECT_EQ(device.stats().captures, 1U);
    EXPECT_EQ(device.stats().items, 0U);
    device.finish_frame();
}

inline const std::uint8_t* pixel_of(const gl::PixelImage& image, int x, int y) {
    return &image.rgba[4 * (static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x))];
}

/// By how much two pixels differ, in 1/255.
inline int difference(const std::uint8_t* a, const std::uint8_t* b) {
    int worst = 0;
    for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(int{a[c]} - int{b[c]}));
    return worst;
}

/// Pixels of `image` whose colour is not that of `other` within so many pixels, up to 1/255 * `within`.
inline int misplaced_pixels(const gl::PixelImage& image, const gl::PixelImage& other, int radius, int within) {
    const int w = static_cast<int>(image.width), h = static_cast<int>(image.height);
    int count = 0;
    for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
            bool found = false;
            for (int v = std::max(0, y - radius); v <= std::min(h - 1, y + radius) && !found; ++v)
                for (int u = std::max(0, x - radius); u <= std::min(w - 1, x + radius) && !found; ++u)
                    found = difference(pixel_of(image, x, y), pixel_of(other, u, v)) <= within;
            count += found ? 0 : 1;
        }
    }
    return count;
}

/// Pixels of `image` with a channel that is out of what `other` has within so many pixels, by over 1/255 * `within`. So mixed
/// colours of an edge are right beside it, and a surface wider than the window must have its own colour.
inline int pixels_beyond(const gl::PixelImage& image, const gl::PixelImage& other, int radius, int within) {
    const int w = static_cast<int>(image.width), h = static_cast<int>(image.height);
    int count = 0;
    for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
            bool beyond = false;
            for (int c = 0; c < 3; ++c) {
                int low = 255, high = 0;
                for (int v = std::max(0, y - radius); v <= std::min(h - 1, y + radius); ++v) {
                    for (int u = std::max(0, x - radius); u <= std::min(w - 1, x + radius); ++u) {
                        low = std::min(low, int{pixel_of(other, u, v)[c]});
                        high = std::max(high, int{pixel_of(other, u, v)[c]});
                    }
                }
                const int value = pixel_of(image, x, y)[c];
                beyond = beyond || value < low - within || value > high + within;
            }
            count += beyond ? 1 : 0;
        }
    }
    return count;
}

/// The same picture in two colours: what is at least half bright, and what is darker.
inline gl::PixelImage in_two_colours(gl::PixelImage image) {
    for (std::size_t i = 0; i < image.rgba.size(); ++i)
        if (i % 4 != 3) image.rgba[i] = image.rgba[i] >= 128 ? 255 : 0;
    return image;
}

inline int lit_pixels(const gl::PixelImage& image) {
    int count = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
        count += image.rgba[i] + image.rgba[i + 1] + image.rgba[i + 2] > 0 ? 1 : 0;
    return count;
}

}  // namespace surefoot::test
