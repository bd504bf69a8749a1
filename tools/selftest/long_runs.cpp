// Rows: a thousand million frames. Where a state can be put there by a jump it is; else as many steps as the effort allows.
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "input/motion/motion.hpp"
#include "rt/base/random.hpp"
#include "rt/clock/clock.hpp"
#include "rt/clock/grid.hpp"
#include "rt/frame/loop.hpp"
#include "rt/monitor/histogram.hpp"
#include "rt/monitor/telemetry.hpp"
#include "tools/selftest/families.hpp"

namespace surefoot::selftest {

namespace {

constexpr std::uint64_t thousand_million = 1'000'000'000;
constexpr std::int64_t period_ns = 16'666'667;

void mark_scaled(Outcome& out, std::uint64_t done, const char* what) {
    if (done < thousand_million) out.scaled = std::to_string(done) + " " + what + " of 1000000000";
}

/// Late frames of every length; slot times against 128-bit arithmetic.
void grid_books(const Effort& effort, Outcome& out) {
    Random random(31);
    std::uint64_t wrong = 0, early = 0;
    const std::uint64_t steps = effort.count(10'000'000, 100'000);
    const rt::Grid grid{123'456'789, period_ns};
    std::uint64_t slot = 0, run = 0, skipped = 0;
    // Most of the way to the thousand millionth slot is slept over: single stalls of up to a month.
    while (slot < thousand_million || run < steps) {
        if (effort.stopped()) break;
        const auto late = random.below(2) == 0 ? rt::LatePolicy::lock : rt::LatePolicy::floating;
        const std::int64_t max_work_ns =
            slot < thousand_million && random.below(1000) == 0 ? 2'592'000'000'000'000 : 3 * period_ns;
        const std::int64_t finished =
            grid.due_ns(slot) + static_cast<std::int64_t>(random.unit() * static_cast<double>(max_work_ns));
        const rt::NextSlot next = rt::next_slot(grid, late, slot, finished);
        ++run;
        early += next.start_ns < finished ? 1 : 0;
        skipped += next.skipped;
        slot = next.slot;
        const auto exact = static_cast<__int128>(slot) * period_ns + 123456789;
        wrong += exact == grid.due_ns(slot) ? 0 : 1;
    }
    out.none_of("slots whose time is not t0 + k T", wrong);
    out.none_of("frames that would start before the last one was done", early);
    out.exactly("slots less frames run and skipped", static_cast<double>(slot) - static_cast<double>(run + skipped), 0);
    out.at_least("slots", static_cast<double>(slot), static_cast<double>(thousand_million));
    out.digest_of(skipped);
}

/// The angle that heading and pitch are kept in, against the same sum in extended precision.
void turning(const Effort& effort, Outcome& out) {
    const std::uint64_t steps = effort.count(thousand_million, 1'000'000);
    constexpr double step_rad = 0.0217;
    input::Angle angle;
    std::uint64_t done = 0;
    while (done < steps && !effort.stopped()) {
        const std::uint64_t until = std::min(steps, done + 1'000'000);
        for (; done < until; ++done) {
            angle.add(step_rad);
            angle.wrap();
        }
    }
    constexpr long double two_pi = 6.28318530717958647692528676655900577L;
    const long double exact = std::remainder(static_cast<long double>(step_rad) * static_cast<long double>(done), two_pi);
    const long double off =
        std::remainder(static_cast<long double>(angle.value) - static_cast<long double>(angle.carry) - exact, two_pi);
    // What the reference itself is sure of: extended precision has 64 bits, and turns grow with the steps.
    const double sure = 2e-13 + 1e-20 * static_cast<double>(done);
    out.at_most("heading off after turning", static_cast<double>(std::abs(off)), sure, "rad");
    out.at_most("heading out of -pi to pi by", std::abs(angle.value) - 3.1415926535897936, 0, "rad");
    mark_scaled(out, done, "steps");
}

/// A walker who goes round a circle must stay on it, upright.
void walking(const Effort& effort, Outcome& out) {
    const std::uint64_t steps = effort.count(3'000'000, 30'000);
    input::MotionState state;
    const input::MotionLimits limits;
    input::Command command;
    command.request.forward = 1;
    command.request.turn = 1;
    std::int64_t now = 1;
    for (int i = 0; i < 1000; ++i) (void)input::step(state, limits, command, now += period_ns);
    const double turn = limits.turn_rad_s * 1e-9 * period_ns;
    // Of a regular polygon with that outer angle: three corners give its middle.
    std::array<dvec3, 3> corner{};
    for (dvec3& c : corner) {
        c = state.position;
        (void)input::step(state, limits, command, now += period_ns);
    }
    const dvec3 side = corner[1] - corner[0], inwards = glm::normalize((corner[2] - corner[1]) - side);
    const double radius = 0.5 * glm::length(side) / std::sin(0.5 * turn);
    const dvec3 middle = corner[1] + radius * inwards;
    double off = 0, roll = 0, unit = 0;
    for (std::uint64_t i = 0; i < steps; ++i) {
        if (i % 4096 == 0 && effort.stopped()) break;
        const Pose pose = input::step(state, limits, command, now += period_ns).pose;
        off = std::max(off, std::abs(glm::length(pose.position - middle) - radius));
        roll = std::max(roll, std::abs(pose.right().y));
        unit = std::max(unit, std::abs(glm::length(pose.orientation) - 1));
    }
    out.at_most("off the circle", off, 1e-6, "m");
    out.at_most("horizon leans", roll, 1e-12, "rad");
    out.at_most("length of the orientation less 1", unit, 1e-14);
    mark_scaled(out, steps, "steps");
}

/// Counts beyond 2^63, sums over the bins, and stalls at the end of time.
void histograms(const Effort&, Outcome& out) {
    constexpr auto max_time = std::numeric_limits<std::int64_t>::max();
    constexpr auto full = std::numeric_limits<std::uint64_t>::max();
    rt::Histogram h;
    Random random(33);
    std::uint64_t want = 0, wrong = 0;
    const auto in_bins = [](const rt::Histogram& of) {
        std::uint64_t sum = 0;
        for (std::size_t b = 0; b < rt::Histogram::bins; ++b) sum += of.bin_count(b);
        return sum;
    };
    for (int i = 0; i < 1000; ++i) {
        const std::uint64_t times = thousand_million / 1000;
        if (i % 3 == 0) {
            h.add_progression(random.below(1'000'000), period_ns, times);
        } else {
            h.add(static_cast<std::int64_t>(random.next() >> (1 + random.below(60))), times);
        }
        want += times;
    }
    wrong += h.count() == want && in_bins(h) == want && want == thousand_million ? 0 : 1;
    rt::Histogram twice = h;
    twice.merge(h);
    wrong += twice.count() == 2 * want && in_bins(twice) == 2 * want ? 0 : 1;
    out.none_of("counts other than what went in", wrong);

    rt::Histogram s;
    s.add(5, full - 10);
    s.add(5, 100);
    s.add(7, 1);
    out.exactly("a full count goes on as full", s.count() == full && s.bin_count(rt::Histogram::bin_of(5)) == full ? 1 : 0, 1);
    s.merge(s);
    out.exactly("two full counts merged are full", s.count() == full ? 1 : 0, 1);
    out.exactly("the median of a full count", static_cast<double>(s.quantile(0.5)), 5);

    rt::Histogram e;
    e.add(max_time, 3);
    e.add(-max_time, 2);
    e.add_progression(max_time - 10, 100, 4);
    out.exactly("stalls at the end of time are counted", static_cast<double>(e.count()), 9);
    out.exactly("and none comes out before it", e.max() == max_time && e.bin_count(0) == 2 ? 1 : 0, 1);
}

/// Live figures over stalls of years: every slot is in exactly one place.
void telemetry_books(const Effort& effort, Outcome& out) {
    const auto telemetry = std::make_unique<rt::Telemetry>();
    telemetry->begin({period_ns, rt::LatePolicy::lock, 1});
    const rt::Grid grid{1, period_ns};
    Random random(34);
    std::uint64_t slot = 0, frames = 0, skipped = 0;
    const std::uint64_t wanted = effort.count(100'000, 2'000);
    std::uint32_t skipped_before = 0;
    while ((slot < thousand_million || frames < wanted) && !effort.stopped()) {
        rt::FrameRecord f;
        f.slot = slot;
        f.frame = frames++;
        f.skipped_before = skipped_before;
        skipped += skipped_before;
        f.due_ns = f.ready_ns = grid.due_ns(slot);
        f.deadline_ns = grid.deadline_ns(slot);
        const std::int64_t max_work_ns = random.below(200) == 0 ? 8'000'000'000'000'000 : 2 * period_ns;
        f.woken_ns = f.selected_ns = f.submitted_ns = f.rastered_ns = f.due_ns;
        f.complete_ns = f.due_ns + static_cast<std::int64_t>(random.unit() * static_cast<double>(max_work_ns));
        f.missed = f.complete_ns > f.deadline_ns;
        telemetry->add(f);
        const rt::NextSlot next = rt::next_slot(grid, rt::LatePolicy::lock, slot, f.complete_ns);
        slot = next.slot;
        skipped_before = next.skipped;
    }
    const rt::Figures& figures = telemetry->figures();
    const auto of = [&](rt::Series s) { return static_cast<double>(figures.of(s).fine.count()); };
    out.exactly("slack + lateness less frames + skipped slots",
                of(rt::Series::slack) + of(rt::Series::lateness) - static_cast<double>(figures.frames + figures.skipped_slots),
                0);
    out.exactly("frames and skipped slots less those sent",
                static_cast<double>(figures.frames + figures.skipped_slots) - static_cast<double>(frames + skipped), 0);
    out.exactly("lost slots", static_cast<double>(figures.lost_slots), 0);
    out.at_least("slots", static_cast<double>(slot), static_cast<double>(thousand_million));
}

/// Idle stages on the virtual clock, with a stall of most of the thousand million slots in the middle.
class Stall final : public rt::FrameStages {
public:
    explicit Stall(rt::VirtualClock& clock) : clock_(clock) {}
    void sample(rt::FrameRecord&) override {}
    void select(rt::FrameRecord&) override {}
    void submit(rt::FrameRecord& record) override { clock_.advance(record.frame % 97 == 0 ? 3 * period_ns : 1'000'000); }
    void finish(rt::FrameRecord& record) override {
        if (record.frame == 1000) clock_.steal(999'000'000LL * period_ns);
    }
    void account(rt::FrameRecord& record) override { off += record.due_ns == due_of(record.slot) ? 0 : 1; }
    [[nodiscard]] static std::int64_t due_of(std::uint64_t slot) { return 1000 + static_cast<std::int64_t>(slot) * period_ns; }
    std::uint64_t off = 0;

private:
    rt::VirtualClock& clock_;
};

void loop_books(const Effort& effort, Outcome& out) {
    rt::VirtualClock clock(0);
    Stall stages(clock);
    rt::FrameLoopOptions options;
    options.period_ns = period_ns;
    options.t0_ns = 1000;
    options.frames = effort.count(200'000, 10'000);
    options.limits.period_ns = period_ns;
    rt::SpscRing<rt::FrameRecord> ring(1024);  // nobody empties it: what does not fit is dropped and counted
    const rt::FrameLoopResult result = rt::run_frame_loop(options, clock, stages, ring);
    out.exactly("slots elapsed less run and skipped",
                static_cast<double>(result.elapsed) - static_cast<double>(result.run + result.skipped), 0);
    out.exactly("frames run", static_cast<double>(result.run), static_cast<double>(options.frames));
    out.none_of("frames whose due time is not t0 + k T", stages.off);
    out.at_least("slots", static_cast<double>(result.elapsed), 999'000'000);
    out.scaled = std::to_string(result.run) + " frames run; the rest of the thousand million slots in one stall";
    out.digest_of(result.elapsed);
}

}  // namespace

std::span<const Row> long_runs_rows() {
    static constexpr std::array<Row, 6> table = {{
        {"L1", "long_runs", "a grid of a thousand million slots at 60 Hz, frames late by nothing to a month",
         "every slot at t0 + k T exactly; run + skipped = elapsed", grid_books},
        {"L2", "long_runs", "a heading turned by 0.0217 rad a thousand million times",
         "the sum is exact to what the reference is sure of", turning},
        {"L3", "long_runs", "a walk in a circle, at 60 Hz, for hours", "on the circle, upright, of unit length", walking},
        {"L4", "long_runs", "histograms of a thousand million values, full counters, values at the ends",
         "counts exact or saturating, none lost", histograms},
        {"L5", "long_runs", "live figures over a thousand million slots with stalls of months", "each slot is counted once",
         telemetry_books},
        {"L6", "long_runs", "the frame loop on a virtual clock, with one stall of 999 million slots",
         "due times exact; run + skipped = elapsed", loop_books},
    }};
    return table;
}

}  // namespace surefoot::selftest
