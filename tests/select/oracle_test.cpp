// The oracle against every cut of small trees; the selectors against the oracle.
#include "render/select/oracle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

using test::Scene;

/// Value and costs of a whole cut.
struct Whole {
    double value = 0, submit_us = 0, raster_us = 0;
};

/// Every legal cut of a candidate's subtree; empty: there are more than `max`.
std::vector<Whole> all_cuts(const prepare::PreparedFrame& frame, Index at, std::size_t max) {
    const prepare::Candidate& c = frame.candidates[at];
    std::vector<Whole> cuts;
    for (std::uint32_t k = 0; k < c.choice_count; ++k) {
        const prepare::Choice& choice = frame.choices[c.first_choice + k];
        cuts.push_back({choice.value, choice.cost.submit_us, choice.cost.raster_us});
    }
    if (c.child_count == 0) return cuts;
    std::vector<Whole> sums{{}};
    for (std::uint32_t k = 0; k < c.child_count; ++k) {
        const std::vector<Whole> below = all_cuts(frame, c.first_child + k, max);
        if (below.empty() || sums.size() * below.size() > max) return {};
        std::vector<Whole> more;
        for (const Whole& a : sums)
            for (const Whole& b : below)
                more.push_back({a.value + b.value, a.submit_us + b.submit_us, a.raster_us + b.raster_us});
        sums = std::move(more);
    }
    cuts.insert(cuts.end(), sums.begin(), sums.end());
    return cuts;
}

double predicted_us(const Scene& s, double submit_us, double raster_us) {
    const model::FrameCombine& c = s.costs.combine;
    const double items =
        submit_us * c.submit_weight + raster_us * c.raster_weight + std::max(submit_us, raster_us) * c.max_weight;
    const double end = c.submit_weight * s.costs.slice_us;
    return (c.fixed_us + end + items * (1.0 + end / 1000.0)) * s.costs.headroom;
}

std::uint32_t leaves_of(const prepare::PreparedFrame& frame) {
    return static_cast<std::uint32_t>(std::count_if(frame.candidates.begin(), frame.candidates.end(),
                                                    [](const prepare::Candidate& c) { return c.child_count == 0; }));
}

/// Random trees whose cost is the larger of two sums, with a budget between floor and full detail.
template <class Use>
void for_trees(std::uint64_t trees, std::uint32_t max_nodes, const Use& use) {
    Random random(41);
    for (std::uint64_t seed = 0; seed < trees; ++seed) {
        Scene s(test::random_model(seed, 2 + static_cast<int>(random.below(max_nodes))));
        s.costs.combine = {static_cast<float>(random.range(0, 300)), 1.0F, static_cast<float>(random.range(0, 1)),
                           random.below(3) == 0 ? 0.0F : static_cast<float>(random.range(0, 3))};
        s.state.hysteresis = 1;
        prepare::Region region{test::random_pose(random), 0.1, 0.02};
        region.centre.position *= 0.4;
        s.look(region);
        if (s.frame.candidates.empty() || !(s.frame.full_value > 0)) continue;
        const double full = static_cast<double>(s.run("flat", test::infinity).predicted_us);
        const double floor = static_cast<double>(s.run("two-stage", 0).predicted_us);
        if (full > 1.05 * floor) use(s, floor + (full - floor) * random.unit());
    }
}

