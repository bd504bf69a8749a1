// Values and rates: one pass up the tree, one down.
#include "render/prepare/value.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "rt/base/check.hpp"

namespace surefoot::prepare {

namespace {

constexpr float top_rate = 0x1p20F;      // px/us, of level 0
constexpr std::size_t max_on_hull = 32;  // of one candidate on its hull; more are left out of it

/// 0..1. What is out of the view has no surface there: only its error counts.
float looks_right(float error_px, float surface_px, float leaves_surface_px) {
    constexpr float of_error = 0.25F;
    const float error =
        error_px / (error_px + 256.0F);  // nearly linear up to a hundred pixels: twice the error is twice as wrong
    const float lacks = leaves_surface_px > 0.0F ? std::clamp(1.0F - surface_px / leaves_surface_px, 0.0F, 1.0F) : 0.0F;
    return 1.0F - of_error * error - (1.0F - of_error) * lacks;
}

/// 0..0.5: losses are measured from outside. Of a form that is off by more than its distance, half of the pixels show other
/// things.
float elsewhere(float error_rad) { return 0.5F * error_rad * error_rad / (1.0F + error_rad * error_rad); }

/// 0..1, by the measured loss. What is out of the view looks as in it.
float looks_right_measured(float error_px, float error_rad, float loss, float of_missing, float size_px) {
    constexpr float of_shift = 0.12F, half_shifted_px = 16.0F;  // what is nearer than was measured: its texture has moved
    constexpr float of_error = 0.05F;
    const float nearer = std::max(0.0F, 1.0F - model::loss_sizes_px[0] / size_px);
    const float shifted = of_shift * nearer * error_px / (error_px + half_shifted_px);
    const float lost = std::max(std::clamp(loss / of_missing, 0.0F, 1.0F), elsewhere(error_rad));
    return 1.0F - of_error * error_px / (error_px + 256.0F) - (1.0F - of_error) * (lost + (1.0F - lost) * shifted);
}

float rate_of(std::uint32_t level) { return std::ldexp(top_rate, -static_cast<int>(level)); }

/// The first level whose rate is at most `rate`.
std::uint32_t level_of(float rate) {
    if (!(rate < top_rate)) return 0;
    if (!(rate > 0.0F)) return ValuePass::levels;
    int exponent = 0;
    std::frexp(rate, &exponent);  // rate = m * 2^exponent, m in [0.5, 1)
    return static_cast<std::uint32_t>(std::min(20 - (exponent - 1), static_cast<int>(ValuePass::levels)));
}

/// Value of a step by its cost. A step that costs nothing is taken at any rate.
float slope(float value, float cost) {
    if (!(value > 0.0F)) return 0.0F;
    return cost > 0.0F ? std::min(value / cost, std::numeric_limits<float>::max()) : std::numeric_limits<float>::max();
}

/// The upper convex hull of a candidate's choices. Fills the rates; returns the offsets of the choices on the hull.
std::span<const std::uint32_t> hull_of(const model::FrameCombine& combine, std::span<Choice> choices,
                                       std::array<std::uint32_t, max_on_hull>& on) {
    std::size_t count = 0;
    const auto between = [&](std::uint32_t a, std::uint32_t b) {
        return slope(choices[b].value - choices[a].value,
                     cost_metric(combine, choices[b].cost) - cost_metric(combine, choices[a].cost));
    };
    for (std::uint32_t k = 0; k < choices.size(); ++k) {
        while (count > 1 && between(on[count - 2], on[count - 1]) <= between(on[count - 1], k)) --count;
        if (count == on.size()) --count;
        on[count++] = k;
    }
    for (std::size_t i = 0; i + 1 < count; ++i) {
        const float rate = between(on[i], on[i + 1]);
        for (std::uint32_t k = on[i]; k < on[i + 1]; ++k) choices[k].rate = rate;
    }
    choices.back().rate = 0.0F;
    return std::span(on).first(count);
}

}  // namespace

/// Two colours of the model that have nothing to do with each other differ by twice the variance, in square.
Looks looks_of(const model::Model& model, const std::array<float, 3>& sky, const model::LossGroups* groups) {
    constexpr float min_variance = 0.005F;  // of a model of one colour
    const float variance = std::max(model.colours.variance, min_variance);
    float apart = 0;
    for (std::size_t i = 0; i < sky.size(); ++i) {
        const float difference = sky[i] - model.colours.mean[i];
        apart += difference * difference / static_cast<float>(sky.size());
    }
    const float before_sky = model.losses.empty() ? 1.0F : std::max(1.0F, (apart + variance) / (2.0F * variance));
    Looks looks;
    looks.losses = model.losses;
    looks.of_missing = 2.0F * variance;
    looks.before_sky = before_sky;
    if (groups == nullptr || model.group_losses.empty()) return looks;
    looks.groups = groups;
    looks.of_groups = model.group_losses;
    looks.nodes = model.nodes;
    return looks;
}

float ValueCurve::value_at(float cost_us) const {
    if (!(cost_us >= cost[0])) return value[0];  // the floor is always drawn
    for (std::uint32_t level = 1; level < value_levels; ++level) {
        if (cost_us >= cost[level]) continue;
        const float step = cost[level] - cost[level - 1];
        return value[level - 1] + (value[level] - value[level - 1]) * (step > 0.0F ? (cost_us - cost[level - 1]) / step : 1.0F);
    }
    return value.back();
}

void ValuePass::reserve(std::uint32_t max_candidates, std::size_t max_choices) {
    sums_.resize(max_candidates);
    lost_.resize(max_choices);
    // Curves are held for one level of the tree at a time, and only for nodes that have children in the frame.
    const std::uint32_t curves = std::min(max_candidates / 2 + 1, 1U << 15U);
    curves_.resize(curves);
    free_.reserve(curves);
}

std::uint32_t ValuePass::take_curve() {
    if (free_.empty()) return none;
    const std::uint32_t at = free_.back();
    free_.pop_back();
    curves_[at] = {};
    return at;
}

void ValuePass::add(Index parent, std::uint32_t level, float value, float cost) {
    if (parent == none || level >= levels) return;
    Sums& above = sums_[parent];
    if (above.curve == none) above.curve = take_curve();
    if (above.curve == none) return;  // too many at once: the parent counts as a leaf
    curves_[above.curve].value[level] += value;
    curves_[above.curve].cost[level] += cost;
}

/// What a leaf weighs, and the value of each choice of a candidate.
void ValuePass::set_values(std::size_t i, float resolved_rad, const Weight& seen, float shown_px, PreparedFrame& frame,
                           const Looks& looks, const SkyPixels& sky) {
    const Candidate& candidate = frame.candidates[i];
    Sums& sums = sums_[i];
    const float more = looks.before_sky - 1.0F;  // than before other things
    if (candidate.child_count == 0) {
        sums.weight = seen.pixel_weight * shown_px;
        sums.surface_px = frame.choices[candidate.first_choice + candidate.choice_count - 1].surface_px;
        sums.weight_per_m = sums.weight / seen.distance_m;
        sums.full = sums.weight + (sky.of_leaf.empty() ? 0.0F : more * seen.pixel_weight * sky.of_leaf[i]);
    }
    if (!sky.at.empty()) sums.sky += sky.at[i];
    if (candidate.parent != none) {
        sums_[candidate.parent].weight += sums.weight;
        sums_[candidate.parent].sky += sums.sky;
        sums_[candidate.parent].full += sums.full;
        sums_[candidate.parent].weight_per_m += sums.weight_per_m;
        sums_[candidate.parent].surface_px += sums.surface_px;
    }
    // A leaf is seen from its own distance; what stands for many leaves, from their mean one.
    const float per_m = sums.weight > 0.0F ? sums.weight_per_m / sums.weight : 0.0F;
    const float size_px = seen.size_m * per_m / resolved_rad;
    float value = 0.0F;
    const float known = sums.weight > 0.0F ? std::min(1.0F, sums.grouped / sums.weight) : 0.0F;
    for (Index k = candidate.first_choice; k < candidate.first_choice + candidate.choice_count; ++k) {
        Choice& choice = frame.choices[k];
        model::PictureLoss loss = looks.losses.empty() ? model::PictureLoss{} : looks.losses[choice.rep];
        for (std::size_t s = 0; known > 0.0F && s < loss.colour.size(); ++s)
            loss.colour[s] = lost_[k].colour[s] / sums.weight + (1.0F - known) * loss.colour[s];
        const float error_rad = choice.error_rad * seen.distance_m * per_m, error_px = error_rad / resolved_rad;
        const float looked = looks.losses.empty()
                                 ? looks_right(error_px, choice.surface_px, sums.surface_px)
                                 : looks_right_measured(error_px, error_rad, loss_at(loss, size_px), looks.of_missing, size_px);
        const float right = looks.forgiven.empty() ? looked : looked + looks.forgiven[candidate.node] * (1.0F - looked);
        const float uncovered = looks.losses.empty() ? 0.0F : std::max(std::min(1.0F, loss.coverage), elsewhere(error_rad));
        value = std::max(value, sums.full - sums.weight * (1.0F - right) - more * sums.sky * uncovered);
        choice.value = value;
    }
}

/// To the clusters above that know what their forms lose on this candidate.
void ValuePass::add_to_groups(std::size_t i, const PreparedFrame& frame, const Looks& looks) {
    const float weight = sums_[i].weight;
    if (looks.groups == nullptr || !(weight > 0.0F)) return;
    const model::LossGroups::Above above = looks.groups->above(frame.candidates[i].node);
    Index at = static_cast<Index>(i);
    for (std::uint32_t up = 0; up < above.skipped + above.slots.size(); ++up) {
        at = frame.candidates[at].parent;
        if (at == none) return;
        if (up < above.skipped) continue;
        const Candidate& cluster = frame.candidates[at];
        sums_[at].grouped += weight;
        for (Index k = cluster.first_choice; k < cluster.first_choice + cluster.choice_count; ++k) {
            const Index form = frame.choices[k].rep - looks.nodes[cluster.node].first_rep;
            const std::size_t entry = looks.groups->first(cluster.node) + std::size_t{form} * looks.groups->count(cluster.node) +
                                      above.slots[up - above.skipped];
            for (std::size_t s = 0; s < lost_[k].colour.size(); ++s)
                lost_[k].colour[s] += weight * looks.of_groups[entry].colour[s];
        }
    }
}

/// Gives the parent the steps of the candidate's own hull.
void ValuePass::add_own(const Candidate& candidate, const OwnChoices& own) {
    add(candidate.parent, 0, own.choices[0].value, own.cost(0));
    for (std::size_t h = 0; h + 1 < own.hull.size(); ++h) {
        const std::uint32_t a = own.hull[h], b = own.hull[h + 1];
        add(candidate.parent, level_of(own.choices[a].rate), own.choices[b].value - own.choices[a].value,
            own.cost(b) - own.cost(a));
    }
}

/// The curve of a root without children.
void ValuePass::own_curve(const OwnChoices& own, ValueCurve& curve) {
    std::size_t at = 0;
    for (std::uint32_t level = 0; level < levels; ++level) {
        while (at + 1 < own.hull.size() && own.choices[own.hull[at]].rate >= rate_of(level)) ++at;
        curve.value[level] = own.choices[own.hull[at]].value;
        curve.cost[level] = own.cost(own.hull[at]);
    }
}

/// At each level the better of the node's own choices and of its children. Once the children are better, they stay so.
void ValuePass::merge_curve(Index parent, Curve& curve, const OwnChoices& own) {
    std::size_t at = 0;  // on the hull, at the current level's rate
    float value = 0, cost = 0, given_value = 0, given_cost = 0;
    bool open = false;
    for (std::uint32_t level = 0; level < levels; ++level) {
        value += curve.value[level];
        cost += curve.cost[level];
        const float rate = rate_of(level);
        float best_value = value, best_cost = cost;
        if (!open) {
            while (at + 1 < own.hull.size() && own.choices[own.hull[at]].rate >= rate) ++at;
            const std::uint32_t k = own.hull[at];
            const float own_value = own.choices[k].value, own_cost = own.cost(k);
            open = value - rate * cost >= own_value - rate * own_cost || level + 1 == levels;
            if (open) {
                set_opening_rate(level, value, cost, own);
            } else {
                best_value = own_value;
                best_cost = own_cost;
            }
        }
        add(parent, level, best_value - given_value, best_cost - given_cost);
        given_value = curve.value[level] = best_value;
        given_cost = curve.cost[level] = best_cost;
    }
}

/// Where exactly in the level the children become better. Choices that would be left later are passed at that rate, all at once.
void ValuePass::set_opening_rate(std::uint32_t level, float value, float cost, const OwnChoices& own) {
    const float rate = rate_of(level);
    std::size_t from = 0;  // the choice that is shown at twice the rate
    while (level > 0 && from + 1 < own.hull.size() && own.choices[own.hull[from]].rate >= 2.0F * rate) ++from;
    const float exact = slope(value - own.choices[own.hull[from]].value, cost - own.cost(own.hull[from]));
    const float lowest = level + 1 == levels ? 0.0F : rate;
    const float opening = level == 0 ? std::max(exact, rate) : std::clamp(exact, lowest, 2.0F * rate);
    for (std::size_t c = 0; c < own.choices.size(); ++c) {
        if (c + 1 == own.choices.size() || own.choices[c].rate < opening) own.choices[c].rate = opening;
    }
}

/// Rates fall along the choices and down the tree.
void ValuePass::enforce_falling_rates(PreparedFrame& frame) {
    for (const Candidate& candidate : frame.candidates) {  // parents first
        float limit = std::numeric_limits<float>::max();
        if (candidate.parent != none) {
            const Candidate& parent = frame.candidates[candidate.parent];
            limit = frame.choices[parent.first_choice + parent.choice_count - 1].rate;
        }
        for (Choice& choice : std::span(&frame.choices[candidate.first_choice], candidate.choice_count))
            limit = choice.rate = std::min(limit, choice.rate);
    }
}

void ValuePass::run(const model::FrameCombine& combine, float resolved_rad, std::span<const Weight> weights,
                    std::span<const float> shown_px, PreparedFrame& frame, const Looks& looks, const SkyPixels& sky) {
    frame.curve = {};
    frame.full_value = 0;
    const std::size_t n = frame.candidates.size();
    if (n == 0) return;
    CHECK(n <= sums_.size(), "Values are made for no more candidates than were reserved");
    std::fill_n(sums_.begin(), n, Sums{});
    if (looks.groups != nullptr) {
        CHECK(frame.choices.size() <= lost_.size(), "Values are made for no more choices than were reserved");
        std::fill_n(lost_.begin(), frame.choices.size(), model::LossOfGroup{});
    }
    free_.clear();
    for (std::uint32_t i = static_cast<std::uint32_t>(curves_.size()); i-- > 0;) free_.push_back(i);
    std::array<std::uint32_t, max_on_hull> room{};
    double full_value = 0;
    for (std::size_t i = n; i-- > 0;) {
        const Candidate& candidate = frame.candidates[i];
        const std::span<Choice> choices(&frame.choices[candidate.first_choice], candidate.choice_count);
        set_values(i, resolved_rad, weights[i], shown_px[i], frame, looks, sky);
        add_to_groups(i, frame, looks);
        frame.candidates[i].full_value = sums_[i].full;
        const OwnChoices own{combine, choices, hull_of(combine, choices, room)};
        if (candidate.child_count == 0) full_value += static_cast<double>(choices.back().value);
        const bool inner = candidate.child_count > 0 && sums_[i].curve != none;
        if (!inner) add_own(candidate, own);
        if (inner) {
            Curve& curve = curves_[sums_[i].curve];
            merge_curve(candidate.parent, curve, own);
            if (i == 0) std::copy_n(curve.value.begin(), levels, frame.curve.value.begin());
            if (i == 0) std::copy_n(curve.cost.begin(), levels, frame.curve.cost.begin());
            free_.push_back(sums_[i].curve);
        } else if (i == 0) {
            own_curve(own, frame.curve);
        }
    }
    frame.full_value = full_value;
    frame.curve.full_value = sums_[0].full;
    enforce_falling_rates(frame);
}

void estimate_values(const model::FrameCombine& combine, PreparedFrame& frame) {
    std::vector<Weight> weights;
    std::vector<float> shown_px;
    weights.reserve(frame.candidates.size());
    shown_px.reserve(frame.candidates.size());
    for (const Candidate& candidate : frame.candidates) {
        Weight weight;
        weight.pixel_weight = 1.0F;
        weights.push_back(weight);
        shown_px.push_back(std::max(candidate.pixels, 0.0F));
    }
    ValuePass pass;
    pass.reserve(static_cast<std::uint32_t>(frame.candidates.size()), frame.choices.size());
    pass.run(combine, static_cast<float>(resolved_rad(frame)), weights, shown_px, frame);
}

}  // namespace surefoot::prepare
