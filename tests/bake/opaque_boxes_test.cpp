// Boxes whose pictures show no hole: they lose the mask, and no pixel changes by it.
#include "render/bake/opaque_boxes.hpp"

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

constexpr model::EffectMask mask_bit = model::effect_alpha_mask, picture_bits = model::effect_texture | mask_bit;

/// A form of one square that shows texels 2 to 6 of a picture of 8 x 8, all opaque, with a second level.
struct PictureForm {
    model::Model model;
    PictureForm() {
        model.textures.push_back({8, 8, 2, 0, true});
        model.texels.assign(std::size_t{4} * (64 + 16), std::byte{200});
        model::Material material;
        material.texture = 0;
        material.alpha = model::AlphaMode::mask;
        material.effects = picture_bits;
        model.materials.push_back(material);
        for (const auto& [u, v] : {std::pair{2, 2}, {6, 2}, {6, 6}, {2, 6}}) {
            model::Vertex vertex{};
            vertex.uv[0] = static_cast<float>(u) / 8;
            vertex.uv[1] = static_cast<float>(v) / 8;
            model.vertices.push_back(vertex);
        }
        model.indices = {0, 1, 2, 0, 2, 3};
        model.parts.push_back({0, 0, 6, 0, 4});
        model::Representation rep;
        rep.kind = model::RepKind::textured_box;
        rep.part_count = 1;
        rep.triangles = 2;
        rep.effects = picture_bits;
        model.reps.push_back(rep);
    }
    void set_alpha(std::size_t texel, int alpha) { model.texels[4 * texel + 3] = static_cast<std::byte>(alpha); }
    bool loses_its_mask() {
        const std::size_t changed = drop_needless_masks(model);
        const bool masked = (model.materials[0].effects & mask_bit) != 0;
        EXPECT_EQ(changed, masked ? 0U : 1U);
        EXPECT_EQ(model.materials[0].alpha, masked ? model::AlphaMode::mask : model::AlphaMode::opaque);
        EXPECT_EQ(model.reps[0].effects, model.materials[0].effects);
        return !masked;
    }
};

TEST(OpaqueBoxes, LoseTheMaskWhereAllThatMayBeReadIsOpaque) {
    EXPECT_TRUE(PictureForm().loses_its_mask());
    PictureForm far_hole;
    far_hole.set_alpha(0, 0);  // no place between columns 2 and 6 reads column 0
    far_hole.set_alpha(8 * 4 + 0, 0);
    far_hole.set_alpha(8 * 7 + 7, 127);
    EXPECT_TRUE(far_hole.loses_its_mask());
}

TEST(OpaqueBoxes, KeepTheMaskForAnyTexelThatMayBeRead) {
    for (const std::size_t texel : {8 * 3 + 3, 8 * 2 + 2, 8 * 5 + 5, 8 * 4 + 1, 8 * 1 + 4, 8 * 6 + 4, 8 * 4 + 6}) {
        PictureForm form;
        form.set_alpha(texel, 0);
        EXPECT_FALSE(form.loses_its_mask()) << texel;
    }
    for (const std::size_t texel : {64 + 5, 64 + 0, 64 + 3 * 4 + 3}) {  // of the second level: columns 0 to 3 are read
        PictureForm form;
        form.set_alpha(texel, 0);
        EXPECT_FALSE(form.loses_its_mask()) << texel;
    }
}

TEST(OpaqueBoxes, KeepTheMaskWhereAlphasDifferOrFailTheTest) {
    PictureForm differs;
    differs.set_alpha(8 * 4 + 4, 201);
    EXPECT_FALSE(differs.loses_its_mask()) << "with several samples a pixel, a slope of alpha leaves some out";
    PictureForm fails;
    fails.model.materials[0].alpha_cutoff = 0.9F;
    EXPECT_FALSE(fails.loses_its_mask());
    PictureForm faint;
    faint.model.materials[0].colour[3] = 0.5F;
    EXPECT_FALSE(faint.loses_its_mask()) << "its own alpha counts too";
}

TEST(OpaqueBoxes, AreTheOnlyFormsThatChange) {
    PictureForm mesh;
    mesh.model.reps[0].kind = model::RepKind::mesh;
    EXPECT_FALSE(mesh.loses_its_mask());
    PictureForm shared;
    shared.model.reps.push_back(shared.model.reps[0]);
    shared.model.reps[1].kind = model::RepKind::mesh;
    EXPECT_FALSE(shared.loses_its_mask()) << "a mesh has the material too";
    PictureForm repeats;
    repeats.model.textures[0].clamp = false;
    EXPECT_FALSE(repeats.loses_its_mask());
}

