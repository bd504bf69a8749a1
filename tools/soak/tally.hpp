// Sums the figures of a soak, record by record. The frames of hours are not kept.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rt/frame/control.hpp"
#include "rt/frame/record.hpp"
#include "rt/monitor/histogram.hpp"
#include "tools/soak/plan.hpp"
#include "tools/soak/summary.hpp"

namespace surefoot::soak {

/// Fed by the monitor thread; read when that has ended. Memory is set aside by the constructor.
class SoakTally {
public:
    SoakTally(const LoadPlan& plan, std::int64_t period_ns, double seconds);

    /// Before the first record: when slot 0 is due.
    void begin(std::int64_t t0_ns) { t0_ns_ = t0_ns; }
    /// Every record in order, the control's too.
    void add(const rt::FrameRecord& record);
    /// Fills `summary`, except for machine, loads, samples and checks. `summary.walk` holds the walk's figures afterwards.
    void fill(SoakSummary& summary) const;
    [[nodiscard]] const std::vector<rt::BlockTally>& blocks() const { return blocks_.blocks(); }
    /// Seconds from the first slot to the end of the last.
    [[nodiscard]] double ran_s() const;

private:
    struct Phase {
        rt::Histogram frame_ns;
        std::uint64_t misses = 0, own_misses = 0, skipped = 0;
    };
    struct Column {
        std::uint32_t frames = 0, misses = 0;
        double low_ms = 0, sum_ms = 0, high_ms = 0, accuracy_min = 0;
    };
    void add_walk_frame(const rt::FrameRecord& record);
    void check_grid(const rt::FrameRecord& record);
    [[nodiscard]] double time_s(std::int64_t time_ns) const { return static_cast<double>(time_ns - t0_ns_) * 1e-9; }

    const LoadPlan& plan_;
    std::int64_t period_ns_ = 1, t0_ns_ = 0;
    double column_s_ = 1;
    rt::BlockTallies blocks_;
    rt::Histogram frame_ns_, wake_ns_, select_ns_, submit_ns_, raster_ns_, prepare_cpu_ns_, prepared_age_;
    std::array<std::uint64_t, rt::cause_count> causes_{};
    std::vector<Phase> phases_;
    std::vector<Column> columns_;
    std::vector<SoakMiss> misses_;
    std::uint64_t misses_unlisted_ = 0, skipped_ = 0, missed_ = 0, own_missed_ = 0;
    double accuracy_min_ = 0, accuracy_sum_ = 0, triangles_sum_ = 0;
    report::GuaranteeSummary guarantee_;
    std::uint64_t accuracy_frames_ = 0, triangles_max_ = 0, downgrades_ = 0, floor_bound_ = 0, switches_ = 0;
    std::uint64_t page_faults_ = 0, driver_faults_ = 0, driver_allocations_ = 0, guard_violations_ = 0;
    // The grid.
    bool any_ = false, last_was_walk_ = false, last_miss_listed_ = false;
    std::size_t last_phase_ = 0;
    std::uint64_t last_slot_ = 0, run_ = 0, skipped_all_ = 0, lost_ = 0;
    std::int64_t drift_ns_ = 0, last_end_ns_ = 0;
};

}  // namespace surefoot::soak
