// Values, rates and the selector that goes by them, against every cut of small trees.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "render/prepare/tree_passes.hpp"
#include "render/prepare/value.hpp"
#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

using test::Scene;

struct Point {
    double cost = 0, value = 0;
};

/// Keeps the points that no other one beats in both cost and value.
std::vector<Point> undominated(std::vector<Point> points) {
    std::sort(points.begin(), points.end(),
              [](const Point& a, const Point& b) { return a.cost != b.cost ? a.cost < b.cost : a.value > b.value; });
    std::vector<Point> front;
    for (const Point& p : points)
        if (front.empty() || p.value > front.back().value) front.push_back(p);
    return front;
}

/// All cuts of a candidate's subtree that are worth their cost. Only submission costs here, so costs add up.
std::vector<Point> cuts_below(const prepare::PreparedFrame& frame, model::Index at) {
    const prepare::Candidate& candidate = frame.candidates[at];
    std::vector<Point> points;
    for (std::uint32_t k = 0; k < candidate.choice_count; ++k) {
        const prepare::Choice& choice = frame.choices[candidate.first_choice + k];
        points.push_back({static_cast<double>(choice.cost.submit_us), static_cast<double>(choice.value)});
    }
    if (candidate.child_count > 0) {
        std::vector<Point> sums{{0, 0}};
        for (std::uint32_t k = 0; k < candidate.child_count; ++k) {
            std::vector<Point> more;
            for (const Point& below : cuts_below(frame, candidate.first_child + k))
                for (const Point& sum : sums) more.push_back({sum.cost + below.cost, sum.value + below.value});
            sums = undominated(std::move(more));
        }
        points.insert(points.end(), sums.begin(), sums.end());
    }
    return undominated(std::move(points));
}

/// Small random trees seen from random poses, where only submission costs.
template <class Use>
void for_small_trees(std::uint64_t trees, const Use& use) {
    Random random(23);
    for (std::uint64_t seed = 0; seed < trees; ++seed) {
        Scene s(test::random_model(seed, 2 + random.below(24)));
        s.costs.combine = {.fixed_us = 0, .submit_weight = 1, .raster_weight = 0, .max_weight = 0};
        s.costs.slice_us = 0;
        s.costs.headroom = 1;
        s.state.hysteresis = 1;
        prepare::Region region{test::random_pose(random), 0.1, 0.02};
        region.centre.position *= 0.4;
        s.look(region);
        if (!s.frame.candidates.empty() && s.frame.full_value > 0) use(s, random);
    }
}

TEST(Value, RatesFallAndValuesRise) {
    for_small_trees(500, [](Scene& s, Random&) {
        for (const prepare::Candidate& candidate : s.frame.candidates) {
            float rate = std::numeric_limits<float>::infinity(), value = 0;
            if (candidate.parent != model::none) {
                const prepare::Candidate& parent = s.frame.candidates[candidate.parent];
                rate = s.frame.choices[parent.first_choice + parent.choice_count - 1].rate;
            }
            for (std::uint32_t k = 0; k < candidate.choice_count; ++k) {
                const prepare::Choice& choice = s.frame.choices[candidate.first_choice + k];
                ASSERT_TRUE(std::isfinite(choice.value) && std::isfinite(choice.rate));
                ASSERT_GE(choice.value, value);
                ASSERT_LE(choice.rate, rate);
                value = choice.value;
                rate = choice.rate;
            }
        }
    });
}

/// Whether each node's coarsest choice is no dearer than its children's coarsest together. Else a cut that opens the node at once
/// may be the best at a high rate, while one that shows it is the best at a lower rate. Rates that fall cannot say both.
bool coarse_is_cheap(const prepare::PreparedFrame& frame) {
    for (const prepare::Candidate& candidate : frame.candidates) {
        float children = 0;
        for (std::uint32_t k = 0; k < candidate.child_count; ++k)
            children += frame.choices[frame.candidates[candidate.first_child + k].first_choice].cost.submit_us;
        if (candidate.child_count > 0 && frame.choices[candidate.first_choice].cost.submit_us > children) return false;
    }
    return true;
}

