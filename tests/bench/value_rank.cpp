// Bench: whether value orders pictures. At each pose, random legal cuts of the same predicted cost are drawn. The figure is the
// rank correlation (Spearman) of their values and of their PSNR against full detail. Cuts are made by `threshold` from rates that
// are multiplied by exp(2 n), n normal. The cost is the geometric mean of the floor's and of full detail's.
//
// bench_value_rank MODEL.walk [PATH.csv] [LIFT_M] [STATE_DIR] [POSES 10] [CUTS 20] -> one JSON object.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "render/engine.hpp"
#include "render/measure/image_metrics.hpp"
#include "rt/base/random.hpp"
#include "rt/base/statistics.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tools/report/report.hpp"

namespace {

using namespace surefoot;
using bench::fail;

constexpr double noise = 2, tolerated_cost = 0.05;
constexpr int tries = 20;  // for a cut of the right cost

double normal(Random& random) {
    const double radius = std::sqrt(-2 * std::log(1 - random.unit()));
    return radius * std::cos(2 * std::numbers::pi * random.unit());
}

/// Other rates, which still fall along the choices and down the tree.
void disturb_rates(const prepare::PreparedFrame& from, Random& random, prepare::PreparedFrame& to) {
    for (const prepare::Candidate& candidate : from.candidates) {  // parents first
        float limit = std::numeric_limits<float>::max();
        if (candidate.parent != prepare::none) {
            const prepare::Candidate& parent = from.candidates[candidate.parent];
            limit = to.choices[parent.first_choice + parent.choice_count - 1].rate;
        }
        for (prepare::Index k = candidate.first_choice; k < candidate.first_choice + candidate.choice_count; ++k)
            limit = to.choices[k].rate =
                std::min(limit, from.choices[k].rate * static_cast<float>(std::exp(noise * normal(random))));
    }
}

/// Ranks from 0; equal values share the mean of theirs.
std::vector<double> ranks_of(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    std::vector<double> ranks(values.size());
    for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
        while (last < order.size() && values[order[last]] == values[order[first]]) ++last;
        for (std::size_t i = first; i < last; ++i) ranks[order[i]] = 0.5 * static_cast<double>(first + last - 1);
    }
    return ranks;
}

/// Spearman's: Pearson's of the ranks. No number where all are equal.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
    const std::vector<double> x = ranks_of(a), y = ranks_of(b);
    const double mean = 0.5 * static_cast<double>(a.size() - 1);
    double xy = 0, xx = 0, yy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xy += (x[i] - mean) * (y[i] - mean);
        xx += (x[i] - mean) * (x[i] - mean);
        yy += (y[i] - mean) * (y[i] - mean);
    }
    return xy / std::sqrt(xx * yy);
}

/// The drawing of one pose.
struct Drawing {
    Engine& engine;
    Pose pose;
    std::vector<std::uint8_t> full;

    /// PSNR of the selected cut.
    Result<double> psnr_db() {
        SubmitLimits limits;
        limits.limit_us = 1e12;
        engine.submit(pose, limits);
        auto image = engine.device().read_pixels();
        if (!image) return image.error();
        return report::psnr_db(measure::snr(image->rgba, full).mse);
    }
};

/// What the random cuts of a pose showed.
struct PoseFigures {
    std::vector<double> values, psnr_db;
    double chosen_psnr_db = 0;  ///< of the cut that is not disturbed
    double full_value = 0, budget_us = 0;
};

Result<PoseFigures> measure_pose(Drawing& drawing, const prepare::PreparedFrame& prepared, std::size_t cuts, Random& random) {
    Engine& engine = drawing.engine;
    PoseFigures figures;
    figures.full_value = prepared.full_value;
    const double floor_us = engine.select(prepared, 1, {}, 0).floor_us;
    const double full_us = engine.select(prepared, 1e12, {}, 0).predicted_us;
    const double budget_us = figures.budget_us = std::sqrt(floor_us * full_us);
    engine.select(prepared, budget_us, {}, 0);
    auto chosen = drawing.psnr_db();
    if (!chosen) return chosen.error();
    figures.chosen_psnr_db = *chosen;
    prepare::PreparedFrame disturbed = prepared;
    for (std::size_t i = 0; i < cuts * tries && figures.values.size() < cuts; ++i) {
        disturb_rates(prepared, random, disturbed);
        const select::Cut& cut = engine.select(disturbed, budget_us, {}, 0);
        if (cut.floor_binds || std::abs(cut.predicted_us - budget_us) > tolerated_cost * budget_us) continue;
        auto psnr = drawing.psnr_db();
        if (!psnr) return psnr.error();
        figures.values.push_back(cut.value);
        figures.psnr_db.push_back(*psnr);
    }
    return figures;
}

