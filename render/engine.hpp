// The renderer's interface: open a model, prepare, select, submit, report.
//
//   workers:       prepare(region) ──► PreparedFrame ──┐  (handed over by the caller, newest wins)
//   frame thread:  select(prepared, budget) ──► Cut ◄──┘ ──► submit(pose, limit): slice by slice ──► SubmitReport
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/cache/frame_boxes.hpp"
#include "render/gl/device.hpp"
#include "render/model/cost.hpp"
#include "render/model/covered_boxes.hpp"
#include "render/model/model.hpp"
#include "render/model/resolution.hpp"
#include "render/prepare/prepared.hpp"
#include "render/select/registry.hpp"
#include "rt/base/result.hpp"

namespace surefoot {

/// Settings of an engine.
struct EngineOptions {
    gl::DeviceOptions device;  ///< the costs of the null backend are the engine's
    prepare::PrepareOptions prepare;
    std::string selector{select::usual_selector};
    double slice_us = 1000;  ///< predicted length of the shortest slices
    float hysteresis = 1.25F;
    float reserve_share = 0.03F;  ///< SelectState::reserve_share
    /// Share of the picture's width and height that is drawn, then enlarged; 0: chosen frame by frame.
    float resolution = 1;
    /// How long the pose must stay before the picture at rest is drawn, ms; 0: never. SubmitLimits::frame_ns is its clock.
    double rest_after_ms = 0;
    double max_error_rad = 0;  ///< SelectInput::max_error_rad; refused for selectors that do not guarantee it
    select::BenefitModel benefit = select::BenefitModel::surefoot;  ///< of the 1994 selectors
    bool motion = true;  ///< false: what moves stands as at time 0, in pictures at any time and in sets for them
    /// Groups of DeviceOptions::switches are items: a frame leaves out those whose value per us is less than that of forms.
    bool buys_effects = false;
    /// Pictures of the image cache are kept all round the eye, as fine as at the picture's corner: a turn makes none.
    bool pictures_all_round = false;
    std::vector<double> effect_hours;  ///< of the day, rising, for which their worth is found; empty: the model's own light
    bool in_frame_check = true;        ///< checks slices against the time left; off only for comparison
};

/// Time limit of one frame, and the clock for its checks.
struct SubmitLimits {
    double elapsed_us = 0;                            ///< already spent in this frame when submit is called
    double limit_us = 0;                              ///< when the frame should be done, from its start
    double deadline_us = 0;                           ///< when it is late; 0: at the limit
    double margin_us = 0;                             ///< of the in-frame check: how much later than forecast frames end
    std::int64_t (*now_ns)(void* context) = nullptr;  ///< null: the device's charged time (virtual)
    void* now_context = nullptr;
    std::int64_t frame_ns = -1;  ///< the time that the pose is of; below 0: unknown, and no rest
    /// Of FrameProfile: the same in all frames.
    [[nodiscard]] double scale_us() const { return std::max(limit_us, deadline_us); }
};

/// Actual / predicted cost of recent frames: the median, and the headroom (p90) on top of it.
struct Correction {
    double factor = 1;
    double headroom = 0;  ///< 0: the cost table's
};

/// What the frame thread knows for the next preparation.
struct PrepareHints {
    /// By step of resolution: predicted time that a cut may take, without correction and headroom. 0: the resolution stays.
    std::array<double, model::resolution_steps.size()> planned_us{};
    double form_ratio = 1;          ///< how much more expensive full detail is against coarse forms than predicted
    double time_s = 0, span_s = 0;  ///< of what moves: the set is for pictures from this time on, and no later than the span
    model::CoverBits covered;       ///< by Engine::cover(): the set leaves out what pictures show
};

/// A group of effects in a selection.
struct EffectSale {
    model::EffectMask group = 0;  ///< one of DeviceOptions::switches
    float rate = 0;               ///< value per us; of a dropped one, at which it fell; 0: it is not for sale
    bool dropped = false;         ///< it would show something, and is left out
    bool fell = false;            ///< by this selection
};

/// Results of a submission. Times in us from the call.
struct SubmitReport {
    double submitted_us = 0;            ///< last slice handed to the driver
    double finished_us = 0;             ///< last fence passed
    double predicted_us = 0;            ///< of the drawn items; uncorrected, without headroom
    model::ItemCost predicted;          ///< the sums behind predicted_us, slices included
    double full_us = 0, coarse_us = 0;  ///< of predicted_us, before PrepareHints::form_ratio: items in full detail, and others
    double other_us = 0;                ///< of predicted_us: all but the items
    double forecast_us = 0;  ///< of finished_us, by the last check that let a slice be drawn in full; 0: none did, or untimed
    std::uint32_t slices = 0, downgraded_slices = 0, items = 0, draws = 0;
    std::uint32_t culled = 0;  ///< items of the cut outside this pose's view
    std::uint64_t triangles = 0;
    std::uint32_t bought_items = 0, refused_items = 0;  ///< beside the forms; see select/item.hpp
    double bought_us = 0;                               ///< of predicted_us: what they cost
    float resolution = 1;                               ///< that was drawn: a step of model::resolution_steps
    std::uint32_t samples = 1;                          ///< of a pixel, that were drawn
    rt::TextureFilter filter = rt::TextureFilter::bilinear;
    float worst_error_rad = 0;              ///< of the drawn items, stand-ins included
    float worst_weighted_rad = 0;           ///< the same of errors times importance
    model::Index worst_node = model::none;  ///< the node of worst_weighted_rad; none: all is exact
    /// EngineOptions::max_error_rad, or the target error of a selector that promises it; 0: nothing is promised.
    double promised_rad = 0;
    rt::Guarantee guarantee = rt::Guarantee::none;  ///< of promised_rad: kept, or why not
    double value = 0;  ///< share of PreparedFrame::full_value that is drawn; 0: no prepared frame is; 1: nothing has value
    /// The share that the best cut would show more, had the budget been a millisecond longer. As estimated by the prepared frame.
    /// 0 where the selector does not spend all of its time by value: all but `threshold`, and with a guarantee.
    double one_more_ms = 0;
    std::uint32_t dropped_objects = 0;  ///< select::Dropped::count
    /// The picture that was shown stays, or full detail replaces it (RestPicture). slices, predicted_us and times are of what was
    /// drawn beside it; all else describes the shown picture.
    bool at_rest = false;
    std::uint32_t rest_samples = 0;                       ///< of the shown picture: 1 is full detail; 0: it is a cut
    bool shadow_refreshed = false, shadow_shown = false;  ///< the shadow map of what moves: bought by this frame; in its picture
    std::uint32_t pictures = 0;                           ///< of the image cache: that show a part of the frame
    std::uint32_t pictures_made = 0;                      ///< bought by this frame
    std::uint32_t pictures_reused = 0;                    ///< of pictures: made by earlier frames
    std::uint32_t boxes_as_triangles = 0;                 ///< in view, whose contents no picture shows
    double pictures_us = 0;                               ///< of predicted_us: to draw them
    double captures_us = 0;                               ///< of predicted_us and bought_us: to make them
    std::uint64_t picture_bytes = 0;                      ///< of all pictures that the cache holds
    std::uint32_t uncovered_items = 0;                    ///< drawn in place of pictures that were not valid any more
    float floor_share = 0;  ///< of the drawn pixels, as estimated: those in the cheapest forms of nodes that have finer ones
};

/// A picture of the image cache in a frame, and the box of the cache that it shows.
struct ShownPicture {
    gl::CachePicture picture;
    std::uint32_t box = 0;
};

/// A model, a device and the arrays between them. prepare() may run on any one thread at a time; all other calls belong to the
/// thread that called bind(). After open() nothing allocates, except the driver and the calls that say so.
class Engine {
public:
    /// Call from a neutral thread: driver and worker threads inherit from their creator.
    static Result<std::unique_ptr<Engine>> open(model::Model model, const model::CostModel& costs, const EngineOptions& options);
    ~Engine();
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    /// The model, without its texels.
    [[nodiscard]] const model::Model& model() const;
    /// As the device draws: with its samples and its texture filter.
    [[nodiscard]] const model::CostModel& costs() const;
    [[nodiscard]] gl::Device& device();
    [[nodiscard]] const EngineOptions& options() const;

