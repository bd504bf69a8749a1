// Slices: exactly the cut, legal stand-ins, and the in-frame check that keeps a frame when its costs were under-predicted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

using test::infinity;
using test::Scene;

/// Leaf candidates below `c`.
void leaves_of(const prepare::PreparedFrame& f, Index c, std::multiset<Index>& leaves) {
    std::vector<Index> stack{c};
    while (!stack.empty()) {
        const auto& candidate = f.candidates[stack.back()];
        const Index at = stack.back();
        stack.pop_back();
        if (candidate.child_count == 0) leaves.insert(at);
        for (Index k = 0; k < candidate.child_count; ++k) stack.push_back(candidate.first_child + k);
    }
}

model::ItemCost sum_of(const prepare::PreparedFrame& f, std::span<const CutItem> items) {
    model::ItemCost sum;
    for (const CutItem& item : items) {
        sum += f.choices[item.choice].cost;
    }
    return sum;
}

void expect_plan_covers_cut(const Scene& s, double slice_us) {
    const SlicePlan& plan = s.plan;
    std::set<std::pair<Index, Index>> cut, order;
    for (const CutItem& item : s.cut.items) cut.emplace(item.candidate, item.choice);
    for (const CutItem& item : plan.order) order.emplace(item.candidate, item.choice);
    EXPECT_EQ(order, cut);
    EXPECT_EQ(plan.order.size(), s.cut.items.size());
    std::uint32_t item = 0, stand_in = 0;
    double total = 0;
    for (const Slice& slice : plan.slices) {
        EXPECT_EQ(slice.first_item, item);
        EXPECT_EQ(slice.first_stand_in, stand_in);
        ASSERT_GT(slice.item_count, 0U);
        item += slice.item_count;
        stand_in += slice.stand_in_count;
        const auto items = std::span(plan.order).subspan(slice.first_item, slice.item_count);
        const auto stand_ins = std::span(plan.stand_ins).subspan(slice.first_stand_in, slice.stand_in_count);
        std::multiset<Index> full, coarse;
        for (const CutItem& i : items) leaves_of(s.frame, i.candidate, full);
        for (const CutItem& i : stand_ins) leaves_of(s.frame, i.candidate, coarse);
        EXPECT_EQ(full, coarse);  // the same leaves, each once
        const auto cost = sum_of(s.frame, items), stand_in_cost = sum_of(s.frame, stand_ins);
        EXPECT_NEAR(slice.cost.submit_us, cost.submit_us, 1e-3F * (1 + cost.submit_us));
        EXPECT_NEAR(slice.stand_in_cost.raster_us, stand_in_cost.raster_us, 1e-3F * (1 + stand_in_cost.raster_us));
        const auto& w = s.costs.combine;
        const auto metric = [&](const model::ItemCost& c) { return w.frame_us(c.submit_us, c.raster_us) - w.fixed_us; };
        EXPECT_LE(metric(stand_in_cost), metric(cost) * 1.001F + 1e-3F);
        total += static_cast<double>(metric(cost));
    }
    EXPECT_EQ(item, plan.order.size());
    EXPECT_EQ(stand_in, plan.stand_ins.size());
    EXPECT_LE(static_cast<double>(plan.slices.size()), 1.001 + total / slice_us);
    Cut mixed;  // any prefix of full slices followed by stand-ins is a legal cut
    for (std::size_t k = 0; k < plan.slices.size(); ++k) {
        const Slice& slice = plan.slices[k];
        const bool full = k < plan.slices.size() / 2;
        const auto part = full ? std::span(plan.order).subspan(slice.first_item, slice.item_count)
                               : std::span(plan.stand_ins).subspan(slice.first_stand_in, slice.stand_in_count);
        mixed.items.insert(mixed.items.end(), part.begin(), part.end());
    }
    EXPECT_EQ(check_legal(s.frame, mixed), "");
}

