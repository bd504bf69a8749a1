// What moves, drawn: where it is at the frame's time, no more than it is worth at its speed, and never as if it stood still.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/engine.hpp"
#include "render/measure/image_metrics.hpp"
#include "render/model/moving.hpp"
#include "tests/bake/moving_scene.hpp"
#include "tests/engine/moving_frame.hpp"
#include "tests/select/count_malloc.hpp"

namespace surefoot {
namespace {

using model::Index;

constexpr std::int64_t moving_frame_ns = 33'000'000;
constexpr model::Viewport small_picture{320, 180};

const model::Model& moving_model() {
    static const model::Model baked = [] {
        auto m = bake::bake(bake::moving_town(), {}, {});
        EXPECT_TRUE(m.ok());
        return std::move(*m);
    }();
    return baked;
}

/// Null, without a failure, only where the library is missing or a sanitizer allows no GL.
std::unique_ptr<Engine> open(gl::BackendKind backend, model::Model model, double rest_after_ms = 0, bool motion = true) {
    EngineOptions options;
    options.motion = motion;
    options.device.kind = backend;
    options.device.viewport = small_picture;
    options.rest_after_ms = rest_after_ms;
    auto opened = Engine::open(std::move(model), model::default_costs(), options);
    if (!opened) {
        EXPECT_EQ(opened.error().kind, ErrorKind::unsupported) << opened.error().text();
        return nullptr;
    }
    (*opened)->device().draws.plays();
    return std::move(*opened);
}

/// All that moves is in view.
Pose overlook() {
    Pose pose;
    pose.position = dvec3(50, 30, 150);
    pose.orientation = glm::quatLookAt(glm::normalize(dvec3(46, 10, 50) - pose.position), dvec3(0, 1, 0));
    return pose;
}

std::vector<std::uint8_t> full_picture(Engine& engine, double time_s) {
    engine.device().draws.plays();
    engine.set_time(time_s);
    engine.draw_unbudgeted(overlook(), engine.full_detail(overlook()));
    auto image = engine.device().read_pixels();
    EXPECT_TRUE(image.ok());
    return image.ok() ? std::move(image->rgba) : std::vector<std::uint8_t>{};
}

/// The model with everything placed as it is at a time, and nothing that moves.
model::Model placed_at(double time_s) {
    model::Model still = moving_model();
    for (model::Placement& p : still.placements) {
        p = model::moved(p, model::pose_at(moving_model(), p.motion, time_s));
        p.motion = model::none;
    }
    still.motions.clear();
    still.motion_keys.clear();
    return still;
}

TEST(Moving, APictureIsThatOfAStillSceneWithEverythingInItsPlace) {
    auto engine = open(gl::BackendKind::egl, moving_model());
    if (engine == nullptr) GTEST_SKIP() << "EGL is not there, or a sanitizer allows no GL";
    constexpr std::array times_s = {0.0, 1.3, 4.0, 17.7, -2.5, 1e6 + 6.1};
    std::vector<std::vector<std::uint8_t>> shown;
    for (const double t : times_s) shown.push_back(full_picture(*engine, t));
    EXPECT_EQ(full_picture(*engine, 0), shown[0]) << "time goes back as well";
    engine.reset();  // one context a thread
    for (std::size_t i = 0; i < times_s.size(); ++i) {
        auto still = open(gl::BackendKind::egl, placed_at(times_s[i]));
        ASSERT_NE(still, nullptr);
        EXPECT_GT(measure::share_within(shown[i], full_picture(*still, 0), 2), 0.9999) << times_s[i];
        if (i == 0) continue;
        EXPECT_LT(measure::share_within(shown[i], shown[0], 2), 0.999) << times_s[i] << ": something has moved";
    }
}

struct Frames {
    std::unique_ptr<Engine> engine;
    prepare::PreparedFrame prepared;
    std::int64_t at_ns = 0;
    double budget_us = 1e6;

