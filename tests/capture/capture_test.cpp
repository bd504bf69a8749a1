// Captured frames: the round trip gives the same cut off line; truncation and any changed byte are refused.
#include "render/capture/capture.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <limits>

#include "rt/base/file.hpp"
#include "tests/select/scene.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot::capture {
namespace {

using test::Scene;

struct TempFile {
    test::TemporaryFolder folder;
    std::string path = folder / "capture";
};

Capture captured(std::string_view selector, std::uint32_t depth = 4) {
    Scene s(test::town(depth));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 30);
    for (int i = 0; i < 3; ++i) {  // so that the selector remembers something
        s.look(region);
        s.run(selector, 4000 + 1000 * i);
        region.centre.position.x += 0.7;
    }
    s.look(region);
    s.run(selector, 5500);
    return take(s.input(5500), selector, s.state.hysteresis, {s.state.before, s.state.bought_before}, s.cut);
}

TEST(Capture, ReplaysToTheSameCutForEverySelector) {
    const TempFile file;
    for (const std::string_view name : select::selector_names()) {
        const Capture before = captured(name);
        ASSERT_TRUE(write_capture(file.path, before));
        auto after = read_capture(file.path);
        ASSERT_TRUE(after) << after.error().text();
        EXPECT_TRUE(verify(*after)) << name;
        auto cut = replay(*after);
        ASSERT_TRUE(cut);
        EXPECT_EQ(cut->hash, before.hash);
        EXPECT_EQ(cut->predicted_us, before.predicted_us);
        EXPECT_EQ(cut->items.size(), before.items.size());
        EXPECT_GT(before.items.size(), 5U);
    }
}

TEST(Capture, OfALowerResolutionKnowsWhatEnlargingCosts) {
    const TempFile file;
    Scene s(test::town(4));
    s.costs.enlarge_ns_per_pixel = 3.7F;
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 30);
    s.frame.resolution = 0.5F;
    s.look(region);
    s.run("two-stage", 6500);
    const Capture before = take(s.input(6500), "two-stage", s.state.hysteresis, {s.state.before, s.state.bought_before}, s.cut);
    ASSERT_TRUE(write_capture(file.path, before));
    auto after = read_capture(file.path);
    ASSERT_TRUE(after) << after.error().text();
    EXPECT_EQ(after->prepared.resolution, 0.5F);
    EXPECT_TRUE(verify(*after));
    EXPECT_EQ(replay(*after)->predicted_us, before.predicted_us);
    Capture cheap = *after;
    cheap.enlarge_ns_per_pixel = 0;
    EXPECT_NE(replay(cheap)->predicted_us, before.predicted_us);
}

TEST(Capture, MemoryIsPartOfTheDecision) {
    Capture c = captured("two-stage", 5);
    ASSERT_FALSE(c.memory.empty());
    const std::uint64_t with = replay(c)->hash;
    c.memory.clear();
    EXPECT_NE(replay(c)->hash, with);
}

TEST(Capture, AnotherSelectorCanBeTriedOnTheSameFrame) {
    const Capture c = captured("two-stage");
    ASSERT_TRUE(replay(c, "flat"));
    EXPECT_NE(replay(c, "flat")->hash, c.hash);
    EXPECT_FALSE(replay(c, "no-such"));
}

TEST(Capture, DifferenceIsNamed) {
    Capture c = captured("two-stage");
    c.items[1].rep += 1;
    const auto result = verify(c);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().place, "item 1");
}

TEST(Capture, AnyChangedByteAndAnyTruncationIsRefused) {
    const TempFile file;
    ASSERT_TRUE(write_capture(file.path, captured("best-first", 2)));
    auto bytes = read_file(file.path);
    ASSERT_TRUE(bytes);
    std::vector<std::byte>& b = *bytes;
    ASSERT_TRUE(parse_capture(b, "x"));
    for (std::size_t i = 0; i < b.size(); ++i) {
        for (const int bit : {0, 3, 7}) {
            b[i] ^= std::byte{1} << bit;
            EXPECT_FALSE(parse_capture(b, "x")) << "byte " << i;
            b[i] ^= std::byte{1} << bit;
        }
        EXPECT_FALSE(parse_capture(std::span(b).first(i), "x")) << "cut at " << i;
    }
    b.push_back(std::byte{0});
    EXPECT_FALSE(parse_capture(b, "x"));
}

TEST(Capture, InconsistentIndicesAreRefusedThoughTheChecksumIsRight) {
    const TempFile file;
    const Capture good = captured("two-stage", 3);
    int tried = 0;
    const auto refused = [&](auto&& spoil) {
        Capture c = good;
        spoil(c);
        ASSERT_TRUE(write_capture(file.path, c));
        EXPECT_FALSE(read_capture(file.path)) << "case " << tried;
        ++tried;
    };
    refused([](Capture& c) { c.prepared.candidates[1].parent = 5; });
    refused([](Capture& c) { c.prepared.candidates[0].first_child = 0; });
    refused([](Capture& c) { c.prepared.candidates[0].child_count = 0xffffffff; });
    refused([](Capture& c) { c.prepared.candidates.back().first_choice = 0xfffffff0; });
    refused([](Capture& c) { c.prepared.candidates.back().choice_count = 0; });
    refused([](Capture& c) { c.prepared.candidates[2].node = c.node_count; });
    refused([](Capture& c) { c.prepared.choices[3].cost.raster_us = std::numeric_limits<float>::quiet_NaN(); });
    refused([](Capture& c) { c.memory[0].node = 0xffffffff; });
    refused([](Capture& c) { c.items[0].candidate = 0xffffffff; });
    refused([](Capture& c) { c.node_count = 0xffffffff; });
    refused([](Capture& c) { c.hysteresis = std::numeric_limits<float>::infinity(); });
    EXPECT_EQ(tried, 11);
}

TEST(Capture, MissingFileIsNamed) {
    const auto result = read_capture("/nonexistent/frame.capture");
    ASSERT_FALSE(result);
    EXPECT_NE(result.error().text().find("/nonexistent/frame.capture"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::capture
