// The selectors that leave objects out, by their definitions, and the published benefits of the 1994 searches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "render/model/view.hpp"
#include "render/select/benefit_model.hpp"
#include "render/select/budget.hpp"
#include "render/select/registry.hpp"
#include "tests/select/count_malloc.hpp"
#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

using test::infinity;
using test::Scene;

/// Costs that add up over a cut: nothing depends on the larger of two sums.
Scene seen_scene(std::uint64_t seed, std::uint32_t nodes, Random& random) {
    Scene s(test::random_model(seed, nodes));
    s.costs.combine = {100, 1.0F, 0.7F, 0};
    s.state.hysteresis = 1;
    prepare::Region region{test::random_pose(random), random.range(0, 0.5), random.range(0, 0.1)};
    region.centre.position *= 0.5;
    s.look(region);
    return s;
}

double cost_us(const prepare::Choice& choice) {
    return double{choice.cost.submit_us} + double{0.7F} * double{choice.cost.raster_us};
}

std::vector<Index> objects_of(const Scene& s) {
    std::vector<Index> objects;
    for (Index c = 0; c < s.frame.candidates.size(); ++c)
        if (s.frame.candidates[c].child_count == 0) objects.push_back(c);
    return objects;
}

/// By candidate: the offset of the form that the cut draws, or none.
std::vector<Index> drawn_forms(const Scene& s) {
    std::vector<Index> forms(s.frame.candidates.size(), none);
    for (const CutItem& item : s.cut.items) forms[item.candidate] = item.choice - s.frame.candidates[item.candidate].first_choice;
    return forms;
}

/// No choice of one form or none for each object has more value at this cost: forms may be taken in part here.
double bound_of(const Scene& s, double room_us) {
    struct Part {
        double cost_us, value;
    };
    std::vector<Part> parts;
    for (const Index c : objects_of(s)) {
        Part at{0, 0};
        const prepare::Candidate& object = s.frame.candidates[c];
        const auto forms = std::span(s.frame.choices).subspan(object.first_choice, object.choice_count);
        while (true) {  // along the upper hull
            Part best{0, 0};
            for (const prepare::Choice& f : forms) {
                const Part step{cost_us(f) - at.cost_us, double{f.value} - at.value};
                if (step.cost_us > 0 && step.value > 0 && step.value * std::max(best.cost_us, 1e-300) > best.value * step.cost_us)
                    best = step;
                if (step.cost_us > 0 && step.value > 0 && best.cost_us == 0) best = step;
            }
            if (!(best.value > 0)) break;
            parts.push_back(best);
            at = {at.cost_us + best.cost_us, at.value + best.value};
        }
    }
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.value * b.cost_us > b.value * a.cost_us; });
    double value = 0;
    for (const Part& p : parts) {
        const double share = std::clamp(room_us / p.cost_us, 0.0, 1.0);
        value += share * p.value;
        room_us -= share * p.cost_us;
    }
    return value;
}

