// The choice of the picture's resolution.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/prepare/resolution.hpp"

namespace surefoot::prepare {
namespace {

/// Frames in which the resolutions lose these shares, by model::resolution_steps.
template <class Lost>
void walk(ResolutionChooser& chooser, int frames, const Lost& lost, double planned_us = 1e4) {
    PlannedTimes planned;
    planned.fill(planned_us);
    for (int i = 0; i < frames; ++i) {
        const float tried = chooser.trial(planned);
        if (tried > 0.0F) chooser.judge(lost(chooser.resolution()), lost(tried));
    }
}

TEST(ResolutionChooser, TakesWhatLosesClearlyLessAndGoesBack) {
    ResolutionChooser chooser;
    walk(chooser, 60, [](float) { return 0.0; });
    EXPECT_EQ(chooser.resolution(), 1.0F);
    walk(chooser, 60, [](float r) { return r == 0.625F ? 0.02 : 0.1; });
    EXPECT_EQ(chooser.resolution(), 0.625F);
    walk(chooser, 60, [](float r) { return r == 1.0F ? 0.0 : 0.01; });
    EXPECT_EQ(chooser.resolution(), 1.0F);
}

TEST(ResolutionChooser, NeitherASmallGainNorAShortOneChangesAnything) {
    ResolutionChooser chooser;
    walk(chooser, 200, [](float r) { return r == 0.5F ? 0.08 : 0.1; });
    EXPECT_EQ(chooser.resolution(), 1.0F);
    for (int i = 0; i < 20; ++i) {
        walk(chooser, 12, [](float r) { return r == 0.5F ? 0.01 : 0.1; });  // all others once
        walk(chooser, 12, [](float) { return 0.1; });
    }
    EXPECT_EQ(chooser.resolution(), 1.0F);
}

TEST(ResolutionChooser, ASofterPictureNeedsMoreThanASharperOne) {
    ResolutionChooser chooser;
    walk(chooser, 60, [](float r) { return r == 1.0F ? 0.1 : 0.07; });
    EXPECT_EQ(chooser.resolution(), 1.0F) << "three tenths less are not enough";
    walk(chooser, 60, [](float r) { return r == 0.5F ? 0.05 : 0.1; });
    EXPECT_EQ(chooser.resolution(), 0.5F);
    walk(chooser, 60, [](float r) { return r == 0.5F ? 0.05 : 0.047; });
    EXPECT_EQ(chooser.resolution(), 0.5F);
    walk(chooser, 60, [](float r) { return r == 1.0F ? 0.04 : 0.05; });
    EXPECT_EQ(chooser.resolution(), 1.0F) << "a fifth less is";
}

TEST(ResolutionChooser, WinnersThatMoveAgreeOnTheNearerOne) {
    const auto best_at = [](float best) { return [=](float r) { return 0.02 + 0.3 * std::abs(static_cast<double>(r - best)); }; };
    const auto start_at = [&](ResolutionChooser& chooser, float best) {
        walk(chooser, 4, best_at(best));
        ASSERT_EQ(chooser.resolution(), best);
    };
    ResolutionChooser sharper;  // a view that becomes cheaper: each round has another winner
    start_at(sharper, 0.5F);
    walk(sharper, 12, best_at(0.75F));
    EXPECT_EQ(sharper.resolution(), 0.5F) << "one round decides nothing";
    walk(sharper, 12, best_at(0.875F));
    EXPECT_EQ(sharper.resolution(), 0.75F);
    walk(sharper, 12, best_at(1.0F));
    EXPECT_EQ(sharper.resolution(), 0.875F) << "the winner before counts on";

    ResolutionChooser softer;
    start_at(softer, 1.0F);
    walk(softer, 12, best_at(0.625F));
    walk(softer, 12, best_at(0.5F));
    EXPECT_EQ(softer.resolution(), 0.625F);

    ResolutionChooser both;  // winners on both sides agree on nothing
    start_at(both, 0.75F);
    for (int i = 0; i < 4; ++i) walk(both, 12, best_at(i % 2 == 0 ? 0.5F : 1.0F));
    EXPECT_EQ(both.resolution(), 0.75F);
}

TEST(ResolutionChooser, ARoundTriesAllOthersAfterAChangeToo) {
    ResolutionChooser chooser;
    walk(chooser, 4, [](float r) { return r == 0.5F ? 0.02 : 0.1; });
    ASSERT_EQ(chooser.resolution(), 0.5F);
    std::vector<float> tried;
    for (int i = 0; i < 12; ++i) {
        const float other = chooser.trial({1e4, 1e4, 1e4, 1e4, 1e4});
        if (!(other > 0.0F)) continue;
        tried.push_back(other);
        chooser.judge(0.02, 0.1);
    }
    std::sort(tried.begin(), tried.end());
    EXPECT_EQ(tried, (std::vector<float>{0.625F, 0.75F, 0.875F, 1.0F}));
}

TEST(ResolutionChooser, DecidesAtOnceInTheBeginning) {
    ResolutionChooser chooser;
    walk(chooser, 3, [](float r) { return r == 0.625F ? 0.02 : 0.1; });
    EXPECT_EQ(chooser.resolution(), 1.0F) << "one of the four others is not known yet";
    walk(chooser, 1, [](float r) { return r == 0.625F ? 0.02 : 0.1; });
    EXPECT_EQ(chooser.resolution(), 0.625F);
    EXPECT_NEAR(static_cast<double>(chooser.gain()), 0.08, 1e-6);
    walk(chooser, 12, [](float r) { return r == 1.0F ? 0.0 : 0.1; });
    EXPECT_EQ(chooser.resolution(), 0.625F) << "later it takes two rounds";
    walk(chooser, 12, [](float r) { return r == 1.0F ? 0.0 : 0.1; });
    EXPECT_EQ(chooser.resolution(), 1.0F);
    EXPECT_EQ(chooser.gain(), 0.0F);
}

/// At 62.5 % `soft` is lost, at 100 % `sharp`, elsewhere more.
auto losses(double soft, double sharp) {
    return [=](float r) { return r == 0.625F ? soft : r == 1.0F ? sharp : 0.2; };
}
constexpr double time_us = 1e4;

TEST(ResolutionChooser, DecidesAnewWhereThePlannedTimeHasChanged) {
    ResolutionChooser chooser;
    walk(chooser, 4, losses(0.02, 0.1), time_us);
    ASSERT_EQ(chooser.resolution(), 0.625F);
    walk(chooser, 8, losses(0.02, 0.0), 1.15 * time_us);
    EXPECT_EQ(chooser.resolution(), 0.625F) << "a small change: it takes two rounds";
    walk(chooser, 3, losses(0.02, 0.0), 1.3 * time_us);
    EXPECT_EQ(chooser.resolution(), 0.625F);
    walk(chooser, 1, losses(0.02, 0.0), 1.3 * time_us);
    EXPECT_EQ(chooser.resolution(), 1.0F) << "after each of the four others";
    walk(chooser, 12, losses(0.02, 0.1), 0.8 * time_us);
    EXPECT_EQ(chooser.resolution(), 1.0F) << "held for twelve sets";
    walk(chooser, 4, losses(0.02, 0.1), 0.8 * time_us);
    EXPECT_EQ(chooser.resolution(), 0.625F) << "as soon as before after that";
}

TEST(ResolutionChooser, ATimeThatGoesToAndFroDoesNotChangeEachPicture) {
    ResolutionChooser chooser;
    walk(chooser, 4, losses(0.02, 0.1), time_us);
    int changes = 0;
    for (int i = 0; i < 30; ++i) {  // each half lasts as long as a round
        const float before = chooser.resolution();
        walk(chooser, 4, losses(0.02, i % 2 == 0 ? 0.0 : 0.1), i % 2 == 0 ? 1.5 * time_us : time_us);
        if (chooser.resolution() != before) ++changes;
    }
    EXPECT_GT(changes, 0);
    EXPECT_LE(changes, 8) << "120 sets; at most one change in sixteen";
}

TEST(ResolutionChooser, AShortChangeOfThePlannedTimeDecidesNothing) {
    ResolutionChooser chooser;
    walk(chooser, 4, losses(0.02, 0.1), time_us);
    for (int i = 0; i < 5; ++i) {
        walk(chooser, 1, losses(0.02, 0.0), 2 * time_us);
        walk(chooser, 3, losses(0.02, 0.1), time_us);
        EXPECT_EQ(chooser.resolution(), 0.625F);
    }
}

TEST(ResolutionChooser, NoTimeIsAChangeTooButNoNumberIsNone) {
    ResolutionChooser chooser;
    walk(chooser, 4, losses(0.02, 0.1), time_us);
    walk(chooser, 4, losses(0.02, 0.0), 0);
    EXPECT_EQ(chooser.resolution(), 1.0F);
    walk(chooser, 16, losses(0.02, 0.1), std::nan(""));
    EXPECT_EQ(chooser.resolution(), 1.0F);
}

TEST(ValueCurve, IsReadBetweenItsLevels) {
    ValueCurve curve;
    for (std::uint32_t i = 0; i < value_levels; ++i) {
        curve.cost[i] = 10.0F * static_cast<float>(i + 1);
        curve.value[i] = static_cast<float>(i);
    }
    curve.full_value = value_levels - 1;
    EXPECT_EQ(curve.value_at(0), 0);
    EXPECT_EQ(curve.value_at(std::nanf("")), 0) << "the floor is drawn";
    EXPECT_FLOAT_EQ(curve.value_at(25), 1.5F);
    EXPECT_EQ(curve.value_at(1e9F), value_levels - 1);
    EXPECT_EQ(lost_share(curve, 1e9), 0);
    EXPECT_EQ(lost_share(curve, 0), 1);
    EXPECT_EQ(lost_share({}, 100), 0) << "no value was computed";
}

}  // namespace
}  // namespace surefoot::prepare
