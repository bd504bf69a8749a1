// How far pictures are off full detail: sums by hand, and a small model measured on 1, 2 and 4 threads.
#include "render/bake/picture_loss.hpp"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cmath>

#include "render/model/loss_groups.hpp"
#include "tests/bake/squares.hpp"

namespace surefoot::bake {
namespace {

const model::ColourSpread grey{{0.5F, 0.5F, 0.5F}, 0.125F};

model::PictureLoss loss_of(const Square& full, const std::vector<Square>& form) {
    std::vector<Square> all = form;
    all.push_back(full);
    const model::Model m = squares(all);
    FormPicture a, b;
    a.clear(view_of(unit_box, front, dvec3(0), 64));
    b.clear(a.view);
    draw_form(m, m.reps[form.size()], a);
    for (std::size_t i = 0; i < form.size(); ++i) draw_form(m, m.reps[i], b);
    PictureDifference difference;
    difference.add(a, b);
    return difference.loss(grey);
}

TEST(PictureDifference, OfEqualPicturesIsNothing) {
    const auto loss = loss_of({}, {Square{}});
    EXPECT_EQ(loss.coverage, 0);
    EXPECT_EQ(loss.colour[0], 0);
}

TEST(PictureDifference, OfColoursIsTheirMeanSquare) {
    Square dark;
    dark.colour = {0, 0, 0, 1};
    const auto loss = loss_of({}, {dark});  // red for black: one channel of three
    EXPECT_EQ(loss.coverage, 0);
    EXPECT_NEAR(loss.colour[0], 1.0 / 3, 1e-6);
    dark.colour = {0.8F, 0, 0, 1};  // 204 of 255
    EXPECT_NEAR(loss_of({}, {dark}).colour[1], 0.04 / 3, 1e-6);
}

TEST(PictureDifference, OfAMissingThingIsThatOfAnyColourBehind) {
    Square square;
    square.colour = {0.4F, 0.4F, 0.4F, 1};  // 102 of 255
    const auto loss = loss_of(square, {});
    EXPECT_EQ(loss.coverage, 1);
    EXPECT_NEAR(loss.colour[0], 0.01 + 0.125, 1e-6) << "off the mean by 0.1, and the variance";
}

TEST(PictureDifference, IsAShareOfWhatFullDetailCovers) {
    Square half;
    half.size = 0.5F;
    const auto lacks = loss_of({}, {half});  // 33 x 33 of 65 x 65 samples are left
    const double off = (2 * 0.25 + 0.25) / 3 + 0.125, missing = 1 - 33.0 * 33 / (65 * 65);
    EXPECT_NEAR(lacks.coverage, missing, 1e-6);
    EXPECT_NEAR(lacks.colour[0], off * missing, 1e-6);
    EXPECT_EQ(loss_of(half, {Square{}}).coverage, 1) << "three times as much too much as there is";
}

TEST(PictureDifference, OfATextureFallsWithItsSize) {
    Square board, plain;
    board.textured = true;
    plain.colour = {0.5F, 0.5F, 0.5F, 1};
    const auto loss = loss_of(board, {plain});
    EXPECT_NEAR(loss.colour[0], 0.25, 0.01);
    EXPECT_NEAR(loss.colour[2], 0.0, 1e-4);
}

/// A root of two clusters of two squares, and a shared mesh. Forms of a leaf: half a square, a square. Of a cluster: nothing
/// right.
model::Model small_tree() {
    Square coarse, green;
    coarse.size = 0.5F;
    green.colour = {0, 1, 0, 1};
    model::Model m = squares({green, coarse, {}});
    const auto forms = [&](model::Node& node, std::initializer_list<model::Index> from, const dvec3& at) {
        node.first_rep = static_cast<model::Index>(m.reps.size());
        node.rep_count = static_cast<std::uint32_t>(from.size());
        for (const model::Index r : from) {
            m.reps.push_back(m.reps[r]);
            m.reps.back().placement = static_cast<model::Index>(m.placements.size());
        }
        m.placements.push_back({at, mat3(1.0F)});
    };
    m.nodes.resize(7);
    for (model::Index n = 0; n < 7; ++n) {
        model::Node& node = m.nodes[n];
        node.parent = n == 0 ? model::none : (n - 1) / 2;
        if (n < 3) node.first_child = 2 * n + 1, node.child_count = 2;
        const dvec3 at(n > 2 ? 3.0 * (n - 3) : 0, 0, 0);
        if (n < 3) forms(node, {0}, at);
        if (n > 2) forms(node, {1, 2}, at);
        if (n > 2) node.box = {unit_box.min + at, unit_box.max + at};
    }
    for (model::Index n = 7; n-- > 1;) m.nodes[m.nodes[n].parent].box.grow(m.nodes[n].box);
    return m;
}

const ForAll serial = [](std::size_t count, const std::function<void(std::size_t)>& body) {
    for (std::size_t i = 0; i < count; ++i) body(i);
};

TEST(PictureLoss, OfLeavesIsSharedAndOfFullDetailIsNone) {
    const model::Model m = small_tree();
    const auto losses = measure_losses(m, serial, [] { return true; }).forms;
    ASSERT_EQ(losses.size(), m.reps.size());
    for (model::Index n = 3; n < 7; ++n) {
        const model::Index r = m.nodes[n].first_rep;
        EXPECT_NEAR(losses[r].coverage, 0.75, 0.02) << "of a square half as wide";
        EXPECT_EQ(losses[r].coverage, losses[m.nodes[3].first_rep].coverage);
        EXPECT_EQ(losses[r + 1].coverage, 0);
        EXPECT_EQ(losses[r + 1].colour[0], 0);
    }
    for (model::Index n = 1; n < 3; ++n) EXPECT_GT(losses[m.nodes[n].first_rep].coverage, 0.4) << "one square of two, in green";
    EXPECT_GT(losses[m.nodes[0].first_rep].coverage, losses[m.nodes[1].first_rep].coverage) << "one of four";
}

TEST(PictureLoss, OfGroupsIsWhatAClusterLacksOfEach) {
    const model::Model m = small_tree();
    const auto measured = measure_losses(m, serial, [] { return true; });
    const model::LossGroups groups(m);
    ASSERT_EQ(measured.groups.size(), groups.size());
    ASSERT_EQ(groups.count(1), 2U);
    const auto of = [&](model::Index cluster, model::Index leaf) {
        return measured.groups[groups.first(cluster) + groups.slot_of(leaf, cluster)].colour[0];
    };
    const float whole = measured.forms[m.nodes[1].first_rep].colour[0];
    EXPECT_NEAR(of(1, 3), 2.0 / 3, 0.03) << "in green where it is white";
    EXPECT_GT(std::abs(of(1, 3) - of(1, 4)), 0.1F) << "the other is missing: before white things that loses nothing";
    EXPECT_NEAR((of(1, 3) + of(1, 4)) / 2, whole, 0.02) << "both squares show alike, so their mean is the cluster's";
    EXPECT_NEAR(of(0, 3), of(1, 3), 0.05) << "seen as a part of more";
    for (const model::LossOfGroup& group : measured.groups) {
        EXPECT_EQ(group.colour[1], group.colour[0]) << "without textures, size makes no difference";
        EXPECT_EQ(group.colour[2], group.colour[0]);
    }
}

TEST(PictureLoss, IsTheSameOnAnyNumberOfThreads) {
    const model::Model m = small_tree();
    const MeasuredLosses by_one = measure_losses(m, serial, [] { return true; });
    const auto& one = by_one.forms;
    for (const int threads : {2, 4}) {
        tbb::task_arena arena(threads);
        MeasuredLosses measured;
        arena.execute([&] {
            measured = measure_losses(
                m,
                [](std::size_t count, const std::function<void(std::size_t)>& body) {
                    tbb::parallel_for(std::size_t{0}, count, body);
                },
                [] { return true; });
        });
        const std::vector<model::PictureLoss>& losses = measured.forms;
        ASSERT_EQ(measured.groups.size(), by_one.groups.size());
        for (std::size_t i = 0; i < by_one.groups.size(); ++i) EXPECT_EQ(measured.groups[i].colour, by_one.groups[i].colour);
        ASSERT_EQ(losses.size(), one.size());
        for (std::size_t r = 0; r < one.size(); ++r) {
            EXPECT_EQ(losses[r].coverage, one[r].coverage);
            EXPECT_EQ(losses[r].colour, one[r].colour);
        }
    }
}

TEST(PictureLoss, StopsAtAnyStepAndCountsThemRight) {
    const model::Model m = small_tree();
    const std::size_t steps = loss_steps(m);
    EXPECT_EQ(steps, 1U + 6 * 3) << "one mesh, and three clusters from six directions";
    std::size_t taken = 0;
    EXPECT_FALSE(measure_losses(m, serial, [&] { return ++taken, true; }).forms.empty());
    EXPECT_EQ(taken, steps);
    for (const std::size_t stop : {std::size_t{1}, std::size_t{2}, steps}) {
        taken = 0;
        EXPECT_TRUE(measure_losses(m, serial, [&] { return ++taken < stop; }).forms.empty());
        EXPECT_EQ(taken, stop);
    }
}

}  // namespace
}  // namespace surefoot::bake
