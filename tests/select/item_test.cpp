// Items beside forms: what is refused, what is bought before and after forms, and that the budget holds.
#include "render/select/item.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/select/count_malloc.hpp"
#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

using test::Scene;

constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

Scene town() {
    Scene s(test::town(5));
    prepare::Region region;
    region.centre.position = dvec3(0, 3, 60);
    s.look(region);
    return s;
}

const Cut& run(Scene& s, std::string_view selector, double budget_us, const ItemList& items) {
    SelectInput input = s.input(budget_us);
    input.items = &items;
    find_selector(selector)->run(input, s.state, s.cut);
    return s.cut;
}

double half_of_full(Scene& s) {
    const double full = static_cast<double>(s.run("flat", test::infinity).predicted_us);
    s.forget();
    return 0.5 * full;
}

std::vector<std::string_view> budgeted() {
    std::vector<std::string_view> names;
    for (const SelectorEntry& entry : selectors())
        if (entry.goes_by == GoesBy::budget) names.push_back(entry.name);
    return names;
}

TEST(Items, WithoutAPriceOrAValueAreRefusedAndCounted) {
    ItemList items;
    std::uint32_t refused = 0;
    for (const float bad : {0.0F, -1.0F, nan_f, infinite, -infinite}) {
        EXPECT_FALSE(items.offer({ItemKind::upload, 1, bad, 1}));
        EXPECT_FALSE(items.offer({ItemKind::upload, 1, 1, bad}));
        refused += 2;
        EXPECT_EQ(items.refused(), refused);
    }
    EXPECT_TRUE(items.offer({ItemKind::upload, 1, 1, 1}));
    EXPECT_FALSE(items.offer({ItemKind::upload, 1, 2, 3})) << "offered twice";
    EXPECT_TRUE(items.offer({ItemKind::effect, 1, 1, 1})) << "of another kind, at the same price and value";
    EXPECT_TRUE(items.offer({ItemKind::samples, 4, 1, 1}));
    EXPECT_FALSE(items.offer({ItemKind::samples, 2, 1, 1})) << "a lever's steps come in order";
    EXPECT_FALSE(items.prepay({ItemKind::resolution, 2, -1, 0}));
    EXPECT_TRUE(items.prepay({ItemKind::resolution, 2, 100, 0}));
    EXPECT_EQ(items.offered().size(), 4U);
    for (std::uint32_t i = 4; i < ItemList::capacity; ++i) EXPECT_TRUE(items.offer({ItemKind::refresh, i, 1, 1}));
    EXPECT_FALSE(items.offer({ItemKind::refresh, 1000, 1, 1})) << "full";
    items.clear();
    EXPECT_TRUE(items.offered().empty());
    EXPECT_EQ(items.refused(), 0U);
}

TEST(Items, OfAHighRateAreBoughtBeforeFormsAndOfALowRateAreNot) {
    Scene s = town();
    const double budget = half_of_full(s);
    const auto cost = static_cast<float>(0.1 * budget);
    for (const std::string_view name : budgeted()) {
        s.forget();
        const double alone = s.run(name, budget).value;
        ItemList items;
        items.offer({ItemKind::effect, 1, cost, 1000.0F * cost});
        s.forget();
        run(s, name, budget, items);
        EXPECT_TRUE(s.cut.bought.has(0)) << name;
        EXPECT_LE(s.cut.value, alone) << name << ": forms have less";
        EXPECT_EQ(s.cut.bought.count, 1U);
        EXPECT_FLOAT_EQ(static_cast<float>(s.cut.bought.cost_us), cost);
        EXPECT_LE(static_cast<double>(s.cut.predicted_us), budget) << name;
        EXPECT_GE(static_cast<double>(s.cut.predicted_us), static_cast<double>(cost) * s.costs.headroom) << name;
    }
    const double tight = 0.2 * budget;  // later steps are of things that nearer ones hide: their rates are next to nothing
    for (const std::string_view name : {"two-stage", "threshold", "best-first"}) {
        s.forget();
        const std::uint64_t alone = s.run(name, tight).hash;
        ItemList items;
        items.offer({ItemKind::effect, 1, cost, 1e-9F * cost});
        s.forget();
        run(s, name, tight, items);
        EXPECT_FALSE(s.cut.bought.has(0)) << name;
        EXPECT_EQ(s.cut.hash, alone) << name << ": forms are as without it";
    }
}

