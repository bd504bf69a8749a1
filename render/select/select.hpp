// From candidates and one budget to a cut: the selectors behind one interface, their accounting, their bound.
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

namespace surefoot::select {

using model::Index;
using model::none;

struct CutItem {
    Index candidate = 0;
    Index node = 0;
    Index rep = 0;
    Index choice = 0;  ///< in PreparedFrame::choices
};

/// The chosen set (DESIGN 4). items is in candidate order of the selector's tree walk; legal: every visible leaf covered once.
struct Cut {
    std::vector<CutItem> items;  ///< reserved; never grows after
    model::ItemCost sum;         ///< over items
    float predicted_us = 0;      ///< whole frame, combined and corrected, at the upper quantile
    float floor_us = 0;          ///< the cheapest legal cut's
    bool floor_binds = false;    ///< floor_us > budget: the floor is drawn
    float worst_error_rad = 0;   ///< 1 / accuracy
    double benefit = 0;          ///< sum over items of what is shown, 0..items
    std::uint64_t triangles = 0;
    std::uint32_t switches = 0;     ///< representations that differ from the previous frame's
    std::uint64_t hash = 0;         ///< of (node, rep) in order
    std::uint32_t refinements = 0;  ///< upgrades bought
};

struct SelectInput {
    const model::Model* model = nullptr;
    const prepare::PreparedFrame* prepared = nullptr;
    const model::CostModel* costs = nullptr;
    double budget_us = 0;         ///< whole frame; infinity: full detail
    double correction = 1;        ///< online factor on predictions
    double target_error_rad = 0;  ///< stop refining below it (0: refine as far as the budget goes)
    double slice_us = 1000;       ///< predicted length of a slice: what ending the slices costs is in the prediction
    double upper_factor = 0;      ///< from a corrected prediction to the upper quantile that the budget spends; 0: the table's
};

inline double upper_factor_of(const SelectInput& input) {
    return input.upper_factor > 0 ? input.upper_factor : static_cast<double>(input.costs->upper_factor);
}

/// What was shown of a node: a representation, or SelectState::opened.
struct Shown {
    Index node = 0;
    Index form = 0;
};

/// Kept by the frame thread between frames, sized once: what was shown, for hysteresis and switches; room for the searches.
struct SelectState {
    static constexpr Index opened = none - 1;
    std::vector<Index> shown;    ///< a node: representation in the last cut, `opened` if that was among its descendants, or none
    std::vector<Shown> touched;  ///< nodes whose `shown` is not none, and what it is
    std::vector<Shown> before;   ///< `touched` as the last selection found it: with it, that selection can be repeated
    /// Benefit factor, 1..2, for what was refined in the last frame; 1: no memory.
    float hysteresis = 1.25F;

    struct Scratch;  ///< the searches' own
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

/// A selector allocates nothing, and is a pure function of its arguments. registry.hpp has them by name.
class Selector {
public:
    virtual ~Selector() = default;
    virtual void run(const SelectInput& input, SelectState& state, Cut& cut) const = 0;
};

void reserve(Cut& cut, std::uint32_t max_candidates);

/// Checks that the cut is legal over the prepared frame: no ancestor with its descendant, every visible leaf covered once.
/// Returns an empty string, or what is wrong. For tests and `--strict`.
std::string check_legal(const prepare::PreparedFrame& prepared, const Cut& cut);

// ---- slices: subtree by subtree, each with a coarser stand-in (DESIGN 1.2) ----

/// Items [first_item, +item_count) of SlicePlan::order are drawn, or instead the stand-in items
/// [first_stand_in, +stand_in_count) of SlicePlan::stand_ins: the coarsest legal cover of the same leaves.
struct Slice {
    std::uint32_t first_item = 0, item_count = 0;
    std::uint32_t first_stand_in = 0, stand_in_count = 0;
    model::ItemCost cost, stand_in_cost;
};

struct SlicePlan {
    std::vector<Slice> slices;   ///< in submission order: most beneficial (nearest) subtrees first
    std::vector<CutItem> order;  ///< the cut's items, grouped by slice
    std::vector<CutItem> stand_ins;

    struct Scratch;  ///< plan_slices's own
    SlicePlan();
    ~SlicePlan();
    SlicePlan(SlicePlan&&) noexcept;
    SlicePlan& operator=(SlicePlan&&) noexcept;
    void reserve(std::uint32_t max_candidates);
    [[nodiscard]] Scratch& scratch() { return *scratch_; }

private:
    std::unique_ptr<Scratch> scratch_;
};

/// Groups the cut into slices of about slice_us predicted each. Allocates nothing.
void plan_slices(const SelectInput& input, const Cut& cut, double slice_us, SlicePlan& plan);

/// In-frame check, a pure function: whether the next slice may still be drawn in full. It may while, after it, all that is
/// left would fit as stand-ins: the frame then degrades from its least beneficial end, and no earlier than it must. (DESIGN
/// 1.2 would stop as soon as the rest in full no longer fits: that drew most of a frame coarse for an error of a few per cent.)
struct CheckInput {
    double elapsed_us = 0;           ///< since the frame was due, work in flight included
    double predicted_so_far_us = 0;  ///< for what was drawn in that time
    double next_us = 0;              ///< the next slice in full, at the upper quantile
    double next_stand_in_us = 0;     ///< the next slice as its stand-in
    double rest_stand_in_us = 0;     ///< all slices after it as stand-ins, expected
    double limit_us = 0;             ///< when the frame must be done
    double margin = 1.0;             ///< on top of the upper quantile
};
/// true: draw it in full; false: draw this and every later slice by its stand-ins. The predictions are scaled by how wrong the
/// frame has been so far (1..8; a twentieth of the limit, and of the rest a half that melts with the time left, are taken as
/// seen and right, so that the first slices do not speak for all).
bool still_fits(const CheckInput& input);

}  // namespace surefoot::select
