// Filling tables and fitting weights (calibrate_fit.hpp).
#include "render/measure/calibrate_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "rt/base/statistics.hpp"

namespace surefoot::measure {

namespace {

constexpr std::uint32_t triangle_steps = 21, pixel_steps = 25;  // to 2^20 triangles and 2^24 pixels
constexpr int terms = 4;                                        // fixed, S, R, max
constexpr double tolerated = 0.15;                              // relative error up to which a sample counts in full
constexpr double prior_share = 5e-4;                            // of the samples' own weight

using Row = std::array<double, terms>;

Row row_of(const FrameSample& s) { return {1.0, s.submit_us, s.raster_us, std::max(s.submit_us, s.raster_us)}; }

double predicted(const FrameSample& s, const Row& w) {
    const Row x = row_of(s);
    double sum = 0;
    for (int i = 0; i < terms; ++i) sum += w[static_cast<std::size_t>(i)] * x[static_cast<std::size_t>(i)];
    return sum;
}

/// Solves the normal equations over the terms in `active` by Gauss-Jordan elimination; false where they are singular.
bool solve(const std::array<Row, terms>& normal, const Row& right, unsigned active, Row& out) {
    std::array<std::array<double, terms + 1>, terms> a{};
    std::array<std::size_t, terms> index{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < terms; ++i) {
        if ((active >> i & 1U) != 0) index[n++] = i;
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) a[i][j] = normal[index[i]][index[j]];
        a[i][n] = right[index[i]];
    }
    for (std::size_t c = 0; c < n; ++c) {
        std::size_t pivot = c;
        for (std::size_t r = c; r < n; ++r) {
            if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
        }
        if (std::abs(a[pivot][c]) < 1e-9 * (1.0 + std::abs(normal[index[c]][index[c]]))) return false;
        std::swap(a[c], a[pivot]);
        for (std::size_t r = 0; r < n; ++r) {
            if (r == c) continue;
            const double factor = a[r][c] / a[c][c];
            for (std::size_t k = c; k <= n; ++k) a[r][k] -= factor * a[c][k];
        }
    }
    out = {};
    for (std::size_t i = 0; i < n; ++i) out[index[i]] = a[i][n] / a[i][i];
    return true;
}

/// Non-negative weighted least squares over at most four terms: the best of all subsets whose solution is non-negative.
Row non_negative(std::span<const FrameSample> samples, std::span<const double> weights, const Row& prior) {
    std::array<Row, terms> normal{};
    Row right{};
    for (std::size_t s = 0; s < samples.size(); ++s) {
        const Row x = row_of(samples[s]);
        for (std::size_t i = 0; i < terms; ++i) {
            for (std::size_t j = 0; j < terms; ++j) normal[i][j] += weights[s] * x[i] * x[j];
            right[i] += weights[s] * x[i] * samples[s].actual_us;
        }
    }
    for (std::size_t i = 0; i < terms; ++i) {
        right[i] += prior_share * normal[i][i] * prior[i];
        normal[i][i] *= 1 + prior_share;
    }
    Row best{};
    double min_residual = std::numeric_limits<double>::infinity();
    for (unsigned active = 1; active < 1U << terms; ++active) {
        Row w{};
        if (!solve(normal, right, active, w) || std::any_of(w.begin(), w.end(), [](double v) { return !(v >= 0); })) continue;
        double residual = 0;
        for (std::size_t s = 0; s < samples.size(); ++s) {
            residual += weights[s] * std::pow(samples[s].actual_us - predicted(samples[s], w), 2);
        }
        for (std::size_t i = 0; i < terms; ++i) residual += prior_share * normal[i][i] * std::pow(w[i] - prior[i], 2);
        if (residual < min_residual) {
            min_residual = residual;
            best = w;
        }
    }
    return best;
}

/// Index of the interval of `knots` that x is in, and the place within (below 0 or above 1 outside).
struct Place {
    std::size_t low;
    double t;
};
Place place_in(const std::vector<double>& knots, double x) {
    if (knots.size() < 2) return {0, 0};
    std::size_t low = 0;
    while (low + 2 < knots.size() && x > knots[low + 1]) ++low;
    return {low, (x - knots[low]) / (knots[low + 1] - knots[low])};
}

/// The points of one triangle count, by rising pixels. Each has its own pixel counts: a coarse mesh covers less of its sphere.
struct Level {
    double triangles = 0;
    std::vector<double> pixels;
    std::vector<std::array<double, 2>> values;  ///< submit, raster
};

std::vector<Level> levels_of(std::span<const CalibrationPoint> points) {
    std::vector<CalibrationPoint> sorted(points.begin(), points.end());
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
        return a.triangles != b.triangles ? a.triangles < b.triangles : a.pixels < b.pixels;
    });
    std::vector<Level> levels;
    for (const CalibrationPoint& p : sorted) {
        if (levels.empty() || p.triangles != levels.back().triangles) levels.push_back({p.triangles, {}, {}});
        Level& level = levels.back();
        std::array<double, 2> value{p.submit_us, p.raster_us};
        for (std::size_t k = 0; k < 2; ++k) {
            value[k] = std::max(value[k], level.values.empty() ? 0.0 : level.values.back()[k]);  // noise makes no work cheaper
        }
        level.pixels.push_back(p.pixels);
        level.values.push_back(value);
    }
    return levels;
}

