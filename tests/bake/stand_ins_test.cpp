// Stand-ins of artists in a baked model: bounded like any other form, chosen where they belong, and refused by name.
#include "render/bake/stand_ins.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "render/bake/bake.hpp"
#include "tests/bake/scenes.hpp"
#include "tests/bake/surface.hpp"

namespace surefoot::bake {
namespace {

constexpr std::uint32_t ball_rings = 24;  // 2304 triangles

/// A ball of 2 m, and far away another one; and a stand-in of the first.
importer::Scene scene_with(importer::Primitive stand_in) {
    importer::Scene scene;
    scene.materials.push_back({.name = "white"});
    const importer::Index mesh = add_mesh(scene, ball(ball_rings, 2), "ball");
    place(scene, mesh, {0, 0, 0});
    place(scene, mesh, {40, 0, 0}, {2, 2, 2});
    scene.stand_ins.push_back({"far ball", mesh, {"far ball", {std::move(stand_in)}}});
    return scene;
}

model::Model with_stand_ins(const importer::Scene& scene) {
    auto model = bake(scene, {}, {});
    EXPECT_TRUE(model.ok()) << (model.ok() ? "" : model.error().text());
    return model.ok() ? std::move(*model) : model::Model{};
}

std::vector<std::uint32_t> triangles_of_forms(const model::Model& m, const std::string& kind) {
    std::vector<std::uint32_t> out;
    for (const model::Node& node : m.nodes) {
        if ((node.child_count > 0) != (kind == "cluster")) continue;
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) out.push_back(m.reps[r].triangles);
    }
    return out;
}

std::size_t placements_with(const model::Model& m, std::uint32_t triangles) {
    const auto all = triangles_of_forms(m, "object");
    return static_cast<std::size_t>(std::count(all.begin(), all.end(), triangles));
}

TEST(ArtistStandIns, AreFormsOfEveryPlacement) {
    const importer::Primitive stand_in = ball(5, 2);
    const auto triangles = static_cast<std::uint32_t>(stand_in.indices.size() / 3);
    const model::Model m = with_stand_ins(scene_with(stand_in));
    EXPECT_EQ(placements_with(m, triangles), 2U);
    EXPECT_TRUE(m.provenance.warnings.empty());
    EXPECT_TRUE(model::validate(m).ok());
}

TEST(ArtistStandIns, AreBoundedByTheirDistanceToFullDetail) {
    importer::Primitive crate = ball(3, 1.5F);  // half a metre inside the ball
    const auto triangles = static_cast<std::uint32_t>(crate.indices.size() / 3);
    const model::Model m = with_stand_ins(scene_with(std::move(crate)));
    std::size_t seen = 0;
    for (const Judged& j : judge(m, 20000)) {
        EXPECT_LE(j.sampled, j.bound + j.rounding);
        if (m.nodes[j.node].child_count > 0 || m.reps[j.rep].triangles != triangles) continue;
        ++seen;
        EXPECT_LE(j.bound, 2 * j.sampled);
        EXPECT_GE(j.bound, 0.5F);
    }
    EXPECT_EQ(seen, 2U);
}

// The surface of an exact one is right, and its picture is unknown.
TEST(ArtistStandIns, CountAsOffByASixtyFourthOfTheirSizeAtLeast) {
    importer::Scene scene = scene_with(ball(ball_rings / 2, 2));
    const std::uint32_t triangles = ball_rings * ball_rings;
    const model::Model m = with_stand_ins(scene);
    ASSERT_EQ(placements_with(m, triangles), 2U);
    for (const model::Node& node : m.nodes) {
        if (node.child_count > 0) continue;
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r)
            if (m.reps[r].triangles == triangles) {
                EXPECT_GE(m.reps[r].error_m, 0.99 * min_proxy_error * node.box.diagonal());
            }
    }
}