TEST(Slices, HoldExactlyTheCutAndStandInsForTheSameLeaves) {
    Random random(31);
    for (std::uint64_t seed = 0; seed < 600; ++seed) {
        Scene s(test::random_model(seed, 80));
        s.look({test::random_pose(random, 30), 0.1, 0.02});
        if (s.frame.candidates.empty()) continue;
        const auto names = selector_names();
        s.run(names[seed % names.size()], random.range(0, 20000));
        const double slice_us = std::exp(random.range(2, 9));
        plan_slices(s.input(infinity), s.cut, slice_us, s.plan);
        expect_plan_covers_cut(s, slice_us);
        if (HasFatalFailure()) return;
    }
}

TEST(Slices, NearestSubtreesComeFirst) {
    Scene s(test::town(6));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 100);
    s.look(region);
    s.run("two-stage", 20000);
    plan_slices(s.input(20000), s.cut, 500, s.plan);
    ASSERT_GT(s.plan.slices.size(), 4U);
    const auto nearest = [&](const Slice& slice) {
        double d = infinity;
        for (std::uint32_t i = 0; i < slice.item_count; ++i) {
            d = std::min(d, s.model.nodes[s.plan.order[slice.first_item + i].node].box.distance(region.centre.position));
        }
        return d;
    };
    EXPECT_LT(nearest(s.plan.slices.front()), nearest(s.plan.slices.back()));
    plan_slices(s.input(20000), s.cut, 1e-3, s.plan);  // so short that no two items are one subtree
    ASSERT_EQ(s.plan.order.size(), s.cut.items.size());
    ASSERT_GT(s.plan.slices.size(), s.plan.order.size() / 2);
    float before_m = 0;
    for (const CutItem& item : s.plan.order) {
        const auto m = static_cast<float>(s.model.nodes[item.node].box.distance(region.centre.position));
        EXPECT_LE(before_m, m);
        before_m = m;
    }
    EXPECT_GT(before_m, 50.0F);
}

TEST(Slices, TakeAnEighthOfWhatIsLeftFromOneToFourTimesTheShortest) {
    Random random(57);
    std::size_t long_ones = 0, shortest_ones = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Scene s(test::random_model(seed, 80));
        s.look({test::random_pose(random, 30), 0.1, 0.02});
        if (s.frame.candidates.empty()) continue;
        s.run("flat", infinity);
        const model::FrameCombine& w = s.costs.combine;
        const bool submits = s.cut.sum.submit_us > s.cut.sum.raster_us;
        const auto time_us = [&](const model::ItemCost& c) {  // adds up over slices
            return static_cast<double>((w.submit_weight + (submits ? w.max_weight : 0)) * c.submit_us +
                                       (w.raster_weight + (submits ? 0 : w.max_weight)) * c.raster_us);
        };
        const double all_us = time_us(s.cut.sum), slice_us = all_us / std::exp(random.range(0, 4));
        double largest_us = slice_us;  // of what is not divided: an item, or a subtree within the shortest slice
        for (const CutItem& item : s.cut.items) largest_us = std::max(largest_us, time_us(s.frame.choices[item.choice].cost));
        plan_slices(s.input(infinity), s.cut, slice_us, s.plan);
        const double shortest = all_us / slice_us,
                     shrinking = std::log(std::max(std::min(shortest, 32.0) / 8, 1.0)) / std::log(8.0 / 7);
        EXPECT_LE(static_cast<double>(s.plan.slices.size()), 12.001 + shrinking + std::max(0.0, (shortest - 32) / 4));
        double left_us = all_us, before_us = slice_us / 2;
        for (std::size_t k = 0; k + 1 < s.plan.slices.size(); ++k) {
            const double wanted_us = std::clamp(std::min(0.125 * left_us, 2 * before_us), slice_us, 4 * slice_us);
            const double is_us = time_us(s.plan.slices[k].cost);
            EXPECT_GE(is_us, wanted_us - 1e-4 * all_us);
            EXPECT_LE(is_us, wanted_us + largest_us + 1e-4 * all_us);
            long_ones += wanted_us > 1.5 * slice_us ? 1 : 0;
            shortest_ones += wanted_us <= slice_us ? 1 : 0;
            left_us -= is_us;
            before_us = wanted_us;
        }
    }
    EXPECT_GT(long_ones, 20U);
    EXPECT_GT(shortest_ones, 20U);
}