double value_in(const Level& level, std::size_t kind, double pixels) {
    const Place p = place_in(level.pixels, std::max(pixels, level.pixels.front()));
    const double low = level.values[p.low][kind];
    const double high = level.values[std::min(p.low + 1, level.values.size() - 1)][kind];
    return low + p.t * (high - low);
}

}  // namespace

FrameTimes robust_frame_times(std::span<const std::vector<FrameSample>> rounds) {
    FrameTimes frame_times;
    std::vector<double> longer;
    for (const std::vector<FrameSample>& of_frame : rounds) {
        const FrameSample& last = of_frame.back();
        std::vector<double> times;
        for (const FrameSample& s : of_frame)
            if (s.submit_us == last.submit_us && s.raster_us == last.raster_us) times.push_back(s.actual_us);
        const double min_time = *std::min_element(times.begin(), times.end());
        frame_times.frames.push_back(last);
        frame_times.frames.back().actual_us = min_time;
        if (times.size() < 2) continue;
        ++frame_times.repeated;
        longer.push_back(median_of(std::move(times)) / std::max(1.0, min_time));
    }
    if (!longer.empty()) frame_times.slowdown = std::max(1.0, quantile_of(std::move(longer), 0.5));
    for (FrameSample& frame : frame_times.frames) frame.actual_us *= frame_times.slowdown;
    return frame_times;
}

model::CostGrid fill_grid(model::EffectMask effects, std::span<const CalibrationPoint> points) {
    model::CostGrid grid{effects, triangle_steps, pixel_steps, {}};
    if (points.empty()) return grid;
    const std::vector<Level> levels = levels_of(points);
    std::vector<double> knots;
    knots.reserve(levels.size());
    for (const Level& level : levels) knots.push_back(level.triangles);
    const auto value = [&](std::size_t kind, std::uint32_t t, std::uint32_t p) {
        const Place place = place_in(knots, std::max(std::ldexp(1.0, static_cast<int>(t)), knots.front()));
        const double pixels = std::ldexp(1.0, static_cast<int>(p));
        const double low = value_in(levels[place.low], kind, pixels);
        const double high = value_in(levels[std::min(place.low + 1, levels.size() - 1)], kind, pixels);
        return static_cast<float>(std::max(0.0, low + place.t * (high - low)));
    };
    for (std::uint32_t t = 0; t < triangle_steps; ++t) {
        for (std::uint32_t p = 0; p < pixel_steps; ++p) {
            model::ItemCost cost{value(0, t, p), value(1, t, p)};
            if (t > 0) {
                const model::ItemCost& fewer = grid.cells[(t - 1) * pixel_steps + p];
                cost = {std::max(cost.submit_us, fewer.submit_us), std::max(cost.raster_us, fewer.raster_us)};
            }
            grid.cells.push_back(cost);
        }
    }
    return grid;
}

/// The error that fit_combine() makes least: squares of relative errors, but outliers count less.
double huber_loss(std::span<const FrameSample> samples, const model::FrameCombine& combine) {
    double sum = 0;
    for (const FrameSample& s : samples) {
        const float us = combine.frame_us(static_cast<float>(s.submit_us), static_cast<float>(s.raster_us));
        const double error = std::abs(static_cast<double>(us) - s.actual_us) / std::max(1.0, s.actual_us);
        sum += error <= tolerated ? error * error : tolerated * (2.0 * error - tolerated);
    }
    return sum;
}