TEST(Dropping, GreedyLeavesOutOnlyWhatDoesNotFit) {
    Random random(17);
    double least = 1, sum = 0;
    int frames = 0, large = 0;
    std::uint64_t dropped = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        Scene s = seen_scene(seed, 20 + static_cast<std::uint32_t>(seed), random);
        if (s.frame.candidates.empty()) continue;
        const double full_us = double{s.run("flat", infinity).predicted_us};
        for (const double share : {0.2, 0.6}) {
            const double budget_us = share * full_us;
            s.run("greedy", budget_us);
            const std::vector<Index> forms = drawn_forms(s);
            const auto objects = objects_of(s);
            ASSERT_EQ(s.cut.dropped.count + s.cut.items.size(), objects.size());
            const Budget budget(s.input(budget_us));
            Sum total;
            for (const CutItem& item : s.cut.items) total.add(s.frame.choices[item.choice].cost);
            ASSERT_TRUE(s.cut.items.empty() || budget.fits(total)) << seed;
            for (const Index c : objects) {
                const prepare::Candidate& object = s.frame.candidates[c];
                for (std::uint32_t k = 0; k < object.choice_count; ++k) {
                    const prepare::Choice& choice = s.frame.choices[object.first_choice + k];
                    if (forms[c] != none || !(choice.value > 0)) continue;
                    Sum with = total;
                    with.add(choice.cost);
                    ASSERT_FALSE(budget.fits(with)) << "seed " << seed << ", candidate " << c;
                }
            }
            dropped += s.cut.dropped.count;
            const double bound = bound_of(s, budget.room_us());
            if (!(bound > 0)) continue;
            ++frames;
            ASSERT_LE(s.cut.value, bound * (1 + 1e-5)) << seed;
            if (objects.size() < 30) continue;  // of few, one that does not fit decides
            least = std::min(least, s.cut.value / bound);
            sum += s.cut.value / bound;
            ++large;
        }
    }
    EXPECT_GT(dropped, 1000U);
    EXPECT_GT(frames, 300);
    EXPECT_GT(large, 100);
    std::printf("greedy shows %.3f of the most that any forms could, least %.3f, of %d frames; the published bound is 0.5\n",
                sum / large, least, large);
    EXPECT_GT(sum / large, 0.5);
}

TEST(Dropping, StaticGoesByTheSizeOfFacesAndBySpeed) {
    Random random(5);
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        Scene s = seen_scene(seed, 300, random);
        if (s.frame.candidates.empty()) continue;
        const double pixel = model::pixel_angle(s.frame.region.centre, s.frame.viewport);
        for (const double side_px : {2.0, 9.0}) {
            s.run("static", 1, side_px == 2.0 ? 0.0 : side_px * pixel);
            const std::vector<Index> forms = drawn_forms(s);
            for (const Index c : objects_of(s)) {
                const prepare::Candidate& object = s.frame.candidates[c];
                const double away =
                    std::max(s.model.nodes[object.node].box.distance(s.frame.region.centre.position), model::near_plane_m);
                const double moved_px = (s.frame.region.radius_m / away + s.frame.region.angle_rad) / pixel;
                const double face_px = side_px * side_px * (1 + moved_px / 100);
                Index expected = double{object.pixels} >= face_px * (1 - 1e-9) ? 0 : none;
                for (std::uint32_t k = 0; k < object.choice_count; ++k) {
                    const double triangles = std::max(1U, s.frame.choices[object.first_choice + k].triangles);
                    if (double{object.pixels} / triangles >= face_px * (1 - 1e-9)) expected = k;
                }
                ASSERT_EQ(forms[c], expected) << "seed " << seed << ", candidate " << c;
            }
        }
    }
}

