// Pictures of the image cache and time: none where there is time for all, and soon where there is not.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/picture_walk.hpp"

namespace surefoot {
namespace {

using test::along;
using test::PictureWalk;

/// Pictures are softer than what they show, and time that nothing else can use is worth nothing.
TEST(PictureCache, AFrameWithTimeForAllHasNoPictures) {
    for (const bool all_round : {false, true}) {
        PictureWalk walk(test::forest_model(), {.selector = "best-first", .all_round = all_round});
        const double full_us = walk.frame(along(walk.engine(), 0)).predicted_us;
        std::uint32_t made = 0;
        for (int i = 1; i < 30; ++i) made += walk.frame(along(walk.engine(), i), 2 * full_us).pictures_made;
        EXPECT_EQ(made, 0U) << "there is time for all";
        for (int i = 30; i < 60; ++i) made += walk.frame(along(walk.engine(), i), 0.5 * full_us).pictures_made;
        EXPECT_GT(made, 0U) << "there is not";
        std::uint32_t shown = 1;
        for (int i = 60; i < 66; ++i) shown = walk.frame(along(walk.engine(), i), 4 * full_us).pictures;
        EXPECT_EQ(shown, 0U) << "there is again";
    }
}

/// While nothing pays, the cache plans in one frame of eight, and costs are noted in these alone.
TEST(PictureCache, AfterALongTimeForAllPicturesAreThereWithinTwoSeconds) {
    for (const bool all_round : {false, true}) {
        PictureWalk walk(test::forest_model(), {.selector = "best-first", .all_round = all_round});
        const double full_us = walk.frame(along(walk.engine(), 0)).predicted_us;
        for (int i = 1; i < 90; ++i)  // there, back, and there again
            EXPECT_EQ(walk.frame(along(walk.engine(), 30 - std::abs(30 - i % 60)), 2 * full_us).pictures, 0U);
        int without = 0;
        while (without < 60 && walk.frame(along(walk.engine(), 30 + without), 0.5 * full_us).pictures == 0) ++without;
        EXPECT_LT(without, 60) << (all_round ? "all round" : "in view");
    }
}

/// Whether pictures are shown changes no more than once with each budget: they do not come and go by what they save themselves.
TEST(PictureCache, PicturesDoNotComeAndGoWithWhatTheySave) {
    for (const bool all_round : {false, true}) {
        PictureWalk walk(test::forest_model(), {.selector = "best-first", .all_round = all_round});
        const double full_us = walk.frame(along(walk.engine(), 0)).predicted_us;
        int at = 1;
        for (const double share : {0.4, 0.15, 0.8, 0.95, 1.05, 1.2}) {
            int changes = 0;
            bool shows = false;
            for (int i = 0; i < 40; ++i, ++at) {
                const bool now = walk.frame(along(walk.engine(), at), share * full_us).pictures > 0;
                changes += i > 8 && now != shows ? 1 : 0;
                shows = now;
            }
            EXPECT_LE(changes, 1) << share << (all_round ? ", all round" : "");
            EXPECT_TRUE(shows || share != 0.4) << share;
        }
    }
}

}  // namespace
}  // namespace surefoot
