// Preparation: legal trees, conservative visibility, equal arrays at any worker count, finite numbers everywhere.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "render/model/form_range.hpp"
#include "render/prepare/evaluate.hpp"
#include "render/prepare/prepared.hpp"
#include "render/prepare/tree_passes.hpp"
#include "tests/prepare/random_model.hpp"

namespace surefoot::prepare {
namespace {

using test::random_model;
using test::random_pose;

const model::CostModel costs = model::default_costs();

PreparedFrame prepared(const model::Model& m, const Region& region, const PrepareOptions& options = {}) {
    Preparer preparer(m, costs, options);
    PreparedFrame frame;
    preparer.reserve(frame);
    preparer.run(region, {640, 360}, 1, 1.0, 0.1, frame);
    return frame;
}

void expect_sound(const model::Model& m, const PreparedFrame& f) {
    ASSERT_FALSE(f.candidates.empty());
    EXPECT_EQ(f.candidates[0].node, 0U);
    std::size_t next_child = 1, next_choice = 0;
    for (std::size_t i = 0; i < f.candidates.size(); ++i) {
        const Candidate& c = f.candidates[i];
        ASSERT_GE(c.choice_count, 1U);
        ASSERT_EQ(c.first_choice, next_choice);  // no gaps
        next_choice += c.choice_count;
        if (c.child_count > 0) {
            ASSERT_EQ(c.first_child, next_child);
            next_child += c.child_count;
            ASSERT_LE(next_child, f.candidates.size());
        } else {
            EXPECT_EQ(c.first_child, none);
        }
        for (Index k = 0; k < c.child_count; ++k) {
            EXPECT_EQ(f.candidates[c.first_child + k].parent, i);
            EXPECT_EQ(m.nodes[f.candidates[c.first_child + k].node].parent, c.node);
        }
        const Candidate* parent = c.parent == none ? nullptr : &f.candidates[c.parent];
        float benefit = 1, subtree = std::numeric_limits<float>::infinity();
        if (parent != nullptr) {
            benefit = f.choices[parent->first_choice + parent->choice_count - 1].benefit;
            subtree = f.choices[parent->first_choice + parent->choice_count - 1].subtree_benefit;
        }
        for (std::uint32_t k = 0; k < c.choice_count; ++k) {
            const Choice& choice = f.choices[c.first_choice + k];
            EXPECT_TRUE(std::isfinite(choice.error_rad) && std::isfinite(choice.cost.submit_us) &&
                        std::isfinite(choice.cost.raster_us));
            EXPECT_TRUE(choice.benefit >= 0 && choice.benefit <= 1 && choice.subtree_benefit >= 0 && choice.subtree_benefit <= 1);
            EXPECT_LE(choice.benefit, benefit);
            EXPECT_LE(choice.subtree_benefit, subtree);
            benefit = choice.benefit;
            subtree = choice.subtree_benefit;
            if (k == 0) continue;
            const Choice& coarser = f.choices[c.first_choice + k - 1];
            EXPECT_LT(choice.error_rad, coarser.error_rad);
            EXPECT_GT(cost_metric(costs.combine, choice.cost), cost_metric(costs.combine, coarser.cost));
        }
    }
    EXPECT_EQ(next_child, f.candidates.size());
    EXPECT_EQ(next_choice, f.choices.size());
}

TEST(Prepare, RandomTreesAreSoundAndMonotone) {
    Random random(3);
    int seen = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        const model::Model m = random_model(seed, 1 + random.below(300));
        Region region{random_pose(random), random.range(0, 2), random.range(0, 0.3)};
        const PreparedFrame f = prepared(m, region);
        if (f.candidates.empty()) continue;
        ++seen;
        expect_sound(m, f);
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(seen, 150);
}

std::array<std::uint32_t, 2> bits(const model::ItemCost& cost) { return std::bit_cast<std::array<std::uint32_t, 2>>(cost); }

bool same(const PreparedFrame& a, const PreparedFrame& b) {
    if (a.candidates.size() != b.candidates.size() || a.choices.size() != b.choices.size() || a.visits != b.visits) return false;
    for (std::size_t i = 0; i < a.candidates.size(); ++i) {
        const Candidate &x = a.candidates[i], &y = b.candidates[i];
        if (x.node != y.node || x.parent != y.parent || x.first_child != y.first_child || x.child_count != y.child_count ||
            x.first_choice != y.first_choice || x.choice_count != y.choice_count || x.pixels != y.pixels ||
            x.floor_open != y.floor_open || bits(x.children_cost) != bits(y.children_cost) ||
            bits(x.floor_cost) != bits(y.floor_cost)) {
            return false;
        }
    }
    static_assert(sizeof(Choice) == 40);  // no padding: bytes can be compared
    return std::memcmp(a.choices.data(), b.choices.data(), a.choices.size() * sizeof(Choice)) == 0;
}

TEST(Prepare, ArraysAreEqualWithOneTwoAndFourWorkers) {
    const model::Model m = test::town(7);
    Random random(5);
    PrepareOptions options;
    options.max_visits = 4000;  // the error target adapts too
    std::vector<std::unique_ptr<Preparer>> preparers;
    for (const int workers : {1, 2, 4}) {
        options.workers = workers;
        preparers.push_back(std::make_unique<Preparer>(m, costs, options));
    }
    std::vector<PreparedFrame> frames(3);
    std::size_t largest = 0;
    for (int i = 0; i < 20; ++i) {
        const Region region{random_pose(random, 200), 0.5, 0.05};
        for (std::size_t w = 0; w < 3; ++w) {
            preparers[w]->reserve(frames[w]);
            preparers[w]->run(region, {1280, 720}, 1, 2, 0.2, frames[w]);
        }
        largest = std::max(largest, frames[0].candidates.size());
        EXPECT_TRUE(same(frames[0], frames[1]));
        EXPECT_TRUE(same(frames[0], frames[2]));
    }
    EXPECT_GT(largest, 1000U);
}

/// Coarse forms look wrong, and cover a third too little or too much.
void measure_losses(model::Model& m) {
    m.colours = {{0.2F, 0.2F, 0.2F}, 0.02F};
    m.losses.assign(m.reps.size(), {0.33F, {0.01F, 0.012F, 0.015F}});
    for (const model::Node& node : m.nodes)
        if (node.child_count == 0) m.losses[node.first_rep + node.rep_count - 1] = {};
}

TEST(Prepare, ValuesBeforeTheSkyAreSoundAndEqualAtAnyWorkerCount) {
    model::Model m = test::town(7);
    measure_losses(m);
    Random random(5);
    double before_sky = 0, as_the_things = 0;
    for (int i = 0; i < 20; ++i) {
        const Region region{random_pose(random, 200), 0.5, 0.05};
        std::vector<PreparedFrame> frames;
        PrepareOptions options;
        for (const int workers : {1, 2, 4}) {
            options.workers = workers;
            frames.push_back(prepared(m, region, options));
        }
        EXPECT_TRUE(same(frames[0], frames[1]));
        EXPECT_TRUE(same(frames[0], frames[2]));
        const PreparedFrame& f = frames[0];
        double leaves = 0;
        for (const Candidate& c : f.candidates) {
            const std::span<const Choice> choices(&f.choices[c.first_choice], c.choice_count);
            EXPECT_GE(choices[0].value, 0);
            for (std::size_t k = 1; k < choices.size(); ++k) {
                EXPECT_GE(choices[k].value, choices[k - 1].value);
                EXPECT_LE(choices[k].rate, choices[k - 1].rate);
            }
            if (c.child_count == 0) leaves += static_cast<double>(choices.back().value);
        }
        EXPECT_NEAR(leaves, f.full_value, 1e-4 * f.full_value);
        EXPECT_NEAR(f.curve.full_value, f.full_value, 1e-2 * f.full_value) << "but for nodes that are fine enough unopened";
        before_sky += f.full_value;
        options.sky = {0.2F, 0.2F, 0.2F};  // of the things' own colour
        as_the_things += prepared(m, region, options).full_value;
    }
    EXPECT_GT(before_sky, 1.05 * as_the_things) << "or the sky counts for nothing";
}

TEST(Prepare, AnotherResolutionKnowsTheSkyToo) {
    model::Model m = test::town(7);
    measure_losses(m);
    Random random(5);
    Preparer preparer(m, costs, {});
    PreparedFrame frame;
    preparer.reserve(frame);
    for (int i = 0; i < 5; ++i) {
        preparer.run({random_pose(random, 200), 0.5, 0.05}, {640, 360}, 1, 1.0, 0.1, frame);
        EXPECT_EQ(preparer.value_at(1).full_value, frame.curve.full_value);
    }
}

TEST(Prepare, EveryLeafThatAnyEyeOfTheRegionSeesIsCovered) {
    Random random(11);
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        const model::Model m = random_model(1000 + seed, 120);
        PrepareOptions options;
        options.full_depth = true;
        const Region region{random_pose(random), random.range(0, 1.5), random.range(0, 0.2)};
        const PreparedFrame f = prepared(m, region, options);
        std::vector<bool> found(m.nodes.size());
        for (const Candidate& c : f.candidates) found[c.node] = true;
        for (int eye = 0; eye < 8; ++eye) {
            Pose pose = region.centre;
            dvec3 step(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1));
            if (glm::length(step) > 1) step = glm::normalize(step);
            pose.position += step * region.radius_m;
            const dvec3 axis = glm::normalize(dvec3(random.range(-1, 1), random.range(-1, 1), random.range(0.1, 1)));
            pose.orientation = pose.orientation * glm::angleAxis(region.angle_rad * random.unit(), axis);
            const model::Frustum frustum = model::make_frustum(pose, {640, 360}, 1000);
            for (Index n = 0; n < m.nodes.size(); ++n) {
                // The exact frustum of a pose is conservative itself: ask for a point of the box inside all planes.
                if (m.nodes[n].child_count > 0) continue;
                const Box& box = m.nodes[n].box;
                const dvec3 p(random.range(box.min.x, box.max.x), random.range(box.min.y, box.max.y),
                              random.range(box.min.z, box.max.z));
                bool inside = true;
                for (const dvec4& plane : frustum.planes) inside = inside && glm::dot(dvec3(plane), p) + plane.w >= 0;
                EXPECT_TRUE(!inside || found[n]) << "seed " << seed << " leaf " << n;
            }
        }
    }
}