TEST(Items, OfALowRateAreBoughtWithWhatIsLeft) {
    Scene s = town();
    const double full = 2 * half_of_full(s);
    ItemList items;
    items.offer({ItemKind::refresh, 7, static_cast<float>(0.1 * full), 1e-6F});
    for (const std::string_view name : budgeted()) {
        s.forget();
        EXPECT_TRUE(run(s, name, 1.3 * full, items).bought.has(0)) << name;
        EXPECT_LE(static_cast<double>(s.cut.predicted_us), 1.3 * full);
    }
    for (const char* name : {"flat", "distance"}) EXPECT_TRUE(run(s, name, 0, items).bought.has(0)) << name << " has no budget";
}

TEST(Items, WithFormsFitTheBudgetOnManyTrees) {
    Random random(43);
    int bought = 0, left = 0;
    for (std::uint64_t seed = 0; seed < 1500; ++seed) {
        Scene s(test::random_model(seed, 2 + static_cast<int>(random.below(50))));
        s.look({test::random_pose(random, 30), 0.1, 0.02});
        if (s.frame.candidates.empty()) continue;
        const double full = static_cast<double>(s.run("flat", test::infinity).predicted_us);
        const double floor = static_cast<double>(s.cut.floor_us);
        const double budget = floor * 0.9 + (1.2 * full - 0.9 * floor) * random.unit();
        ItemList items;
        for (std::uint32_t i = 0; i < 12; ++i)
            items.offer({i < 4 ? ItemKind::samples : ItemKind::upload, i, static_cast<float>(full * random.range(0, 0.2)),
                         static_cast<float>(s.frame.full_value * random.range(0, 0.3))});
        for (const std::string_view name : budgeted()) {
            const Cut& cut = run(s, name, budget, items);
            ASSERT_EQ(check_legal(s.frame, cut), "");
            ASSERT_LE(static_cast<double>(cut.predicted_us), std::max(budget, static_cast<double>(cut.floor_us)))
                << name << " " << seed;
            ASSERT_TRUE(!cut.floor_binds || cut.bought.count == 0) << name;
            double cost_us = 0;
            bool lever_ended = false;
            for (std::size_t i = 0; i < items.offered().size(); ++i) {
                if (cut.bought.has(i)) cost_us += static_cast<double>(items.offered()[i].cost_us);
                if (!is_lever(items.offered()[i].kind)) continue;
                ASSERT_FALSE(lever_ended && cut.bought.has(i)) << "a step without the one before it";
                lever_ended = lever_ended || !cut.bought.has(i);
            }
            ASSERT_NEAR(cut.bought.cost_us, cost_us, 1e-9 * cost_us);
            bought += static_cast<int>(cut.bought.count);
            left += static_cast<int>(items.offered().size()) - static_cast<int>(cut.bought.count);
        }
    }
    EXPECT_GT(bought, 1000);
    EXPECT_GT(left, 1000);
}

TEST(Items, NoneOfferedChangesNoCut) {
    Random random(47);
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        Scene s(test::random_model(seed, 60)), t(test::random_model(seed, 60));
        const prepare::Region region{test::random_pose(random, 30), 0.1, 0.02};
        s.look(region);
        t.look(region);
        if (s.frame.candidates.empty()) continue;
        const double full = static_cast<double>(s.run("flat", test::infinity).predicted_us);
        t.run("flat", test::infinity);
        ItemList none, prepaid;
        none.offer({ItemKind::upload, 1, nan_f, 1});
        prepaid.prepay({ItemKind::resolution, 2, 100, 5});
        for (const std::string_view name : selector_names()) {
            const double budget = full * random.unit();
            const Cut& with = run(s, name, budget, random.below(2) == 0 ? none : prepaid);
            const Cut& without = t.run(name, budget);
            ASSERT_EQ(with.hash, without.hash) << name;
            ASSERT_EQ(with.predicted_us, without.predicted_us);
            ASSERT_EQ(with.floor_us, without.floor_us);
            ASSERT_EQ(with.bought.cost_us, 0.0);
            ASSERT_EQ(with.bought.count + with.bought.refused, 1U);
        }
    }
}

