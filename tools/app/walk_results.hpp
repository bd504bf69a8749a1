// What a walk leaves: its summary, and the files that were asked for.
#pragma once

#include <string>
#include <vector>

#include "render/engine.hpp"
#include "tools/app/placing.hpp"
#include "tools/app/shots.hpp"
#include "tools/app/walk.hpp"
#include "tools/app/walk_stages.hpp"

namespace surefoot::app {

/// Found out on the way, for the summary.
struct WalkFacts {
    std::vector<report::Degraded> degraded;
    std::vector<std::string> census_problems;
    std::string renderer, machine;
    bool pinned = false, locked = false, isolated = false;
    double steal_ms = 0;
    std::uint64_t dropped_records = 0;
};

void fill_summary(const WalkRequest& request, const WalkFacts& facts, const PlacingPlan& plan, std::int64_t period_ns,
                  const std::string& path_source, const Engine& engine, WalkOutcome& outcome);

/// Ledger, trace, capture, pictures, report: what the request names. The device must be bound to the calling thread.
Result<void> write_outputs(const WalkRequest& request, const KeptFrame& kept, Engine& engine, const ShotStore& shots, WalkOutcome& outcome,
                           const Progress& progress);

}  // namespace surefoot::app
