// Serial passes over the candidates: a parent comes before its children, so one loop each way does.
#include "render/prepare/tree_passes.hpp"

#include <algorithm>

namespace surefoot::prepare {

namespace {

/// Costs that differ by less count as equal: a node and its only child fill the same pixels, and rounding decides which comes out
/// dearer. Otherwise the cut would depend on the compiler.
constexpr float same_cost = 1.0001F;

struct Below {
    Weight weight;      ///< greatest weight and least distance among the visible leaves below
    float benefit = 0;  ///< the children's greatest
    model::ItemCost floor;
};

Below below(const Candidate& candidate, std::span<const Weight> weights, const PreparedFrame& frame, model::ItemCost& first_sum) {
    Below sum;
    sum.weight = weights[candidate.first_child];
    for (Index c = candidate.first_child; c < candidate.first_child + candidate.child_count; ++c) {
        const Candidate& child = frame.candidates[c];
        const Choice& first = frame.choices[child.first_choice];
        sum.weight.weight = std::max(sum.weight.weight, weights[c].weight);
        sum.weight.distance_m = std::min(sum.weight.distance_m, weights[c].distance_m);
        sum.benefit = std::max(sum.benefit, first.subtree_benefit);
        sum.floor += child.floor_cost;
        first_sum += first.cost;
    }
    return sum;
}

}  // namespace

void propagate_up(const model::FrameCombine& combine, float resolved_rad, std::span<Weight> weights, PreparedFrame& frame) {
    double full_submit_us = 0, full_raster_us = 0;  // double: a hundred thousand small costs
    for (std::size_t i = frame.candidates.size(); i-- > 0;) {
        Candidate& candidate = frame.candidates[i];
        const std::span<Choice> choices(&frame.choices[candidate.first_choice], candidate.choice_count);
        candidate.floor_cost = choices[0].cost;
        const auto penalty_of = [&](std::size_t c) {
            const model::ItemCost& next = c + 1 < choices.size() ? choices[c + 1].cost : candidate.children_cost;
            return cost_penalty(cost_metric(combine, next) - cost_metric(combine, choices[c].cost));
        };
        if (candidate.child_count == 0) {
            float min_benefit = 0;  // of the finest there is no leaving
            for (std::size_t c = choices.size(); c-- > 0;) {
                if (c + 1 < choices.size()) choices[c].benefit *= penalty_of(c);
                min_benefit = std::max(min_benefit, choices[c].benefit);
                choices[c].subtree_benefit = min_benefit;
            }
            full_submit_us += static_cast<double>(choices.back().cost.submit_us);
            full_raster_us += static_cast<double>(choices.back().cost.raster_us);
            continue;
        }
        const Below sum = below(candidate, weights, frame, candidate.children_cost);
        if (cost_metric(combine, sum.floor) <= same_cost * cost_metric(combine, candidate.floor_cost)) {
            candidate.floor_cost = sum.floor;  // no dearer and finer
            candidate.floor_open = true;
        }
        float min_benefit = sum.benefit;
        for (std::size_t c = choices.size(); c-- > 0;) {
            const float error_m = choices[c].error_rad * weights[i].distance_m;
            const float gain =
                benefit_of(sum.weight.weight, accuracy_gain(error_m / sum.weight.distance_m, resolved_rad),
                           unusable_penalty(weights[i].size, choices[c].error_rad));  // its own: round the eye, not below
            const float share = penalty_of(c);
            choices[c].benefit *= share;
            min_benefit = std::max(min_benefit, gain * share);
            choices[c].subtree_benefit = min_benefit;
        }
        weights[i] = sum.weight;
    }
    frame.full_cost = {static_cast<float>(full_submit_us), static_cast<float>(full_raster_us)};
}

void enforce_monotone_benefit(PreparedFrame& frame) {
    for (Candidate& candidate : frame.candidates) {
        float max_benefit = 1.0F;
        if (candidate.parent != none) {
            const Candidate& parent = frame.candidates[candidate.parent];
            max_benefit = frame.choices[parent.first_choice + parent.choice_count - 1].benefit;
        }
        for (std::uint32_t c = 0; c < candidate.choice_count; ++c) {
            float& benefit = frame.choices[candidate.first_choice + c].benefit;
            max_benefit = std::min(max_benefit, benefit);
            benefit = max_benefit;
        }
    }
}

PlaneMask cull_planes(const model::Frustum& frustum, const Box& box, PlaneMask parent) {
    if (box.empty()) return culled;
    if (parent == 0) return 0;
    const dvec3 centre = box.centre(), half = box.half();
    unsigned mask = parent;
    for (unsigned i = 0; i < frustum.planes.size(); ++i) {
        if ((mask >> i & 1U) == 0) continue;
        const dvec4& p = frustum.planes[i];
        const double reach = std::abs(p.x) * half.x + std::abs(p.y) * half.y + std::abs(p.z) * half.z;
        const double away = p.x * centre.x + p.y * centre.y + p.z * centre.z + p.w;
        const double slack = 1e-9 * (std::abs(p.w) + reach);  // rounding far from the origin, as in model::visible
        if (away + reach < -slack) return culled;
        if (away - reach > slack) mask &= ~(1U << i);
    }
    // Crossing boxes may still lie beside the frustum's edges: the second test decides, and only they pay for it.
    if (mask != 0 && !model::visible(frustum, box)) return culled;
    return static_cast<PlaneMask>(mask);
}

}  // namespace surefoot::prepare