TEST(Prepare, PlaneMasksChangeNoAnswer) {
    Random random(13);
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const model::Model m = random_model(2000 + seed, 150);
        const model::Frustum frustum = model::make_frustum(random_pose(random), {640, 360}, 1000);
        std::vector<PlaneMask> masks(m.nodes.size(), all_planes);
        for (Index n = 0; n < m.nodes.size(); ++n) {
            const PlaneMask above = n == 0 ? all_planes : masks[m.nodes[n].parent];
            masks[n] = above == culled ? culled : cull_planes(frustum, m.nodes[n].box, above);
            const bool visible = model::visible(frustum, m.nodes[n].box);
            EXPECT_TRUE(above == culled || (masks[n] != culled) == visible) << "seed " << seed << " node " << n;
        }
    }
}

TEST(Prepare, ClusterWithNoVisibleChildIsNoCandidate) {
    // The cluster's box reaches into view, its two small children lie beside it (Maciel figure 3.16), two levels deep.
    model::Model m;
    m.placements.emplace_back();
    Random random(1);
    const auto node = [&](const dvec3& low, const dvec3& high, Index parent, Index first, std::uint32_t count) {
        model::Node n;
        n.box = {low, high};
        n.parent = parent;
        n.first_child = first;
        n.child_count = count;
        m.nodes.push_back(n);
    };
    node({-100, -1, -20}, {100, 1, -5}, none, 1, 2);
    node({-100, -1, -20}, {100, 1, -5}, 0, 3, 1);  // seen, but what it stands for is not
    node({-1, -1, -12}, {1, 1, -10}, 0, none, 0);  // seen
    node({-100, -1, -20}, {100, 1, -5}, 1, 4, 2);
    node({-100, -1, -6}, {-90, 1, -5}, 3, none, 0);
    node({90, -1, -6}, {100, 1, -5}, 3, none, 0);
    for (model::Node& n : m.nodes) test::add_reps(m, n, random, 1, 5.0, 100);
    const PreparedFrame f = prepared(m, {});
    ASSERT_EQ(f.candidates.size(), 2U);
    EXPECT_EQ(f.candidates[1].node, 2U);
    EXPECT_EQ(f.candidates[0].child_count, 1U);
    EXPECT_EQ(f.visits, 6U);
}

