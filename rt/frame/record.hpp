// The record of a frame: times, predictions, counts, and the cause of a miss. Plain data for the ring.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "rt/base/light.hpp"
#include "rt/base/modes.hpp"
#include "rt/base/shown.hpp"

namespace surefoot::rt {

/// The cause of a miss, one a frame. none: on time.
enum class Cause : std::uint8_t {
    none,
    woken_late,
    stolen,
    preempted,
    select,
    submit,
    raster,
    upload,
    prepared_too_old,
    page_fault,
    present,
    stopped
};
constexpr int cause_count = 12;
constexpr std::array<std::string_view, cause_count> cause_names = {
    "none",   "woken_late", "stolen",           "preempted",  "select",  "submit",
    "raster", "upload",     "prepared_too_old", "page_fault", "present", "stopped"};

/// FrameRecord::binding_node where no drawn node has an error.
constexpr std::uint32_t no_node = 0xFFFFFFFF;

/// Times in integer nanoseconds of CLOCK_MONOTONIC (or of the virtual clock).
struct FrameRecord {
    std::uint64_t slot = 0;     ///< grid slot; skipped slots are the gaps
    std::uint64_t frame = 0;    ///< frames run, from 0
    std::int64_t due_ns = 0;    ///< t0 + slot * T
    std::int64_t ready_ns = 0;  ///< earliest start: due_ns, or later by what presenting the frame before took of this slot
    std::int64_t woken_ns = 0;
    std::int64_t selected_ns = 0;    ///< sample, select and slice plan done
    std::int64_t submitted_ns = 0;   ///< last slice handed to the driver
    std::int64_t rastered_ns = 0;    ///< last fence passed
    std::int64_t complete_ns = 0;    ///< end of the frame's work: its picture is whole
    std::int64_t deadline_ns = 0;    ///< by when it must be whole: due + T, less the time that presenting usually takes
    std::int64_t show_ns = 0;        ///< when it was to be shown: on the grid (lock), or by the end of the slot (float)
    std::int64_t handed_ns = 0;      ///< presenting began; this and the next are 0 where pictures are not presented
    std::int64_t presented_ns = 0;   ///< presenting ended
    std::int64_t shown_ns = 0;       ///< the picture was shown, as shown_by tells; else 0
    std::int64_t cpu_ns = 0;         ///< frame thread's own CPU time
    std::int64_t raster_cpu_ns = 0;  ///< of the driver's rasterisers; 0 where unknown
    std::int64_t stolen_ns = 0;      ///< wall minus CPU minus known waits, with no involuntary switch
    std::int64_t preempted_ns = 0;   ///< the same gap, where involuntary switches were seen
    std::int64_t waited_ns = 0;      ///< known waits: for the driver's rasterisers, for the display; not for the time of showing
    std::int64_t upload_ns = 0;
    /// Growth of the host's steal in the readings round the frame, of the core where it grew most; -1: the kernel did not say.
    /// Filled after the frame, by StealEvidence.
    std::int64_t core_steal_ns = -1;
    std::int64_t input_stamp_ns = 0;                   ///< of the newest report in this frame's pose; 0: none
    std::uint64_t input_reports = 0;                   ///< in its pose, since the walk began
    std::uint32_t skipped_before = 0;                  ///< slots skipped just before this one
    std::uint32_t voluntary = 0, involuntary = 0;      ///< context switches in the frame
    std::uint32_t minor_faults = 0, major_faults = 0;  ///< in own code
    std::uint32_t driver_faults = 0, driver_allocations = 0, guard_violations = 0;
    std::uint32_t continued = 0;     ///< times the process was stopped and continued since the last frame
    std::uint32_t prepared_age = 0;  ///< frames; 1 is the newest possible
    std::uint32_t slices = 0, downgraded_slices = 0;
    std::uint32_t items = 0, draws = 0, switches = 0, visits = 0, hidden = 0, candidates = 0;
    std::uint32_t bought_items = 0;   ///< what time was spent on beside the forms: a resolution, an upload, an effect
    std::uint32_t refused_items = 0;  ///< offered with a cost or a value that is no number above zero, or twice
    std::uint32_t rest_samples = 0;   ///< of the shown picture: 1 is full detail; 0: it is a cut
    std::uint64_t triangles = 0;
    std::uint64_t cut_hash = 0;
    float predicted_us = 0, actual_us = 0, budget_us = 0, floor_us = 0, correction = 1;
    float cost_scale = 1;  ///< the setting's factor in predicted_us (real clock) or in actual_us (virtual clock)
    float prepare_cpu_us = 0;
    float bought_us = 0;  ///< of predicted_us, without correction: what bought_items cost
    float accuracy = 0;   ///< rad^-1, of the drawn items
    /// rad^-1: the setting min_accuracy, or what a selector by accuracy alone was to reach; 0: nothing is guaranteed.
    float guaranteed_accuracy = 0;
    float reached_accuracy = 0;  ///< as accuracy, of errors times importance
    Guarantee guarantee = Guarantee::none;
    std::uint32_t binding_node = no_node;  ///< of the model: the node of reached_accuracy; no_node: all is exact
    float value = 0;        ///< share of full detail's value that is drawn, 0..1, without blur; 0: not known, no set was used
    float one_more_ms = 0;  ///< share of full detail's value that one more millisecond would have shown, as estimated
    std::uint32_t dropped_objects = 0;  ///< visible ones that were left out; only by selectors that are for comparison
    float floor_share = 0;       ///< of the picture, as estimated: what shows the cheapest forms of nodes that have finer ones
    bool floor_frame = false;    ///< over half of the picture fell to floor forms, although the cut before would have fitted
    float resolution = 1;        ///< share of the picture's sides at which it was drawn
    std::uint32_t samples = 1;   ///< of a pixel
    bool other_samples = false;  ///< the driver lacks the requested number
    TextureFilter filter = TextureFilter::bilinear;
    bool by_core_steal = false;  ///< a miss that the clocks alone would call own, and `stolen` by core_steal_ns
    bool missed = false, own_miss = false, floor_binds = false, control = false, snapped = false;
    ShownBy shown_by = ShownBy::nothing;
    bool at_rest = false;                           ///< no cut was drawn: the shown picture stays, or full detail replaces it
    std::uint32_t pictures = 0, pictures_made = 0;  ///< of the image cache: in the frame's picture; bought by it
    std::uint32_t pictures_reused = 0;              ///< of pictures: made by earlier frames
    std::uint32_t boxes_as_triangles = 0;           ///< of the image cache, in view: no picture shows their contents
    std::uint32_t uncovered_items = 0;              ///< drawn in place of pictures that were not valid any more
    float pictures_us = 0, captures_us = 0;         ///< predicted: to draw the pictures, and to make those that were bought
    std::uint64_t picture_bytes = 0;                ///< of all pictures that are held
    bool shadow_refreshed = false, shadow_shown = false;    ///< the shadow map of what moves: bought by the frame; in its picture
    ShownLight light;                                       ///< of the walk's frames
    std::array<DroppedPart, switch_count> dropped_parts{};  ///< of the light, by light_switches; where frames buy them
    bool stopped = false;  ///< the input stands still by order (emergency stop, dead-man); not a cause of a miss
    Cause cause = Cause::none;
    std::uint32_t block = 0;              ///< control blocks: number of the 2 s block
    std::array<double, 3> eye{};          ///< metres
    std::array<double, 4> orientation{};  ///< x, y, z, w
};

/// By how much a missed frame was late: its picture was whole after the deadline, or shown after its time.
inline std::int64_t late_ns(const FrameRecord& f) {
    return f.complete_ns <= f.deadline_ns && f.show_ns > 0 ? f.presented_ns - f.show_ns : f.complete_ns - f.deadline_ns;
}

/// Time left at a frame's end; below zero: how late it was.
inline std::int64_t slack_ns(const FrameRecord& f) { return f.missed ? -late_ns(f) : f.deadline_ns - f.complete_ns; }

inline std::string_view cause_of(const FrameRecord& f) { return cause_names[static_cast<std::size_t>(f.cause)]; }

/// CPU time used by the frame, ns: that of the frame thread, plus that of the rasterisers divided by their number. If a CPU clock
/// is unknown (GPU, virtual clock): the wall time of that part minus stolen time.
inline double busy_ns(const FrameRecord& f, std::uint32_t rasterisers) {
    const double stolen = static_cast<double>(f.stolen_ns);
    const double raster_wall = std::max(0.0, static_cast<double>(f.rastered_ns - f.submitted_ns) - stolen);
    if (f.cpu_ns <= 0) return std::max(0.0, static_cast<double>(f.rastered_ns - f.woken_ns) - stolen);
    const double raster = f.raster_cpu_ns > 0 ? static_cast<double>(f.raster_cpu_ns) / std::max(1U, rasterisers) : raster_wall;
    return static_cast<double>(f.cpu_ns) + raster;
}

}  // namespace surefoot::rt