    void reserve(prepare::PreparedFrame& frame) const;
    /// Ends the threads that help to prepare: what is left of the engine ends without them.
    void end_workers();
    void prepare(const prepare::Region& region, std::uint64_t frame, double speed_mps, double turn_rps,
                 prepare::PreparedFrame& out, const PrepareHints& hints = {});

    /// Whether there is an image cache. Where layers were requested and it is not, picture_reason() has the reason.
    [[nodiscard]] bool has_pictures() const;
    [[nodiscard]] const std::string& picture_reason() const;
    /// What the pictures of the image cache show on the way from a pose to a region: for PrepareHints::covered. Once a frame,
    /// before select(). Nothing without a cache (gl::DeviceOptions::picture_layers).
    const model::CoverBits& cover(const Pose& now, const prepare::Region& next);

    /// Changes the selector, from the next prepare() on. No prepare() may be running, since `flat` changes its depth. Allocates.
    Result<void> set_selector(std::string_view name);

    /// Leaves groups of effects out of the next pictures (gl::DeviceOptions::switches), or the model's own light gives way to
    /// another. Effects that show nothing in it are left out by themselves. Between pictures, on the thread that draws. A change
    /// lets a picture at rest begin anew. Sets that are prepared from then on have the prices of what is left. `hour`: of the
    /// light, where EngineOptions::effect_hours are given.
    void hide_effects(model::EffectMask hidden);
    void set_light(const model::Daylight& light, float hour = std::numeric_limits<float>::quiet_NaN());
    /// The time of the next pictures: where what moves is drawn. As hide_effects() else, but a picture at rest goes on: it only
    /// begins where nothing in view moves.
    void set_time(double time_s);
    /// By DeviceOptions::switches: what the last select() did with them. Empty where effects are not bought.
    [[nodiscard]] std::span<const EffectSale> effect_sales() const;

