// What a frame's clocks and counters say about it.
#include "rt/frame/frame_account.hpp"

#include <algorithm>

namespace surefoot::rt {

namespace {

std::uint32_t small(std::uint64_t count) { return static_cast<std::uint32_t>(std::min<std::uint64_t>(count, UINT32_MAX)); }

}  // namespace

std::int64_t WaitEstimate::known_ns(std::int64_t wait_ns, ThreadClocks::Spent rasterisers, bool slept) const {
    if (wait_ns <= 0) return 0;
    if (rasterisers.sum_ns <= 0) return slept ? wait_ns : 0;
    if (count_ < window) return std::min(wait_ns, rasterisers.sum_ns);
    std::array<double, window> sorted = ratios_;
    std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
    const auto expected = static_cast<std::int64_t>(sorted[rank] * static_cast<double>(rasterisers.sum_ns));
    return std::min(wait_ns, std::clamp(expected, std::min(rasterisers.longest_ns, rasterisers.sum_ns), rasterisers.sum_ns));
}

void WaitEstimate::update(std::int64_t wait_ns, ThreadClocks::Spent rasterisers) {
    if (wait_ns <= 0 || rasterisers.sum_ns <= 0) return;
    ratios_[next_] = static_cast<double>(wait_ns) / static_cast<double>(rasterisers.sum_ns);
    next_ = (next_ + 1) % window;
    count_ = std::min(count_ + 1, window);
}

FrameAccount::FrameAccount(const FrameLoopOptions& options, Clock& clock)
    : options_(options),
      clock_(clock),
      limits_(options.limits),
      rasterisers_(options.rasterisers),
      on_core_(options.rasterisers_on_core) {
    limits_.period_ns = options.period_ns;
    before_ = clock_.usage();
    guard_before_ = guard_counters();
    continued_before_ = continues();
}

std::uint32_t FrameAccount::continues() const {
    return options_.continued != nullptr ? options_.continued->load(std::memory_order_relaxed) : 0;
}

void FrameAccount::begin(FrameRecord& record) {
    record.woken_ns = clock_.now_ns();
    rasterisers_.start();
    on_core_.start();
    begun_ns_ = clock_.now_ns();
    begun_ = clock_.usage();
}

void FrameAccount::own_done(FrameRecord& record) {
    record.selected_ns = clock_.now_ns();
    selected_ = clock_.usage();
}

/// Read until no stop falls between the two: a stop is counted in the frame that it makes late. One that comes later makes the
/// next frame wake late, and is counted there.
void FrameAccount::read_end(std::int64_t& now_ns, FrameRecord& record) {
    std::uint32_t continued = 0;
    do {
        continued = continues();
        now_ns = clock_.now_ns();
    } while (continues() != continued);
    record.continued += continued - continued_before_;
    continued_before_ = continued;
}

void FrameAccount::driver_done(FrameRecord& record) {
    read_end(record.complete_ns, record);
    ended_ = clock_.usage();
    if (record.submitted_ns == 0) record.submitted_ns = record.complete_ns;
    if (record.rastered_ns == 0) record.rastered_ns = record.complete_ns;
}

/// The wait for the display: that part of an unexplained voluntary wait by which presenting exceeded its share. After the last
/// fence the thread waits only for the display. If the host steals time just there, it counts as a wait too, and the miss as own.
/// That part of a frame is short.
std::int64_t FrameAccount::display_wait_ns(const FrameRecord& record, std::int64_t unexplained_ns) const {
    const auto share_ns = static_cast<std::int64_t>(limits_.present_share * static_cast<double>(limits_.period_ns));
    return std::clamp<std::int64_t>(record.complete_ns - record.rastered_ns - share_ns, 0,
                                    std::max<std::int64_t>(unexplained_ns, 0));
}

void FrameAccount::close(FrameRecord& record) {
    const ThreadUsage own = selected_ - begun_, driver = ended_ - selected_, frame = ended_ - begun_;
    const ThreadClocks::Spent raster = rasterisers_.spent();
    record.cpu_ns = frame.cpu_ns;
    record.raster_cpu_ns = raster.sum_ns;
    core_cpu_ns_ = frame.cpu_ns + on_core_.spent().sum_ns;
    record.voluntary = small(frame.voluntary);
    record.involuntary = small(frame.involuntary);

    // Own code never waits, so all of its gap was lost. The driver's phases wait for the rasterisers; the rest of their gap was
    // lost.
    const std::int64_t own_gap = std::max<std::int64_t>(record.selected_ns - begun_ns_ - own.cpu_ns, 0);
    const std::int64_t wait = std::max<std::int64_t>(record.complete_ns - record.selected_ns - driver.cpu_ns, 0);
    record.waited_ns = estimate_.known_ns(wait, raster, driver.voluntary > 0);
    estimate_.update(wait, raster);
    if (driver.voluntary > 0 && frame.involuntary == 0) record.waited_ns += display_wait_ns(record, wait - record.waited_ns);
    const std::int64_t gap = own_gap + wait - record.waited_ns;
    (frame.involuntary > 0 ? record.preempted_ns : record.stolen_ns) = gap;

    // Outside the driver's phases everything is own code, the time between frames included.
    const ThreadUsage between = begun_ - before_;
    record.minor_faults = small(between.minor_faults + own.minor_faults);
    record.major_faults = small(between.major_faults + own.major_faults);
    record.driver_faults = small(driver.minor_faults + driver.major_faults);
    before_ = ended_;

    record.missed = record.complete_ns > record.deadline_ns;
    record.own_miss = is_own_miss(record, limits_);
    record.cause = blame(record, limits_);
}

void FrameAccount::before_showing(const FrameRecord& record) {
    const ThreadUsage since = clock_.usage() - ended_;
    lost_before_showing_ = lost(clock_.now_ns() - record.complete_ns, since);
}

void FrameAccount::present_begins(FrameRecord& record, std::int64_t begins_ns) {
    record.handed_ns = clock_.now_ns();
    woken_late_ns_ = record.handed_ns - begins_ns;
    handed_ = clock_.usage();
}

/// A gap in which the thread slept is a wait, and not lost. After the last fence it is for the display, or for its driver's own
/// threads.
FrameAccount::Lost FrameAccount::lost(std::int64_t wall_ns, const ThreadUsage& used) {
    const std::int64_t gap = std::max<std::int64_t>(wall_ns - used.cpu_ns, 0);
    if (used.voluntary > 0) return {};
    return used.involuntary > 0 ? Lost{0, gap} : Lost{gap, 0};
}

/// By how much this thread was still busy when the picture was to be handed over. `float` plans no such time.
std::int64_t FrameAccount::kept_waiting_ns(const FrameRecord& record, std::int64_t lead_ns) const {
    if (options_.late == LatePolicy::floating) return 0;
    return std::max<std::int64_t>(record.handed_ns - woken_late_ns_ - (record.show_ns - lead_ns), 0);
}

void FrameAccount::present_ended(FrameRecord& record, Shown shown, std::int64_t lead_ns) {
    read_end(record.presented_ns, record);
    const ThreadUsage driver = clock_.usage() - handed_;
    record.shown_by = shown.by;
    if (shown.by == ShownBy::display) record.shown_ns = shown.time_ns;
    if (shown.by == ShownBy::hand_over) record.shown_ns = record.presented_ns;
    record.voluntary += small(driver.voluntary);
    record.involuntary += small(driver.involuntary);
    record.driver_faults += small(driver.minor_faults + driver.major_faults);
    before_ = before_ + driver;
    if (record.missed || !is_shown_late(record, limits_)) return;

    const std::int64_t presenting_ns = record.presented_ns - record.handed_ns;
    const Lost here = lost(presenting_ns, driver);
    ShowingDelays delays;
    delays.woken_late_ns = woken_late_ns_;
    delays.stolen_ns = here.stolen_ns + lost_before_showing_.stolen_ns;
    delays.preempted_ns = here.preempted_ns + lost_before_showing_.preempted_ns;
    // Where a display tells, presenting holds the wait for a refresh: one that was missed by what came before is not its doing.
    const bool by_others =
        shown.by == ShownBy::display && record.handed_ns > record.show_ns - lead_ns + shown_tolerance_ns(limits_);
    const std::int64_t own_ns =
        kept_waiting_ns(record, lead_ns) - lost_before_showing_.stolen_ns - lost_before_showing_.preempted_ns;
    delays.beyond_lead_ns = std::max<std::int64_t>(own_ns, 0);
    if (!by_others) delays.beyond_lead_ns += presenting_ns - lead_ns - here.stolen_ns - here.preempted_ns;
    record.stolen_ns += delays.stolen_ns;
    record.preempted_ns += delays.preempted_ns;
    record.missed = true;
    record.cause = blame_showing(record, delays);
    const bool outside =
        record.cause == Cause::stolen || record.cause == Cause::stopped || (record.cause == Cause::woken_late && limits_.fifo);
    record.own_miss = !outside;
}

void FrameAccount::before_push(FrameRecord& record) {
    const GuardCounters now = guard_counters();
    record.guard_violations = small(now.own_violations - guard_before_.own_violations);
    record.driver_allocations = small(now.driver_allocations - guard_before_.driver_allocations);
    guard_before_ = now;
}

}  // namespace surefoot::rt
