// The selectors that leave objects out: `greedy`, `static` and `reactive`. They choose no groups: an object is a visible node
// that preparation did not open, and it is drawn in one of its own forms or not at all. That is a leaf, or a cluster so far away
// that its error is not seen. For comparison only; no service runs them.
#include <algorithm>
#include <cmath>
#include <limits>

#include "render/model/view.hpp"
#include "render/select/bucket_queue.hpp"
#include "render/select/common_error.hpp"
#include "render/select/cut_builder.hpp"
#include "render/select/entries.hpp"
#include "render/select/scratch.hpp"

namespace surefoot::select {

namespace {

constexpr double largest_missing_rad = 1e6;

/// The angle of what is missing where an object should be: its box's diagonal over the nearest distance of an eye.
float missing_error_rad(const SelectInput& input, const Box& box) {
    const prepare::Region& region = input.prepared->region;
    const double distance = std::max(box.distance(region.centre.position) - region.radius_m, model::near_plane_m);
    return static_cast<float>(std::min(glm::length(box.max - box.min) / distance, largest_missing_rad));
}

/// Opens every group; shows nothing.
void drop_all(CutBuilder& builder) {
    builder.take_floor();  // for its cost
    for (Index c = 0; c < builder.size(); ++c) {
        if (builder.candidate(c).child_count > 0)
            builder.open(c);
        else
            builder.choose(c, none);
    }
}

void finish_dropping(const SelectInput& input, CutBuilder& builder, Budget& budget, std::uint32_t steps, Cut& cut) {
    builder.finish(budget, steps, cut);
    for (Index c = 0; c < builder.size(); ++c) {
        if (builder.chosen(c) != none) continue;
        const prepare::Candidate& object = builder.candidate(c);
        const float error_rad = missing_error_rad(input, input.model->nodes[object.node].box);
        ++cut.dropped.count;
        cut.dropped.error_rad = std::max(cut.dropped.error_rad, error_rad);
        if (!(error_rad * object.importance > cut.dropped.weighted_rad)) continue;
        cut.dropped.weighted_rad = error_rad * object.importance;
        cut.dropped.node = object.node;
    }
    cut.worst_error_rad = std::max(cut.worst_error_rad, cut.dropped.error_rad);
    cut.worst_weighted_rad = std::max(cut.worst_weighted_rad, cut.dropped.weighted_rad);
}

/// Funkhouser and Sequin 1993, as Maciel 1994, 2.2.2, has it: pairs of an object and one of its forms, the greatest value per us
/// first, until the budget is spent. Of an object's pairs the finest that was taken counts. A pair that does not fit, or has no
/// value, is passed over; objects of which none is taken are not drawn. Values per us that differ by less than 0.8 % count as
/// equal. The tuple's third member, the rendering, is the frame's: items of effects stand in the same order.
class Greedy final : public Selector {
public:
    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        clear(cut);
        if (!has_room(input, state, cut)) return;
        Budget budget(input);
        CutBuilder builder(input, state);
        builder.buy_items_of(0, budget);
        builder.put_items_in_order();
        drop_all(builder);
        const float unit = greatest_rate(builder, budget);
        BucketQueue queue(state.scratch().queue_heads, state.scratch().links);
        const auto next = builder.scratch();  // by candidate: the form that is tried next
        const auto push = [&](Index c, float below, std::uint32_t after) {
            next[c] = next_pair(builder, budget, c, below, after);
            if (next[c] != none) queue.push(rate(budget, builder.choices(c)[next[c]]) / unit, c);
        };
        for (Index c = 0; c < builder.size(); ++c)
            if (builder.candidate(c).child_count == 0) push(c, std::numeric_limits<float>::infinity(), none);
        Sum total;
        std::uint32_t taken = 0;
        while (!queue.empty()) {
            const Index c = queue.pop();
            const std::uint32_t form = next[c], now = builder.chosen(c);
            const prepare::Choice& choice = builder.choices(c)[form];
            builder.buy_items_down_to(rate(budget, choice), total, budget);
            const Sum with = total.changed(now == none ? model::ItemCost{} : builder.choices(c)[now].cost, choice.cost);
            if ((now == none || choice.value > builder.choices(c)[now].value) && budget.fits(with)) {
                total = with;
                builder.choose(c, form);
                ++taken;
            }
            push(c, rate(budget, choice), form);
        }
        builder.buy_items_down_to(0.0F, total, budget);
        finish_dropping(input, builder, budget, taken, cut);
    }

private:
    static float rate(const Budget& budget, const prepare::Choice& choice) {
        Sum sum;
        sum.add(choice.cost);
        const double cost_us = budget.items_us(sum);
        if (!(choice.value > 0.0F) || !std::isfinite(cost_us)) return 0.0F;
        return static_cast<float>(static_cast<double>(choice.value) / std::max(cost_us, 1e-6));
    }
    static float greatest_rate(const CutBuilder& builder, const Budget& budget) {
        float greatest = 0;
        for (Index c = 0; c < builder.size(); ++c)
            if (builder.candidate(c).child_count == 0)
                for (const prepare::Choice& choice : builder.choices(c)) greatest = std::max(greatest, rate(budget, choice));
        return greatest > 0.0F ? greatest : 1.0F;
    }
    /// The form with the greatest rate after (below, after); of equal rates the coarser one first. None: there is no more.
    static std::uint32_t next_pair(const CutBuilder& builder, const Budget& budget, Index c, float below, std::uint32_t after) {
        const auto choices = builder.choices(c);
        std::uint32_t best = none;
        float best_rate = 0;
        for (std::uint32_t k = 0; k < choices.size(); ++k) {
            const float r = rate(budget, choices[k]);
            const bool is_after = r < below || (r == below && after != none && k > after);
            if (!is_after || !(r > best_rate)) continue;
            best = k;
            best_rate = r;
        }
        return best;
    }
};

/// Two thresholds, as Maciel 1994, 2.2.2, has them: an object takes the finest form whose average face covers enough pixels,
/// and fast ones need larger faces. What covers less than a face in its coarsest form is not drawn.
class BySize final : public Selector {
public:
    explicit BySize(bool reacts) : reacts_(reacts) {}

    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        clear(cut);
        if (!has_room(input, state, cut)) return;
        Budget budget(input);
        CutBuilder builder(input, state);
        builder.buy_all_items(budget);
        drop_all(builder);
        const prepare::Region& region = input.prepared->region;
        const double pixel = model::pixel_angle(region.centre, input.prepared->viewport);
        const double side_px = input.target_error_rad > 0.0 ? input.target_error_rad / pixel : default_threshold_px;
        double face_px = side_px * side_px;
        if (reacts_) face_px *= react(input, state);
        std::uint32_t shown = 0;
        for (Index c = 0; c < builder.size(); ++c) {
            const prepare::Candidate& object = builder.candidate(c);
            if (object.child_count > 0) continue;
            const double away =
                std::max(input.model->nodes[object.node].box.distance(region.centre.position), model::near_plane_m);
            const double moved_px = (region.radius_m / away + region.angle_rad) / pixel;
            const std::uint32_t form = finest_of(builder, c, face_px * (1.0 + moved_px / usual_move_px));
            builder.choose(c, form);
            if (form != none) ++shown;
        }
        finish_dropping(input, builder, budget, shown, cut);
    }

private:
    static constexpr double usual_move_px =
        100;  ///< an object that moves so far while the set is in use needs faces twice as large

