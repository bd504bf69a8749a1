// Snapshots: which frames are kept, what the frame before showed, what of it is a pop, and shadows of what moves.
#include "tools/walk/snapshots.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <utility>

#include "render/model/walk_file.hpp"
#include "tests/engine/moving_frame.hpp"
#include "tests/engine/moving_lawn.hpp"
#include "tests/engine/picture_walk.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

using Items = std::vector<gl::DrawItem>;
using Pairs = std::set<std::pair<model::Index, model::Index>>;

Pairs pairs_of(const Items& items) {
    Pairs pairs;
    for (const gl::DrawItem& item : items) pairs.insert({item.node, item.rep});
    return pairs;
}

TEST(Snapshots, HoldTheFrameBeforeWithWhatWasOutsideItsView) {
    walk::SnapshotStore store(3, 2, 10, true);
    for (model::Index frame = 0; frame < 9; ++frame) {
        const Items drawn{{frame, 0}}, culled{{frame + 100, 0}};
        store.remember(frame, 0, {}, 0, 1, rt::TextureFilter::bilinear, 0, drawn, culled);
    }
    ASSERT_EQ(store.used(), 2U);
    EXPECT_TRUE(store.snapshots()[0].last_items.empty()) << "nothing comes before the first";
    EXPECT_EQ(store.snapshots()[1].frame, 3U);
    EXPECT_EQ(pairs_of(store.snapshots()[1].items), (Pairs{{3, 0}}));
    EXPECT_EQ(pairs_of(store.snapshots()[1].last_items), (Pairs{{2, 0}, {102, 0}}));
}

TEST(Snapshots, HoldTheBoxesOfTheImageCacheOfTheirFrames) {
    walk::SnapshotStore store(3, 2, 10);
    store.reserve_boxes(4);
    const cache::FrameBox* place = store.snapshots()[1].boxes.data();
    for (model::Index frame = 0; frame < 9; ++frame) {
        store.remember(frame, 0, {}, 0, 1, rt::TextureFilter::bilinear, 0, Items{{frame, 0}});
        std::vector<cache::FrameBox> boxes(4);
        boxes[frame % 4].made = true;
        if (frame > 0) store.remember_boxes(frame, boxes);
    }
    EXPECT_TRUE(store.snapshots()[0].boxes.empty()) << "that frame had none";
    ASSERT_EQ(store.snapshots()[1].boxes.size(), 4U);
    EXPECT_TRUE(store.snapshots()[1].boxes[3].made) << "of frame 3, not of those after it";
    EXPECT_EQ(store.snapshots()[1].boxes.data(), place) << "in the room that was reserved";
}

TEST(Snapshots, OfEveryFrameHoldTheFrameBeforeToo) {
    walk::SnapshotStore store(1, 2, 10, true);
    for (model::Index frame = 0; frame < 4; ++frame)
        store.remember(frame, 0, {}, 0, 1, rt::TextureFilter::bilinear, 0, Items{{frame, 0}});
    EXPECT_TRUE(store.snapshots()[0].last_items.empty());
    EXPECT_EQ(pairs_of(store.snapshots()[1].last_items), (Pairs{{0, 0}}));
    walk::SnapshotStore without(1, 2, 10);
    for (model::Index frame = 0; frame < 4; ++frame)
        without.remember(frame, 0, {}, 0, 1, rt::TextureFilter::bilinear, 0, Items{{frame, 0}});
    EXPECT_TRUE(without.snapshots()[1].last_items.empty());
}

/// Root 0 over 1 and 2; 1 over 3 and 4.
model::Model small_tree() {
    model::Model model;
    model.nodes.resize(5);
    for (const auto& [child, parent] : {std::pair{1U, 0U}, {2U, 0U}, {3U, 1U}, {4U, 1U}}) model.nodes[child].parent = parent;
    return model;
}

TEST(Snapshots, WhatCameIntoViewIsNoPop) {
    const model::Model model = small_tree();
    walk::FrameSnapshot snapshot;
    const auto last_cut = [&](Items last, Items now) {
        snapshot.last_items = std::move(last);
        snapshot.items = std::move(now);
        return pairs_of(last_cut_at(model, snapshot));
    };
    EXPECT_EQ(last_cut({{3, 7}}, {{3, 8}, {2, 5}}), (Pairs{{3, 7}, {2, 5}})) << "2 is new, 3 was coarser";
    EXPECT_EQ(last_cut({{1, 2}}, {{3, 8}, {4, 9}}), (Pairs{{1, 2}})) << "their ancestor was shown";
    EXPECT_EQ(last_cut({{3, 7}, {4, 9}}, {{1, 2}}), (Pairs{{3, 7}, {4, 9}})) << "its descendants were shown";
    EXPECT_EQ(last_cut({{0, 0}}, {{2, 5}, {3, 8}}), (Pairs{{0, 0}}));
}

