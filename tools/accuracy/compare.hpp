// Selectors or settings side by side: the same walk by each in turn, its pictures against full detail, and its times.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/accuracy/value_share.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::accuracy {

/// A walk with other settings.
struct NamedWalk {
    std::string name;  ///< as the user wrote the settings
    walk::WalkRequest walk;
};

/// What is walked, by whom, and how often.
struct CompareRequest {
    walk::WalkRequest walk;              ///< its selector is replaced; pictures > 0
    std::vector<std::string> selectors;  ///< names of the registry; at least one
    std::vector<NamedWalk> settings;     ///< not empty: these are compared, and no selectors
    std::uint32_t rounds = 1;            ///< all walk in turns, so often
    bool in_triangles = false;           ///< the budget is of triangles: triangle_costs() are the walk's
};

/// Medians over the rounds, and sums where said.
struct ComparedSelector {
    std::string selector;  ///< or the name of settings
    double psnr_db = 0, worst_psnr_db = 0, ssim = 0, flip = 0;
    double min_psnr_db = 0, max_psnr_db = 0;     ///< of the rounds: the spread
    double accuracy_mean = 0, accuracy_min = 0;  ///< rad^-1; infinite: exact
    bool pops_compared = false;                  ///< else the next two are 0
    double popped_share = 0, pop_psnr_db = 0;    ///< of one pose by a frame's cut and by the cut before it
    double frame_ms_p50 = 0, frame_ms_p99 = 0, unused_ms = 0, switches_per_frame = 0;
    std::uint64_t frames = 0, misses = 0, coarse_frames = 0, floor_frames = 0;  ///< sums
    std::vector<report::PictureFigures> pictures;                               ///< of the first round
    std::vector<report::DroppedSummary> dropped_parts;                          ///< of the light, in the first round
    double dropped_per_frame = 0;                                               ///< visible objects that were left out
    bool goes_by_budget = true;                                                 ///< else no share of a budget's value is stated
    ValueShare value;                                                           ///< of the frames in Comparison::value
};

/// All that `surefoot compare` prints.
struct Comparison {
    std::string model, path, renderer, machine, uncalibrated;
    std::uint32_t width = 0, height = 0, rounds = 0, pictures = 0;
    double rate_hz = 0, budget_ms = 0;
    bool in_triangles = false;                ///< CompareRequest::in_triangles: budget_ms is triangle_budget_ms() of them
    bool of_settings = false;                 ///< CompareRequest::settings were compared
    ValueShares value;                        ///< frames 0: not compared, or none had anything to choose
    std::vector<ComparedSelector> selectors;  ///< in the order of the request
};

/// Costs of one us a triangle, and nothing else: a budget of us is one of triangles.
model::CostModel triangle_costs();
/// The time that a walk with these costs may spend on as many triangles; and back.
double triangle_budget_ms(double triangles);
std::uint64_t triangles_of_budget(double budget_ms);
/// Lets a walk spend triangles in place of time: by these costs, on the virtual clock, without correction, headroom or
/// hysteresis. Each frame is prepared for its own pose alone.
void spend_triangles(walk::WalkRequest& request);

/// How a walk is run: walk::run_walk, or a test's stand-in.
using RunWalk = std::function<Result<walk::WalkOutcome>(const walk::WalkRequest&, const Progress&)>;

/// Shares of the greatest value at this budget, for the names of the request that keep a budget; null: not compared.
using FindShares = std::function<Result<ValueShares>(std::span<const std::string> selectors, double budget_us, const Progress&)>;

/// The progress of walk `number` of `count`, from 0, as part of the whole. `progress` must outlive it.
Progress part_of(const Progress& progress, const std::string& stage, double number, double count);

/// Errors: of a walk; stopped by the user; a walk that compared no picture.
Result<Comparison> compare_selectors(const CompareRequest& request, const RunWalk& run_walk, const FindShares& find_shares,
                                     const Progress& progress);

std::string compare_json(const Comparison& comparison);
/// At most 100 columns; after a line that says what was walked, a line a selector of the pictures, then one of the frames.
std::string compare_table(const Comparison& comparison);

/// "200 triangles", or "26.7 ms".
std::string budget_text(const Comparison& comparison);

/// "shadows from frame 12 on, at 0.2 px/us; 40 frames without, dropped 1 time"
std::string dropped_words(const report::DroppedSummary& part);

/// Whether the page could be written to `dir` now. Call it before the walks.
Result<void> probe_compare_page(const std::string& dir);
/// DIR/index.html: triangles, accuracy and SNR picture by picture, a chart each; the charts alone as DIR/pictures.svg; and
/// DIR/pictures.csv.
Result<void> write_compare_page(const std::string& dir, const Comparison& comparison);

}  // namespace surefoot::accuracy
