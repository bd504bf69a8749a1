// Finds what the machine grants of real time, and what is missing. With --strict nothing starts if anything is missing.
#pragma once

#include <span>
#include <vector>

#include "rt/base/result.hpp"
#include "tools/walk/placing.hpp"
#include "tools/walk/walk_results.hpp"

namespace surefoot::walk {

/// Fills in what is granted and what is lacking (facts.degraded), locks memory, and works out the placing. real_clock false:
/// nothing is requested from the machine. An Error only where the request itself cannot be met.
Result<PlacingPlan> claim_real_time(const WalkRequest& request, bool real_clock, WalkFacts& facts);

/// --strict: success, or one Error that names every lack with its remedy.
Result<void> require_real_time(std::span<const rt::Lack> lacks);

}  // namespace surefoot::walk
