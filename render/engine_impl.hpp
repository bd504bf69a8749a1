// What an engine owns and what its submission shares: private to engine.cpp and engine_submit.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/cache/walk_cache.hpp"
#include "render/effect_lever.hpp"
#include "render/engine.hpp"
#include "render/filter_lever.hpp"
#include "render/floor_watch.hpp"
#include "render/model/moving.hpp"
#include "render/model/view.hpp"
#include "render/moving_shadow.hpp"
#include "render/prepare/resolution.hpp"
#include "render/rest.hpp"
#include "render/select/frame_profile.hpp"
#include "render/unprepared.hpp"
#include "rt/base/thread_annotations.hpp"

namespace surefoot {

/// A leaf that a picture was to show. It is drawn in full detail, or where there is no time in its cheapest form.
struct UncoveredItem {
    model::Index node = 0, full = 0, coarse = 0;  ///< forms
    model::ItemCost full_cost, coarse_cost;
    float pixels = 0, distance_m = 0;
};

/// What is left of a cost; at least nothing.
inline model::ItemCost less(const model::ItemCost& cost, const model::ItemCost& off) {
    return {std::max(0.0F, cost.submit_us - off.submit_us), std::max(0.0F, cost.raster_us - off.raster_us)};
}

/// The engine itself. prepare() runs on a worker; what GUARDED_BY(draws) marks belongs to the thread that draws.
struct Engine::Impl {
    model::Model model;
    model::CostModel costs;
    EngineOptions options;
    std::unique_ptr<gl::Device> device;
    std::unique_ptr<prepare::Preparer> preparer;
    prepare::ResolutionChooser resolution;
    const select::Selector* selector = nullptr;
    [[no_unique_address]] ThreadRole draws;                       ///< the thread that called bind(); prepare() runs on another
    bool full_depth_always = false;                               ///< requested by the options, for every selector
    bool by_budget = true;                                        ///< the selector: others buy whatever is offered
    bool keeps_target = false;                                    ///< the selector promises its target error
    bool by_value = true;                                         ///< the selector spends all of its budget by value
    rt::TextureFilter best_filter = rt::TextureFilter::bilinear;  ///< that frames may have
    FilterCosts filter_costs;
    QualityDwell dwell GUARDED_BY(draws);
    float filter_us GUARDED_BY(draws) = 0;       ///< that the second mip level was offered for; 0: it was not
    bool filtered GUARDED_BY(draws) = false;     ///< the cut has it
    bool offers_used GUARDED_BY(draws) = false;  ///< by a selection: the next offer begins a new list
    bool use_last GUARDED_BY(draws) = false;     ///< the last cut's forms: no prepared set may be used
    select::SelectState state GUARDED_BY(draws);
    select::Cut cut GUARDED_BY(draws);
    select::ItemList offered GUARDED_BY(draws);
    select::SlicePlan plan GUARDED_BY(draws);
    std::vector<gl::DrawItem> drawn GUARDED_BY(draws), culled GUARDED_BY(draws);
    FloorWatch floor GUARDED_BY(draws);
    Unprepared unprepared GUARDED_BY(draws);
    const prepare::PreparedFrame* prepared GUARDED_BY(draws) = nullptr;
    Correction correction GUARDED_BY(draws);
    double headroom GUARDED_BY(draws) = 1;  ///< that the last select() spent
    /// By step of resolution: the usual course of frames.
    std::array<select::FrameProfile, model::resolution_steps.size()> profiles GUARDED_BY(draws);
    double forecast_us GUARDED_BY(draws) = 0;      ///< end of this frame, by the last check that let a slice be drawn in full
    float drawn_resolution GUARDED_BY(draws) = 1;  ///< of the last prepared frame that was selected from

