// Loss by blur: figures by hand, a mean that rises with the blur, and losses that are no losses.
#include "render/measure/blur.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace surefoot::measure {
namespace {

TEST(Blur, of_a_fifth_of_white_in_every_channel_is_six_times_its_square) {
    const std::vector<std::uint8_t> full{100, 100, 100, 255, 0, 0, 0, 255}, enlarged{151, 49, 151, 0, 51, 51, 51, 0};
    EXPECT_NEAR(blur_loss_of(enlarged, full), 6 * 0.2 * 0.2, 1e-12);
    EXPECT_EQ(blur_loss_of(full, full), 0);
}

TEST(Blur, of_one_colour_against_two_is_defined) {
    const std::vector<std::uint8_t> full{0, 0, 0, 255, 255, 255, 255, 255}, grey{0, 0, 0, 255, 0, 0, 0, 255};
    EXPECT_NEAR(blur_loss_of(grey, full), 3, 1e-12);  // half of the pixels are off by white
}

TEST(Blur, of_pictures_that_do_not_compare_is_no_number) {
    const std::vector<std::uint8_t> one(4), two(8);
    EXPECT_TRUE(std::isnan(blur_loss_of(one, two)));
    EXPECT_TRUE(std::isnan(blur_loss_of({}, {})));
}

TEST(MeanBlur, is_the_mean_of_the_poses_and_nothing_at_full_resolution) {
    const std::vector<PoseBlur> poses{{0.5, 0.01, 0.02, 0.03, 0.04}, {0, 0.03, 0.04, 0.05, 0.08}};
    const auto loss = mean_blur_loss(poses);
    ASSERT_TRUE(loss.ok());
    const model::BlurLoss expected{0, 0.02F, 0.03F, 0.04F, 0.06F};
    for (std::size_t step = 0; step < expected.size(); ++step) EXPECT_NEAR((*loss)[step], expected[step], 1e-7F) << step;
}

TEST(MeanBlur, never_falls_towards_lower_resolutions_and_ends_at_one) {
    const std::vector<PoseBlur> poses{{0, 0.3, 0.2, 4, 0.1}};
    const auto loss = mean_blur_loss(poses);
    ASSERT_TRUE(loss.ok());
    EXPECT_EQ(*loss, (model::BlurLoss{0, 0.3F, 0.3F, 1, 1}));
}

TEST(MeanBlur, of_no_pose_or_of_a_loss_that_is_none_is_an_error) {
    EXPECT_FALSE(mean_blur_loss({}).ok());
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e-9}) {
        const std::vector<PoseBlur> poses{{0, 0.1, 0.1, 0.1, 0.1}, {0, 0.1, 0.1, bad, 0.1}};
        const auto loss = mean_blur_loss(poses);
        ASSERT_FALSE(loss.ok()) << bad;
        EXPECT_NE(loss.error().what.find("loss"), std::string::npos);
    }
}

}  // namespace
}  // namespace surefoot::measure
