// What vertices see of sky and room: in the open, in a closed room, in a room with a hole, before and behind a sheet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/bake/openness.hpp"
#include "render/bake/ray_tree.hpp"
#include "render/effects/effects.hpp"
#include "render/model/ground/near.hpp"
#include "rt/base/random.hpp"
#include "tests/bake/scenes.hpp"

namespace surefoot {
namespace {

/// Four corners, counter-clockwise as seen from where the normal points.
importer::Primitive square(const vec3& middle, const vec3& u, const vec3& v, importer::Index material, std::uint32_t n = 4) {
    importer::Primitive p =
        bake::grid_surface(n, n, [&](float s, float t) { return middle + (2 * s - 1) * u + (2 * t - 1) * v; });
    const vec3 normal = glm::normalize(glm::cross(u, v));
    for (auto& of : p.normals) of = normal;
    p.material = material;
    return p;
}

/// A room of 6 x 3 x 6 m of six squares that look inwards, each an object, and a floor of 60 m around it. `without`: a wall that
/// is missing.
importer::Scene room(int without = -1) {
    importer::Scene scene;
    scene.materials.resize(3);
    scene.materials[2].two_sided = true;
    const vec3 x(3, 0, 0), y(0, 1.5F, 0), z(0, 0, 3), up(0, 1.5F, 0);
    const std::vector<importer::Primitive> walls = {square(vec3(0, 0, 0), z, x, 0),        // floor, looks up
                                                    square(vec3(0, 3, 0), x, z, 0),        // ceiling, looks down
                                                    square(up + vec3(-3, 0, 0), y, z, 0),  // west, looks east
                                                    square(up + vec3(3, 0, 0), z, y, 0),   // east
                                                    square(up + vec3(0, 0, -3), x, y, 0),  // north
                                                    square(up + vec3(0, 0, 3), y, x, 0)};  // south
    for (std::size_t w = 0; w < walls.size(); ++w)
        if (static_cast<int>(w) != without)
            bake::place(scene, bake::add_mesh(scene, walls[w], "wall " + std::to_string(w)), dvec3(0));
    bake::place(scene, bake::add_mesh(scene, square(vec3(0, -0.5F, 0), vec3(0, 0, 30), vec3(30, 0, 0), 1, 30), "ground"),
                dvec3(0));
    return scene;
}

model::Model baked(const importer::Scene& scene, bake::Quality quality = bake::Quality::full) {
    bake::BakeOptions options;
    options.quality = quality;
    auto model = bake::bake(scene, options, {});
    EXPECT_TRUE(model.ok()) << (model.ok() ? "" : model.error().text());
    return std::move(*model);
}

/// use(vertex, material) of an object's full detail.
template <class Use>
void for_vertices(const model::Model& m, const std::string& name, const Use& use) {
    std::size_t found = 0;
    for (const model::Node& node : m.nodes) {
        if (node.child_count > 0 || name != m.name_of(node)) continue;
        const model::Representation& full = m.reps[node.first_rep + node.rep_count - 1];
        for (model::Index p = full.first_part; p < full.first_part + full.part_count; ++p)
            for (std::uint32_t i = 0; i < m.parts[p].index_count; ++i, ++found)
                use(m.vertices[m.parts[p].first_vertex + m.indices[m.parts[p].first_index + i]],
                    m.materials[m.parts[p].material]);
    }
    EXPECT_GT(found, 0U) << name;
}

TEST(Openness, IsNoneInAClosedRoomWhichIsDrawnWithoutTheSun) {
    const model::Model m = baked(room());
    for (const char* wall : {"wall 0", "wall 1", "wall 2", "wall 3", "wall 4", "wall 5"})
        for_vertices(m, wall, [&](const model::Vertex& v, const model::Material& material) {
            EXPECT_EQ(v.hidden[0], 255) << wall;
            EXPECT_EQ(material.effects & model::effect_sun, 0U) << wall;
            EXPECT_NE(material.effects & model::effect_openness, 0U) << wall;
        });
    bool sees_all = false;
    for_vertices(m, "ground", [&](const model::Vertex& v, const model::Material& material) {
        EXPECT_NE(material.effects & model::effect_sun, 0U);
        const bool below = std::abs(v.position[0]) < 2.9F && std::abs(v.position[2]) < 2.9F;
        if (below) {
            EXPECT_GT(v.hidden[0], 128) << "a floor is half a metre above it";
        }
        sees_all = sees_all || v.hidden[0] == 0;
    });
    EXPECT_TRUE(sees_all);
    EXPECT_NE(m.effects[2].reason.find("see no sky"), std::string::npos) << m.effects[2].reason;
    EXPECT_TRUE(m.effects[5].called_for);
}

TEST(Openness, ComesThroughAHoleToWhatFacesIt) {
    const model::Model m = baked(room(3));  // the east is missing
    double west = 0, floor_near = 0, floor_far = 0;
    std::size_t near = 0, far = 0, count = 0;
    for_vertices(m, "wall 2", [&](const model::Vertex& v, const model::Material&) { west += 255 - v.hidden[0], ++count; });
    for_vertices(m, "wall 0", [&](const model::Vertex& v, const model::Material&) {
        (v.position[0] > 1 ? floor_near : floor_far) += 255 - v.hidden[0];
        ++(v.position[0] > 1 ? near : far);
    });
    ASSERT_GT(near, 0U);
    ASSERT_GT(far, 0U);
    EXPECT_GT(west / static_cast<double>(count), 5);
    EXPECT_GT(floor_near / static_cast<double>(near), 1.5 * floor_far / static_cast<double>(far));
}

TEST(Openness, OfAClosedRoomAloneCallsForNoSunAndKeepsItsOtherEffects) {
    importer::Scene scene = room();
    scene.meshes.pop_back();  // no ground outside
    scene.nodes.pop_back();
    image::Image image;
    image.width = image.height = 2;
    image.rgba.assign(16, 200);
    scene.images.push_back(image);
    scene.materials[0].image = 0;
    const model::Model m = baked(scene);
    EXPECT_TRUE(m.effects[0].called_for);
    EXPECT_EQ(m.effects[0].triangles, m.triangles()) << m.effects[0].reason;
    EXPECT_EQ(m.effects[2].triangles, 0U);
    EXPECT_NE(m.effects[2].reason.find("none of"), std::string::npos) << m.effects[2].reason;
    for (const model::Node& node : m.nodes)
        if (node.child_count == 0) {
            EXPECT_EQ(m.reps[node.first_rep + node.rep_count - 1].effects & model::effect_sun, 0U);
        }
}

TEST(Openness, IsTheSameAtAnyScaleAndMirrored) {
    const model::Model plain = baked(room(3));
    for (const double scale : {0.001, 100.0, -0.001}) {
        importer::Scene scene = room(3);
        for (importer::Mesh& mesh : scene.meshes)
            for (importer::Primitive& p : mesh.primitives) {
                for (vec3& at : p.positions) at = vec3(dvec3(at) / dvec3(std::abs(scale), std::abs(scale), scale));
                for (vec3& n : p.normals) n.z *= scale < 0 ? -1.0F : 1.0F;
                for (std::size_t i = 0; scale < 0 && i + 2 < p.indices.size(); i += 3)
                    std::swap(p.indices[i + 1], p.indices[i + 2]);
            }
        for (importer::Node& node : scene.nodes) {
            node.world[0][0] = node.world[1][1] = std::abs(scale);
            node.world[2][2] = scale;
        }
        const model::Model scaled = baked(scene);
        for (const char* wall : {"wall 0", "wall 2", "wall 4"}) {
            double here = 0, there = 0, count = 0;
            for_vertices(plain, wall, [&](const model::Vertex& v, const model::Material&) { here += v.hidden[0], ++count; });
            for_vertices(scaled, wall, [&](const model::Vertex& v, const model::Material&) { there += v.hidden[0]; });
            EXPECT_NEAR(here / count, there / count, 4) << wall << " at " << scale;
        }
    }
}

TEST(Openness, ComesThroughGlass) {
    importer::Scene scene = room(3);
    importer::Primitive pane = square(vec3(3, 1.5F, 0), vec3(0, 0, 3), vec3(0, 1.5F, 0), 1);
    scene.materials[1].alpha = model::AlphaMode::blend;
    scene.materials[1].colour[3] = 0.3F;
    bake::place(scene, bake::add_mesh(scene, std::move(pane), "pane"), dvec3(0));
    const model::Model m = baked(scene);
    std::size_t lit = 0;
    for_vertices(m, "wall 2", [&](const model::Vertex& v, const model::Material&) { lit += v.hidden[0] < 255 ? 1 : 0; });
    EXPECT_GT(lit, 0U);
}

TEST(Openness, OfWhatStandsInManyPlacesIsKnownInEachOfThem) {
    importer::Scene scene = room();
    const importer::Index ball = bake::add_mesh(scene, bake::ball(6, 0.2F), "ball");
    for (int i = 0; i < 6; ++i) bake::place(scene, ball, dvec3(-2 + 0.7 * i, 1, 0));
    const model::Model m = baked(scene);
    for_vertices(m, "ball", [&](const model::Vertex& v, const model::Material& material) {
        EXPECT_EQ(v.hidden[0], 255) << "all are in the room";
        EXPECT_EQ(material.effects & model::effect_sun, 0U) << "also of the two whose room was not measured";
    });
}

TEST(Openness, OfASheetDiffersBeforeAndBehindIt) {
    importer::Scene scene = room(1);  // a ceiling of its own: a sheet that both sides show
    bake::place(scene, bake::add_mesh(scene, square(vec3(0, 3, 0), vec3(0, 0, 3), vec3(3, 0, 0), 2), "roof"), dvec3(0));
    const model::Model m = baked(scene);
    for_vertices(m, "roof", [&](const model::Vertex& v, const model::Material& material) {
        EXPECT_LT(v.hidden[0], 30) << "above it is the sky";
        EXPECT_EQ(v.hidden[1], 255) << "below it is the room";
        EXPECT_NE(material.effects & model::effect_sun, 0U);
    });
}

TEST(Openness, IsLeftOutOfDraftsAndWhereNothingIsHidden) {
    const model::Model draft = baked(room(), bake::Quality::draft);
    EXPECT_FALSE(draft.effects[5].called_for);
    EXPECT_NE(draft.effects[5].reason.find("draft"), std::string::npos);
    for (const model::Vertex& v : draft.vertices) ASSERT_EQ(v.hidden[0] + v.hidden[1] + v.hidden[2] + v.hidden[3], 0);
    importer::Scene plain;
    plain.materials.emplace_back();
    bake::place(plain, bake::add_mesh(plain, square(vec3(0), vec3(0, 0, 3), vec3(3, 0, 0), 0), "plain"), dvec3(0));
    EXPECT_FALSE(baked(plain).effects[5].called_for);
}

TEST(Openness, IsOfTheSunThatTheSceneNames) {
    importer::Scene scene = room();
    scene.sun = importer::Sun{"noon", glm::normalize(dvec3(1, 2, 0)), 3};
    const model::Model m = baked(scene, bake::Quality::draft);
    EXPECT_EQ(m.sun_direction, scene.sun->towards);
    EXPECT_NE(m.effects[2].reason.find("the scene's light 'noon'"), std::string::npos) << m.effects[2].reason;
}

TEST(Openness, IsTheSameForAnyNumberOfThreads) {
    bake::BakeOptions options;
    options.quality = bake::Quality::full;
    const importer::Scene scene = room(3);
    std::vector<std::vector<std::array<std::uint8_t, 4>>> all;
    for (const int workers : {1, 3}) {
        options.workers = workers;
        const auto m = bake::bake(scene, options, {});
        ASSERT_TRUE(m.ok());
        all.emplace_back();
        for (const model::Vertex& v : m->vertices) all.back().push_back({v.hidden[0], v.hidden[1], v.hidden[2], v.hidden[3]});
    }
    EXPECT_EQ(all[0], all[1]);
}

TEST(RayTree, MeetsWhatPlainTrialMeets) {
    importer::Scene scene;
    scene.materials.emplace_back();
    const importer::Index ball = bake::add_mesh(scene, bake::ball(10, 1), "ball");
    Random random(7);
    for (int i = 0; i < 40; ++i)
        bake::place(scene, ball, dvec3(random.range(-20, 20), random.range(-3, 3), random.range(-20, 20)),
                    dvec3(random.range(0.5, 3), random.range(0.5, 3), i % 3 == 0 ? -1.0 : 1.0));
    bake::place(scene, bake::add_mesh(scene, bake::hills(20, 30), "hills"), dvec3(-15, -4, -15));
    const model::Model m = baked(scene, bake::Quality::draft);
    std::vector<model::GroundTriangle> triangles;
    model::for_triangles_near(m.ground, {dvec3(-1e3), dvec3(1e3)},
                              [&](const model::GroundTriangle& t) { triangles.push_back(t); });
    ASSERT_GT(triangles.size(), 5000U);
    const bake::RayTree tree(m.ground);
    int hits = 0, grazing = 0;
    for (int i = 0; i < 4000; ++i) {
        bake::Ray ray;
        ray.from = {random.range(-25, 25), random.range(-5, 5), random.range(-25, 25)};
        const dvec3 way(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1));
        ray.direction = i % 10 == 0 ? dvec3(0, i % 20 == 0 ? 1 : -1, 0) : glm::normalize(way);
        ray.max_m = random.range(1, 40);
        double nearest = INFINITY;
        for (const model::GroundTriangle& t : triangles) {
            const double share = model::crossing_of(ray.from, ray.max_m * ray.direction, t).share;
            if (share <= 1) nearest = std::min(nearest, share * ray.max_m);
        }
        const double found = tree.nearest_hit_m(ray);
        EXPECT_EQ(tree.is_blocked(ray), std::isfinite(found)) << i;
        const bool same = std::isinf(nearest) ? std::isinf(found) : std::abs(found - nearest) < 1e-3;
        grazing += same ? 0 : 1;  // within rounding of an edge, one of both may miss
        hits += std::isfinite(nearest) ? 1 : 0;
    }
    EXPECT_GT(hits, 600);
    EXPECT_LE(grazing, 2);
}

TEST(RayTree, OfNothingOfOneTriangleAndOfManyInOnePlaceIsNoTrouble) {
    EXPECT_FALSE(bake::RayTree(model::Ground{}).is_blocked({dvec3(0), dvec3(0, 1, 0), 10}));
    importer::Scene scene;
    scene.materials.emplace_back();
    const importer::Index sheet = bake::add_mesh(scene, square(vec3(0), vec3(0, 0, 3), vec3(3, 0, 0), 0, 1), "sheet");
    for (int i = 0; i < 200; ++i) bake::place(scene, sheet, dvec3(0));
    const model::Model m = baked(scene, bake::Quality::draft);
    const bake::RayTree tree(m.ground);
    EXPECT_NEAR(tree.nearest_hit_m({dvec3(1, 5, 1), dvec3(0, -1, 0), 10}), 5, 1e-4);
    EXPECT_FALSE(tree.is_blocked({dvec3(1, 5, 1), dvec3(0, -1, 0), 4.9}));
    EXPECT_FALSE(tree.is_blocked({dvec3(1, 5, 1), dvec3(0, 1, 0), 1e6}));
}

}  // namespace
}  // namespace surefoot
