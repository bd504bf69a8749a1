// The accuracy that all objects share: the cheapest cuts within an error, and the smallest error within a budget, beside plain
// recursion and trial of every error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/select/registry.hpp"
#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

using test::infinity;
using test::Scene;

/// Costs that add up over a cut: nothing depends on the larger of two sums.
Scene random_frame(std::uint64_t seed, std::uint32_t nodes, Random& random) {
    Scene s(test::random_model(seed, nodes));
    for (model::Node& node : s.model.nodes) node.importance = 1;  // errors are as they are; guarantee_test.cpp has the others
    s.costs.combine = {100, 1.0F, 0.7F, 0};
    s.state.hysteresis = 1;
    prepare::Region region{test::random_pose(random), random.range(0, 0.5), random.range(0, 0.1)};
    region.centre.position *= 0.5;
    s.look(region);
    return s;
}

double item_us(const model::ItemCost& cost) {
    return static_cast<double>(cost.submit_us) + static_cast<double>(0.7F) * static_cast<double>(cost.raster_us);
}

/// Of the cheapest cut below a candidate whose items are all within the error; infinite: none is.
double cheapest_us(const prepare::PreparedFrame& f, Index c, float error_rad) {
    const prepare::Candidate& at = f.candidates[c];
    double best = infinity, children = at.child_count > 0 ? 0 : infinity;
    for (Index k = 0; k < at.choice_count; ++k)
        if (f.choices[at.first_choice + k].error_rad <= error_rad)
            best = std::min(best, item_us(f.choices[at.first_choice + k].cost));
    for (Index k = 0; k < at.child_count; ++k) children += cheapest_us(f, at.first_child + k, error_rad);
    return std::min(best, children);
}

double cut_items_us(const Scene& s) {
    double sum = 0;
    for (const CutItem& item : s.cut.items) sum += item_us(s.frame.choices[item.choice].cost);
    return sum;
}

/// All errors of a frame, from small to large.
std::vector<float> errors_of(const Scene& s) {
    std::vector<float> errors;
    for (const prepare::Choice& choice : s.frame.choices)
        if (choice.error_rad > 0) errors.push_back(choice.error_rad);
    std::sort(errors.begin(), errors.end());
    errors.erase(std::unique(errors.begin(), errors.end()), errors.end());
    return errors;
}

template <class Use>
void for_frames(std::uint64_t count, std::uint32_t max_nodes, const Use& use) {
    Random random(23);
    for (std::uint64_t seed = 0; seed < count; ++seed) {
        Scene s = random_frame(seed, 2 + random.below(max_nodes), random);
        if (!s.frame.candidates.empty()) use(s, random);
    }
}

TEST(CommonError, IsHadByTheCheapestCut) {
    std::size_t compared = 0, unreachable = 0;
    for_frames(400, 50, [&](Scene& s, Random&) {
        for (const float error : errors_of(s)) {
            const double best = cheapest_us(s.frame, 0, error);
            s.run("curve-accuracy", 0, static_cast<double>(error));
            ASSERT_EQ(check_legal(s.frame, s.cut), "");
            ++(std::isinf(best) ? unreachable : compared);
            if (std::isinf(best)) continue;
            ASSERT_LE(s.cut.worst_error_rad, error);
            ASSERT_NEAR(cut_items_us(s), best, 1e-6 * best + 1e-9);
        }
    });
    std::printf("%zu errors compared; %zu were below what some leaf has\n", compared, unreachable);
    EXPECT_GT(compared, 2500U);
    EXPECT_GT(unreachable, 20U);
}

TEST(CommonError, BelowWhatALeafHasTheBestFormIsTaken) {
    for_frames(100, 30, [&](Scene& s, Random&) {
        for (prepare::Choice& choice : s.frame.choices) choice.error_rad += 0.01F;  // nothing is exact
        const float best = s.run("flat", infinity).worst_error_rad;
        ASSERT_LE(s.run("curve-accuracy", 0, 0.005).worst_error_rad, best);
        ASSERT_EQ(check_legal(s.frame, s.cut), "");
    });
}