model::FrameCombine fit_combine(std::span<const FrameSample> samples, const model::FrameCombine& prior) {
    const Row start{static_cast<double>(prior.fixed_us), static_cast<double>(prior.submit_weight),
                    static_cast<double>(prior.raster_weight), static_cast<double>(prior.max_weight)};
    if (samples.empty()) return prior;
    std::vector<double> weights(samples.size());
    Row w{};
    for (int round = 0; round < 8; ++round) {
        for (std::size_t s = 0; s < samples.size(); ++s) {
            const double actual = std::max(1.0, samples[s].actual_us);
            const double error = round == 0 ? 0.0 : std::abs(predicted(samples[s], w) - actual) / actual;
            weights[s] = huber_weight(error, tolerated) / (actual * actual);
        }
        w = non_negative(samples, weights, start);
    }
    model::FrameCombine combine;
    combine.fixed_us = static_cast<float>(w[0]);
    combine.submit_weight = static_cast<float>(w[1]);
    combine.raster_weight = static_cast<float>(w[2]);
    combine.max_weight = static_cast<float>(w[3]);
    return combine;
}

std::vector<FrameSample> priced(std::span<const FrameSample> samples, float ns_per_pixel) {
    std::vector<FrameSample> out(samples.begin(), samples.end());
    for (FrameSample& s : out) s.raster_us += 1e-3 * static_cast<double>(ns_per_pixel) * s.pixels;
    return out;
}

FrameFit fit_frames(std::span<const FrameSample> samples, const model::FrameCombine& prior) {
    constexpr std::array<float, 4> tried_ns{0.25F, 0.5F, 1, 2};  // few, so that noise chooses seldom
    constexpr double clearly = 0.97, min_gain = 1e-6;  // of the loss without a price, and for each sample: rounding is no gain
    FrameFit best{fit_combine(samples, prior), 0};
    double to_beat = clearly * huber_loss(samples, best.combine) - min_gain * static_cast<double>(samples.size());
    for (const float ns : tried_ns) {
        const std::vector<FrameSample> at = priced(samples, ns);
        const model::FrameCombine combine = fit_combine(at, prior);
        const double loss = huber_loss(at, combine);
        if (!(loss < to_beat)) continue;
        to_beat = loss;
        best = {combine, ns};
    }
    return best;
}

std::optional<float> enlarge_ns_of(std::span<const EmptyPair> pairs, const model::Viewport& picture) {
    constexpr double min_ns = 0.01;  // noise must not make it free
    std::vector<double> added_ns;
    for (const EmptyPair& pair : pairs) {
        added_ns.push_back(1e3 * (pair.lower_us - pair.full_us));
        if (!std::isfinite(added_ns.back())) return {};
    }
    const double pixels = static_cast<double>(picture.width) * static_cast<double>(picture.height);
    if (added_ns.empty() || !(pixels > 0)) return {};
    return static_cast<float>(std::clamp(median_of(std::move(added_ns)) / pixels, min_ns, max_enlarge_ns));
}

bool price_pictures(const PictureTimes& times, const model::Viewport& picture, model::CostModel& costs) {
    const auto typical = [](const std::vector<double>& all) {
        const bool sound = !all.empty() && std::all_of(all.begin(), all.end(), [](double us) { return std::isfinite(us); });
        return sound ? median_of(std::vector<double>(all)) : std::numeric_limits<double>::quiet_NaN();
    };
    const double pixels = static_cast<double>(picture.width) * static_cast<double>(picture.height);
    const double one_us = typical(times.many_us) / PictureTimes::count;
    const double pixel_ns = 1e3 * (typical(times.wide_us) - PictureTimes::wide * one_us) / (PictureTimes::fills * pixels);
    const double small_us = typical(times.small_us) / PictureTimes::captures;
    const double large_us = typical(times.large_us) / PictureTimes::captures;
    constexpr double small_area = 1.0 * PictureTimes::small_texels * PictureTimes::small_texels;
    constexpr double large_area = 1.0 * PictureTimes::large_texels * PictureTimes::large_texels;
    const double texel_ns = 1e3 * (large_us - small_us) / (large_area - small_area);
    const double capture_us = small_us - 1e-3 * std::max(0.0, texel_ns) * small_area;
    if (!(pixel_ns > 0) || !(capture_us > 0) || !std::isfinite(one_us) || !std::isfinite(texel_ns)) return false;
    costs.picture_us = static_cast<float>(std::clamp(one_us, min_picture_us, max_picture_us));
    costs.picture_ns_per_pixel = static_cast<float>(std::clamp(pixel_ns, min_picture_ns, max_ns_per_pixel));
    costs.capture_us = static_cast<float>(std::clamp(capture_us, min_picture_us, max_picture_us));
    costs.capture_ns_per_texel = static_cast<float>(std::clamp(texel_ns, min_picture_ns, max_ns_per_pixel));
    costs.pictures_measured = true;
    return true;
}

