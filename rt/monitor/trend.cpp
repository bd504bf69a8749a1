// Theil and Sen's slope. Pairs are quadratic in the points, so many points are first put into groups.
#include "rt/monitor/trend.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace surefoot::rt {

namespace {

constexpr std::size_t most_points = 512;

double middle_of(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1) return *middle;
    return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

std::vector<TrendPoint> grouped_points(std::span<const TrendPoint> points) {
    if (points.size() <= most_points) return {points.begin(), points.end()};
    const auto [first, last] = std::ranges::minmax(points, {}, &TrendPoint::time_s);
    const double group_s = (last.time_s - first.time_s) / static_cast<double>(most_points);
    std::vector<std::vector<TrendPoint>> groups(most_points);
    for (const TrendPoint& p : points) {
        const double at = group_s > 0 ? (p.time_s - first.time_s) / group_s : 0;
        groups[std::min(most_points - 1, static_cast<std::size_t>(at))].push_back(p);
    }
    std::vector<TrendPoint> kept;
    for (const auto& group : groups) {
        if (group.empty()) continue;
        std::vector<double> times, values;
        for (const TrendPoint& p : group) times.push_back(p.time_s), values.push_back(p.value);
        kept.push_back({middle_of(times), middle_of(values)});
    }
    return kept;
}

}  // namespace

Trend robust_trend(std::span<const TrendPoint> points) {
    const std::vector<TrendPoint> kept = grouped_points(points);
    std::vector<double> slopes;
    slopes.reserve(kept.size() * kept.size() / 2);
    for (std::size_t i = 0; i < kept.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            const double apart_s = kept[i].time_s - kept[k].time_s;
            if (apart_s != 0) slopes.push_back((kept[i].value - kept[k].value) / apart_s);
        }
    }
    Trend trend;
    if (slopes.empty()) return trend;
    trend.known = true;
    trend.per_s = middle_of(slopes);
    std::vector<double> left;
    left.reserve(kept.size());
    for (const TrendPoint& p : kept) left.push_back(p.value - trend.per_s * p.time_s);
    trend.at_s0 = middle_of(left);
    return trend;
}

}  // namespace surefoot::rt