TEST(CommonError, IsTheSmallestThatTheBudgetBuys) {
    std::size_t compared = 0;
    for_frames(400, 50, [&](Scene& s, Random& random) {
        const double full = static_cast<double>(s.run("flat", infinity).predicted_us),
                     floor = static_cast<double>(s.cut.floor_us);
        const double budget = floor + (full - floor) * random.range(0.05, 0.95);
        // predicted = factor * (fixed + items * more): from two cuts
        const double full_us = cut_items_us(s);
        s.run("curve-accuracy", 0, 1e6);
        const double cheap_us = cut_items_us(s), cheap = static_cast<double>(s.cut.predicted_us);
        if (!(full_us > cheap_us * 1.01)) return;
        const double room = cheap_us + (budget - cheap) * (full_us - cheap_us) / (full - cheap);
        float best = infinity;
        const std::vector<float> errors = errors_of(s);
        for (auto error = errors.rbegin(); error != errors.rend(); ++error)
            if (cheapest_us(s.frame, 0, *error) <= room * (1 - 1e-5)) best = *error;
        s.run("curve-budget", budget);
        ASSERT_LE(static_cast<double>(s.cut.predicted_us), std::max(budget, static_cast<double>(s.cut.floor_us)));
        if (!std::isfinite(best)) return;
        ++compared;
        ASSERT_LE(static_cast<double>(s.cut.worst_error_rad), static_cast<double>(best) * (1 + 1.0 / 60));
    });
    EXPECT_GT(compared, 200U);
}

/// Beside the cheapest cut of the same worst error: more value, no more error, within the budget.
void expect_more_value(Scene& s, double budget, double& left, double& left_before) {
    const Cut cut = s.run("curve-budget", budget);
    const Cut common = s.run("curve-accuracy", 0, static_cast<double>(cut.worst_error_rad));
    ASSERT_EQ(check_legal(s.frame, cut), "");
    ASSERT_LE(static_cast<double>(cut.predicted_us), budget);
    ASSERT_GE(cut.value, common.value * (1 - 1e-5));
    left = (budget - static_cast<double>(cut.predicted_us)) / budget;
    left_before = (budget - static_cast<double>(common.predicted_us)) / budget;
    ASSERT_LE(left, left_before + 1e-6);
}

TEST(CommonError, LeavesTheRestOfTheBudgetToValue) {
    double left = 0, left_before = 0;
    std::size_t compared = 0, spent = 0;
    for_frames(300, 60, [&](Scene& s, Random& random) {
        const double full = static_cast<double>(s.run("flat", infinity).predicted_us),
                     floor = static_cast<double>(s.cut.floor_us);
        const double budget = floor + (full - floor) * random.range(0.1, 0.9);
        const Cut& cut = s.run("curve-budget", budget);
        if (cut.floor_binds || !(cut.worst_error_rad > 0)) return;
        if (!(static_cast<double>(s.run("curve-accuracy", 0, static_cast<double>(cut.worst_error_rad)).predicted_us) <= budget))
            return;
        expect_more_value(s, budget, left, left_before);
        ++compared;
        spent += left < left_before - 1e-3 ? 1U : 0U;
    });
    std::printf("something of the rest was spent in %zu of %zu random trees\n", spent, compared);
    EXPECT_GT(compared, 100U);
    EXPECT_GT(spent, 20U);
    Scene s(test::town(6));  // small steps, so something always fits
    s.state.hysteresis = 1;
    s.look({{dvec3(0, 3, 100), Pose{}.orientation}, 0, 0});
    const double full = static_cast<double>(s.run("flat", infinity).predicted_us);
    for (const double share : {0.3, 0.5, 0.7, 0.9}) {
        expect_more_value(s, share * full, left, left_before);
        std::printf("with %.1f of full detail's time: %.5f of the budget is left, after the common error %.5f\n", share, left,
                    left_before);
        EXPECT_LT(left, 0.002) << share;
    }
}

TEST(CommonError, StopsAtTheAccuracyThatIsAsked) {
    Scene s(test::town(6));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 100);
    s.look(region);
    const double full = static_cast<double>(s.run("flat", infinity).predicted_us);
    for (const double target : {0.2, 0.02, 0.005}) {
        s.forget();
        const std::uint64_t wanted = s.run("curve-accuracy", 0, target).triangles;
        s.forget();
        EXPECT_EQ(s.run("curve-budget", 0.99 * full, target).triangles, wanted) << target;
        EXPECT_LE(static_cast<double>(s.cut.worst_error_rad), target);
    }
}

