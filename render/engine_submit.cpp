// The engine's submission: a cut is drawn slice by slice, with the in-frame check before each.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "render/drawn_items.hpp"
#include "render/engine_impl.hpp"
#include "rt/base/check.hpp"

namespace surefoot {

namespace {

constexpr float floor_picture_share = 0.5F;

}  // namespace

void Engine::Impl::count_error(model::Index node, float error_rad, float importance, SubmitReport& report) {
    report.worst_error_rad = std::max(report.worst_error_rad, error_rad);
    const float weighted_rad = error_rad * importance;
    if (!(weighted_rad > report.worst_weighted_rad)) return;
    report.worst_weighted_rad = weighted_rad;
    if (weighted_rad > model::exact_up_to_rad) report.worst_node = node;
}

/// It may be kept although the cut breaks it: items outside the pose's view are not drawn.
rt::Guarantee Engine::Impl::guarantee_of(const SubmitReport& report) const {
    if (!(promised_rad > 0.0)) return rt::Guarantee::none;
    if (static_cast<double>(report.worst_weighted_rad) <= promised_rad) return rt::Guarantee::kept;
    if (use_last) return rt::Guarantee::unprepared;
    return cut.guarantee > rt::Guarantee::kept ? cut.guarantee : rt::Guarantee::stand_ins;
}

bool Engine::Impl::in_view(model::Index node) {
    return model::visible(frustum, moving.any() ? moving.box(node, poses) : model.nodes[node].box);
}

/// Whether anything moves, now or later, that the pose may see; and whether a shadow comes into its view now.
bool Engine::Impl::motion_in_view(const Pose& pose) const {
    if (restless.empty() || !options.motion) return false;
    const bool shadow_comes = shadow_due && (drawn_without() & model::effect_moving_shadow) == 0;
    if (shadow_shown || shadow_comes) return true;  // it may be in view without what casts it
    // A moved sample sees a pixel more.
    const double pixel_rad = model::pixel_angle(pose, options.device.viewport);
    const model::Frustum wide =
        model::make_frustum(pose, options.device.viewport, model::far_corners_m(model.nodes[0].box), 0, 2 * pixel_rad);
    return std::any_of(restless.begin(), restless.end(),
                       [&](model::Index node) { return model::visible(wide, model.nodes[node].box); });
}

/// Draws what of a slice the pose really sees; returns what that was predicted to cost.
model::ItemCost Engine::Impl::draw_slice(std::span<const select::CutItem> items, SubmitReport& report) {
    device->draws.plays();
    const std::size_t first = drawn.size();
    model::ItemCost cost;
    for (const select::CutItem& item : items) {
        const prepare::Choice& choice = prepared->choices[item.choice];
        report.value += static_cast<double>(choice.value);
        if (!in_view(item.node)) {
            ++report.culled;
            if (culled.size() < culled.capacity()) culled.push_back({item.node, item.rep});
            continue;
        }
        if (!push_within(drawn, {item.node, item.rep})) break;
        const prepare::Candidate& candidate = prepared->candidates[item.candidate];
        const bool finer = candidate.choice_count > 1 || candidate.child_count > 0;
        const bool full = model::is_full_detail(model.nodes[item.node], item.rep, model.reps[item.rep].error_m);
        floor.add(drawn.back(), candidate.pixels, finer && !full && item.choice == candidate.first_choice);
        const model::ItemCost drawn_as = drawn_cost(choice);
        cost += drawn_as;
        const model::FrameCombine& combine = costs.combine;
        const double item_us = static_cast<double>(combine.frame_us(drawn_as.submit_us, drawn_as.raster_us) - combine.fixed_us);
        (full ? report.full_us : report.coarse_us) +=
            item_us / static_cast<double>(full ? prepared->full_factor : prepared->coarse_factor);
        count_error(item.node, choice.error_rad, candidate.importance, report);
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
    const model::FrameCombine combine = this->combine();
    const auto bought_us = static_cast<float>(beside_us());
    const float so_far_us = combine.frame_us(p.so_far.submit_us, p.so_far.raster_us);
    const auto with = [&](const model::ItemCost& more) {
        return static_cast<double>(combine.frame_us(p.so_far.submit_us + more.submit_us, p.so_far.raster_us + more.raster_us) -
                                   so_far_us);
    };
    const double scale = correction.factor * headroom;
    const float handed_us = combine.frame_us(p.so_far.submit_us - p.pending.submit_us, p.so_far.raster_us - p.pending.raster_us);
    const float pending_us = so_far_us - handed_us;
    select::CheckInput check;
    check.predicted_so_far_us = limits.elapsed_us + static_cast<double>(so_far_us + bought_us) * correction.factor;
    check.elapsed_us = limits.elapsed_us + now_us(limits) - start_us + static_cast<double>(pending_us) * correction.factor;
    if (limits.now_ns != nullptr) {
        // As it counts in the frame: several rasterisers share it.
        const float left_us = combine.left_us(p.so_far.submit_us, p.so_far.raster_us, p.in_flight_us);
        check.in_flight_us = static_cast<double>(left_us + p.before_us) * correction.factor;
        check.elapsed_us += check.in_flight_us;
    } else if (!device->charges())  // what a charging device has in flight is charged; for another one predictions count
        check.elapsed_us = check.predicted_so_far_us;
    check.next_us = with(p.next) * scale;
    check.next_stand_in_us = with(p.stand_in) * scale;
    check.rest_stand_in_us =
        (with(p.rest) + static_cast<double>(enlarge_us()) + after_us) * correction.factor;  // of many: little spread
    check.last_us = shown_us * correction.factor;
    check.limit_us = limits.limit_us - limits.margin_us;
    check.deadline_us = limits.deadline_us - limits.margin_us;
    if (limits.now_ns != nullptr && !use_last) {  // times of another clock repeat the predictions
        const double predicted_us = check.predicted_so_far_us - check.in_flight_us;
        profile().note(check.elapsed_us - check.in_flight_us, predicted_us, limits.scale_us());
        const select::FrameProfile::Usual usual = profile().at(predicted_us, limits.scale_us());
        check.usual_head = usual.head;
        check.usual_tail = usual.tail;
    }
    if (!select::still_fits(check)) return false;
    forecast_us = select::forecast_us(check);
    return true;
}

/// Of what the driver has before the first slice: a slice with the shadow map, and what is behind everything.
float Engine::Impl::before_us(bool shadow_refreshed) const {
    const model::Viewport picture = model::viewport_of_step(options.device.viewport, model::resolution_step(drawn_resolution));
    return (shadow_refreshed ? shadow_map_us() : 0.0F) + costs.behind_us(picture);
}

void Engine::Impl::submit_cut(const SubmitLimits& limits, double start_us, SubmitReport& report) {
    device->draws.plays();
    const model::FrameCombine combine = this->combine();
    model::ItemCost rest_stand_in, so_far;
    for (const select::Slice& slice : plan.slices) {
        rest_stand_in += {slice.stand_in_cost.submit_us + costs.slice_us, slice.stand_in_cost.raster_us};
    }
    bool full = true;
    // New pictures change the target, where some drivers wait until they are drawn. So what beginning took is of them.
    float in_flight_us = 0, unfinished_us = before_us(report.shadow_refreshed) +
                                            static_cast<float>(std::max(0.0, report.captures_us - begun_us / correction.factor));
    if (beside_us() > 0.0) device->charge_us(beside_us());
    const std::span<const select::CutItem> order(plan.order), stand_ins(plan.stand_ins);
    for (const select::Slice& slice : plan.slices) {
        rest_stand_in.submit_us -= slice.stand_in_cost.submit_us + costs.slice_us;
        rest_stand_in.raster_us -= slice.stand_in_cost.raster_us;
        const model::ItemCost next{slice.cost.submit_us + costs.slice_us, slice.cost.raster_us};
        const model::ItemCost stand_in{slice.stand_in_cost.submit_us + costs.slice_us, slice.stand_in_cost.raster_us};
        full = full && in_time({so_far, next, stand_in, rest_stand_in, in_flight_us, {}, unfinished_us}, limits, start_us);
        const model::ItemCost cost = draw_slice(full ? order.subspan(slice.first_item, slice.item_count)
                                                     : stand_ins.subspan(slice.first_stand_in, slice.stand_in_count),
                                                report);
        so_far += {cost.submit_us + costs.slice_us, cost.raster_us};
        in_flight_us = cost.raster_us;
        unfinished_us = 0;
        ++report.slices;
        if (!full) ++report.downgraded_slices;
    }
    draw_uncovered(limits, start_us, so_far, report);
    draw_pictures(limits, report);
    report.one_more_ms = one_more_ms;
    report.dropped_objects = cut.dropped.count;
    report.worst_error_rad = std::max(report.worst_error_rad, cut.dropped.error_rad);
    if (cut.dropped.weighted_rad > report.worst_weighted_rad) {
        report.worst_weighted_rad = cut.dropped.weighted_rad;
        report.worst_node = cut.dropped.node;
    }
    report.predicted = so_far;
    const double full_value = prepared->full_value + pictures_value;  // what pictures show is shown in full
    report.value = full_value > 0 ? (report.value + pictures_value) / full_value : 1.0;
    report.predicted_us = static_cast<double>(combine.frame_us(so_far.submit_us, so_far.raster_us) + enlarge_us()) + beside_us() +
                          report.pictures_us;
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
    count_error(item.item.node, item.error_rad, model.nodes[item.item.node].importance, report);
}

/// As submit_cut(), with groups of the plan in place of slices. Several groups make a slice, since ending one has its price.
void Engine::Impl::submit_last(const Pose& pose, const SubmitLimits& limits, double start_us, SubmitReport& report) {
    device->draws.plays();
    const model::FrameCombine combine = this->combine();
    unprepared.plan(state.shown, frustum, pose, drawn_scale(pose), preparer->item_costs(), drawn_without());
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
        full = full && in_time({so_far, group.cost, group.stand_in.cost, rest, in_flight_us, slice}, limits, start_us);
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
    const bool still = limits.frame_ns >= 0 && watch.at_rest(pose, limits.frame_ns) && !device->lost() && !motion_in_view(pose);
    if (still) {
        report = last_report;
        report.pictures_made = report.uncovered_items = 0;
        report.pictures_reused = report.pictures;
        report.pictures_us = report.captures_us = 0;
        const RestScene scene{
            model,       preparer->item_costs(), costs, *device, options.device.viewport, options.slice_us, filter_costs,
            best_filter, always_without()};
        if (lever.count > 0) device->hide_effects(always_without());  // full detail has the time for all others
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
    e.frame_ns = limits.frame_ns;
    if (std::exchange(e.jumped, false)) e.jumped_ns = e.frame_ns;
    e.rests = e.submit_rest(pose, limits, report);
    if (e.rests) return report;
    const double start_us = e.now_us(limits);
    e.drawn.clear();
    e.culled.clear();
    e.floor.begin();
    e.forecast_us = 0;
    e.profile().begin();
    e.frustum = model::make_frustum(pose, e.options.device.viewport, model::far_corners_m(e.model.nodes[0].box));
    e.begin_pictures(pose, limits, report);
    e.count_boxes(report);
    e.device->set_filter(e.filtered && !e.use_last ? e.best_filter : e.device->filter());
    if (e.lever.count > 0) e.device->hide_effects(e.drawn_without());
    e.begin_shadow(pose, report);
    const double begins_us = e.now_us(limits);
    e.device->begin_frame(pose, e.drawn_resolution);
    e.begun_us = limits.now_ns != nullptr ? e.now_us(limits) - begins_us : 0.0;
    if (e.use_last) {
        e.submit_last(pose, limits, start_us, report);
        if (report.uncovered_items > 0) report.downgraded_slices = report.slices;  // the cut was given up for what is uncovered
    } else {
        e.submit_cut(limits, start_us, report);
    }
    e.device->end_items();
    report.submitted_us = e.now_us(limits) - start_us;
    e.device->finish_frame();
    report.finished_us = e.now_us(limits) - start_us;
    if (limits.now_ns != nullptr && !e.use_last) {  // without the pictures: they are timed by themselves
        const double from_us = limits.elapsed_us - e.shown_us * e.correction.factor;
        e.profile().finish(from_us + report.finished_us, from_us + report.predicted_us * e.correction.factor, limits.scale_us());
    }
    const bool timed = report.finished_us > 0;  // else no clock runs within the frame, and no forecast was made of it
    report.forecast_us = timed && e.forecast_us > 0 ? e.forecast_us - limits.elapsed_us : 0;
    const gl::FrameStats stats = e.device->stats();
    report.items = stats.items;
    report.draws = stats.draws;
    report.resolution = stats.resolution;
    report.samples = stats.samples;
    report.filter = stats.filter;
    report.floor_share = e.floor.floor_share();
    report.guarantee = e.guarantee_of(report);
    report.promised_rad = e.promised_rad;
    e.report_items(report);
    e.last_report = report;
    e.last_frame_us = timed ? report.finished_us : report.predicted_us * e.correction.factor;
    return report;
}

bool Engine::fell_to_floor(const Pose& pose, double time_us, double correction) {
    Impl& e = *impl_;
    e.draws.plays();
    if (!(e.floor.floor_share() > floor_picture_share)) return false;
    const std::vector<select::Shown>& last = e.use_last ? e.state.touched : e.state.before;
    if (!(e.floor.fallen_share(last) > floor_picture_share)) return false;
    const model::ViewScale scale = e.drawn_scale(pose);
    const model::FrameCombine combine = e.combine();
    model::ItemCost sum;
    for (const UncoveredItem& item : e.uncovered) sum += item.full_cost;  // the last cut left them to pictures
    const model::EffectMask hidden = e.drawn_without();
    for (const select::Shown& shown : last) {
        if (shown.form == select::SelectState::opened) continue;
        const Box& box = e.model.nodes[shown.node].box;
        if (!model::visible(e.frustum, box)) continue;
        float pixels = 0;
        sum += e.preparer->item_costs().of(shown.form, box, pose.position, scale, pixels, hidden);
        if ((combine.frame_us(sum.submit_us, sum.raster_us) + e.enlarge_us()) * correction > time_us) return false;
    }
    return true;
}

}  // namespace surefoot