TEST(ArtistStandIns, ThatCannotBeUsedAreNamedAndTheObjectIsDrawn) {
    struct Case {
        importer::Primitive mesh;
        std::string why;
    };
    importer::Primitive nothing = ball(3, 2);
    nothing.indices.clear();
    const std::vector<Case> cases = {{ball(ball_rings, 2), "it has 2304 triangles, and the object 2304"},
                                     {ball(5, 6), "beyond the object"},
                                     {ball(5, 0.2F), "m off its object"},
                                     {nothing, "it has no triangles"}};
    for (const Case& one : cases) {
        const model::Model m = with_stand_ins(scene_with(one.mesh));
        ASSERT_EQ(m.provenance.warnings.size(), 1U) << one.why;
        EXPECT_NE(m.provenance.warnings[0].find("Stand-in 'far ball' is left out"), std::string::npos);
        EXPECT_NE(m.provenance.warnings[0].find(one.why), std::string::npos) << m.provenance.warnings[0];
        EXPECT_EQ(m.triangles(), 2U * 2304) << "whole, or in pieces as without a stand-in";
    }
}

TEST(ArtistStandIns, OfOneObjectStandSideBySideInAnyOrder) {
    for (const bool fine_first : {true, false}) {
        importer::Scene scene = scene_with(ball(fine_first ? 10 : 5, 2));
        scene.stand_ins.push_back({"other", 0, {"other", {ball(fine_first ? 5 : 10, 2)}}});
        const model::Model m = with_stand_ins(scene);
        EXPECT_EQ(placements_with(m, 100), 2U) << fine_first;
        EXPECT_EQ(placements_with(m, 400), 2U) << fine_first;
        EXPECT_TRUE(m.provenance.warnings.empty());
    }
    importer::Scene twice = scene_with(ball(5, 2));
    twice.stand_ins.push_back({"again", 0, {"again", {ball(5, 2)}}});
    const model::Model m = with_stand_ins(twice);
    ASSERT_EQ(m.provenance.warnings.size(), 1U);
    EXPECT_NE(m.provenance.warnings[0].find("'again' is left out: another one"), std::string::npos);
}

TEST(ArtistStandIns, KeepVertexColoursOfTheirOwn) {
    importer::Scene scene = scene_with(ball(5, 2));
    scene.materials.push_back({.name = "painted"});
    importer::Primitive& p = scene.stand_ins[0].mesh.primitives[0];
    p.material = 1;
    p.colours.assign(p.positions.size(), {255, 0, 0, 255});
    const model::Model m = with_stand_ins(scene);
    std::size_t painted = 0;
    for (const model::Representation& rep : m.reps)
        if (rep.triangles == 100 && (m.materials[m.parts[rep.first_part].material].effects & model::effect_vertex_colour) != 0)
            ++painted;
    EXPECT_GE(painted, 2U);
}

TEST(ArtistStandIns, OfAnObjectThatIsTooLargeToDrawWholeAreNamed) {
    importer::Scene scene = scene_with(ball(5, 2));
    BakeOptions options;
    options.frame_us = 300;  // a sixteenth of it draws few triangles
    const auto m = bake(scene, options, {});
    ASSERT_TRUE(m.ok());
    ASSERT_EQ(m->provenance.warnings.size(), 1U);
    EXPECT_NE(m->provenance.warnings[0].find("its object of 2304 triangles is cut into"), std::string::npos)
        << m->provenance.warnings[0];
}

TEST(ArtistStandIns, KeepTheirMaterial) {
    importer::Scene scene = scene_with(ball(5, 2));
    scene.materials.push_back({.name = "red", .colour = {1, 0, 0, 1}});
    scene.stand_ins[0].mesh.primitives[0].material = 1;
    const model::Model m = with_stand_ins(scene);
    std::size_t red = 0;
    for (const model::Representation& rep : m.reps)
        if (rep.triangles == 100 && m.materials[m.parts[rep.first_part].material].colour[1] == 0) ++red;
    EXPECT_EQ(red, 2U);
}

}  // namespace
}  // namespace surefoot::bake
