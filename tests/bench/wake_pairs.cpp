// Bench: our wake-up against cyclictest's on the same core and priority, in alternating blocks, both read by our histogram.
// bench_wake_pairs [PAIRS=24] [SECONDS=5] [PERIOD_US=1000] [CORE] -> one JSON object. Exit status 77 where cyclictest or FIFO is
// missing, 1 if the median of the paired differences of p99 (ours less cyclictest's) is above 50 us.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "rt/base/statistics.hpp"
#include "rt/threads/capability.hpp"
#include "rt/threads/placement.hpp"
#include "tools/doctor/wake_up.hpp"

namespace {

using namespace surefoot;

std::string list(const std::vector<double>& v) {
    std::string text;
    for (const double x : v) text += fmt::format("{}{:.1f}", text.empty() ? "" : ", ", x);
    return text;
}

}  // namespace

int main(int argc, char** argv) {
    const int pairs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 24;
    doctor::WakeOptions options;
    const rt::Capabilities able = rt::probe_capabilities(options.priority);
    options.seconds = argc > 2 ? std::max(1, std::atoi(argv[2])) : 5;
    options.period_ns = (argc > 3 ? std::max(100, std::atoi(argv[3])) : 1000) * std::int64_t{1000};
    options.core = argc > 4 ? std::atoi(argv[4]) : rt::default_frame_core(able.allowed, able.isolated);
    const auto program = doctor::find_program("cyclictest");
    if (!program) return fmt::print("SKIPPED: cyclictest is not installed (Debian: rt-tests)\n"), 77;
    if (able.fifo_priority < options.priority)
        return fmt::print("SKIPPED: SCHED_FIFO {} is refused here\n", options.priority), 77;

    std::vector<double> ours_p99, theirs_p99, difference, ours_max, theirs_max;
    double steal_ms = 0;
    for (int pair = 0; pair < pairs; ++pair) {
        doctor::WakeFigures ours;
        for (int half = 0; half < 2; ++half) {
            if ((half == 0) == (pair % 2 == 0)) {  // who goes first takes turns
                ours = doctor::run_wake_up(options, {});
                if (ours.steal_ms > 0) steal_ms += ours.steal_ms;
                continue;
            }
            const auto theirs = doctor::run_cyclictest(*program, options, {});
            if (!theirs) return fmt::print(stderr, "{}\n", theirs.error().text()), 1;
            theirs_p99.push_back(theirs->p99_us);
            theirs_max.push_back(theirs->max_us);
        }
        ours_p99.push_back(ours.p99_us);
        ours_max.push_back(ours.max_us);
        difference.push_back(ours.p99_us - theirs_p99.back());
        fmt::print(stderr, "pair {:2}: p99 {:.1f} us, cyclictest {:.1f} us\n", pair + 1, ours.p99_us, theirs_p99.back());
    }
    const double middle = median_of(difference);
    fmt::print(
        "{{\"pairs\": {}, \"block_s\": {}, \"period_us\": {}, \"core\": {}, \"priority\": {}, \"p99_us\": {{\"surefoot\": "
        "{:.1f}, "
        "\"cyclictest\": {:.1f}}}, \"max_us\": {{\"surefoot\": {:.0f}, \"cyclictest\": {:.0f}}}, "
        "\"p99_difference_us\": {{\"median\": {:.1f}, \"blocks\": [{}]}}, \"steal_ms\": {:.0f}}}\n",
        pairs, options.seconds, options.period_ns / 1000, options.core, options.priority, median_of(ours_p99),
        median_of(theirs_p99), *std::max_element(ours_max.begin(), ours_max.end()),
        *std::max_element(theirs_max.begin(), theirs_max.end()), middle, list(difference), steal_ms);
    return middle <= 50 ? 0 : 1;
}
