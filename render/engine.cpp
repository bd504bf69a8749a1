// The renderer's door, implemented: opens, prepares, selects, and draws whole pictures. engine_submit.cpp draws frames.
#include "render/engine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "render/drawn_items.hpp"
#include "render/effects/effects.hpp"
#include "render/engine_impl.hpp"
#include "render/select/budget.hpp"
#include "render/select/steps.hpp"
#include "rt/base/check.hpp"

namespace surefoot {

namespace {

/// An effect that is newer than the table is not free: it has the usual price until somebody calibrates again.
void add_missing_prices(model::EffectMask called_for, std::vector<model::EffectPrice>& prices) {
    for (const model::EffectPrice& usual : effects::usual_prices()) {
        const bool has =
            std::any_of(prices.begin(), prices.end(), [&](const auto& price) { return price.effect == usual.effect; });
        if (!has && (called_for & usual.effect) != 0) prices.push_back(usual);
    }
}

}  // namespace

Engine::Engine(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Engine::~Engine() = default;

Result<std::unique_ptr<Engine>> Engine::open(model::Model model, const model::CostModel& costs, const EngineOptions& options) {
    auto impl = std::make_unique<Impl>();
    impl->draws.plays();  // nobody else has it yet
    impl->model = std::move(model);
    impl->costs = costs;
    // A table that was measured before effects had prices keeps none: those of another machine would mislead.
    if (impl->costs.prices.empty() && !impl->costs.calibrated) impl->costs.prices = effects::usual_prices();
    if (impl->costs.prices_measured) add_missing_prices(impl->model.called_for(), impl->costs.prices);
    impl->options = options;
    auto selector = select::selector_named(options.selector);
    if (!selector) return selector.error();
    if (auto able = select::can_guarantee(**selector, options.max_error_rad); !able) return able.error();
    impl->options.device.null.costs = &impl->costs;
    impl->options.device.null.enlarge_us = static_cast<double>(costs.enlarge_us(0.5F, options.device.viewport));
    impl->options.device.rest = options.rest_after_ms > 0;
    if (options.device.background && (impl->model.called_for() & model::background_effects) != 0)
        impl->costs = model::with_background(std::move(impl->costs));
    impl->options.device.null.rest_pass_us = static_cast<double>(impl->costs.rest_pass_us(options.device.viewport));
    impl->options.device.null.behind_us = static_cast<double>(impl->costs.behind_us(options.device.viewport));
    impl->options.resolution = model::stepped(options.resolution);
    if (impl->options.resolution > 0.0F) impl->drawn_resolution = impl->options.resolution;
    impl->options.device.smaller = impl->options.resolution < 1.0F;
    auto device = gl::open_device(impl->with_light_groups());
    if (!device) return device.error();
    impl->device = std::move(*device);
    impl->device->draws.plays();
    impl->costs = model::at_quality(std::move(impl->costs), gl::quality_of(*impl->device, costs));
    auto loaded = impl->device->load(impl->model, effects::assemble_program);
    if (!loaded) return loaded.error();
    if (options.buys_effects) impl->reserve_effects();
    decltype(impl->model.texels)().swap(impl->model.texels);  // the device has its own
    const auto candidates =
        static_cast<std::uint32_t>(std::min<std::size_t>(options.prepare.max_candidates, impl->model.nodes.size()));
    impl->options.prepare.max_candidates = candidates;
    impl->options.prepare.sky = options.device.sky;
    impl->options.prepare.max_choices =
        static_cast<std::uint32_t>(std::min<std::size_t>(options.prepare.max_choices, impl->model.reps.size()));
    impl->best_filter = impl->device->filter();
    if (impl->device->switches_filter()) {
        impl->best_filter = rt::TextureFilter::trilinear;
        impl->filter_costs = FilterCosts(impl->model, impl->costs);
    }
    impl->full_depth_always = options.prepare.full_depth;
    impl->use(**selector);
    impl->state.reserve(impl->model, candidates);
    impl->state.hysteresis = options.hysteresis;
    impl->state.reserve_share = options.reserve_share;
    select::reserve(impl->cut, candidates);
    impl->plan.reserve(candidates);
    impl->unprepared.reserve(impl->model);
    impl->moving = model::MovingNodes(impl->model);
    impl->restless = restless_nodes(impl->model, impl->moving);
    impl->poses = model::MotionPoses(impl->model);
    if (impl->device->receives_shadows()) impl->shadow = MovingShadow(impl->model);
    impl->make_pictures();
    impl->light = model::daylight_of_model(impl->model.sun_direction, impl->model.light);
    impl->leave_out_unlit();
    const std::size_t in_pictures = impl->pictures.any() ? impl->model.nodes.size() : 0;
    const std::size_t max_drawn = std::max<std::size_t>(candidates * 2 + in_pictures, impl->unprepared.capacity());
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
    by_budget = entry.goes_by == select::GoesBy::budget;
    keeps_target = entry.keeps_target;
    by_value = by_budget && entry.by_value && !(options.max_error_rad > 0);
    draws.plays();  // nothing is drawn or prepared meanwhile
    price_without();
    const bool full_depth = full_depth_always || entry.goes_by == select::GoesBy::nothing;
    if (preparer && full_depth == options.prepare.full_depth) return;
    options.prepare.full_depth = full_depth;
    preparer.reset();  // its workers first
    preparer = std::make_unique<prepare::Preparer>(model, costs, options.prepare);
    if (pictures.any()) preparer->set_cover(&pictures.boxes());
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
void Engine::end_workers() { impl_->preparer->end_workers(); }

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
    out.from_s = impl_->options.motion ? hints.time_s : 0;
    out.to_s = impl_->options.motion ? hints.time_s + hints.span_s : 0;
    out.without = e.without.load(std::memory_order_relaxed);
    out.covered = hints.covered;
    if (e.worth.any())
        e.preparer->set_effect_losses(
            e.worth.at(e.light_hour.load(std::memory_order_relaxed), e.unseen.load(std::memory_order_relaxed)));
    e.preparer->run(region, viewport, frame, speed_mps, turn_rps, out);
    out.full_filter_us = e.filter_costs.any() ? e.filter_costs.full_us(out) : 0.0F;
    if (!chosen || !(hints.planned_us[0] > 0.0) || e.options.prepare.full_depth) return;
    // As Budget counts it: the fixed time, and the ends of slices.
    const double slice_end_us = static_cast<double>(e.costs.combine.submit_weight * e.costs.slice_us);
    // What is below the acuity anyway does not look softer.
    const auto sharper = static_cast<float>(prepare::resolved_rad(out) / model::pixel_angle(out.region.centre, viewport));
    const double with_effects = static_cast<double>(e.with_effects.load(std::memory_order_relaxed));
    // Pictures take their time first, lose hardly anything, and look softer too.
    const double pictures_us = static_cast<double>(e.set_pictures_us.load(std::memory_order_relaxed));
    const float all_value = out.curve.full_value + e.set_pictures_value.load(std::memory_order_relaxed);
    const double of_forms = all_value > 0.0F ? static_cast<double>(out.curve.full_value / all_value) : 1.0;
    const auto lost = [&](const prepare::ValueCurve& curve, float at) {
        const double fixed_us =
            static_cast<double>(e.costs.combine_at(at, viewport).fixed_us + e.costs.enlarge_us(at, viewport)) + slice_end_us +
            pictures_us * static_cast<double>(at * at);
        const double planned_us = hints.planned_us[model::resolution_step(at)];
        const double items_us = (planned_us - fixed_us) / (1.0 + slice_end_us / std::max(1.0, e.options.slice_us)) / with_effects;
        return of_forms * prepare::lost_share(curve, items_us) +
               static_cast<double>(e.costs.blur_loss_at(std::min(1.0F, at * sharper)));
    };
    const float other = e.resolution.trial(hints.planned_us);
    if (other > 0.0F) {
        e.resolution.judge(lost(out.curve, out.resolution), lost(e.preparer->value_at(other), other));
        e.preparer->add_value_time(out);
    }
    out.resolution_value = e.resolution.gain() * all_value;
}

Result<void> Engine::set_selector(std::string_view name) {
    auto selector = select::selector_named(name);
    if (!selector) return selector.error();
    if (auto able = select::can_guarantee(**selector, impl_->options.max_error_rad); !able) return able;
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

select::SelectInput Engine::Impl::input_of(const prepare::PreparedFrame& set, double budget_us, const Correction& by,
                                           double target_error_rad) const {
    return {&model,           &set,
            &costs,           budget_us,
            by.factor,        target_error_rad,
            options.slice_us, by.headroom,
            &offered,         options.max_error_rad,
            options.benefit,  last_frame_us,
            pictures_us};
}

double Engine::Impl::gain_of_one_more_ms(const select::SelectInput& input) const {
    const prepare::PreparedFrame& set = *input.prepared;
    if (!by_value || !(set.full_value > 0.0)) return 0;
    const double bought_us = cut.bought.cost_us + cut.bought.prepaid_us;
    const auto value_with = [&](double more_us) {
        select::SelectInput longer = input;
        longer.budget_us += more_us;
        select::Budget budget(longer);
        budget.spend(bought_us);
        return static_cast<double>(set.curve.value_at(static_cast<float>(budget.room_us())));
    };
    return std::max(0.0, value_with(1000) - value_with(0)) / set.full_value;
}

/// The price is that of full detail, since a frame that shows less has no time for it.
bool Engine::offer_filter(const prepare::PreparedFrame& prepared, double budget_us, const Correction& correction) {
    constexpr float value_share = 1e-4F;  // of the picture: less than any form that is missing
    Impl& e = *impl_;
    e.draws.plays();
    e.begin_offers();
    e.filter_us = 0;
    const model::FrameCombine combine = e.costs.combine_at(prepared.resolution, prepared.viewport);
    const model::ItemCost& full = prepared.full_cost;
    const float more_us = combine.frame_us(full.submit_us, full.raster_us + prepared.full_filter_us) -
                          combine.frame_us(full.submit_us, full.raster_us);
    if (!e.by_budget || !(more_us > 0.0F)) {
        e.dwell.answer(false);
        return false;
    }
    select::Budget budget(e.input_of(prepared, budget_us, correction, 0));
    budget.spend(static_cast<double>(more_us));
    select::Sum sum;
    sum.add(full);
    // Within what new steps may use. So full detail fits beside it, whatever has just come into view.
    if (!e.dwell.offer(budget.predicted_us(sum) / (budget_us * select::fresh_share(e.state)))) return false;
    const auto value = static_cast<float>(static_cast<double>(value_share) * prepared.full_value);
    const bool offered = e.offered.offer({select::ItemKind::filter, 1, more_us, value});
    if (offered) e.filter_us = more_us;
    if (!offered) e.dwell.answer(false);
    return offered;
}

/// After a selection: whether it bought the second mip level. What is drawn with it takes longer, slice by slice.
void Engine::Impl::take_filter() {
    filtered = false;
    if (!(filter_us > 0.0F)) return;
    for (std::size_t i = 0; i < offered.offered().size(); ++i)
        if (offered.offered()[i].kind == select::ItemKind::filter) filtered = cut.bought.has(i);
    dwell.answer(filtered);
    if (!filtered) filter_us = 0;
}

bool Engine::bought(select::ItemKind kind, std::uint32_t what) const {
    const Impl& e = *impl_;
    e.draws.plays();
    return !e.use_last && e.offers_used && e.was_bought({kind, what});
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
    e.promised_rad = e.options.max_error_rad > 0.0              ? e.options.max_error_rad
                     : e.keeps_target && target_error_rad > 0.0 ? target_error_rad
                                                                : 0.0;
    e.begin_offers();
    e.prepay_resolution(prepared);
    e.prepay_pictures(prepared);
    const select::SelectInput input = e.input_of(prepared, budget_us, correction, target_error_rad);
    e.offer_effects(prepared, select::Budget(input).room_us());
    e.offer_shadow(prepared);
    e.offer_pictures(prepared, input);
    e.headroom = select::headroom_of(input);
    e.selector->run(input, e.state, e.cut);
    e.one_more_ms = e.gain_of_one_more_ms(input);
    e.last_frame_us = 0;
    e.offers_used = true;
    select::plan_slices(input, e.cut, e.options.slice_us, e.plan);
    e.take_filter();
    e.take_effects(prepared);
    e.take_shadow();
    e.take_pictures();
    e.price_light_change(prepared);
    if (e.filtered || (e.lever.shown | e.priced_late | e.priced_early) != 0) e.price_slices();
    return e.cut;
}

const select::SelectState& Engine::selection_memory() const {
    impl_->draws.plays();
    return impl_->state;
}

void Engine::hide_effects(model::EffectMask hidden) {
    Impl& e = *impl_;
    e.draws.plays();
    if (hidden == e.hidden) return;
    e.device->draws.plays();
    e.hidden = hidden;
    e.leave_out_unlit();
    e.watch.forget();
    e.rest_picture.leave();
}

void Engine::set_light(const model::Daylight& light, float hour) {
    Impl& e = *impl_;
    e.light_hour.store(hour, std::memory_order_relaxed);
    e.draws.plays();
    e.device->draws.plays();
    e.device->set_light(light);
    if (!(light == e.light)) e.pictures.forget();
    e.light = light;
    e.leave_out_unlit();
    e.watch.forget();
    e.rest_picture.leave();
}

void Engine::set_time(double time_s) {
    Impl& e = *impl_;
    e.draws.plays();
    if (e.restless.empty()) return;
    e.device->draws.plays();
    const double shown_s = e.options.motion && std::isfinite(time_s) ? time_s : 0;
    e.poses.set_time(shown_s);
    e.moving.set_span(shown_s, shown_s);
    e.time_s = shown_s;
    e.device->set_time(shown_s);
}

void Engine::select_last() {
    impl_->draws.plays();
    impl_->use_last = true;
    for (EffectSale& sale : impl_->lever.sales) sale.fell = false;
    impl_->dwell.answer(false);
}

/// Begins a picture, and draws all of its items.
void Engine::Impl::draw_items(const Pose& pose, std::span<const gl::DrawItem> items, float at_resolution) {
    device->draws.plays();
    device->begin_frame(pose, at_resolution);
    constexpr std::size_t chunk = 4096;  // below the device's max_items, and bounded work a slice
    for (std::size_t at = 0; at < items.size(); at += chunk) {
        device->draw(items.subspan(at, std::min(chunk, items.size() - at)));
        device->end_slice();
        device->wait_slices(1);
    }
}

void Engine::draw_unbudgeted(const Pose& pose, std::span<const gl::DrawItem> items, float resolution, rt::TextureFilter filter) {
    draw_unbudgeted(pose, items, {}, resolution, filter);
}

void Engine::draw_unbudgeted(const Pose& pose, std::span<const gl::DrawItem> items, std::span<const ShownPicture> pictures,
                             float resolution, rt::TextureFilter filter) {
    gl::Device& device = *impl_->device;
    device.draws.plays();
    impl_->draws.plays();
    impl_->watch.forget();  // another picture is shown
    impl_->rest_picture.leave();
    device.show_shadow(std::exchange(impl_->shadow_unbudgeted, false));
    device.set_filter(filter == rt::TextureFilter::automatic ? impl_->best_filter : filter);
    device.hide_effects(impl_->always_without());
    impl_->make_pictures_anew(pose, pictures);
    impl_->draw_items(pose, items, resolution);
    if (!impl_->anew.empty()) {
        device.draw_pictures(impl_->anew);
        device.end_slice();
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
    const double grown = model::widened_rad(pose, region.centre, viewport);
    return moved <= region.radius_m + 1e-9 && turned + grown <= region.angle_rad + 1e-6;
}

prepare::Region predict_region(const Pose& before, const Pose& now, double dt_s, double horizon_s) {
    const double dt = std::max(dt_s, 1e-4);
    const dvec3 velocity = (now.position - before.position) / dt;
    dquat turn = now.orientation * glm::conjugate(before.orientation);
    if (turn.w < 0.0) turn = -turn;
    const double turned = 2.0 * std::acos(std::min(1.0, turn.w));
    prepare::Region region;
    // Half the way on is the centre; the region reaches both ends, and half as far again for a change of speed.
    const double travel = glm::length(velocity) * horizon_s, angle = turned / dt * horizon_s;
    region.centre = now;
    region.centre.position = now.position + velocity * (0.5 * horizon_s);
    const dvec3 axis(turn.x, turn.y, turn.z);
    if (const double length = glm::length(axis); length > 1e-9 && angle < 2.0)
        region.centre.orientation = glm::normalize(glm::angleAxis(0.5 * angle, axis / length) * now.orientation);
    region.radius_m = 0.75 * travel + 0.25;
    region.angle_rad = std::min(1.0, 0.75 * angle + 0.06);
    // The widest of the next views, and a quarter more for a change of speed: what is prepared serves all narrower ones.
    const double widening = (now.fov_y_rad - before.fov_y_rad) / dt * horizon_s;
    if (widening > 0.0) region.centre.fov_y_rad = std::min(now.fov_y_rad + 1.25 * widening, std::max(now.fov_y_rad, 3.1));
    return region;
}

}  // namespace surefoot
