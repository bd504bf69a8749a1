// A posted picture on the box that stands for it, drawn by the device where a texel is a pixel; faces of a box from farther off.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>

#include "render/bake/bake.hpp"
#include "render/effects/effects.hpp"
#include "render/gl/device.hpp"
#include "tests/bake/scenes.hpp"

namespace surefoot::bake {
namespace {

constexpr std::uint32_t poster_fields = 8, view_px = 64;
constexpr double view_angle_rad = 0.17;
constexpr double board_m = 3;

/// Row 0 is the lowest; the first field of a row is its highest bit.
using Poster = std::array<std::uint8_t, poster_fields>;
constexpr Poster checker{0x55, 0xAA, 0x55, 0xAA, 0x55, 0xAA, 0x55, 0xAA};
constexpr Poster letter{0x42, 0x44, 0x48, 0x78, 0x44, 0x42, 0x42, 0x7C};  // an R, the right way round and up

bool is_light(const Poster& poster, std::size_t column, std::size_t row) { return (poster[row] >> (7 - column) & 1U) != 0; }

importer::Primitive upright(std::uint32_t cells, double from_m, double to_m, double z_m, importer::Index material) {
    importer::Primitive p = grid_surface(cells, cells, [=](float u, float v) {
        return vec3(dvec3(from_m + (to_m - from_m) * u, from_m + (to_m - from_m) * v, z_m));
    });
    p.material = material;
    return p;
}

/// A brown board of 3 m with a poster on it, which leaves a rim of a twentieth.
importer::Scene poster_scene(const Poster& poster) {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(2);
    scene.materials[0].colour = {0.4F, 0.3F, 0.2F, 1};
    scene.materials[1].image = 0;
    for (importer::Material& material : scene.materials) material.two_sided = material.unlit = true;
    image::Image picture;
    picture.width = picture.height = 64;
    for (std::size_t y = 0; y < 64; ++y) {
        for (std::size_t x = 0; x < 64; ++x) {
            const std::uint8_t shade = is_light(poster, x / 8, y / 8) ? 255 : 0;
            picture.rgba.insert(picture.rgba.end(), {shade, shade, shade, 255});
        }
    }
    scene.images.push_back(std::move(picture));
    importer::Mesh board{"board", {upright(16, 0, board_m, 0, 0), upright(16, 0, board_m, -0.1, 0)}};
    scene.meshes.push_back(std::move(board));
    place(scene, 0, dvec3(0));
    place(scene, add_mesh(scene, upright(8, 0.05 * board_m, 0.95 * board_m, 0.01, 1), "poster"), dvec3(0));
    return scene;
}

/// The model's box with pictures for all of it; none: it has none.
std::optional<model::Index> root_box(const model::Model& m) {
    const model::Node& root = m.nodes[0];
    if (m.reps[root.first_rep].kind != model::RepKind::textured_box) return {};
    return root.first_rep;
}

/// A device. Skipped only where the library is missing, or a sanitizer allows no GL.
class PostedPicture : public ::testing::Test {
protected:
    void SetUp() override {
        gl::DeviceOptions options;
        options.viewport = {view_px, view_px};
        options.sky = {0, 0, 1};
        auto opened = gl::open_device(options);
        if (!opened && opened.error().kind == ErrorKind::unsupported) GTEST_SKIP() << opened.error().text();
        ASSERT_TRUE(opened.ok()) << opened.error().text();
        device_ = std::move(*opened);
    }
    void load(const model::Model& m) {
        device_->draws.plays();
        const auto loaded = device_->load(m, effects::assemble_program);
        ASSERT_TRUE(loaded.ok()) << loaded.error().text();
    }
    gl::PixelImage draw(const Pose& pose, model::Index rep) {
        device_->draws.plays();
        device_->begin_frame(pose);
        const gl::DrawItem item{0, rep};
        device_->draw({&item, 1});
        device_->end_slice();
        device_->finish_frame();
        auto image = device_->read_pixels();
        EXPECT_TRUE(image.ok());
        return image.ok() ? *image : gl::PixelImage{};
    }
    std::unique_ptr<gl::Device> device_;
};

/// Looks along -`towards` at a point, where a pixel there is `pixel_m`.
Pose pose_of(const dvec3& at, const dvec3& towards, double pixel_m) {
    Pose pose;
    pose.fov_y_rad = view_angle_rad;
    pose.position = at + 0.5 * view_px * pixel_m / std::tan(0.5 * view_angle_rad) * towards;
    pose.orientation = glm::quatLookAt(-towards, std::abs(towards.y) > 0.9 ? dvec3(0, 0, 1) : dvec3(0, 1, 0));
    return pose;
}

TEST_F(PostedPicture, IsReadableAtOneTexelAPixel) {
    constexpr double texel_m = board_m / 28;
    for (const Poster& poster : {checker, letter}) {
        const auto m = bake(poster_scene(poster), {}, {});
        ASSERT_TRUE(m.ok()) << m.error().text();
        const auto box = root_box(*m);
        ASSERT_TRUE(box) << "the board has no box";
        load(*m);
        const Box& all = m->nodes[0].box;
        for (const double shift : {0.0, 0.3, 0.5}) {  // of pixels against texels
            const dvec3 middle(all.centre().x + shift * texel_m, all.centre().y + shift * texel_m, all.max.z);
            const gl::PixelImage image = draw(pose_of(middle, dvec3(0, 0, 1), texel_m), *box);
            std::array<double, poster_fields * poster_fields> sum{}, count{};
            for (std::size_t y = 0; y < view_px; ++y) {
                for (std::size_t x = 0; x < view_px; ++x) {
                    const double column = ((static_cast<double>(x) + 0.5 - view_px / 2.0) * texel_m + middle.x) / board_m;
                    const double row = ((view_px / 2.0 - static_cast<double>(y) - 0.5) * texel_m + middle.y) / board_m;
                    const double u = (column - 0.05) / 0.9 * poster_fields, v = (row - 0.05) / 0.9 * poster_fields;
                    if (!(u >= 0 && v >= 0 && u < poster_fields && v < poster_fields)) continue;
                    const auto field = static_cast<std::size_t>(v) * poster_fields + static_cast<std::size_t>(u);
                    sum[field] += image.rgba[4 * (y * view_px + x) + 1];
                    ++count[field];
                }
            }
            for (std::size_t field = 0; field < sum.size(); ++field) {
                ASSERT_GE(count[field], 4) << "a field has pixels";
                const double mean = sum[field] / count[field];
                const bool light = is_light(poster, field % poster_fields, field / poster_fields);
                EXPECT_EQ(mean > 128, light) << mean << " in field " << field % poster_fields << ' ' << field / poster_fields;
                EXPECT_GT(std::abs(mean - 128), 25) << "too grey to be read: " << mean;
            }
        }
    }
}

/// A cube of 2 m with a colour a side, and in it something with a picture, so that boxes have pictures.
importer::Scene six_colours() {
    importer::Scene scene = poster_scene(checker);
    scene.nodes.clear();
    importer::Mesh cube{"cube", {}};
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        importer::Primitive side = grid_surface(10, 10, [=](float s, float t) {
            vec3 at(0);
            at[axis] = face % 2 == 1 ? 1.0F : -1.0F;
            at[u] = (face % 2 == 1 ? 1.0F : -1.0F) * (2 * s - 1);
            at[v] = 2 * t - 1;
            return at;
        });
        side.material = static_cast<importer::Index>(scene.materials.size());
        importer::Material& material = scene.materials.emplace_back();
        material.unlit = material.two_sided = true;
        const auto part = static_cast<float>(face);
        material.colour = {face % 2 == 0 ? 1.0F : 0.0F, part / 5, 1 - part / 5, 1};
        cube.primitives.push_back(std::move(side));
    }
    scene.meshes.push_back(std::move(cube));
    place(scene, static_cast<importer::Index>(scene.meshes.size() - 1), dvec3(0));
    place(scene, 1, dvec3(-0.3, -0.3, 0), dvec3(0.2));
    return scene;
}

TEST_F(PostedPicture, FacesOfABoxDoNotMixFromFartherOff) {
    const importer::Scene scene = six_colours();
    const auto m = bake(scene, {}, {});
    ASSERT_TRUE(m.ok()) << m.error().text();
    const auto box = root_box(*m);
    ASSERT_TRUE(box) << "the cube has no box";
    load(*m);
    std::vector<dvec3> sides;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            dvec3 towards(0);
            towards[axis] = side;
            sides.push_back(towards);
            sides.push_back(glm::normalize(towards + dvec3(0.3, 0.5, 0.4)));
        }
    for (const dvec3& towards : sides) {
        for (const double texels : {1.0, 2.0, 4.0}) {  // in a pixel
            const double pixel_m = texels * 2.0 / 28;
            const gl::PixelImage image = draw(pose_of(dvec3(0), towards, pixel_m), *box);
            int shown = 0, mixed = 0;
            for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
                const auto is = [&](const std::array<float, 4>& colour) {
                    int off = 0;
                    for (std::size_t k = 0; k < 3; ++k)
                        off = std::max(off, std::abs(image.rgba[i + k] - static_cast<int>(std::lround(255 * colour[k]))));
                    return off <= 3;
                };
                if (is({0, 0, 1, 1}) && image.rgba[i + 1] == 0) continue;  // the sky
                ++shown;
                bool one = false;
                for (std::size_t face = 0; face < 6; ++face) one |= is(scene.materials[2 + face].colour);
                mixed += one ? 0 : 1;
            }
            EXPECT_GT(shown, 0.8 * (2 / pixel_m) * (2 / pixel_m)) << towards.x << ' ' << towards.y << ' ' << towards.z;
            EXPECT_EQ(mixed, 0) << "of " << shown << " pixels, " << texels << " texels a pixel, from " << towards.x << ' '
                                << towards.y << ' ' << towards.z;
        }
    }
}

}  // namespace
}  // namespace surefoot::bake
