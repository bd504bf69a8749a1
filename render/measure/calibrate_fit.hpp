// Fits: measured points to a cost table; measured frames to the weights by which items add up.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/measure/calibrate.hpp"
#include "render/model/cost.hpp"

namespace surefoot::measure {

/// The cost grid of one state class. points: a full lattice of triangles x pixels, any spacing.
/// Linear between points, continued by the outermost slope beyond them, and monotone in triangles and pixels.
model::CostGrid fill_grid(model::EffectMask effects, std::span<const CalibrationPoint> points);

/// Sums over a frame's items by the cost table alone: no ends of slices, no fixed time.
struct ItemSums {
    double submit_us = 0, raster_us = 0;
    double larger_us = 0;  ///< of each item the larger of the two
};

/// One measured frame: predicted sums and measured time.
struct FrameSample {
    double submit_us = 0, raster_us = 0;  ///< predicted sums over items, slices included
    double actual_us = 0;
    ItemSums items{};   ///< for published formulas; zeros where they are not asked for
    double pixels = 0;  ///< rasterised by the items, overdraw included
};

/// Weights >= 0 of fixed, S, R and max(S, R) with the least relative error. Outliers count less (Huber 1964). If the samples
/// cannot tell weights apart, as when rasterising dominates all of them, the weights nearest to `prior` are taken.
model::FrameCombine fit_combine(std::span<const FrameSample> samples, const model::FrameCombine& prior);

/// The samples with this price of every pixel. Requires that raster_us is without one.
std::vector<FrameSample> priced(std::span<const FrameSample> samples, float ns_per_pixel);

/// What a fit to frames finds.
struct FrameFit {
    model::FrameCombine combine;
    float ns_per_pixel = 0;
};
/// The price of a pixel, of a few, with the least error of fit_combine(). None unless another one is clearly better: then a
/// machine that charges by the cells alone is fitted by them. Allocates.
FrameFit fit_frames(std::span<const FrameSample> samples, const model::FrameCombine& prior);

/// |actual - predicted| / actual at a quantile, 0..1.
double relative_error(std::span<const FrameSample> samples, const model::FrameCombine& combine, double quantile);
/// actual / predicted at a quantile.
double ratio(std::span<const FrameSample> samples, const model::FrameCombine& combine, double quantile);

/// A frame at full resolution, and right after it one at a lower resolution: both empty.
struct EmptyPair {
    double full_us = 0, lower_us = 0;
};
/// Time that enlarging adds to a frame, ns for a pixel of the whole picture: the median of the pairs' differences. It is kept
/// within 0.01 to max_enlarge_ns. Nothing if there are no pixels or no pairs, or if a time is not finite.
std::optional<float> enlarge_ns_of(std::span<const EmptyPair> pairs, const model::Viewport& picture);

/// What frames take longer than empty ones, each drawn right after one: by pictures of the image cache. us.
struct PictureTimes {
    std::vector<double> many_us;   ///< with `count` drawn pictures of a pixel
    std::vector<double> wide_us;   ///< with `wide` pictures that fill the frame `fills` times
    std::vector<double> small_us;  ///< with `captures` new pictures of `small_texels` a side, without contents
    std::vector<double> large_us;  ///< the same of `large_texels`
    static constexpr int count = 64, wide = 60, fills = 4, captures = 16;
    static constexpr std::uint32_t small_texels = 64, large_texels = 256;
};
/// Prices of pictures: by their medians. Nothing is free, since noise must not make it so. False: a time is not finite, there are
/// none, or pixels and new pictures took no time. `costs` is as before then.
bool price_pictures(const PictureTimes& times, const model::Viewport& picture, model::CostModel& costs);

/// The same work drawn in two ways, one right after the other.
struct WorkPair {
    double plain_us = 0, dearer_us = 0;  ///< raster time, without that of an empty frame
};
/// How much longer the dearer way takes: the median ratio, within 1 to max. Nothing if there are no pairs, or if a ratio is not
/// finite.
std::optional<float> dearer_factor_of(std::span<const WorkPair> pairs, double max);

/// What an effect added to one item, at one size.
struct PricePoint {
    model::EffectMask effect = 0;
    double triangles = 0, pixels = 0;     ///< of the item
    double submit_us = 0, raster_us = 0;  ///< with it, more than without it
};
/// The price of each effect, in the order of their first points. The points of an effect differ in triangles and pixels. Least
/// squares, where points of any size count alike. Never negative; noise below zero is nothing. Points that are not finite do
/// not count.
std::vector<model::EffectPrice> fit_prices(std::span<const PricePoint> points);

/// One time for each frame, from several measurements of it.
struct FrameTimes {
    std::vector<FrameSample> frames;  ///< sums as last drawn; actual_us: minimum of the rounds, times `slowdown`
    double slowdown = 1;              ///< median over the frames of (median / minimum of the rounds)
    std::size_t repeated = 0;         ///< frames with at least two rounds of equal sums
};
/// Robust frame times: the minimum of several rounds, scaled by the typical median / minimum ratio. On shared hosts the speed
/// varies by a factor of two within milliseconds, so single measurements do not compare.
/// rounds: [frame][round], none empty. The rounds of a frame must lie far apart in time, so that one disturbance does not hit
/// all. Only rounds with the same sums as the last one count: hysteresis of the first frames may differ between rounds.
FrameTimes robust_frame_times(std::span<const std::vector<FrameSample>> rounds);

}  // namespace surefoot::measure
