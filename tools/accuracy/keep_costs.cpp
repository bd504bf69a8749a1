// Which costs a model's walks shall use (keep_costs.hpp).
#include "tools/accuracy/keep_costs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace surefoot::accuracy {

namespace {

constexpr std::array<std::string_view, 3> reasons{"deadlines", "pictures", "prediction"};

/// PSNR of the mean of the rounds' mean squared errors: each round compares as many pictures.
double pooled_db(const std::vector<double>& of_rounds) {
    double noise = 0;
    for (const double db : of_rounds) noise += std::pow(10.0, -0.1 * db);
    return -10.0 * std::log10(noise / static_cast<double>(of_rounds.size()));
}

void add(CostTrial& trial, const report::WalkSummary& walked, std::uint32_t rounds) {
    const report::PictureSummary& picture = walked.picture;
    trial.worst_psnr_db = trial.of_rounds.empty() ? picture.worst_psnr_db : std::min(trial.worst_psnr_db, picture.worst_psnr_db);
    trial.of_rounds.push_back(picture.psnr_db);
    trial.psnr_db = pooled_db(trial.of_rounds);
    trial.ssim += picture.ssim / rounds;
    trial.unused_ms += walked.unused_ms.mean / rounds;
    trial.frames += walked.frames;
    trial.own_misses += walked.own_misses;
}

double miss_share(const CostTrial& trial) {
    return static_cast<double>(trial.own_misses) / static_cast<double>(std::max<std::uint64_t>(1, trial.frames));
}

/// The machine's speed changes between walks. One walk of a candidate differs from its next by more than a decibel, so a
/// difference counts only if it is larger than that spread.
bool has_better_pictures(const CostTrial& a, const CostTrial& b) {
    if (a.of_rounds.empty() || b.of_rounds.empty()) return false;
    const double margin_db = a.of_rounds.size() > 1 ? equal_psnr_db : one_round_db;
    const double worst = *std::min_element(a.of_rounds.begin(), a.of_rounds.end());
    const double best = *std::max_element(b.of_rounds.begin(), b.of_rounds.end());
    return worst >= best + margin_db;
}

}  // namespace

std::string_view name_of(KeepReason reason) { return reasons[static_cast<std::size_t>(reason)]; }

KeptCosts decide(CostTrial of_fit, CostTrial of_table, double fit_error, double table_error) {
    KeptCosts kept;
    const double more_misses = miss_share(of_fit) - miss_share(of_table);
    if (std::abs(more_misses) > equal_miss_share) {
        kept.fit = more_misses < 0;
        kept.reason = KeepReason::deadlines;
    } else if (has_better_pictures(of_fit, of_table) || has_better_pictures(of_table, of_fit)) {
        kept.fit = of_fit.psnr_db > of_table.psnr_db;
        kept.reason = KeepReason::pictures;
    } else {
        kept.fit = fit_error < table_error;
    }
    kept.of_fit = std::move(of_fit);
    kept.of_table = std::move(of_table);
    return kept;
}

Result<KeptCosts> keep_costs(const KeepRequest& request, const RunWalk& run_walk, const Progress& progress) {
    CostTrial of_fit, of_table;
    const std::uint32_t walks = 2 * request.rounds;
    for (std::uint32_t i = 0; i < walks; ++i) {
        const bool fit = i % 4 == 1 || i % 4 == 2;
        walk::WalkRequest one = request.walk;
        one.given_costs = fit ? request.fit : request.table;
        auto outcome = run_walk(one, part_of(progress, fit ? "walk by the fit" : "walk by the table", i, walks));
        if (!outcome) return outcome.error();
        if (outcome->stopped || progress.stopped())
            return Error{"calibration", "The calibration was stopped: nothing was written", "Run it again", ErrorKind::stopped};
        if (!outcome->failures.empty()) return outcome->failures.front();
        if (outcome->summary.picture.frames == 0)
            return Error{one.model_file, "No picture of the walk could be compared", "Keep the fit with --keep fit",
                         ErrorKind::misuse};
        add(fit ? of_fit : of_table, outcome->summary, request.rounds);
    }
    return decide(std::move(of_fit), std::move(of_table), request.fit_error, request.table_error);
}

Path path_in_pieces(const Path& path, double seconds) {
    constexpr int pieces = 4;
    const double whole_s = path.duration_s();
    if (!(seconds > 0) || whole_s <= seconds) return path;
    const double length_s = seconds / pieces;
    const int steps = std::max(2, static_cast<int>(std::ceil(length_s * 60)));
    Path result;
    for (int piece = 0; piece < pieces; ++piece) {
        const double first_s = piece * (whole_s - length_s) / (pieces - 1);
        const int last = piece + 1 < pieces ? steps - 1 : steps;  // the next piece begins where this one's last step would be
        for (int i = 0; i <= last; ++i) {
            const double time_s = i * length_s / steps;
            result.samples.push_back({piece * length_s + time_s, sample_path(path, first_s + time_s)});
        }
    }
    return result;
}

}  // namespace surefoot::accuracy
