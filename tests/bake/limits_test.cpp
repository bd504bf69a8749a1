// What 32-bit numbers cannot name is refused by name before it is written: by counts, so that no test needs the memory.
#include "render/bake/limits.hpp"

#include <gtest/gtest.h>

#include <string>

#include "render/bake/bake.hpp"
#include "render/bake/materials.hpp"
#include "tests/bake/scenes.hpp"

namespace surefoot::bake {
namespace {

TEST(Limits, TheMostOfEachIsAllowedAndOneMoreIsRefusedByName) {
    struct Case {
        std::uint64_t Counts::*count;
        std::uint64_t most;
        const char* name;
    };
    constexpr std::uint64_t signed_max = 0x7fffffff, most = 0xffffffff;
    for (const Case& c : {Case{&Counts::vertices, signed_max, "vertices"}, Case{&Counts::indices, most, "indices"},
                          Case{&Counts::parts, most, "parts"}, Case{&Counts::placements, most, "placements"},
                          Case{&Counts::materials, most, "materials"}, Case{&Counts::representations, most, "forms"},
                          Case{&Counts::nodes, most, "nodes"}, Case{&Counts::name_bytes, most, "bytes of names"},
                          Case{&Counts::textures, most, "textures"}, Case{&Counts::drawn_parts, most, "parts of forms"}}) {
        Counts counts;
        counts.*c.count = c.most;
        EXPECT_TRUE(check_limits(counts, "town.glb").ok()) << c.name;
        for (const std::uint64_t more : {c.most + 1, c.most + 1 + (std::uint64_t{1} << 32U), ~std::uint64_t{0}}) {
            counts.*c.count = more;
            const auto refused = check_limits(counts, "town.glb");
            ASSERT_FALSE(refused.ok()) << c.name;
            EXPECT_EQ(refused.error().place, "town.glb");
            EXPECT_NE(refused.error().what.find("out of limits"), std::string::npos);
            EXPECT_NE(refused.error().what.find(std::to_string(more) + " " + c.name), std::string::npos) << refused.error().what;
            EXPECT_FALSE(refused.error().remedy.empty());
        }
    }
}

TEST(Limits, ABakeThatWouldHoldMoreIsRefused) {
    importer::Scene scene;
    scene.materials.emplace_back();
    scene.sources = {"ball.glb"};
    const importer::Index mesh = add_mesh(scene, ball(16, 1), "ball");
    place(scene, mesh, dvec3(0));
    BakeOptions options;
    const auto whole = bake(scene, options, {});
    ASSERT_TRUE(whole.ok()) << whole.error().text();
    options.max_counts.vertices = whole->vertices.size() - 1;
    const auto refused = bake(scene, options, {});
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().place, "ball.glb");
    EXPECT_NE(refused.error().what.find("out of limits"), std::string::npos) << refused.error().text();
}

TEST(Limits, CountsAddUp) {
    Counts sum{1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    sum += {10, 20, 30, 40, 50, 60, 70, 80, 90, 100};
    EXPECT_EQ(sum.vertices, 11U);
    EXPECT_EQ(sum.indices, 22U);
    EXPECT_EQ(sum.parts, 33U);
    EXPECT_EQ(sum.placements, 44U);
    EXPECT_EQ(sum.materials, 55U);
    EXPECT_EQ(sum.representations, 66U);
    EXPECT_EQ(sum.nodes, 77U);
    EXPECT_EQ(sum.name_bytes, 88U);
    EXPECT_EQ(sum.textures, 99U);
    EXPECT_EQ(sum.drawn_parts, 110U);
}

TEST(Limits, WhatIsCountedBeforehandIsWhatEmittingAdds) {
    importer::Scene scene;
    scene.materials.emplace_back();
    const importer::Index mesh = add_mesh(scene, ball(16, 1), "ball");
    model::Model model;
    add_materials(scene, model);
    const std::vector<MeshForm> forms = make_forms(mesh_geometry(scene.meshes[mesh], model), {}, {});
    ASSERT_EQ(forms.size(), 1U);
    std::vector<PlacedObject> objects(3);
    for (PlacedObject& object : objects) object.name = "ball";
    ProxyInput input;
    input.model = &model;
    input.objects = objects;
    input.forms = forms;
    const Counts counts = counts_of(input, 0), with_a_box = counts_of(input, 1);

    const EmittedChain chain = emit_chain(forms[0].chain, model);
    for (const PlacedObject& object : objects) emit_representations(chain, object.world, model);
    EXPECT_EQ(counts.vertices, model.vertices.size());
    EXPECT_EQ(counts.indices, model.indices.size());
    EXPECT_EQ(counts.parts, model.parts.size());
    EXPECT_EQ(counts.placements, model.placements.size());
    EXPECT_EQ(counts.materials, model.materials.size());
    EXPECT_EQ(counts.representations, model.reps.size());
    EXPECT_EQ(counts.nodes, 3U);
    EXPECT_EQ(counts.name_bytes, 1U + 3 * 5);
    EXPECT_EQ(counts.textures, model.textures.size());
    EXPECT_EQ(counts.drawn_parts, model::counts_of(model).drawn_parts);

    BoxForm box;
    box.box.grow(dvec3(0));
    box.box.grow(dvec3(1));
    box.textured = true, box.pixels = face_pixels(8);
    for (FaceCapture& face : box.faces) face.covered = 1, face.rgba.assign(std::size_t{4} * box.pixels * box.pixels, 255);
    emit_box(box, 0, model);
    EXPECT_EQ(with_a_box.vertices, model.vertices.size());
    EXPECT_EQ(with_a_box.indices, model.indices.size());
    EXPECT_EQ(with_a_box.parts, model.parts.size());
    EXPECT_EQ(with_a_box.placements, model.placements.size());
    EXPECT_EQ(with_a_box.materials, model.materials.size());
    EXPECT_EQ(with_a_box.representations, model.reps.size());
    EXPECT_EQ(with_a_box.textures, model.textures.size());
    EXPECT_EQ(with_a_box.drawn_parts, model::counts_of(model).drawn_parts);
}

}  // namespace
}  // namespace surefoot::bake
