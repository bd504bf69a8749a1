// The walk on the virtual clock: bit-equal cuts, the in-frame check, the budget, conservation of slots.
#include <gtest/gtest.h>

#include <unistd.h>

#include "render/measure/calibrate.hpp"
#include "rt/base/file.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/walk/state.hpp"

namespace surefoot {
namespace {

using test::walk;

TEST(VirtualWalk, CutsAreBitEqualAtAnyWorkerCountAndAcrossRuns) {
    walk::WalkRequest request = test::Forest::get().virtual_request(120);
    request.workers = 1;
    const std::string hash = walk(request).summary.cut_hash;
    EXPECT_FALSE(hash.empty());
    EXPECT_EQ(walk(request).summary.cut_hash, hash);
    for (const int workers : {2, 4}) {
        request.workers = workers;
        EXPECT_EQ(walk(request).summary.cut_hash, hash) << workers << " workers";
    }
}

TEST(VirtualWalk, EverySlotIsRunOrSkippedExactly) {
    walk::WalkRequest request = test::Forest::get().virtual_request(200);
    request.in_frame_check = false;
    request.correct_costs = false;
    request.cost_scale = 2.3;
    const walk::WalkOutcome outcome = walk(request);
    ASSERT_EQ(outcome.records.size(), 200U);
    std::uint64_t skipped = 0;
    for (const rt::FrameRecord& r : outcome.records) skipped += r.skipped_before;
    EXPECT_EQ(outcome.records.back().slot + 1, outcome.records.size() + skipped);
    EXPECT_GT(skipped, 0U) << "costs of 2.3 times the budget must overrun slots, or the test shows nothing";
}

TEST(VirtualWalk, RecordsAndLedgerSayWhatWasBoughtBesideForms) {
    walk::WalkRequest request = test::Forest::get().virtual_request(20);
    request.resolution_pct = 100;
    for (const rt::FrameRecord& r : walk(request).records) {
        EXPECT_EQ(r.bought_items + r.refused_items, 0U);
        EXPECT_EQ(r.bought_us, 0.0F);
    }
    const test::TemporaryFolder folder;
    request.resolution_pct = 50;
    request.ledger_file = folder / "ledger.csv";
    for (const rt::FrameRecord& r : walk(request).records) {
        EXPECT_EQ(r.bought_items, 1U) << "the enlarging, frame " << r.frame;
        EXPECT_GT(r.bought_us, 100.0F);
        EXPECT_LT(r.bought_us, r.predicted_us);
    }
    const auto ledger = read_text(request.ledger_file);
    ASSERT_TRUE(ledger.ok());
    EXPECT_NE(ledger->find(",bought_items,bought_us,refused_items,"), std::string::npos);
}

TEST(VirtualWalk, ChoosesTheResolutionWhereTimeIsShortAndAlikeAtAnyWorkerCount) {
    walk::WalkRequest request = test::Forest::get().virtual_request(60);
    auto costs = std::make_shared<model::CostModel>(model::default_costs());
    costs->combine.submit_weight *= 0.1F;
    costs->combine.raster_weight *= 20.0F;  // pixels are dear, and a softer picture loses little
    for (float& loss : costs->blur_loss) loss *= 0.2F;
    request.given_costs = costs;
    request.workers = 1;
    const walk::WalkOutcome chosen = walk(request);
    EXPECT_LT(chosen.summary.resolution_min, 1);
    ASSERT_FALSE(chosen.records.empty());
    EXPECT_LT(chosen.records.front().resolution, 1) << "compared before the walk begins";
    for (const int workers : {2, 4}) {
        request.workers = workers;
        EXPECT_EQ(walk(request).summary.cut_hash, chosen.summary.cut_hash) << workers << " workers";
    }
    request.workers = 1;
    request.resolution_pct = 100;
    EXPECT_EQ(walk(request).summary.resolution_min, 1) << "as asked for";
    request.resolution_pct = 0;
    request.accuracy = 10;
    EXPECT_EQ(walk(request).summary.resolution_min, 1) << "an accuracy is asked for, not all that time buys";
    request.accuracy = 0;
    request.selector = "two-stage";
    EXPECT_EQ(walk(request).summary.resolution_min, 1) << "it knows no value";
}

TEST(VirtualWalk, PlansUpToTheLimitOfTheInFrameCheck) {
    for (const char* backend : {"null", "egl"}) {
        walk::WalkRequest request = test::Forest::get().virtual_request(80);
        request.backend = backend;
        const auto outcome = walk::run_walk(request, {}, {});
        if (!outcome && request.backend == "egl") GTEST_SKIP() << outcome.error().text();
        ASSERT_TRUE(outcome.ok()) << outcome.error().text();
        ASSERT_EQ(outcome->records.size(), 80U);
        for (const rt::FrameRecord& r : outcome->records) {
            EXPECT_NEAR(double{r.budget_us}, 0.88 * 1e6 / request.rate_hz, 1) << backend << ", frame " << r.frame;
            EXPECT_EQ(r.downgraded_slices, 0U) << "costs are as predicted";
        }
    }
}

TEST(VirtualWalk, AResolutionBelowTheLeastIsReportedAndDrawnAsTheLeast) {
    walk::WalkRequest request = test::Forest::get().virtual_request(5);
    request.resolution_pct = 10;
    const walk::WalkOutcome outcome = walk(request);
    for (const rt::FrameRecord& r : outcome.records) EXPECT_EQ(r.resolution, 0.5F);
    const auto is_message = [](const std::string& note) { return note == "resolution: 10 % is below the least. 50 % is drawn."; };
    EXPECT_EQ(std::count_if(outcome.notes.begin(), outcome.notes.end(), is_message), 1);
    request.resolution_pct = 60;
    EXPECT_TRUE(walk(request).notes.empty());
}

TEST(VirtualWalk, SamplesAreRecordedAndPredicted) {
    walk::WalkRequest request = test::Forest::get().virtual_request(60);
    const walk::WalkOutcome plain = walk(request);
    for (const rt::FrameRecord& r : plain.records) EXPECT_EQ(r.samples, 1U);
    const test::TemporaryFolder folder;
    request.samples = 4;
    request.ledger_file = folder / "ledger.csv";
    const walk::WalkOutcome smooth = walk(request);
    ASSERT_EQ(smooth.records.size(), 60U);
    for (const rt::FrameRecord& r : smooth.records) {
        EXPECT_EQ(r.samples, 4U);
        EXPECT_FALSE(r.other_samples) << "the virtual device has any number";
        EXPECT_FALSE(r.missed) << "costs are predicted with their samples, frame " << r.frame;
    }
    EXPECT_TRUE(smooth.notes.empty());
    EXPECT_LT(smooth.summary.triangles_mean, plain.summary.triangles_mean) << "dearer pixels leave time for fewer triangles";
    EXPECT_NE(read_text(request.ledger_file).value().find(",samples,other_samples,filter,"), std::string::npos);
}

TEST(VirtualWalk, SamplesThatTheDriverLacksAreFlaggedAndSaidOnce) {
    walk::WalkRequest request = test::Forest::get().virtual_request(3);
    request.backend = "egl";
    request.samples = 2;  // software drivers have four or none
    const auto outcome = walk::run_walk(request, {}, {});
    if (!outcome) GTEST_SKIP() << outcome.error().text();
    ASSERT_EQ(outcome->records.size(), 3U);
    const std::uint32_t drawn = outcome->records.front().samples;
    for (const rt::FrameRecord& r : outcome->records) EXPECT_EQ(r.other_samples, drawn != 2U);
    const auto is_message = [&](const std::string& note) {
        return note == "samples: The driver cannot draw 2 a pixel. It draws " + std::to_string(drawn) + ".";
    };
    EXPECT_EQ(std::count_if(outcome->notes.begin(), outcome->notes.end(), is_message), drawn != 2U ? 1 : 0);
}

TEST(VirtualWalk, ACostTableOfAnotherMachineIsReportedAndNoFrameIsLost) {
    const test::TemporaryFolder folder;
    model::CostModel costs = model::default_costs();
    costs.calibrated = true;
    costs.machine = "a machine elsewhere";
    ASSERT_TRUE(measure::write_costs(walk::cost_table_file(folder.path()), costs).ok());
    walk::WalkRequest request = test::Forest::get().virtual_request(3);
    request.backend = "egl";
    request.state_dir = folder.path();
    const auto outcome = walk::run_walk(request, {}, {});
    if (!outcome && outcome.error().kind == ErrorKind::no_device) GTEST_SKIP() << outcome.error().text();
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    EXPECT_EQ(outcome->records.size(), 3U);
    EXPECT_NE(outcome->summary.uncalibrated.find("a machine elsewhere"), std::string::npos) << outcome->summary.uncalibrated;
}

TEST(VirtualWalk, ATourThatStartsAtSpeedIsPreparedForFromItsFirstFrame) {
    walk::WalkRequest request = test::Forest::get().virtual_request(10);
    const test::TemporaryFolder folder;
    Path fast = *read_path(request.path_file);
    for (auto& sample : fast.samples) sample.time_s /= 40;
    const double speed_m_s = glm::length(sample_path(fast, 0.01).position - sample_path(fast, 0).position) / 0.01;
    EXPECT_GT(speed_m_s, 25) << "or the test shows nothing";
    request.path_file = folder / "fast.csv";
    ASSERT_TRUE(write_path(request.path_file, fast).ok());
    for (const rt::FrameRecord& r : walk(request).records)
        EXPECT_GT(r.candidates, 0U) << "frame " << r.frame << " was drawn coarse";
}

TEST(VirtualWalk, CostsUnderPredictedTwofoldMissNothingWithTheInFrameCheckAndMissWithoutIt) {
    walk::WalkRequest request = test::Forest::get().virtual_request(600);
    request.cost_scale = 2;
    request.correct_costs = false;  // the check alone must hold, for all 600 frames
    const walk::WalkOutcome checked = walk(request);
    EXPECT_EQ(checked.summary.misses, 0U);
    EXPECT_GT(checked.summary.downgrades, 0U);
    request.in_frame_check = false;
    EXPECT_GT(walk(request).summary.misses, 300U);
}

TEST(VirtualWalk, WithinAFewFramesTheCorrectionMeetsADoubledCost) {
    walk::WalkRequest request = test::Forest::get().virtual_request(300);
    request.cost_scale = 1.9;
    const walk::WalkOutcome outcome = walk(request);
    std::uint32_t late_downgrades = 0;
    for (const rt::FrameRecord& r : outcome.records) late_downgrades += r.frame > 60 ? r.downgraded_slices : 0;
    EXPECT_EQ(outcome.summary.misses, 0U);
    EXPECT_EQ(late_downgrades, 0U);
}

TEST(VirtualWalk, EverySelectorWalksAndThoseByBudgetKeepIt) {
    walk::WalkRequest request = test::Forest::get().virtual_request(60);
    request.in_frame_check = false;
    for (const auto* selector : {"depth-first", "best-first", "two-stage", "curve-budget"}) {
        request.selector = selector;
        const walk::WalkOutcome outcome = walk(request);
        for (const rt::FrameRecord& r : outcome.records) {
            ASSERT_LE(r.actual_us, std::max(r.budget_us, r.floor_us) * 1.0001F) << selector << " frame " << r.frame;
        }
    }
    for (const auto* selector : {"flat", "distance", "curve-accuracy", "depth-first-1994", "best-first-1994", "two-stage-1994"}) {
        request.selector = selector;
        EXPECT_EQ(walk(request).records.size(), 60U) << selector;
    }
}

TEST(VirtualWalk, BadRequestsNameThePlaceAndTheRemedy) {
    const walk::WalkRequest good = test::Forest::get().virtual_request(10);
    const auto refused = [&](auto change) {
        walk::WalkRequest request = good;
        change(request);
        auto outcome = walk::run_walk(request, {});
        if (outcome.ok()) return std::string();
        EXPECT_FALSE(outcome.error().remedy.empty()) << outcome.error().text();
        return outcome.error().text();
    };
    EXPECT_NE(refused([](auto& r) { r.model_file = "absent.walk"; }).find("absent.walk"), std::string::npos);
    EXPECT_NE(refused([](auto& r) { r.path_file = "absent.csv"; }).find("absent.csv"), std::string::npos);
    EXPECT_NE(refused([](auto& r) { r.selector = "best"; }).find("two-stage"), std::string::npos);
    EXPECT_NE(refused([](auto& r) { r.ledger_file = "/nonexistent/ledger.csv"; }).find("/nonexistent"), std::string::npos);
}

}  // namespace
}  // namespace surefoot
