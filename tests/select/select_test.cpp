// Selection: the bound on predicted cost, legal cuts for every selector and budget, the order of the searches, hysteresis.
#include "render/select/registry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "tests/select/count_malloc.hpp"
#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

using test::infinity;
using test::Scene;

bool is_search(std::string_view name) { return (*selector_named(name))->goes_by == GoesBy::budget; }

double predicted(const Scene& s, double submit, double raster) {
    const model::FrameCombine& c = s.costs.combine;
    const double items = submit * c.submit_weight + raster * c.raster_weight + std::max(submit, raster) * c.max_weight;
    const double end = c.submit_weight * s.costs.slice_us;
    return (c.fixed_us + end + items * (1.0 + end / 1000.0)) * s.costs.headroom;
}

TEST(Select, PredictedStaysWithinBudgetOrFloorAndCutsAreLegalOnTenThousandTrees) {
    Random random(17);
    std::map<std::string_view, std::pair<double, int>> unused;
    for (std::uint64_t seed = 0; seed < 10000; ++seed) {
        Scene s(test::random_model(seed, 2 + random.below(60)));
        s.costs.combine = {static_cast<float>(random.range(0, 600)), 1.0F, static_cast<float>(random.range(0.2, 1.0)),
                           random.below(2) == 0 ? 0.0F : 0.5F};
        prepare::Region region{test::random_pose(random), random.range(0, 0.5), random.range(0, 0.1)};
        region.centre.position *= 0.5;
        s.look(region);
        if (s.frame.candidates.empty()) continue;
        const double full = static_cast<double>(s.run("flat", infinity).predicted_us);
        const double floor = static_cast<double>(s.cut.floor_us);
        EXPECT_LE(floor, full * (1 + 1e-6));
        const double between = floor + (full - floor) * random.unit();
        for (const double budget : {between, seed % 4 == 0   ? 0.0
                                             : seed % 4 == 1 ? infinity
                                             : seed % 4 == 2 ? std::nan("")
                                                             : -5.0}) {
            for (const std::string_view name : selector_names()) {
                const Cut& cut = s.run(name, budget);
                ASSERT_EQ(check_legal(s.frame, cut), "") << name << " seed " << seed;
                ASSERT_TRUE(std::isfinite(cut.predicted_us));
                const bool binds = !(static_cast<double>(cut.floor_us) * (1.0 + 2e-6) <= budget);
                if (is_search(name)) {
                    ASSERT_LE(static_cast<double>(cut.predicted_us),
                              std::max(budget > 0 ? budget : 0.0, static_cast<double>(cut.floor_us)))
                        << name << " seed " << seed << " budget " << budget;
                }
                ASSERT_EQ(cut.floor_binds, binds) << name << " seed " << seed;
                ASSERT_NEAR(static_cast<double>(cut.predicted_us), predicted(s, cut.sum.submit_us, cut.sum.raster_us),
                            1e-4 * static_cast<double>(cut.predicted_us));
                if (budget == between && !binds && full > 1.05 * floor) {
                    unused[name].first += (budget - static_cast<double>(cut.predicted_us)) / (budget - floor);
                    ++unused[name].second;
                }
            }
        }
    }
    for (const auto& [name, sum] : unused) {
        std::printf("%-18s leaves %5.1f %% of the budget above the floor unused (mean of %d trees)\n", std::string(name).c_str(),
                    100 * sum.first / sum.second, sum.second);
    }
    EXPECT_GT(unused["two-stage"].second, 3000);
}

TEST(Select, UnlimitedBudgetGivesWhatFlatGives) {
    Random random(19);
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Scene s(test::random_model(seed, 100));
        s.look({test::random_pose(random, 30), 0.1, 0.02});
        if (s.frame.candidates.empty()) continue;
        const std::uint64_t flat = s.run("flat", infinity).hash;
        for (const char* name : {"depth-first", "best-first", "two-stage", "curve-budget"})
            EXPECT_EQ(s.run(name, infinity).hash, flat) << name;
    }
}

/// A cut in the making, for the definition: what is drawn and its cost.
struct Growing {
    struct Item {
        Index candidate;
        std::uint32_t choice;
    };
    std::vector<Item> items;
    double submit = 0, raster = 0;
};

/// The documented rule, read off directly: from the floor, always the steps of greatest key, together where they fit; else one
/// after the other, by candidate, up to the first that does not fit.
class Definition {
public:
    Definition(const Scene& s, double budget, bool subtree) : s_(s), f_(s.frame), budget_(budget), subtree_(subtree) {}

