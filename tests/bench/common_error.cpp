// Bench: the accuracy that all objects of a frame share. For each capture, `curve-budget` without hysteresis beside the bound of
// any cut within the same budget, and beside other selectors. The bound and the accuracies of cuts are computed here, from the
// captured arrays. Exact: it shows full detail. bench_common_error CAPTURE... -> one JSON object.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "render/capture/capture.hpp"
#include "rt/base/statistics.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tests/cut_bounds.hpp"

namespace {

using namespace surefoot;

/// 1/rad; infinite: exact.
double worst_accuracy(const capture::Capture& of, const select::Cut& cut) { return 1 / test::worst_error(of, cut.items); }

bool is_full_detail(const capture::Capture& of, const select::Cut& cut) {
    return std::all_of(cut.items.begin(), cut.items.end(), [&](const select::CutItem& item) {
        const prepare::Candidate& at = of.prepared.candidates[item.candidate];
        return at.child_count == 0 && item.choice == at.first_choice + at.choice_count - 1;
    });
}

/// The greatest accuracy whose bound is within what the items of the budget may take: halving, on logarithms.
double best_accuracy(const capture::Capture& of, double room_us) {
    double fine = std::log(1e-9), coarse = std::log(1e3);
    if (test::bound_us(of, 0) <= room_us) return std::numeric_limits<double>::infinity();
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (fine + coarse);
        (test::bound_us(of, std::exp(middle)) <= room_us ? coarse : fine) = middle;
    }
    double best = 0;  // errors are those of forms: the greatest within
    for (const prepare::Candidate& at : of.prepared.candidates)
        for (std::uint32_t k = at.first_choice; k < at.first_choice + at.choice_count; ++k)
            if (const double error = test::weighted_error(at, of.prepared.choices[k]); error <= std::exp(coarse))
                best = std::max(best, error);
    return 1 / best;
}

struct Figures {
    std::vector<double> of_best, to_two_stage, to_threshold;
    std::size_t exact = 0;
};

Result<void> measure(const char* file, Figures& figures) {
    auto read = capture::read_capture(file);
    if (!read) return read.error();
    capture::Capture& of = *read;
    of.hysteresis = 1;
    of.target_error_rad = 0;
    const auto ours = capture::replay(of, "curve-budget");
    const auto two_stage = capture::replay(of, "two-stage"), threshold = capture::replay(of, "threshold");
    for (const auto* cut : {&ours, &two_stage, &threshold})
        if (!*cut) return cut->error();
    if (ours->floor_binds) return Error{file, "The budget does not buy the floor", "Capture with a larger budget"};
    if (is_full_detail(of, *ours)) {
        ++figures.exact;
        return {};
    }
    const double reached = worst_accuracy(of, *ours);
    const double room_us = test::room_us(of, ours->items, static_cast<double>(ours->predicted_us));
    const double best = best_accuracy(of, room_us);
    figures.of_best.push_back(reached / best);
    figures.to_two_stage.push_back(reached / worst_accuracy(of, *two_stage));
    figures.to_threshold.push_back(reached / worst_accuracy(of, *threshold));
    fmt::print(stderr, "{}: {} candidates, accuracy {:.1f} rad^-1, {:.4f} of the best; two-stage {:.1f}, threshold {:.1f}\n",
               file, of.prepared.candidates.size(), reached, figures.of_best.back(), worst_accuracy(of, *two_stage),
               worst_accuracy(of, *threshold));
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return bench::fail({"CAPTURE...", "is missing", "give files of `surefoot walk --capture`"});
    Figures figures;
    for (int i = 1; i < argc; ++i)
        if (const Result<void> done = measure(argv[i], figures); !done) return bench::fail(done.error());
    if (figures.of_best.empty()) return bench::fail({"the captures", "are all exact", "capture with a smaller budget"});
    fmt::print(
        "{{\"captures\": {}, \"exact\": {}, \"min_of_best\": {:.4f}, \"to_two_stage\": {:.3f}, \"to_threshold\": {:.3f}}}\n",
        argc - 1, figures.exact, *std::min_element(figures.of_best.begin(), figures.of_best.end()),
        median_of(figures.to_two_stage), median_of(figures.to_threshold));
    return 0;
}
