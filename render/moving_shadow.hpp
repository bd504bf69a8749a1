// The shadow map of what moves as an item of the budget: what it would show now, what that costs, and what it is worth.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/cost.hpp"
#include "render/model/daylight.hpp"
#include "render/model/moving.hpp"
#include "render/model/view.hpp"

namespace surefoot {

/// For whom a map is planned.
struct ShadowScene {
    const model::Model& model;
    const model::MovingNodes& moving;
    model::MotionPoses& poses;  ///< at the time of the picture
    const model::Daylight& light;
    double time_s = 0;
};

/// The eye, and how much of it may differ from what was prepared.
struct ShadowEye {
    Pose pose;
    model::Viewport viewport;
    double radius_m = 0, angle_rad = 0;
};

/// How much a map holds, and how much a plan looks at.
struct ShadowLimits {
    std::size_t casters = 64, items = 4096;  ///< in a map
    /// Worked out for a plan. Where more than these may cast, half of them are of the largest of the plan before.
    std::size_t poses = 256;
    std::size_t boxes = 1024;  ///< of things over all times, tested for a plan; the next plan goes on behind them
};

/// What plans, judges and remembers the map of one engine. After it is made nothing allocates. It reads the scene at a time, the
/// eye, the light and its last plans, and no clock.
class MovingShadow {
public:
    /// An old map is shown while nothing in it is off by more, and it is no older. What did not move at all stays for ever.
    static constexpr double max_off_px = 2, max_age_s = 0.25;
    static constexpr double min_size_px = 4;     ///< of what casts, at its own distance or at that of its shadow
    static constexpr double max_texel_m = 0.25;  ///< what would make texels larger is left out, except the largest on the picture

    MovingShadow() = default;
    /// Finds what casts: nodes that move otherwise than their parents, with a leaf that is not transparent and may see the sky.
    /// The model must outlive it.
    explicit MovingShadow(const model::Model& model, const ShadowLimits& limits = {});
    [[nodiscard]] bool any() const { return !roots_.empty(); }

    /// Plans a map for this moment. False: no sun, or nothing that casts is near enough. Takes as many poses as the limits allow,
    /// a microsecond each, but for those that the picture has worked out already.
    bool plan(const ShadowScene& scene, const ShadowEye& eye);
    /// Of the planned map.
    [[nodiscard]] const gl::ShadowView& view() const { return view_; }
    [[nodiscard]] std::span<const gl::DrawItem> items() const { return items_; }
    /// Nodes whose children the last plan looked at: fewer than ShadowLimits::items.
    [[nodiscard]] std::size_t visits() const { return visits_; }
    /// Predicted, to draw it: its triangles, its texels and the end of a pass.
    [[nodiscard]] float price_us(const model::Model& model, const model::CostModel& costs) const;
    /// Weighted pixels that it changes: of shadows, times what the sun makes there. Against the drawn map, or against none where
    /// that may not be shown.
    [[nodiscard]] float value(const ShadowScene& scene, const ShadowEye& eye) const;
    /// The planned map was drawn.
    void drawn(double time_s);
    /// Whether the drawn map may be shown at this moment. Takes a pose for each thing in it, or finds that worked out.
    [[nodiscard]] bool usable(const ShadowScene& scene, const ShadowEye& eye) const;
    /// There is no drawn map any more.
    void forget() { drawn_count_ = 0; }

private:
    /// A thing in a map, as it stood there.
    struct Cast {
        model::Index node = model::none;
        model::RigidPose pose;
    };
    /// A thing that may be in the next map.
    struct Near {
        model::Index node = model::none;
        double size_px = 0;
    };
    void find_near(const ShadowScene& scene, const ShadowEye& eye);
    bool fit(const ShadowScene& scene);
    bool choose_forms(const ShadowScene& scene, model::Index node);
    [[nodiscard]] double off_px(const ShadowScene& scene, const ShadowEye& eye, model::Index node) const;
    [[nodiscard]] bool recent(const ShadowScene& scene, double worst_px) const;

    ShadowLimits limits_;
    std::vector<model::Index> roots_;
    std::size_t next_root_ = 0;  ///< that the next plan begins with
    std::vector<bool> casts_;    ///< by form
    std::vector<Near> near_;
    std::vector<gl::DrawItem> items_;
    std::vector<Cast> planned_, drawn_;
    std::size_t drawn_count_ = 0;
    std::size_t visits_ = 0;  ///< nodes that the plan descended from
    gl::ShadowView view_;
    vec3 planned_towards_{0, 1, 0}, drawn_towards_{0, 1, 0};  ///< the sun
    double drawn_s_ = 0;
};

}  // namespace surefoot