    std::vector<std::pair<Index, Index>> cut() const {
        Growing now = floor();
        while (true) {
            const float key = greatest(now);
            if (key < 0) break;
            Growing all = now;
            while (greatest(all) == key) buy(all, key);
            if (fits(all)) {
                now = all;
                continue;
            }
            for (Growing next = now;; now = next) {
                buy(next, key);
                if (!fits(next)) break;
            }
            break;
        }
        std::vector<std::pair<Index, Index>> items;
        for (const auto& o : now.items) items.emplace_back(o.candidate, f_.candidates[o.candidate].first_choice + o.choice);
        std::sort(items.begin(), items.end());
        return items;
    }

private:
    Growing floor() const {
        Growing g;
        std::vector<Index> walk{0};
        for (std::size_t i = 0; i < walk.size(); ++i) {
            const auto& c = f_.candidates[walk[i]];
            if (c.floor_open) {
                for (Index k = 0; k < c.child_count; ++k) walk.push_back(c.first_child + k);
                continue;
            }
            g.items.push_back({walk[i], 0});
            g.submit += f_.choices[c.first_choice].cost.submit_us;
            g.raster += f_.choices[c.first_choice].cost.raster_us;
        }
        return g;
    }
    bool fits(const Growing& g) const { return predicted(s_, g.submit, g.raster) * (1 + 1e-6) <= budget_; }
    /// Of the item's next step; -1: it has none.
    float key(const Growing::Item& o) const {
        const auto& c = f_.candidates[o.candidate];
        if (o.choice + 1 >= c.choice_count && c.child_count == 0) return -1;
        const auto& choice = f_.choices[c.first_choice + o.choice];
        return subtree_ ? choice.subtree_benefit : choice.benefit;
    }
    float greatest(const Growing& g) const {
        float most = -1;
        for (const auto& o : g.items) most = std::max(most, key(o));
        return most;
    }
    /// The first step of that key.
    void buy(Growing& g, float wanted) const {
        auto best = g.items.end();
        for (auto o = g.items.begin(); o != g.items.end(); ++o) {
            if (key(*o) == wanted && (best == g.items.end() || o->candidate < best->candidate)) best = o;
        }
        const Growing::Item step = *best;
        const auto& c = f_.candidates[step.candidate];
        const auto& own = f_.choices[c.first_choice + step.choice].cost;
        const bool finer = step.choice + 1 < c.choice_count;
        const auto& next = finer ? f_.choices[c.first_choice + step.choice + 1].cost : c.children_cost;
        g.submit += static_cast<double>(next.submit_us) - static_cast<double>(own.submit_us);
        g.raster += static_cast<double>(next.raster_us) - static_cast<double>(own.raster_us);
        g.items.erase(best);
        if (finer) return g.items.push_back({step.candidate, step.choice + 1});
        for (Index k = 0; k < c.child_count; ++k) g.items.push_back({c.first_child + k, 0});
    }

    const Scene& s_;
    const prepare::PreparedFrame& f_;
    double budget_;
    bool subtree_;
};

TEST(Select, BestFirstAndTwoStageFollowTheirDefinition) {
    Random random(23);
    int compared = 0, differ = 0;
    for (std::uint64_t seed = 0; seed < 1500; ++seed) {
        Scene s(test::random_model(seed, 40));
        s.state.hysteresis = 1;
        prepare::Region region{test::random_pose(random, 30), 0.1, 0.02};
        s.look(region);
        if (s.frame.candidates.empty()) continue;
        // Quantised keys, as the queue has them: else the definition would order what the queue calls equal.
        for (prepare::Choice& c : s.frame.choices) {
            c.benefit = std::exp2(std::round(8 * std::log2(std::max(c.benefit, 1e-6F))) / 8);
            c.subtree_benefit = std::exp2(std::round(8 * std::log2(std::max(c.subtree_benefit, 1e-6F))) / 8);
        }
        const double full = static_cast<double>(s.run("flat", infinity).predicted_us),
                     floor = static_cast<double>(s.cut.floor_us);
        const double budget = floor + (full - floor) * random.unit();
        for (const bool subtree : {false, true}) {
            const auto expected = Definition(s, budget, subtree).cut();
            const Cut& cut = s.run(subtree ? "two-stage" : "best-first", budget);
            std::vector<std::pair<Index, Index>> items;
            for (const CutItem& item : cut.items) items.emplace_back(item.candidate, item.choice);
            ASSERT_EQ(items, expected) << "seed " << seed << (subtree ? " two-stage" : " best-first");
            ++compared;
        }
        const std::uint64_t two_stage = s.cut.hash;
        differ += s.run("best-first", budget).hash != two_stage ? 1 : 0;
    }
    EXPECT_GT(compared, 1000);
    EXPECT_GT(differ, 10);  // they are two selectors
}

