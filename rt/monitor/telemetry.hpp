// Live figures of a walk: the monitor thread sums times and counts of all records, and publishes copies for one reader. Neither
// waits for the other. The frame thread is not involved.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "rt/clock/grid.hpp"
#include "rt/exchange/triple_buffer.hpp"
#include "rt/frame/record.hpp"
#include "rt/monitor/histogram.hpp"

namespace surefoot::rt {

/// Upper edges of exact cumulative counts, ascending and distinct. They are round times from 10 us to 10 s, and multiples
/// of the period T that are dense near the deadline. These are 1/4, 1/2, 3/4, 7/8, 15/16, 1, 5/4 and 2.
class Edges {
public:
    static constexpr std::size_t max_edges = 27;
    Edges() : Edges(16'666'667) {}
    explicit Edges(std::int64_t period_ns);
    [[nodiscard]] std::span<const std::int64_t> ns() const { return {edges_ns_.data(), count_}; }

private:
    std::array<std::int64_t, max_edges> edges_ns_{};
    std::size_t count_ = 0;
};

/// Distribution of nanoseconds, any value: without loss in the histogram, and exact at the edges.
struct Distribution {
    Histogram fine;
    std::array<std::uint64_t, Edges::max_edges + 1> up_to{};  ///< [i]: above edge i-1, at most edge i; the last: above all edges

    void add(const Edges& edges, std::int64_t value_ns);
    void add_progression(const Edges& edges, std::int64_t first_ns, std::int64_t step_ns, std::uint64_t times);
};

/// The measured distributions. Every slot is in exactly one of slack and lateness:
/// slack.count + lateness.count = frames + skipped slots.
enum class Series : std::uint8_t {
    wake,             ///< due -> woken
    prepare,          ///< CPU time of the workers for the set that the frame used
    select,           ///< woken -> selected
    submit,           ///< selected -> submitted
    raster,           ///< submitted -> last fence
    present,          ///< handed to the display -> presented; where pictures are not presented: last fence -> complete
    frame,            ///< due -> complete
    slack,            ///< of frames in time: complete -> deadline
    lateness,         ///< of late frames: deadline -> complete, or planned -> presented where only that was late; of a skipped
                      ///< slot: its deadline -> the next frame complete
    shown_interval,   ///< from one shown picture to the next, of frames that follow one another
    shown_error,      ///< |shown - planned| of pictures that are planned for a point of the grid (late policy lock)
    animation_error,  ///< |shown interval - interval of the times that the poses are of|
    input_age,        ///< of a frame with new reports: stamp of the newest -> submitted
    input_to_shown    ///< of such a frame whose picture was shown: stamp of the newest -> shown
};
constexpr std::size_t series_count = 14;

/// One of the last frames, for live views.
struct RecentFrame {
    float frame_us = 0, wake_us = 0, slack_us = 0;
    float used = 0;        ///< of the period, CPU time of frame thread and rasterisers
    float resolution = 1;  ///< share of the picture's sides that was drawn
    float accuracy = 0;    ///< rad^-1; infinite where all was exact
    std::uint32_t skipped_before = 0;
    bool missed = false;
    Cause cause = Cause::none;
};

/// What the figures are counted against.
struct TelemetrySetup {
    std::int64_t period_ns = 16'666'667;
    LatePolicy late = LatePolicy::lock;
    std::uint32_t rasterisers = 1;  ///< threads that raster_cpu_ns is spread over
};

/// Everything that a reader may want, in one plain block (about 220 KiB). The control's bare frames count in bare_frames only.
struct Figures {
    static constexpr std::size_t max_recent = 1024;

    TelemetrySetup setup;
    Edges edges;
    std::array<Distribution, series_count> series;
    std::array<std::uint64_t, cause_count> misses{};  ///< by cause; [none] stays 0
    std::uint64_t frames = 0, skipped_slots = 0, bare_frames = 0;
    std::uint64_t lost_slots = 0;         ///< records that did not fit into the ring; nothing is known of these slots
    bool core_steal_known = false;        ///< FrameRecord::core_steal_ns of any frame is
    std::uint64_t core_steal_misses = 0;  ///< FrameRecord::by_core_steal
    std::uint64_t own_misses = 0, downgraded_slices = 0, slices = 0, switches = 0, triangles = 0;
    std::uint64_t minor_faults = 0, major_faults = 0, driver_faults = 0, driver_allocations = 0, guard_violations = 0;
    std::uint64_t input_reports = 0, stopped_frames = 0, floor_frames = 0, rest_frames = 0, continues = 0;
    std::uint64_t broken_guarantees = 0;                                       ///< frames below the accuracy that is guaranteed
    std::uint64_t trilinear_frames = 0;                                        ///< that blended two mip levels
    std::uint64_t pictures_shown = 0, pictures_made = 0, uncovered_items = 0;  ///< of the image cache, as in the records
    double captures_us = 0;                                                    ///< predicted, to make those pictures
    std::array<std::uint64_t, shown_by_names.size()> shown_by{};               ///< frames, by who told when they were shown
    std::int64_t stolen_ns = 0, preempted_ns = 0, frame_cpu_ns = 0, raster_cpu_ns = 0;
    double prepare_cpu_us = 0;
    FrameRecord last;  ///< newest frame of the walk; meaningless while frames is 0
    std::array<RecentFrame, max_recent> recent{};
    std::uint64_t recent_count = 0;  ///< ever; the i-th is recent[i % max_recent]

    [[nodiscard]] const Distribution& of(Series s) const { return series[static_cast<std::size_t>(s)]; }
    [[nodiscard]] std::uint64_t all_misses() const;
    /// slots = frames + skipped_slots + lost_slots
    [[nodiscard]] std::uint64_t slots() const { return frames + skipped_slots + lost_slots; }
    /// Who tells when pictures are shown: the display where it told of any, else the hand-over; nothing where none was shown.
    [[nodiscard]] ShownBy shown_by_whom() const;
    /// 1 / p99 of shown_interval; 0 before the second frame.
    [[nodiscard]] double one_percent_low_hz() const;
};

/// One writer (the monitor thread; begin() before it starts) and one reader. About 900 KiB: keep it on the heap.
class Telemetry {
public:
    static constexpr std::int64_t publish_ns = 250'000'000;

    Telemetry() = default;
    /// A walk begins. Counts go on from the last one; with another period, whose edges are others, they start from zero.
    void begin(const TelemetrySetup& setup);
    /// Call in order. Publishes every publish_ns of the records' time.
    void add(const FrameRecord& record);
    void publish();
    [[nodiscard]] const Figures& figures() const { return figures_; }

    /// Reader: the newest published figures; they stay until the next call.
    const Figures& newest();

private:
    void count(const FrameRecord& f);
    void add_times(const FrameRecord& f);
    void add_shown(const FrameRecord& f);
    void add_recent(const FrameRecord& f);
    Distribution& of(Series s) { return figures_.series[static_cast<std::size_t>(s)]; }

    Figures figures_;
    bool follows_ = false;  ///< previous_ is the record just before, and the walk's
    bool shown_ = false;    ///< and its picture was shown
    bool any_ = false;      ///< of this walk
    std::uint64_t next_slot_ = 0;
    std::int64_t previous_due_ns_ = 0, previous_shown_ns_ = 0;
    std::uint64_t reports_seen_ = 0;
    std::int64_t published_ns_ = 0;
    TripleBuffer<Figures> published_;
};

}  // namespace surefoot::rt
