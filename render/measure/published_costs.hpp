// Published formulas of a frame's cost, evaluated on measured frames beside the program's own fit.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "render/measure/calibrate_fit.hpp"

namespace surefoot::measure {

/// Errors of predicted frame times against measured ones.
struct CostErrors {
    double p50 = 0, p90 = 0, p99 = 0;  ///< |actual - predicted| / actual, 0..1
    double bias = 0;                   ///< median of predicted / actual, minus 1; below 0: predicted too low
    double r2 = 0;                     ///< squared correlation, 0..1: blind to a constant factor. 0 without a spread
};

/// predicted, actual: one value a frame, us, of equal number. Zeros where there is no frame.
CostErrors cost_errors(std::span<const double> predicted, std::span<const double> actual);
/// Of the program's own model.
CostErrors cost_errors(std::span<const FrameSample> samples, const model::FrameCombine& combine);

/// One formula on the held-out frames. Its sums are of items by the cost table: no ends of slices, no fixed time.
struct PublishedCost {
    std::string_view name;     ///< as in JSON
    std::string_view formula;  ///< G: cost of an item's geometry stage (submit), R: of its raster stage
    std::string_view source;
    CostErrors as_published;
    double factor = 1;  ///< Maciel's overhead factor: median of actual / predicted on the taught frames
    CostErrors with_factor;
};

/// Sources: sum of max(G, R) and max of the sums: Maciel 1994, section 3.3.1. F(T) + X(T) + C(T) + R(T), for rendering by
/// software: Selcuk 1997, chapter 4. Loading, transforming and clipping triangles are the table's submit time.
std::vector<PublishedCost> published_costs(std::span<const FrameSample> taught, std::span<const FrameSample> held_out);

}  // namespace surefoot::measure
