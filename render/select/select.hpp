// From candidates and one budget to a cut: the interface of selectors, slices, and the in-frame check.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/model.hpp"
#include "render/prepare/prepared.hpp"
#include "render/select/item.hpp"
#include "rt/base/modes.hpp"

namespace surefoot::select {

using model::Index;
using model::none;

/// An item of a cut: a node and the representation chosen for it.
struct CutItem {
    Index candidate = 0;
    Index node = 0;
    Index rep = 0;
    Index choice = 0;  ///< in PreparedFrame::choices
};

/// Visible objects that a cut leaves out. Only the selectors of dropping_selectors() do that.
struct Dropped {
    std::uint32_t count = 0;
    float error_rad = 0;     ///< the largest angle under which one would be seen
    float weighted_rad = 0;  ///< the largest of these angles times importance
    Index node = none;       ///< of weighted_rad
};

/// The chosen items, in candidate order. Legal: every visible leaf is covered exactly once, or counted as dropped.
struct Cut {
    std::vector<CutItem> items;                     ///< reserved; never grows after
    model::ItemCost sum;                            ///< over items
    float predicted_us = 0;                         ///< whole frame, with correction and headroom
    float floor_us = 0;                             ///< of the cheapest legal cut
    bool floor_binds = false;                       ///< floor_us > budget: the floor is drawn
    float worst_error_rad = 0;                      ///< 1 / accuracy
    float worst_weighted_rad = 0;                   ///< the same of errors times importance: what is guaranteed
    rt::Guarantee guarantee = rt::Guarantee::none;  ///< of max_error_rad: kept, or why not
    double benefit = 0;  ///< sum over items of 1 - benefit of the next finer step; 0..items, items: nothing is left to gain
    double value = 0;    ///< sum over items, weighted pixels; PreparedFrame::full_value: nothing is left to gain
    Dropped dropped;
    BoughtItems bought;  ///< beside the forms; in predicted_us, not in sum and value
    std::uint64_t triangles = 0;
    std::uint32_t switches = 0;     ///< representations that differ from the previous frame's
    std::uint64_t hash = 0;         ///< of (node, rep) in order
    std::uint32_t refinements = 0;  ///< steps taken
};

/// What a cluster's benefit is in the published searches; benefit_model.hpp names them.
enum class BenefitModel : std::uint8_t { surefoot, distance_centre, distance_vertex, distance_point, subtree_max };

/// All that a selection depends on, besides SelectState.
struct SelectInput {
    const model::Model* model = nullptr;
    const prepare::PreparedFrame* prepared = nullptr;
    const model::CostModel* costs = nullptr;
    double budget_us = 0;             ///< whole frame; infinity: full detail
    double correction = 1;            ///< online factor on predictions
    double target_error_rad = 0;      ///< stop refining at this error; 0: refine as far as the budget goes
    double slice_us = 1000;           ///< of the shortest slices; the prediction counts as if all were so short
    double headroom = 0;              ///< headroom on corrected predictions; 0: that of the cost table
    const ItemList* items = nullptr;  ///< what else may be bought; null: nothing
    double max_error_rad = 0;         ///< bought first: no error times importance is more, if the budget allows; 0: none
    BenefitModel benefit = BenefitModel::surefoot;  ///< of the 1994 searches; others go by their own
    double last_frame_us = 0;                       ///< how long the last frame took; 0: unknown. For `reactive`
    double beside_us = 0;                           ///< spent already beside the forms: pictures of the image cache
};

inline double headroom_of(const SelectInput& input) {
    return input.headroom > 0 ? input.headroom : static_cast<double>(input.costs->headroom);
}

/// The last state of a node: a representation, or SelectState::opened.
struct Shown {
    Index node = 0;
    Index form = 0;
};

/// Kept by the frame thread between frames: what was shown, for hysteresis and switches, and scratch memory. Sized once.
struct SelectState {
    static constexpr Index opened = none - 1;
    std::vector<Index> shown;    ///< by node: its representation in the last cut, `opened` if descendants were in it, or none
    std::vector<Shown> touched;  ///< all nodes with `shown` other than none
    std::vector<Shown> before;   ///< `touched` before the last selection; allows to repeat it
    RememberedItems bought, bought_before;  ///< by the last selection, and by the one before it
    /// Factor 1..2 on the benefit of nodes that were refined in the last frame; 1: no hysteresis.
    float hysteresis = 1.25F;
    /// With hysteresis: share of the budget that steps of the last frame alone may use, 0..1. The rest of the frame's budget
    /// serves all steps.
    float reserve_share = 0.03F;
    double size_factor = 1;  ///< of `reactive`: on its size threshold

