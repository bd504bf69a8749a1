// The image cache in a walk: seen in its figures, the same at any number of workers, and no violation of the frame thread's
// rules.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "rt/base/file.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/report/report.hpp"

namespace surefoot {
namespace {

TEST(PictureWalk, DrawsAndBuysPicturesWithinTheBudgetAndSaysSo) {
    walk::WalkRequest request = test::Forest::get().virtual_request(50);
    request.cache = rt::ImageCache::view;
    const test::TemporaryFolder folder;
    request.report_dir = folder / "report";
    const walk::WalkOutcome outcome = test::walk(request);
    const report::PicturesSummary& pictures = outcome.summary.pictures;
    EXPECT_GT(pictures.made, 0U);
    EXPECT_GT(pictures.drawn_mean, 0.5);
    EXPECT_GT(pictures.max_bytes, 0U);
    EXPECT_EQ(outcome.summary.misses, 0U);
    for (const rt::FrameRecord& r : outcome.records) {
        ASSERT_EQ(r.guard_violations, 0U) << r.frame;
        ASSERT_LE(r.captures_us, 0.25F * r.budget_us + 1) << r.frame;
        ASSERT_LE(r.pictures_reused, r.pictures) << r.frame;
        ASSERT_GE(r.pictures_reused + r.pictures_made, r.pictures) << r.frame;
    }
    const auto json = nlohmann::json::parse(report::to_json(outcome.summary))["pictures"];
    EXPECT_EQ(json["made"], pictures.made);
    EXPECT_GT(json["reused_mean"], 0.5);
    EXPECT_GT(json["boxes_as_triangles_mean"], 1);
    const std::string page = *read_text(folder / "report/index.html");
    EXPECT_NE(page.find("The image cache from above"), std::string::npos) << "with the pictures of the path";
    EXPECT_NE(page.find("Cached pictures"), std::string::npos);
    request.workers = 3;
    const walk::WalkOutcome again = test::walk(request);
    EXPECT_EQ(again.summary.cut_hash, outcome.summary.cut_hash);
    EXPECT_EQ(again.summary.pictures.made, pictures.made);
}

/// A walk after it, as a service begins one, has no picture of the time before.
TEST(PictureWalk, AfterALostContextAllPicturesAreMadeAnew) {
    walk::WalkRequest request = test::Forest::get().virtual_request(24);
    request.cache = rt::ImageCache::view;
    const walk::WalkOutcome whole = test::walk(request);
    walk::WalkObserver observer;
    observer.inject = [](walk::FramePhase phase, const rt::FrameRecord& record) {
        return phase == walk::FramePhase::finish && record.frame == 15 ? walk::Fault::context_lost : walk::Fault::none;
    };
    const auto broken = walk::run_walk(request, {}, observer);
    ASSERT_TRUE(broken.ok());
    EXPECT_TRUE(broken->lost);
    ASSERT_EQ(broken->records.size(), 16U) << "no frame comes after it";
    EXPECT_GT(broken->records.back().pictures, 0U);
    const walk::WalkOutcome again = test::walk(request);
    ASSERT_EQ(again.records.size(), whole.records.size());
    for (std::size_t i = 0; i < whole.records.size(); ++i) {
        EXPECT_EQ(again.records[i].pictures, whole.records[i].pictures) << i;
        EXPECT_EQ(again.records[i].pictures_made, whole.records[i].pictures_made) << i;
        EXPECT_EQ(again.records[i].picture_bytes, whole.records[i].picture_bytes) << i;
    }
    EXPECT_EQ(again.records.front().pictures, 0U);
    EXPECT_EQ(again.summary.cut_hash, whole.summary.cut_hash);
}

TEST(PictureWalk, OfTheSurroundAreTheSameAtAnyNumberOfWorkers) {
    walk::WalkRequest request = test::Forest::get().virtual_request(50);
    request.cache = rt::ImageCache::surround;
    const walk::WalkOutcome one = test::walk(request);
    EXPECT_GT(one.summary.pictures.made, 0U);
    EXPECT_EQ(one.summary.misses, 0U);
    for (const rt::FrameRecord& r : one.records) ASSERT_EQ(r.guard_violations, 0U) << r.frame;
    request.workers = 3;
    const walk::WalkOutcome three = test::walk(request);
    EXPECT_EQ(three.summary.cut_hash, one.summary.cut_hash);
    EXPECT_EQ(three.summary.pictures.made, one.summary.pictures.made);
    EXPECT_EQ(three.summary.pictures.max_bytes, one.summary.pictures.max_bytes);
}

TEST(PictureWalk, WithoutTheSettingThereAreNone) {
    const walk::WalkOutcome outcome = test::walk(test::Forest::get().virtual_request(30));
    EXPECT_EQ(outcome.summary.pictures.made, 0U);
    EXPECT_EQ(outcome.summary.pictures.max_bytes, 0U);
    for (const rt::FrameRecord& r : outcome.records) ASSERT_EQ(r.pictures + r.bought_items, 0U) << r.frame;
}

}  // namespace
}  // namespace surefoot