TEST(Value, TheCurveIsTheBestCutAtEachRate) {
    int inner = 0;
    for_small_trees(1000, [&](Scene& s, Random&) {
        if (s.frame.candidates[0].child_count == 0) return;  // the curve is of trees
        const bool cheap = coarse_is_cheap(s.frame);
        inner += cheap ? 1 : 0;
        const std::vector<Point> cuts = cuts_below(s.frame, 0);
        for (std::uint32_t level = 0; level + 1 < prepare::value_levels; ++level) {
            const double rate = std::ldexp(1.0, 20 - static_cast<int>(level));
            double best = -std::numeric_limits<double>::infinity();
            for (const Point& cut : cuts) best = std::max(best, cut.value - rate * cut.cost);
            const double found =
                static_cast<double>(s.frame.curve.value[level]) - rate * static_cast<double>(s.frame.curve.cost[level]);
            ASSERT_LE(found, best + 1e-4 * std::abs(best) + 1e-3);
            if (!cheap) continue;
            ASSERT_GE(found, best - 1e-2 * std::abs(best) - 1e-2 * static_cast<double>(s.frame.curve.full_value));
        }
        ASSERT_NEAR(static_cast<double>(s.frame.curve.value_at(1e9F)), s.frame.full_value, 1e-3 * s.frame.full_value);
    });
    EXPECT_GT(inner, 200);
}

TEST(Value, ThresholdIsNearTheOptimumOfSmallTrees) {
    double sum = 0, sum_two_stage = 0, worst = 1;
    int trees = 0;
    for_small_trees(3000, [&](Scene& s, Random& random) {
        const std::vector<Point> cuts = cuts_below(s.frame, 0);
        const double floor = static_cast<double>(s.run("threshold", 0).sum.submit_us), full = cuts.back().cost;
        if (!(full > 1.05 * floor)) return;
        const double budget = floor + (full - floor) * random.unit();
        double optimum = 0;
        for (const Point& cut : cuts)
            if (cut.cost <= budget) optimum = std::max(optimum, cut.value);
        if (!(optimum > 0)) return;  // the floor shows nothing
        s.forget();
        const double share = s.run("threshold", budget).value / optimum;
        ASSERT_LE(s.cut.sum.submit_us, budget * (1 + 1e-5));
        ASSERT_LE(share, 1 + 1e-5);
        s.forget();
        sum_two_stage += s.run("two-stage", budget).value / optimum;
        sum += share;
        worst = std::min(worst, share);
        ++trees;
    });
    std::printf("share of the optimum's value: threshold %.3f (least %.2f), two-stage %.3f, %d trees\n", sum / trees, worst,
                sum_two_stage / trees, trees);
    EXPECT_GT(trees, 1000);
    EXPECT_GE(sum / trees, 0.99);
    EXPECT_GT(sum, sum_two_stage);
}

TEST(Value, OddCostsAndValuesStayFinite) {
    for (const float bad : {0.0F, std::nanf(""), std::numeric_limits<float>::infinity(), -1.0F}) {
        for_small_trees(50, [&](Scene& s, Random& random) {
            const prepare::PreparedFrame good = s.frame;
            for (const std::string_view name : selector_names()) {
                s.frame = good;
                for (prepare::Choice& choice : s.frame.choices)
                    if (random.unit() < 0.5) (random.unit() < 0.5 ? choice.cost.submit_us : choice.cost.raster_us) = bad;
                s.frame.candidates[0].children_cost.raster_us = bad;
                for (const double budget : {0.0, 1000.0, 1e9}) EXPECT_EQ(check_legal(s.frame, s.run(name, budget)), "") << name;
            }
            s.frame = good;
            for (prepare::Choice& choice : s.frame.choices) choice.value = choice.rate = bad;
            const Cut& cut = s.run("threshold", 1000);
            EXPECT_EQ(check_legal(s.frame, cut), "");
            for (prepare::Choice& choice : s.frame.choices) choice.error_rad = bad;
            prepare::estimate_values(s.costs.combine, s.frame);
            EXPECT_EQ(check_legal(s.frame, s.run("threshold", 1000)), "");
        });
    }
}

