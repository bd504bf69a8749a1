// The outputs of a sweep of budgets: CSV, JSON, charts and the one-page report.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::accuracy {

/// Figures of one selector at one budget.
struct AccuracyPoint {
    std::string selector;
    double budget_ms = 0, frame_ms_p50 = 0, frame_ms_p90 = 0, accuracy_mean = 0, snr_db = 0, ssim = 0, triangles = 0, cost_us = 0;
    std::uint32_t snr_undefined = 0, snr_infinite = 0, frames = 0;
    std::uint32_t exact = 0;     ///< frames drawn exactly: left out of accuracy_mean, which is infinite where all are
    double frame_ms_p99 = 0;     ///< of all timed frames; the other times are of the places' medians
    double accuracy_worst = 0;   ///< of the worst place, rad^-1; infinite: all are exact
    double error_m = 0;          ///< mean over the places: the largest geometric error that is drawn, wherever it is
    double psnr_db = 0;          ///< of the mean squared error over all places; report::max_psnr_db: all pictures are equal
    double flip = 0, value = 0;  ///< means; value: share of full detail's
    double estimated_gain = 0;   ///< of value by one more millisecond, as frames estimate it: the mean; 0: the selector has none
    /// No other point shows more in the same time, or as much in less: the worst accuracy in the p99, and PSNR in the median.
    bool accuracy_front = false, psnr_front = false;
};
/// Selectors with the published accounting are named so.
constexpr std::string_view published_ending = "-1994";

/// What one more millisecond buys at the budget that a rate allows.
struct OneMoreMs {
    AccuracyPoint now, more;  ///< at the budget, and at one millisecond more
};
/// One selector at the same budget with one setting changed. The first of a run is as swept.
struct ChangeMark {
    std::string change;  ///< "as swept", "no occlusion culling"
    AccuracyPoint point;
};
/// Marks the points that no other point beats.
void mark_fronts(std::vector<AccuracyPoint>& points);
/// All points of a sweep, and what they were measured with.
struct AccuracyRun {
    std::string model, path, renderer, machine;
    std::string uncalibrated;  ///< where this machine's cost table is missing: what, and the remedy
    std::uint32_t width = 0, height = 0, poses = 0;
    double shift_x = 0, shift_y = 0;  ///< off axis, half widths and half heights
    double full_frame_ms = 0;
    std::vector<AccuracyPoint> points;
    double rate_hz = 0, working_ms = 0;  ///< the rate, and the budget that it allows
    std::vector<OneMoreMs> one_more_ms;  ///< by selectors that go by a budget, the published ones left out
    std::vector<ChangeMark> changes;     ///< at the same budget; empty: no selector that goes by one was swept
};
/// The chart as a file of its own.
std::string accuracy_svg(const AccuracyRun& run, bool dark);
std::string worst_case_svg(const AccuracyRun& run, bool dark);
std::string accuracy_csv(const AccuracyRun& run);
std::string accuracy_json(const AccuracyRun& run);
/// Whether the page could be written to `dir` now. Call it before the sweep.
Result<void> probe_accuracy_page(const std::string& dir);
Result<void> write_accuracy_page(const std::string& dir, const AccuracyRun& run);

/// The chart without its frame, for a page: takes its colours from the page's style.
std::string accuracy_chart(const AccuracyRun& run);
/// The same of the worst place against the slowest frames, of PSNR and of FLIP; rings mark the fronts.
std::string worst_case_chart(const AccuracyRun& run);

}  // namespace surefoot::accuracy
