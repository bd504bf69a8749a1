// What matters more is drawn finer, by every selector that buys within a budget and looks at single objects.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

using test::Scene;

/// The node whose importance changes: a leaf in the middle of the view.
constexpr model::Index chosen = 21 + 37;

Scene town_seen(float importance) {
    model::Model model = test::town(3);
    for (model::Node& node : model.nodes)
        if (node.child_count == 0) node.importance = 0.2F;
    model.nodes[chosen].importance = importance;
    Scene scene(std::move(model));
    scene.state.hysteresis = 1;
    Pose pose;
    pose.position = {0, 20, 60};
    pose.orientation = dquat(std::cos(-0.15), std::sin(-0.15), 0, 0);
    scene.look({pose, 0, 0});
    return scene;
}

/// Of the item that shows the node: its own or one above.
double shown_error_rad(const Scene& scene, model::Index node) {
    for (model::Index at = node; at != model::none; at = scene.model.nodes[at].parent)
        for (const CutItem& item : scene.cut.items)
            if (item.node == at) return static_cast<double>(scene.frame.choices[item.choice].error_rad);
    return std::numeric_limits<double>::infinity();
}

class Importance : public ::testing::TestWithParam<std::string> {};

TEST_P(Importance, OfOneObjectRefinesIt) {
    constexpr int budgets = 60;
    const double none_rad = 0.5;  // counts where the object is left out
    Scene little = town_seen(0.2F), full = town_seen(1.0F);
    full.run("flat", test::infinity);
    // The published accounting never takes a parent's cost away, so it needs several times the budget for the same cut.
    const double accounted = GetParam().ends_with("-1994") ? 8 : 1;
    const double all_us = accounted * static_cast<double>(full.cut.predicted_us);
    double with_little = 0, with_full = 0;
    int finer = 0, coarser = 0;
    for (int i = 1; i <= budgets; ++i) {
        const double budget_us = all_us * i / budgets;
        for (Scene* scene : {&little, &full}) {
            scene->forget();
            scene->run(GetParam(), budget_us);
        }
        const double a = std::min(none_rad, shown_error_rad(little, chosen)),
                     b = std::min(none_rad, shown_error_rad(full, chosen));
        with_little += a;
        with_full += b;
        finer += b < a ? 1 : 0;
        coarser += b > a ? 1 : 0;
    }
    std::printf("%s: finer at %d of %d budgets, coarser at %d; mean error %.4f with 0.2, %.4f rad with 1\n", GetParam().c_str(),
                finer, budgets, coarser, with_little / budgets, with_full / budgets);
    EXPECT_LT(with_full, with_little);
    EXPECT_GE(finer, 1 + 2 * coarser);
}

/// As published, one takes groups in their stored order, and one goes by a group's own benefit: no object's importance counts.
bool goes_by_groups(std::string_view name) { return name == "depth-first-1994" || name == "best-first-1994"; }

std::vector<std::string> buying_selectors() {
    std::vector<std::string> names;
    for (const auto list : {selectors(), dropping_selectors()})
        for (const SelectorEntry& entry : list)
            if (entry.goes_by == GoesBy::budget && !goes_by_groups(entry.name)) names.emplace_back(entry.name);
    return names;
}

INSTANTIATE_TEST_SUITE_P(Each, Importance, ::testing::ValuesIn(buying_selectors()), [](const auto& of) {
    std::string name = of.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

}  // namespace
}  // namespace surefoot::select