/// Candidate `leaf` below the root, with so many choices from `first_choice` on.
void add_leaf(prepare::PreparedFrame& frame, model::Index leaf, model::Index first_choice, std::uint32_t choices) {
    prepare::Candidate& candidate = frame.candidates[leaf];
    candidate.node = leaf;
    candidate.parent = 0;
    candidate.first_choice = first_choice;
    candidate.choice_count = choices;
}

/// Equal leaves below a root, each with a coarse form, one for 95 % of full detail's cost and half of its value, and full detail.
prepare::PreparedFrame leaves_with_a_dear_form(model::Index leaves, const model::FrameCombine& combine) {
    prepare::PreparedFrame frame;
    frame.candidates.resize(leaves + 1);
    frame.choices.resize(3 * leaves + 1);
    frame.choices[0].cost.submit_us = 1;
    frame.choices[0].error_rad = 1;
    frame.candidates[0].first_child = 1;
    frame.candidates[0].child_count = leaves;
    frame.candidates[0].choice_count = 1;
    const std::array<float, 3> cost_us{10, 95, 100}, surface_px{100, 500, 1000}, error_rad{2e-3F, 1e-3F, 0};
    for (model::Index leaf = 1; leaf <= leaves; ++leaf) {
        const model::Index first = 3 * leaf - 2;
        add_leaf(frame, leaf, first, 3);
        for (std::uint32_t k = 0; k < 3; ++k) {
            prepare::Choice& choice = frame.choices[first + k];
            choice.rep = 3 * leaf + k;
            choice.cost.submit_us = cost_us[k];
            choice.surface_px = surface_px[k];
            choice.error_rad = error_rad[k];
        }
    }
    std::vector<prepare::Weight> weights(leaves + 1);
    for (prepare::Weight& weight : weights) weight.pixel_weight = 1;
    const std::vector<float> shown_px(leaves + 1, 1000.0F);
    prepare::ValuePass pass;
    pass.reserve(leaves + 1);
    pass.run(combine, 1e-3F, weights, shown_px, frame);
    prepare::propagate_up(combine, 1e-3F, weights, frame);
    return frame;
}

TEST(Value, AFormThatIsHardlyCheaperThanTheNextFinerOneIsNoStopForTheDefault) {
    constexpr model::Index leaves = 8;
    model::Model nodes_only;
    nodes_only.nodes.resize(leaves + 1);
    model::CostModel costs;
    costs.combine = {0, 1, 0, 0};
    costs.headroom = 1;
    costs.slice_us = 0;
    const prepare::PreparedFrame frame = leaves_with_a_dear_form(leaves, costs.combine);
    EXPECT_EQ(frame.choices[1].rate, frame.choices[2].rate) << "off the hull: one step for the search";
    SelectState state;
    state.hysteresis = 1;
    Cut cut;
    reserve(cut, leaves + 1);
    std::size_t max_finest = 0;
    for (double budget_us = 81; budget_us < 820; budget_us += 3) {
        state.reserve(nodes_only, leaves + 1);
        find_selector(usual_selector)->run({&nodes_only, &frame, &costs, budget_us, 1.0, 0, 1000.0}, state, cut);
        std::array<std::size_t, 3> shown{};
        for (const CutItem& item : cut.items)
            if (item.candidate > 0) ++shown[item.choice - frame.candidates[item.candidate].first_choice];
        EXPECT_LE(shown[1], 1U) << "at the budget's edge alone, with " << budget_us;
        max_finest = std::max(max_finest, shown[2]);
    }
    EXPECT_EQ(max_finest, leaves);
}

