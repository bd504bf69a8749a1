// What a sweep of budgets leaves on disk: a page that needs nothing outside itself, CSV, JSON and charts.
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/file.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/text_pieces.hpp"
#include "tools/accuracy/page.hpp"
#include "tools/accuracy/sweep.hpp"
#include "tools/report/report.hpp"

namespace surefoot::accuracy {
namespace {

AccuracyRun sweep() {
    AccuracyRun run;
    run.model = "forest.walk";
    run.full_frame_ms = 100;
    for (const auto* selector : {"two-stage", "two-stage-1994", "flat"})
        for (const double budget : {10.0, 20.0, 40.0}) {
            AccuracyPoint p;
            p.selector = selector;
            p.budget_ms = budget;
            p.frame_ms_p50 = budget * 0.9;
            p.accuracy_mean = budget * 10;
            p.snr_db = budget / 3;
            p.ssim = 0.9;
            p.frames = 5;
            run.points.push_back(p);
        }
    run.points.back().snr_db = std::numeric_limits<double>::infinity();
    run.points.back().snr_infinite = 5;
    run.points.back().accuracy_mean = std::numeric_limits<double>::infinity();
    run.points.back().exact = 5;
    return run;
}

TEST(AccuracyPage, AndItsFiles) {
    const test::TemporaryFolder folder;
    const auto in = [&](const std::string& name) { return folder / name; };
    const auto run = sweep();
    ASSERT_TRUE(write_accuracy_page(in("a"), run).ok());
    const auto page = *read_text(in("a/index.html"));
    EXPECT_EQ(page.find("http"), std::string::npos);
    EXPECT_EQ(test::split(*read_text(in("a/accuracy.csv")), '\n').size(), run.points.size() + 1);
    const auto json = nlohmann::json::parse(*read_text(in("a/accuracy.json")));
    EXPECT_EQ(json["points"].size(), run.points.size());
    EXPECT_TRUE(json["points"].back()["snr_db"].is_null());
    EXPECT_TRUE(json["points"].back()["accuracy"].is_null());
    EXPECT_EQ(json["points"].back()["exact"], 5);
    EXPECT_NE(page.find("left out of the mean"), std::string::npos);
    for (const bool dark : {false, true}) {
        const auto svg = accuracy_svg(run, dark);
        EXPECT_EQ(svg.rfind("<svg xmlns=", 0), 0U);
        // 9 points in three panels, the exact one in none but the last; a dot each for two corrected selectors in the legend.
        EXPECT_EQ(test::count_of(svg, "<title>two-stage"), 18U);
        EXPECT_EQ(test::count_of(svg, "<title>flat"), 7U);
        EXPECT_EQ(svg.find("nan"), std::string::npos);
        EXPECT_EQ(svg.find("inf"), std::string::npos);
    }
    EXPECT_NE(accuracy_svg(run, false), accuracy_svg(run, true));
    const std::string worst = *read_text(in("a/accuracy-worst.svg"));
    for (const char* const shown : {"Worst accuracy", "PSNR", "FLIP", "<title>two-stage"})
        EXPECT_NE(worst.find(shown), std::string::npos) << shown;
    EXPECT_TRUE(read_text(in("a/accuracy-worst-dark.svg")).ok());
}

AccuracyPoint point(double ms, double accuracy, double psnr_db) {
    AccuracyPoint p;
    p.selector = "threshold";
    p.frame_ms_p50 = p.frame_ms_p99 = ms;
    p.accuracy_mean = p.accuracy_worst = accuracy;
    p.psnr_db = psnr_db;
    return p;
}

TEST(AccuracyPage, MarksWhatNoOtherPointBeats) {
    constexpr double exact = std::numeric_limits<double>::infinity();
    std::vector<AccuracyPoint> points = {point(10, 50, 30),
                                         point(10, 60, 29),
                                         point(20, 55, 40),
                                         point(20, 55, 40),
                                         point(30, exact, report::max_psnr_db),
                                         point(40, exact, report::max_psnr_db)};
    mark_fronts(points);
    std::string accuracy, psnr;
    for (const AccuracyPoint& p : points) {
        accuracy += p.accuracy_front ? 'y' : 'n';
        psnr += p.psnr_front ? 'y' : 'n';
    }
    EXPECT_EQ(accuracy, "nynnyn");
    EXPECT_EQ(psnr, "ynyyyn") << "equal points are both on it";
}

TEST(AccuracyPage, SaysWhatOneMoreMillisecondBuys) {
    auto run = sweep();
    EXPECT_EQ(nlohmann::json::parse(accuracy_json(run))["one_more_ms"].size(), 0U);
    run.rate_hz = 30;
    run.working_ms = 29.3;
    run.one_more_ms = {{point(29, 50, 40.25), point(30, 53, 40.5)}};
    run.one_more_ms[0].now.value = 0.9;
    run.one_more_ms[0].more.value = 0.9123;
    run.one_more_ms[0].now.estimated_gain = 0.0117;
    run.points.front().accuracy_front = run.points.front().psnr_front = true;
    const test::TemporaryFolder folder;
    ASSERT_TRUE(write_accuracy_page(folder / "a", run).ok());
    const auto page = *read_text(folder / "a/index.html");
    for (const char* part :
         {"30.3 ms shows instead", "<td>1.23</td><td>1.17</td>", "50 → <b>53</b>", "40.25 → <b>40.50</b>", "class=\"front\""})
        EXPECT_NE(page.find(part), std::string::npos) << part;
    const auto json = nlohmann::json::parse(*read_text(folder / "a/accuracy.json"));
    EXPECT_EQ(json["one_more_ms"][0]["more"]["accuracy_worst"], 53);
    EXPECT_EQ(json["working_ms"], 29.3);
}

TEST(AccuracyPage, MarksWhatOneSettingChanges) {
    auto run = sweep();
    EXPECT_EQ(nlohmann::json::parse(accuracy_json(run))["changes"].size(), 0U);
    const test::TemporaryFolder folder;
    ASSERT_TRUE(write_accuracy_page(folder / "without", run).ok());
    EXPECT_EQ(read_text(folder / "without/index.html")->find("One setting"), std::string::npos);
    run.working_ms = 29.3;
    run.changes = {{"as swept", point(29, 50, 40.25)}, {"no occlusion culling", point(290, 7, 31)}};
    ASSERT_TRUE(write_accuracy_page(folder / "a", run).ok());
    const auto page = *read_text(folder / "a/index.html");
    for (const char* part : {"One setting changed", "<td>no occlusion culling</td><td>290.00</td>", "at the same 29.3 ms"})
        EXPECT_NE(page.find(part), std::string::npos) << part;
    EXPECT_EQ(test::count_of(page, "<title>threshold, no occlusion culling, "), 6U) << "one a panel";
    EXPECT_EQ(test::count_of(page, "class=\"as-swept\""), 6U);
    EXPECT_EQ(test::split(*read_text(folder / "a/accuracy.csv"), '\n').size(), run.points.size() + run.changes.size() + 1);
    EXPECT_NE(read_text(folder / "a/accuracy.csv")->find(",no occlusion culling\n"), std::string::npos);
    const auto json = nlohmann::json::parse(*read_text(folder / "a/accuracy.json"));
    EXPECT_EQ(json["changes"][1]["change"], "no occlusion culling");
    EXPECT_EQ(json["changes"][1]["accuracy_worst"], 7);
}

TEST(AccuracyPage, ChangesSettingsOfTheUsualSelectorOrTheFirstThatHasABudget) {
    EXPECT_EQ(changed_selector(compared_selectors()), "threshold");
    EXPECT_EQ(changed_selector({"distance", "two-stage-1994", "best-first", "two-stage"}), "best-first");
    EXPECT_EQ(changed_selector({"distance", "two-stage-1994"}), "");
    EXPECT_EQ(changed_selector({}), "");
}

TEST(AccuracyPage, OfNoPointsDoesNotDivideByZero) {
    const auto svg = accuracy_svg({}, false);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::accuracy
