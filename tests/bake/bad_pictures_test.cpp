// Pictures and sheets that give a coarse form nothing to go by: the object is still drawn, and no bound is broken.
#include <gtest/gtest.h>

#include "render/bake/bake.hpp"
#include "tests/bake/scenes.hpp"
#include "tests/bake/surface.hpp"

namespace surefoot::bake {
namespace {

using Texel = std::array<std::uint8_t, 4>;

importer::Index add_picture(importer::Scene& scene, std::uint32_t size, const Texel& even, const Texel& odd) {
    image::Image image;
    image.width = image.height = size;
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            const Texel& texel = (x + y) % 2 == 0 ? even : odd;
            image.rgba.insert(image.rgba.end(), texel.begin(), texel.end());
        }
    scene.images.push_back(std::move(image));
    return static_cast<importer::Index>(scene.images.size() - 1);
}

importer::Index add_material(importer::Scene& scene, importer::Index image, bool masked) {
    importer::Material material;
    material.image = image;
    material.alpha = masked ? model::AlphaMode::mask : model::AlphaMode::opaque;
    material.two_sided = true;
    scene.materials.push_back(material);
    return static_cast<importer::Index>(scene.materials.size() - 1);
}

/// A scene with a white ball in it, at x = 6.
importer::Scene with_a_ball() {
    importer::Scene scene;
    scene.materials.emplace_back();
    place(scene, add_mesh(scene, ball(12, 1), "ball"), dvec3(6, 1, 0));
    return scene;
}

importer::Primitive sheet(importer::Index material) {
    importer::Primitive p = grid_surface(8, 8, [](float u, float v) { return vec3(3 * u, 3 * v, 0); });
    p.material = material;
    return p;
}

/// Bakes it: all of the scene is there, no sample lies beyond its bound, and every node has a form from everywhere.
void expect_sound(const importer::Scene& scene, const char* name) {
    const auto m = bake(scene, {}, {});
    ASSERT_TRUE(m.ok()) << name << ": " << m.error().text();
    EXPECT_TRUE(model::validate(*m).ok()) << name;
    EXPECT_EQ(m->triangles(), scene.triangles()) << name;
    EXPECT_EQ(m->object_count, scene.nodes.size()) << name;
    for (const Judged& j : judge(*m, 500, 1))
        EXPECT_LE(j.sampled, j.bound + j.rounding) << name << ", node " << j.node << " representation " << j.rep;
    for (const model::Node& node : m->nodes) {
        bool drawable = false;
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) drawable |= m->reps[r].everywhere;
        EXPECT_TRUE(drawable) << name;
    }
}

TEST(BadPictures, OfOneTexelAreColours) {
    importer::Scene scene = with_a_ball();
    const auto red = add_picture(scene, 1, {200, 30, 30, 255}, {200, 30, 30, 255});
    place(scene, add_mesh(scene, sheet(add_material(scene, red, false)), "opaque"), dvec3(0));
    place(scene, add_mesh(scene, sheet(add_material(scene, red, true)), "masked"), dvec3(0, 0, 3));
    expect_sound(scene, "one texel");
}

TEST(BadPictures, MaskThatHidesAllLeavesTheRest) {
    importer::Scene scene = with_a_ball();
    const auto hidden = add_picture(scene, 32, {200, 30, 30, 0}, {30, 200, 30, 0});
    place(scene, add_mesh(scene, sheet(add_material(scene, hidden, true)), "hidden"), dvec3(0));
    expect_sound(scene, "hides all");
}

TEST(BadPictures, CardsWithoutACommonTextureKeepTheirs) {
    importer::Scene scene = with_a_ball();
    importer::Mesh mesh;
    mesh.name = "cards";
    Random random(7);
    for (std::uint8_t k = 0; k < 8; ++k) {
        const auto checkered = add_picture(scene, 16, {static_cast<std::uint8_t>(30 * k), 120, 60, 255}, {0, 0, 0, 0});
        importer::Primitive p;
        p.material = add_material(scene, checkered, true);
        for (std::uint32_t card = 0; card < 12; ++card) {
            const vec3 at(random.range(-2, 2), random.range(0, 3), random.range(-2, 2));
            for (const vec2 uv : {vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 1)}) {
                p.positions.push_back(at + vec3(0.4F * uv.x, 0.4F * uv.y, 0));
                p.uvs.push_back(uv);
            }
            for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) p.indices.push_back(4 * card + i);
        }
        mesh.primitives.push_back(std::move(p));
    }
    scene.meshes.push_back(std::move(mesh));
    place(scene, static_cast<importer::Index>(scene.meshes.size() - 1), dvec3(0));
    expect_sound(scene, "cards");
}

// A sheet that is folded back upon itself forty times, and a doubled one that faces both ways.
TEST(BadPictures, FoldsStayWhereTheyAre) {
    importer::Scene scene = with_a_ball();
    const importer::Primitive folded =
        grid_surface(40, 4, [](float u, float v) { return vec3(2 * static_cast<float>(std::lround(40 * u) % 2), 2 * v, 0); });
    place(scene, add_mesh(scene, folded, "folded"), dvec3(0));
    importer::Primitive doubled = sheet(0);
    const std::size_t count = doubled.indices.size();
    for (std::size_t i = 0; i < count; i += 3)
        for (const std::size_t k : {0U, 2U, 1U}) doubled.indices.push_back(doubled.indices[i + k]);
    place(scene, add_mesh(scene, doubled, "doubled"), dvec3(0, 0, 3));
    expect_sound(scene, "folds");
}

}  // namespace
}  // namespace surefoot::bake
