// The results of a walk: its summary, and the requested files.
#pragma once

#include <string>
#include <vector>

#include "render/engine.hpp"
#include "rt/base/result.hpp"
#include "tools/walk/placing.hpp"
#include "tools/walk/snapshots.hpp"
#include "tools/walk/walk.hpp"
#include "tools/walk/walk_stages.hpp"

namespace surefoot::walk {

/// Found out on the way, for the summary.
struct WalkFacts {
    std::vector<rt::Lack> degraded;
    std::string uncalibrated;  ///< the cost table is missing or another machine's: what, and the remedy
    std::vector<std::string> census_problems;
    std::vector<std::string> worker_problems;  ///< of the workers' first tasks; the census takes them in
    std::vector<rt::CensusRow> threads;
    std::string renderer, machine;
    bool pinned = false, locked = false, isolated = false;
    double steal_ms = 0;
    std::int64_t minor_fault_ns = 0;  ///< cost of a page fault, for blame; 0: not measured
    std::uint64_t dropped_records = 0;
};

void fill_summary(const WalkRequest& request, const WalkFacts& facts, const PlacingPlan& plan, std::int64_t period_ns,
                  const std::string& path_source, const Engine& engine, WalkOutcome& outcome);

/// The threads as they are now, and how they differ from the declared table.
void take_census(const PlacingPlan& plan, WalkFacts& facts);

/// Room for the pictures that --snap or --report will want of `frames` frames; a message where that is less than all.
SnapshotStore make_snapshot_store(const WalkRequest& request, std::uint64_t frames, const SnapshotRoom& room,
                                  std::vector<std::string>& notes);

/// Ledger, trace, capture, pictures, report: what the request names. One that fails goes to outcome.failures, and the next is
/// written. The device must be bound to the calling thread.
void write_outputs(const WalkRequest& request, const KeptFrame& kept, Engine& engine, const SnapshotStore& snapshots,
                   WalkOutcome& outcome, const Progress& progress);

/// Errors: an output that cannot be written, that is an input or another output, or that the backend cannot make (pictures of
/// the null backend). Creates and changes no file.
Result<void> check_outputs(const WalkRequest& request);

}  // namespace surefoot::walk
