// The renderer's door, implemented: owns model, device and arrays, and runs the sliced submission with its in-frame check.
#include "render/engine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "render/drawn_items.hpp"
#include "render/effects/effects.hpp"
#include "render/floor_watch.hpp"
#include "render/model/view.hpp"
#include "render/prepare/resolution.hpp"
#include "render/rest.hpp"
#include "render/unprepared.hpp"
#include "rt/base/check.hpp"
#include "rt/base/thread_annotations.hpp"

namespace surefoot {

namespace {

constexpr float floor_picture_share = 0.5F;

}  // namespace

struct Engine::Impl {
    model::Model model;
    model::CostModel costs;
    EngineOptions options;
    std::unique_ptr<gl::Device> device;
    std::unique_ptr<prepare::Preparer> preparer;
    prepare::ResolutionChooser resolution;
    bool full_depth_always = false;  ///< requested by the options, for every selector
    const select::Selector* selector = nullptr;
    [[no_unique_address]] ThreadRole draws;  ///< the thread that called bind(); prepare() runs on another
    select::SelectState state GUARDED_BY(draws);
    select::Cut cut GUARDED_BY(draws);
    select::ItemList offered GUARDED_BY(draws);
    bool offers_used GUARDED_BY(draws) = false;  ///< by a selection: the next offer begins a new list
    select::SlicePlan plan GUARDED_BY(draws);
    std::vector<gl::DrawItem> drawn GUARDED_BY(draws), culled GUARDED_BY(draws);
    FloorWatch floor GUARDED_BY(draws);
    Unprepared unprepared GUARDED_BY(draws);
    bool use_last GUARDED_BY(draws) = false;  ///< the last cut's forms: no prepared set may be used
    const prepare::PreparedFrame* prepared GUARDED_BY(draws) = nullptr;
    Correction correction GUARDED_BY(draws);
    double headroom GUARDED_BY(draws) = 1;         ///< that the last select() spent
    double forecast_us GUARDED_BY(draws) = 0;      ///< end of this frame, by the last check that let a slice be drawn in full
    float drawn_resolution GUARDED_BY(draws) = 1;  ///< of the last prepared frame that was selected from

    RestWatch watch GUARDED_BY(draws);
    RestPicture rest_picture GUARDED_BY(draws);
    SubmitReport last_report GUARDED_BY(draws);  ///< of the last frame that drew a cut

