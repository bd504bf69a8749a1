// Fits a machine's cost table to one model: how the costs of items add up to a frame, from measured frames.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/engine.hpp"
#include "render/measure/published_costs.hpp"
#include "rt/base/path.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"

namespace surefoot::walk {

/// Settings of a fit.
struct ModelFitOptions {
    gl::DeviceOptions device;
    double frame_us = 1e6 / 30;  ///< budgets are drawn from a tenth of it up to 85 %
    std::uint32_t poses = 240;
    std::uint32_t rounds = 4;       ///< how often each pose is drawn, at least 1
    std::uint32_t blur_poses = 12;  ///< of the path, at which the blur of each resolution is measured; 0: not measured
    std::uint64_t seed = 7;
    std::function<void()> opened;  ///< called once, when the driver's threads exist: place them as a walk does
};

/// A cost table fitted to one model.
struct ModelFit {
    model::CostModel costs;             ///< the table with `combine`, `ns_per_pixel`, `headroom` and `blur_loss` of this model
    measure::CostErrors before, after;  ///< on the half of the frames that were not used for the fit
    std::vector<measure::PublishedCost> published;  ///< published formulas on the same half
    std::string machine;                            ///< that drew it, as a table names its own
    std::uint32_t frames = 0;
    std::size_t blur_poses = 0;  ///< at which the blur was measured
    std::size_t repeated = 0;    ///< of them, drawn alike in at least two rounds
    double slowdown = 1;         ///< measure::FrameTimes's
    double seconds = 0;
};

/// Draws random views near the path at random budgets, in several rounds (measure::robust_frame_times). Every other view is used
/// for the fit, the rest to measure its error. The fit adds a price of every pixel if that predicts clearly better.
/// The table's cells do not change, as they are of single items. Models differ in how items overlap and hide each other. The null
/// backend charges what the table says: a fit without GL, for tests. It shows nothing, so the blur keeps the table's figures.
Result<ModelFit> fit_to_model(model::Model model, const Path& path, const model::CostModel& table, const ModelFitOptions& options,
                              const Progress& progress);

}  // namespace surefoot::walk
