// The renderer's door: what it keeps in memory, and that another selector prepares what that one needs. Without GL.
#include "render/engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/drawn_items.hpp"
#include "rt/base/check.hpp"
#include "rt/threads/memory.hpp"
#include "tests/gl/small_models.hpp"
#include "tests/rt/in_child.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot {
namespace {

EngineOptions null_options() {
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    return options;
}

/// Memory of this process's own that is in RAM.
std::int64_t anonymous_bytes() {
    std::ifstream rollup("/proc/self/smaps_rollup");
    std::string word;
    std::int64_t kib = 0;
    while (rollup >> word)
        if (word == "Anonymous:") rollup >> kib;
    return kib * 1024;
}

/// Two pictures of 2048 x 2048 with their levels: 43 MiB.
model::Model large_pictures() {
    test::SmallModel scene;
    for (int i = 0; i < 2; ++i) {
        auto material = test::plain(1, 1, 1, 1, model::effect_texture);
        material.texture = scene.texture({255, 0, 0, 255}, {0, 255, 0, 255}, 2048);
        scene.square(scene.material(material), test::at(i, 0, -1));
    }
    scene.finish();
    scene.model().texels.shrink_to_fit();  // as in a model that was read: locked memory counts whether it is used or not
    return std::move(scene.model());
}

/// Percent of the texels' size by which open() leaves less in memory, in a process of its own; 0 where anything fails.
int percent_given_back(bool as_in_a_walk) {
    return rt::test::in_child([=] {
        if (as_in_a_walk) static_cast<void>(rt::prepare_memory({}));  // keeps the heap even where locking is refused
        model::Model model = large_pictures();
        const auto texels = static_cast<std::int64_t>(model.texels.size());
        const std::int64_t before = anonymous_bytes();
        auto engine = Engine::open(std::move(model), model::default_costs(), null_options());
        if (!engine.ok() || before == 0) return 0;
        return static_cast<int>(std::clamp<std::int64_t>(100 * (before - anonymous_bytes()) / texels, 0, 120));
    });
}

#ifdef SUREFOOT_WATCHES_THREADS
constexpr bool memory_counts = false;
#else
constexpr bool memory_counts = true;
#endif

TEST(EngineMemory, GivesTheTexelsBackOnceTheDeviceHasThem) {
    if (!memory_counts) GTEST_SKIP() << "the thread sanitizer's allocator changes what a process keeps";
    const int percent = percent_given_back(false);
    EXPECT_GE(percent, 85);  // the engine's own arrays take some of it
    EXPECT_LE(percent, 105);
}

TEST(EngineMemory, GivesTheTexelsBackWhereTheHeapIsKeptAndLocked) {
    if (!memory_counts) GTEST_SKIP() << "the thread sanitizer's allocator changes what a process keeps";
    const int percent = percent_given_back(true);
    EXPECT_GE(percent, 85);
    EXPECT_LE(percent, 105);
}

TEST(DrawnItems, AnItemBeyondTheReservedMemoryIsLeftOutAndCounted) {
    std::vector<gl::DrawItem> drawn;
    drawn.reserve(3);
    const std::size_t room = drawn.capacity();
    const gl::DrawItem* const memory = drawn.data();
    const std::uint64_t before = rare_check_count();
    for (std::size_t i = 0; i < room; ++i) EXPECT_TRUE(push_within(drawn, {static_cast<model::Index>(i), 0}));
    EXPECT_EQ(rare_check_count(), before);
    EXPECT_FALSE(push_within(drawn, {99, 0}));
    EXPECT_FALSE(push_within(drawn, {99, 0}));
    EXPECT_EQ(rare_check_count(), before + 2);
    EXPECT_EQ(drawn.size(), room);
    EXPECT_EQ(drawn.data(), memory) << "it allocated";
    EXPECT_EQ(drawn.back().node, room - 1);
    const auto checks = rare_checks();
    EXPECT_TRUE(std::any_of(checks.begin(), checks.end(), [](const RareCheck& check) {
        return check.place.starts_with("render/drawn_items.hpp:") && check.count >= 2;
    }));
}

using Nodes = std::set<model::Index>;

struct SelectorSwitch : testing::Test {
    static model::Model forest() {
        auto scene = scenes::generate("forest", 0.05, 1);
        EXPECT_TRUE(scene.ok());
        auto model = bake::bake(scene->scene, {}, {});
        EXPECT_TRUE(model.ok());
        return std::move(*model);
    }
    static std::unique_ptr<Engine> open(const EngineOptions& options) {
        auto engine = Engine::open(forest(), model::default_costs(), options);
        EXPECT_TRUE(engine.ok());
        return std::move(*engine);
    }
    static EngineOptions options(std::string_view selector) {
        EngineOptions options = null_options();
        options.selector = selector;
        options.prepare.occlusion = false;
        return options;
    }
    /// What is selected from so far off that all of the model is in view and nothing but `flat` needs its leaves.
    static Nodes cut_of(Engine& engine) {
        const Box& box = engine.model().nodes[0].box;
        Pose pose;
        pose.position = box.centre() + dvec3(0, 0, 40 * box.diagonal());
        prepare::PreparedFrame prepared;
        engine.reserve(prepared);
        engine.prepare({pose, 0, 0}, 0, 0, 0, prepared);
        Nodes nodes;
        for (const auto& item : engine.select(prepared, 1e9, {}, 0).items) nodes.insert(item.node);
        return nodes;
    }
    static Nodes leaves_of(const model::Model& m) {
        Nodes nodes;
        for (model::Index n = 0; n < m.nodes.size(); ++n)
            if (m.nodes[n].child_count == 0) nodes.insert(n);
        return nodes;
    }
};

TEST_F(SelectorSwitch, FlatDrawsTheLeavesAndTheNextOneItsOwnCutAgain) {
    auto engine = open(options(select::usual_selector));
    const Nodes leaves = leaves_of(engine->model()), before = cut_of(*engine);
    EXPECT_LT(before.size(), leaves.size());
    ASSERT_TRUE(engine->set_selector("flat").ok());
    EXPECT_EQ(cut_of(*engine), leaves);
    ASSERT_TRUE(engine->set_selector(select::usual_selector).ok());
    EXPECT_EQ(cut_of(*engine), before);
    EXPECT_FALSE(engine->set_selector("no such").ok());
    EXPECT_EQ(cut_of(*engine), before);
}

TEST_F(SelectorSwitch, FromFlatToAnotherAndBack) {
    auto engine = open(options("flat"));
    const Nodes leaves = leaves_of(engine->model());
    EXPECT_EQ(cut_of(*engine), leaves);
    ASSERT_TRUE(engine->set_selector(select::usual_selector).ok());
    EXPECT_LT(cut_of(*engine).size(), leaves.size());
    ASSERT_TRUE(engine->set_selector("flat").ok());
    EXPECT_EQ(cut_of(*engine), leaves);
}

TEST_F(SelectorSwitch, FullDepthThatWasRequestedStays) {
    EngineOptions deep = options("flat");
    deep.prepare.full_depth = true;
    auto engine = open(deep);
    ASSERT_TRUE(engine->set_selector(select::usual_selector).ok());
    EXPECT_TRUE(engine->options().prepare.full_depth);
}

}  // namespace
}  // namespace surefoot