    explicit Frames(gl::BackendKind backend, model::Model model, double rest_after_ms = 0, bool motion = true)
        : engine(open(backend, std::move(model), rest_after_ms, motion)) {
        if (engine != nullptr) engine->reserve(prepared);
    }
    SubmitReport frame(const Pose& pose, double time_s) {
        at_ns += moving_frame_ns;
        SubmitLimits limits;
        limits.limit_us = 1e6;
        limits.frame_ns = at_ns;
        return test::moving_frame(*engine, prepared, pose, time_s, budget_us, limits);
    }
    [[nodiscard]] bool draws(Index node) const {
        const auto items = engine->drawn();
        return std::any_of(items.begin(), items.end(), [&](const gl::DrawItem& item) { return item.node == node; });
    }
};

/// The leaf on the motion with this period.
Index leaf_of(const model::Model& m, double period_s) {
    for (Index n = 0; n < m.nodes.size(); ++n) {
        const Index motion = model::motion_of(m, m.nodes[n]);
        if (m.nodes[n].child_count == 0 && motion != model::none && m.motions[motion].period_s == period_s) return n;
    }
    return model::none;
}

/// Looks from the side at a place, so near that little else is in the picture.
Pose look_at(const dvec3& place, double away_m, double fov_y_rad = 0.3) {
    Pose pose;
    pose.position = place + dvec3(0, 0, away_m);
    pose.fov_y_rad = fov_y_rad;
    return pose;
}

TEST(Moving, IsDrawnWhereItIsAndNotWhereItWas) {
    Frames frames(gl::BackendKind::null, moving_model());
    ASSERT_NE(frames.engine, nullptr);
    const Index lift = leaf_of(moving_model(), 10);
    const Pose at_rest = look_at(dvec3(70, 6, 60), 30), above = look_at(dvec3(70, 18, 60), 30);
    frames.frame(at_rest, 0);
    EXPECT_TRUE(frames.draws(lift));
    frames.frame(above, 0);
    EXPECT_FALSE(frames.draws(lift)) << "its box over all times is in view, and itself is not";
    frames.frame(above, 5);
    EXPECT_TRUE(frames.draws(lift));
    frames.frame(at_rest, 5);
    EXPECT_FALSE(frames.draws(lift));
}

/// Errors by the nearest place that it may have in the span.
TEST(Moving, ErrorsAreThoseFromWhereItIs) {
    const model::Model& m = moving_model();
    const Index lift = leaf_of(m, 10);
    prepare::PreparedFrame set;
    auto engine = open(gl::BackendKind::null, m);
    ASSERT_NE(engine, nullptr);
    engine->reserve(set);
    const Box rest = model::rest_box_of(m, m.nodes[lift]);
    Random random(3);
    std::size_t seen = 0;
    for (int i = 0; i < 200; ++i) {
        PrepareHints hints;
        hints.time_s = 50 * random.unit();
        hints.span_s = 0.2 * random.unit();
        const Pose pose = look_at(dvec3(70, 6 + 12 * random.unit(), 60), 5 + 40 * random.unit(), 1.2);
        engine->prepare({pose, 0, 0}, 0, 0, 0, set, hints);
        for (const prepare::Candidate& c : set.candidates) {
            if (c.node != lift) continue;
            ++seen;
            double nearest = 1e30;
            for (int k = 0; k <= 20; ++k) {
                const model::RigidPose at =
                    model::pose_at(m, model::motion_of(m, m.nodes[lift]), hints.time_s + hints.span_s * k / 20);
                nearest = std::min(nearest, rest.distance(at.back(pose.position)));
            }
            for (std::uint32_t k = 0; k < c.choice_count; ++k) {
                const prepare::Choice& choice = set.choices[c.first_choice + k];
                const double error_rad = static_cast<double>(m.reps[choice.rep].error_m) / std::max(nearest, 0.05);
                ASSERT_GE(static_cast<double>(choice.error_rad), error_rad * (1 - 1e-5)) << i;
                ASSERT_LE(static_cast<double>(choice.error_rad), error_rad * 1.3 + 1e-9) << i << ": not from its whole way";
            }
        }
    }
    EXPECT_GT(seen, 100U);
}

TEST(Moving, NeverRestsInViewAndRestsElsewhere) {
    Frames frames(gl::BackendKind::null, moving_model(), 200);
    ASSERT_NE(frames.engine, nullptr);
    bool rested = false;
    for (int i = 0; i < 60; ++i) rested = rested || frames.frame(overlook(), 0.033 * i).at_rest;
    EXPECT_FALSE(rested);
    Pose away = overlook();
    away.orientation = glm::angleAxis(std::numbers::pi, dvec3(0, 1, 0)) * away.orientation;
    for (int i = 0; i < 60; ++i) rested = rested || frames.frame(away, 2 + 0.033 * i).at_rest;
    EXPECT_TRUE(rested);
    Frames still(gl::BackendKind::null, placed_at(0), 200);
    ASSERT_NE(still.engine, nullptr);
    rested = false;
    for (int i = 0; i < 60; ++i) rested = rested || still.frame(overlook(), 0.033 * i).at_rest;
    EXPECT_TRUE(rested) << "or the test shows nothing";
}

TEST(Moving, StandsAsAtItsStartWithoutMotion) {
    Frames frames(gl::BackendKind::null, moving_model(), 200, false);
    ASSERT_NE(frames.engine, nullptr);
    const Index lift = leaf_of(moving_model(), 10);
    const Pose at_rest = look_at(dvec3(70, 6, 60), 30), above = look_at(dvec3(70, 18, 60), 30);
    frames.frame(at_rest, 5);
    EXPECT_TRUE(frames.draws(lift)) << "with motion it is 12 m higher then";
    EXPECT_EQ(frames.prepared.from_s, 0);
    EXPECT_EQ(frames.prepared.to_s, 0);
    frames.frame(above, 5);
    EXPECT_FALSE(frames.draws(lift));
    bool rested = false;
    for (int i = 0; i < 60; ++i) rested = rested || frames.frame(overlook(), 0.033 * i).at_rest;
    EXPECT_TRUE(rested) << "nothing in view will move";
}

TEST(Moving, AFrameAllocatesNothing) {
    Frames frames(gl::BackendKind::null, moving_model(), 500);
    ASSERT_NE(frames.engine, nullptr);
    for (int i = 0; i < 5; ++i) frames.frame(overlook(), 0.1 * i);
    SubmitLimits limits;
    limits.limit_us = 1e6;
    std::uint64_t allocated = 0;
    for (int i = 0; i < 100; ++i) {
        const std::uint64_t before = test::allocations();
        frames.engine->set_time(0.05 * i);
        if (i % 10 == 9)
            frames.engine->select_last();
        else
            frames.engine->select(frames.prepared, frames.budget_us, {}, 0);
        limits.frame_ns = frames.at_ns += moving_frame_ns;
        frames.engine->submit(overlook(), limits);
        allocated += test::allocations() - before;
    }
    EXPECT_EQ(allocated, 0U);
}

/// A row of balls of which one turns about itself; the time is short.
model::Model row_of_balls(double period_s) {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(1);
    const auto mesh = bake::add_mesh(scene, bake::ball(64, 2), "ball");
    for (int i = -3; i <= 3; ++i) {
        if (i == 0) continue;
        bake::place(scene, mesh, dvec3(6 * i, 0, -30));
    }
    bake::place_moving(scene, mesh, dvec3(0, 0, -30), bake::add_turn(scene, dvec3(0, 0, -30), dvec3(0, 1, 0), period_s));
    auto m = bake::bake(scene, {}, {});
    EXPECT_TRUE(m.ok());
    return std::move(*m);
}

TEST(Moving, ARotatingObjectsAccuracyFollowsItsSpeed) {
    std::vector<double> errors_m;
    std::vector<float> values;
    for (const double period_s : {1e4, 2.0, 0.25}) {
        Frames frames(gl::BackendKind::null, row_of_balls(period_s));
        ASSERT_NE(frames.engine, nullptr);
        const Index turning = leaf_of(frames.engine->model(), period_s);
        ASSERT_NE(turning, model::none);
        double error_m = 0;
        int drawn = 0;
        for (frames.budget_us = 500; frames.budget_us <= 6000; frames.budget_us += 100) {
            frames.frame({}, 0);
            for (const gl::DrawItem& item : frames.engine->drawn()) {
                if (item.node != turning) continue;
                error_m += static_cast<double>(frames.engine->model().reps[item.rep].error_m);
                ++drawn;
            }
        }
        ASSERT_GT(drawn, 20) << period_s;
        errors_m.push_back(error_m / drawn);
        for (const prepare::Candidate& c : frames.prepared.candidates)
            if (c.node == turning) values.push_back(frames.prepared.choices[c.first_choice + c.choice_count - 1].value);
    }
    EXPECT_GT(errors_m[1], 1.05 * errors_m[0]) << errors_m[0] << ", " << errors_m[1] << ", " << errors_m[2];
    EXPECT_GT(errors_m[2], 1.05 * errors_m[1]) << errors_m[0] << ", " << errors_m[1] << ", " << errors_m[2];
    ASSERT_EQ(values.size(), 3U);
    EXPECT_GT(values[0], values[1]);
    EXPECT_GT(values[1], values[2]);
}

}  // namespace
}  // namespace surefoot
