// Groups of alike members: a row of equal dots is seen as one thing (the law of similarity: Maciel 1994, 3.4.3, figure 3.9).
#include <gtest/gtest.h>

#include <cmath>

#include "render/prepare/alike.hpp"
#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

using test::Scene;

/// Sixteen dots in four groups. Those of the first two groups are of one kind; in the last group one is of another kind, and in
/// the third each is of its own.
model::Model dots() {
    model::Model m = test::town(2);
    for (model::Index n = 5; n < m.nodes.size(); ++n) {
        const model::Index group = (n - 5) / 4;
        model::Representation& full = m.reps[m.nodes[n].first_rep + m.nodes[n].rep_count - 1];
        full.first_part = group == 2 ? n : group == 3 && n + 1 == m.nodes.size() ? 1 : 0;
    }
    return m;
}

Scene seen(const model::Model& model, double gestalt) {
    prepare::PrepareOptions options;
    options.gestalt = gestalt;
    options.full_depth = true;
    Scene scene(model, options);
    Pose pose;
    pose.position = {0, 12, 40};
    pose.orientation = dquat(std::cos(-0.12), std::sin(-0.12), 0, 0);
    scene.look({pose, 0, 0});
    return scene;
}

TEST(Gestalt, KnowsHowAlikeTheMembersOfAGroupAre) {
    const model::Model model = dots();
    const std::vector<float> alike = prepare::alike_members(model);
    ASSERT_EQ(model.nodes.size(), 21U);
    EXPECT_EQ(alike[1], 1.0F);
    EXPECT_EQ(alike[2], 1.0F);
    EXPECT_EQ(alike[3], 0.0F) << "each is of its own kind";
    EXPECT_FLOAT_EQ(alike[4], 2.0F / 3);
    EXPECT_FLOAT_EQ(alike[0], 2.0F / 3) << "the group of many kinds is a kind of its own";
    for (std::size_t leaf = 5; leaf < alike.size(); ++leaf) EXPECT_EQ(alike[leaf], 0.0F);
}

TEST(Gestalt, ForgivesGroupsOfAlikeMembersAndNothingElse) {
    const model::Model model = dots();
    const Scene off = seen(model, 0), on = seen(model, 0.5);
    ASSERT_EQ(off.frame.choices.size(), on.frame.choices.size());
    EXPECT_EQ(off.frame.full_value, on.frame.full_value);
    const std::vector<float> alike = prepare::alike_members(model);
    int forgiven = 0, judged = 0;
    for (const prepare::Candidate& at : off.frame.candidates) {
        double full = 0;  // what the group's full detail is worth
        for (const prepare::Candidate& leaf : off.frame.candidates) {
            const bool below = &leaf == &at || (leaf.parent != model::none && &off.frame.candidates[leaf.parent] == &at);
            if (below && leaf.child_count == 0)
                full += static_cast<double>(off.frame.choices[leaf.first_choice + leaf.choice_count - 1].value);
        }
        if (at.node == 0) continue;
        for (std::uint32_t k = at.first_choice; k < at.first_choice + at.choice_count; ++k) {
            const double without = static_cast<double>(off.frame.choices[k].value),
                         with = static_cast<double>(on.frame.choices[k].value);
            EXPECT_NEAR(full - with, (full - without) * (1 - 0.5 * static_cast<double>(alike[at.node])), 1e-3 * full) << at.node;
            EXPECT_EQ(off.frame.choices[k].error_rad, on.frame.choices[k].error_rad);
            judged += full - without > 0.01 * full ? 1 : 0;
            forgiven += full - without > 0.01 * full && alike[at.node] > 0 ? 1 : 0;
        }
    }
    EXPECT_GT(forgiven, 2) << "forms of alike groups that lose something";
    EXPECT_GT(judged, forgiven + 2) << "others that do";
}

TEST(Gestalt, KeepsGroupsOfAlikeMembersWholeForLonger) {
    const model::Model model = dots();
    Scene off = seen(model, 0), on = seen(model, 1);
    const auto groups_in = [&](const Cut& cut, model::Index group) {
        std::size_t whole = 0;
        for (const CutItem& item : cut.items) whole += item.node == group ? 1 : 0;
        return whole;
    };
    off.run("flat", test::infinity);
    const double all_us = off.cut.predicted_us;
    std::size_t alike_off = 0, alike_on = 0, other_off = 0, other_on = 0;
    for (int i = 1; i < 40; ++i) {
        const double budget_us = all_us * i / 40;
        off.forget();
        on.forget();
        off.run("threshold", budget_us);
        on.run("threshold", budget_us);
        for (const model::Index group : {1U, 2U}) alike_off += groups_in(off.cut, group), alike_on += groups_in(on.cut, group);
        other_off += groups_in(off.cut, 3);
        other_on += groups_in(on.cut, 3);
    }
    EXPECT_GT(alike_on, alike_off);
    EXPECT_LE(other_on, other_off) << "what is spared there is spent here";
    on.run("threshold", test::infinity);
    EXPECT_EQ(on.cut.items.size(), 16U) << "full detail is full detail";
}

}  // namespace
}  // namespace surefoot::select
