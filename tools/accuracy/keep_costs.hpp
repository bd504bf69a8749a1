// Which costs a model's walks shall use: the fit to the model or the machine's table, by short walks with each.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "render/model/cost.hpp"
#include "rt/base/path.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/accuracy/compare.hpp"

namespace surefoot::accuracy {

/// The two candidates, and how they are walked.
struct KeepRequest {
    walk::WalkRequest walk;  ///< its costs are replaced; pictures > 0, and a length
    std::shared_ptr<const model::CostModel> fit, table;
    double fit_error = 0, table_error = 0;  ///< of held-out frames: decide where the walks do not
    std::uint32_t rounds = 3;               ///< walks with each; neighbours in time change their order
};

/// Walks with one candidate.
struct CostTrial {
    double psnr_db = 0;              ///< pooled over the pictures of all rounds
    std::vector<double> of_rounds;   ///< PSNR, dB
    double worst_psnr_db = 0;        ///< of one picture
    double ssim = 0, unused_ms = 0;  ///< means of the rounds
    std::uint64_t frames = 0, own_misses = 0;
};

/// Why one candidate is kept, in the order in which it is asked.
enum class KeepReason : std::uint8_t {
    deadlines,   ///< the other one's frames were late more often
    pictures,    ///< its worst round shows a better picture than the best round of the other
    prediction,  ///< the walks do not tell: its error of held-out frames is smaller
};
std::string_view name_of(KeepReason reason);

/// The decision, and what it is made of.
struct KeptCosts {
    bool fit = true;  ///< else the table
    KeepReason reason = KeepReason::prediction;
    CostTrial of_fit, of_table;
};

/// Limits of the decision: shares of own misses, and dB, that count as equal.
constexpr double equal_miss_share = 0.02, equal_psnr_db = 0.2;
constexpr double one_round_db = 2;  ///< the same where there is one round only: its spread is not known

/// Pure.
KeptCosts decide(CostTrial of_fit, CostTrial of_table, double fit_error, double table_error);

/// Walks by the table, by the fit, by the fit, by the table, and so on. Errors: of a walk; stopped by the user; no picture.
Result<KeptCosts> keep_costs(const KeepRequest& request, const RunWalk& run_walk, const Progress& progress);

/// Four pieces of the path at its own speed, evenly spread over it, of `seconds` together. A shorter path: as it is.
Path path_in_pieces(const Path& path, double seconds);

}  // namespace surefoot::accuracy