TEST(Prepare, NothingInViewGivesNoCandidates) {
    const model::Model m = random_model(1, 50);
    Region region;
    region.centre.position = dvec3(0, 0, -500);
    EXPECT_TRUE(prepared(m, region).candidates.empty());
}

TEST(Prepare, EyeInABoxAndBadPosesStayFinite) {
    const model::Model m = test::town(4);
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    for (const double bad : {0.0, nan, inf, -inf, 1e300}) {
        Region region;
        region.centre.position = dvec3(bad, 0, 0);
        expect_sound(m, prepared(m, bad == 1e300 ? Region{} : region));
        region = {};
        region.centre.orientation = dquat(bad, bad, bad, bad);
        region.centre.fov_y_rad = bad;
        region.radius_m = bad;
        region.angle_rad = bad;
        expect_sound(m, prepared(m, region));
    }
}

TEST(Prepare, CapacityReachedLeavesALegalTree) {
    const model::Model m = test::town(5);
    for (const std::uint32_t most : {1U, 2U, 5U, 17U, 100U, 301U}) {
        PrepareOptions options;
        options.max_candidates = most;
        Region region;
        region.centre.position = dvec3(0, 3, 90);
        const PreparedFrame f = prepared(m, region, options);
        EXPECT_TRUE(f.truncated);
        EXPECT_LE(f.candidates.size(), most);
        expect_sound(m, f);
        options.max_candidates = 1U << 18U;
        options.max_choices = most;
        const PreparedFrame g = prepared(m, region, options);
        EXPECT_TRUE(g.truncated);
        EXPECT_LE(g.choices.size(), std::max(most, 3U));
        expect_sound(m, g);
    }
}