TEST(CommonError, GoesDownToWhatIsWantedFromACoarseCut) {
    Scene s(test::town(6));
    s.look({{dvec3(0, 3, 100), Pose{}.orientation}, 0, 0});
    const double full = static_cast<double>(s.run("flat", infinity).predicted_us);
    for (const double target : {0.02, 0.005, 0.001}) {
        s.forget();
        s.run("curve-budget", 1.2 * static_cast<double>(s.cut.floor_us));
        EXPECT_GT(static_cast<double>(s.cut.worst_error_rad), target);
        s.run("curve-budget", 0.99 * full, target);
        EXPECT_LE(static_cast<double>(s.cut.worst_error_rad), target);
        const std::uint64_t triangles = s.cut.triangles;
        s.run("curve-budget", 0.99 * full);
        EXPECT_GT(s.cut.triangles, triangles);
    }
}

TEST(CommonError, OneLeafWithoutAGoodFormMakesNoOtherFiner) {
    Scene s(test::town(6));
    s.state.hysteresis = 1;
    s.look({{dvec3(0, 3, 100), Pose{}.orientation}, 0, 0});
    s.run("curve-accuracy", 0, 0.01);
    const double before = cut_items_us(s);
    const prepare::Candidate leaf = s.frame.candidates.back();
    ASSERT_EQ(leaf.child_count, 0U);
    for (Index c = static_cast<Index>(s.frame.candidates.size()) - 1; c != none; c = s.frame.candidates[c].parent)
        for (Index k = 0; k < s.frame.candidates[c].choice_count; ++k)
            s.frame.choices[s.frame.candidates[c].first_choice + k].error_rad += 1.0F;  // nor has any node above it
    s.run("curve-accuracy", 0, 0.01);
    EXPECT_GE(s.cut.worst_error_rad, 1.0F);
    // Opened are the nodes above it, and beside them stands what is cheapest.
    double opened = item_us(s.frame.choices[leaf.first_choice + leaf.choice_count - 1].cost);
    Index below = static_cast<Index>(s.frame.candidates.size()) - 1;
    for (Index c = leaf.parent; c != none; below = c, c = s.frame.candidates[c].parent) {
        const prepare::Candidate& above = s.frame.candidates[c];
        for (Index k = above.first_child; k < above.first_child + above.child_count; ++k)
            if (k != below) opened += cheapest_us(s.frame, k, 0.01F);
    }
    EXPECT_LE(cut_items_us(s), opened * (1 + 1e-6));
    EXPECT_LT(opened, 1.5 * before);
}

/// Frames add the larger of both sums: the cut may be dearer than the cheapest, by little.
TEST(CommonError, WithTheLargerOfTwoSumsIsNearTheBound) {
    double worst = 1;
    for_frames(200, 50, [&](Scene& s, Random&) {
        s.costs.combine = {100, 0.6F, 0.4F, 0.5F};
        const auto weighed = [&](double submit, double raster, Index c, float error, const auto& self) -> double {
            const prepare::Candidate& at = s.frame.candidates[c];
            double best = infinity, children = at.child_count > 0 ? 0 : infinity;
            for (Index k = 0; k < at.choice_count; ++k) {
                const prepare::Choice& choice = s.frame.choices[at.first_choice + k];
                if (choice.error_rad <= error)
                    best = std::min(best, submit * static_cast<double>(choice.cost.submit_us) +
                                              raster * static_cast<double>(choice.cost.raster_us));
            }
            for (Index k = 0; k < at.child_count; ++k) children += self(submit, raster, at.first_child + k, error, self);
            return std::min(best, children);
        };
        for (const float error : errors_of(s)) {
            double bound = 0;
            for (int i = 0; i <= 8; ++i)
                bound = std::max(bound, weighed(0.6 + 0.5 * i / 8, 0.4 + 0.5 * (8 - i) / 8, 0, error, weighed));
            if (std::isinf(bound)) continue;
            s.run("curve-accuracy", 0, static_cast<double>(error));
            double submit = 0, raster = 0;
            for (const CutItem& item : s.cut.items) {
                submit += static_cast<double>(s.frame.choices[item.choice].cost.submit_us);
                raster += static_cast<double>(s.frame.choices[item.choice].cost.raster_us);
            }
            worst = std::max(worst, (0.6 * submit + 0.4 * raster + 0.5 * std::max(submit, raster)) / bound);
        }
    });
    std::printf("at most %.4f of the bound\n", worst);
    EXPECT_LT(worst, 1.2);
}

