// The triangles that show a picture, by calculation alone: random boxes, eyes and squares.
#include "render/gl/picture_faces.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "rt/base/random.hpp"
#include "tests/gl/picture_scene.hpp"

namespace surefoot::test {
namespace {

/// How many triangles a place of the texture lies in; -1 near an edge of one.
int triangles_at(std::span<const gl::PictureVertex> corners, const dvec2& at) {
    int count = 0;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        std::array<double, 3> sides{};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto &a = corners[i + c].at, &b = corners[i + (c + 1) % 3].at;
            sides[c] =
                (double{b[0]} - double{a[0]}) * (at.y - double{a[1]}) - (double{b[1]} - double{a[1]}) * (at.x - double{a[0]});
            if (std::abs(sides[c]) < 1e-7) return -1;
        }
        count += (sides[0] > 0) == (sides[1] > 0) && (sides[1] > 0) == (sides[2] > 0) ? 1 : 0;
    }
    return count;
}

TEST(PictureFaces, show_each_point_of_a_box_once_and_end_with_the_square) {
    Random random(3);
    std::array<gl::PictureVertex, gl::max_picture_vertices> to;
    int seen = 0, points = 0;
    for (int i = 0; i < 20000; ++i) {
        const dvec3 middle = any_in(random, dvec3(-10), dvec3(10)), half = any_in(random, dvec3(0), dvec3(3));
        const dvec3 from = any_in(random, dvec3(-20), dvec3(20));
        gl::CachePicture picture = picture_from({middle - half, middle + half}, from, {0, 0, 0, 128});
        if (i % 2 == 1) picture.low_m += any_in(random, dvec3(-1), dvec3(1)).x * picture.side_m;
        const dvec3 eye = from + any_in(random, dvec3(-1), dvec3(1)) * static_cast<double>(i % 7);
        const std::size_t count = gl::add_picture(picture, eye, to);
        ASSERT_EQ(count % 3, 0U);
        seen += count > 0 ? 1 : 0;
        for (std::size_t v = 0; v < count; ++v) {
            for (const float at : {to[v].at[0], to[v].at[1]}) ASSERT_TRUE(at >= 0.4999F / 256 && at <= 127.5001F / 256);
            for (const float place : to[v].place) ASSERT_TRUE(std::isfinite(place));
            ASSERT_GT(to[v].place[3], 0) << "before the eye";
        }
        const dvec3 ray = any_in(random, picture.box.min, picture.box.max) - eye, moved = eye - from;
        const double plane = picture.plane_m - glm::dot(moved, picture.forward);
        const dvec3 on_plane = moved + ray * (plane / glm::dot(ray, picture.forward));
        const dvec2 at =
            (dvec2(glm::dot(on_plane, picture.right), glm::dot(on_plane, picture.up)) - picture.low_m) / picture.side_m;
        if (count == 0 || !(std::min(at.x, at.y) > 0.005) || !(std::max(at.x, at.y) < 0.995)) continue;
        const int triangles = triangles_at(std::span(to).first(count), 0.5 * at);
        points += triangles >= 0 ? 1 : 0;
        ASSERT_TRUE(triangles == 1 || triangles == -1) << triangles << " " << i;
    }
    EXPECT_GT(seen, 15000);
    EXPECT_GT(points, 8000);
}

/// What stands before the box as it was before it grew stays before the picture.
TEST(PictureFaces, of_a_grown_box_lie_on_the_planes_of_the_smaller_one) {
    Random random(5);
    std::array<gl::PictureVertex, gl::max_picture_vertices> to, plain;
    int seen = 0;
    for (int i = 0; i < 2000; ++i) {
        const dvec3 middle = any_in(random, dvec3(-10), dvec3(10)), half = any_in(random, dvec3(0.1), dvec3(3));
        const dvec3 eye = any_in(random, dvec3(-20), dvec3(20));
        const double grown_m = any_in(random, dvec3(0), dvec3(1)).x;
        const Box small{middle - half, middle + half}, box{small.min - dvec3(grown_m), small.max + dvec3(grown_m)};
        gl::CachePicture picture = picture_from(box, eye, {0, 0, 0, 128});
        const std::size_t count = gl::add_picture(picture, eye, plain);
        picture.grown_m = grown_m;
        ASSERT_EQ(gl::add_picture(picture, eye, to), count);
        seen += count > 0 ? 1 : 0;
        for (std::size_t v = 0; v < count; v += 3) {
            bool on_face = false;
            for (int axis = 0; axis < 3; ++axis) {
                for (const dvec3& end : {small.min, small.max}) {
                    bool all = true;
                    for (std::size_t c = v; c < v + 3; ++c)
                        all = all &&
                              std::abs(eye[axis] + double{to[c].place[static_cast<std::size_t>(axis)]} / double{to[c].place[3]} -
                                       end[axis]) < 1e-4;
                    on_face = on_face || all;
                }
            }
            ASSERT_TRUE(on_face) << i;
            for (std::size_t c = v; c < v + 3; ++c) {
                for (const std::size_t axis : {0U, 1U, 2U}) ASSERT_EQ(to[c].place[axis], plain[c].place[axis]) << "the same ray";
                ASSERT_EQ(to[c].at, plain[c].at);
            }
        }
    }
    EXPECT_GT(seen, 1000);
}

}  // namespace
}  // namespace surefoot::test