TEST(Prepare, TooManyVisitsRaiseTheErrorTargetUntilTheyFit) {
    const model::Model m = test::town(7);
    PrepareOptions options;
    options.max_visits = 1000;
    Preparer preparer(m, costs, options);
    PreparedFrame f;
    preparer.reserve(f);
    Region region;
    region.centre.position = dvec3(0, 3, 300);
    preparer.run(region, {1280, 720}, 0, 0, 0, f);
    EXPECT_GT(f.visits, 4000U);
    for (int i = 0; i < 20; ++i) preparer.run(region, {1280, 720}, 0, 0, 0, f);
    EXPECT_LE(f.visits, 1000U);
    const std::uint32_t steady_visits = f.visits;
    for (int i = 0; i < 10; ++i) {
        preparer.run(region, {1280, 720}, 0, 0, 0, f);
        EXPECT_LE(f.visits, 1000U);
    }
    EXPECT_GT(steady_visits, 300U);
}

TEST(Prepare, FullDepthGoesToEveryVisibleLeaf) {
    const model::Model m = test::town(5);
    PrepareOptions options;
    options.full_depth = true;
    Region region;
    region.centre.position = dvec3(0, 3, 400);
    const PreparedFrame f = prepared(m, region, options);
    for (const Candidate& c : f.candidates) {
        if (c.child_count > 0) continue;
        EXPECT_EQ(m.nodes[c.node].child_count, 0U);
        EXPECT_EQ(f.choices[c.first_choice + c.choice_count - 1].error_rad, 0.0F);
    }
    EXPECT_EQ(f.candidates.size(), m.nodes.size());
}

