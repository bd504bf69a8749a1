// Published formulas of a frame's cost (published_costs.hpp).
#include "render/measure/published_costs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "rt/base/check.hpp"
#include "rt/base/statistics.hpp"

namespace surefoot::measure {

namespace {

struct Formula {
    std::string_view name, formula, source;
    double (*frame_us)(const ItemSums& sums);
};

constexpr std::array<Formula, 3> formulas{{
    {"sum_of_max", "sum of max(G, R)", "Maciel 1994, 3.3.1", [](const ItemSums& s) { return s.larger_us; }},
    {"max_of_sums", "max(sum G, sum R)", "Maciel 1994, 3.3.1",
     [](const ItemSums& s) { return std::max(s.submit_us, s.raster_us); }},
    {"sum_of_stages", "F + X + C + R", "Selcuk 1997, ch. 4", [](const ItemSums& s) { return s.submit_us + s.raster_us; }},
}};

std::vector<double> actual_of(std::span<const FrameSample> samples) {
    std::vector<double> actual;
    for (const FrameSample& s : samples) actual.push_back(s.actual_us);
    return actual;
}

std::vector<double> predicted_by(const Formula& formula, std::span<const FrameSample> samples, double factor) {
    std::vector<double> predicted;
    for (const FrameSample& s : samples) predicted.push_back(factor * formula.frame_us(s.items));
    return predicted;
}

double squared_correlation(std::span<const double> x, std::span<const double> y) {
    const auto n = static_cast<double>(x.size());
    double mean_x = 0, mean_y = 0, xx = 0, yy = 0, xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mean_x += x[i] / n;
        mean_y += y[i] / n;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        yy += (y[i] - mean_y) * (y[i] - mean_y);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    return xx > 0 && yy > 0 ? std::min(1.0, xy * xy / (xx * yy)) : 0;
}

}  // namespace

CostErrors cost_errors(std::span<const double> predicted, std::span<const double> actual) {
    CHECK(predicted.size() == actual.size(), "Each measured frame was predicted");
    if (actual.empty()) return {};
    std::vector<double> errors, ratios;
    for (std::size_t i = 0; i < actual.size(); ++i) {
        const double time_us = std::max(1.0, actual[i]);
        errors.push_back(std::abs(actual[i] - predicted[i]) / time_us);
        ratios.push_back(predicted[i] / time_us);
    }
    CostErrors e;
    e.p50 = quantile_of(errors, 0.5);
    e.p90 = quantile_of(errors, 0.9);
    e.p99 = quantile_of(errors, 0.99);
    e.bias = median_of(ratios) - 1;
    e.r2 = squared_correlation(predicted, actual);
    return e;
}

CostErrors cost_errors(std::span<const FrameSample> samples, const model::FrameCombine& combine) {
    std::vector<double> predicted;
    for (const FrameSample& s : samples)
        predicted.push_back(
            static_cast<double>(combine.frame_us(static_cast<float>(s.submit_us), static_cast<float>(s.raster_us))));
    return cost_errors(predicted, actual_of(samples));
}

std::vector<PublishedCost> published_costs(std::span<const FrameSample> taught, std::span<const FrameSample> held_out) {
    std::vector<PublishedCost> costs;
    for (const Formula& formula : formulas) {
        PublishedCost cost{formula.name, formula.formula, formula.source, {}, 1, {}};
        const std::vector<double> actual = actual_of(held_out);
        cost.as_published = cost_errors(predicted_by(formula, held_out, 1), actual);
        std::vector<double> ratios;
        for (const FrameSample& s : taught) ratios.push_back(s.actual_us / std::max(1.0, formula.frame_us(s.items)));
        if (!ratios.empty()) cost.factor = median_of(ratios);
        cost.with_factor = cost_errors(predicted_by(formula, held_out, cost.factor), actual);
        costs.push_back(cost);
    }
    return costs;
}

}  // namespace surefoot::measure
