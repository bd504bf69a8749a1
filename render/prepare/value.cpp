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
constexpr std::size_t max_choices = 32;  // of one candidate on its hull; more are left out of it

/// 0..1: how wrong a picture with this error looks. Nearly linear up to a hundred pixels: twice the error is twice as wrong.
float wrongness(float error_px) { return error_px / (error_px + 256.0F); }

/// Pixels of a leaf, weighted. Large things count for more than their pixels: they hide what stands behind them.
float weight_of(const Weight& weight, float pixels, float view_pixels) {
    const float share = std::max(pixels, 0.0F) / view_pixels;
    return weight.weight * std::sqrt(share * std::sqrt(share)) * view_pixels;  // weight.weight has the root of the share already
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
                                       std::array<std::uint32_t, max_choices>& on) {
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

float ValueCurve::value_at(float cost_us) const {
    if (!(cost_us >= cost[0])) return value[0];  // the floor is always drawn
    for (std::uint32_t level = 1; level < value_levels; ++level) {
        if (cost_us >= cost[level]) continue;
        const float step = cost[level] - cost[level - 1];
        return value[level - 1] + (value[level] - value[level - 1]) * (step > 0.0F ? (cost_us - cost[level - 1]) / step : 1.0F);
    }
    return value.back();
}

void ValuePass::reserve(std::uint32_t max_candidates) {
    sums_.resize(max_candidates);
    // Curves are held for one level of the tree at a time, and only for nodes that have children in the frame.
    const std::uint32_t most = std::min(max_candidates / 2 + 1, 1U << 15U);
    curves_.resize(most);
    free_.reserve(most);
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
    if (above.curve == none) return;  // too many at once: the parent opens by its children's finest choices alone
    curves_[above.curve].value[level] += value;
    curves_[above.curve].cost[level] += cost;
}

void ValuePass::run(const model::FrameCombine& combine, float pixel_angle_rad, std::span<const Weight> weights,
                    PreparedFrame& frame) {
    frame.curve = {};
    const std::size_t n = frame.candidates.size();
    if (n == 0) return;
    CHECK(n <= sums_.size(), "Values are made for no more candidates than were reserved");
    std::fill_n(sums_.begin(), n, Sums{0, 0, none});
    free_.clear();
    for (std::uint32_t i = static_cast<std::uint32_t>(curves_.size()); i-- > 0;) free_.push_back(i);
    const float view_pixels =
        std::max(1.0F, static_cast<float>(frame.viewport.width) * static_cast<float>(frame.viewport.height));
    double full_value = 0, weight = 0;
    std::array<std::uint32_t, max_choices> room{};
    for (std::size_t i = n; i-- > 0;) {
        const Candidate& candidate = frame.candidates[i];
        const std::span<Choice> choices(&frame.choices[candidate.first_choice], candidate.choice_count);
        Sums& sums = sums_[i];
        const bool leaf = candidate.child_count == 0;
        if (leaf) {
            sums.weight = weight_of(weights[i], candidate.pixels, view_pixels);
            sums.weight_per_m = sums.weight / weights[i].distance_m;
        }
        if (candidate.parent != none) {
            sums_[candidate.parent].weight += sums.weight;
            sums_[candidate.parent].weight_per_m += sums.weight_per_m;
        }
        // A leaf is seen from its own distance; what stands for many leaves, from their mean one.
        const float per_m = sums.weight > 0.0F ? sums.weight_per_m / sums.weight : 0.0F;
        float least = 0.0F;
        for (Choice& choice : choices) {
            const float error_rad = choice.error_rad * weights[i].distance_m * per_m;
            const float right =
                (1.0F - wrongness(error_rad / pixel_angle_rad)) * (1.0F - unusable_penalty(weights[i].size, choice.error_rad));
            least = std::max(least, sums.weight * right);
            choice.value = least;
        }
        const auto hull = hull_of(combine, choices, room);
        const auto cost_of = [&](std::uint32_t k) { return cost_metric(combine, choices[k].cost); };
        if (leaf) {
            full_value += static_cast<double>(choices.back().value);
            weight += static_cast<double>(sums.weight);
            add(candidate.parent, 0, choices[0].value, cost_of(0));
            for (std::size_t h = 0; h + 1 < hull.size(); ++h) {
                const std::uint32_t a = hull[h], b = hull[h + 1];
                add(candidate.parent, level_of(choices[a].rate), choices[b].value - choices[a].value, cost_of(b) - cost_of(a));
            }
            continue;
        }
        if (sums.curve == none) continue;  // no room was left
        Curve& below = curves_[sums.curve];
        std::size_t at = 0;  // on the hull, at the current level's rate
        float value = 0, cost = 0;
        float now_value = 0, now_cost = 0;  // what the levels so far gave the parent
        bool open = false;
        for (std::uint32_t level = 0; level < levels; ++level) {
            value += below.value[level];
            cost += below.cost[level];
            const float rate = rate_of(level);
            float best_value = value, best_cost = cost;
            if (!open) {
                while (at + 1 < hull.size() && choices[hull[at]].rate >= rate) ++at;
                const std::uint32_t k = hull[at];
                const float own_value = choices[k].value, own_cost = cost_of(k);
                open = value - rate * cost >= own_value - rate * own_cost || level + 1 == levels;
                if (open) {
                    // Where exactly it opens within the level: from the last choice before it, that the hull gives at twice the
                    // rate.
                    std::size_t from = 0;
                    while (from + 1 < hull.size() && choices[hull[from]].rate >= 2.0F * rate && level > 0) ++from;
                    const float exact = slope(value - choices[hull[from]].value, cost - cost_of(hull[from]));
                    const float opening =
                        level == 0 ? std::max(exact, rate) : std::clamp(exact, level + 1 == levels ? 0.0F : rate, 2.0F * rate);
                    for (std::uint32_t c = 0; c < choices.size(); ++c) {
                        const bool last = c + 1 == choices.size();
                        if (last || choices[c].rate < opening) choices[c].rate = opening;
                    }
                    // Choices before the opening keep their own rate; behind it all are passed at once.
                } else {
                    best_value = own_value;
                    best_cost = own_cost;
                }
            }
            add(candidate.parent, level, best_value - now_value, best_cost - now_cost);
            if (i == 0) {
                frame.curve.value[level] = best_value;
                frame.curve.cost[level] = best_cost;
            }
            now_value = best_value;
            now_cost = best_cost;
        }
        free_.push_back(sums.curve);
    }
    frame.full_value = full_value;
    frame.curve.full_value = static_cast<float>(weight);
    for (const Candidate& candidate : frame.candidates) {  // parents first
        float most = std::numeric_limits<float>::max();
        if (candidate.parent != none) {
            const Candidate& parent = frame.candidates[candidate.parent];
            most = frame.choices[parent.first_choice + parent.choice_count - 1].rate;
        }
        for (std::uint32_t c = 0; c < candidate.choice_count; ++c) {
            float& rate = frame.choices[candidate.first_choice + c].rate;
            most = std::min(most, rate);
            rate = most;
        }
    }
}

void estimate_values(const model::FrameCombine& combine, PreparedFrame& frame) {
    const float view_pixels = static_cast<float>(frame.viewport.width) * static_cast<float>(frame.viewport.height);
    std::vector<Weight> weights;
    weights.reserve(frame.candidates.size());
    for (const Candidate& candidate : frame.candidates) {
        const float size = std::sqrt(std::max(candidate.pixels, 0.0F) / std::max(view_pixels, 1.0F));
        weights.push_back({size, size, 1.0F});
    }
    ValuePass pass;
    pass.reserve(static_cast<std::uint32_t>(frame.candidates.size()));
    pass.run(combine, static_cast<float>(model::pixel_angle(frame.region.centre, frame.viewport)), weights, frame);
}

}  // namespace surefoot::prepare
