// The outputs of a walk: ledger, trace, table, JSON, and the one-page report.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "rt/base/modes.hpp"
#include "rt/base/result.hpp"
#include "rt/base/statistics.hpp"
#include "rt/frame/control.hpp"
#include "rt/frame/record.hpp"
#include "rt/monitor/facts.hpp"
#include "rt/threads/capability.hpp"
#include "rt/threads/census.hpp"

namespace surefoot {
class AtomicFile;
}

namespace surefoot::report {

/// Counts of one block of the control.
struct ControlBlock {
    bool walk = false;  ///< else the bare loop
    std::uint32_t frames = 0, misses = 0, own_misses = 0;
    double steal_ms = 0;
};

/// The control of a walk, with its verdict.
struct ControlSummary {
    bool ran = false;
    rt::DeadlineVerdict verdict;
    double burn_ms = 0;            ///< CPU time of a bare frame: the mean of the walk's on the frame core
    double other_miss_share = -1;  ///< the load proof under SCHED_OTHER; -1 not run
    std::vector<ControlBlock> blocks;
};

/// The input that steered the walk, and the age of its reports.
struct InputSummary {
    bool given = false;  ///< false: a path was followed
    std::string source;  ///< the recording
    std::vector<rt::SteeringDevice> devices;
    std::uint64_t reports = 0;                ///< accepted
    std::uint64_t reports_shown = 0;          ///< of them, those in the pose of some frame; the others came after the last frame
    std::uint64_t refused = 0;                ///< short, long, undeclared: they changed nothing
    std::uint64_t illegal_encoder_steps = 0;  ///< of wired encoders: missed steps, whose direction is unknown
    Quantiles age_ms;                         ///< a report's, from its stamp until the first frame that holds it was submitted
    Quantiles to_shown_ms;                    ///< the same until its picture was shown; all 0 where none was
    std::uint64_t stops = 0;                  ///< emergency stops
    std::uint64_t stopped_frames = 0;         ///< that stood still by order: emergency stop or dead-man
    bool stop_latched = false;                ///< at the end
    std::uint64_t timeouts = 0, overflows = 0, losses = 0;
    std::uint64_t next_viewpoint = 0, reset = 0, tour = 0, pause = 0;  ///< presses
    rt::SwitchPresses switches;                                        ///< of the light
    std::uint64_t jumps = 0;                                           ///< placings elsewhere
    bool walked = false;                   ///< walls and floors held the visitor; false: it flew, or the model has no ground
    std::uint64_t returns = 0, freed = 0;  ///< of the walker: from being stuck, and out of something solid
    std::uint64_t put_aside = 0, passed_through = 0;  ///< by things that move and left no room: beside them, or not at all
    double filter_lag_ms = 0;                         ///< at most, of mapping and filter
    std::uint64_t guard_violations = 0;               ///< of the input thread
};

/// A form that was drawn where full detail would show more. Its share of the error is measured in the pictures where it was
/// tried: there it is drawn in full detail, while all else stays. Shares of several forms need not add up: one may hide another.
struct WorstForm {
    std::uint32_t node = 0;             ///< of the model
    std::string name, node_kind, form;  ///< the node's name, may be empty; cluster, object or piece; the kind of form
    std::uint64_t triangles = 0;
    double error_share = 0;      ///< of the squared error of all compared pictures
    std::uint32_t pictures = 0;  ///< in which it was tried
    std::uint64_t frame = 0;     ///< where it costs most
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> walk, full;  ///< RGBA8: that part of that frame's picture, and of full detail
};
/// Pictures of the walk against full detail, drawn after the walk.
struct PictureSummary {
    std::uint32_t frames = 0;       ///< compared; 0: none, and no figure holds
    double psnr_db = 0;             ///< of the mean squared error over all of them; at most max_psnr_db
    double worst_psnr_db = 0;       ///< of one frame
    std::uint64_t worst_frame = 0;  ///< its number
    double ssim = 0, flip = 0;      ///< means
    /// Popping: pictures of one pose by this frame's cut and by the cut of the frame before.
    std::uint32_t pop_frames = 0;  ///< compared so; 0: none, and no figure holds
    double popped_share = 0;       ///< mean share of pixels that change by over visible_steps
    double worst_popped_share = 0;
    double pop_psnr_db = 0;       ///< as psnr_db
    bool forms_compared = false;  ///< with a report; else the next two hold nothing, and JSON lacks them
    /// What costs the pictures most, first.
    std::vector<WorstForm> worst_forms = {};
    /// Of the squared error, what full detail has too at the frames' resolutions.
    double resolution_error_share = 0;
};
/// A change of R, G or B by more is taken to be visible: 3 % of full scale.
constexpr int visible_steps = 8;
/// PSNR of equal pictures: no other pair of 8-bit pictures below 4000 x 4000 pixels reaches it.
constexpr double max_psnr_db = 130;
/// Of a mean squared error of 8-bit channels; at most max_psnr_db.
double psnr_db(double mse);

/// What became of the accuracy that all frames guarantee.
struct GuaranteeSummary {
    double accuracy = 0;                          ///< rad^-1; 0: nothing was guaranteed, and no figure holds
    std::uint64_t kept = 0;                       ///< frames that had it
    std::map<std::string, std::uint64_t> broken;  ///< frames that did not, by reason
    double reached_min = 0;                       ///< rad^-1 of the worst frame; infinite: all were exact
    std::uint64_t worst_frame = 0;                ///< its number
    std::uint32_t binding_node = rt::no_node;     ///< of the model: what was worst in it
    std::string binding_name;                     ///< the node's; may be empty
};

/// Adds a frame of the walk.
void count_guarantee(const rt::FrameRecord& frame, GuaranteeSummary& guarantee);
/// "100 /rad in 580 frames; not in 20 (over_budget); worst 88 /rad in frame 77: node 12 (door)".
std::string guarantee_words(const GuaranteeSummary& guarantee);

/// When pictures were shown, measured as `by` says. All zero where none was shown: on the virtual clock.
struct ShownSummary {
    rt::ShownBy by = rt::ShownBy::nothing;
    Quantiles interval_ms;          ///< of pictures whose frames follow one another
    Quantiles animation_error_ms;   ///< |interval - interval of the times that the poses are of|
    Quantiles error_us;             ///< |shown - planned|; all zero with the late policy float, which plans no time
    bool on_grid = false;           ///< error_us is known
    double one_percent_low_hz = 0;  ///< 1 / p99 of interval_ms
};

/// What the display itself reported of pictures, apart from the records, which are written before it does (X Present).
struct DisplaySummary {
    std::uint64_t pictures = 0;  ///< that it showed; 0: it reports nothing, and no figure holds
    std::uint64_t replaced = 0;  ///< by a newer one, before they were shown
    Quantiles after_ms;          ///< from a picture's hand-over until it was shown; of the newest 65 536
};

/// Where the eye is before the screen.
struct SeatSummary {
    bool given = false;
    double screen_width_cm = 0, eye_distance_cm = 0;
    double fov_x_deg = 0, fov_y_deg = 0;  ///< of a screen straight before the eye, in every pose
};

/// A part of the light that frames bought, or left out because forms showed more for the time.
struct DroppedSummary {
    std::string_view part;          ///< name of its switch
    std::uint64_t frames = 0;       ///< that were drawn without it
    std::uint64_t falls = 0;        ///< times that it was dropped
    std::uint64_t first_frame = 0;  ///< that dropped it
    double first_value_per_us = 0;  ///< in that frame; weighted pixels
};

/// What the image cache did in a walk. Times are predictions.
struct PicturesSummary {
    double drawn_mean = 0;                      ///< in a frame's picture
    double reused_mean = 0;                     ///< of these: made by earlier frames
    double as_triangles_mean = 0;               ///< boxes in view whose contents no picture shows
    std::uint64_t made = 0;                     ///< bought
    std::uint64_t max_bytes = 0;                ///< of the pictures that were held
    double draw_us_mean = 0, make_us_mean = 0;  ///< of a frame
    double make_us_max = 0;
    std::uint64_t uncovered = 0;  ///< items that were drawn in place of pictures that were not valid any more
    [[nodiscard]] bool any() const { return made > 0 || drawn_mean > 0; }
};

/// All that `walk --json` prints, computed once from the records. Its fields are a contract: names are added, never changed.
struct WalkSummary {
    std::string model, path, selector, backend, renderer, machine, late_policy, clock;
    std::uint32_t width = 0, height = 0;
    double shift_x = 0, shift_y = 0;  ///< off axis, in halves of the picture
    SeatSummary seat;
    double acuity_arcmin = 0;       ///< angle that the eye tells apart; 0: unknown, pixels decide
    std::uint32_t rasterisers = 1;  ///< threads that share raster_cpu_ns; set before summarize
    double rate_hz = 0, seconds = 0;
    std::uint64_t frames = 0, slots = 0, skipped = 0, misses = 0, own_misses = 0;
    std::map<std::string, std::uint64_t> miss_causes;
    bool core_steal_known = false;        ///< the kernel told the steal of the frame's cores
    std::uint64_t core_steal_misses = 0;  ///< that looked like work, and are `stolen` by the steal of the frame's cores
    Quantiles frame_ms, wake_us, select_us, prepare_cpu_us, prepared_age, cost_error, submit_ms, raster_ms, visits, hidden;
    double cost_scale = 1;  ///< the setting
    double budget_ms = 0, budget_used_mean = 0, budget_used_p99 = 0, budget_used_wall_mean = 0;
    double accuracy_min = 0, accuracy_mean = 0, triangles_mean = 0, switches_per_frame = 0;
    double dropped_per_frame = 0;               ///< visible objects that were left out; only by selectors that are for comparison
    std::vector<DroppedSummary> dropped_parts;  ///< that were dropped; the one that went first comes first
    GuaranteeSummary guarantee;
    std::uint64_t rest_frames = 0, rested_frames = 0;  ///< that drew no cut; those of them that showed full detail
    std::uint32_t rest_samples = 0;                    ///< of the smoothest picture at rest
    double rest_ms = 0;  ///< longest time from the first frame of a rest until full detail was shown; 0: it never was
    double resolution_mean = 1, resolution_min = 1;          ///< share of the picture's sides at which frames were drawn
    std::uint32_t samples = 1;                               ///< of a pixel, as the last frame was drawn
    bool other_samples = false;                              ///< the driver lacks the requested number
    rt::TextureFilter filter = rt::TextureFilter::bilinear;  ///< as the last frame was drawn
    std::uint64_t trilinear_frames = 0;
    std::uint64_t shadow_refreshes = 0, shadow_frames = 0;  ///< of the shadow map of what moves: bought; pictures that show it
    PicturesSummary pictures;                               ///< of the image cache
    std::uint64_t coarse_frames = 0;                        ///< with a slice that the in-frame check drew coarser
    std::uint64_t floor_frames = 0;  ///< over half of the picture fell to floor forms, although the cut before would have fitted
    /// Time between the end of drawing and the deadline, of frames below full resolution or whose value is below 0.99 or not
    /// known.
    Quantiles unused_ms;
    std::uint64_t triangles_max = 0, downgrades = 0, floor_bound_frames = 0, model_triangles = 0;
    std::string cut_hash;  ///< 16 hex digits over all frames
    double steal_ms = 0;   ///< as the host says, set before summarize; at least what the frames lost
    bool fifo = false, pinned = false, isolated = false, locked = false;
    std::uint64_t page_faults = 0, guard_violations = 0, driver_faults = 0, driver_allocations = 0;
    std::vector<std::string> census_problems;
    double driver_allocations_per_frame = 0;
    std::vector<rt::CensusRow> threads;  ///< of the census, early in the walk; empty where none was taken
    std::string uncalibrated;            ///< the cost table is missing: what, and the remedy
    std::vector<rt::Lack> degraded;      ///< what is not real-time here, and how to grant it
    ControlSummary control;
    ShownSummary shown;
    DisplaySummary display;
    InputSummary input;
    PictureSummary picture;
};

/// Pure: quantiles and sums over the records (control blocks' bare frames excluded from the walk's figures).
void summarize(std::span<const rt::FrameRecord> records, std::int64_t period_ns, WalkSummary& summary);

std::string to_json(const WalkSummary& summary);
/// The table for a terminal, at most 100 columns.
std::string to_table(const WalkSummary& summary, bool colour);

Result<void> write_ledger(const std::string& file, std::span<const rt::FrameRecord> records);
Result<void> write_ledger(AtomicFile& out, std::span<const rt::FrameRecord> records);  ///< not committed
/// Chrome trace events: opens in Perfetto. Expected and actual slices a frame, phases, misses with their cause.
Result<void> write_trace(const std::string& file, std::span<const rt::FrameRecord> records);

/// One place along the path: the walk's picture, full detail, difference, and the top view of what was drawn.
struct ReportSnapshot {
    std::uint64_t frame = 0;
    double time_s = 0;
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> walk, full, difference;  ///< RGBA8; may be empty (null backend)
    double snr_db = 0, ssim = 0, flip = 0;
    double mse = 0;              ///< mean squared error of R, G and B bytes
    bool pops_compared = false;  ///< with the cut of the frame before, drawn at this pose; else the next two are 0
    double popped_share = 0, pop_mse = 0;
    std::uint64_t triangles = 0, full_triangles = 0;
    float accuracy = 0, resolution = 1;
    /// Top view (key 't' of the walkthrough program in Maciel 1994, figure 3.20): rectangles of the drawn nodes in the XZ plane,
    /// world metres.
    struct Rect {
        float x0, z0, x1, z1;
        int kind;
        float detail;
    };  ///< kind: 0 cluster, 1 object, 2 piece; detail 0 coarse..1 full
    std::vector<Rect> drawn;
    std::array<double, 3> eye{}, forward{};
    double left_rad = -0.5, right_rad = 0.5;  ///< of forward: the sides of the view
    /// Bird's-eye view of the image cache, RGBA8, birds_eye_px on each side; empty without one. Its boxes by what they show.
    std::vector<std::uint8_t> birds_eye;
    std::uint32_t birds_eye_px = 0, new_pictures = 0, reused_pictures = 0, boxes_as_triangles = 0;
    std::array<double, 4> world_xz{};  ///< min x, min z, max x, max z
};

/// One compared picture of a walk, without its pixels.
struct PictureFigures {
    std::uint64_t frame = 0, triangles = 0, full_triangles = 0;
    float accuracy = 0;  ///< rad^-1; infinite: exact
    double snr_db = 0, mse = 0, ssim = 0, flip = 0;
};
PictureFigures figures_of(const ReportSnapshot& snapshot);

/// Of snapshots with pictures; those without are passed over.
PictureSummary compare_pictures(std::span<const ReportSnapshot> snapshots);

/// DIR/index.html, self-contained (SVG and data-URI pictures, light and dark, no network), and DIR/ledger.csv, DIR/walk.json.
Result<void> write_report(const std::string& dir, const WalkSummary& summary, std::span<const rt::FrameRecord> records,
                          std::span<const ReportSnapshot> snapshots);

/// Figure 3.4 of Maciel 1994 for this machine: cost against pixels, a line a triangle count, a panel a state class.
struct CostPoint {
    std::string state;
    double triangles, pixels, cost_us;
};
std::string cost_plot_svg(const std::string& title, std::span<const CostPoint> points);

}  // namespace surefoot::report