    static std::uint32_t finest_of(const CutBuilder& builder, Index c, double face_px) {
        const auto choices = builder.choices(c);
        const auto pixels = static_cast<double>(builder.candidate(c).pixels);
        for (auto k = static_cast<std::uint32_t>(choices.size()); k-- > 0;)
            if (pixels >= face_px * std::max(1U, choices[k].triangles)) return k;
        return pixels >= face_px ? 0 : none;
    }
    /// "Based on the time needed to render the previous scene": the threshold grows by last time / budget.
    static double react(const SelectInput& input, SelectState& state) {
        constexpr double smallest = 1.0 / 64, largest = 1e6, quickest = 4;
        if (input.last_frame_us > 0.0 && input.budget_us > 0.0 && std::isfinite(input.budget_us)) {
            const double step = std::clamp(input.last_frame_us / input.budget_us, 1 / quickest, quickest);
            state.size_factor = std::clamp(state.size_factor * step, smallest, largest);
        }
        return state.size_factor;
    }

    bool reacts_;
};

const Selector& make_greedy() {
    static const Greedy selector;
    return selector;
}
template <bool reacts>
const Selector& make_by_size() {
    static const BySize selector(reacts);
    return selector;
}

}  // namespace

const SelectorEntry greedy_entry{"greedy", "the greatest value per us first, without groups (Funkhouser and Sequin 1993)",
                                 GoesBy::budget, false, make_greedy};
const SelectorEntry static_entry{"static", "fixed thresholds on the size of faces and on speed; no budget", GoesBy::threshold,
                                 false, make_by_size<false>};
const SelectorEntry reactive_entry{"reactive",
                                   "the same, its size threshold steered by the time of the frame before",
                                   GoesBy::threshold,
                                   false,
                                   make_by_size<true>,
                                   false,
                                   true};

}  // namespace surefoot::select
