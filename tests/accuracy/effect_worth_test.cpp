// The report of effects: what each costs and shows, and a page that holds it.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <nlohmann/json.hpp>

#include "rt/base/file.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/text_pieces.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/accuracy/effect_worth.hpp"
#include "tools/report/report.hpp"

namespace surefoot::accuracy {
namespace {

PlacesRequest of_the_forest() {
    PlacesRequest request;
    request.model_file = test::Forest::get().model_file;
    request.path_file = test::Forest::get().path_file;
    request.state_dir = test::Forest::get().dir;
    request.width = 160;
    request.height = 90;
    request.poses = 2;
    request.repeats = 1;
    return request;
}

TEST(EffectWorth, EachEffectIsDrawnWithAndWithoutAndTheRestIsSaidToBeAbsent) {
    const auto report = measure_effects(of_the_forest(), {});
    ASSERT_TRUE(report.ok()) << report.error().text();
    std::size_t shown = 0;
    for (const EffectWorth& e : report->effects) {
        EXPECT_FALSE(e.reason.empty()) << e.name;
        if (!e.called_for) {
            EXPECT_EQ(e.shown_at, 0U) << e.name << ": nothing that nobody calls for is drawn";
        }
        if (e.shown_at == 0) continue;
        ++shown;
        EXPECT_GT(e.worth.with_ms, 0) << e.name;
        EXPECT_GT(e.worth.without_ms, 0) << e.name;
        EXPECT_LT(e.worth.psnr_db, report::max_psnr_db) << e.name << " is seen";
        EXPECT_GE(e.worth.psnr_db, report->bare.psnr_db - 6) << e.name << ": all together are worth more";
        EXPECT_FALSE(e.worth.with.empty());
        EXPECT_NE(e.worth.with, e.worth.without) << e.name;
    }
    EXPECT_GE(shown, 2U) << "the forest is lit and has colours";
    const test::TemporaryFolder folder;
    ASSERT_TRUE(write_effects_page(folder / "page", *report).ok());
    const auto json = nlohmann::json::parse(*read_text(folder / "page/effects.json"));
    EXPECT_EQ(json["effects"].size(), report->effects.size());
    EXPECT_GT(json["bare"]["flip"], 0);
    const std::string page = *read_text(folder / "page/index.html");
    for (const EffectWorth& e : report->effects) EXPECT_NE(page.find("<td>" + e.name + "</td>"), std::string::npos) << e.name;
    EXPECT_EQ(test::count_of(page, "<figcaption>with</figcaption>"), shown + 1);
}

TEST(EffectWorth, StopsWhereTheUserSaysSo) {
    const std::atomic<bool> stop = true;
    Progress progress;
    progress.stop = &stop;
    const auto report = measure_effects(of_the_forest(), progress);
    ASSERT_FALSE(report.ok());
    EXPECT_EQ(report.error().kind, ErrorKind::stopped);
}

TEST(EffectWorth, OfABackendWithoutPicturesIsRefused) {
    PlacesRequest request = of_the_forest();
    request.backend = "null";
    const auto report = measure_effects(request, {});
    ASSERT_FALSE(report.ok());
    EXPECT_EQ(report.error().kind, ErrorKind::misuse);
}

}  // namespace
}  // namespace surefoot::accuracy
