// The guaranteed accuracy in a walk: each record says what was promised, what was reached, which node binds, and why not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "render/capture/capture.hpp"
#include "render/model/walk_file.hpp"
#include "tests/cut_bounds.hpp"
#include "tests/surface_points.hpp"
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

/// Where the eye was. A record has no field of view.
Pose pose_of(const rt::FrameRecord& record, const capture::Capture& of) {
    Pose pose;
    pose.position = {record.eye[0], record.eye[1], record.eye[2]};
    pose.orientation = dquat(record.orientation[3], record.orientation[0], record.orientation[1], record.orientation[2]);
    pose.fov_y_rad = of.prepared.region.centre.fov_y_rad;
    return pose;
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
        for (const char* key : {"accuracy", "broken_frames", "reached_min", "worst_frame", "binding_node", "binding_name"})
            EXPECT_TRUE(json["guarantee"].contains(key)) << key;
        std::printf("%g /rad: kept in %d frames, over budget in %d, least %.1f, node %u (%s)\n", accuracy,
                    counts[Guarantee::kept], counts[Guarantee::over_budget], g.reached_min, g.binding_node,
                    g.binding_name.c_str());
        EXPECT_NE(report::to_table(outcome.summary, false).find("guarantee"), std::string::npos);
    }
}

TEST(GuaranteeWalk, ASelectorByAccuracyAlonePromisesWhatWasAskedOfIt) {
    walk::WalkRequest request = test::Forest::get().virtual_request(20);
    request.rest_after_ms = 0;
    request.in_frame_check = false;  // it has no budget, and here all the time it takes
    request.selector = "curve-accuracy";
    request.accuracy = 400;
    for (const rt::FrameRecord& r : test::walk(request).records) {
        EXPECT_EQ(r.guaranteed_accuracy, 400) << r.frame;
        EXPECT_EQ(r.guarantee, Guarantee::kept) << r.frame;
        EXPECT_GE(r.reached_accuracy, 400) << r.frame;
    }
    request.accuracy = 0;
    for (const rt::FrameRecord& r : test::walk(request).records) EXPECT_EQ(r.guarantee, Guarantee::none) << r.frame;
    request.selector = "threshold";
    request.accuracy = 400;  // stops there, and promises nothing
    for (const rt::FrameRecord& r : test::walk(request).records) EXPECT_EQ(r.guarantee, Guarantee::none) << r.frame;
}

TEST(GuaranteeWalk, IsReachedByCapturedCutsAndBrokenOnlyWhereNoCutFits) {
    int kept = 0, broken = 0;
    const auto model = model::read_walk(test::Forest::get().model_file, nullptr);
    ASSERT_TRUE(model.ok());
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
            const Pose pose = pose_of(record, *read);
            ASSERT_EQ(read->hash, record.cut_hash);
            const double seen = test::worst_seen_error(*read, *model, pose);
            ASSERT_NEAR(double{record.reached_accuracy} * seen, 1, 1e-5) << "frame " << frame;
            EXPECT_TRUE(test::errs_most(*read, record.binding_node, seen))
                << "frame " << frame << " names node " << record.binding_node;
            if (record.guarantee == Guarantee::kept) {
                ++kept;
                EXPECT_LE(seen, 1 / accuracy) << "frame " << frame;
            } else {
                ASSERT_EQ(record.guarantee, Guarantee::over_budget);
                ++broken;
                EXPECT_GT(test::bound_us(*read, 1 / accuracy),
                          test::room_us(*read, read->items, double{read->predicted_us}) * 0.97)
                    << "frame " << frame;
            }
        }
    EXPECT_GT(kept, 0);
    EXPECT_GT(broken, 0);
}

TEST(AccuracyWalk, NoPointOfTheTrueSurfaceIsFartherFromWhatIsDrawn) {
    constexpr double accuracy = 400;
    constexpr std::size_t points = 20000;
    const auto model = model::read_walk(test::Forest::get().model_file, nullptr);
    ASSERT_TRUE(model.ok());
    walk::WalkRequest request = test::Forest::get().virtual_request(61);
    request.selector = "curve-accuracy";
    request.accuracy = accuracy;
    request.rest_after_ms = 0;
    request.capture_file = test::Forest::get().dir + "/accuracy.cap";
    request.capture_frame = 60;
    const walk::WalkOutcome outcome = test::walk(request);
    const auto read = capture::read_capture(request.capture_file);
    ASSERT_TRUE(read.ok());
    const rt::FrameRecord& record = outcome.records.back();
    ASSERT_EQ(read->hash, record.cut_hash);
    const Pose pose = pose_of(record, *read);
    const test::SurfacePoints seen = test::judge_surface_points(*read, *model, pose, 1 / accuracy, points);
    EXPECT_GE(seen.points, points * 9 / 10);
    EXPECT_GT(seen.items, 50U);
    EXPECT_EQ(seen.beyond, 0U) << "the worst: 1/" << 1 / seen.worst_rad << " rad, of "
                               << model->name_of(model->nodes[seen.worst_node]);
    std::printf("%zu points on %zu coarse forms: at most 1/%.1f rad off\n", seen.points, seen.items, 1 / seen.worst_rad);
    const test::SurfacePoints finer = test::judge_surface_points(*read, *model, pose, seen.worst_rad / 2, points);
    EXPECT_GT(finer.beyond, 0U) << "points that are farther off are found";
}

TEST(GuaranteeWalk, OfALateFrameIsToldFromOneThatCannotBePaid) {
    walk::WalkRequest request = guaranteed(20, frames);
    request.cost_scale = 2;  // costs twice what was predicted, so the rest of a frame is drawn coarse
    request.correct_costs = false;
    const walk::WalkOutcome outcome = test::walk(request);
    int late = 0;
    for (const rt::FrameRecord& r : outcome.records) {
        late += r.guarantee == Guarantee::stand_ins ? 1 : 0;
        ASSERT_EQ(r.guarantee == Guarantee::kept, double{r.reached_accuracy} >= 20) << r.frame;
        if (r.guarantee == Guarantee::stand_ins) {
            ASSERT_GT(r.downgraded_slices, 0U) << r.frame;
        }
    }
    EXPECT_GT(late, frames / 4);
    EXPECT_EQ(outcome.summary.guarantee.broken.at("stand_ins"), static_cast<std::uint64_t>(late));
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