/// A cube of 2 m with six colours, and a small thing with a picture, so that boxes have pictures. Its upper side may end
/// in the middle.
importer::Scene cube_scene(bool half_open) {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.emplace_back().image = 0;
    image::Image picture;
    picture.width = picture.height = 4;
    for (int i = 0; i < 16; ++i) picture.rgba.insert(picture.rgba.end(), {static_cast<std::uint8_t>(16 * i), 90, 60, 255});
    scene.images.push_back(picture);
    importer::Mesh cube{"cube", {}};
    for (int face = 0; face < 6; ++face) {
        const float end = half_open && face == 3 ? 0.5F : 1;
        const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        importer::Primitive side = grid_surface(10, 10, [=](float s, float t) {
            vec3 at(0);
            at[axis] = face % 2 == 1 ? 1.0F : -1.0F;
            at[u] = (face % 2 == 1 ? 1.0F : -1.0F) * (2 * end * s - 1);
            at[v] = 2 * t - 1;
            return at;
        });
        side.material = static_cast<importer::Index>(scene.materials.size());
        const auto part = static_cast<float>(face);
        scene.materials.emplace_back().colour = {face % 2 == 0 ? 1.0F : 0.0F, part / 5, 1 - part / 5, 1};
        cube.primitives.push_back(std::move(side));
    }
    for (importer::Material& material : scene.materials) material.unlit = material.two_sided = true;
    scene.meshes.push_back(std::move(cube));
    place(scene, 0, dvec3(0));
    place(scene, add_mesh(scene, grid_surface(4, 4, [](float s, float t) { return vec3(0.3F * s, 0.3F * t, 0); }), "inside"),
          dvec3(0));
    return scene;
}

/// The whole model's box with pictures; none: it has none.
std::optional<model::Index> box_of_all(const model::Model& m) {
    const model::Index rep = m.nodes[0].first_rep;
    return m.reps[rep].kind == model::RepKind::textured_box ? std::optional(rep) : std::nullopt;
}

TEST(OpaqueBoxes, OfABakeAreThoseWithoutHoles) {
    for (const bool half_open : {false, true}) {
        const auto m = bake(cube_scene(half_open), {}, {});
        ASSERT_TRUE(m.ok()) << m.error().text();
        const auto box = box_of_all(*m);
        ASSERT_TRUE(box) << "the cube has no box";
        EXPECT_EQ((m->reps[*box].effects & mask_bit) != 0, half_open) << "one sees into it";
        EXPECT_TRUE(model::validate(*m).ok());
        for (const model::EffectFinding& finding : m->effects) {
            if (finding.bit != mask_bit || half_open) continue;
            EXPECT_FALSE(finding.called_for) << "no form needs it";
        }
    }
}

/// Pictures of one form by a device. Skipped only where the library is missing, or a sanitizer allows no GL.
class OpaqueBoxPictures : public ::testing::TestWithParam<rt::TextureFilter> {
protected:
    static constexpr std::uint32_t side = 64;
    void SetUp() override {
        gl::DeviceOptions options;
        options.viewport = {side, side};
        options.filter = GetParam();
        options.sky = {0, 0, 1};
        auto opened = gl::open_device(options);
        if (!opened && opened.error().kind == ErrorKind::unsupported) GTEST_SKIP() << opened.error().text();
        ASSERT_TRUE(opened.ok()) << opened.error().text();
        device_ = std::move(*opened);
    }
    std::vector<gl::PixelImage> pictures(const model::Model& m, model::Index rep) {
        device_->draws.plays();
        const auto loaded = device_->load(m, effects::assemble_program);
        EXPECT_TRUE(loaded.ok());
        std::vector<gl::PixelImage> out;
        for (int i = 0; i < 20; ++i) {
            const double azimuth = 0.7 + 0.9 * i, elevation = 1.4 * std::sin(1.3 * i), away_m = 3.2 * std::pow(1.35, i);
            const dvec3 towards(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                                std::cos(elevation) * std::cos(azimuth));
            Pose pose;
            pose.position = away_m * towards;
            pose.orientation = glm::quatLookAt(-towards, dvec3(0, 1, 0));
            device_->begin_frame(pose);
            const gl::DrawItem item{0, rep};
            device_->draw({&item, 1});
            device_->end_slice();
            device_->finish_frame();
            auto image = device_->read_pixels();
            EXPECT_TRUE(image.ok());
            if (image) out.push_back(std::move(*image));
        }
        return out;
    }
    std::unique_ptr<gl::Device> device_;
};

TEST_P(OpaqueBoxPictures, AreTheSameWithTheMask) {
    const auto without = bake(cube_scene(false), {}, {});
    ASSERT_TRUE(without.ok());
    const auto box = box_of_all(*without);
    ASSERT_TRUE(box);
    model::Model with = *without;
    with.reps[*box].effects |= mask_bit;
    for (model::Index p = 0; p < with.reps[*box].part_count; ++p) {
        model::Material& material = with.materials[with.parts[with.reps[*box].first_part + p].material];
        EXPECT_EQ(material.effects & mask_bit, 0U);
        material.effects |= mask_bit;
        material.alpha = model::AlphaMode::mask;
    }
    const std::vector<gl::PixelImage> a = pictures(*without, *box), b = pictures(with, *box);
    ASSERT_EQ(a.size(), b.size());
    std::size_t shown = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_TRUE(a[i].rgba == b[i].rgba) << "pose " << i;
        for (std::size_t at = 0; at < a[i].rgba.size(); at += 4)
            shown += a[i].rgba[at + 2] == 255 && a[i].rgba[at + 1] == 0 ? 0 : 1;
    }
    EXPECT_GT(shown, 3000U) << "pixels that are not of the sky";
}

INSTANTIATE_TEST_SUITE_P(Filters, OpaqueBoxPictures, ::testing::Values(rt::TextureFilter::bilinear, rt::TextureFilter::trilinear),
                         [](const auto& filter) {
                             return filter.param == rt::TextureFilter::bilinear ? "bilinear" : "trilinear";
                         });

}  // namespace
}  // namespace surefoot::bake