TEST(Select, TwoStageRefinesTheClusterWhoseObjectsAreNear) {
    // Maciel figure 3.17: cluster 1 begins near the eye but its object is far; cluster 2 begins farther, its object is near.
    model::Model m;
    m.placements.emplace_back();
    Random random(1);
    const auto node = [&](double near_z, double far_z, double half, Index parent, Index first, std::uint32_t count) {
        model::Node n;
        n.box = {dvec3(-half, -1, -far_z), dvec3(half, 1, -near_z)};
        n.parent = parent;
        n.first_child = first;
        n.child_count = count;
        m.nodes.push_back(n);
    };
    node(2, 60, 4, none, 1, 2);
    node(2, 60, 2, 0, 3, 1);
    node(5, 60, 2, 0, 4, 1);
    node(58, 60, 2, 1, none, 0);
    node(5, 7, 2, 2, none, 0);
    test::add_reps(m, m.nodes[0], random, 1, 5, 10);
    for (Index i = 1; i < 5; ++i) test::add_reps(m, m.nodes[i], random, 1, i < 3 ? 1.0 : 0.5, i < 3 ? 100 : 2000);
    for (Index i = 3; i < 5; ++i) m.reps[m.nodes[i].first_rep].area_m2 = {0, 0, 0};
    for (Index i = 1; i < 3; ++i) m.reps[m.nodes[i].first_rep].area_m2 = {0, 0, 0};
    Scene s(std::move(m));
    s.look({});
    ASSERT_EQ(s.frame.candidates.size(), 5U);
    const auto opened = [&](std::string_view name) {
        double budget = 0;  // raise it until one of the clusters is opened
        for (; budget < 1e5; budget += 20) {
            s.forget();
            for (const CutItem& item : s.run(name, budget).items) {
                if (item.node >= 3) return item.node;
            }
        }
        return none;
    };
    EXPECT_EQ(opened("best-first"), 3U);
    EXPECT_EQ(opened("two-stage"), 4U);
}

TEST(Select, PublishedAccountingLeavesMoreOfTheBudgetUnused) {
    Scene s(test::town(6));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 100);
    s.look(region);
    const double full = static_cast<double>(s.run("flat", infinity).predicted_us);
    for (const auto& [corrected, published] :
         {std::pair{"best-first", "best-first-1994"}, std::pair{"two-stage", "two-stage-1994"}}) {
        s.forget();
        const float used = s.run(corrected, 0.5 * full).predicted_us;
        s.forget();
        EXPECT_LT(s.run(published, 0.5 * full).predicted_us, used);
    }
}

TEST(Select, AccuracyTargetStopsWhereItIsReached) {
    Scene s(test::town(6));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 100);
    s.look(region);
    for (const double target : {0.2, 0.02, 0.005}) {
        s.forget();
        const Cut& cut = s.run("two-stage", infinity, target);
        EXPECT_LE(static_cast<double>(cut.worst_error_rad), target);
        s.forget();
        EXPECT_GT(s.run("two-stage", infinity).triangles, cut.triangles / 2);
    }
    s.forget();
    const std::uint64_t coarse = s.run("two-stage", infinity, 0.2).triangles;
    s.forget();
    EXPECT_LT(coarse, s.run("two-stage", infinity, 0.005).triangles);
}

/// Switches a frame over 200 frames in which eye and orientation shake by up to 2 %.
double switches_under_dither(float hysteresis, std::uint64_t seed) {
    Scene s(test::town(6));
    s.state.hysteresis = hysteresis;
    Random random(seed);
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 100);
    s.look(region);
    const double budget = 0.4 * static_cast<double>(s.run("flat", infinity).predicted_us);
    s.forget();
    std::uint64_t switches = 0;
    for (int i = 0; i < 220; ++i) {
        region.centre.position = dvec3(random.range(-0.2, 0.2), 3, 100 * random.range(0.999, 1.001));
        s.look(region);
        s.run("two-stage", budget * random.range(0.99, 1.01));
        if (i >= 20) switches += s.cut.switches;
    }
    return static_cast<double>(switches) / 200;
}

TEST(Select, HysteresisKeepsFormsWhileTheEyeTrembles) {
    const double with = switches_under_dither(1.25F, 1), without = switches_under_dither(1.0F, 1);
    std::printf("switches a frame under dither: %.2f with hysteresis, %.2f without\n", with, without);
    EXPECT_LT(with, 0.1 * without);
    EXPECT_LT(with, 1.0);
}

