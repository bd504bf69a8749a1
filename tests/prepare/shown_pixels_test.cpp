// Shown pixels of leaves against values worked out by hand, and the values that follow from them.
#include "render/prepare/shown_pixels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "render/prepare/value.hpp"
#include "tests/model/random_tree.hpp"
#include "tests/prepare/plain_view.hpp"
#include "tests/prepare/random_model.hpp"

namespace surefoot::prepare {
namespace {

constexpr float view_px = 1280.0F * 720.0F;
const model::ViewScale view = test::plain_view();
constexpr Outline whole_view{-1, -1, 1, 1};

/// Leaves below one root, each with one choice.
struct Leaves {
    std::vector<Candidate> candidates{Candidate{}};
    std::vector<Choice> choices{Choice{}};
    std::vector<Weight> weights{Weight{}};
    ShownPixels shown;
    model::ViewScale picture = view;  ///< that surfaces are counted in

    void add(float distance_m, const Outline& outline, float surface_px) {
        Candidate leaf;
        leaf.parent = 0;
        leaf.first_choice = static_cast<Index>(choices.size());
        leaf.choice_count = 1;
        candidates.push_back(leaf);
        Choice choice;
        choice.surface_px = surface_px;
        choices.push_back(choice);
        Weight weight;
        weight.distance_m = distance_m;
        weight.outline = outline;
        weights.push_back(weight);
    }
    std::span<const float> run() {
        candidates[0].first_child = 1;
        candidates[0].child_count = static_cast<std::uint32_t>(candidates.size() - 1);
        candidates[0].choice_count = 1;
        shown.reserve(static_cast<std::uint32_t>(candidates.size()));
        return shown.run(weights, candidates, choices, view, picture);
    }
};

TEST(ShownPixels, OfASurfaceAsLargeAsItsOutlineAreTwoThirds) {
    Leaves leaves;
    leaves.add(10, {-0.5F, -0.5F, 0.5F, 0.5F}, view_px / 4);
    const auto shown = leaves.run();
    EXPECT_EQ(shown[0], 0) << "the root has children";
    EXPECT_NEAR(shown[1], (1 - std::exp(-1.0)) * view_px / 4, 1);
}

TEST(ShownPixels, OfWhatIsBehindAreWhatTheNearerLeftOpen) {
    Leaves leaves;
    leaves.add(20, whole_view, 2 * view_px);  // added first, and yet behind
    leaves.add(10, {-1, -1, 0, 1}, view_px / 2);
    const auto shown = leaves.run();
    const double near = 1 - std::exp(-1.0), far = 1 - std::exp(-2.0);
    EXPECT_NEAR(shown[2], near * view_px / 2, 1);
    EXPECT_NEAR(shown[1], far * ((1 - near) * view_px / 2 + view_px / 2), 1);
}

TEST(ShownPixels, OfEquallyFarLeavesGoByTheirOrder) {
    Leaves leaves;
    leaves.add(10, whole_view, view_px);
    leaves.add(10, whole_view, view_px);
    const auto shown = leaves.run();
    EXPECT_NEAR(shown[1], (1 - std::exp(-1.0)) * view_px, 1);
    EXPECT_NEAR(shown[2], (1 - std::exp(-1.0)) * std::exp(-1.0) * view_px, 1);
}

TEST(ShownPixels, OutsideTheViewAreNoneAndAPartCountsAsFarAsItIsInside) {
    Leaves leaves;
    leaves.add(5, {1.1F, -1, 2, 1}, view_px);
    leaves.add(10, {-3, -1, -0.75F, 1}, 1e9F);
    const auto shown = leaves.run();
    EXPECT_EQ(shown[1], 0);
    EXPECT_NEAR(shown[2], view_px / 8, 1);
}

TEST(ShownPixels, OfWhatIsNotInThePictureYetAreAsOfHalfALayer) {
    Leaves leaves;
    leaves.add(10, {0.5F, -1, 1, 1}, 0);
    EXPECT_NEAR(leaves.run()[1], (1 - std::exp(-0.5)) * view_px / 4, 1);
}

TEST(ShownPixels, OfAnOutlineBesideThePictureAreAsOfHalfALayerThere) {
    Leaves leaves;
    leaves.picture.tan_half_x *= 0.5F;                   // half of the wide view
    leaves.add(10, {0.25F, -1, 0.75F, 1}, view_px / 8);  // one layer on the half of it that is in the picture
    EXPECT_NEAR(leaves.run()[1], (1 - std::exp(-0.75)) * view_px / 4, 1);
    Leaves whole;
    whole.picture = leaves.picture;
    whole.add(10, {-0.25F, -1, 0.25F, 1}, view_px / 4);
    EXPECT_NEAR(whole.run()[1], (1 - std::exp(-1.0)) * view_px / 4, 1) << "wholly in the picture nothing changes";
}

/// Leaves with surfaces, seen from 0 along -z.
struct Solids {
    model::Model model;
    Leaves leaves;