    /// Offers something that the next select() may buy beside forms. False: refused, and counted in its cut.
    bool offer(const select::Item& item);
    /// Offers the next select() the second mip level of textures, where frames before had ample time for it: see QualityDwell.
    /// correction: of frames that are drawn so. False: not offered. Call it once a frame; without it, none has the second level.
    bool offer_filter(const prepare::PreparedFrame& prepared, double budget_us, const Correction& correction);
    /// Whether the cut that the next submit() draws has it. Always false after select_last().
    [[nodiscard]] bool bought(select::ItemKind kind, std::uint32_t what) const;
    /// All that was offered to the last select(), what it prepaid included.
    [[nodiscard]] const select::ItemList& offered() const;

    /// budget_us: of the whole frame; target_error_rad 0: as far as the budget goes.
    const select::Cut& select(const prepare::PreparedFrame& prepared, double budget_us, const Correction& correction,
                              double target_error_rad);
    /// State of the selector between frames. For a capture, copy it before select().
    [[nodiscard]] const select::SelectState& selection_memory() const;
    /// Draws the cut of the last select(), or after select_last() that cut's forms at this pose.
    SubmitReport submit(const Pose& pose, const SubmitLimits& limits);
    /// Replaces select() if no prepared frame may be used. What the last cut showed keeps its forms, where they are legal at the
    /// pose. All else shows coarse levels, valid from everywhere. The in-frame check holds here too.
    void select_last();

    /// (node, representation) of what the last submit() shows, in drawing order; valid until the next.
    [[nodiscard]] std::span<const gl::DrawItem> drawn() const;
    /// Items of that cut, or their stand-ins, that were outside the pose's view; valid as long.
    [[nodiscard]] std::span<const gl::DrawItem> culled() const;
    /// Pictures of the image cache in the last submit(), back to front; valid as long.
    [[nodiscard]] std::span<const gl::CachePicture> pictures() const;
    /// The same, so that the frame may be drawn again later.
    [[nodiscard]] std::span<const ShownPicture> shown_pictures() const;
    /// Leaves of the model that lie in a box of the image cache, or reach into it.
    [[nodiscard]] std::span<const model::Index> leaves_in(std::uint32_t box) const;
    /// Maximum number of pictures in a frame.
    [[nodiscard]] std::size_t picture_capacity() const;
    /// What it did with each box of the cache; empty without one.
    [[nodiscard]] std::span<const cache::FrameBox> cache_boxes() const;
    /// Such boxes, kept from any frame, from above: cache::birds_eye_view(), with the eye in it. Allocates.
    [[nodiscard]] std::vector<std::uint8_t> birds_eye(std::span<const cache::FrameBox> frame, const dvec3& eye,
                                                      std::uint32_t side_px) const;
    /// Whether the last submit() fell to the floor without need. Over half of its picture shows floor forms where the cut before
    /// had finer ones. And what of that cut is in view now would have been done within `time_us` from the call, by `correction`.
    /// Takes a microsecond, or up to a millisecond where much of the picture is at the floor: call it after the frame.
    [[nodiscard]] bool fell_to_floor(const Pose& pose, double time_us, double correction);
    /// Maximum number of items in drawn() and culled() together.
    [[nodiscard]] std::size_t drawn_capacity() const;

    /// The next draw_unbudgeted() draws the shadow map of what moves and shows it; without this call its pictures have no such
    /// shadow. False: there is none.
    bool refresh_shadow(const Pose& pose);
    /// Forgets the drawn shadow map: no picture shows it any more. One that the last select() bought is drawn by the next
    /// submit(), also where another submit() drew it before. For measurements in which no frame may have what an earlier one
    /// paid for.
    void forget_shadow();
    /// Draws items without a budget, for images of reports: full_detail(), or a remembered set. `filter`: automatic is the best
    /// that frames may have.
    void draw_unbudgeted(const Pose& pose, std::span<const gl::DrawItem> items, float resolution = 1,
                         rt::TextureFilter filter = rt::TextureFilter::automatic);
    /// The same with pictures of the image cache, as a frame showed them. They are made anew, in the light that is set, over
    /// those of the walk: a walk that goes on begins without any.
    void draw_unbudgeted(const Pose& pose, std::span<const gl::DrawItem> items, std::span<const ShownPicture> pictures,
                         float resolution, rt::TextureFilter filter);
    /// Every visible leaf at full detail, for draw_unbudgeted; allocates.
    [[nodiscard]] std::vector<gl::DrawItem> full_detail(const Pose& pose) const;

private:
    struct Impl;
    explicit Engine(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Whether the region contains the pose's eye and its whole view.
bool covers(const prepare::Region& region, const Pose& pose, model::Viewport viewport);

/// The region for the next frames, from the last two samples: extrapolated by `horizon_s`, widened by possible changes.
prepare::Region predict_region(const Pose& before, const Pose& now, double dt_s, double horizon_s);

}  // namespace surefoot