/// How often an item is bought and dropped in 100 frames whose budget trembles about what it needs.
int changes(float hysteresis) {
    Scene s = town();
    s.state.hysteresis = hysteresis;
    const double budget = half_of_full(s);
    Random random(5);
    ItemList items;
    items.offer({ItemKind::effect, 1, static_cast<float>(0.1 * budget), 1e9F});
    const double needed =
        static_cast<double>(s.run("two-stage", 0).floor_us) + 0.1 * budget * static_cast<double>(s.costs.headroom);
    int changed = 0;
    bool before = run(s, "threshold", 1.05 * needed, items).bought.has(0);
    for (int i = 0; i < 100; ++i) {
        const bool now = run(s, "threshold", needed * random.range(1.003, 1.027), items).bought.has(0);
        changed += now != before ? 1 : 0;
        before = now;
    }
    EXPECT_TRUE(before);
    return changed;
}

TEST(Items, ThatWereBoughtStayWhileTheBudgetTrembles) {
    EXPECT_EQ(changes(1.25F), 0);
    Scene s = town();
    const double budget = half_of_full(s);
    ItemList items;
    items.offer({ItemKind::effect, 1, static_cast<float>(0.1 * budget), 1e9F});
    const double needed =
        static_cast<double>(s.run("two-stage", 0).floor_us) + 0.1 * budget * static_cast<double>(s.costs.headroom);
    s.forget();
    EXPECT_FALSE(run(s, "threshold", 1.01 * needed, items).bought.has(0)) << "new ones may use 97 % of the budget";
}

TEST(Items, GiveTheSameBitsAtAnyWorkerCount) {
    std::vector<std::uint64_t> hashes;
    std::vector<std::uint64_t> sets;
    for (const int workers : {1, 2, 4}) {
        prepare::PrepareOptions options;
        options.workers = workers;
        Scene s(test::town(5), options);
        prepare::Region region;
        region.centre.position = dvec3(0, 3, 60);
        s.look(region);
        const double budget = half_of_full(s);
        ItemList items;
        for (std::uint32_t i = 0; i < 30; ++i)
            items.offer({ItemKind::upload, i, static_cast<float>(0.02 * budget),
                         static_cast<float>(s.frame.full_value * std::exp2(-static_cast<double>(i)))});
        const Cut& cut = run(s, "threshold", budget, items);
        hashes.push_back(cut.hash);
        sets.push_back(cut.bought.set);
        EXPECT_GT(cut.bought.count, 1U);
        EXPECT_LT(cut.bought.count, 30U);
    }
    EXPECT_TRUE(hashes[0] == hashes[1] && hashes[0] == hashes[2]);
    EXPECT_TRUE(sets[0] == sets[1] && sets[0] == sets[2]);
}

TEST(Items, AreBoughtWithoutAnAllocation) {
    Scene s = town();
    const double budget = half_of_full(s);
    for (const std::string_view name : selector_names()) ASSERT_NE(find_selector(name), nullptr);
    const std::uint64_t before = test::allocations();
    for (int i = 0; i < 5; ++i) {
        ItemList items;
        for (std::uint32_t k = 0; k < ItemList::capacity; ++k)
            items.offer({ItemKind::upload, k, static_cast<float>(0.01 * budget), static_cast<float>(1000.0 * k + 1)});
        for (const std::string_view name : selector_names()) run(s, name, budget, items);
    }
    EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace surefoot::select
