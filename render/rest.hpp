// The picture at rest: full detail drawn over several frames beside the shown picture, then refined by moved samples.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/engine.hpp"
#include "render/filter_lever.hpp"
#include "render/gl/device.hpp"
#include "render/model/item_costs.hpp"
#include "render/model/model.hpp"
#include "render/model/view.hpp"

namespace surefoot {

/// Decides when the eye is at rest: its pose has stayed within both thresholds of one pose for a time. A slow drift ends a rest,
/// since poses are compared with the one where the rest began.
class RestWatch {
public:
    /// A tenth of a pixel, roughly: of what is a metre away, and of a picture with 60 degrees and 1000 lines.
    static constexpr double still_m = 1e-4, still_rad = 1e-4;

    /// after_ns: how long the pose must stay; 0: it is never at rest.
    explicit RestWatch(std::int64_t after_ns = 0) : after_ns_(after_ns) {}
    /// The pose of the frame at `now_ns`. A pose that is not finite is a movement.
    bool at_rest(const Pose& pose, std::int64_t now_ns);
    /// The next pose counts as a movement.
    void forget() { known_ = false; }

private:
    std::int64_t after_ns_, since_ns_ = 0;
    Pose pose_;
    bool known_ = false;
};

/// Number of samples of a smooth picture, the unmoved one included.
constexpr std::uint32_t max_rest_samples = 64;

/// Where a sample moves the picture, in pixels, -0.5 to 0.5. Sample 0 is not moved; the others follow the Halton sequence of
/// bases 2 and 3.
dvec2 rest_offset_px(std::uint32_t sample);

/// What the picture at rest is made of and with.
struct RestScene {
    const model::Model& model;
    const model::ItemCosts& item_costs;
    const model::CostModel& costs;
    gl::Device& device;
    model::Viewport viewport;
    double slice_us = 1000;
    const FilterCosts& filter_costs;
    rt::TextureFilter filter;      ///< the best one: a picture at rest has the time
    model::EffectMask hidden = 0;  ///< effects that are not drawn
};

/// Belongs to the frame thread. Sized once; then nothing allocates. Each part is drawn only if its predicted cost fits the frame.
class RestPicture {
public:
    void reserve(const model::Model& model);
    [[nodiscard]] std::size_t capacity() const { return items_.capacity(); }

    /// A frame at rest: goes on with the picture, and presents what is shown. The first one after leave() begins a picture of
    /// `pose`. False: nothing was drawn or presented, because some part of this picture fits no frame.
    bool frame(const RestScene& scene, const Pose& pose, const SubmitLimits& limits, double correction, SubmitReport& report);
    /// The eye has moved: the next frame at rest begins anew.
    void leave();

    /// Samples of the shown picture; 0: it is still the last one of the walk.
    [[nodiscard]] std::uint32_t samples() const { return shown_; }
    [[nodiscard]] std::span<const gl::DrawItem> items() const { return items_; }  ///< all visible leaves, once they are collected

private:
    enum class Phase : std::uint8_t { away, collect, sort, begin, opaque, blended, add, show, done, refused };
    struct Leaf {
        gl::DrawItem item;
        model::ItemCost cost;
        float distance_m = 0;
        std::uint8_t bucket = 0;
    };
    struct Frame;
    bool advance(Frame& frame);
    bool collect(Frame& frame);
    bool sort(Frame& frame);
    void sort_blended();
    bool draw(Frame& frame, gl::Parts parts);
    bool show(Frame& frame);
    void collect_node(const Frame& frame, model::Index node);
    void describe(SubmitReport& report) const;

    static constexpr std::size_t buckets = 256;  ///< of the logarithm of the distance
    static constexpr int max_stalled = 60;       ///< frames without progress
    Phase phase_ = Phase::away;
    Pose pose_;
    model::Frustum frustum_;
    model::ViewScale scale_;
    double pixel_rad_ = 0;
    std::vector<model::Index> stack_;
    std::vector<Leaf> leaves_, blended_leaves_;   ///< in the order of the tree; far to near
    std::array<std::uint32_t, buckets> place_{};  ///< leaves of a bucket; then where the next of a bucket goes
    std::vector<gl::DrawItem> items_, blended_;   ///< near to far; far to near
    std::vector<model::ItemCost> cost_, blended_cost_;
    std::size_t next_ = 0;  ///< leaf or item to go on with
    std::uint64_t triangles_ = 0;
    std::uint32_t sample_ = 0, shown_ = 0;  ///< sample that is drawn; samples that are shown
    double learned_ = 0;                    ///< actual / predicted of recent frames: the largest, slowly forgotten
    int stalled_ = 0;
};

}  // namespace surefoot
