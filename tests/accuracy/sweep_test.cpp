// A sweep on a small forest: the points at one budget, what one more millisecond buys, and the marks of single changed settings.
#include "tools/accuracy/sweep.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <vector>

#include "tests/walk/walk_fixture.hpp"

namespace surefoot::accuracy {
namespace {

TEST(AccuracySweep, MarksTheBudgetOfTheRateWithOneSettingChanged) {
    AccuracyRequest request;
    request.model_file = test::Forest::get().model_file;
    request.path_file = test::Forest::get().path_file;
    request.state_dir = test::Forest::get().dir;
    request.width = 320;
    request.height = 180;
    request.poses = 2;
    request.repeats = 1;
    request.rate_hz = 120;
    request.selectors = {"distance", "threshold"};
    request.budgets_ms = {6};
    const auto run = run_accuracy(request, {});
    ASSERT_TRUE(run.ok()) << run.error().text();
    EXPECT_EQ(run->points.size(), 2U);
    ASSERT_EQ(run->one_more_ms.size(), 1U);
    EXPECT_GE(run->one_more_ms[0].now.estimated_gain, 0);
    EXPECT_LE(run->one_more_ms[0].now.estimated_gain, 1);
    std::vector<std::string> changes;
    for (const ChangeMark& mark : run->changes) {
        changes.push_back(mark.change);
        EXPECT_EQ(mark.point.selector, "threshold");
        EXPECT_EQ(mark.point.frames, 2U);
        EXPECT_GT(mark.point.frame_ms_p50, 0) << mark.change;
        EXPECT_GT(mark.point.triangles, 0) << mark.change;
        EXPECT_DOUBLE_EQ(mark.point.budget_ms, run->working_ms);
    }
    ASSERT_EQ(changes, (std::vector<std::string>{"as swept", "no occlusion culling", "no focus on the middle", "gestalt 1",
                                                 "resolution 75 %", "no sun"}));
    const AccuracyPoint& as_swept = run->changes[0].point;
    EXPECT_EQ(as_swept.triangles, run->one_more_ms[0].now.triangles) << "the same cuts";
    EXPECT_EQ(as_swept.psnr_db, run->one_more_ms[0].now.psnr_db) << "the same pictures";
    for (std::size_t i = 2; i < run->changes.size(); ++i)
        EXPECT_NE(run->changes[i].point.psnr_db, as_swept.psnr_db) << run->changes[i].change << " changes pictures";
    EXPECT_LT(run->changes.back().point.psnr_db, as_swept.psnr_db) << "the sun is missed";
}

TEST(AccuracySweep, StopsWhereTheUserSaysSo) {
    AccuracyRequest request;
    request.model_file = test::Forest::get().model_file;
    request.path_file = test::Forest::get().path_file;
    request.state_dir = test::Forest::get().dir;
    request.width = request.height = 64;
    request.poses = 1;
    const std::atomic<bool> stop = true;
    Progress progress;
    progress.stop = &stop;
    const auto run = run_accuracy(request, progress);
    ASSERT_FALSE(run.ok());
    EXPECT_EQ(run.error().kind, ErrorKind::stopped);
}

}  // namespace
}  // namespace surefoot::accuracy
