// Where this machine's figures live: the state folder and the calibrated cost table in it.
#pragma once

#include <string>

#include "render/model/cost.hpp"
#include "rt/base/result.hpp"

namespace surefoot::app {

/// `asked` if not empty, else $STATE_DIRECTORY, else $XDG_STATE_HOME/surefoot, else ~/.local/state/surefoot.
std::string state_directory(const std::string& asked);
/// Whether an emergency stop is still latched.
std::string stop_file(const std::string& state_dir);
std::string cost_table_file(const std::string& state_dir);

/// The calibrated table of this machine and renderer; without one, or with another machine's, default_costs() and
/// `note` says so and how to calibrate. A damaged table is an Error.
Result<model::CostModel> load_costs(const std::string& state_dir, const std::string& machine, std::string& note);

/// Where the fit of `table` to the model whose file has `model_hash` lies: a table measured anew leaves old fits behind.
std::string model_costs_file(const std::string& state_dir, const model::CostModel& table, std::uint64_t model_hash);

/// The fit to this model where there is one (`surefoot calibrate MODEL.walk`), else `table` as it is.
Result<model::CostModel> fitted_costs(const std::string& state_dir, const model::CostModel& table, std::uint64_t model_hash);

}  // namespace surefoot::app
