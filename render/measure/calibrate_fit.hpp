// From measured points to a cost table, and from measured frames to how items add up.
#pragma once

#include <span>
#include <vector>

#include "render/measure/calibrate.hpp"
#include "render/model/cost.hpp"

namespace surefoot::measure {

/// The grid of one state class from its points (a full lattice of triangles x pixels, any spacing): linear in triangles and
/// pixels between points, by the outermost slope beyond them, never falling with either.
model::CostGrid fill_grid(model::EffectMask effects, std::span<const CalibrationPoint> points);

/// Sums of one measured frame and what it took.
struct FrameSample {
    double submit_us = 0, raster_us = 0;  ///< predicted sums over items, slices included
    double actual_us = 0;
};

/// Weights >= 0 of fixed, S, R and max(S, R) with the least relative error; outliers count less (Huber). Where the samples
/// cannot tell weights apart (rasterising dominates all of them), those nearest to `prior` are taken.
model::FrameCombine fit_combine(std::span<const FrameSample> samples, const model::FrameCombine& prior);

/// |actual - predicted| / actual at a quantile, 0..1.
double relative_error(std::span<const FrameSample> samples, const model::FrameCombine& combine, double quantile);
/// actual / predicted at a quantile.
double ratio(std::span<const FrameSample> samples, const model::FrameCombine& combine, double quantile);

/// Frames, from several measurements of each.
struct Settled {
    std::vector<FrameSample> frames;  ///< as last drawn; actual_us: its least, times `slowdown`
    double slowdown = 1;              ///< by how much longer a frame's median is than its least, median over the frames
    std::size_t repeated = 0;         ///< frames that were drawn alike at least twice
};
/// A machine's speed moves by up to two within milliseconds where it shares cores with others: frames measured at different
/// moments compare only by what each takes undisturbed. rounds: [frame][round], none empty, and far apart in time, so that one
/// moment does not fall on all of a frame's. What was shown before the first frame of all differs between rounds and may still
/// show in the next few: only rounds with the sums of the last one count.
Settled settle(std::span<const std::vector<FrameSample>> rounds);

}  // namespace surefoot::measure
