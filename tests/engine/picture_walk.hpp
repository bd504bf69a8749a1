// A walk through a scene with an image cache on the null device, and a judge that shares no code with the cache.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/engine/forest_engine.hpp"

namespace surefoot::test {

/// How a walk with pictures is made.
struct PictureWalkOptions {
    std::uint32_t layers = 64;
    std::string selector{select::full_detail_selector};
    int workers = 1;
    model::Viewport viewport{320, 240};
    gl::BackendKind kind = gl::BackendKind::null;
    double rest_after_ms = 0;
    double max_error_rad = 0;
    bool all_round = false;
};

/// A clock that runs at a share of what the null device charges, and is late once, after its second call: while a frame begins.
struct ScriptedClock {
    double share = 0;
    double begins_us = 0;
    gl::Device* device = nullptr;
    int calls = 0;
    static std::int64_t now_ns(void* context) {
        auto& clock = *static_cast<ScriptedClock*>(context);
        clock.device->draws.plays();
        const double us = clock.share * clock.device->charged_us() + (clock.calls++ > 1 ? clock.begins_us : 0.0);
        return static_cast<std::int64_t>(1e3 * us);
    }
};

/// Prepares each frame's set from what the frame before knew, as the virtual clock of a walk does.
class PictureWalk {
public:
    PictureWalk(const model::Model& model, const PictureWalkOptions& how) {
        EngineOptions options;
        options.device.kind = how.kind;
        options.device.viewport = how.viewport;
        options.device.picture_layers = how.layers;
        options.prepare.workers = how.workers;
        options.prepare.occlusion = false;  // so that what is not drawn is a hole, whatever hides it
        options.selector = how.selector;
        options.rest_after_ms = how.rest_after_ms;
        options.max_error_rad = how.max_error_rad;
        options.pictures_all_round = how.all_round;
        auto opened = Engine::open(model, model::default_costs(), options);
        absent_ = !opened.ok() && opened.error().kind == ErrorKind::unsupported;
        EXPECT_TRUE(opened.ok() || absent_);
        if (!opened) return;
        engine_ = std::move(*opened);
        engine_->reserve(set_);
    }
    /// The device has no such library here.
    [[nodiscard]] bool absent() const { return absent_; }
    [[nodiscard]] Engine& engine() { return *engine_; }
    [[nodiscard]] const prepare::PreparedFrame& set() const { return set_; }

    /// Pictures that the last cut has bought.
    [[nodiscard]] std::size_t bought() const {
        std::size_t count = 0;
        for (const select::Item& item : engine_->offered().offered())
            count += item.kind == select::ItemKind::refresh && engine_->bought(item.kind, item.what) ? 1 : 0;
        return count;
    }

    SubmitReport frame(const Pose& pose, double budget_us = ample_us, double limit_us = ample_us,
                       ScriptedClock* clock = nullptr) {
        prepare(pose);
        return draw(pose, budget_us, limit_us, clock);
    }
    /// The set of a frame at this pose, as it was expected from the frames before.
    void prepare(const Pose& pose) {
        const bool jumps = !known_ || !(glm::length(pose.position - pose_.position) < 1);
        before_ = jumps ? pose : pose_;
        engine_->prepare(predict_region(before_, before_, 1.0 / 30, 0.1), frames_++, 1.4, 0, set_, hints_);
    }
    SubmitReport draw(const Pose& pose, double budget_us, double limit_us, ScriptedClock* clock = nullptr) {
        engine_->device().draws.plays();
        hints_.covered = engine_->cover(pose, predict_region(before_, pose, 1.0 / 30, 0.1));
        pose_ = pose;
        known_ = true;
        engine_->select(set_, budget_us, {}, 0);
        constexpr std::int64_t frame_ns = 33'333'333;
        SubmitLimits limits;
        limits.limit_us = limit_us;
        limits.frame_ns = static_cast<std::int64_t>(frames_) * frame_ns;
        if (clock != nullptr) {
            clock->device = &engine_->device();
            clock->calls = 0;
            limits.now_ns = ScriptedClock::now_ns;
            limits.now_context = clock;
        }
        return engine_->submit(pose, limits);
    }

private:
    std::unique_ptr<Engine> engine_;
    prepare::PreparedFrame set_;
    PrepareHints hints_;
    Pose pose_, before_;
    bool known_ = false, absent_ = false;
    std::uint64_t frames_ = 0;
};

/// By how many pixels of the screen a picture of the frame shows a point beside its place. Infinite: it does not show the point.
inline double displacement_px(const gl::CachePicture& picture, const Pose& pose, const model::Viewport& viewport,
                              const dvec3& point) {
    if (glm::any(glm::lessThan(point, picture.box.min)) || glm::any(glm::greaterThan(point, picture.box.max)))
        return std::numeric_limits<double>::infinity();
    const dvec3 to = point - picture.eye;
    const dvec3 image = picture.eye + to * (picture.plane_m / glm::dot(to, picture.forward));
    const auto on_screen = [&](const dvec3& at) {
        const dvec3 from = at - pose.position;
        return dvec2(glm::dot(from, pose.right()), glm::dot(from, pose.up())) / glm::dot(from, pose.forward());
    };
    return glm::length(on_screen(point) - on_screen(image)) * viewport.height / (2 * std::tan(pose.fov_y_rad / 2));
}

/// Leaves in view that are neither drawn, nor below something drawn, nor shown by pictures in all of 27 points of their boxes.
inline std::vector<model::Index> holes(const Engine& engine, const Pose& pose) {
    const model::Model& model = engine.model();
    std::vector<bool> drawn(model.nodes.size(), false);
    for (const gl::DrawItem& item : engine.drawn()) drawn[item.node] = true;
    const model::Viewport viewport = engine.options().device.viewport;
    const model::Frustum view = model::make_frustum(pose, viewport, model::far_corners_m(model.nodes[0].box));
    std::vector<model::Index> found;
    for (model::Index n = 0; n < model.nodes.size(); ++n) {
        const model::Node& node = model.nodes[n];
        if (node.parent != model::none && drawn[node.parent]) drawn[n] = true;  // parents come first
        if (node.child_count > 0 || drawn[n] || !model::visible(view, node.box)) continue;
        bool shown = true;
        for (int i = 0; i < 27 && shown; ++i) {
            const dvec3 at = node.box.min + dvec3(i % 3, i / 3 % 3, i / 9) * node.box.half();
            if (!model::visible(view, Box{at, at})) continue;
            shown = std::ranges::any_of(engine.pictures(),
                                        [&](const auto& one) { return displacement_px(one, pose, viewport, at) <= 1 + 1e-6; });
        }
        if (!shown) found.push_back(n);
    }
    return found;
}

/// Along the edge of the forest, looking in, at 1.4 m/s.
inline Pose along(const Engine& engine, int frame) {
    Pose pose = forest_pose(engine);
    pose.position.x += 1.4 / 30 * frame;
    return pose;
}

}  // namespace surefoot::test
