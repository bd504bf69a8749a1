// What no cut of a captured frame can beat: the least cost of an error that all items share, and what a cut reached. Computed
// from the captured arrays, by code that shares nothing with render/select.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "render/capture/capture.hpp"
#include "render/model/view.hpp"

namespace surefoot::test {

/// What is compared with a common error: that of the form, times the importance of its object.
inline double weighted_error(const prepare::Candidate& at, const prepare::Choice& choice) {
    return static_cast<double>(choice.error_rad) * static_cast<double>(at.importance);
}

/// The cheapest cut within an error, by weights of submit and raster time: one pass, children first. Of a leaf without a form
/// within the error the finest counts: nothing better is offered.
inline double cheapest_us(const prepare::PreparedFrame& frame, double error_rad, double submit_weight, double raster_weight) {
    constexpr double none_us = std::numeric_limits<double>::infinity();
    std::vector<double> below(frame.candidates.size());
    for (std::size_t c = below.size(); c-- > 0;) {
        const prepare::Candidate& at = frame.candidates[c];
        double own = none_us, children = at.child_count > 0 ? 0 : none_us;
        for (std::uint32_t k = 0; k < at.choice_count; ++k) {
            const prepare::Choice& choice = frame.choices[at.first_choice + k];
            const bool last_leaf = at.child_count == 0 && k + 1 == at.choice_count;
            if (weighted_error(at, choice) > error_rad && !last_leaf) continue;
            own = std::min(own, submit_weight * static_cast<double>(choice.cost.submit_us) +
                                    raster_weight * static_cast<double>(choice.cost.raster_us));
        }
        for (std::uint32_t k = 0; k < at.child_count; ++k) children += below[at.first_child + k];
        below[c] = std::min(own, children);
    }
    return below[0];
}

/// No cut whose items are all within `error_rad` is predicted to take less than this, us without correction and headroom. A frame
/// takes the larger of two sums in part: any weights between them bound it from below.
inline double bound_us(const capture::Capture& of, double error_rad) {
    constexpr int weighings = 8;
    double bound = 0;
    for (int i = 0; i <= weighings; ++i) {
        const double share = static_cast<double>(i) / weighings, more = static_cast<double>(of.combine.max_weight);
        bound = std::max(bound, cheapest_us(of.prepared, error_rad, static_cast<double>(of.combine.submit_weight) + share * more,
                                            static_cast<double>(of.combine.raster_weight) + (1 - share) * more));
    }
    return bound;
}

/// The same measure of the items of a cut.
inline double items_us(const capture::Capture& of, const std::vector<select::CutItem>& items) {
    double submit = 0, raster = 0;
    for (const select::CutItem& item : items) {
        submit += static_cast<double>(of.prepared.choices[item.choice].cost.submit_us);
        raster += static_cast<double>(of.prepared.choices[item.choice].cost.raster_us);
    }
    return static_cast<double>(of.combine.submit_weight) * submit + static_cast<double>(of.combine.raster_weight) * raster +
           static_cast<double>(of.combine.max_weight) * std::max(submit, raster);
}

/// What the items of any cut may take within the budget, from the prediction of one: that is linear in what its items take.
inline double room_us(const capture::Capture& of, const std::vector<select::CutItem>& items, double predicted_us) {
    const double ends = 1 + static_cast<double>(of.combine.submit_weight) * static_cast<double>(of.slice_end_us) / of.slice_us;
    const double factor = of.correction * static_cast<double>(of.headroom) * ends;
    return items_us(of, items) + (of.budget_us - predicted_us) / factor;
}

/// Radians, times importance.
inline double worst_error(const capture::Capture& of, const std::vector<select::CutItem>& items) {
    double error = 0;
    for (const select::CutItem& item : items)
        error = std::max(error, weighted_error(of.prepared.candidates[item.candidate], of.prepared.choices[item.choice]));
    return error;
}

/// Whether an item of this node errs as much as the worst, but for a part in 10^4.
inline bool errs_most(const capture::Capture& of, std::uint32_t node, double worst_error_rad) {
    return std::any_of(of.items.begin(), of.items.end(), [&](const select::CutItem& item) {
        return item.node == node && worst_error(of, {item}) >= (1 - 1e-4) * worst_error_rad;
    });
}

/// The same of the items that a pose sees.
inline double worst_seen_error(const capture::Capture& of, const model::Model& model, const Pose& pose) {
    const model::Frustum frustum = model::make_frustum(pose, of.prepared.viewport, model::far_corners_m(model.nodes[0].box));
    std::vector<select::CutItem> seen;
    for (const select::CutItem& item : of.items)
        if (model::visible(frustum, model.nodes[item.node].box)) seen.push_back(item);
    return worst_error(of, seen);
}

}  // namespace surefoot::test
