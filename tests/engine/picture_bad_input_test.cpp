// The image cache with hard scenes and eyes: flat things, one triangle, one box; eyes on a picture's plane, in its box and behind
// it. Nothing is ever missing.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "render/bake/bake.hpp"
#include "tests/bake/scenes.hpp"
#include "tests/engine/picture_walk.hpp"

namespace surefoot {
namespace {

using test::holes;
using test::PictureWalk;

model::Model baked(const importer::Scene& scene) {
    auto model = bake::bake(scene, {}, {});
    EXPECT_TRUE(model.ok());
    return model.ok() ? std::move(*model) : model::Model{};
}

importer::Scene empty_scene() {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(1);
    return scene;
}

importer::Primitive flat_wall(std::uint32_t n, float size_m) {
    return bake::grid_surface(n, n, [=](float u, float v) { return size_m * vec3(u, v, 0); });
}

/// Flat walls and round things side by side, across the view direction; `flat`: walls alone, all in one plane.
importer::Scene walls_and_balls(bool flat = false) {
    importer::Scene scene = empty_scene();
    const auto wall = bake::add_mesh(scene, flat_wall(24, flat ? 0.8F : 4.0F), "wall"),
               ball = bake::add_mesh(scene, bake::ball(24, 2), "ball");
    for (int i = 0; i < 24; ++i)
        bake::place(scene, flat || i % 2 == 0 ? wall : ball, dvec3(5 * (i % 6), 5 * (i / 6), flat ? 0 : -3 * (i % 3)));
    return scene;
}

importer::Scene one_triangle() {
    importer::Scene scene = empty_scene();
    importer::Primitive primitive;
    primitive.positions = {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)};
    primitive.normals = {vec3(0, 0, 1), vec3(0, 0, 1), vec3(0, 0, 1)};
    primitive.indices = {0, 1, 2};
    bake::place(scene, bake::add_mesh(scene, primitive, "triangle"), dvec3(0));
    return scene;
}

importer::Scene one_thing(const importer::Primitive& primitive) {
    importer::Scene scene = empty_scene();
    bake::place(scene, bake::add_mesh(scene, primitive, "thing"), dvec3(0));
    return scene;
}

/// Before the middle of the scene, looking at it.
Pose before(const Engine& engine, double distance_m) {
    const Box& box = engine.model().nodes[0].box;
    Pose pose;
    pose.position = box.centre() + dvec3(0, 0, box.half().z + distance_m);
    return pose;
}

/// Walks past, and has pictures. Returns how many the last frame shows.
std::size_t walk_past(PictureWalk& walk, Pose& pose) {
    for (int i = 0; i < 20; ++i) {
        pose.position.x += 0.01;
        walk.frame(pose);
        EXPECT_TRUE(holes(walk.engine(), pose).empty()) << i;
    }
    return walk.engine().pictures().size();
}

/// On the picture's plane, on its box, in it, and behind it.
std::vector<dvec3> hard_eyes(const gl::CachePicture& picture) {
    const Box& box = picture.box;
    return {picture.eye + picture.plane_m * picture.forward, box.centre(), dvec3(box.centre().x, box.centre().y, box.max.z),
            box.min, dvec3(box.centre().x, box.centre().y, box.min.z - 1)};
}

/// The set of the frame before relies on the pictures: what they show no more is drawn in their place. Then frames go on there.
TEST(PictureBadInput, EyesOnThePlaneInTheBoxAndBehindItLeaveNoHole) {
    const model::Model model = baked(walls_and_balls());
    for (const bool all_round : {false, true}) {
        PictureWalk walk(model, {.all_round = all_round});
        Pose pose = before(walk.engine(), 30);
        ASSERT_GT(walk_past(walk, pose), 0U);
        std::vector<gl::CachePicture> pictures(walk.engine().pictures().begin(), walk.engine().pictures().end());
        if (pictures.size() > 3) pictures.resize(3);
        for (const gl::CachePicture& picture : pictures) {
            for (const dvec3& eye : hard_eyes(picture)) {
                for (int i = 0; i < 3; ++i) walk.frame(pose);
                EXPECT_FALSE(walk.engine().pictures().empty());
                Pose there = pose;
                there.position = eye;
                walk.engine().device().draws.plays();
                walk.engine().select(walk.set(), test::ample_us, {}, 0);
                walk.engine().submit(there, {.elapsed_us = 0, .limit_us = test::ample_us});
                EXPECT_TRUE(holes(walk.engine(), there).empty()) << "with the set of another place";
                for (int i = 0; i < 2; ++i) {
                    walk.frame(there);
                    EXPECT_TRUE(holes(walk.engine(), there).empty()) << i;
                }
            }
        }
    }
}

/// A picture of what has no depth stays right wherever the eye goes; seen from the side it shows nothing.
TEST(PictureBadInput, FlatThingsHavePicturesAndLeaveNoHole) {
    const model::Model model = baked(walls_and_balls(true));
    EXPECT_EQ(model.nodes[0].box.half().z, 0);
    PictureWalk walk(model, {});
    Pose pose = before(walk.engine(), 30);
    EXPECT_GT(walk_past(walk, pose), 0U);
    const Box box = model.nodes[0].box;
    for (const dvec3& eye : {box.centre(), box.centre() + dvec3(-20, 0, 0), box.centre() + dvec3(3, 0, 1e-9), box.max}) {
        Pose there = pose;
        there.position = eye;
        for (int i = 0; i < 4; ++i) {
            walk.frame(there);
            EXPECT_TRUE(holes(walk.engine(), there).empty()) << i;
        }
    }
}

TEST(PictureBadInput, OneTriangleAndOneBoxAreDrawn) {
    const std::array scenes = {one_triangle(), one_thing(bake::ball(16, 1)), one_thing(bake::ball(160, 1))};
    for (const importer::Scene& scene : scenes) {
        const model::Model model = baked(scene);
        for (const bool all_round : {false, true}) {
            PictureWalk walk(model, {.layers = 1, .all_round = all_round});
            EXPECT_TRUE(walk.engine().has_pictures()) << walk.engine().picture_reason();
            Pose pose = before(walk.engine(), 15);
            const std::size_t shown = walk_past(walk, pose);
            if (&scene == &scenes.back()) {
                EXPECT_EQ(shown, 1U) << "the others take less time than a picture";
            }
            for (const dvec3& eye : {dvec3(0), dvec3(0.25, 0.25, 0), dvec3(0, 0, -3), dvec3(1e7, 0, 0)}) {
                Pose there = pose;
                there.position = eye;
                walk.frame(there);
                EXPECT_TRUE(holes(walk.engine(), there).empty());
            }
        }
    }
}

/// The memory holds one picture of the largest kind, or none that a box needs: forms are drawn.
TEST(PictureBadInput, ACacheThatIsTooSmallLeavesNoHole) {
    const model::Model model = baked(walls_and_balls());
    for (const std::uint32_t layers : {0U, 1U}) {
        PictureWalk walk(model, {.layers = layers, .viewport = {1280, 720}});
        Pose pose = before(walk.engine(), 12);
        EXPECT_LE(walk_past(walk, pose), layers * 16U);
        pose = before(walk.engine(), 60);
        const std::size_t shown = walk_past(walk, pose);
        EXPECT_LE(shown, layers * 16U);
        EXPECT_EQ(shown > 0, layers > 0);
    }
}

}  // namespace
}  // namespace surefoot
