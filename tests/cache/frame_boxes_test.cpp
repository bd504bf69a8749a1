// Boxes of a walk's frame: each in view is counted once, and the view from above has its colours.
#include "render/cache/frame_boxes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "render/cache/scene_boxes.hpp"
#include "render/model/view.hpp"
#include "tests/cache/row.hpp"

namespace surefoot::cache {
namespace {

/// Leaves of the tree with contents at and below a box.
std::uint32_t filled_leaves(const SceneBoxes& boxes, Index i) {
    const CacheBox& box = boxes.tree().boxes[i];
    if (box.child_count == 0) return boxes.has_contents(i) ? 1 : 0;
    std::uint32_t count = 0;
    for (Index child = box.first_child; child < box.first_child + box.child_count; ++child) count += filled_leaves(boxes, child);
    return count;
}

struct FrameBoxes : testing::Test {
    SceneBoxes boxes = *SceneBoxes::make(row_of_leaves(), {}, TreeOptions{4, 3, 0});  // sixteen leaves, in a row
    std::vector<FrameBox> frame = std::vector<FrameBox>(boxes.size());

    static model::Frustum looking(double towards_z) {
        Pose pose;
        pose.position = {60, 5, 500};
        if (towards_z > 0) pose.orientation = dquat(0, 0, 1, 0);
        return model::make_frustum(pose, {640, 480}, 1e4);
    }
    FrameBoxCounts mark(std::vector<Index> shown, std::vector<Index> made, double towards_z = -1) {
        return mark_boxes(boxes, shown, made, looking(towards_z), frame);
    }
};

TEST_F(FrameBoxes, WithoutPicturesAllInViewAreTriangles) {
    const FrameBoxCounts counts = mark({}, {});
    EXPECT_EQ(counts.reused, 0U);
    EXPECT_EQ(counts.as_triangles, filled_leaves(boxes, 0));
    EXPECT_GE(counts.as_triangles, 8U);
    EXPECT_EQ(mark({}, {}, 1).as_triangles, 0U) << "behind the eye";
}

TEST_F(FrameBoxes, WhatAPictureShowsIsNotCountedBelowIt) {
    EXPECT_EQ(mark({0}, {}).as_triangles, 0U);
    EXPECT_EQ(mark({0}, {}).reused, 1U);
    EXPECT_EQ(mark({0}, {0}).reused, 0U) << "it was made in this frame";
    const Index child = boxes.tree().boxes[0].first_child;
    ASSERT_GT(filled_leaves(boxes, child), 0U);
    const FrameBoxCounts counts = mark({child}, {child + 1});
    EXPECT_EQ(counts.as_triangles, filled_leaves(boxes, 0) - filled_leaves(boxes, child));
    EXPECT_TRUE(frame[child].shown && !frame[child].made && frame[child + 1].made && !frame[child + 1].shown);
    const std::vector<SeenBox> seen = seen_boxes(boxes, frame);
    EXPECT_EQ(seen.size(), counts.as_triangles + 2);
    const auto uses = [&](BoxUse use, bool drawn) {
        return std::count_if(seen.begin(), seen.end(), [&](const SeenBox& box) { return box.use == use && box.drawn == drawn; });
    };
    EXPECT_EQ(uses(BoxUse::reused, true), 1);
    EXPECT_EQ(uses(BoxUse::fresh, false), 1) << "made for later frames";
    EXPECT_EQ(uses(BoxUse::not_replaceable, true), counts.as_triangles);
    mark({}, {});
    EXPECT_FALSE(frame[child].shown) << "each frame begins anew";
}

TEST(BirdsEyeOfBoxes, HasItsColours) {
    const auto box = [](double x, double z, double size, double top) {
        return Box{dvec3(x, 0, z), dvec3(x + size, top, z + size)};
    };
    std::vector<SeenBox> seen{{box(0, 0, 40, 9), BoxUse::fresh, true},
                              {box(60, 0, 40, 9), BoxUse::reused, true},
                              {box(0, 60, 40, 9), BoxUse::not_replaceable, true},
                              {box(0, 60, 40, 9), BoxUse::fresh, false},
                              {box(60, 60, 40, 9), BoxUse::combined, true},
                              {box(60, 60, 20, 1), BoxUse::reused, true}};  // lower: hidden by the one above
    const std::vector<std::uint8_t> view = birds_eye_view(seen, {dvec3(0), dvec3(100, 9, 100)}, {50, 5, 50}, 108);
    ASSERT_EQ(view.size(), 4U * 108 * 108);
    const auto at = [&](std::size_t x, std::size_t z) {  // a pixel a metre, and a margin of four
        const std::size_t i = 4 * ((z + 4) * 108 + x + 4);
        return std::array<int, 3>{view[i], view[i + 1], view[i + 2]};
    };
    const auto is = [&](const std::array<int, 3>& rgb, bool r, bool g, bool b) {
        return (rgb[0] > 128) == r && (rgb[1] > 128) == g && (rgb[2] > 128) == b;
    };
    EXPECT_TRUE(is(at(20, 20), true, false, false)) << "new";
    EXPECT_TRUE(is(at(80, 20), true, true, true)) << "reused";
    EXPECT_TRUE(is(at(5, 65), false, false, false)) << "as triangles";
    EXPECT_TRUE(is(at(20, 80), true, false, false)) << "and a picture for later frames in it";
    EXPECT_TRUE(is(at(70, 70), false, true, false)) << "combined; what lies lower is hidden";
    EXPECT_TRUE(is(at(50, 50), false, false, true)) << "the eye";
    EXPECT_EQ(at(50, 20), (std::array<int, 3>{168, 168, 168})) << "nothing is there";
}

}  // namespace
}  // namespace surefoot::cache