TEST(Oracle, IsTheOptimumOfEveryCutAndItsBoundIsOne) {
    int trees = 0, open = 0, tighter = 0;
    double tightest = 0;
    for_trees(4000, 12, [&](Scene& s, double budget) {
        const std::vector<Whole> cuts = all_cuts(s.frame, 0, 20000);
        if (cuts.empty()) return;
        double optimum = -1;
        for (const Whole& cut : cuts)
            if (predicted_us(s, cut.submit_us, cut.raster_us) * (1 + 2e-6) <= budget) optimum = std::max(optimum, cut.value);
        if (optimum < 0) return;  // nothing fits for sure
        const double near = 1e-5 * optimum + 1e-6;
        s.forget();
        const Optimum exact = find_optimum(s.input(budget), s.state, s.cut);
        ASSERT_TRUE(exact.proven);
        ASSERT_GE(exact.value, optimum - near);
        ASSERT_EQ(check_legal(s.frame, s.cut), "");
        ASSERT_LE(static_cast<double>(s.cut.predicted_us), budget);
        const Optimum loose = find_optimum(s.input(budget), s.state, s.cut, {.exact_leaves = 0, .max_steps = 0, .max_parts = 0});
        ASSERT_GE(loose.bound, optimum - near);
        ASSERT_LE(loose.value, exact.value + near);
        ASSERT_GE(loose.value, s.run("threshold", budget).value - near);
        const Optimum split = find_optimum(s.input(budget), s.state, s.cut, {.exact_leaves = 0, .max_steps = 0, .max_parts = 30});
        ASSERT_GE(split.bound, optimum - near) << "of parts";
        ASSERT_LE(split.bound, loose.bound * (1 + 1e-9));
        ASSERT_GE(split.value, loose.value - near);
        ++trees;
        if (!loose.proven) ++open;
        if (split.bound < 0.999 * loose.bound) ++tighter;
        tightest = std::max(tightest, exact.value / loose.bound);
    });
    EXPECT_GT(trees, 1000);
    EXPECT_GT(open, 100) << "bounds that were not proven were looked at too";
    EXPECT_GT(tighter, 100) << "splitting brings bounds down";
    EXPECT_GT(tightest, 0.999);
}

/// Mean share of the optimum by threshold and two-stage. Two of five random trees have a budget to divide and at most 16 leaves.
void expect_near_the_optimum(std::uint64_t trees) {
    double threshold = 0, two_stage = 0, min_share = 1;
    std::uint64_t count = 0, steps = 0;
    for_trees(trees, 24, [&](Scene& s, double budget) {
        if (leaves_of(s.frame) > 16) return;
        s.forget();
        const Optimum optimum = find_optimum(s.input(budget), s.state, s.cut);
        ASSERT_TRUE(optimum.proven);
        if (!(optimum.value > 0) || optimum.floor_binds) return;
        steps = std::max(steps, optimum.steps);
        s.forget();
        const double share = s.run("threshold", budget).value / optimum.value;
        ASSERT_LE(share, 1 + 1e-6);
        s.forget();
        two_stage += s.run("two-stage", budget).value / optimum.value;
        threshold += share;
        min_share = std::min(min_share, share);
        ++count;
    });
    const auto n = static_cast<double>(count);
    std::printf("share of the optimum: threshold %.4f (least %.2f), two-stage %.4f, %.0f trees, at most %.0f steps\n",
                threshold / n, min_share, two_stage / n, n, static_cast<double>(steps));
    EXPECT_GT(count, trees / 3);
    EXPECT_GE(threshold / n, 0.99);
    EXPECT_GT(threshold, two_stage);
}

TEST(Oracle, ThresholdIsNearItOnAThousandTrees) { expect_near_the_optimum(2700); }
TEST(OracleOfManyTrees, ThresholdIsNearItOnTenThousandTrees) { expect_near_the_optimum(30000); }

