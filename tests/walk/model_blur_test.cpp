// Blur measured on a scene of one edge, whose loss at each resolution follows by hand; and what no picture can be made of.
#include "tools/walk/model_blur.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "tests/gl/small_models.hpp"

namespace surefoot::walk {
namespace {

constexpr model::Viewport picture{160, 96};  // each step is a whole number of pixels, and so is half of it

/// Black on the left half of Pose{}'s picture, white sky on the right; null without GL.
std::unique_ptr<Engine> edge_engine(std::string& why) {
    test::SmallModel scene;
    scene.square(scene.material(test::plain(0, 0, 0)), test::at(-100, 0, -10), 100);
    EngineOptions options;
    options.device.viewport = picture;
    options.device.sky = {1, 1, 1};
    auto opened = Engine::open(scene.finish(), model::default_costs(), options);
    if (!opened) return why = opened.error().text(), nullptr;
    (*opened)->device().bind();
    return std::move(*opened);
}

TEST(ModelBlur, of_an_edge_is_what_follows_by_hand) {
    std::string why;
    const auto engine = edge_engine(why);
    if (!engine) GTEST_SKIP() << why;
    const std::vector<Pose> poses(2);
    const auto loss = measure_blur(*engine, poses, {});
    ASSERT_TRUE(loss.ok()) << loss.error().text();
    EXPECT_EQ((*loss)[0], 0);
    for (std::size_t step = 1; step < loss->size(); ++step) {
        // The pixel on either side of the edge takes this share of the other colour; all others keep theirs.
        const double share = 0.5 * (1 - static_cast<double>(model::resolution_steps[step]));
        const double by_hand = 6 * 2 * share * share / picture.width;
        EXPECT_NEAR((*loss)[step], by_hand, 0.1 * by_hand) << "step " << step;
    }
}

TEST(ModelBlur, of_plain_sky_is_nothing) {
    std::string why;
    const auto engine = edge_engine(why);
    if (!engine) GTEST_SKIP() << why;
    Pose away;
    away.orientation = glm::angleAxis(3.14159265358979, dvec3(0, 1, 0));
    const std::vector<Pose> poses{away};
    const auto loss = measure_blur(*engine, poses, {});
    ASSERT_TRUE(loss.ok());
    EXPECT_EQ(*loss, model::BlurLoss{});
}

TEST(ModelBlur, without_a_pose_or_when_stopped_is_an_error) {
    std::string why;
    const auto engine = edge_engine(why);
    if (!engine) GTEST_SKIP() << why;
    EXPECT_FALSE(measure_blur(*engine, {}, {}).ok());
    const std::atomic<bool> stop{true};
    const std::vector<Pose> poses(1);
    const auto loss = measure_blur(*engine, poses, {.report = {}, .stop = &stop, .notify = {}});
    ASSERT_FALSE(loss.ok());
    EXPECT_EQ(loss.error().kind, ErrorKind::stopped);
}

TEST(ModelBlur, poses_lie_evenly_on_the_path) {
    Path path;
    path.samples.resize(2);
    path.samples[0].time_s = 5;
    path.samples[1].time_s = 9;
    path.samples[1].pose.position.x = 8;
    const auto poses = poses_along(path, 4);
    ASSERT_EQ(poses.size(), 4U);
    for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_NEAR(poses[i].position.x, 1 + 2 * static_cast<double>(i), 1e-9);
    path.samples.pop_back();
    EXPECT_EQ(poses_along(path, 4).size(), 1U) << "one place: once is enough";
    EXPECT_EQ(poses_along(path, 0).size(), 0U);
}

}  // namespace
}  // namespace surefoot::walk