TEST(StillFits, ZeroCasesAreDefined) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(still_fits({.elapsed_us = 9e9, .next_us = 0, .next_stand_in_us = 0}));
    EXPECT_TRUE(
        still_fits({.elapsed_us = 0, .predicted_so_far_us = 0, .next_us = 400, .next_stand_in_us = 10, .limit_us = 1000}));
    EXPECT_FALSE(
        still_fits({.elapsed_us = nan, .predicted_so_far_us = 1, .next_us = 400, .next_stand_in_us = 10, .limit_us = 1000}));
    EXPECT_FALSE(
        still_fits({.elapsed_us = 10, .predicted_so_far_us = 10, .next_us = 100, .next_stand_in_us = 10, .limit_us = nan}));
    EXPECT_TRUE(
        still_fits({.elapsed_us = 999, .predicted_so_far_us = 1, .next_us = 500, .next_stand_in_us = 500, .limit_us = 1000}));
}

TEST(StillFits, ScalesTheRestByHowWrongTheFrameHasBeen) {
    CheckInput in{.elapsed_us = 400,
                  .predicted_so_far_us = 400,
                  .next_us = 300,
                  .next_stand_in_us = 5,
                  .rest_stand_in_us = 200,
                  .limit_us = 1000};
    EXPECT_TRUE(still_fits(in));
    in.predicted_so_far_us = 200;  // twice as slow as said
    EXPECT_FALSE(still_fits(in));
    in.predicted_so_far_us = 4000;  // faster than said: no more than said is hoped for
    EXPECT_TRUE(still_fits(in));
    in.next_us = 450;
    EXPECT_FALSE(still_fits(in));
    EXPECT_DOUBLE_EQ(forecast_us(in), 400 + 450 + 200) << "what the check compares with its limit";
}

/// One frame on a virtual clock whose true costs are `wrong` times the predicted ones. Returns its time, us.
double frame_us(Scene& s, double limit_us, double wrong, bool check) {
    const model::FrameCombine& w = s.costs.combine;
    const auto us = [&](const model::ItemCost& c) {
        return static_cast<double>(w.frame_us(c.submit_us, c.raster_us) - w.fixed_us);
    };
    const double headroom = static_cast<double>(s.costs.headroom), end = static_cast<double>(s.costs.slice_us);
    CheckInput in;
    in.elapsed_us = in.predicted_so_far_us = static_cast<double>(w.fixed_us);
    in.limit_us = limit_us;
    for (const Slice& slice : s.plan.slices) {
        in.rest_stand_in_us += us(slice.stand_in_cost) * headroom + end;
    }
    bool full = true;
    for (const Slice& slice : s.plan.slices) {
        in.rest_stand_in_us -= us(slice.stand_in_cost) * headroom + end;
        in.next_us = us(slice.cost) * headroom + end;
        in.next_stand_in_us = us(slice.stand_in_cost) * headroom + end;
        if (full && check) full = still_fits(in);
        const double predicted = us(full ? slice.cost : slice.stand_in_cost) + end;
        in.predicted_so_far_us += predicted;
        in.elapsed_us += predicted * wrong;
    }
    return in.elapsed_us;
}

// Inside a building most stand-ins are no cheaper than the things: whatever share of the limit they truly take, a frame whose
// costs are up to twice what was predicted ends within its period.
TEST(StillFits, StandInsThatSaveLittleMissNoFrameEither) {
    constexpr double limit_us = 31000, period_us = 33333, budget_us = 28000;
    constexpr int slices = 26;
    double worst_us = 0;
    for (double wrong = 1; wrong <= 2; wrong += 0.125) {
        for (double stand_in_share = 0.1; stand_in_share <= 0.8; stand_in_share += 0.05) {
            const double full_us = budget_us / slices,
                         stand_in_us = std::min(stand_in_share * limit_us / wrong / slices, full_us);
            CheckInput in{.limit_us = limit_us};
            bool full = true;
            for (int i = 0; i < slices; ++i) {
                in.next_us = full_us;
                in.next_stand_in_us = stand_in_us;
                in.rest_stand_in_us = (slices - 1 - i) * stand_in_us;
                full = full && still_fits(in);
                in.predicted_so_far_us += full ? full_us : stand_in_us;
                in.elapsed_us += wrong * (full ? full_us : stand_in_us);
            }
            worst_us = std::max(worst_us, in.elapsed_us);
            EXPECT_LE(in.elapsed_us, period_us) << wrong << " times, stand-ins " << stand_in_share << " of the limit";
            EXPECT_TRUE(full || wrong > 1) << "as predicted, and nothing is coarse: " << stand_in_share;
        }
    }
    EXPECT_GT(worst_us, 0.9 * limit_us) << "the time is used";
}