std::optional<float> dearer_factor_of(std::span<const WorkPair> pairs, double max) {
    std::vector<double> ratios;
    for (const WorkPair& pair : pairs) {
        ratios.push_back(pair.plain_us > 0 ? pair.dearer_us / pair.plain_us : std::numeric_limits<double>::quiet_NaN());
        if (!std::isfinite(ratios.back())) return {};
    }
    if (ratios.empty()) return {};
    return static_cast<float>(std::clamp(median_of(std::move(ratios)), 1.0, max));
}

namespace {

/// x >= 0 and y >= 0 with the least sum of ((a x + b y - c) / scale)^2, where a row is {a, b, c, scale}.
std::array<double, 2> two_prices(std::span<const std::array<double, 4>> rows) {
    double aa = 0, ab = 0, bb = 0, ac = 0, bc = 0;
    for (const auto& [a, b, c, scale] : rows) {
        const double weight = 1 / (scale * scale);
        aa += weight * a * a, ab += weight * a * b, bb += weight * b * b, ac += weight * a * c, bc += weight * b * c;
    }
    const auto alone = [](double square, double right) { return square > 0 ? std::max(0.0, right / square) : 0.0; };
    const double determinant = aa * bb - ab * ab;
    if (determinant > 1e-9 * aa * bb) {
        const double x = (ac * bb - bc * ab) / determinant, y = (bc * aa - ac * ab) / determinant;
        if (x >= 0 && y >= 0) return {x, y};
        if (x < 0) return {0, alone(bb, bc)};
    }
    return {alone(aa, ac), 0};
}

}  // namespace

std::vector<model::EffectPrice> fit_prices(std::span<const PricePoint> points) {
    std::vector<model::EffectPrice> prices;
    for (const PricePoint& first : points) {
        const auto known = [&](const model::EffectPrice& price) { return price.effect == first.effect; };
        if (std::any_of(prices.begin(), prices.end(), known)) continue;
        std::vector<std::array<double, 4>> submit, raster;
        for (const PricePoint& p : points) {
            if (p.effect != first.effect || !std::isfinite(p.submit_us) || !std::isfinite(p.raster_us)) continue;
            const double scale = std::max(1.0, p.triangles + p.pixels);  // points of any size count alike
            submit.push_back({p.triangles, 0, p.submit_us, scale});
            raster.push_back({p.triangles, p.pixels, p.raster_us, scale});
        }
        const auto ns = [](double us, double max) { return static_cast<float>(std::min(1e3 * us, max)); };
        const std::array<double, 2> of_raster = two_prices(raster);
        prices.push_back({first.effect, ns(two_prices(submit)[0], max_effect_ns_per_triangle),
                          ns(of_raster[0], max_effect_ns_per_triangle), ns(of_raster[1], max_ns_per_pixel)});
    }
    return prices;
}

double ratio(std::span<const FrameSample> samples, const model::FrameCombine& combine, double quantile) {
    std::vector<double> values;
    for (const FrameSample& s : samples) {
        const float frame = combine.frame_us(static_cast<float>(s.submit_us), static_cast<float>(s.raster_us));
        values.push_back(s.actual_us / std::max(1.0, static_cast<double>(frame)));
    }
    return quantile_of(std::move(values), quantile);
}

double relative_error(std::span<const FrameSample> samples, const model::FrameCombine& combine, double quantile) {
    std::vector<double> values;
    for (const FrameSample& s : samples) {
        const float frame = combine.frame_us(static_cast<float>(s.submit_us), static_cast<float>(s.raster_us));
        values.push_back(std::abs(s.actual_us - static_cast<double>(frame)) / std::max(1.0, s.actual_us));
    }
    return quantile_of(std::move(values), quantile);
}

}  // namespace surefoot::measure
