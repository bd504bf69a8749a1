// After its graphics context is lost a walk ends, and an engine is opened anew. Its cache begins without a picture, and no texel
// of an earlier one is shown.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/engine/picture_walk.hpp"

namespace surefoot {
namespace {

constexpr int frames = 8;

using Shown = std::vector<std::vector<std::uint8_t>>;

/// Pixels of each frame of a walk that begins in an engine of its own. Empty: there is no such device here.
Shown frames_of_new_engine(const model::Daylight* light) {
    test::PictureWalk walk(test::forest_model(), {.kind = gl::BackendKind::egl});
    if (walk.absent()) return {};
    Engine& engine = walk.engine();
    if (light != nullptr) engine.set_light(*light);
    Shown shown;
    std::uint32_t made = 0, pictures = 0;
    for (int i = 0; i < frames; ++i) {
        Pose pose = test::forest_pose(engine);
        pose.position.x += 1.4 / 30 * i;
        const SubmitReport report = walk.frame(pose);
        EXPECT_LE(report.pictures, made) << "pictures of this engine alone are shown";
        made += report.pictures_made;
        pictures += report.pictures;
        engine.device().draws.plays();
        const auto pixels = engine.device().read_pixels();
        EXPECT_TRUE(pixels.ok());
        if (pixels.ok()) shown.push_back(pixels->rgba);
    }
    EXPECT_GT(pictures, 0U);
    return shown;
}

TEST(PictureReopen, AllPicturesAreMadeAnewAndNoStaleTexelIsShown) {
    const Shown before = frames_of_new_engine(nullptr);
    if (before.empty()) GTEST_SKIP() << "no EGL here";
    model::Daylight other;
    other.sun_light = vec3(0.9F, 0.1F, 0.1F);
    EXPECT_NE(frames_of_new_engine(&other), before) << "the memory that comes free holds other texels";
    EXPECT_EQ(frames_of_new_engine(nullptr), before);
}

}  // namespace
}  // namespace surefoot