std::vector<std::uint32_t> boxes_of(const std::vector<ShownPicture>& pictures) {
    std::vector<std::uint32_t> boxes;
    for (const ShownPicture& each : pictures) boxes.push_back(each.box);
    return boxes;
}

/// A picture of now belongs to the frame before only where that frame showed nothing of its box: then it is no pop.
TEST(Snapshots, APictureOfWhatCameIntoViewIsNoPop) {
    const auto forest = model::read_walk(test::Forest::get().model_file);
    ASSERT_TRUE(forest.ok());
    test::PictureWalk walk(*forest, {});
    const Engine& engine = walk.engine();
    const Box& box = engine.model().nodes[0].box;
    for (int i = 0; i < 12; ++i) {  // along the edge, looking in
        Pose pose;
        pose.position = box.centre() + dvec3(0.05 * i, 2, 0.8 * box.half().z);
        walk.frame(pose);
    }
    ASSERT_GT(engine.shown_pictures().size(), 1U);
    const ShownPicture near = engine.shown_pictures().back(), far = engine.shown_pictures().front();
    ASSERT_FALSE(engine.leaves_in(near.box).empty());
    ShownPicture older = near;
    older.picture.eye.x -= 1;

    walk::FrameSnapshot snapshot;
    snapshot.pictures = {far, near};
    EXPECT_EQ(boxes_of(last_pictures_at(engine, snapshot)), (std::vector{far.box, near.box})) << "nothing was shown";
    snapshot.last_pictures = {older};
    const std::vector<ShownPicture> both = last_pictures_at(engine, snapshot);
    ASSERT_EQ(boxes_of(both), (std::vector{far.box, near.box}));
    EXPECT_EQ(both.back().picture.eye, older.picture.eye) << "as the frame before showed it";
    snapshot.last_items = {{engine.leaves_in(far.box).front(), 0}};
    EXPECT_EQ(boxes_of(last_pictures_at(engine, snapshot)), (std::vector{near.box})) << "its forms were shown";
    snapshot.last_items = {{0, 0}};
    EXPECT_EQ(boxes_of(last_pictures_at(engine, snapshot)), (std::vector{near.box})) << "and here those of all";
    snapshot.last_pictures.clear();
    EXPECT_TRUE(last_pictures_at(engine, snapshot).empty());
}

TEST(Snapshots, ShowShadowsOfWhatMovesIfTheirFrameDid) {
    EngineOptions options;
    options.device.viewport = test::lawn_picture;
    options.device.switches = {model::effect_moving_shadow};
    auto opened = Engine::open(test::baked_lawn(), model::default_costs(), options);
    if (!opened) {
        ASSERT_EQ(opened.error().kind, ErrorKind::unsupported) << opened.error().text();
        GTEST_SKIP() << "EGL is not there, or a sanitizer allows no GL";
    }
    Engine& engine = **opened;
    engine.device().draws.plays();
    prepare::PreparedFrame prepared;
    engine.reserve(prepared);
    const Pose pose = test::over_the_lawn();
    SubmitLimits limits;
    limits.limit_us = 1e6;
    const SubmitReport report = test::moving_frame(engine, prepared, pose, 1, 1e6, limits);
    ASSERT_TRUE(report.shadow_shown);
    auto frame = engine.device().read_pixels();
    ASSERT_TRUE(frame.ok());

    walk::SnapshotStore store(1, 2, engine.drawn_capacity());
    const rt::ShownLight light;
    for (const bool shadow : {true, false})
        store.remember(0, 1, pose, 1, 1, rt::TextureFilter::automatic, 0, engine.drawn(), {}, light, {}, shadow);
    const auto with = render_snapshot(engine, store.snapshots()[0]), without = render_snapshot(engine, store.snapshots()[1]);
    ASSERT_TRUE(with.ok() && without.ok());
    EXPECT_EQ(with->walk, frame->rgba);
    EXPECT_EQ(with->full, frame->rgba) << "full detail has what the scene calls for";
    EXPECT_EQ(without->full, frame->rgba);
    EXPECT_EQ(with->mse, 0);
    EXPECT_GT(without->mse, 0) << "what a frame did not show its picture does not either";

    engine.hide_effects(0);
    walk::FrameSnapshot off = store.snapshots()[0];
    off.light.on.shadows = false;
    const auto hidden = render_snapshot(engine, off);
    ASSERT_TRUE(hidden.ok());
    EXPECT_EQ(hidden->full, without->walk) << "switched off, it is called for by nothing";
}

}  // namespace
}  // namespace surefoot
