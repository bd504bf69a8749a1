// The value of each choice, which adds up over a cut, and the rate at which its next step buys value.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/model/loss_groups.hpp"
#include "render/prepare/before_sky.hpp"
#include "render/prepare/evaluate.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// How far the forms' pictures are off full detail, as the bake measured it.
struct Looks {
    std::span<const model::PictureLoss> losses;     ///< by form; empty: not measured
    float of_missing = 1;                           ///< colour loss of a missing thing, on average
    const model::LossGroups* groups = nullptr;      ///< null: forms lose the same on all that they show
    std::span<const model::LossOfGroup> of_groups;  ///< as Model::group_losses
    std::span<const model::Node> nodes;
    float before_sky = 1;                  ///< what a missing thing loses before the sky, as a multiple of that; 1 or more
    std::span<const float> forgiven = {};  ///< by node, 0..1: share of g that does not count; empty: all counts
};
/// sky: its colour, 0..1. groups: of this model, and they must outlive the result; null: forms lose the same on all they show.
Looks looks_of(const model::Model& model, const std::array<float, 3>& sky, const model::LossGroups* groups = nullptr);

/// Fills Choice::value, Choice::rate and PreparedFrame::full_value.
///
/// value = W * (1 - g) + (K - 1) * (S' - S * u). W of a leaf: the pixels that it shows (ShownPixels) * importance * focus *
/// motion. W of a node: the sum of its leaves'. S: those of W with nothing but the sky behind the node, u: the share of
/// pixels that the choice covers wrongly, measured. S' is of the leaves, in any node below the root. K: Looks::before_sky.
/// g, 0..1: how wrong the choice looks. A twentieth is by its error in pixels. The rest is the measured loss at
/// the node's size on the screen, as a share of what a missing thing loses. For a cluster it is the mean over groups of leaves,
/// by the W of each. What is in no known group counts by the form's whole loss. Nearer than was measured, an error in pixels
/// counts more. Without losses, a quarter is by the error in pixels. Then the rest is the share of the leaves' surface that the
/// choice lacks: a fence that is missing, a tree that is a shard. Looks::forgiven lowers g.
///
/// rate = value per us of the next step, where a step into the children counts all that follows below at that rate. It is the
/// slope of the upper convex hull of (cost, value), for one node and for whole subtrees. Rates fall along the choices of a
/// candidate and down the tree. So all steps with a rate of at least r make the cut of the greatest value - r * cost. This holds
/// to the resolution of the levels below. Source: Lagrange multipliers for choices under one budget, Everett 1963.
class ValuePass {
public:
    /// Rates are told apart by octaves while they are summed up: from 2^20 down to 2^-19 px/us.
    static constexpr std::uint32_t levels = value_levels;

    /// Reserves for this many candidates, and choices where losses of groups are known. run() allocates nothing below that.
    void reserve(std::uint32_t max_candidates, std::size_t max_choices = 0);
    /// weights: one a candidate, as Evaluator::evaluate made them. Call it before propagate_up(), which replaces them.
    /// shown_px: one a candidate, read of leaves alone.
    void run(const model::FrameCombine& combine, float resolved_rad, std::span<const Weight> weights,
             std::span<const float> shown_px, PreparedFrame& frame, const Looks& looks = {}, const SkyPixels& sky = {});

private:
    struct Sums {
        float weight = 0;            ///< W, px
        float sky = 0;               ///< of these, before nothing but the sky
        float full = 0;              ///< value of full detail, px
        float grouped = 0;           ///< of W: in groups whose losses are known
        float surface_px = 0;        ///< of the leaves' finest choices, overdraw included
        float weight_per_m = 0;      ///< sum of W / distance of the leaves
        std::uint32_t curve = none;  ///< of the children, while they are summed up; none: not yet
    };
    /// By level of the rate. While children are added: the change of value and cost at that level. Then: the best cut's.
    struct Curve {
        std::array<float, levels> value, cost;
    };
    /// One candidate's choices, with the offsets of those on their hull.
    struct OwnChoices {
        const model::FrameCombine& combine;
        std::span<Choice> choices;
        std::span<const std::uint32_t> hull;
        [[nodiscard]] float cost(std::uint32_t k) const { return cost_metric(combine, choices[k].cost); }
    };
    std::uint32_t take_curve();
    void add(Index parent, std::uint32_t level, float value, float cost);
    void set_values(std::size_t i, float resolved_rad, const Weight& seen, float shown_px, PreparedFrame& frame,
                    const Looks& looks, const SkyPixels& sky);
    void add_to_groups(std::size_t i, const PreparedFrame& frame, const Looks& looks);
    void add_own(const Candidate& candidate, const OwnChoices& own);
    static void own_curve(const OwnChoices& own, ValueCurve& curve);
    void merge_curve(Index parent, Curve& curve, const OwnChoices& own);
    static void set_opening_rate(std::uint32_t level, float value, float cost, const OwnChoices& own);
    static void enforce_falling_rates(PreparedFrame& frame);

    std::vector<Sums> sums_;
    std::vector<model::LossOfGroup> lost_;  ///< by choice: W of its groups, times their losses
    std::vector<Curve> curves_;
    std::vector<std::uint32_t> free_;
};

/// Weights for prepared frames that were stored without values: pixels and errors alone.
void estimate_values(const model::FrameCombine& combine, PreparedFrame& frame);

}  // namespace surefoot::prepare