    model::MotionPoses poses GUARDED_BY(draws);        ///< at the time of the next picture
    std::vector<model::Index> restless;                ///< nodes whose pictures change with the time; not those below them
    model::MovingNodes moving GUARDED_BY(draws);       ///< at the time of the next picture
    double time_s GUARDED_BY(draws) = 0;               ///< of the next picture
    model::Daylight light GUARDED_BY(draws);           ///< of the next picture
    MovingShadow shadow GUARDED_BY(draws);             ///< none where nothing receives one
    ShadowEye shadow_eye GUARDED_BY(draws);            ///< for which it is planned
    bool shadow_due GUARDED_BY(draws) = false;         ///< the planned map was bought
    bool shadow_shown GUARDED_BY(draws) = false;       ///< by the last picture
    bool shadow_unbudgeted GUARDED_BY(draws) = false;  ///< draw_unbudgeted() is to show it
    bool course_known GUARDED_BY(draws) = false;
    bool jumped GUARDED_BY(draws) = false;  ///< since the last submit()
    /// Of the last submit(), and of the one after the last jump; below 0: unknown.
    std::int64_t frame_ns GUARDED_BY(draws) = -1, jumped_ns GUARDED_BY(draws) = -1;
    double begun_us GUARDED_BY(draws) = 0;                     ///< by the clock, that beginning the frame took
    bool rests GUARDED_BY(draws) = false;                      ///< the last submit() was at rest
    model::EffectMask pictures_without GUARDED_BY(draws) = 0;  ///< effects that the pictures were drawn without
    static constexpr std::uint32_t shadow_item = 0;            ///< the refresh that it is
    cache::WalkCache pictures GUARDED_BY(draws);               ///< none where the device has no layers
    std::vector<gl::DrawItem> picture_items;  ///< full detail of what lies in each box, as in SceneBoxes::nodes()
    std::string picture_reason;               ///< why there are none
    std::vector<gl::CachePicture> shown_pictures GUARDED_BY(draws);
    std::vector<gl::CachePicture> anew GUARDED_BY(draws);     ///< of draw_unbudgeted()
    std::vector<ShownPicture> shown_boxes GUARDED_BY(draws);  ///< the same, with their boxes
    std::vector<cache::Index> made_boxes GUARDED_BY(draws);   ///< that got a picture in this frame
    std::vector<cache::FrameBox> frame_boxes GUARDED_BY(draws);
    std::vector<UncoveredItem> uncovered GUARDED_BY(draws);  ///< leaves whose pictures are not valid
    std::vector<bool> is_uncovered GUARDED_BY(draws);        ///< by node; all false between frames
    model::CoverBits cover_bits GUARDED_BY(draws);
    cache::EyeCourse course GUARDED_BY(draws);           ///< of cover()
    double turn_rad GUARDED_BY(draws) = 0;               ///< of the views after it
    double pictures_us GUARDED_BY(draws) = 0;            ///< to draw the pictures of the cut's set, as predicted
    double pictures_save_us GUARDED_BY(draws) = 0;       ///< what they show took as forms
    double last_picture_sample GUARDED_BY(draws) = 1;    ///< of picture_factor
    double picture_factor GUARDED_BY(draws) = 1;         ///< time to draw pictures, over the table's and the frame's correction
    std::uint32_t picture_frames GUARDED_BY(draws) = 0;  ///< that drew enough of them to be timed
    /// Since pictures were timed. And how many are still timed one after another, since that was long ago.
    std::uint32_t untimed_frames GUARDED_BY(draws) = 64, timed_next GUARDED_BY(draws) = 0;
    double pictures_value GUARDED_BY(draws) = 0;  ///< of what the drawn pictures show
    double after_us GUARDED_BY(draws) = 0;        ///< of coarse forms after the last slice, in place of pictures
    double shown_us GUARDED_BY(draws) = 0;        ///< of the drawn pictures, after all forms
    RestWatch watch GUARDED_BY(draws);
    RestPicture rest_picture GUARDED_BY(draws);
    double one_more_ms GUARDED_BY(draws) = 0;
    model::EffectMask hidden GUARDED_BY(draws) = 0;       ///< by switches
    model::EffectMask by_light = 0;                       ///< that the device can leave out where the light shows nothing of them
    model::EffectMask unlit GUARDED_BY(draws) = 0;        ///< of by_light: those that show nothing now
    model::EffectMask priced_late GUARDED_BY(draws) = 0;  ///< of by_light: drawn, and not in the prices of the cut's set
    model::EffectMask priced_early GUARDED_BY(draws) = 0;  ///< of by_light: in these prices, and not drawn any more
    EffectLever lever GUARDED_BY(draws);
    EffectWorth worth;                           ///< of the thread that prepares; empty where no effects are bought
    std::atomic<model::EffectMask> without = 0;  ///< PreparedFrame::without of the next sets
    std::atomic<model::EffectMask> unseen = 0;  ///< drawn_without() of the last selection, or since a change of switches or light
    std::atomic<float> with_effects{1};         ///< time of forms and bought effects together, as a multiple of the forms'
    /// Of the pictures of the last selection's set: to draw them at full resolution, and the value of what they show.
    std::atomic<float> set_pictures_us{0}, set_pictures_value{0};
    std::atomic<float> light_hour{std::numeric_limits<float>::quiet_NaN()};  ///< of set_light()
    double promised_rad GUARDED_BY(draws) = 0;                               ///< error that the last cut was to keep; 0: none
    /// How long the frame before took; on a clock that does not run within frames, as predicted. 0: it drew no cut.
    double last_frame_us GUARDED_BY(draws) = 0;
    SubmitReport last_report GUARDED_BY(draws);  ///< of the last frame that drew a cut