/// A frame on a real clock: of the slice in flight the check knows the prediction only. Costs are `wrong` times the predicted
/// ones, stand-ins take a share of full slices. Lengths are the plan's. us; seen: the check is told what is in flight.
double frame_with_slices_in_flight_us(double planned_us, double limit_us, double wrong, double stand_in_share, bool seen) {
    std::vector<double> lengths_us;
    double length_us = 500;
    for (double left_us = planned_us; left_us > 1e-6; left_us -= lengths_us.back()) {
        length_us = std::clamp(std::min(0.125 * left_us, 2 * length_us), 1000.0, 4000.0);
        lengths_us.push_back(std::min(length_us, left_us));
    }
    double finished_us = 0, in_flight_us = 0, so_far_us = 0, rest_us = planned_us;
    bool full = true;
    for (const double next_us : lengths_us) {
        rest_us -= next_us;
        CheckInput in{.limit_us = limit_us};
        in.elapsed_us = finished_us + in_flight_us;
        in.predicted_so_far_us = so_far_us;
        in.in_flight_us = seen ? in_flight_us : 0.0;
        in.next_us = next_us;
        in.next_stand_in_us = stand_in_share * next_us;
        in.rest_stand_in_us = stand_in_share * rest_us;
        full = full && still_fits(in);
        finished_us += wrong * in_flight_us;
        in_flight_us = full ? next_us : stand_in_share * next_us;
        so_far_us += in_flight_us;
    }
    return finished_us + wrong * in_flight_us;
}

TEST(StillFits, WhatIsInFlightMayBeAsWrongAsWhatIsFinished) {
    for (const double period_us : {16667.0, 33333.0}) {
        const double limit_us = 0.93 * period_us;
        double worst_us = 0, worst_unseen_us = 0;
        for (double wrong = 1; wrong <= 2; wrong += 0.0625) {
            for (const double share : {0.1, 0.2}) {
                const auto frame = [&](bool seen) {
                    return frame_with_slices_in_flight_us(0.84 * period_us, limit_us, wrong, share, seen);
                };
                worst_us = std::max(worst_us, frame(true));
                worst_unseen_us = std::max(worst_unseen_us, frame(false));
            }
        }
        EXPECT_LE(worst_us, period_us);
        EXPECT_GT(worst_us, 0.9 * limit_us) << "the time is used";
        EXPECT_GT(worst_unseen_us, worst_us + 0.02 * period_us) << "a slice in flight taken for as quick as predicted";
        EXPECT_DOUBLE_EQ(frame_with_slices_in_flight_us(0.84 * period_us, limit_us, 1, 0.2, true), 0.84 * period_us)
            << "all in full";
    }
}

TEST(StillFits, CostsUnderPredictedTwofoldMissNoFrameOfSixHundred) {
    Scene s(test::town(7));
    constexpr double limit_us = 33333;
    int late_with = 0, late_without = 0;
    for (int i = 0; i < 600; ++i) {
        prepare::Region region;
        region.centre.position = dvec3(150 * std::sin(0.01 * i), 3 + 2 * std::sin(0.03 * i), 200 - 0.6 * i);
        region.centre.orientation = glm::angleAxis(0.5 * std::sin(0.02 * i), dvec3(0, 1, 0));
        s.look(region);
        s.run("two-stage", 0.9 * limit_us);
        plan_slices(s.input(0.9 * limit_us), s.cut, 1000, s.plan);
        late_with += frame_us(s, limit_us, 2.0, true) > limit_us ? 1 : 0;
        late_without += frame_us(s, limit_us, 2.0, false) > limit_us ? 1 : 0;
    }
    EXPECT_EQ(late_with, 0);
    EXPECT_GT(late_without, 300);
}

}  // namespace
}  // namespace surefoot::select