TEST(Oracle, OfALargeFrameItBoundsEverySelector) {
    Scene s(test::town(5));
    s.state.hysteresis = 1;
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 60);
    s.look(region);
    ASSERT_GT(leaves_of(s.frame), 100U);
    const double full = static_cast<double>(s.run("flat", test::infinity).predicted_us);
    for (const double share : {0.3, 0.5, 0.8}) {
        s.forget();
        const Optimum optimum = find_optimum(s.input(share * full), s.state, s.cut, {.max_steps = 100000, .max_parts = 50});
        EXPECT_LE(optimum.steps, 100000U);
        EXPECT_EQ(check_legal(s.frame, s.cut), "");
        EXPECT_LE(static_cast<double>(s.cut.predicted_us), share * full);
        EXPECT_GE(optimum.bound, optimum.value);
        EXPECT_LE(optimum.bound, 1.05 * optimum.value);
        for (const SelectorEntry& entry : selectors()) {
            if (entry.goes_by != GoesBy::budget) continue;
            s.forget();
            EXPECT_LE(s.run(entry.name, share * full).value, optimum.value * (1 + 1e-9)) << entry.name;
        }
        s.forget();
        Cut again;
        reserve(again, s.state.max_candidates());
        EXPECT_EQ(find_optimum(s.input(share * full), s.state, again, {.max_steps = 100000, .max_parts = 50}).value,
                  optimum.value)
            << "deterministic";
    }
}

TEST(Oracle, BelowTheFloorTheFloorIsTheOptimum) {
    Scene s(test::town(3));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 60);
    s.look(region);
    const std::uint64_t floor = s.run("two-stage", 0).hash;
    const double value = s.cut.value;
    const Optimum optimum = find_optimum(s.input(1), s.state, s.cut);
    EXPECT_TRUE(optimum.proven && optimum.floor_binds && s.cut.floor_binds);
    EXPECT_EQ(s.cut.hash, floor);
    EXPECT_EQ(optimum.value, value);
    const Optimum all = find_optimum(s.input(test::infinity), s.state, s.cut);
    EXPECT_TRUE(all.proven);
    EXPECT_NEAR(all.value, s.frame.full_value, 1e-4 * s.frame.full_value);
}

TEST(Oracle, ItemsArePartOfTheOptimum) {
    int bought = 0, left = 0;
    for_trees(200, 8, [&](Scene& s, double budget) {
        s.forget();
        const Optimum without = find_optimum(s.input(budget), s.state, s.cut);
        if (without.floor_binds || !(without.value > 0)) return;
        ItemList items;
        items.offer({ItemKind::upload, 1, static_cast<float>(0.1 * budget), static_cast<float>(0.2 * without.value)});
        items.offer({ItemKind::upload, 2, static_cast<float>(0.1 * budget), static_cast<float>(1e-7 * without.value)});
        SelectInput input = s.input(budget);
        input.items = &items;
        const Optimum with = find_optimum(input, s.state, s.cut);
        ASSERT_TRUE(with.proven);
        ASSERT_GE(with.value, without.value * (1 - 1e-6));
        ASSERT_LE(static_cast<double>(s.cut.predicted_us), budget);
        (s.cut.bought.has(0) ? bought : left) += 1;
        s.forget();
        find_selector("threshold")->run(input, s.state, s.cut);
        ASSERT_LE(s.cut.value + s.cut.bought.value, with.value * (1 + 1e-6));
    });
    EXPECT_GT(bought, 20);
    EXPECT_GT(left, 5);
}

TEST(Oracle, OddCostsAndValuesEndAndStayLegal) {
    for (const float bad : {0.0F, std::nanf(""), std::numeric_limits<float>::infinity(), -1.0F}) {
        for_trees(60, 12, [&](Scene& s, double budget) {
            for (prepare::Choice& choice : s.frame.choices) choice.value = bad;
            find_optimum(s.input(budget), s.state, s.cut);
            EXPECT_EQ(check_legal(s.frame, s.cut), "");
            s.frame.choices[0].cost = {bad, bad};
            find_optimum(s.input(budget), s.state, s.cut);
            EXPECT_EQ(check_legal(s.frame, s.cut), "");
        });
    }
}

TEST(Oracle, NoWalkCanHaveIt) {
    EXPECT_EQ(find_selector(oracle_name), nullptr);
    EXPECT_FALSE(selector_named(oracle_name).ok());
    EXPECT_EQ(find_offline_selector(oracle_name), &oracle_entry.make());
    EXPECT_EQ(find_offline_selector("flat"), find_selector("flat"));
}

}  // namespace
}  // namespace surefoot::select