    void use(const select::SelectorEntry& entry);
    bool submit_rest(const Pose& pose, const SubmitLimits& limits, SubmitReport& report) REQUIRES(draws);
    [[nodiscard]] model::ViewScale drawn_scale(const Pose& pose) const REQUIRES(draws) {
        return model::scaled(model::make_view_scale(pose, options.device.viewport), drawn_resolution);
    }
    [[nodiscard]] float enlarge_us() const REQUIRES(draws) { return costs.enlarge_us(drawn_resolution, options.device.viewport); }
    double now_us(const SubmitLimits& limits) const REQUIRES(draws) {
        device->draws.plays();  // `draws` is the same thread
        return limits.now_ns != nullptr ? static_cast<double>(limits.now_ns(limits.now_context)) * 1e-3 : device->charged_us();
    }
    model::Frustum frustum GUARDED_BY(draws);  ///< of the pose that is drawn: narrower than the region that was prepared
    /// Predicted costs within a frame: of what is drawn, of the next part in full and as its stand-in, and of all after it as
    /// stand-ins.
    struct Progression {
        const model::ItemCost &so_far, &next, &stand_in, &rest;
        float in_flight_us;  ///< of so_far: not finished yet
    };
    void begin_offers() REQUIRES(draws);
    void prepay_resolution(const prepare::PreparedFrame& set) REQUIRES(draws);
    void report_items(SubmitReport& report) const REQUIRES(draws);
    [[nodiscard]] bool in_time(const Progression& p, const SubmitLimits& limits, double start_us) REQUIRES(draws);
    model::ItemCost draw_slice(std::span<const select::CutItem> items, SubmitReport& report) REQUIRES(draws);
    void submit_cut(const SubmitLimits& limits, double start_us, SubmitReport& report) REQUIRES(draws);
    void submit_last(const Pose& pose, const SubmitLimits& limits, double start_us, SubmitReport& report) REQUIRES(draws);
    void push(const UnpreparedItem& item, SubmitReport& report) REQUIRES(draws);
};

Engine::Engine(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Engine::~Engine() = default;

Result<std::unique_ptr<Engine>> Engine::open(model::Model model, const model::CostModel& costs, const EngineOptions& options) {
    auto impl = std::make_unique<Impl>();
    impl->draws.plays();  // nobody else has it yet
    impl->model = std::move(model);
    impl->costs = costs;
    impl->options = options;
    auto selector = select::selector_named(options.selector);
    if (!selector) return selector.error();
    impl->options.device.null.costs = &impl->costs;
    impl->options.device.null.enlarge_us = static_cast<double>(costs.enlarge_us(0.5F, options.device.viewport));
    impl->options.device.rest = options.rest_after_ms > 0;
    impl->options.device.null.rest_pass_us = static_cast<double>(costs.rest_pass_us(options.device.viewport));
    impl->options.resolution = model::stepped(options.resolution);
    if (impl->options.resolution > 0.0F) impl->drawn_resolution = impl->options.resolution;
    auto device = gl::open_device(impl->options.device);
    if (!device) return device.error();
    impl->device = std::move(*device);
    impl->device->draws.plays();
    auto loaded = impl->device->load(impl->model, effects::assemble_program);
    if (!loaded) return loaded.error();
    decltype(impl->model.texels)().swap(impl->model.texels);  // the device has its own
    const auto candidates =
        static_cast<std::uint32_t>(std::min<std::size_t>(options.prepare.max_candidates, impl->model.nodes.size()));
    impl->options.prepare.max_candidates = candidates;
    impl->options.prepare.max_choices =
        static_cast<std::uint32_t>(std::min<std::size_t>(options.prepare.max_choices, impl->model.reps.size()));
    impl->full_depth_always = options.prepare.full_depth;
    impl->use(**selector);
    impl->state.reserve(impl->model, candidates);
    impl->state.hysteresis = options.hysteresis;
    select::reserve(impl->cut, candidates);
    impl->plan.reserve(candidates);
    impl->unprepared.reserve(impl->model);
    const std::size_t max_drawn = std::max<std::size_t>(candidates * 2, impl->unprepared.capacity());
    impl->drawn.reserve(max_drawn);
    impl->culled.reserve(candidates);
    impl->floor.reserve(impl->model.nodes.size(), std::max<std::size_t>(candidates, impl->unprepared.capacity()));
    if (options.rest_after_ms > 0) {
        impl->watch = RestWatch(static_cast<std::int64_t>(options.rest_after_ms * 1e6));
        impl->rest_picture.reserve(impl->model);
    }
    return std::unique_ptr<Engine>(new Engine(std::move(impl)));
}

/// A preparer's depth is fixed as it is made: full detail needs the leaves, the other selectors are spared them.
void Engine::Impl::use(const select::SelectorEntry& entry) {
    selector = &entry.make();
    const bool full_depth = full_depth_always || entry.goes_by == select::GoesBy::nothing;
    if (preparer && full_depth == options.prepare.full_depth) return;
    options.prepare.full_depth = full_depth;
    preparer.reset();  // its workers first
    preparer = std::make_unique<prepare::Preparer>(model, costs, options.prepare);
}

const model::Model& Engine::model() const { return impl_->model; }
const model::CostModel& Engine::costs() const { return impl_->costs; }
gl::Device& Engine::device() { return *impl_->device; }
const EngineOptions& Engine::options() const { return impl_->options; }
std::span<const gl::DrawItem> Engine::drawn() const {
    impl_->draws.plays();
    return impl_->rest_picture.samples() > 0 ? impl_->rest_picture.items() : std::span<const gl::DrawItem>(impl_->drawn);
}
std::span<const gl::DrawItem> Engine::culled() const {
    impl_->draws.plays();
    return impl_->rest_picture.samples() > 0 ? std::span<const gl::DrawItem>() : std::span<const gl::DrawItem>(impl_->culled);
}
std::size_t Engine::drawn_capacity() const {
    impl_->draws.plays();
    return std::max(impl_->drawn.capacity(), impl_->rest_picture.capacity());
}

void Engine::reserve(prepare::PreparedFrame& frame) const { impl_->preparer->reserve(frame); }

void Engine::prepare(const prepare::Region& region, std::uint64_t frame, double speed_mps, double turn_rps,
                     prepare::PreparedFrame& out, const PrepareHints& hints) {
    Impl& e = *impl_;
    const model::Viewport viewport = e.options.device.viewport;
    const bool chosen = !(e.options.resolution > 0.0F);
    out.resolution = chosen ? e.resolution.resolution() : e.options.resolution;
    out.resolution_value = 0.0F;
    // Only their ratio: the common correction, which follows whole frames, finds their level.
    const auto apart = static_cast<float>(std::sqrt(hints.form_ratio > 0.0 ? hints.form_ratio : 1.0));
    out.full_factor = apart;
    out.coarse_factor = 1.0F / apart;
    e.preparer->run(region, viewport, frame, speed_mps, turn_rps, out);
    if (!chosen || !(hints.planned_us[0] > 0.0) || e.options.prepare.full_depth) return;
    // As Budget counts it: the fixed time, and the ends of slices.
    const double slice_end_us = static_cast<double>(e.costs.combine.submit_weight * e.costs.slice_us);
    const auto lost = [&](const prepare::ValueCurve& curve, float at) {
        const double fixed_us = static_cast<double>(e.costs.combine.fixed_us + e.costs.enlarge_us(at, viewport)) + slice_end_us;
        const double planned_us = hints.planned_us[model::resolution_step(at)];
        const double items_us = (planned_us - fixed_us) / (1.0 + slice_end_us / std::max(1.0, e.options.slice_us));
        return prepare::lost_share(curve, items_us) + static_cast<double>(e.costs.blur_loss_at(at));
    };
    const float other = e.resolution.trial();
    if (other > 0.0F) e.resolution.judge(lost(out.curve, out.resolution), lost(e.preparer->value_at(other), other));
    out.resolution_value = e.resolution.gain() * out.curve.full_value;
}

Result<void> Engine::set_selector(std::string_view name) {
    auto selector = select::selector_named(name);
    if (!selector) return selector.error();
    impl_->use(**selector);
    return {};
}

void Engine::Impl::begin_offers() {
    if (offers_used) offered.clear();
    offers_used = false;
}

bool Engine::offer(const select::Item& item) {
    impl_->draws.plays();
    impl_->begin_offers();
    return impl_->offered.offer(item);
}

bool Engine::bought(select::ItemKind kind, std::uint32_t what) const {
    const Impl& e = *impl_;
    e.draws.plays();
    const std::span<const select::Item> list = e.offered.offered();
    for (std::size_t i = 0; i < list.size(); ++i)
        if (list[i].name() == select::ItemName{kind, what}) return !e.use_last && e.offers_used && e.cut.bought.has(i);
    return false;
}

const select::ItemList& Engine::offered() const {
    impl_->draws.plays();
    return impl_->offered;
}

/// The step of resolution was bought where the set's prices were made. Enlarging is what it costs, beyond those prices.
void Engine::Impl::prepay_resolution(const prepare::PreparedFrame& set) {
    if (!(set.resolution < 1.0F)) return;
    offered.prepay({select::ItemKind::resolution, static_cast<std::uint32_t>(model::resolution_step(set.resolution)),
                    costs.enlarge_us(set.resolution, options.device.viewport), set.resolution_value});
}

const select::Cut& Engine::select(const prepare::PreparedFrame& prepared, double budget_us, const Correction& correction,
                                  double target_error_rad) {
    Impl& e = *impl_;
    e.draws.plays();
    e.use_last = false;
    e.prepared = &prepared;
    e.drawn_resolution = prepared.resolution;
    e.correction = correction;
    e.begin_offers();
    e.prepay_resolution(prepared);
    const select::SelectInput input{&e.model,           &prepared,           &e.costs,
                                    budget_us,          correction.factor,   target_error_rad,
                                    e.options.slice_us, correction.headroom, &e.offered};
    e.headroom = select::headroom_of(input);
    e.selector->run(input, e.state, e.cut);
    e.offers_used = true;
    select::plan_slices(input, e.cut, e.options.slice_us, e.plan);
    return e.cut;
}

const select::SelectState& Engine::selection_memory() const {
    impl_->draws.plays();
    return impl_->state;
}

void Engine::select_last() {
    impl_->draws.plays();
    impl_->use_last = true;
}

/// Draws what of a slice the pose really sees; returns what that was predicted to cost.
model::ItemCost Engine::Impl::draw_slice(std::span<const select::CutItem> items, SubmitReport& report) {
    device->draws.plays();
    const std::size_t first = drawn.size();
    model::ItemCost cost;
    for (const select::CutItem& item : items) {
        if (!model::visible(frustum, model.nodes[item.node].box)) {
            ++report.culled;
            if (culled.size() < culled.capacity()) culled.push_back({item.node, item.rep});
            continue;
        }
        if (!push_within(drawn, {item.node, item.rep})) break;
        const prepare::Choice& choice = prepared->choices[item.choice];
        const prepare::Candidate& candidate = prepared->candidates[item.candidate];
        const bool finer = candidate.choice_count > 1 || candidate.child_count > 0;
        floor.add(drawn.back(), candidate.pixels, finer && item.choice == candidate.first_choice);
        cost += choice.cost;
        const bool full = model::is_full_detail(model.nodes[item.node], item.rep);
        const model::FrameCombine& combine = costs.combine;
        const double item_us =
            static_cast<double>(combine.frame_us(choice.cost.submit_us, choice.cost.raster_us) - combine.fixed_us);
        (full ? report.full_us : report.coarse_us) +=
            item_us / static_cast<double>(full ? prepared->full_factor : prepared->coarse_factor);
        report.worst_error_rad = std::max(report.worst_error_rad, choice.error_rad);
        report.benefit_mean += 1.0 - choice.benefit;
        report.triangles += model.reps[item.rep].triangles;
    }
    device->draw(std::span<const gl::DrawItem>(drawn).subspan(first));
    device->end_slice();
    device->wait_slices(1);
    return cost;
}

/// The in-frame check: whether the next part may be drawn in full.
bool Engine::Impl::in_time(const Progression& p, const SubmitLimits& limits, double start_us) {
    if (!options.in_frame_check) return true;
    const model::FrameCombine& combine = costs.combine;
    const auto bought_us = static_cast<float>(use_last ? 0.0 : cut.bought.cost_us);
    const float so_far_us = combine.frame_us(p.so_far.submit_us, p.so_far.raster_us);
    const auto with = [&](const model::ItemCost& more) {
        return static_cast<double>(combine.frame_us(p.so_far.submit_us + more.submit_us, p.so_far.raster_us + more.raster_us) -
                                   so_far_us);
    };
    const double scale = correction.factor * headroom;
    select::CheckInput check;
    check.elapsed_us = limits.elapsed_us + now_us(limits) - start_us + static_cast<double>(p.in_flight_us) * correction.factor;
    check.predicted_so_far_us = limits.elapsed_us + static_cast<double>(so_far_us + bought_us) * correction.factor;
    check.next_us = with(p.next) * scale;
    check.next_stand_in_us = with(p.stand_in) * scale;
    check.rest_stand_in_us = (with(p.rest) + static_cast<double>(enlarge_us())) * correction.factor;  // of many: little spread
    check.limit_us = limits.limit_us - limits.margin_us;
    if (!select::still_fits(check)) return false;
    forecast_us = select::forecast_us(check);
    return true;
}

void Engine::Impl::submit_cut(const SubmitLimits& limits, double start_us, SubmitReport& report) {
    device->draws.plays();
    const model::FrameCombine& combine = costs.combine;
    model::ItemCost rest_stand_in, so_far;
    for (const select::Slice& slice : plan.slices) {
        rest_stand_in += {slice.stand_in_cost.submit_us + costs.slice_us, slice.stand_in_cost.raster_us};
    }
    bool full = true;
    float in_flight_us = 0;
    if (cut.bought.cost_us > 0.0) device->charge_us(cut.bought.cost_us);
    const std::span<const select::CutItem> order(plan.order), stand_ins(plan.stand_ins);
    for (const select::Slice& slice : plan.slices) {
        rest_stand_in.submit_us -= slice.stand_in_cost.submit_us + costs.slice_us;
        rest_stand_in.raster_us -= slice.stand_in_cost.raster_us;
        full = full && in_time({so_far, slice.cost, slice.stand_in_cost, rest_stand_in, in_flight_us}, limits, start_us);
        const model::ItemCost cost = draw_slice(full ? order.subspan(slice.first_item, slice.item_count)
                                                     : stand_ins.subspan(slice.first_stand_in, slice.stand_in_count),
                                                report);
        so_far += {cost.submit_us + costs.slice_us, cost.raster_us};
        in_flight_us = cost.raster_us;
        ++report.slices;
        if (!full) ++report.downgraded_slices;
    }
    report.predicted = so_far;
    report.predicted_us =
        static_cast<double>(combine.frame_us(so_far.submit_us, so_far.raster_us) + enlarge_us()) + cut.bought.cost_us;
    report.other_us = report.predicted_us - report.full_us * static_cast<double>(prepared->full_factor) -
                      report.coarse_us * static_cast<double>(prepared->coarse_factor);
}

/// After select_last(), nothing is bought but the enlarging of the picture.
void Engine::Impl::report_items(SubmitReport& report) const {
    if (use_last) {
        report.bought_us = static_cast<double>(enlarge_us());
        report.bought_items = drawn_resolution < 1.0F ? 1U : 0U;
        return;
    }
    report.bought_us = cut.bought.cost_us + cut.bought.prepaid_us;
    report.bought_items = cut.bought.count;
    report.refused_items = cut.bought.refused;
}

void Engine::Impl::push(const UnpreparedItem& item, SubmitReport& report) {
    if (!push_within(drawn, item.item)) return;
    floor.add(item.item, item.pixels, item.floor);
    report.triangles += model.reps[item.item.rep].triangles;
    report.worst_error_rad = std::max(report.worst_error_rad, item.error_rad);
}

/// As submit_cut(), with groups of the plan in place of slices. Several groups make a slice, since ending one has its price.
void Engine::Impl::submit_last(const Pose& pose, const SubmitLimits& limits, double start_us, SubmitReport& report) {
    device->draws.plays();
    const model::FrameCombine& combine = costs.combine;
    unprepared.plan(state.shown, frustum, pose, drawn_scale(pose), preparer->item_costs());
    const std::span<const UnpreparedGroup> groups = unprepared.groups();
    model::ItemCost rest_stand_in, so_far, slice;
    for (const UnpreparedGroup& group : groups) rest_stand_in += group.stand_in.cost;
    bool full = true, slice_full = true;
    float in_flight_us = 0;
    std::size_t slice_begin = 0;
    for (const UnpreparedGroup& group : groups) {
        rest_stand_in.submit_us -= group.stand_in.cost.submit_us;
        rest_stand_in.raster_us -= group.stand_in.cost.raster_us;
        const model::ItemCost rest{rest_stand_in.submit_us + costs.slice_us, rest_stand_in.raster_us};
        const float unfinished_us = in_flight_us + slice.submit_us + slice.raster_us;
        full = full && in_time({so_far, group.cost, group.stand_in.cost, rest, unfinished_us}, limits, start_us);
        if (full) {
            for (const UnpreparedItem& item : unprepared.items().subspan(group.first, group.count)) push(item, report);
        } else {
            push(group.stand_in, report);
            slice_full = false;
        }
        const model::ItemCost& cost = full ? group.cost : group.stand_in.cost;
        so_far += cost;
        slice += cost;
        const bool last = &group == &groups.back();
        if (!last && slice.submit_us + slice.raster_us < options.slice_us) continue;
        device->draw(std::span<const gl::DrawItem>(drawn).subspan(slice_begin));
        device->end_slice();
        device->wait_slices(1);
        slice_begin = drawn.size();
        so_far.submit_us += costs.slice_us;
        in_flight_us = slice.raster_us;
        slice = {};
        ++report.slices;
        if (!slice_full) ++report.downgraded_slices;
        slice_full = true;
    }
    report.predicted = so_far;
    report.predicted_us = combine.frame_us(so_far.submit_us, so_far.raster_us) + enlarge_us();
}

/// False: the pose is not at rest, and a cut is to be drawn.
bool Engine::Impl::submit_rest(const Pose& pose, const SubmitLimits& limits, SubmitReport& report) {
    device->draws.plays();
    const bool still = limits.frame_ns >= 0 && watch.at_rest(pose, limits.frame_ns) && !device->lost();
    if (still) {
        report = last_report;
        const RestScene scene{model, preparer->item_costs(), costs, *device, options.device.viewport, options.slice_us};
        if (rest_picture.frame(scene, pose, limits, correction.factor, report)) return true;
        report = {};
    } else {
        rest_picture.leave();
    }
    return false;
}

SubmitReport Engine::submit(const Pose& pose, const SubmitLimits& limits) {
    Impl& e = *impl_;
    e.draws.plays();
    e.device->draws.plays();
    CHECK(e.use_last || e.prepared != nullptr, "A submitted frame was selected before");
    SubmitReport report;
    if (e.submit_rest(pose, limits, report)) return report;
    const double start_us = e.now_us(limits);
    e.drawn.clear();
    e.culled.clear();
    e.floor.begin();
    e.forecast_us = 0;
    e.frustum = model::make_frustum(pose, e.options.device.viewport, model::far_corners_m(e.model.nodes[0].box));
    e.device->begin_frame(pose, e.drawn_resolution);
    if (e.use_last) {
        e.submit_last(pose, limits, start_us, report);
    } else {
        e.submit_cut(limits, start_us, report);
    }
    e.device->end_items();
    report.submitted_us = e.now_us(limits) - start_us;
    e.device->finish_frame();
    report.finished_us = e.now_us(limits) - start_us;
    report.forecast_us = e.forecast_us > 0 ? e.forecast_us - limits.elapsed_us : 0;
    const gl::FrameStats stats = e.device->stats();
    report.items = stats.items;
    report.draws = stats.draws;
    report.resolution = stats.resolution;
    if (!e.drawn.empty()) report.benefit_mean /= static_cast<double>(e.drawn.size());
    report.floor_share = e.floor.floor_share();
    e.report_items(report);
    e.last_report = report;
    return report;
}

bool Engine::fell_to_floor(const Pose& pose, double time_us, double correction) {
    Impl& e = *impl_;
    e.draws.plays();
    if (!(e.floor.floor_share() > floor_picture_share)) return false;
    const std::vector<select::Shown>& last = e.use_last ? e.state.touched : e.state.before;
    if (!(e.floor.fallen_share(last) > floor_picture_share)) return false;
    const model::ViewScale scale = e.drawn_scale(pose);
    model::ItemCost sum;
    for (const select::Shown& shown : last) {
        if (shown.form == select::SelectState::opened) continue;
        const Box& box = e.model.nodes[shown.node].box;
        if (!model::visible(e.frustum, box)) continue;
        sum += e.preparer->item_costs().of(shown.form, box, pose.position, scale);
        if ((e.costs.combine.frame_us(sum.submit_us, sum.raster_us) + e.enlarge_us()) * correction > time_us) return false;
    }
    return true;
}

void Engine::draw_unbudgeted(const Pose& pose, std::span<const gl::DrawItem> items, float resolution) {
    gl::Device& device = *impl_->device;
    device.draws.plays();
    impl_->draws.plays();
    impl_->watch.forget();  // another picture is shown
    impl_->rest_picture.leave();
    device.begin_frame(pose, resolution);
    constexpr std::size_t chunk = 4096;  // below the device's max_items, and bounded work a slice
    for (std::size_t at = 0; at < items.size(); at += chunk) {
        device.draw(items.subspan(at, std::min(chunk, items.size() - at)));
        device.end_slice();
        device.wait_slices(1);
    }
    device.end_items();
    device.finish_frame();
}

std::vector<gl::DrawItem> Engine::full_detail(const Pose& pose) const {
    const model::Model& model = impl_->model;
    const model::Frustum frustum =
        model::make_frustum(pose, impl_->options.device.viewport, model::far_corners_m(model.nodes[0].box));
    std::vector<gl::DrawItem> items;
    std::vector<model::Index> stack{0};
    while (!stack.empty()) {
        const model::Index n = stack.back();
        stack.pop_back();
        const model::Node& node = model.nodes[n];
        if (!model::visible(frustum, node.box)) continue;
        if (node.child_count == 0) items.push_back({n, node.first_rep + node.rep_count - 1});
        for (std::uint32_t c = node.child_count; c > 0; --c) stack.push_back(node.first_child + c - 1);
    }
    return items;
}

bool covers(const prepare::Region& region, const Pose& pose, model::Viewport viewport) {
    const double moved = glm::length(pose.position - region.centre.position);
    const double w = std::min(1.0, std::abs(glm::dot(pose.orientation, region.centre.orientation)));
    const double turned = 2.0 * std::acos(w);
    // The acos of a rounded 1 is up to 2e-8: far below any region's angle, but not below 0.
    const model::SideAngles now = model::side_angles(pose, viewport), then = model::side_angles(region.centre, viewport);
    const double grown = std::max({0.0, now.right - then.right, then.left - now.left, now.up - then.up, then.down - now.down});
    return moved <= region.radius_m + 1e-9 && turned + grown <= region.angle_rad + 1e-6;
}

prepare::Region predict_region(const Pose& before, const Pose& now, double dt_s, double horizon_s, double turn_ahead_rps) {
    const double dt = std::max(dt_s, 1e-4);
    const dvec3 velocity = (now.position - before.position) / dt;
    const double w = std::min(1.0, std::abs(glm::dot(before.orientation, now.orientation)));
    const double turn_rps = 2.0 * std::acos(w) / dt;
    prepare::Region region;
    region.centre = now;
    region.centre.position = now.position + velocity * (0.5 * horizon_s);
    // Half the way on is the centre; the radius reaches both ends, and half as far again for a change of speed.
    const double travel = glm::length(velocity) * horizon_s;
    region.radius_m = 0.75 * travel + 0.25;
    region.angle_rad = std::min(1.0, 1.5 * std::max(turn_rps, turn_ahead_rps) * horizon_s + 0.06);
    return region;
}

}  // namespace surefoot
