// The engine's image cache: what pictures cover is told to the workers, new pictures are offered before a selection and captured
// after it, and what they cover is drawn by them after the last slice.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "render/cache/validity.hpp"
#include "render/drawn_items.hpp"
#include "render/effects/effects.hpp"
#include "render/engine_impl.hpp"
#include "render/select/budget.hpp"

namespace surefoot {

namespace {

constexpr double off_course_m = 0.03;  // how far eyes may be beside a straight course in the next frames
constexpr double may_turn_rad = 0.1;   // while a picture lives, beyond what the next frames may
constexpr double all_round_rad = std::numbers::pi;
constexpr double jump_m = 2;             // in a frame: no course leads there
constexpr double unlimited_share = 0.1;  // of the budget, for new pictures where nothing limits what a frame spends
constexpr double limited_share = 0.25;   // the same where forms compete with them, for two seconds after a jump
constexpr double steady_share = 0.09;    // and later: what they take is within a tenth of the period
constexpr std::int64_t refill_ns = 2'000'000'000;
constexpr double max_share = 1.0 / 16;  // of the budget, for one picture: what a slice may take
constexpr double usual_budget_us = 33'333;
constexpr double value_share = 1e-5;             // of the picture: of what saves time that nothing else can use
constexpr double min_rate_share = 1e-9;          // of the picture's value: a us is worth at least this
constexpr double min_promised_share = 1e-7;      // the same where an accuracy is promised: time is for keeping it
constexpr double needed_share = 1.25;            // of what they save: so that they do not come and go
constexpr std::uint32_t first_picture_item = 1;  // of ItemKind::refresh; the shadow map is below
constexpr std::size_t uncovered_chunk = 32;
constexpr std::uint32_t timed_every = 8;                     // frames with pictures
constexpr std::uint32_t untimed_long = 64, timed_first = 4;  // frames; so many are timed one after another, after so many without
constexpr double min_timed_us = 100;                         // by the table; less says nothing
constexpr double learnt_share = 0.5, min_picture_factor = 0.25, max_picture_factor = 8;
constexpr double forgotten_share = 1.0 / 512;  // a frame on the real clock: what did not pay is tried again
constexpr double min_sample = 0.05;            // of the prediction; in less nothing was drawn

double us_of(const model::FrameCombine& combine, const model::ItemCost& cost) {
    return static_cast<double>(combine.frame_us(cost.submit_us, cost.raster_us) - combine.fixed_us);
}

gl::CachePicture to_device(const cache::HeldPicture& held) {
    const cache::Picture& picture = held.picture;
    gl::CachePicture to;
    to.place = {held.slot.layer, held.slot.column, held.slot.row, held.slot.texels};
    to.eye = picture.eye;
    to.right = picture.right;
    to.up = picture.up;
    to.forward = picture.forward;
    to.plane_m = picture.plane_m;
    to.low_m = picture.low_m;
    to.side_m = picture.side_m;
    to.box = held.box;
    to.grown_m = held.grown_m;
    return to;
}

/// Leaves that no picture may show: what moves, what is drawn with ordered transparency, and what changes with the time.
std::vector<bool> not_for_pictures(const model::Model& model, bool moving_shadows) {
    const model::EffectMask changing =
        effects::moving_effects() | model::effect_blend | (moving_shadows ? model::EffectMask{model::effect_moving_shadow} : 0U);
    std::vector<bool> excluded(model.nodes.size(), false);
    for (model::Index n = 0; n < model.nodes.size(); ++n) {
        const model::Node& node = model.nodes[n];
        const model::EffectMask effects = model.reps[node.first_rep + node.rep_count - 1].effects;
        excluded[n] = node.child_count == 0 && ((effects & changing) != 0 || model::motion_of(model, node) != model::none);
    }
    return excluded;
}

/// Of leaves with ordered transparency.
std::vector<Box> blended_boxes(const model::Model& model) {
    std::vector<Box> boxes;
    for (const model::Node& node : model.nodes)
        if (node.child_count == 0 && (model.reps[node.first_rep + node.rep_count - 1].effects & model::effect_blend) != 0)
            boxes.push_back(node.box);
    return boxes;
}

}  // namespace

/// Where the device has layers for pictures, and the model has boxes for them. Nothing else of the engine changes without them.
void Engine::Impl::make_pictures() {
    if (device->picture_layers() == 0) {
        picture_reason = device->picture_reason();
        return;
    }
    auto boxes = cache::SceneBoxes::make(model, not_for_pictures(model, shadow.any()));
    if (!boxes) {
        picture_reason = boxes.error().text();
        return;
    }
    boxes->price_captures(model, costs);
    cache::WalkCacheOptions how;
    how.layers = device->picture_layers();
    how.surround = options.pictures_all_round;
    how.picture_us = costs.picture_us;
    how.picture_ns_per_pixel = costs.picture_ns_per_pixel;
    how.capture_us = costs.capture_us;
    how.capture_ns_per_texel = costs.capture_ns_per_texel;
    pictures = cache::WalkCache(std::move(*boxes), how, blended_boxes(model));
    for (const model::Index n : pictures.boxes().nodes())
        picture_items.push_back({n, model.nodes[n].first_rep + model.nodes[n].rep_count - 1});
    shown_pictures.reserve(pictures.boxes().size());
    shown_boxes.reserve(pictures.boxes().size());
    anew.reserve(pictures.boxes().size());
    made_boxes.reserve(pictures.boxes().size());
    frame_boxes.resize(pictures.boxes().size());
    uncovered.reserve(model.nodes.size());
    is_uncovered.resize(model.nodes.size(), false);
    preparer->set_cover(&pictures.boxes());
}

bool Engine::has_pictures() const {
    impl_->draws.plays();
    return impl_->pictures.any();
}

const std::string& Engine::picture_reason() const { return impl_->picture_reason; }

const model::CoverBits& Engine::cover(const Pose& now, const prepare::Region& next) {
    Impl& e = *impl_;
    e.draws.plays();
    if (!e.pictures.any()) return e.cover_bits;
    const dvec3 step = now.position - e.course.eye;
    const bool jumps = !e.course_known || !(glm::length(step) <= jump_m);
    e.course.eye = now.position;
    e.course.step_m = jumps ? dvec3(0) : step;
    e.course.radius_m = off_course_m;
    e.course_known = true;
    e.jumped = e.jumped || jumps;
    // Eyes on the way to the region's middle, and as far beyond it.
    const double way_m = glm::length(next.centre.position - now.position) + off_course_m;
    e.turn_rad = e.options.pictures_all_round ? all_round_rad : next.angle_rad;
    return e.cover_bits = e.pictures.cover(cache::view_pixels(next.centre, e.options.device.viewport, e.turn_rad),
                                           std::min(way_m, next.radius_m));
}

/// Predicted, to draw a box's picture at the resolution that is drawn.
double Engine::Impl::picture_us(cache::Index box, const Pose& pose) const {
    const model::Viewport viewport = options.device.viewport;
    const double pixel_rad = model::pixel_angle(pose, viewport) / static_cast<double>(drawn_resolution);
    const float table_us = pictures.draw_us(box, pose.position, pixel_rad, 1.0 * viewport.width * viewport.height);
    return picture_factor * static_cast<double>(table_us);
}

/// The pictures of the set are drawn whatever else is. Their price is part of all predictions.
void Engine::Impl::prepay_pictures(const prepare::PreparedFrame& set) {
    pictures_us = 0;
    if (!pictures.any()) return;
    pictures.drop_pending();  // bought for a frame that drew no cut
    pictures.set_promise(promised_rad);
    const Pose& pose = set.region.centre;
    const model::Viewport viewport = options.device.viewport;
    const model::Frustum seen = model::make_frustum(pose, viewport, model::far_corners_m(model.nodes[0].box));
    const cache::CacheDraws& in_set = pictures.draws(set.covered, cache::view_pixels(pose, viewport), seen);
    for (const cache::Index box : in_set.boxes) pictures_us += picture_us(box, pose);
    pictures_us = static_cast<double>(static_cast<float>(pictures_us));  // as in the list of items, which captures keep
    const double at = static_cast<double>(drawn_resolution);
    set_pictures_us.store(static_cast<float>(pictures_us / (at * at)), std::memory_order_relaxed);
    set_pictures_value.store(static_cast<float>(in_set.value), std::memory_order_relaxed);
    pictures_save_us = in_set.saves_us;
    if (pictures_us > 0) offered.prepay({select::ItemKind::pictures, 0, static_cast<float>(pictures_us), 0});
}

/// Whether a frame without pictures could show all there is: what they save gone, all effects bought, at the full resolution.
bool Engine::Impl::has_time_for_all(const prepare::PreparedFrame& set, float room_us) const {
    if (drawn_resolution < (options.resolution > 0.0F ? options.resolution : 1.0F)) return false;
    double needed_us = static_cast<double>(set.curve.cost.back()) + needed_share * pictures_save_us;
    for (const select::Item& item : offered.offered()) needed_us += item.prepaid ? 0.0 : static_cast<double>(item.cost_us);
    return static_cast<double>(room_us) >= needed_us;
}

/// What a new picture saves until it fails, at the rate at which this frame trades time for value.
void Engine::Impl::offer_pictures(const prepare::PreparedFrame& set, const select::SelectInput& input) {
    if (!pictures.any() || !course_known || rests) return;
    const Pose& pose = set.region.centre;
    const model::Viewport viewport = options.device.viewport;
    const model::Frustum seen =
        model::make_frustum(pose, viewport, model::far_corners_m(model.nodes[0].box), set.region.radius_m, set.region.angle_rad);
    cache::PlanView view;
    view.course = course;
    view.pixels = cache::view_pixels({course.eye, pose.orientation, pose.fov_y_rad}, viewport, turn_rad + may_turn_rad);
    view.frustum = &seen;
    view.pixel_rad = model::pixel_angle(pose, viewport) / static_cast<double>(drawn_resolution);
    view.view_px = 1.0 * viewport.width * viewport.height;
    view.combine = combine();
    const double budget_us = std::isfinite(input.budget_us) ? input.budget_us : usual_budget_us;
    // Forms compete with them, and what they take is as wrong as what forms take.
    const bool refills = jumped || jumped_ns < 0 || frame_ns - jumped_ns < refill_ns;
    const double corrected_us = by_budget ? budget_us / std::max(1.0, correction.factor) : budget_us;
    double left_us = (!by_budget ? unlimited_share : refills ? limited_share : steady_share) * corrected_us;
    view.max_price_us = std::min(max_share * corrected_us, left_us);
    const auto room_us = static_cast<float>(select::Budget(input).room_us());
    const float a_ms = by_budget ? set.curve.value_at(room_us + 1000.0F) - set.curve.value_at(room_us) : 0.0F;
    const double rate = std::max(1e-3 * static_cast<double>(a_ms), value_share * set.full_value / usual_budget_us);
    const bool promised = promised_rad > 0;
    const double buying = std::max(rate, (promised ? min_promised_share : min_rate_share) * set.full_value);
    view.refills = jumped || (jumped_ns >= 0 && refills);
    view.ample = by_budget && !promised && has_time_for_all(set, room_us);
    view.picture_factor = picture_factor;
    view.us_per_value = by_budget && buying > 0 ? 1 / buying : 0.0;
    const std::span<const cache::CacheOffer> plan_of_pictures = pictures.plan(view);
    for (const cache::CacheOffer& offer : plan_of_pictures) {
        if (static_cast<double>(offer.price_us) > left_us) continue;
        const auto worth_of = static_cast<float>(std::max(rate * static_cast<double>(offer.gain_us), 1e-9));
        if (!offered.offer({select::ItemKind::refresh, first_picture_item + offer.box, offer.price_us, worth_of})) continue;
        left_us -= static_cast<double>(offer.price_us);
    }
}

/// Bought pictures get their places; where there is none, their time stays free. And the cut says what could be saved.
void Engine::Impl::take_pictures() {
    if (!pictures.any()) return;
    const std::span<const select::Item> list = offered.offered();
    for (const cache::CacheOffer& offer : pictures.offers()) {
        for (std::size_t i = 0; i < list.size(); ++i) {
            if (list[i].name() != select::ItemName{select::ItemKind::refresh, first_picture_item + offer.box}) continue;
            if (cut.bought.has(i) && !pictures.take(offer)) cut.bought.cancel(i, list[i]);
        }
    }
    if (pictures.is_idle()) return;
    const model::FrameCombine by = combine();
    pictures.begin_costs(prepared->covered);
    for (const select::CutItem& item : cut.items) {
        const model::ItemCost& cost = prepared->choices[item.choice].cost;
        pictures.add_cost(item.node, by.frame_us(cost.submit_us, cost.raster_us) - by.fixed_us,
                          prepared->choices[item.choice].value, prepared->candidates[item.candidate].full_value);
    }
    pictures.end_costs();
}

/// The device draws them with the next picture that begins.
void Engine::Impl::capture_pictures(SubmitReport& report) {
    device->draws.plays();
    for (std::size_t i = 0; i < offered.offered().size(); ++i) {
        const select::Item& item = offered.offered()[i];
        if (item.kind != select::ItemKind::refresh || item.what < first_picture_item || !cut.bought.has(i)) continue;
        const cache::Index box = item.what - first_picture_item;
        if (pictures.is_pending(box) && device->capture_picture(to_device(pictures.held(box)), contents_of(box))) {
            ++report.pictures_made;
            report.captures_us += static_cast<double>(item.cost_us);
            pictures.captured(box);
            made_boxes.push_back(box);
        } else {
            cut.bought.cancel(i, item);  // not charged either
        }
    }
    pictures.drop_pending();
}

/// Leaves that the set left out because of pictures that are not valid at this pose. Returns the time of their coarse forms; no
/// more are found once they exceed what is left.
double Engine::Impl::find_uncovered(const Pose& pose, double left_us) {
    uncovered.clear();
    double coarse_us = 0;
    const model::ViewScale scale = drawn_scale(pose);
    const model::EffectMask hidden_now = drawn_without();
    for (const cache::Index box : pictures.unserved()) {
        for (const model::Index n : pictures.boxes().leaves(box)) {
            const model::Node& node = model.nodes[n];
            if (is_uncovered[n] || !pictures.boxes().covered(n, prepared->covered) || !in_view(n)) continue;
            is_uncovered[n] = true;
            UncoveredItem item{n, node.first_rep + node.rep_count - 1, node.first_rep, {}, {}, 0, 0};
            item.distance_m = static_cast<float>(std::max(node.box.distance(pose.position), model::near_plane_m));
            while (!model.reps[item.coarse].everywhere && item.coarse < item.full) ++item.coarse;
            const model::ItemCosts& prices = preparer->item_costs();
            item.full_cost = prices.of(item.full, node.box, pose.position, scale, item.pixels, hidden_now);
            item.coarse_cost = prices.of(item.coarse, node.box, pose.position, scale, item.pixels, hidden_now);
            uncovered.push_back(item);
            coarse_us += us_of(costs.combine, item.coarse_cost);
            if (coarse_us > left_us) break;
        }
        if (coarse_us > left_us) break;
    }
    for (const UncoveredItem& item : uncovered) is_uncovered[item.node] = false;
    return coarse_us;
}

/// What the cut's stand-ins and what was bought leave of the frame.
double Engine::Impl::left_for_uncovered_us(const SubmitLimits& limits) const {
    model::ItemCost coarsest;
    for (const select::Slice& slice : plan.slices)
        coarsest += {slice.stand_in_cost.submit_us + costs.slice_us, slice.stand_in_cost.raster_us};
    const double cut_us = static_cast<double>(combine().frame_us(coarsest.submit_us, coarsest.raster_us) + enlarge_us());
    return (limits.limit_us - limits.margin_us - limits.elapsed_us) / correction.factor - cut_us - beside_us();
}

/// Before a picture begins: pictures of the set are chosen for the true pose. Where too much would have to be drawn in their
/// place, no prepared set may be used.
void Engine::Impl::begin_pictures(const Pose& pose, const SubmitLimits& limits, SubmitReport& report) {
    after_us = shown_us = pictures_value = 0;
    shown_pictures.clear();
    shown_boxes.clear();
    made_boxes.clear();
    uncovered.clear();
    report.picture_bytes = pictures.bytes();
    if (!pictures.any() || use_last) return;
    if (drawn_without() != pictures_without) pictures.forget();
    pictures_without = drawn_without();
    const model::Viewport viewport = options.device.viewport;
    const cache::CacheDraws& draws_now = pictures.draws(prepared->covered, cache::view_pixels(pose, viewport), frustum);
    for (const cache::Index box : draws_now.boxes) {
        shown_boxes.push_back({to_device(pictures.held(box)), box});
        shown_pictures.push_back(shown_boxes.back().picture);
        report.pictures_us += picture_us(box, pose);
    }
    const double left_us = left_for_uncovered_us(limits) - report.pictures_us, coarse_us = find_uncovered(pose, left_us);
    if (!uncovered.empty() && coarse_us > left_us) {
        report.uncovered_items = static_cast<std::uint32_t>(uncovered.size());
        report.pictures_us = 0;
        shown_pictures.clear();
        shown_boxes.clear();
        use_last = true;
        return;
    }
    report.pictures = static_cast<std::uint32_t>(shown_pictures.size());
    for (const cache::Index box : draws_now.boxes) {
        const double error_rad = cache::picture_errors(pictures.held(box).picture, pose.position).total();
        count_error(pictures.boxes().important_leaf(box), static_cast<float>(error_rad), pictures.boxes().importance(box),
                    report);
    }
    pictures_value = draws_now.value;
    after_us = coarse_us;
    shown_us = report.pictures_us;
    capture_pictures(report);
}

/// After begin_pictures().
void Engine::Impl::count_boxes(SubmitReport& report) {
    if (!pictures.any()) return;
    const std::span<const cache::Index> shown = shown_pictures.empty() ? std::span<const cache::Index>() : pictures.drawn();
    const cache::FrameBoxCounts counts = cache::mark_boxes(pictures.boxes(), shown, made_boxes, frustum, frame_boxes);
    report.pictures_reused = counts.reused;
    report.boxes_as_triangles = counts.as_triangles;
}

/// In full detail where that fits, else coarse: never a hole.
void Engine::Impl::draw_uncovered(const SubmitLimits& limits, double start_us, model::ItemCost& so_far, SubmitReport& report) {
    if (uncovered.empty() || use_last) return;
    device->draws.plays();
    bool full = report.downgraded_slices == 0;
    float in_flight_us = 0;
    for (std::size_t at = 0; at < uncovered.size(); at += uncovered_chunk) {
        const auto chunk = std::span(uncovered).subspan(at, std::min(uncovered_chunk, uncovered.size() - at));
        model::ItemCost next{costs.slice_us, 0}, coarse = next, rest;
        for (const UncoveredItem& item : chunk) {
            next += item.full_cost;
            coarse += item.coarse_cost;
            after_us -= us_of(costs.combine, item.coarse_cost);
        }
        full = full && in_time({so_far, next, coarse, rest, in_flight_us}, limits, start_us);
        const std::size_t first = drawn.size();
        for (const UncoveredItem& item : chunk) {
            const model::Index rep = full ? item.full : item.coarse;
            if (!push_within(drawn, {item.node, rep})) break;
            floor.add(drawn.back(), item.pixels, !full && item.coarse != item.full);
            report.triangles += model.reps[rep].triangles;
            count_error(item.node, model.reps[rep].error_m / item.distance_m, model.nodes[item.node].importance, report);
        }
        device->draw(std::span<const gl::DrawItem>(drawn).subspan(first));
        device->end_slice();
        device->wait_slices(1);
        const model::ItemCost& cost = full ? next : coarse;
        so_far += cost;
        in_flight_us = cost.raster_us;
        report.uncovered_items += static_cast<std::uint32_t>(chunk.size());
        ++report.slices;
        if (!full) ++report.downgraded_slices;
    }
}

/// Over those of the walk, which are forgotten; those that the last frame showed are there. As many as a frame takes are captured
/// by a frame of their own.
void Engine::Impl::make_pictures_anew(const Pose& pose, std::span<const ShownPicture> shown) {
    device->draws.plays();
    anew.clear();
    if (!pictures.any()) return;
    const std::size_t count = std::min(shown.size(), anew.capacity());
    for (const ShownPicture& each : shown.first(count)) anew.push_back(each.picture);
    if (anew.empty() || shown.data() == shown_boxes.data()) return;
    pictures.clear();
    for (std::size_t i = 0; i < count; ++i) {
        if (i > 0 && i % gl::max_captures == 0) {
            draw_items(pose, {}, 1);
            device->end_items();
            device->finish_frame();
        }
        device->capture_picture(shown[i].picture, contents_of(shown[i].box));
    }
}

std::span<const gl::CachePicture> Engine::pictures() const {
    impl_->draws.plays();
    return impl_->rest_picture.samples() > 0 ? std::span<const gl::CachePicture>() : impl_->shown_pictures;
}

std::span<const ShownPicture> Engine::shown_pictures() const {
    impl_->draws.plays();
    return impl_->rest_picture.samples() > 0 ? std::span<const ShownPicture>() : impl_->shown_boxes;
}

std::span<const model::Index> Engine::leaves_in(std::uint32_t box) const {
    impl_->draws.plays();
    return impl_->pictures.boxes().leaves(box);
}

std::size_t Engine::picture_capacity() const {
    impl_->draws.plays();
    return impl_->shown_boxes.capacity();
}

std::span<const cache::FrameBox> Engine::cache_boxes() const {
    impl_->draws.plays();
    return impl_->frame_boxes;
}

std::vector<std::uint8_t> Engine::birds_eye(std::span<const cache::FrameBox> frame, const dvec3& eye,
                                            std::uint32_t side_px) const {
    impl_->draws.plays();
    const cache::SceneBoxes& boxes = impl_->pictures.boxes();
    if (frame.empty() || frame.size() != boxes.size()) return {};
    Box bounds = boxes.tree().boxes.front().box;
    bounds.grow(eye);
    return cache::birds_eye_view(cache::seen_boxes(boxes, frame), bounds, eye, side_px);
}

/// Whether a frame that draws pictures times them. What was forgotten meanwhile is learnt again at once: pictures that do not pay
/// are made in each frame until then.
bool Engine::Impl::is_timed(double table_us) {
    if (!(table_us > min_timed_us)) return false;
    if (untimed_frames > untimed_long) timed_next = timed_first;
    if (timed_next == 0 && ++picture_frames % timed_every != 0) return false;
    timed_next -= timed_next > 0 ? 1 : 0;
    untimed_frames = 0;
    return true;
}

/// A frame's time is corrected as a whole, mostly by what forms take. So from time to time pictures are timed by themselves: all
/// before them is waited for, and then they are.
void Engine::Impl::draw_pictures(const SubmitLimits& limits, SubmitReport& report) {
    const double table_us = report.pictures_us / picture_factor;
    if (limits.now_ns != nullptr) {
        picture_factor += forgotten_share * (1 - picture_factor);
        ++untimed_frames;
    }
    if (shown_pictures.empty()) return;
    device->draws.plays();
    const bool timed = limits.now_ns != nullptr && is_timed(table_us);
    if (timed) {
        device->end_slice();  // there may be none, and what clears the picture is before it
        device->wait_slices(0);
    }
    const double from_us = now_us(limits);
    device->charge_us(table_us);
    device->draw_pictures(shown_pictures);
    device->end_slice();
    device->wait_slices(timed ? 0 : 1);
    ++report.slices;
    if (!timed) return;
    const double sample = (now_us(limits) - from_us) / (table_us * correction.factor);
    if (!std::isfinite(sample) || !(sample > min_sample)) return;
    const double lesser = std::min(sample, last_picture_sample);  // one frame that was interrupted says nothing
    last_picture_sample = sample;
    picture_factor += learnt_share * (std::clamp(lesser, min_picture_factor, max_picture_factor) - picture_factor);
}

}  // namespace surefoot