/// Twenty leaves that win 40 pixels for 2 us each, and one that wins 1000 for 60 us.
prepare::PreparedFrame cheap_leaves_and_a_dear_one() {
    constexpr model::Index leaves = 21;
    prepare::PreparedFrame frame;
    frame.candidates.resize(leaves + 1);
    frame.choices.resize(2 * leaves + 1);
    prepare::Candidate& root = frame.candidates[0];
    root.first_child = 1;
    root.child_count = leaves;
    root.choice_count = 1;
    root.children_cost.submit_us = leaves;
    frame.choices[0].cost.submit_us = 1;
    frame.choices[0].rate = 20;
    for (model::Index leaf = 1; leaf <= leaves; ++leaf) {
        const bool dear = leaf == leaves;
        const model::Index first = 2 * leaf - 1;
        add_leaf(frame, leaf, first, 2);
        for (std::uint32_t k = 0; k < 2; ++k) {
            frame.choices[first + k].rep = 2 * leaf + k;
            frame.choices[first + k].cost.submit_us = k == 0 ? 1.0F : dear ? 61.0F : 3.0F;
        }
        frame.choices[first].rate = dear ? 1000.0F / 60 : 20;
        frame.choices[first + 1].value = dear ? 1000 : 40;
        frame.full_cost.submit_us += dear ? 61.0F : 3.0F;
    }
    return frame;
}

TEST(Value, CheapStepsDoNotKeepADearOneOutThatIsWorthMore) {
    const prepare::PreparedFrame frame = cheap_leaves_and_a_dear_one();
    model::Model nodes_only;
    nodes_only.nodes.resize(frame.candidates.size());
    model::CostModel costs;
    costs.combine = {0, 1, 0, 0};
    costs.headroom = 1;
    costs.slice_us = 0;
    SelectState state;
    Cut cut;
    reserve(cut, 22);
    const auto value_at = [&](double budget_us) {
        find_selector(usual_selector)->run({&nodes_only, &frame, &costs, budget_us, 1.0, 0, 1000.0}, state, cut);
        EXPECT_EQ(check_legal(frame, cut), "");
        EXPECT_LE(static_cast<double>(cut.predicted_us), budget_us);
        return cut.value;
    };
    state.hysteresis = 1;
    state.reserve(nodes_only, 22);
    EXPECT_EQ(value_at(80), 20 * 40) << "the dear one does not fit";
    EXPECT_EQ(value_at(82), 1000) << "21 of coarse leaves, 60 for the dear one: alone worth more than all others";
    EXPECT_EQ(value_at(90), 1000 + 4 * 40) << "what is left buys cheap ones";
    EXPECT_EQ(value_at(200), 1000 + 20 * 40);
    state.hysteresis = 1.25F;
    state.reserve(nodes_only, 22);
    EXPECT_EQ(value_at(82), 20 * 40) << "a step that is new may use 97 %";
    EXPECT_EQ(value_at(85), 1000 + 40) << "and one that was shown before";
    EXPECT_EQ(value_at(81.5), 1000) << "the dear one was shown before: it stays";
    EXPECT_EQ(value_at(80), 20 * 40);
}

/// A root whose form shows 500 pixels; opened, a wall shows 10 in its coarse form and 1000 in its fine one, and a lamp shows 5.
prepare::PreparedFrame wall_that_is_worse_coarse() {
    prepare::PreparedFrame frame;
    frame.candidates.resize(3);
    frame.choices.resize(4);
    prepare::Candidate& root = frame.candidates[0];
    root.first_child = 1;
    root.child_count = 2;
    root.choice_count = 1;
    root.children_cost.submit_us = 4;
    add_leaf(frame, 1, 1, 2);
    add_leaf(frame, 2, 3, 1);
    const std::array<float, 4> costs{2, 2, 60, 2}, values{500, 10, 1000, 5}, rates{505.0F / 60, 505.0F / 60, 0, 0};
    for (std::size_t k = 0; k < 4; ++k) {
        frame.choices[k].rep = static_cast<model::Index>(k);
        frame.choices[k].cost.submit_us = costs[k];
        frame.choices[k].value = values[k];
        frame.choices[k].rate = rates[k];
    }
    frame.full_cost.submit_us = 62;
    return frame;
}