    struct Scratch;  ///< private to the searches
    SelectState();
    ~SelectState();
    SelectState(SelectState&&) noexcept;
    SelectState& operator=(SelectState&&) noexcept;
    void reserve(const model::Model& model, std::uint32_t max_candidates);
    [[nodiscard]] std::uint32_t max_candidates() const;  ///< as reserved
    [[nodiscard]] Scratch& scratch() { return *scratch_; }

private:
    std::unique_ptr<Scratch> scratch_;
};

/// A selector allocates nothing and is a pure function of its arguments. registry.hpp lists them by name.
class Selector {
public:
    virtual ~Selector() = default;
    virtual void run(const SelectInput& input, SelectState& state, Cut& cut) const = 0;
};

void reserve(Cut& cut, std::uint32_t max_candidates);

/// Checks that the cut is legal over the prepared frame: no ancestor with its descendant, every visible leaf covered once.
/// Returns an empty string, or the first problem. For tests and the self test.
std::string check_legal(const prepare::PreparedFrame& prepared, const Cut& cut);

// ---- slices: subtree by subtree, each with a coarser stand-in ----

/// Items that are submitted together: [first_item, +item_count) of SlicePlan::order. Or instead their stand-ins:
/// [first_stand_in, +stand_in_count) of SlicePlan::stand_ins, the cheapest forms of the same leaves that are no finer.
struct Slice {
    std::uint32_t first_item = 0, item_count = 0;
    std::uint32_t first_stand_in = 0, stand_in_count = 0;
    model::ItemCost cost, stand_in_cost;
};

/// The cut, grouped into slices.
struct SlicePlan {
    std::vector<Slice> slices;   ///< in submission order: nearest subtrees first
    std::vector<CutItem> order;  ///< the cut's items, grouped by slice
    std::vector<CutItem> stand_ins;

    struct Scratch;  ///< private to plan_slices()
    SlicePlan();
    ~SlicePlan();
    SlicePlan(SlicePlan&&) noexcept;
    SlicePlan& operator=(SlicePlan&&) noexcept;
    void reserve(std::uint32_t max_candidates);
    [[nodiscard]] Scratch& scratch() { return *scratch_; }

private:
    std::unique_ptr<Scratch> scratch_;
};

/// Groups the cut into slices, nearest first. The first takes slice_us; the others up to twice the one before, an eighth of what
/// is left, and four times slice_us. The last subtree of a slice may exceed this. Lengths are before correction. Allocates
/// nothing.
void plan_slices(const SelectInput& input, const Cut& cut, double slice_us, SlicePlan& plan);

/// Input of the in-frame check: whether the next slice may still be drawn in full. It may, as long as all slices after it would
/// still fit as stand-ins. So a frame loses detail from its far end, by whole slices.
/// (Testing whether the rest fits in full would draw most of a frame coarse for an error of a few per cent.)
struct CheckInput {
    double elapsed_us = 0;           ///< since the frame was due, work in flight included
    double predicted_so_far_us = 0;  ///< of the slices drawn in that time
    double in_flight_us = 0;         ///< part of both: predicted, not finished yet
    double next_us = 0;              ///< the next slice in full, with headroom
    double next_stand_in_us = 0;     ///< the next slice as its stand-in
    double rest_stand_in_us = 0;     ///< all slices after it as stand-ins, expected
    double last_us = 0;              ///< after all slices, expected; timed by itself, so that the usual tail is without it
    double limit_us = 0;             ///< when the frame should be done
    double deadline_us = 0;          ///< when it is late; below the limit it counts as the limit
    double margin = 1.0;             ///< factor on top of the headroom
    double usual_head = 1.0;         ///< FrameProfile::Usual of the frames before, at this point; below 1 counts as 1
    double usual_tail = 1.0;
};
/// When the frame would end, us since it was due, if the slice is drawn in full and all after it as stand-ins. NaN: unknown.
/// Predictions are multiplied by a factor of 1..8: elapsed / predicted time of what is finished. A few early slices must not
/// decide alone. So a prior time is added to both: 1/20 of the limit, and half of the rest's cost times the share of time left.
/// The factor is divided by what it would be for a usual frame, down to 1, and multiplied by the usual tail. What comes last
/// is not multiplied by that: it belongs to slices.
double forecast_us(const CheckInput& input);
/// True: draw the slice in full. False: draw this and all later slices as stand-ins. Pure. The forecast has to be within the
/// limit. What it would be without the usual figures has to be within the deadline: frames are forgiven no more than that.
bool still_fits(const CheckInput& input);

}  // namespace surefoot::select