TEST(Select, ThingsThatComeIntoViewAreNoSwitches) {
    Scene s(test::town(5));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 20);
    s.look(region);
    s.run("flat", infinity);
    EXPECT_EQ(s.cut.switches, 0U);
    region.centre.orientation = glm::angleAxis(1.5, dvec3(0, 1, 0));
    s.look(region);
    s.run("flat", infinity);
    EXPECT_EQ(s.cut.switches, 0U);
    s.run("two-stage", 0.0);
    EXPECT_GT(s.cut.switches, 0U);
    s.run("two-stage", 0.0);
    EXPECT_EQ(s.cut.switches, 0U);
}

TEST(Select, AFrameAllocatesNothing) {
    Scene s(test::town(6));
    Random random(29);
    s.look({test::random_pose(random, 200), 0.3, 0.05});  // oneTBB makes its own things when it is first asked
    for (const std::string_view name : selector_names()) ASSERT_NE(find_selector(name), nullptr);  // made when first asked for
    for (int i = 0; i < 20; ++i) {
        const prepare::Region region{test::random_pose(random, 200), 0.3, 0.05};
        const std::uint64_t before = test::allocations();
        s.look(region);
        for (const std::string_view name : selector_names()) {
            s.run(name, i % 3 == 0 ? infinity : 3000.0 * i);
            plan_slices(s.input(3000.0 * i), s.cut, 1000, s.plan);
        }
        EXPECT_EQ(test::allocations(), before) << "frame " << i;
    }
}

TEST(Select, EqualBenefitsZeroCostsAndOneNodeTerminate) {
    Scene s(test::town(2));
    for (auto& grid : s.costs.grids) {
        for (auto& cell : grid.cells) cell = {0, 0};
    }
    s.costs.combine.fixed_us = 0;
    s.look({Pose{}, 30.0, 1.0});
    ASSERT_GT(s.frame.candidates.size(), 3U);
    for (auto& choice : s.frame.choices) choice.benefit = choice.subtree_benefit = std::nanf("");
    for (const std::string_view name : selector_names()) {
        EXPECT_EQ(check_legal(s.frame, s.run(name, 0.0)), "") << name;
        EXPECT_EQ(check_legal(s.frame, s.run(name, infinity)), "") << name;
    }
    Scene one(test::random_model(1, 1));
    one.look({Pose{}, 100.0, 1.0});
    for (const std::string_view name : selector_names()) EXPECT_EQ(one.run(name, infinity).items.size(), 1U) << name;
}

TEST(Select, EmptyFrameGivesAnEmptyCut) {
    Scene s(test::random_model(1, 50));
    prepare::Region region;
    region.centre.position = dvec3(0, 0, -500);
    s.look(region);
    for (const std::string_view name : selector_names()) {
        EXPECT_TRUE(s.run(name, infinity).items.empty());
        plan_slices(s.input(1000), s.cut, 1000, s.plan);
        EXPECT_TRUE(s.plan.slices.empty());
    }
}

TEST(Select, UnknownNamesAreRefused) {
    EXPECT_EQ(find_selector("three-stage"), nullptr);
    ASSERT_FALSE(selector_named("three-stage").ok());
    for (const std::string_view name : selector_names()) {
        EXPECT_EQ((*selector_named(name))->name, name);
        EXPECT_NE(selector_named("three-stage").error().remedy.find(name), std::string::npos);
    }
}

TEST(Select, EverySelectorIsExplainedAndMadeOnce) {
    std::set<std::string_view> names;
    std::set<const Selector*> made;
    for (const SelectorEntry& entry : selectors()) {
        EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
        EXPECT_TRUE(made.insert(&entry.make()).second) << entry.name;
        EXPECT_EQ(&entry.make(), find_selector(entry.name)) << entry.name;
        EXPECT_GT(entry.help.size(), 10U) << entry.name;
        EXPECT_EQ(entry.help.find('\n'), std::string_view::npos) << entry.name;
    }
    ASSERT_TRUE(names.contains(usual_selector) && names.contains(full_detail_selector));
    EXPECT_EQ((*selector_named(full_detail_selector))->goes_by, GoesBy::nothing);
}

TEST(Select, IllegalCutsAreNamed) {
    Scene s(test::town(3));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 60);
    s.look(region);
    Cut cut = s.run("flat", infinity);
    EXPECT_EQ(check_legal(s.frame, cut), "");
    Cut twice = cut;
    twice.items.push_back(twice.items[0]);
    EXPECT_NE(check_legal(s.frame, twice), "");
    Cut missing = cut;
    missing.items.pop_back();
    EXPECT_NE(check_legal(s.frame, missing), "");
    Cut above = cut;
    above.items.push_back({0, 0, s.frame.choices[0].rep, 0});
    EXPECT_NE(check_legal(s.frame, above), "");
    Cut form = cut;
    form.items[0].choice = 0;
    EXPECT_NE(check_legal(s.frame, form), "");
}

}  // namespace
}  // namespace surefoot::select
