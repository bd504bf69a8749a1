// The state folder of this machine, and the calibrated cost table in it.
#pragma once

#include <string>

#include "render/model/cost.hpp"
#include "rt/base/result.hpp"

namespace surefoot::walk {

/// `requested` if not empty, else $STATE_DIRECTORY, else $XDG_STATE_HOME/surefoot, else ~/.local/state/surefoot.
std::string state_directory(const std::string& requested);
/// Whether an emergency stop is still latched.
std::string stop_file(const std::string& state_dir);
std::string cost_table_file(const std::string& state_dir);

/// The calibrated table of this machine and renderer; without one, or with another machine's, default_costs(),
/// and `note` has the reason and how to calibrate. A damaged table is an Error.
Result<model::CostModel> load_costs(const std::string& state_dir, const std::string& machine, std::string& note);

/// What a fit to a model is valid for, beside the table that it was made from.
struct FitConditions {
    std::uint64_t model_hash = 0;  ///< model::WalkFileInfo::hash
    std::uint32_t width = 0, height = 0;
    std::string backend;
};

/// Where the fit lies. A table measured anew makes every fit to the old one useless: see drop_old_fits.
std::string model_costs_file(const std::string& state_dir, const model::CostModel& table, const FitConditions& conditions);

/// Removes the fits to other tables than this one; how many.
std::size_t drop_old_fits(const std::string& state_dir, const model::CostModel& table);

/// The fit under these conditions where there is one (`surefoot calibrate MODEL.walk`), else `table` as it is.
Result<model::CostModel> fitted_costs(const std::string& state_dir, const model::CostModel& table,
                                      const FitConditions& conditions);

}  // namespace surefoot::walk
