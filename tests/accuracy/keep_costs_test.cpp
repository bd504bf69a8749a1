// Which costs a model's walks shall use: who walks when, the order of the reasons, and walks on the virtual clock that tell.
#include "tools/accuracy/keep_costs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/walk/walk_fixture.hpp"

namespace surefoot::accuracy {
namespace {

using Costs = std::shared_ptr<const model::CostModel>;

CostTrial trial(std::vector<double> of_rounds, double psnr_db, std::uint64_t own_misses = 0) {
    CostTrial t;
    t.of_rounds = std::move(of_rounds);
    t.psnr_db = psnr_db;
    t.frames = 100;
    t.own_misses = own_misses;
    return t;
}

TEST(KeepCosts, DeadlinesGoBeforePicturesAndPicturesBeforePrediction) {
    const KeptCosts late = decide(trial({30, 30}, 30, 5), trial({20, 20}, 20, 2), 0.1, 0.2);
    EXPECT_FALSE(late.fit);
    EXPECT_EQ(late.reason, KeepReason::deadlines);
    const KeptCosts fit = decide(trial({30, 29}, 29.5, 2), trial({20, 20}, 20, 0), 0.2, 0.1);
    EXPECT_TRUE(fit.fit) << "two misses of a hundred count as none";
    EXPECT_EQ(fit.reason, KeepReason::pictures);
    const KeptCosts table = decide(trial({20, 20}, 20), trial({30, 29}, 29.5), 0.1, 0.2);
    EXPECT_FALSE(table.fit);
    EXPECT_EQ(table.reason, KeepReason::pictures);
    EXPECT_EQ(table.of_table.psnr_db, 29.5);
    EXPECT_EQ(decide(trial({32.1}, 32.1), trial({30}, 30), 0.2, 0.1).reason, KeepReason::pictures) << "one round, far apart";
}

TEST(KeepCosts, WhereTheWalksDoNotTellTheSmallerErrorOfHeldOutFramesDecides) {
    for (const bool fit : {true, false}) {
        const double fit_error = fit ? 0.1 : 0.3;
        const KeptCosts close = decide(trial({30.1, 30.1}, 30.1), trial({30, 30}, 30), fit_error, 0.2);
        EXPECT_EQ(close.fit, fit);
        EXPECT_EQ(close.reason, KeepReason::prediction);
        const KeptCosts unsteady = decide(trial({36, 26}, 29), trial({30, 27}, 28.2), fit_error, 0.2);
        EXPECT_EQ(unsteady.fit, fit) << "one round each";
        EXPECT_EQ(unsteady.reason, KeepReason::prediction);
        const KeptCosts overlapping = decide(trial({36, 29}, 31), trial({30, 27}, 28.2), fit_error, 0.2);
        EXPECT_EQ(overlapping.fit, fit) << "better in both rounds, but by less than the rounds differ";
        EXPECT_EQ(overlapping.reason, KeepReason::prediction);
        const KeptCosts one_round = decide(trial({31.5}, 31.5), trial({30}, 30), fit_error, 0.2);
        EXPECT_EQ(one_round.reason, KeepReason::prediction) << "one walk differs from the next by as much";
    }
}

walk::WalkOutcome outcome_of(double psnr_db, double worst_db) {
    walk::WalkOutcome outcome;
    outcome.summary.frames = 50;
    outcome.summary.picture.frames = 7;
    outcome.summary.picture.psnr_db = psnr_db;
    outcome.summary.picture.worst_psnr_db = worst_db;
    return outcome;
}

KeepRequest request_of(std::uint32_t rounds) {
    KeepRequest request;
    request.walk.model_file = "m.walk";
    request.rounds = rounds;
    request.fit = std::make_shared<const model::CostModel>();
    request.table = std::make_shared<const model::CostModel>();
    return request;
}

TEST(KeepCosts, TheOrderChangesFromRoundToRoundAndRoundsArePooledByTheirErrors) {
    const KeepRequest request = request_of(2);
    std::vector<bool> by_fit;
    const auto kept = keep_costs(request,
                                 [&](const walk::WalkRequest& one, const Progress&) -> Result<walk::WalkOutcome> {
                                     by_fit.push_back(one.given_costs == request.fit);
                                     EXPECT_TRUE(one.given_costs == request.fit || one.given_costs == request.table);
                                     return outcome_of(by_fit.back() ? 40 : 10.0 * static_cast<double>(by_fit.size()),
                                                       static_cast<double>(by_fit.size()));
                                 },
                                 {});
    ASSERT_TRUE(kept.ok());
    EXPECT_EQ(by_fit, (std::vector<bool>{false, true, true, false}));
    EXPECT_NEAR(kept->of_fit.psnr_db, 40, 1e-9);
    EXPECT_EQ(kept->of_fit.worst_psnr_db, 2);
    EXPECT_NEAR(kept->of_table.psnr_db, -10 * std::log10((0.1 + 0.0001) / 2), 1e-9);
    EXPECT_EQ(kept->of_table.frames, 100U);
}

TEST(KeepCosts, AStopAndAWalkWithoutPicturesAreErrors) {
    const auto none = keep_costs(
        request_of(1), [](const walk::WalkRequest&, const Progress&) -> Result<walk::WalkOutcome> { return walk::WalkOutcome{}; },
        {});
    ASSERT_FALSE(none.ok());
    EXPECT_NE(none.error().text().find("--keep fit"), std::string::npos);
    const auto stopped = keep_costs(request_of(1),
                                    [](const walk::WalkRequest&, const Progress&) -> Result<walk::WalkOutcome> {
                                        auto outcome = outcome_of(30, 30);
                                        outcome.stopped = true;
                                        return outcome;
                                    },
                                    {});
    ASSERT_FALSE(stopped.ok());
    EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
}

/// The built-in costs, times a factor.
Costs costs_times(float factor) {
    model::CostModel costs = model::default_costs();
    model::FrameCombine& k = costs.combine;
    k = {k.fixed_us * factor, k.submit_weight * factor, k.raster_weight * factor, k.max_weight * factor};
    return std::make_shared<const model::CostModel>(costs);
}

/// The walk by costs that are so many times the true ones. Every walk on the virtual clock is the same at each repetition
/// (VirtualWalk.CutsAreBitEqualAtAnyWorkerCountAndAcrossRuns), so one stands for all rounds. More triangles stand for better
/// pictures.
class VirtualWalks {
public:
    Result<walk::WalkOutcome> walk(const walk::WalkRequest& given, float times, const Progress& progress) {
        const auto key = std::pair(times, given.in_frame_check);
        auto found = summaries_.find(key);
        if (found == summaries_.end()) {
            walk::WalkRequest one = given;
            one.cost_scale = 1.0 / static_cast<double>(times);
            auto outcome = walk::run_walk(one, progress);
            if (!outcome) return outcome.error();
            outcome->summary.picture.frames = 7;
            outcome->summary.picture.psnr_db = 10 * std::log10(outcome->summary.triangles_mean);
            found = summaries_.emplace(key, outcome->summary).first;
        }
        walk::WalkOutcome outcome;
        outcome.summary = found->second;
        return outcome;
    }

private:
    std::map<std::pair<float, bool>, report::WalkSummary> summaries_;
};

/// Frames really cost what the built-in costs say.
Result<KeptCosts> keep_on_virtual_clock(VirtualWalks& walks, float fit_times, float table_times, bool in_frame_check) {
    KeepRequest request;
    request.walk = test::Forest::get().virtual_request(120);
    request.walk.rate_hz = 60;  // full detail is late
    request.walk.correct_costs = false;
    request.walk.in_frame_check = in_frame_check;
    request.fit = costs_times(fit_times);
    request.table = costs_times(table_times);
    const auto run_walk = [&](const walk::WalkRequest& given, const Progress& progress) -> Result<walk::WalkOutcome> {
        return walks.walk(given, given.given_costs == request.fit ? fit_times : table_times, progress);
    };
    return keep_costs(request, run_walk, {});
}

TEST(KeepCosts, OnTheVirtualClockTheTrueCostsAreKeptWhicheverTheyAre) {
    VirtualWalks walks;
    for (const bool fit_is_true : {true, false}) {
        const auto dear = keep_on_virtual_clock(walks, fit_is_true ? 1 : 3, fit_is_true ? 3 : 1, true);
        ASSERT_TRUE(dear.ok()) << dear.error().text();
        EXPECT_EQ(dear->fit, fit_is_true);
        EXPECT_EQ(dear->reason, KeepReason::pictures);
        const auto cheap = keep_on_virtual_clock(walks, fit_is_true ? 1 : 0.4F, fit_is_true ? 0.4F : 1, false);
        ASSERT_TRUE(cheap.ok()) << cheap.error().text();
        EXPECT_EQ(cheap->fit, fit_is_true) << "frames that are predicted too cheap are late";
        EXPECT_EQ(cheap->reason, KeepReason::deadlines);
    }
}

TEST(KeepCosts, PiecesOfAPathAreOfAllOfItAtItsOwnSpeed) {
    Path path;
    for (int i = 0; i <= 100; ++i) {
        Pose pose;
        pose.position.x = i;  // 1 m/s
        path.samples.push_back({static_cast<double>(i), pose});
    }
    const Path pieces = path_in_pieces(path, 8);
    EXPECT_NEAR(pieces.duration_s(), 8, 1e-9);
    EXPECT_EQ(pieces.samples.front().pose.position.x, 0);
    EXPECT_NEAR(pieces.samples.back().pose.position.x, 100, 1e-9);
    std::vector<double> starts{0};
    for (std::size_t i = 1; i < pieces.samples.size(); ++i) {
        const double s = pieces.samples[i].time_s - pieces.samples[i - 1].time_s;
        ASSERT_GT(s, 0);
        const double moved_m = pieces.samples[i].pose.position.x - pieces.samples[i - 1].pose.position.x;
        if (moved_m > 1)
            starts.push_back(pieces.samples[i].pose.position.x);
        else
            EXPECT_NEAR(moved_m, s, 1e-9);
    }
    ASSERT_EQ(starts.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(starts[i], 98.0 / 3.0 * static_cast<double>(i), 1e-9);
    EXPECT_EQ(path_in_pieces(path, 200).samples.size(), path.samples.size());
}

}  // namespace
}  // namespace surefoot::accuracy