    void use(const select::SelectorEntry& entry);
    bool submit_rest(const Pose& pose, const SubmitLimits& limits, SubmitReport& report) REQUIRES(draws);
    [[nodiscard]] model::ViewScale drawn_scale(const Pose& pose) const REQUIRES(draws) {
        return model::scaled(model::make_view_scale(pose, options.device.viewport), drawn_resolution);
    }
    /// How items add up at the resolution that is drawn.
    [[nodiscard]] model::FrameCombine combine() const REQUIRES(draws) {
        return costs.combine_at(drawn_resolution, options.device.viewport);
    }
    [[nodiscard]] float enlarge_us() const REQUIRES(draws) { return costs.enlarge_us(drawn_resolution, options.device.viewport); }
    double now_us(const SubmitLimits& limits) const REQUIRES(draws) {
        device->draws.plays();  // `draws` is the same thread
        return limits.now_ns != nullptr ? static_cast<double>(limits.now_ns(limits.now_context)) * 1e-3 : device->charged_us();
    }
    model::Frustum frustum GUARDED_BY(draws);  ///< of the pose that is drawn: narrower than the region that was prepared
    /// Predicted costs within a frame: of what is drawn, of the next part in full and as its stand-in. `rest` is of all after it
    /// as stand-ins.
    struct Progression {
        const model::ItemCost &so_far, &next, &stand_in, &rest;
        float in_flight_us;            ///< of so_far's raster time: not finished yet
        model::ItemCost pending = {};  ///< of so_far: not handed to the device yet
        float before_us = 0;           ///< of what comes before the first slice, while it is not finished yet
    };
    [[nodiscard]] select::SelectInput input_of(const prepare::PreparedFrame& set, double budget_us, const Correction& by,
                                               double target_error_rad) const REQUIRES(draws);
    [[nodiscard]] double gain_of_one_more_ms(const select::SelectInput& input) const REQUIRES(draws);
    static void count_error(model::Index node, float error_rad, float importance, SubmitReport& report);
    [[nodiscard]] rt::Guarantee guarantee_of(const SubmitReport& report) const REQUIRES(draws);
    void begin_offers() REQUIRES(draws);
    void take_filter() REQUIRES(draws);
    void reserve_effects() REQUIRES(draws);
    void price_without() REQUIRES(draws);
    [[nodiscard]] model::EffectMask priced_now(std::size_t g) const REQUIRES(draws);
    void price_groups(const prepare::PreparedFrame& set) REQUIRES(draws);
    void share_budget(const prepare::PreparedFrame& set, double room_us) REQUIRES(draws);
    void offer_effects(const prepare::PreparedFrame& set, double room_us) REQUIRES(draws);
    void take_effects(const prepare::PreparedFrame& set) REQUIRES(draws);
    void learn_effects() REQUIRES(draws);
    /// Whether a group has anything that is switched on and shows in this light.
    [[nodiscard]] bool may_show(std::size_t g) const REQUIRES(draws) { return (lever.groups[g].own & ~(hidden | unlit)) != 0; }
    void price_slices() REQUIRES(draws);
    [[nodiscard]] gl::DeviceOptions with_light_groups();
    void leave_out_unlit() REQUIRES(draws);
    void price_light_change(const prepare::PreparedFrame& set) REQUIRES(draws);
    /// Effects that all pictures are drawn without: what is switched off, and what shows nothing in their light.
    [[nodiscard]] model::EffectMask always_without() const REQUIRES(draws) {
        return gl::left_out(options.device.switches, hidden) | unlit;
    }
    /// Effects that a cut's pictures are drawn without.
    [[nodiscard]] model::EffectMask drawn_without() const REQUIRES(draws) {
        return gl::left_out(options.device.switches, hidden | lever.left_out) | unlit;
    }
    [[nodiscard]] bool was_bought(const select::ItemName& name) const REQUIRES(draws);
    [[nodiscard]] model::ItemCost effects_of(model::Index rep, float surface_px, model::EffectMask effects) const REQUIRES(draws);
    /// What the choice costs as it is drawn: with the second mip level and with the effects that were bought.
    [[nodiscard]] model::ItemCost drawn_cost(const prepare::Choice& choice) const REQUIRES(draws) {
        model::ItemCost cost = choice.cost;
        if ((lever.shown | priced_late) != 0) cost += effects_of(choice.rep, choice.surface_px, lever.shown | priced_late);
        if (priced_early != 0) cost = less(cost, effects_of(choice.rep, choice.surface_px, priced_early));
        return filtered && !use_last ? filter_costs.with(choice.rep, cost) : cost;
    }
    [[nodiscard]] select::FrameProfile& profile() REQUIRES(draws) { return profiles[model::resolution_step(drawn_resolution)]; }
    /// Of what was bought, the time that is spent beside the draws.
    [[nodiscard]] double beside_us() const REQUIRES(draws) {
        return use_last ? 0.0 : cut.bought.cost_us - (filtered ? static_cast<double>(filter_us) : 0.0) - lever.spent_us;
    }
    void make_pictures() REQUIRES(draws);
    [[nodiscard]] double picture_us(cache::Index box, const Pose& pose) const REQUIRES(draws);
    void prepay_pictures(const prepare::PreparedFrame& set) REQUIRES(draws);
    [[nodiscard]] bool has_time_for_all(const prepare::PreparedFrame& set, float room_us) const REQUIRES(draws);
    void offer_pictures(const prepare::PreparedFrame& set, const select::SelectInput& input) REQUIRES(draws);
    void take_pictures() REQUIRES(draws);
    void capture_pictures(SubmitReport& report) REQUIRES(draws);
    double find_uncovered(const Pose& pose, double left_us) REQUIRES(draws);
    [[nodiscard]] double left_for_uncovered_us(const SubmitLimits& limits) const REQUIRES(draws);
    void begin_pictures(const Pose& pose, const SubmitLimits& limits, SubmitReport& report) REQUIRES(draws);
    void count_boxes(SubmitReport& report) REQUIRES(draws);
    void draw_uncovered(const SubmitLimits& limits, double start_us, model::ItemCost& so_far, SubmitReport& report)
        REQUIRES(draws);
    void draw_pictures(const SubmitLimits& limits, SubmitReport& report) REQUIRES(draws);
    [[nodiscard]] bool is_timed(double table_us) REQUIRES(draws);
    [[nodiscard]] std::span<const gl::DrawItem> contents_of(cache::Index box) const REQUIRES(draws) {
        return std::span(picture_items).subspan(pictures.boxes().first_node(box), pictures.boxes().nodes(box).size());
    }
    void make_pictures_anew(const Pose& pose, std::span<const ShownPicture> shown) REQUIRES(draws);
    void draw_items(const Pose& pose, std::span<const gl::DrawItem> items, float at_resolution) REQUIRES(draws);
    [[nodiscard]] ShadowScene shadow_scene() REQUIRES(draws);
    void offer_shadow(const prepare::PreparedFrame& set) REQUIRES(draws);
    void take_shadow() REQUIRES(draws);
    [[nodiscard]] float shadow_map_us() const REQUIRES(draws);
    [[nodiscard]] float before_us(bool shadow_refreshed) const REQUIRES(draws);
    void begin_shadow(const Pose& pose, SubmitReport& report) REQUIRES(draws);
    void prepay_resolution(const prepare::PreparedFrame& set) REQUIRES(draws);
    void report_items(SubmitReport& report) const REQUIRES(draws);
    [[nodiscard]] bool in_time(const Progression& p, const SubmitLimits& limits, double start_us) REQUIRES(draws);
    model::ItemCost draw_slice(std::span<const select::CutItem> items, SubmitReport& report) REQUIRES(draws);
    void submit_cut(const SubmitLimits& limits, double start_us, SubmitReport& report) REQUIRES(draws);
    void submit_last(const Pose& pose, const SubmitLimits& limits, double start_us, SubmitReport& report) REQUIRES(draws);
    void push(const UnpreparedItem& item, SubmitReport& report) REQUIRES(draws);
    [[nodiscard]] bool in_view(model::Index node) REQUIRES(draws);
    [[nodiscard]] bool motion_in_view(const Pose& pose) const REQUIRES(draws);
};

/// What moves, and leaves whose full detail has an effect that does.
std::vector<model::Index> restless_nodes(const model::Model& model, const model::MovingNodes& moving);

}  // namespace surefoot
