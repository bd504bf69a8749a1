// Groups of a cluster's leaves: they part the leaves, and none is larger than a 32nd unless it is a leaf.
#include "render/model/loss_groups.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "tests/model/random_tree.hpp"

namespace surefoot::model {
namespace {

/// One or two forms a node.
Model tree_of(Random& random, std::size_t nodes) {
    Model model = test::random_tree(random, nodes);
    for (Node& node : model.nodes) node.rep_count = random.unit() < 0.5 ? 1 : 2;
    return model;
}

TEST(LossGroups, PartTheLeavesOfEveryCluster) {
    Random random(7);
    for (const Index nodes : {1U, 2U, 30U, 400U, 3000U}) {
        const Model model = tree_of(random, nodes);
        const LossGroups groups(model);
        const auto n = static_cast<Index>(model.nodes.size());
        std::vector<std::size_t> leaves(n, 0);
        for (Index i = n; i-- > 0;) {
            if (model.nodes[i].child_count == 0) leaves[i] = 1;
            if (i > 0) leaves[model.nodes[i].parent] += leaves[i];
        }
        std::vector<std::map<Index, std::size_t>> shown(n);  // by cluster: leaves by slot
        for (Index leaf = 0; leaf < n; ++leaf) {
            if (model.nodes[leaf].child_count > 0) continue;
            for (Index a = model.nodes[leaf].parent; a != none; a = model.nodes[a].parent) ++shown[a][groups.slot_of(leaf, a)];
        }
        const std::function<std::size_t(Index, Index)> groups_below = [&](Index node, Index cluster) {
            std::size_t found = 0;
            for (Index c = model.nodes[node].first_child; c < model.nodes[node].first_child + model.nodes[node].child_count; ++c)
                found += model.nodes[c].child_count == 0 || leaves[c] * LossGroups::parts <= leaves[cluster]
                             ? 1
                             : groups_below(c, cluster);
            return found;
        };
        std::size_t entries = 0;
        for (Index a = 0; a < n; ++a) {
            EXPECT_EQ(groups.count(a), shown[a].size()) << "every slot holds leaves";
            EXPECT_EQ(shown[a].count(none), 0U) << "every leaf has a slot";
            for (const auto& [slot, in] : shown[a]) {
                EXPECT_LT(slot, groups.count(a));
                if (in > 1) {
                    EXPECT_LE(in * LossGroups::parts, leaves[a]);
                }
            }
            EXPECT_EQ(groups.count(a), model.nodes[a].child_count == 0 ? 0 : groups_below(a, a)) << "the highest that are small";
            EXPECT_EQ(groups.first(a), entries);
            entries += std::size_t{groups.count(a)} * model.nodes[a].rep_count;
        }
        EXPECT_EQ(groups.size(), entries);
    }
}

TEST(LossGroups, OfAChainThatIsTooDeepAreNone) {
    for (const Index depth : {LossGroups::max_depth, LossGroups::max_depth + 1}) {
        Model model;
        model.nodes.resize(1 + std::size_t{2} * depth);  // each cluster holds a leaf and the next cluster
        for (Index i = 0; i < depth; ++i)
            for (const Index child : {2 * i + 1, 2 * i + 2}) model.nodes[child].parent = 2 * i, ++model.nodes[2 * i].child_count;
        for (Node& node : model.nodes) node.rep_count = 1;
        const LossGroups groups(model);
        EXPECT_EQ(groups.size() > 0, depth == LossGroups::max_depth);
        EXPECT_EQ(groups.count(0) > 0, depth == LossGroups::max_depth);
        EXPECT_EQ(groups.above(1).slots.empty(), depth > LossGroups::max_depth);
    }
}

TEST(LossGroups, OfALeafAreThoseOfItsAncestorsFromTheParentOn) {
    Model model;  // 0 over 1 and 2, 1 over 3 and 4
    model.nodes.resize(5);
    for (const auto& [child, parent] : {std::pair{1U, 0U}, {2U, 0U}, {3U, 1U}, {4U, 1U}}) {
        model.nodes[child].parent = parent;
        ++model.nodes[parent].child_count;
    }
    const LossGroups groups(model);
    EXPECT_EQ(groups.count(0), 3U) << "three leaves; the cluster has more than a 32nd of them";
    EXPECT_EQ(groups.count(1), 2U);
    EXPECT_EQ(groups.count(2), 0U);
    EXPECT_EQ(groups.above(1).skipped, 1U);
    EXPECT_TRUE(groups.above(1).slots.empty());
    EXPECT_EQ(groups.above(3).skipped, 0U);
    EXPECT_EQ(std::vector<Index>(groups.above(3).slots.begin(), groups.above(3).slots.end()), (std::vector<Index>{0, 1}));
    EXPECT_EQ(groups.slot_of(4, 1), 1U);
    EXPECT_EQ(groups.slot_of(4, 0), 2U);
    EXPECT_EQ(groups.slot_of(2, 0), 0U) << "in the order of nodes";
}

}  // namespace
}  // namespace surefoot::model