TEST(CommonError, OfABudgetSwitchesLittleWhileEyeAndBudgetTremble) {
    const auto switches = [](float hysteresis) {
        Scene s(test::town(6));
        s.state.hysteresis = hysteresis;
        Random random(7);
        s.look({{dvec3(0, 3, 100), Pose{}.orientation}, 0, 0});
        const double budget = 0.4 * static_cast<double>(s.run("flat", infinity).predicted_us);
        double sum = 0;
        for (int i = 0; i < 120; ++i) {
            s.look({{dvec3(random.range(-0.2, 0.2), 3, 100 * random.range(0.999, 1.001)), Pose{}.orientation}, 0, 0});
            s.run("curve-budget", budget * random.range(0.99, 1.01));
            if (i >= 20) sum += s.cut.switches;
        }
        return sum / 100;
    };
    const double with = switches(1.25F), without = switches(1.0F);
    std::printf("switches a frame by a budget under dither: %.2f with hysteresis, %.2f without\n", with, without);
    EXPECT_LT(with, 0.2 * without);
}

TEST(CommonError, FallsAsTheBudgetGrows) {
    Scene s(test::town(6));
    s.state.hysteresis = 1;
    s.look({Pose{}, 30.0, 1.0});
    const double full = static_cast<double>(s.run("flat", infinity).predicted_us), floor = static_cast<double>(s.cut.floor_us);
    float before = infinity, first = 0;
    for (int i = 1; i < 20; ++i) {
        const float error = s.run("curve-budget", floor + (full - floor) * i / 20).worst_error_rad;
        EXPECT_LE(error, before * (1 + 1.0F / 60)) << i;
        before = error;
        if (i == 1) first = error;
    }
    EXPECT_LT(before, 0.5F * first);
}

TEST(CommonError, ShownFormsStayWithinTheErrorWhileTheEyeTrembles) {
    const auto switches = [](float hysteresis) {
        Scene s(test::town(6));
        s.state.hysteresis = hysteresis;
        Random random(5);
        double sum = 0;
        for (int i = 0; i < 120; ++i) {
            s.look({{dvec3(random.range(-0.2, 0.2), 3, 100 * random.range(0.999, 1.001)), Pose{}.orientation}, 0, 0});
            s.run("curve-accuracy", 0, 0.01);
            EXPECT_LE(s.cut.worst_error_rad, 0.01F);
            if (i >= 20) sum += s.cut.switches;
        }
        return sum / 100;
    };
    const double with = switches(1.25F), without = switches(1.0F);
    std::printf("switches a frame under dither: %.2f with hysteresis, %.2f without\n", with, without);
    EXPECT_LT(with, 0.2 * without);
}

TEST(CommonError, BelowWhatIsThereIsToldInTheCut) {
    for_frames(40, 30, [&](Scene& s, Random&) {
        const bool has_it = s.run("curve-accuracy", 0, 0.01).worst_weighted_rad <= 0.01F;
        EXPECT_EQ(s.cut.guarantee, has_it ? rt::Guarantee::kept : rt::Guarantee::no_form);
        EXPECT_EQ(s.run("curve-accuracy", 0, 0).guarantee, rt::Guarantee::none) << "nothing was asked for";
        for (prepare::Choice& choice : s.frame.choices) choice.error_rad += 0.01F;  // nothing is exact
        for (prepare::Candidate& candidate : s.frame.candidates) candidate.importance = 1;
        const Cut& cut = s.run("curve-accuracy", 0, 0.009);
        EXPECT_EQ(cut.guarantee, rt::Guarantee::no_form);
        EXPECT_EQ(check_legal(s.frame, cut), "") << "the best that is there is drawn";
        EXPECT_FALSE(cut.items.empty());
    });
}

TEST(CommonError, OddErrorsAndCostsEndAndStayLegal) {
    for (const float bad : {0.0F, std::nanf(""), static_cast<float>(infinity), -1.0F}) {
        for_frames(40, 20, [&](Scene& s, Random&) {
            const double full = static_cast<double>(s.run("flat", infinity).predicted_us);
            for (std::size_t i = 0; i < s.frame.choices.size(); i += 3) s.frame.choices[i].error_rad = bad;
            for (std::size_t i = 1; i < s.frame.choices.size(); i += 3) s.frame.choices[i].cost = {bad, bad};
            for (const double budget : {0.0, 0.5 * full, infinity, std::nan("")}) {
                EXPECT_EQ(check_legal(s.frame, s.run("curve-budget", budget)), "");
                EXPECT_EQ(check_legal(s.frame, s.run("curve-accuracy", budget, 0.01)), "");
            }
            EXPECT_EQ(check_legal(s.frame, s.run("curve-accuracy", 0, std::nan(""))), "");
        });
    }
}

}  // namespace
}  // namespace surefoot::select
