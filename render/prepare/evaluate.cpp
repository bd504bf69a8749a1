// Choices of one node: legality over the region, predicted cost, error as an angle, and the benefit's factors.
#include "render/prepare/evaluate.hpp"

#include <algorithm>
#include <cmath>

#include "render/model/form_range.hpp"

namespace surefoot::prepare {

namespace {

constexpr float near_m = static_cast<float>(model::near_plane_m);
constexpr float largest_error_rad = 1e6F;  // keeps every product finite; an error of a million radians is just "wrong"

/// The eye of the region that is nearest to the box: there it costs most.
dvec3 nearest_eye(const RegionView& view, const Box& box) {
    const dvec3 away = glm::clamp(view.eye, box.min, box.max) - view.eye;
    const double distance = glm::length(away);
    if (!(distance > 0.0) || !(view.radius_m > 0.0)) return view.eye;
    return view.eye + away * (std::min(view.radius_m, distance) / distance);
}

struct Extent {
    float centre, half;
};
Extent along(const vec3& centre, const vec3& half, const vec3& axis) {
    return {glm::dot(centre, axis), glm::dot(half, glm::abs(axis))};
}

float overlap(const Extent& e, float limit) {
    return std::max(0.0F, std::min(e.centre + e.half, limit) - std::max(e.centre - e.half, -limit));
}

/// How far off the middle of the view the box begins, 0..1 of the half view.
float off_centre(const Extent& e, float limit) { return std::clamp((std::abs(e.centre) - e.half) / limit, 0.0F, 1.0F); }

struct Seen {
    float pixels = 0;  ///< of the box's outline, clipped to the view
    float focus = 1;
};

Seen look(const RegionView& view, const Box& box, const dvec3& eye) {
    const model::ViewScale& s = view.wide;
    const vec3 centre(box.centre() - eye), half(box.half());
    const Extent x = along(centre, half, s.across), y = along(centre, half, s.rise), z = along(centre, half, s.forward);
    Seen seen;
    const float deepest = z.centre + z.half;
    if (!(deepest > near_m)) return {0.0F, 1.0F - view.focus_strength};
    // The outline at the box's nearest depth alone misses what lies below or beside an eye that the box goes round (ground
    // under one's feet): the largest share of the view that the box fills at any of five depths through it.
    const float nearest = std::max(z.centre - z.half, near_m);
    const int steps = deepest > 1.5F * nearest ? 5 : 1;
    const float ratio = steps > 1 ? std::sqrt(std::sqrt(deepest / nearest)) : 1.0F;
    float depth = nearest, share = 0.0F;
    for (int i = 0; i < steps; ++i, depth *= ratio) {
        const float wide = depth * s.tan_half_x, high = depth * s.tan_half_y;
        share = std::max(share, overlap(x, wide) * overlap(y, high) / (4.0F * wide * high));
    }
    // Flat things have no height at any depth, and yet fill the view from their near edge to their far one: half of the
    // rectangle round both (a street to the horizon is a triangle in it).
    const auto between = [&](const Extent& e, float limit) {
        const float low = e.centre - e.half, high = e.centre + e.half;
        const float from = std::max(low / (low < 0 ? nearest : deepest), -limit);
        const float to = std::min(high / (high > 0 ? nearest : deepest), limit);
        return std::max(0.0F, to - from) / (2.0F * limit);
    };
    share = std::max(share, 0.5F * between(x, s.tan_half_x) * between(y, s.tan_half_y));
    seen.pixels = std::min(share, 1.0F) * s.viewport_pixels;
    const float right = off_centre(x, deepest * s.tan_half_x), up = off_centre(y, deepest * s.tan_half_y);
    seen.focus = 1.0F - view.focus_strength * 0.5F * (right * right + up * up);
    return seen;
}

float mean_size_m(const Box& box) {
    const vec3 half(box.half());
    return std::sqrt(2.0F * std::max(half.x * half.y + half.y * half.z + half.z * half.x, 0.0F));
}

/// What moves fast across the view is blurred (Maciel 1994, section 3.3.2): down to a half, since walking towards a thing does
/// not blur it.
float motion_factor(const RegionView& view, float distance_m) {
    const float omega = (view.speed_mps + view.object_mps) / distance_m + view.turn_rps;
    return 1.0F - 0.5F * omega / (omega + 4.0F);
}

/// How much of its sharpness a moving thing keeps, above 0 to 1. Of what it crosses in a frame of 30 Hz, a quarter is taken as
/// blurred: what the eye can tell apart grows by that (the motion benefit of Funkhouser and Sequin 1993, section 4.2).
float sharpness(const RegionView& view, float distance_m) {
    constexpr float blurred_s = 0.25F / 30;
    return view.resolved_rad / (view.resolved_rad + blurred_s * view.object_mps / distance_m);
}

}  // namespace

Outline outline_of(const RegionView& view, const Box& box) {
    const model::ViewScale& s = view.wide;
    constexpr float far_out = 1e9F;
    Outline outline{far_out, far_out, -far_out, -far_out};
    const vec3 low(box.min - view.eye), high(box.max - view.eye);
    float deepest = -far_out;
    for (unsigned i = 0; i < 8; ++i) {
        const vec3 corner((i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z);
        deepest = std::max(deepest, glm::dot(corner, s.forward));
        const float depth = std::max(glm::dot(corner, s.forward), near_m);
        const float x = glm::dot(corner, s.across) / (depth * s.tan_half_x),
                    y = glm::dot(corner, s.rise) / (depth * s.tan_half_y);
        outline = {std::min(outline.left, x), std::min(outline.low, y), std::max(outline.right, x), std::max(outline.high, y)};
    }
    return deepest > near_m ? outline : Outline{};
}

RegionView seen_at_rest(const RegionView& view, const model::MovingNode& moving) {
    RegionView out = view;
    out.eye = moving.pose.back(view.eye);
    out.radius_m += moving.drift_m;
    out.scale = model::turned_back(view.scale, moving.pose);
    out.wide = model::turned_back(view.wide, moving.pose);
    out.object_mps = static_cast<float>(std::min(moving.speed_mps, 1e4));
    return out;
}

float nearest_distance(const RegionView& view, const Box& box) {
    const double distance = box.distance(view.eye) - view.radius_m;
    return distance > 0.0 ? static_cast<float>(std::min(distance, 1e30)) : 0.0F;
}

float finest_error(const model::Model& model, const model::Node& node, float nearest_m) {
    for (Index r = node.first_rep + node.rep_count; r > node.first_rep; --r) {
        const model::Representation& rep = model.reps[r - 1];
        if (model::legal(rep, nearest_m)) return rep.error_m;
    }
    return model.reps[node.first_rep].error_m;
}

Evaluator::Evaluator(const model::Model& model, const model::CostModel& costs)
    : model_(model), costs_(costs), item_costs_(model, costs) {}

std::uint32_t Evaluator::evaluate(const RegionView& view, const Box& box, float nearest_m, Candidate& candidate, Choice* choices,
                                  Weight& weight) const {
    const model::Node& node = model_.nodes[candidate.node];
    const dvec3 eye = nearest_eye(view, box);
    const float distance = model::error_distance(nearest_m);
    const Seen seen = look(view, box, eye);
    const float sharp = sharpness(view, distance);
    candidate.pixels = seen.pixels;
    const float size = std::sqrt(seen.pixels / view.wide.viewport_pixels);
    const float importance = node.importance >= 0.0F ? std::min(node.importance, 1.0F) : 0.0F;
    candidate.importance = importance;
    const float pixel_weight = importance * seen.focus * motion_factor(view, distance);
    weight = {size * pixel_weight, size * importance, distance, pixel_weight, outline_of(view, box), sharp * mean_size_m(box)};

    const auto fill = [&](Choice& choice, Index r, float error_rad) {
        choice.rep = r;
        choice.cost = item_costs_.of(r, box, eye, view.scale, choice.surface_px, view.without) *
                      (model::is_full_detail(node, r, model_.reps[r].error_m) ? view.full_factor : view.coarse_factor);
        choice.surface_px *= view.wide.viewport_pixels / view.scale.viewport_pixels;  // of full resolution
        choice.error_rad = error_rad;
        choice.benefit = benefit_of(weight.weight, accuracy_gain(error_rad, view.resolved_rad / sharp),
                                    unusable_penalty(weight.size, error_rad));
        choice.subtree_benefit = choice.benefit;
        choice.triangles = model_.reps[r].triangles;
    };
    const auto error_of = [&](Index r) {
        return std::clamp(model::error_rad(model_.reps[r], nearest_m), 0.0F, largest_error_rad);
    };

    std::uint32_t count = 0;
    bool enough = false;
    for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
        if (!model::legal(model_.reps[r], nearest_m)) continue;
        const float error_rad = error_of(r);
        if (count > 0 && !(error_rad < choices[count - 1].error_rad)) continue;
        Choice choice;
        fill(choice, r, error_rad);
        const float metric = cost_metric(costs_.combine, choice.cost);
        if (enough && metric > cost_metric(costs_.combine, choices[count - 1].cost)) break;
        while (count > 0 && metric <= cost_metric(costs_.combine, choices[count - 1].cost)) --count;  // better and no dearer
        choices[count++] = choice;
        if (!(error_rad <= view.target_error_rad) || view.full_depth) continue;
        if (!model::is_full_detail(node, r, model_.reps[r].error_m)) break;
        enough = true;  // what follows shows the same: it is offered where it is cheaper
    }
    if (count == 0) {  // a model that breaks its promise of an everywhere-legal form is still drawn
        fill(choices[0], node.first_rep, error_of(node.first_rep));
        count = 1;
    }
    candidate.choice_count = count;
    return count;
}

}  // namespace surefoot::prepare
