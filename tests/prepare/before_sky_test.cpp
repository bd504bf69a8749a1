// What has nothing but the sky behind it, and what that makes of values.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "render/prepare/before_sky.hpp"
#include "render/prepare/shown_pixels.hpp"
#include "render/prepare/value.hpp"
#include "tests/prepare/plain_view.hpp"

namespace surefoot::prepare {
namespace {

/// The root has a wood of two trees, and a house: candidates 0, 1 (3, 4) and 2.
std::vector<Candidate> wood_and_house() {
    std::vector<Candidate> tree(5);
    tree[0].first_child = 1;
    tree[0].child_count = 2;
    tree[1].parent = tree[2].parent = 0;
    tree[1].first_child = 3;
    tree[1].child_count = 2;
    tree[3].parent = tree[4].parent = 1;
    for (Index i = 0; i < tree.size(); ++i) {
        tree[i].first_choice = i;
        tree[i].choice_count = 1;
    }
    return tree;
}
constexpr std::uint32_t wood = 1, house = 2, tree_a = 3, tree_b = 4;

TEST(BeforeSky, APointBelongsToTheDeepestNodeThatHoldsAllThatCoversIt) {
    const std::vector<Candidate> candidates = wood_and_house();
    BeforeSky sky;
    sky.reserve(5, 4);
    sky.begin(candidates, {});
    ItemBuffer buffer;
    buffer.clear();
    buffer.cover(0, 0, sky.rank(tree_a));  // alone
    buffer.cover(1, 0, sky.rank(tree_a));
    buffer.cover(1, 0, sky.rank(tree_b));  // a tree behind a tree
    buffer.cover(2, 0, sky.rank(tree_a));
    buffer.cover(2, 0, sky.rank(house));  // a house behind it
    for (int x = 0; x < 3; ++x) sky.show(tree_a, 64, 0.5F, buffer, x, 0);
    const SkyPixels pixels = sky.pixels();
    EXPECT_EQ(pixels.at[tree_a], 32);
    EXPECT_EQ(pixels.at[wood], 32) << "if one tree is missing the other one shows, if the wood is, the sky does";
    EXPECT_EQ(pixels.at[0], 0);
    EXPECT_EQ(pixels.of_leaf[tree_a], 128);
    EXPECT_EQ(pixels.of_leaf[tree_b], 0) << "it shows nothing";
    sky.begin(candidates, {});
    EXPECT_EQ(sky.pixels().of_leaf[tree_a], 0);
}

TEST(BeforeSky, WhatOthersHideIsBehindThem) {
    const std::vector<Candidate> candidates = wood_and_house();
    BeforeSky sky;
    sky.reserve(5, 4);
    const std::array<HiddenNode, 3> hidden{HiddenNode{{-1, -1, 0, 1}, 0},       // the left half, below the root
                                           HiddenNode{{0.5F, -1, 1, 1}, wood},  // a third tree, on the right
                                           HiddenNode{{1, 1, -1, -1}, 0}};      // an empty outline
    sky.begin(candidates, hidden);
    ItemBuffer buffer;
    buffer.clear();
    for (const std::uint32_t leaf : {tree_a, tree_b, house}) {
        for (const int x : {10, 100, 150}) sky.show(leaf, 64, 1, buffer, x, 45);
    }
    const SkyPixels pixels = sky.pixels();
    EXPECT_EQ(pixels.of_leaf[house], 64) << "in the middle alone";
    EXPECT_EQ(pixels.at[house], 64);
    EXPECT_EQ(pixels.of_leaf[tree_a], 128) << "in the middle, and before the hidden tree";
    EXPECT_EQ(pixels.at[tree_a], 64);
    EXPECT_EQ(pixels.at[wood], 128) << "if the wood is missing, so is its hidden tree";
}

TEST(BeforeSky, ALoneRootIsBeforeTheSky) {
    std::vector<Candidate> root(1);
    root[0].choice_count = 1;
    BeforeSky sky;
    sky.reserve(1, 0);
    sky.begin(root, {});
    ItemBuffer buffer;
    buffer.clear();
    sky.show(0, 64, 0.5F, buffer, 3, 4);
    EXPECT_EQ(sky.pixels().of_leaf[0], 64);
    EXPECT_EQ(sky.pixels().at[0], 32);
    sky.begin({}, {});
    EXPECT_TRUE(sky.pixels().at.empty());
}

TEST(BeforeSky, DrawnSurfacesCountAlsoWhereANearerOneShows) {
    const std::vector<Candidate> candidates = wood_and_house();
    for (const bool near_first : {true, false}) {
        BeforeSky sky;
        sky.reserve(5, 0);
        sky.begin(candidates, {});
        ItemBuffer buffer;
        buffer.clear();
        const auto draw = [&](std::uint32_t leaf, float depth) {  // a square of 16 x 9 points in the middle
            model::SeenPiece piece;
            piece.at[0] = {0, 0, depth};
            piece.pixels = 64 * 144;
            buffer.draw({.number = leaf, .seed = leaf, .point_px = 64, .rank = sky.rank(leaf)}, std::span(&piece, 1));
        };
        draw(near_first ? tree_a : house, near_first ? 5 : 9);
        draw(near_first ? house : tree_a, near_first ? 9 : 5);
        ASSERT_EQ(buffer.at(80, 45).item, tree_a);
        sky.show(tree_a, 64, 1, buffer, 80, 45);
        EXPECT_EQ(sky.pixels().of_leaf[tree_a], 0) << "the house is behind, whichever was drawn first";
    }
}

TEST(BeforeSky, SmallLeavesAreJudgedAtTheirMiddle) {
    const std::vector<Candidate> candidates = wood_and_house();
    std::vector<Choice> choices(5);
    std::vector<Weight> weights(5);
    for (Choice& choice : choices) choice.surface_px = 10'000;
    for (Weight& weight : weights) weight.pixel_weight = 1;
    weights[house].distance_m = 50;
    weights[house].outline = {-0.5F, -0.5F, 0.5F, 0};
    weights[tree_a].distance_m = 10;
    weights[tree_a].outline = {-0.4F, -0.4F, -0.2F, -0.2F};  // before the house
    weights[tree_b].distance_m = 10;
    weights[tree_b].outline = {0.2F, 0.2F, 0.4F, 0.4F};  // before the sky
    ShownPixels shown;
    shown.reserve(5);
    const model::ViewScale view_of_sky = test::plain_view();
    const auto px = shown.run(weights, candidates, choices, view_of_sky, view_of_sky);
    const SkyPixels sky = shown.before_sky();
    EXPECT_EQ(sky.of_leaf[tree_a], 0);
    EXPECT_GT(px[tree_b], 0);
    EXPECT_EQ(sky.of_leaf[tree_b], px[tree_b]);
    EXPECT_EQ(sky.at[tree_b], px[tree_b]);

    model::ViewScale quarter = view_of_sky;  // of the wide view: the tree may come into it
    quarter.tan_half_x *= 0.25F;
    quarter.tan_half_y *= 0.25F;
    const auto beside = shown.run(weights, candidates, choices, view_of_sky, quarter);
    EXPECT_GT(beside[tree_b], 0);
    EXPECT_EQ(shown.before_sky().of_leaf[tree_b], 0) << "not in the picture yet";
}

TEST(BeforeSky, WhatIsUncoveredThereLosesAsManyTimesMore) {
    std::vector<Candidate> candidates = wood_and_house();
    PreparedFrame frame;
    frame.candidates = candidates;
    frame.choices.resize(5);
    for (Index i = 0; i < 5; ++i) frame.choices[i].rep = i;
    model::Model model;  // grey things; a missing one loses 0.02 before others, and 0.41 + 0.01 before a sky that is 0.64 lighter
    model.colours = {{0.2F, 0.2F, 0.2F}, 0.01F};
    model.losses.resize(5);
    model.losses[wood] = {0.25F, {0.01F, 0.01F, 0.01F}};
    const Looks looks = looks_of(model, {0.84F, 0.84F, 0.84F});
    EXPECT_NEAR(looks.of_missing, 0.02, 1e-6);
    EXPECT_NEAR(looks.before_sky, (0.64 * 0.64 + 0.01) / 0.02, 1e-3);
    EXPECT_EQ(looks_of(model, {0.2F, 0.2F, 0.2F}).before_sky, 1) << "a sky like the things: no less than other things";
    EXPECT_EQ(looks_of({}, {1, 1, 1}).before_sky, 1) << "no losses are measured";

    std::vector<Weight> weights(5);
    for (Weight& weight : weights) weight.pixel_weight = 0.5F;
    const std::vector<float> shown_px{0, 0, 1000, 400, 600};
    const std::vector<float> of_leaf{0, 0, 0, 400, 200}, at{0, 150, 0, 100, 50};
    ValuePass pass;
    pass.reserve(5);
    const auto run = [&](const SkyPixels& sky) {
        pass.run({.fixed_us = 0, .submit_weight = 1, .raster_weight = 0, .max_weight = 0}, 1e-3F, weights, shown_px, frame, looks,
                 sky);
    };
    run({});
    EXPECT_NEAR(frame.full_value, 1000, 1e-2);
    EXPECT_NEAR(frame.choices[wood].value, 500 * (1 - 0.95 * 0.5), 1e-2);
    run({of_leaf, at});
    const double more = static_cast<double>(looks.before_sky) - 1;
    EXPECT_NEAR(frame.full_value, 1000 + more * 0.5 * 600, 1e-1);
    EXPECT_NEAR(frame.choices[tree_a].value, 200 + more * 0.5 * 400, 1e-1) << "full detail lacks nothing";
    EXPECT_NEAR(frame.choices[wood].value, 500 * (1 - 0.95 * 0.5) + more * (0.5 * 600 - 0.25 * 300), 1e-1);
    EXPECT_NEAR(frame.choices[house].value, 500, 1e-2) << "it has no pixels before the sky";
    EXPECT_NEAR(frame.curve.full_value, frame.full_value, 1e-1);
    frame.choices[wood].error_rad = 1e6F;  // the eye is in it
    run({of_leaf, at});
    EXPECT_NEAR(frame.choices[wood].value, 500 * (1 - 0.05 - 0.95 * 0.5) + more * (0.5 * 600 - 0.5 * 300), 1)
        << "seen from inside, a form is no better than half";
}

}  // namespace
}  // namespace surefoot::prepare
