// Quantiles, Theil and Sen's slope, the sign-flip test. Pairs of points are quadratic, so many points are first put into groups.
#include "rt/base/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace surefoot {

namespace {

constexpr std::size_t max_points = 512;

std::vector<TrendPoint> grouped_points(std::span<const TrendPoint> points) {
    if (points.size() <= max_points) return {points.begin(), points.end()};
    const auto [first, last] = std::ranges::minmax(points, {}, &TrendPoint::time_s);
    const double group_s = (last.time_s - first.time_s) / static_cast<double>(max_points);
    std::vector<std::vector<TrendPoint>> groups(max_points);
    for (const TrendPoint& p : points) {
        const double at = group_s > 0 ? (p.time_s - first.time_s) / group_s : 0;
        groups[std::min(max_points - 1, static_cast<std::size_t>(at))].push_back(p);
    }
    std::vector<TrendPoint> kept;
    for (const auto& group : groups) {
        if (group.empty()) continue;
        std::vector<double> times, values;
        for (const TrendPoint& p : group) times.push_back(p.time_s), values.push_back(p.value);
        kept.push_back({median_of(std::move(times)), median_of(std::move(values))});
    }
    return kept;
}

/// Nearest rank: the smallest value that at least a share q of all values do not exceed. Never a value that did not occur.
double nearest_rank(const std::vector<double>& sorted, double q) {
    const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size()) - 1e-9));
    return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

}  // namespace

double quantile_of(std::vector<double> values, double q) {
    if (values.empty()) return 0;
    const auto rank = std::min(static_cast<std::size_t>(q * static_cast<double>(values.size())), values.size() - 1);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double median_of(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1) return *middle;
    return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

Quantiles quantiles(std::vector<double> values) {
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    Quantiles q;
    if (values.empty()) return q;
    std::sort(values.begin(), values.end());
    q.p50 = nearest_rank(values, 0.50);
    q.p90 = nearest_rank(values, 0.90);
    q.p99 = nearest_rank(values, 0.99);
    q.p999 = nearest_rank(values, 0.999);
    q.min = values.front();
    q.max = values.back();
    double sum = 0;
    for (const double v : values) sum += v;
    q.mean = sum / static_cast<double>(values.size());
    return q;
}

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
    trend.per_s = median_of(std::move(slopes));
    std::vector<double> left;
    left.reserve(kept.size());
    for (const TrendPoint& p : kept) left.push_back(p.value - trend.per_s * p.time_s);
    trend.at_s0 = median_of(std::move(left));
    return trend;
}

double sign_flip_p_value(std::span<const int> differences) {
    int sum = 0, reach = 0;
    for (const int d : differences) {
        sum += d;
        reach += std::abs(d);
    }
    if (reach == 0) return 1.0;
    // chance[s + reach]: of the sum s, over all signs of the differences taken so far.
    std::vector<double> chance(2 * static_cast<std::size_t>(reach) + 1, 0.0), next(chance.size());
    chance[static_cast<std::size_t>(reach)] = 1.0;
    for (const int d : differences) {
        const auto step = static_cast<std::size_t>(std::abs(d));
        std::ranges::fill(next, 0.0);
        for (std::size_t s = 0; s < chance.size(); ++s) {
            if (chance[s] == 0.0) continue;
            next[s + step] += 0.5 * chance[s];
            next[s - step] += 0.5 * chance[s];
        }
        chance.swap(next);
    }
    double p = 0;
    const int first = sum + reach;
    for (auto s = static_cast<std::size_t>(first); s < chance.size(); ++s) p += chance[s];
    return std::min(p, 1.0);
}

}  // namespace surefoot
