// The guaranteed accuracy in a walk: each record says what was promised, what was reached, which node binds, and why not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "render/capture/capture.hpp"
#include "render/model/walk_file.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/report/report.hpp"

namespace surefoot {
namespace {

using rt::Guarantee;

constexpr int frames = 80;

walk::WalkRequest guaranteed(double min_accuracy, std::uint64_t length) {
    walk::WalkRequest request = test::Forest::get().virtual_request(length);
    request.min_accuracy = min_accuracy;
    request.rest_after_ms = 0;
    auto costs = std::make_shared<model::CostModel>(model::default_costs());
    costs->combine.submit_weight *= 3;  // the small forest is cheap
    costs->combine.raster_weight *= 3;
    request.given_costs = costs;
    return request;
}

/// Of the cheapest cut within an error, by weights of submit and raster time; infinite: there is none.
double cheapest_us(const prepare::PreparedFrame& frame, std::uint32_t c, double error_rad, double submit, double raster) {
    const prepare::Candidate& at = frame.candidates[c];
    double best = std::numeric_limits<double>::infinity(), children = at.child_count > 0 ? 0 : best;
    for (std::uint32_t k = at.first_choice; k < at.first_choice + at.choice_count; ++k) {
        const prepare::Choice& choice = frame.choices[k];
        if (double{choice.error_rad} * double{at.importance} <= error_rad)
            best = std::min(best, submit * double{choice.cost.submit_us} + raster * double{choice.cost.raster_us});
    }
    for (std::uint32_t k = 0; k < at.child_count; ++k)
        children += cheapest_us(frame, at.first_child + k, error_rad, submit, raster);
    return std::min(best, children);
}

/// No cut within the error takes less, us without correction and headroom: weights between the two sums bound their maximum.
double bound_us(const capture::Capture& of, double error_rad) {
    double bound = 0;
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const double more = double{of.combine.max_weight};
        bound = std::max(bound, cheapest_us(of.prepared, 0, error_rad, double{of.combine.submit_weight} + share * more,
                                            double{of.combine.raster_weight} + (1 - share) * more));
    }
    return bound;
}

/// What the items of a frame's budget may take, us.
double room_us(const capture::Capture& of) {
    const double slice_end_us = double{of.combine.submit_weight} * double{of.slice_end_us};
    return (of.budget_us / (of.correction * double{of.headroom}) - double{of.combine.fixed_us} - slice_end_us) /
           (1 + slice_end_us / of.slice_us);
}

double worst_of(const capture::Capture& of) {
    double worst = 0;
    for (const select::CutItem& item : of.items)
        worst = std::max(worst, double{of.prepared.choices[item.choice].error_rad} *
                                    double{of.prepared.candidates[item.candidate].importance});
    return worst;
}

TEST(GuaranteeWalk, EveryRecordSaysWhatWasPromisedAndReached) {
    for (const double accuracy : {20.0, 2000.0}) {
        const walk::WalkOutcome outcome = test::walk(guaranteed(accuracy, frames));
        std::map<Guarantee, int> counts;
        for (const rt::FrameRecord& r : outcome.records) {
            ++counts[r.guarantee];
            ASSERT_EQ(double{r.guaranteed_accuracy}, accuracy);
            ASSERT_EQ(r.guarantee == Guarantee::kept, double{r.reached_accuracy} >= accuracy) << r.frame;
            ASSERT_EQ(r.binding_node == rt::no_node, std::isinf(r.reached_accuracy)) << r.frame;
            ASSERT_EQ(r.accuracy, r.reached_accuracy) << "all objects of the forest matter alike";
            ASSERT_FALSE(r.missed) << r.frame;
        }
        EXPECT_EQ(counts[Guarantee::none], 0);
        if (accuracy == 20.0) {
            EXPECT_EQ(counts[Guarantee::kept], frames);
        }
        if (accuracy == 2000.0) {
            EXPECT_GT(counts[Guarantee::over_budget], frames / 2);
        }
        const report::GuaranteeSummary& g = outcome.summary.guarantee;
        EXPECT_EQ(g.kept, static_cast<std::uint64_t>(counts[Guarantee::kept]));
        EXPECT_EQ(g.accuracy, accuracy);
        const auto json = nlohmann::json::parse(report::to_json(outcome.summary));
        EXPECT_EQ(json["guarantee"]["kept_frames"], g.kept);
        std::printf("%g /rad: kept in %d frames, over budget in %d, least %.1f, node %u (%s)\n", accuracy,
                    counts[Guarantee::kept], counts[Guarantee::over_budget], g.reached_min, g.binding_node,
                    g.binding_name.c_str());
        EXPECT_NE(report::to_table(outcome.summary, false).find("guarantee"), std::string::npos);
    }
}

TEST(GuaranteeWalk, IsReachedByCapturedCutsAndBrokenOnlyWhereNoCutFits) {
    int kept = 0, broken = 0;
    for (const double accuracy : {20.0, 2000.0})
        for (const std::uint64_t frame : {20U, 60U}) {
            walk::WalkRequest request = guaranteed(accuracy, frame + 1);
            request.capture_file = test::Forest::get().dir + "/guarantee.cap";
            request.capture_frame = frame;
            const walk::WalkOutcome outcome = test::walk(request);
            const auto read = capture::read_capture(request.capture_file);
            ASSERT_TRUE(read.ok());
            EXPECT_TRUE(capture::verify(*read).ok()) << "the guarantee is in the file";
            const rt::FrameRecord& record = outcome.records.back();
            // What is drawn is what of the cut is in view.
            ASSERT_LE(1 / double{record.reached_accuracy}, worst_of(*read) * (1 + 1e-6));
            if (record.guarantee == Guarantee::kept) {
                ++kept;
                if (1 / worst_of(*read) < accuracy) ADD_FAILURE() << "frame " << frame << " has " << 1 / worst_of(*read);
            } else {
                ASSERT_EQ(record.guarantee, Guarantee::over_budget);
                ++broken;
                EXPECT_GT(bound_us(*read, 1 / accuracy), room_us(*read) * 0.97) << "frame " << frame;
            }
        }
    EXPECT_GT(kept, 0);
    EXPECT_GT(broken, 0);
}

TEST(GuaranteeWalk, NeedsASelectorThatBuysIt) {
    walk::WalkRequest request = guaranteed(100, 2);
    request.selector = "distance";
    const auto refused = walk::run_walk(request, {});
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().remedy.find("threshold"), std::string::npos) << refused.error().text();
}

TEST(GuaranteeWalk, WithoutOneNothingIsSaid) {
    const walk::WalkOutcome outcome = test::walk(guaranteed(0, 5));
    for (const rt::FrameRecord& r : outcome.records) EXPECT_EQ(r.guarantee, Guarantee::none);
    EXPECT_FALSE(nlohmann::json::parse(report::to_json(outcome.summary)).contains("guarantee"));
    EXPECT_EQ(report::to_table(outcome.summary, false).find("guarantee"), std::string::npos);
}

}  // namespace
}  // namespace surefoot
