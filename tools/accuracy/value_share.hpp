// How much of the greatest value that a budget buys each selector shows. Off line, on frames prepared along a path.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/model.hpp"
#include "render/prepare/prepared.hpp"
#include "render/select/oracle.hpp"
#include "rt/base/path.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::accuracy {

/// A selector's shares, 0..1, over frames; budgets of one kind.
struct ValueShare {
    std::string selector;
    /// Means and least values: of the best cut known, and of the bound where the optimum is not proven.
    double of_best = 0, min_of_best = 1, of_bound = 0, min_of_bound = 1;
};

/// Shares of all selectors over the same frames.
struct ValueShares {
    std::vector<ValueShare> selectors;  ///< in the order of the request; all have hysteresis off, so frames are independent
    std::uint32_t frames = 0;           ///< that count: the floor fits the budget, and full detail does not
    std::uint32_t proven = 0;           ///< of them: the optimum is known
    std::uint32_t floor_frames = 0, full_frames = 0;  ///< left out: nothing was to be chosen
    double bound_gap = 0;                             ///< mean of 1 - best / bound
};

/// Frames, and what is compared on them.
struct ShareRequest {
    std::vector<std::string> selectors;
    std::uint32_t frames = 20;   ///< evenly spread over the path
    double budget_us = 0;        ///< of each frame; 0: share_of_full
    double share_of_full = 0.5;  ///< of the predicted time of the frame's full detail
    double period_s = 1.0 / 30;  ///< from one pose to the next
    double slice_us = 1000;
    select::BenefitModel benefit = select::BenefitModel::surefoot;
    int workers = 1;
    std::array<float, 3> sky = model::usual_sky;
    model::Viewport viewport;
    double acuity_rad = 0;  ///< PrepareOptions::acuity_rad
    select::OracleLimits limits;
};

/// Adds one prepared frame. `into` has the selectors already.
void add_frame(const select::SelectInput& input, const select::OracleLimits& limits, ValueShares& into);

/// Prepares frames as a walk does, without drawing, and adds them. Errors: stopped by the user.
Result<ValueShares> value_shares(const model::Model& model, const model::CostModel& costs, const Path& path,
                                 const ShareRequest& request, const Progress& progress);

/// The same for the model, path, costs and budget of a walk.
Result<ValueShares> value_shares_of_walk(const walk::WalkRequest& walk, ShareRequest request, const Progress& progress);

}  // namespace surefoot::accuracy