double mean_of(const std::vector<double>& of) {
    return std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(of.size());
}

double spread(const std::vector<double>& of) {
    const auto [least, most] = std::minmax_element(of.begin(), of.end());
    return *most - *least;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return fmt::print(stderr, "bench_value_rank MODEL.walk [PATH.csv] [LIFT_M] [STATE_DIR] [POSES] [CUTS]\n"), 2;
    const auto poses = static_cast<std::size_t>(argc > 5 ? std::atoi(argv[5]) : 10);
    const auto cuts = static_cast<std::size_t>(argc > 6 ? std::atoi(argv[6]) : 20);
    bench::SceneArguments arguments{argv[1]};
    arguments.fitted = true;
    if (argc > 2) arguments.path_file = argv[2];
    if (argc > 3) arguments.lift_m = std::atof(argv[3]);
    if (argc > 4) arguments.state_dir = argv[4];
    auto scene = bench::open_scene(arguments);
    if (!scene) return fail(scene.error());
    const Path& path = scene->path.path;
    EngineOptions options;
    options.in_frame_check = false;
    options.selector = "threshold";
    options.hysteresis = 1;
    auto engine = Engine::open(std::move(scene->model), scene->costs, options);
    if (!engine) return fail(engine.error());
    (*engine)->device().bind();
    (*engine)->device().draws.plays();

    prepare::PreparedFrame prepared;
    (*engine)->reserve(prepared);
    Random random(2026);
    std::vector<double> correlations, psnr_spreads, value_spreads, worse, chosen_db;
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < poses; ++i) {
        const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(poses);
        Drawing drawing{**engine, sample_path(path, path.duration_s() * at), {}};
        (*engine)->draw_unbudgeted(drawing.pose, (*engine)->full_detail(drawing.pose));
        auto full = (*engine)->device().read_pixels();
        if (!full) return fail(full.error());
        drawing.full = std::move(full->rgba);
        (*engine)->prepare({drawing.pose, 0, 0}, 0, 0, 0, prepared);
        auto figures = measure_pose(drawing, prepared, cuts, random);
        if (!figures) return fail(figures.error());
        const double correlation = figures->values.size() < cuts ? NAN : rank_correlation(figures->values, figures->psnr_db);
        if (!std::isfinite(correlation)) {
            ++left_out;
            continue;
        }
        correlations.push_back(correlation);
        psnr_spreads.push_back(spread(figures->psnr_db));
        value_spreads.push_back(spread(figures->values) / figures->full_value);
        const auto below = std::count_if(figures->psnr_db.begin(), figures->psnr_db.end(),
                                         [&](double db) { return db < figures->chosen_psnr_db; });
        chosen_db.push_back(figures->chosen_psnr_db);
        worse.push_back(static_cast<double>(below) / static_cast<double>(cuts));
    }
    if (correlations.empty()) return fmt::print(stderr, "{}: no pose has {} cuts of one cost\n", argv[1], cuts), 1;
    fmt::print(
        "{{\"model\": \"{}\", \"poses\": {}, \"poses_left_out\": {}, \"cuts\": {}, \"correlation\": {{\"median\": {:.3f}, "
        "\"least\": {:.3f}, \"each\": [{:.3f}]}}, \"psnr_range_db\": {:.2f}, \"value_range\": {:.4f}, "
        "\"worse_than_chosen\": {:.3f}, \"chosen_psnr_db\": {:.2f}}}\n",
        argv[1], correlations.size(), left_out, cuts, median_of(correlations),
        *std::min_element(correlations.begin(), correlations.end()), fmt::join(correlations, ", "), median_of(psnr_spreads),
        median_of(value_spreads), median_of(worse), mean_of(chosen_db));
    return 0;
}
