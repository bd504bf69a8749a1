// Hours of a walk under a rotating mix of load, with a verdict. The walk is the session of walk.hpp. The load is processes of its
// own. Of the frames only sums, histograms and misses are kept.
#pragma once

#include <cstdint>
#include <string>

#include "tools/soak/plan.hpp"
#include "tools/soak/summary.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::soak {

/// Settings of a soak.
struct SoakRequest {
    walk::WalkRequest walk;  ///< how it walks; frames, seconds, control and outputs are the soak's to set
    double seconds = 1200;   ///< with a control: whole pairs of blocks of it
    LoadSet mix = usual_loads;
    std::uint64_t seed = 1;
    bool control = true;         ///< not on the virtual clock
    double clock_step_s = 3600;  ///< of the load `clock`
    std::string report_dir;      ///< empty: no page
};

/// Result of a soak.
struct SoakOutcome {
    SoakSummary summary;
    std::vector<std::string> notes;
    std::vector<Error> failures;  ///< outputs that could not be written
    std::string report_page;
};

/// Call it while the process has one thread: it forks. Errors are run_walk()'s, and an output that could not be written. Stopped
/// (progress.stop): what ran is judged.
Result<SoakOutcome> run_soak(const SoakRequest& request, const Progress& progress);

}  // namespace surefoot::soak
