// The slice plan and the in-frame check. The plan groups subtrees of the cut, nearest first, into slices: long ones first, short
// ones where the frame may have to end. Each slice has a coarser stand-in for exactly the same leaves. The check tests whether
// the next slice still fits in full, from the error of the frame's prediction so far.
#include <algorithm>
#include <cmath>

#include "render/select/budget.hpp"
#include "render/select/scratch.hpp"
#include "render/select/select.hpp"
#include "rt/base/check.hpp"

namespace surefoot::select {

namespace {

constexpr std::size_t max_slices = 4096;
/// A slice takes this share of what is left of the frame. Between slices rasterisers wait for each other, so few are better.
/// But while one is in flight, the in-frame check knows nothing of it.
constexpr float share_of_rest = 0.125F;
constexpr float max_stretch = 4.0F;  ///< times the shortest, at most
constexpr float max_growth = 2.0F;   ///< times the one before: rasterisers begin when the first slice ends

/// Predicted time as a linear measure, so that parts add up to the whole: the larger sum carries the max term.
struct Measure {
    float submit = 1, raster = 1;
    [[nodiscard]] float of(const model::ItemCost& cost) const { return submit * cost.submit_us + raster * cost.raster_us; }
};

Measure measure_of(const model::FrameCombine& combine, const model::ItemCost& sum) {
    Measure m{combine.submit_weight, combine.raster_weight};
    (sum.submit_us > sum.raster_us ? m.submit : m.raster) += combine.max_weight;
    return m;
}

/// The cut as a tree: what lies below every candidate. Arrays live in the plan's scratch.
class CutTree {
public:
    CutTree(const prepare::PreparedFrame& prepared, const Cut& cut, const Measure& measure, SlicePlan::Scratch& room)
        : prepared_(prepared), cut_(cut) {
        // Nothing of the cut lies after its last item: deeper candidates need no room.
        const std::size_t n = cut.items.empty() ? 0 : static_cast<std::size_t>(cut.items.back().candidate) + 1;
        below_us_ = std::span(room.below_us).first(n);
        item_ = std::span(room.item).first(n);
        std::fill(below_us_.begin(), below_us_.end(), -1.0F);
        std::fill(item_.begin(), item_.end(), none);
        for (std::uint32_t i = 0; i < cut.items.size(); ++i) {
            item_[cut.items[i].candidate] = i;
            below_us_[cut.items[i].candidate] = measure.of(prepared.choices[cut.items[i].choice].cost);
        }
        for (std::size_t c = n; c-- > 1;) {
            const Index parent = prepared.candidates[c].parent;
            if (below_us_[c] >= 0.0F) below_us_[parent] = std::max(0.0F, below_us_[parent]) + below_us_[c];
        }
    }
    [[nodiscard]] std::size_t size() const { return item_.size(); }
    [[nodiscard]] float below_us(Index c) const { return below_us_[c]; }
    [[nodiscard]] bool in_cut(Index c) const { return c < item_.size() && below_us(c) >= 0.0F; }
    [[nodiscard]] bool is_item(Index c) const { return item_[c] != none; }
    [[nodiscard]] const CutItem& item(Index c) const { return cut_.items[item_[c]]; }
    [[nodiscard]] const prepare::Candidate& candidate(Index c) const { return prepared_.candidates[c]; }
    [[nodiscard]] const prepare::Choice& choice(const CutItem& item) const { return prepared_.choices[item.choice]; }
    [[nodiscard]] CutItem coarsest(Index c) const {
        const prepare::Candidate& candidate = prepared_.candidates[c];
        return {c, candidate.node, prepared_.choices[candidate.first_choice].rep, candidate.first_choice};
    }
    /// NaN has none: what is sorted has an order.
    [[nodiscard]] float benefit(Index c) const {
        return std::max(0.0F, prepared_.choices[candidate(c).first_choice].subtree_benefit);
    }

private:
    const prepare::PreparedFrame& prepared_;
    const Cut& cut_;
    std::span<float> below_us_;
    std::span<std::uint32_t> item_;
};

/// Subtrees that fit a slice, or single items: an antichain that covers the cut. Written to the front of `room`, whose rest
/// serves as the walk's stack. Nearest to the region's centre first, because what is drawn behind costs less. What holds the eye
/// has no distance: there the most beneficial come first, and the lowest number breaks ties. distance_m: by candidate, of units.
std::span<std::uint32_t> find_units(const SelectInput& input, const CutTree& tree, float slice_us, std::span<std::uint32_t> room,
                                    std::span<float> distance_m) {
    const dvec3 eye = input.prepared->region.centre.position;
    std::size_t units = 0, bottom = room.size();
    if (tree.size() > 0) room[--bottom] = 0;
    while (bottom < room.size()) {
        const Index c = room[bottom++];
        if (!tree.in_cut(c)) continue;  // dropped
        if (tree.is_item(c) || tree.below_us(c) <= slice_us) {
            distance_m[c] = static_cast<float>(input.model->nodes[tree.candidate(c).node].box.distance(eye));
            room[units++] = c;
            continue;
        }
        const prepare::Candidate& candidate = tree.candidate(c);
        for (Index k = candidate.child_count; k-- > 0;) room[--bottom] = candidate.first_child + k;
    }
    const auto found = room.first(units);
    std::sort(found.begin(), found.end(), [&](std::uint32_t a, std::uint32_t b) {
        if (distance_m[a] != distance_m[b]) return distance_m[a] < distance_m[b];
        const float ba = tree.benefit(a), bb = tree.benefit(b);
        return ba != bb ? ba > bb : a < b;
    });
    return found;
}

/// Appends the items below `unit`, and as their stand-ins the cheapest forms of the same leaves that are no finer.
void append_unit(const CutTree& tree, Index unit, std::span<std::uint32_t> stack, Slice& slice, SlicePlan& plan) {
    std::size_t top = 0;
    stack[top++] = unit;
    while (top > 0) {
        const Index c = stack[--top];
        if (!tree.in_cut(c)) continue;
        if (tree.is_item(c)) {
            plan.order.push_back(tree.item(c));
            slice.cost += tree.choice(tree.item(c)).cost;
            continue;
        }
        const prepare::Candidate& candidate = tree.candidate(c);
        for (Index k = candidate.child_count; k-- > 0;) stack[top++] = candidate.first_child + k;
    }
    stack[top++] = unit;
    while (top > 0) {
        const Index c = stack[--top];
        if (!tree.in_cut(c)) continue;
        const prepare::Candidate& candidate = tree.candidate(c);
        if (!tree.is_item(c) && candidate.floor_open) {  // the children are no dearer than the node, but for rounding
            for (Index k = candidate.child_count; k-- > 0;) stack[top++] = candidate.first_child + k;
            continue;
        }
        plan.stand_ins.push_back(tree.coarsest(c));
        slice.stand_in_cost += tree.choice(plan.stand_ins.back()).cost;
    }
}

}  // namespace

SlicePlan::SlicePlan() : scratch_(std::make_unique<Scratch>()) {}
SlicePlan::~SlicePlan() = default;
SlicePlan::SlicePlan(SlicePlan&&) noexcept = default;
SlicePlan& SlicePlan::operator=(SlicePlan&&) noexcept = default;

void SlicePlan::reserve(std::uint32_t max_candidates) {
    slices.reserve(std::min<std::size_t>(max_candidates, max_slices));
    order.reserve(max_candidates);
    stand_ins.reserve(max_candidates);
    scratch_->below_us.resize(max_candidates);
    scratch_->distance_m.resize(max_candidates);
    for (auto* each : {&scratch_->item, &scratch_->units, &scratch_->stack}) each->resize(max_candidates);
}

void plan_slices(const SelectInput& input, const Cut& cut, double slice_us, SlicePlan& plan) {
    plan.slices.clear();
    plan.order.clear();
    plan.stand_ins.clear();
    if (cut.items.empty()) return;
    SlicePlan::Scratch& room = plan.scratch();
    if (!CHECK_RARE(cut.items.back().candidate < room.item.size(), "A cut has no more candidates than were reserved")) return;
    const Measure measure = measure_of(input.costs->combine, cut.sum);
    const float min_us = slice_us > 0.0 ? static_cast<float>(slice_us) : 1000.0F;
    const CutTree tree(*input.prepared, cut, measure, room);
    const auto units = find_units(input, tree, min_us, room.units, room.distance_m);
    float left_us = measure.of(cut.sum);
    float target_us = min_us;
    const auto next_us = [&] {
        const float wanted_us = std::min({share_of_rest * left_us, max_growth * target_us, max_stretch * min_us});
        return wanted_us > min_us ? wanted_us : min_us;  // NaN too
    };
    Slice slice;
    const auto close = [&] {
        slice.item_count = static_cast<std::uint32_t>(plan.order.size()) - slice.first_item;
        slice.stand_in_count = static_cast<std::uint32_t>(plan.stand_ins.size()) - slice.first_stand_in;
        plan.slices.push_back(slice);
        left_us -= measure.of(slice.cost);
        target_us = next_us();
        slice = {};
        slice.first_item = static_cast<std::uint32_t>(plan.order.size());
        slice.first_stand_in = static_cast<std::uint32_t>(plan.stand_ins.size());
    };
    for (std::size_t i = 0; i < units.size(); ++i) {
        append_unit(tree, units[i], room.stack, slice, plan);
        // Every slice but the last reaches min_us, so their number is at most 1 + total / slice_us, as the budget counts.
        const bool full = measure.of(slice.cost) >= target_us && plan.slices.size() + 1 < plan.slices.capacity();
        if (full || i + 1 == units.size()) close();
    }
    (void)CHECK_RARE(plan.order.size() == cut.items.size(), "The slices hold every item of the cut once");
}

namespace {

/// How much longer than predicted a frame takes whose finished part took `finished_us`: 1..8, 8 if it is unknown.
double wrong_by(const CheckInput& input, double finished_us) {
    const double after_us = input.rest_stand_in_us + input.last_us;
    const double rest_us = std::isfinite(after_us) ? std::max(after_us, 0.0) : 0.0;
    const double time_left = std::clamp(1.0 - input.elapsed_us / input.limit_us, 0.0, 1.0);  // NaN stays one: does not fit
    const double prior_us = 0.05 * input.limit_us + 0.5 * rest_us * time_left;
    const double predicted_us = std::max(input.predicted_so_far_us - input.in_flight_us, 0.0);
    const double wrong = (finished_us + prior_us) / (predicted_us + prior_us);
    return std::clamp(std::isfinite(wrong) ? wrong : 8.0, 1.0, 8.0);
}

/// What is in flight counts as predicted: it says nothing of how wrong the frame is, and may be as wrong.
double end_us(const CheckInput& input, double factor, double last_factor) {
    const double finished_us = input.elapsed_us - input.in_flight_us;
    return finished_us + input.in_flight_us * factor + (input.next_us + input.rest_stand_in_us) * factor * input.margin +
           input.last_us * last_factor * input.margin;
}

}  // namespace

double forecast_us(const CheckInput& input) {
    const double predicted_us = std::max(input.predicted_so_far_us - input.in_flight_us, 0.0);
    const double usual = wrong_by(input, std::max(input.usual_head, 1.0) * predicted_us);
    const double wrong = wrong_by(input, input.elapsed_us - input.in_flight_us);
    const double unusual = std::max(wrong / usual, 1.0);
    return end_us(input, unusual * std::max(input.usual_tail, 1.0), unusual);
}

bool still_fits(const CheckInput& input) {
    if (input.next_stand_in_us >= input.next_us) return true;   // the stand-in would gain nothing
    if (!(forecast_us(input) <= input.limit_us)) return false;  // NaN: does not fit
    const double wrong = wrong_by(input, input.elapsed_us - input.in_flight_us);
    return end_us(input, wrong, wrong) <= std::max(input.deadline_us, input.limit_us);
}

}  // namespace surefoot::select