TEST(Dropping, ReactiveFollowsTheTimeOfTheFrameBefore) {
    Random random(3);
    Scene s = seen_scene(7, 900, random);
    const auto triangles_after = [&](double last_us) {
        SelectInput input = s.input(10'000);
        input.last_frame_us = last_us;
        find_selector("reactive")->run(input, s.state, s.cut);
        return s.cut.triangles;
    };
    const std::uint64_t first = triangles_after(0);
    EXPECT_EQ(first, s.run("static", 10'000).triangles);
    EXPECT_EQ(s.state.size_factor, 1);
    EXPECT_LT(triangles_after(40'000), first);
    EXPECT_EQ(s.state.size_factor, 4);
    triangles_after(40'000);
    EXPECT_EQ(s.state.size_factor, 16);
    for (int i = 0; i < 4; ++i) triangles_after(1000);
    EXPECT_EQ(s.state.size_factor, 1.0 / 16);
    EXPECT_GT(s.cut.triangles, first);
    for (int i = 0; i < 20; ++i) triangles_after(i < 10 ? infinity : std::nan(""));
    EXPECT_TRUE(std::isfinite(s.state.size_factor));
}

TEST(Dropping, WhatIsMissingCountsInTheWorstError) {
    Random random(9);
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        Scene s = seen_scene(seed, 400, random);
        for (const SelectorEntry& entry : dropping_selectors()) {
            s.run(entry.name, 0.2 * double{s.run("flat", infinity).predicted_us}, 0.05);
            double worst = 0;
            const std::vector<Index> forms = drawn_forms(s);
            std::uint32_t missing = 0;
            for (const Index c : objects_of(s)) {
                if (forms[c] != none) continue;
                ++missing;
                const Box& box = s.model.nodes[s.frame.candidates[c].node].box;
                const double away =
                    std::max(box.distance(s.frame.region.centre.position) - s.frame.region.radius_m, model::near_plane_m);
                worst = std::max(worst, std::min(1e6, glm::length(box.max - box.min) / away));
            }
            ASSERT_EQ(s.cut.dropped.count, missing) << entry.name;
            ASSERT_NEAR(double{s.cut.dropped.error_rad}, worst, 1e-5 * worst) << entry.name;
            ASSERT_GE(double{s.cut.worst_error_rad}, double{s.cut.dropped.error_rad}) << entry.name;
            plan_slices(s.input(1e4), s.cut, 300, s.plan);
            std::vector<Index> planned, items;
            for (const CutItem& item : s.plan.order) planned.push_back(item.candidate);
            for (const CutItem& item : s.cut.items) items.push_back(item.candidate);
            std::sort(planned.begin(), planned.end());
            ASSERT_EQ(planned, items) << entry.name;
        }
    }
}

TEST(Dropping, AllocatesNothing) {
    Scene s(test::town(6));
    s.look({{dvec3(0, 3, 100), Pose{}.orientation}, 0, 0});
    for (const SelectorEntry& entry : dropping_selectors()) ASSERT_NE(find_selector(entry.name), nullptr);
    for (const std::string_view name : {"best-first-1994", "two-stage-1994"}) ASSERT_NE(find_selector(name), nullptr);
    const std::uint64_t before = test::allocations();
    for (const SelectorEntry& entry : dropping_selectors()) s.run(entry.name, 2000);
    for (const BenefitModelEntry& model : benefit_models())
        for (const std::string_view name : {"best-first-1994", "two-stage-1994"}) {
            SelectInput input = s.input(2000);
            input.benefit = model.model;
            find_selector(name)->run(input, s.state, s.cut);
        }
    EXPECT_EQ(test::allocations(), before);
}

TEST(Dropping, OddBudgetsAndTimesLeaveNoHoleInTheArrays) {
    Random random(2);
    Scene s = seen_scene(3, 200, random);
    for (const double budget_us : {0.0, -1.0, std::nan(""), infinity, 1e-300}) {
        for (const SelectorEntry& entry : dropping_selectors()) {
            SelectInput input = s.input(budget_us);
            input.last_frame_us = std::nan("");
            find_selector(entry.name)->run(input, s.state, s.cut);
            EXPECT_EQ(s.cut.items.size() + s.cut.dropped.count, objects_of(s).size()) << entry.name;
        }
    }
}

/// The distances of figure 3.13, and that of the text's footnote.
double distance_by(BenefitModel model, const Box& box, const dvec3& eye) {
    if (model == BenefitModel::distance_centre) return glm::length((box.min + box.max) * 0.5 - eye);
    if (model == BenefitModel::distance_point) return glm::length(glm::clamp(eye, box.min, box.max) - eye);
    double nearest = infinity;
    for (int corner = 0; corner < 8; ++corner)
        nearest = std::min(nearest,
                           glm::length(dvec3((corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                                             (corner & 4) != 0 ? box.max.z : box.min.z) -
                                       eye));
    return nearest;
}

TEST(BenefitModels, AreTheDistancesOfTheSource) {
    Random random(11);
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        Scene s = seen_scene(seed, 150, random);
        std::vector<float> benefits(s.frame.candidates.size());
        for (const BenefitModelEntry& entry : benefit_models()) {
            if (entry.model == BenefitModel::surefoot) continue;
            for (const bool of_subtree : {false, true}) {
                SelectInput input = s.input(1e3);
                input.benefit = entry.model;
                find_benefits(input, of_subtree, benefits);
                std::vector<double> expected(benefits.size(), 0.0);
                for (std::size_t c = benefits.size(); c-- > 0;) {
                    const prepare::Candidate& at = s.frame.candidates[c];
                    const double d = distance_by(entry.model, s.model.nodes[at.node].box, s.frame.region.centre.position);
                    const bool below = at.child_count > 0 && (of_subtree || entry.model == BenefitModel::subtree_max);
                    if (!below) expected[c] = 1 / (1 + d * d);
                    for (Index k = 0; below && k < at.child_count; ++k)
                        expected[c] = std::max(expected[c], expected[at.first_child + k]);
                    ASSERT_NEAR(double{benefits[c]}, expected[c], 1e-6 * expected[c]) << entry.name;
                }
            }
        }
    }
}

TEST(BenefitModels, KeepTheBudgetAndGuideTheSearch) {
    Random random(23);
    int other_cuts = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        Scene s = seen_scene(seed, 300, random);
        if (s.frame.candidates.empty()) continue;
        const double budget_us = 0.4 * double{s.run("flat", infinity).predicted_us};
        const auto hash_by = [&](std::string_view selector, BenefitModel model) {
            SelectInput input = s.input(budget_us);
            input.benefit = model;
            find_selector(selector)->run(input, s.state, s.cut);
            EXPECT_EQ(check_legal(s.frame, s.cut), "");
            EXPECT_TRUE(double{s.cut.predicted_us} <= budget_us || s.cut.floor_binds) << selector;
            return s.cut.hash;
        };
        EXPECT_EQ(hash_by("best-first-1994", BenefitModel::subtree_max), hash_by("two-stage-1994", BenefitModel::distance_vertex))
            << "both go by the greatest benefit below, by the nearest corner";
        if (hash_by("best-first-1994", BenefitModel::distance_centre) !=
            hash_by("best-first-1994", BenefitModel::distance_vertex))
            ++other_cuts;
    }
    EXPECT_GT(other_cuts, 20);
    EXPECT_TRUE(benefit_model_named("distance-point").ok());
    const auto unknown = benefit_model_named("nearness");
    ASSERT_FALSE(unknown.ok());
    for (const BenefitModelEntry& entry : benefit_models()) EXPECT_NE(unknown.error().remedy.find(entry.name), std::string::npos);
}

TEST(Dropping, GreedyBuysItemsInTheOrderOfItsPairs) {
    Random random(5);
    int before = 0, after = 0, scenes = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        Scene s = seen_scene(seed, 60, random);
        if (s.frame.candidates.empty()) continue;
        const double budget_us = 0.4 * double{s.run("flat", infinity).predicted_us};
        const double room_us = Budget(s.input(budget_us)).room_us();
        if (!(room_us > 1)) continue;
        ++scenes;
        s.forget();
        s.run("greedy", budget_us);
        const double alone = s.cut.value;
        const auto with = [&](float rate) {
            const auto cost_us = static_cast<float>(0.5 * room_us);
            ItemList items;
            items.offer({ItemKind::effect, 1, cost_us, rate * cost_us});
            SelectInput input = s.input(budget_us);
            input.items = &items;
            s.forget();
            find_selector("greedy")->run(input, s.state, s.cut);
            return s.cut.bought.has(0);
        };
        if (with(1e6F)) {
            ++before;
            EXPECT_LE(s.cut.value, alone) << "pairs have what is left";
            EXPECT_LE(double{s.cut.predicted_us}, budget_us);
        }
        if (with(1e-12F)) ++after;
    }
    EXPECT_GT(scenes, 30);
    EXPECT_EQ(before, scenes) << "a rate above all pairs' is bought first";
    EXPECT_LT(after, before) << "one below all of them has what they leave";
}

}  // namespace
}  // namespace surefoot::select