    Solids() {
        model.placements.resize(1);
        model.materials.resize(1);
        model.nodes.resize(1);
        model.reps.resize(1);
    }
    /// Rectangles that face +z: left, low, right, high, z.
    void add(const std::vector<std::array<float, 5>>& rectangles, const Outline& outline, float nearest_m) {
        const auto first = static_cast<std::uint32_t>(model.vertices.size());
        const auto first_index = static_cast<std::uint32_t>(model.indices.size());
        model::Node node;
        for (const auto& [left, low, right, high, z] : rectangles) {
            for (const vec3& at : {vec3(left, low, z), vec3(right, low, z), vec3(right, high, z), vec3(left, low, z),
                                   vec3(right, high, z), vec3(left, high, z)}) {
                model::Vertex v{};
                for (int k = 0; k < 3; ++k) v.position[k] = at[k];
                model.indices.push_back(static_cast<std::uint32_t>(model.vertices.size()) - first);
                model.vertices.push_back(v);
                node.box.grow(dvec3(at));
            }
        }
        const auto count = static_cast<std::uint32_t>(6 * rectangles.size());
        model.parts.push_back({0, first_index, count, first, count});
        model::Representation rep;
        rep.first_part = static_cast<Index>(model.parts.size() - 1);
        rep.part_count = 1;
        rep.triangles = count / 3;
        model.reps.push_back(rep);
        node.first_rep = static_cast<Index>(model.reps.size() - 1);
        node.rep_count = 1;
        model.nodes.push_back(node);
        leaves.add(nearest_m, outline, view_px);
        leaves.candidates.back().node = static_cast<Index>(model.nodes.size() - 1);
        leaves.choices.back().rep = node.first_rep;
    }
    std::span<const float> run() {
        const model::PixelEstimator estimator(model);
        leaves.run();  // reserves
        return leaves.shown.run(leaves.weights, leaves.candidates, leaves.choices, view, view, {&model, &estimator, dvec3(0.0)});
    }
};

TEST(ShownPixels, WhatIsRoundTheEyeDoesNotHideWhatIsBeforeIt) {
    Solids solids;
    // A room: a wall far ahead, and a speck behind the eye, so that its box goes round the eye. A barrel fills a quarter.
    solids.add({{-100, -100, 100, 100, -50}, {0, 0, 0.01F, 0.01F, 5}}, whole_view, 0.05F);
    solids.add({{-1.28F, -0.72F, 1.28F, 0.72F, -4}}, {-0.5F, -0.5F, 0.5F, 0.5F}, 3.9F);
    const auto shown = solids.run();
    EXPECT_NEAR(shown[2], view_px / 4, 0.02F * view_px);
    EXPECT_NEAR(shown[1], 3 * view_px / 4, 0.02F * view_px);
}

TEST(ShownPixels, BehindADrawnWallNothingIsShown) {
    Solids solids;
    solids.add({{-100, -100, 100, 100, -10}}, whole_view, 10);
    solids.add({{-2, -2, 2, 2, -20}}, {-0.15F, -0.25F, 0.15F, 0.25F}, 20);
    solids.add({{-0.1F, -0.1F, 0.1F, 0.1F, -20}}, {-0.008F, -0.014F, 0.008F, 0.014F}, 20);    // a small one behind it
    solids.add({{-0.02F, -0.02F, 0.02F, 0.02F, -4}}, {-0.008F, -0.014F, 0.008F, 0.014F}, 4);  // and before it
    const auto shown = solids.run();
    EXPECT_NEAR(shown[2], 0.001F * 0.15F * 0.25F * view_px, 0.1) << "a thousandth: the order of what may come into sight";
    EXPECT_NEAR(shown[3], 0.001F * 0.008F * 0.014F * view_px, 0.1);
    EXPECT_NEAR(shown[4], 0.008F * 0.014F * view_px, 5);
    EXPECT_NEAR(shown[1] + shown[4], view_px, 0.0011F * view_px) << "the wall shows what the small one leaves open";
}

TEST(ShownPixels, OfPartsOfTilesAddUp) {
    Leaves leaves;
    leaves.add(5, {0.01F, 0.01F, 0.02F, 0.02F}, 1e9F);  // within one tile
    leaves.add(10, whole_view, 1e9F);
    const auto shown = leaves.run();
    EXPECT_NEAR(shown[1], 0.0001F / 4 * view_px, 0.5);
    EXPECT_NEAR(shown[1] + shown[2], view_px, 2);
}

TEST(ShownPixels, AreNoMoreThanTheViewWhateverTheLeaves) {
    Random random(7);
    constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    constexpr std::array odd{0.0F, -1.0F, 1e30F, -1e30F, inf, -inf, nan};
    for (int round = 0; round < 300; ++round) {
        Leaves leaves;
        const auto number = [&](double low, double high) {
            return round % 2 == 1 && random.below(8) == 0 ? odd[random.below(odd.size())]
                                                          : static_cast<float>(random.range(low, high));
        };
        for (std::uint32_t i = random.below(60); i-- > 0;) {
            const float left = number(-1.5, 1), low = number(-1.5, 1);
            leaves.add(static_cast<float>(random.range(1, 100)), {left, low, left + number(0, 1), low + number(0, 1)},
                       number(0, 4 * static_cast<double>(view_px)));
        }
        double sum = 0;
        for (const float px : leaves.run()) {
            ASSERT_GE(px, 0) << "and a number";
            sum += static_cast<double>(px);
        }
        ASSERT_LE(sum, 1.0001 * static_cast<double>(view_px));
    }
}

/// One leaf below a root, which has a coarse form of half of the leaf's surface.
TEST(Value, IsByShownPixelsAndLostSurface) {
    PreparedFrame frame;
    frame.candidates.resize(2);
    frame.candidates[0].first_child = 1;
    frame.candidates[0].child_count = 1;
    frame.candidates[0].choice_count = 1;
    frame.candidates[1].parent = 0;
    frame.candidates[1].first_choice = 1;
    frame.candidates[1].choice_count = 2;
    frame.choices.resize(3);
    const std::array<float, 3> surface_px{500, 800, 1000}, error_px{256, 64, 0};
    for (std::size_t i = 0; i < 3; ++i) {
        frame.choices[i].surface_px = surface_px[i];
        frame.choices[i].error_rad = 1e-3F * error_px[i];
        frame.choices[i].cost.submit_us = static_cast<float>(10 * (i + 1));
    }
    std::vector<Weight> weights(2);
    weights[0].distance_m = weights[1].distance_m = 10;
    weights[1].pixel_weight = 0.5F;
    const std::vector<float> shown_px{0, 600};
    ValuePass pass;
    pass.reserve(2);
    pass.run({.fixed_us = 0, .submit_weight = 1, .raster_weight = 0, .max_weight = 0}, 1e-3F, weights, shown_px, frame);
    EXPECT_NEAR(frame.choices[2].value, 300, 1e-3) << "full detail lacks nothing";
    EXPECT_NEAR(frame.choices[1].value, 300 * (1 - 0.25 * 64 / 320 - 0.75 * 0.2), 1e-3);
    EXPECT_NEAR(frame.choices[0].value, 300 * (1 - 0.25 * 0.5 - 0.75 * 0.5), 1e-3);
    EXPECT_NEAR(frame.full_value, 300, 1e-3);

    // With measured losses: the root is 64 pixels across, the leaf 8. Two colours of the model differ by 0.4.
    model::Model looks;
    looks.losses = {{0, {0, 0.1F, 0}}, {0, {0, 0, 0.05F}}, {}};
    looks.colours.variance = 0.2F;
    weights[0].size_m = 0.64F;
    weights[1].size_m = 0.08F;
    for (Index r = 0; r < 3; ++r) frame.choices[r].rep = r;
    const auto value_again = [&] {
        pass.run({.fixed_us = 0, .submit_weight = 1, .raster_weight = 0, .max_weight = 0}, 1e-3F, weights, shown_px, frame,
                 looks_of(looks, {}));
    };
    value_again();
    EXPECT_NEAR(frame.choices[2].value, 300, 1e-3);
    EXPECT_NEAR(frame.choices[1].value, 300 * (1 - 0.05 * 64 / 320 - 0.95 * 0.125), 1e-2);
    EXPECT_NEAR(frame.choices[0].value, 300 * (1 - 0.05 * 0.5 - 0.95 * 0.25), 1e-2);
    looks.losses[0].colour[1] = 1;
    value_again();
    EXPECT_NEAR(frame.choices[0].value, 300 * (1 - 0.05 * 0.5 - 0.95), 1e-2) << "no worse than missing";
}

TEST(Value, OfAClustersFormGoesByTheGroupsThatAreSeen) {
    model::Model m;  // a cluster of two leaves; its form is right on the first and shows nothing of the second
    m.nodes.resize(3);
    m.nodes[0].child_count = 2;
    m.nodes[0].first_child = 1;
    for (Index i = 0; i < 3; ++i) {
        m.nodes[i].first_rep = i;
        m.nodes[i].rep_count = 1;
        if (i > 0) m.nodes[i].parent = 0;
    }
    m.losses = {{0.5F, {0.2F, 0.2F, 0.2F}}, {}, {}};
    m.colours.variance = 0.2F;
    m.group_losses = {{{0, 0, 0}}, {{0.4F, 0.4F, 0.4F}}};
    PreparedFrame frame;
    frame.candidates.resize(3);
    frame.choices.resize(3);
    for (Index i = 0; i < 3; ++i) {
        frame.candidates[i].node = i;
        frame.candidates[i].first_choice = i;
        frame.candidates[i].choice_count = 1;
        frame.choices[i].rep = i;
        if (i > 0) frame.candidates[i].parent = 0;
    }
    frame.candidates[0].first_child = 1;
    frame.candidates[0].child_count = 2;
    std::vector<Weight> weights(3);
    for (Weight& weight : weights) weight.distance_m = 10, weight.pixel_weight = 1, weight.size_m = 1;
    const model::LossGroups groups(m);
    ValuePass pass;
    pass.reserve(3, 3);
    const auto value_where = [&](float first_px, float second_px, const model::LossGroups* by) {
        pass.run({.fixed_us = 0, .submit_weight = 1, .raster_weight = 0, .max_weight = 0}, 1e-3F, weights,
                 std::vector<float>{0, first_px, second_px}, frame, looks_of(m, {}, by));
        return frame.choices[0].value;
    };
    EXPECT_NEAR(value_where(500, 500, nullptr), 1000 * (1 - 0.95 * 0.5), 1e-1) << "the cluster's mean";
    EXPECT_NEAR(value_where(500, 500, &groups), 1000 * (1 - 0.95 * 0.5), 1e-1) << "is that of its groups";
    EXPECT_NEAR(value_where(900, 100, &groups), 1000 * (1 - 0.95 * 0.1), 1e-1);
    EXPECT_NEAR(value_where(0, 100, &groups), 100 * (1 - 0.95), 1e-1) << "only what is missing is seen";
    EXPECT_NEAR(value_where(100, 0, &groups), 100, 1e-1);
    frame.candidates[0].child_count = 0;  // cut off by a limit: its groups are not known
    frame.candidates.resize(1);
    frame.choices.resize(1);
    weights.resize(1);
    pass.run({.fixed_us = 0, .submit_weight = 1, .raster_weight = 0, .max_weight = 0}, 1e-3F, weights, std::vector<float>{1000},
             frame, looks_of(m, {}, &groups));
    EXPECT_NEAR(frame.choices[0].value, 1000 * (1 - 0.95 * 0.5), 1e-1);
}

/// A tree of clusters of up to eight, breadth first, with two forms a cluster, and losses of its groups. Each node is a
/// candidate.
struct GroupedTree {
    model::Model m;
    PreparedFrame frame;
    explicit GroupedTree(Random& random, std::size_t nodes) : m(test::random_tree(random, nodes)) {
        for (Index n = 0; n < m.nodes.size(); ++n) {
            model::Node& node = m.nodes[n];
            node.first_rep = static_cast<Index>(m.losses.size());
            node.rep_count = node.child_count > 0 ? 2 : 1;
            m.losses.resize(m.losses.size() + node.rep_count);
            Candidate& candidate = frame.candidates.emplace_back();
            candidate.node = n;
            candidate.parent = n == 0 ? none : node.parent;
            candidate.first_child = node.child_count > 0 ? node.first_child : none;
            candidate.child_count = node.child_count;
            candidate.first_choice = static_cast<Index>(frame.choices.size());
            candidate.choice_count = 1;  // of two forms the second: choices are some of the forms
            frame.choices.emplace_back().rep = node.first_rep + node.rep_count - 1;
        }
        m.colours.variance = 0.5F;
        m.group_losses.resize(model::LossGroups(m).size());
        for (model::LossOfGroup& loss : m.group_losses) loss.colour.fill(static_cast<float>(random.unit()));
    }
};

TEST(Value, OfAClustersFormIsTheMeanOverItsGroupsInAnyTree) {
    Random random(11);
    const GroupedTree tree(random, 900);
    const model::LossGroups groups(tree.m);
    const auto n = static_cast<Index>(tree.m.nodes.size());
    std::vector<float> shown_px(n, 0);
    std::vector<Weight> weights(n);
    for (Index i = 0; i < n; ++i) {
        weights[i].distance_m = 10, weights[i].pixel_weight = 1, weights[i].size_m = 1;
        if (tree.m.nodes[i].child_count == 0 && random.unit() < 0.7) shown_px[i] = static_cast<float>(100 * random.unit());
    }
    std::vector<double> weight(n, 0), lost(n, 0);
    for (Index leaf = 0; leaf < n; ++leaf) {
        for (Index a = tree.m.nodes[leaf].parent; shown_px[leaf] > 0 && a != none; a = tree.m.nodes[a].parent) {
            const std::size_t entry = groups.first(a) + groups.count(a) + groups.slot_of(leaf, a);  // of the second form
            weight[a] += static_cast<double>(shown_px[leaf]);
            lost[a] += static_cast<double>(shown_px[leaf]) * static_cast<double>(tree.m.group_losses[entry].colour[0]);
        }
    }
    PreparedFrame frame = tree.frame;
    ValuePass pass;
    pass.reserve(n, frame.choices.size());
    pass.run({.fixed_us = 0, .submit_weight = 1, .raster_weight = 0, .max_weight = 0}, 1e-3F, weights, shown_px, frame,
             looks_of(tree.m, {}, &groups));
    std::size_t compared = 0;
    for (Index a = 0; a < n; ++a) {
        if (tree.m.nodes[a].child_count == 0 || weight[a] == 0) continue;
        EXPECT_NEAR(frame.choices[a].value, weight[a] - 0.95 * lost[a], 1e-3 * weight[a]) << a;
        ++compared;
    }
    EXPECT_GT(compared, 50U);
    EXPECT_LT(groups.count(0), 8 * model::LossGroups::parts * 2) << "the root's groups are clusters";
}

TEST(ShownPixels, BehindTheEyeThereIsNoOutline) {
    const model::Model m = test::town(3);
    const model::CostModel prices = model::default_costs();
    const Evaluator evaluator(m, prices);
    const model::Node& node = m.nodes.back();
    std::vector<Choice> choices(node.rep_count + 1);
    Candidate candidate;
    candidate.node = static_cast<Index>(m.nodes.size() - 1);
    for (const double side : {-1.0, 1.0}) {
        RegionView from;
        from.eye = node.box.centre() + dvec3(0, 0, side * (node.box.half().z + 5));
        Weight weight;
        evaluator.evaluate(from, nearest_distance(from, node.box), candidate, choices.data(), weight);
        EXPECT_EQ(weight.outline.right > weight.outline.left, side > 0) << "the view looks along -z";
    }
}

TEST(Value, OfFullDetailIsNoMoreThanTheView) {
    const model::Model m = test::town(7);
    const model::CostModel prices = model::default_costs();
    Preparer preparer(m, prices, {});
    PreparedFrame frame;
    preparer.reserve(frame);
    Region region;
    region.centre.position = dvec3(0, 3, 60);
    preparer.run(region, {1280, 720}, 0, 0, 0, frame);
    EXPECT_GT(frame.full_value, 0);
    EXPECT_LE(frame.full_value, static_cast<double>(view_px)) << "no pixel counts twice";
}

}  // namespace
}  // namespace surefoot::prepare