TEST(Prepare, PictureIsNoChoiceWhereSomeEyeOfTheRegionIsTooNear) {
    model::Representation rep;
    rep.everywhere = false;
    rep.min_distance_m = 3;
    EXPECT_FALSE(legal(rep, 2.9F));
    EXPECT_TRUE(legal(rep, 3.0F));
    rep.min_distance_m = 0;
    EXPECT_FALSE(legal(rep, 0.0F));
    RegionView view;
    view.radius_m = 1;
    EXPECT_FLOAT_EQ(nearest_distance(view, {dvec3(4, -1, -1), dvec3(6, 1, 1)}), 3.0F);
    EXPECT_EQ(nearest_distance(view, {dvec3(0.5, -1, -1), dvec3(6, 1, 1)}), 0.0F);
}

TEST(Prepare, ChainOfTenThousandDoesNotRecurse) {
    model::Model m;
    m.placements.emplace_back();
    Random random(1);
    for (Index i = 0; i < 10000; ++i) {
        model::Node n;
        n.box = {dvec3(-1, -1, -3), dvec3(1, 1, -1)};
        n.parent = i == 0 ? none : i - 1;
        n.child_count = i + 1 < 10000 ? 1 : 0;
        n.first_child = i + 1 < 10000 ? i + 1 : none;
        m.nodes.push_back(n);
    }
    for (model::Node& n : m.nodes) test::add_reps(m, n, random, 1, 0.5, 10);
    EXPECT_EQ(prepared(m, {}).candidates.size(), 10000U);
}

/// A leaf with two forms, the finer one `step_us` dearer, both equally wrong.
float benefit_of_step(float step_us) {
    PreparedFrame frame;
    Candidate leaf;
    leaf.choice_count = 2;
    frame.candidates.push_back(leaf);
    Choice coarse, fine;
    coarse.benefit = coarse.subtree_benefit = 0.8F;
    coarse.cost.submit_us = 10;
    fine.cost.submit_us = 10 + step_us;
    frame.choices = {coarse, fine};
    model::FrameCombine combine;
    combine.submit_weight = 1;
    combine.raster_weight = 1;
    combine.max_weight = 0;
    std::vector<Weight> weights(1);
    propagate_up(combine, 1e-3F, weights, frame);
    enforce_monotone_benefit(frame);
    EXPECT_EQ(frame.choices[0].benefit, frame.choices[0].subtree_benefit);
    return frame.choices[0].benefit;
}

TEST(CostPenalty, OfTwoStepsThatAreEquallyWorthTheCheaperGoesFirst) {
    EXPECT_FLOAT_EQ(benefit_of_step(0), 0.8F);
    EXPECT_FLOAT_EQ(benefit_of_step(2000), 0.4F);
    EXPECT_GT(benefit_of_step(8), benefit_of_step(1988));
    EXPECT_FLOAT_EQ(benefit_of_step(-5), 0.8F) << "what costs less than nothing is worth no more than it is";
}

/// A node that costs 500 ms and its only child, dearer by `factor`: is the child the floor?
bool child_is_the_floor(float factor) {
    PreparedFrame frame;
    Candidate node, child;
    node.choice_count = child.choice_count = 1;
    node.first_child = child.first_choice = 1;
    node.child_count = 1;
    child.parent = 0;
    frame.candidates = {node, child};
    frame.choices.resize(2);
    frame.choices[0].cost.raster_us = 500'000;
    frame.choices[1].cost.raster_us = 500'000 * factor;
    std::vector<Weight> weights(2);
    propagate_up({}, 1e-3F, weights, frame);
    return frame.candidates[0].floor_open;
}

TEST(Floor, OpensWhereTheChildrenAreNoDearerButForRounding) {
    EXPECT_TRUE(child_is_the_floor(0.9F));
    EXPECT_TRUE(child_is_the_floor(1.0F));
    EXPECT_TRUE(child_is_the_floor(1.00001F)) << "as much as the order of a sum may change it";
    EXPECT_FALSE(child_is_the_floor(1.001F));
    EXPECT_FALSE(child_is_the_floor(2.0F));
}

}  // namespace
}  // namespace surefoot::prepare
