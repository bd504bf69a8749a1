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

Memory memory_of(const Scene& s) { return {s.state.before, s.state.bought_before, s.state.hysteresis, s.state.reserve_share}; }

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
    return take(s.input(5500), selector, memory_of(s), s.cut);
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

TEST(Capture, KnowsWhatTheEyeTellsApart) {
    const TempFile file;
    prepare::PrepareOptions options;
    options.acuity_rad = 0.02;
    Scene s(test::town(4), options);
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 30);
    s.look(region);
    s.run("distance", 5500);
    const Capture before = take(s.input(5500), "distance", memory_of(s), s.cut);
    ASSERT_TRUE(write_capture(file.path, before));
    auto after = read_capture(file.path);
    ASSERT_TRUE(after) << after.error().text();
    EXPECT_EQ(after->prepared.acuity_rad, 0.02);
    EXPECT_TRUE(verify(*after));
    after->prepared.acuity_rad = 0;
    EXPECT_FALSE(verify(*after)) << "the fixed threshold goes by it";
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
    const Capture before = take(s.input(6500), "two-stage", memory_of(s), s.cut);
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

TEST(Capture, OfSeveralSamplesKnowsWhatTheirPassesCostAtTheResolutionThatIsDrawn) {
    Scene s(test::town(4));
    s.costs.sample_pass_ns_per_pixel = 0.7F;
    s.costs = model::at_quality(s.costs, {4, rt::TextureFilter::bilinear, rt::TextureFilter::bilinear});
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 30);
    std::vector<float> predicted_us;
    for (const float resolution : {1.0F, 0.5F}) {
        s.frame.resolution = resolution;
        s.look(region);
        s.run("threshold", 6500);
        const Capture before = take(s.input(6500), "threshold", memory_of(s), s.cut);
        EXPECT_TRUE(verify(before));
        EXPECT_EQ(replay(before)->predicted_us, before.predicted_us);
        const model::FrameCombine at = s.costs.combine_at(resolution, s.frame.viewport);
        EXPECT_EQ(before.combine.fixed_us, at.fixed_us);
        predicted_us.push_back(before.combine.fixed_us);
    }
    EXPECT_LT(predicted_us[1], predicted_us[0]);
}

/// A capture in which an item is bought that the frame before had bought too.
Capture captured_with_items() {
    Scene s(test::town(4));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 30);
    s.look(region);
    select::ItemList items;
    items.offer({select::ItemKind::effect, 3, 500, 1e9F});
    items.offer({select::ItemKind::upload, 9, 400, 1e-9F});
    items.prepay({select::ItemKind::resolution, 2, 100, 7});
    select::SelectInput input = s.input(5500);
    input.items = &items;
    for (int i = 0; i < 2; ++i) select::find_selector("threshold")->run(input, s.state, s.cut);
    EXPECT_TRUE(s.cut.bought.has(0) && s.cut.bought.has(2));
    return take(input, "threshold", memory_of(s), s.cut);
}

TEST(Capture, HoldsWhatWasOfferedAndBoughtBesideForms) {
    const TempFile file;
    const Capture before = captured_with_items();
    ASSERT_EQ(before.offered.size(), 3U);
    ASSERT_GE(before.bought_before.size(), 2U);
    ASSERT_TRUE(write_capture(file.path, before));
    auto after = read_capture(file.path);
    ASSERT_TRUE(after) << after.error().text();
    EXPECT_EQ(after->bought_before, before.bought_before);
    EXPECT_TRUE(verify(*after));
    const auto cut = replay(*after);
    EXPECT_EQ(cut->predicted_us, before.predicted_us);
    EXPECT_TRUE(cut->bought.has(0) && cut->bought.has(2));
    Capture free = *after;
    free.offered[0].cost_us = 1;
    EXPECT_NE(replay(free)->predicted_us, before.predicted_us);
    for (const float bad : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
        Capture wrong = before;
        wrong.offered[0].cost_us = bad;
        ASSERT_TRUE(write_capture(file.path, wrong));
        EXPECT_FALSE(read_capture(file.path)) << bad;
    }
    Capture wrong = before;
    wrong.offered[1].kind = static_cast<select::ItemKind>(99);
    ASSERT_TRUE(write_capture(file.path, wrong));
    EXPECT_FALSE(read_capture(file.path));
}

TEST(Capture, HoldsThePriceOfPictures) {
    Scene s(test::town(4));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 30);
    s.look(region);
    std::vector<double> cut_us;
    for (const float pictures_us : {0.0F, 1500.3F}) {
        select::ItemList items;
        items.prepay({select::ItemKind::pictures, 0, pictures_us, 0});
        select::SelectInput input = s.input(5500);
        input.items = &items;
        input.beside_us = static_cast<double>(pictures_us);
        select::find_selector("threshold")->run(input, s.state, s.cut);
        const Capture taken = take(input, "threshold", memory_of(s), s.cut);
        const auto cut = replay(taken);
        EXPECT_TRUE(verify(taken));
        EXPECT_EQ(cut->predicted_us, s.cut.predicted_us);
        cut_us.push_back(static_cast<double>(s.cut.sum.raster_us));
    }
    EXPECT_LT(cut_us[1], cut_us[0]) << "pictures take their time from forms";
}

TEST(Capture, TheOracleCanBeTriedOnTheSameFrame) {
    const Capture c = captured("threshold");
    const auto best = replay(c, "oracle");
    ASSERT_TRUE(best) << best.error().text();
    EXPECT_GE(best->value, replay(c)->value);
    EXPECT_LE(static_cast<double>(best->predicted_us), c.budget_us);
}

TEST(Capture, MemoryIsPartOfTheDecision) {
    Capture c = captured("two-stage", 5);
    ASSERT_FALSE(c.memory.empty());
    const std::uint64_t with = replay(c)->hash;
    c.memory.clear();
    EXPECT_NE(replay(c)->hash, with);
}

TEST(Capture, TheReserveIsPartOfTheDecision) {
    const TempFile file;
    Scene s(test::town(4));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 30);
    s.look(region);
    s.state.reserve_share = 0.4F;
    s.run("threshold", 5500);
    ASSERT_TRUE(write_capture(file.path, take(s.input(5500), "threshold", memory_of(s), s.cut)));
    auto after = read_capture(file.path);
    ASSERT_TRUE(after) << after.error().text();
    EXPECT_EQ(after->reserve_share, 0.4F);
    EXPECT_TRUE(verify(*after));
    EXPECT_LE(replay(*after)->predicted_us, 0.6F * 5500.0F) << "nothing was on screen: all forms are new";
    after->reserve_share = 0;
    EXPECT_GT(replay(*after)->predicted_us, 0.6F * 5500.0F);
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
    refused([](Capture& c) { c.reserve_share = 1.5F; });
    EXPECT_EQ(tried, 12);
}

TEST(Capture, MissingFileIsNamed) {
    const auto result = read_capture("/nonexistent/frame.capture");
    ASSERT_FALSE(result);
    EXPECT_NE(result.error().text().find("/nonexistent/frame.capture"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::capture