/// What a selection of these three nodes needs: costs are sums of submission.
struct Selecting {
    model::Model model;
    model::CostModel costs;
    SelectState state;
    Cut cut;
    Selecting() {
        model.nodes.resize(3);
        costs.combine = {0, 1, 0, 0};
        costs.headroom = 1;
        costs.slice_us = 0;
        state.hysteresis = 1;
        state.reserve(model, 3);
        reserve(cut, 3);
    }
    double value_of(const prepare::PreparedFrame& frame, double budget_us) {
        find_selector(usual_selector)->run({&model, &frame, &costs, budget_us, 1.0, 0, 1000.0}, state, cut);
        EXPECT_EQ(check_legal(frame, cut), "");
        EXPECT_LE(static_cast<double>(cut.predicted_us), budget_us);
        return cut.value;
    }
};
double value_of(const prepare::PreparedFrame& frame, double budget_us) { return Selecting().value_of(frame, budget_us); }

/// At 61 us, after a frame of `before_us`.
double value_after(const prepare::PreparedFrame& frame, double before_us, float hysteresis) {
    Selecting one;
    one.state.hysteresis = hysteresis;
    one.state.reserve_share = 0;
    one.value_of(frame, before_us);
    return one.value_of(frame, 61);
}

TEST(Value, StepsThatLoseAreUndoneWhereTheDearOneBehindThemDoesNotFit) {
    const prepare::PreparedFrame frame = wall_that_is_worse_coarse();
    Selecting selecting;
    const auto value_at = [&](double budget_us) { return selecting.value_of(frame, budget_us); };
    EXPECT_EQ(value_at(61), 500) << "opened, it would show 15";
    EXPECT_EQ(value_at(63), 1005);
    EXPECT_EQ(value_at(61), 500);

    prepare::PreparedFrame changed = frame;
    changed.choices[0].value = 15 * 1.29F;
    EXPECT_EQ(value_of(changed, 61), 15) << "not clearly worse";
    changed.choices[0].value = 15 * 1.31F;
    EXPECT_EQ(value_of(changed, 61), changed.choices[0].value);
    changed = frame;
    changed.choices[0].cost.submit_us = 5;  // the coarse children cost 4
    EXPECT_EQ(value_of(changed, 61), 15) << "it may not cost more";
}

TEST(Value, WhatWasOpenedStaysUnlessTheFormAboveIsClearlyBetter) {
    prepare::PreparedFrame frame = wall_that_is_worse_coarse();
    frame.choices[0].value = 15 * 1.305F;
    EXPECT_EQ(value_after(frame, 63, 1.25F), 15) << "the last frame showed the children: they count 1 % more";
    EXPECT_EQ(value_after(frame, 63, 1), frame.choices[0].value) << "without hysteresis the last frame is forgotten";
    EXPECT_EQ(value_after(frame, 61, 1.25F), frame.choices[0].value) << "the last frame showed the root";
}

TEST(Value, ATargetAccuracyIsNotUndone) {
    prepare::PreparedFrame frame = wall_that_is_worse_coarse();
    frame.choices[0].error_rad = frame.choices[1].error_rad = 1;
    Selecting one;
    Cut& cut = one.cut;
    find_selector(usual_selector)->run({&one.model, &frame, &one.costs, 61, 1.0, 1e-9, 1000.0}, one.state, cut);
    EXPECT_EQ(cut.value, 15) << "the children were asked for";
}

}  // namespace
}  // namespace surefoot::select
