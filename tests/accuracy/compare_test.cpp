// Comparing selectors: who walks when, medians and sums, and what JSON and table print.
#include "tools/accuracy/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace surefoot::accuracy {
namespace {

/// Walks that never ran: each has a PSNR of its number.
struct FakeWalks {
    std::vector<std::string> walked;
    std::vector<double> psnr_db;
    std::uint32_t pictures = 7;

    std::vector<double> resolutions_pct = {};
    [[nodiscard]] Result<walk::WalkOutcome> operator()(const walk::WalkRequest& request) {
        const std::size_t number = walked.size();
        resolutions_pct.push_back(request.resolution_pct);
        walked.push_back(request.selector);
        walk::WalkOutcome outcome;
        report::WalkSummary& s = outcome.summary;
        s.model = "m.walk";
        s.frames = 100;
        s.misses = number;
        s.accuracy_mean = request.selector == "flat" ? std::numeric_limits<double>::infinity() : 5;
        s.frame_ms.p99 = 10 + static_cast<double>(number);
        s.picture.frames = pictures;
        s.picture.psnr_db = psnr_db.at(number);
        s.picture.pop_frames = pictures > 1 ? pictures - 1 : 0;
        s.picture.popped_share = 0.001 * static_cast<double>(number);
        s.floor_frames = number;
        return outcome;
    }
};

CompareRequest request_of(std::vector<std::string> selectors, std::uint32_t rounds) {
    CompareRequest request;
    request.walk.model_file = "m.walk";
    request.selectors = std::move(selectors);
    request.rounds = rounds;
    return request;
}

Result<Comparison> compare(FakeWalks& walks, const CompareRequest& request, const Progress& progress = {},
                           const FindShares& find_shares = nullptr) {
    return compare_selectors(
        request, [&](const walk::WalkRequest& one, const Progress&) { return walks(one); }, find_shares, progress);
}

TEST(Compare, SelectorsWalkInTurnsAndMediansAreOfTheRounds) {
    FakeWalks walks{{}, {20, 40, 30, 41, 22, 90}};
    const auto c = compare(walks, request_of({"two-stage", "flat"}, 3));
    ASSERT_TRUE(c.ok());
    EXPECT_EQ(walks.walked, (std::vector<std::string>{"two-stage", "flat", "two-stage", "flat", "two-stage", "flat"}));
    ASSERT_EQ(c->selectors.size(), 2U);
    EXPECT_EQ(c->selectors[0].selector, "two-stage");
    EXPECT_EQ(c->selectors[0].psnr_db, 22);
    EXPECT_EQ(c->selectors[0].min_psnr_db, 20);
    EXPECT_EQ(c->selectors[0].max_psnr_db, 30);
    EXPECT_EQ(c->selectors[0].frames, 300U);
    EXPECT_EQ(c->selectors[0].misses, 0U + 2U + 4U);
    EXPECT_EQ(c->selectors[0].floor_frames, 0U + 2U + 4U);
    EXPECT_DOUBLE_EQ(c->selectors[0].popped_share, 0.002);
    EXPECT_EQ(c->selectors[1].psnr_db, 41);
    EXPECT_TRUE(std::isinf(c->selectors[1].accuracy_mean)) << "exact in every round";
}

TEST(Compare, AnEvenNumberOfRoundsHasTheMeanOfTheMiddles) {
    FakeWalks walks{{}, {20, 30}};
    const auto c = compare(walks, request_of({"two-stage"}, 2));
    ASSERT_TRUE(c.ok());
    EXPECT_EQ(c->selectors[0].psnr_db, 25);
    EXPECT_EQ(c->selectors[0].frame_ms_p99, 10.5);
}

TEST(Compare, JsonIsValidWhereAFigureIsInfiniteAndTheTableSaysExact) {
    FakeWalks walks{{}, {20}};
    const auto c = compare(walks, request_of({"flat"}, 1));
    ASSERT_TRUE(c.ok());
    const auto json = nlohmann::json::parse(compare_json(*c));
    EXPECT_EQ(json["selectors"][0]["selector"], "flat");
    EXPECT_EQ(json["selectors"][0]["psnr_db"], 20);
    EXPECT_TRUE(json["selectors"][0]["accuracy"]["mean"].is_null());
    EXPECT_DOUBLE_EQ(json["selectors"][0]["popping"]["pixels"].get<double>(), 0);
    EXPECT_EQ(json["selectors"][0]["floor_frames"], 0);
    const std::string table = compare_table(*c);
    EXPECT_NE(table.find("exact"), std::string::npos) << table;
    for (std::size_t begin = 0; begin < table.size(); begin = table.find('\n', begin) + 1)
        EXPECT_LE(table.find('\n', begin) - begin, 100U) << table;
}

TEST(Compare, OnePictureHasNoFrameBeforeToPopFrom) {
    FakeWalks walks{{}, {20}};
    walks.pictures = 1;
    const auto c = compare(walks, request_of({"flat"}, 1));
    ASSERT_TRUE(c.ok());
    EXPECT_TRUE(nlohmann::json::parse(compare_json(*c))["selectors"][0]["popping"].is_null());
}

/// Shares of 0.9 of the bound, `proven` of 4 frames.
FindShares shares_of(std::uint32_t proven, std::vector<std::string>& names) {
    return [proven, &names](std::span<const std::string> selectors, double, const Progress&) -> Result<ValueShares> {
        names.assign(selectors.begin(), selectors.end());
        ValueShares shares;
        shares.frames = 4;
        shares.proven = proven;
        for (const std::string& name : selectors) shares.selectors.push_back({name, 0.95, 0.8, 0.9, 0.7});
        return shares;
    };
}

TEST(Compare, TheShareOfTheGreatestValueIsOfTheBoundWhereTheOptimumIsNotProven) {
    for (const std::uint32_t proven : {4U, 3U}) {
        FakeWalks walks{{}, {20, 21}};
        std::vector<std::string> names;
        const auto c = compare(walks, request_of({"flat", "threshold"}, 1), {}, shares_of(proven, names));
        ASSERT_TRUE(c.ok());
        EXPECT_EQ(names, std::vector<std::string>{"threshold"}) << "flat keeps no budget";
        const auto json = nlohmann::json::parse(compare_json(*c));
        EXPECT_TRUE(json["selectors"][0]["value_share"].is_null());
        EXPECT_DOUBLE_EQ(json["selectors"][1]["value_share"]["of_bound"]["mean"].get<double>(), 0.9);
        EXPECT_DOUBLE_EQ(json["selectors"][1]["value_share"]["of_best_known"]["min"].get<double>(), 0.8);
        EXPECT_EQ(json["value_frames"]["proven"], proven);
        const std::string table = compare_table(*c);
        EXPECT_EQ(table.find(">=90.00") != std::string::npos, proven < 4) << table;
        EXPECT_NE(table.find("90.00"), std::string::npos) << table;
        for (std::size_t begin = 0; begin < table.size(); begin = table.find('\n', begin) + 1)
            EXPECT_LE(table.find('\n', begin) - begin, 100U) << table;
    }
}

TEST(Compare, WithoutASearchForTheGreatestValueNoShareIsStated) {
    FakeWalks walks{{}, {20}};
    const auto c = compare(walks, request_of({"threshold"}, 1));
    ASSERT_TRUE(c.ok());
    EXPECT_TRUE(nlohmann::json::parse(compare_json(*c))["selectors"][0]["value_share"].is_null());
    EXPECT_EQ(c->value.frames, 0U);
}

TEST(Compare, SettingsWalkInTurnsUnderTheirNamesAndNoValueIsShared) {
    FakeWalks walks{{}, {20, 40, 30, 42}};
    CompareRequest request = request_of({"flat"}, 2);
    request.walk.selector = "threshold";
    request.settings = {{"as set", request.walk}, {"resolution=50,hysteresis=1.5", request.walk}};
    request.settings[1].walk.resolution_pct = 50;
    std::vector<std::string> names;
    const auto c = compare(walks, request, {}, shares_of(4, names));
    ASSERT_TRUE(c.ok());
    EXPECT_EQ(walks.walked, (std::vector<std::string>(4, "threshold"))) << "the selectors of the request do not walk";
    EXPECT_EQ(walks.resolutions_pct, (std::vector<double>{0, 50, 0, 50}));
    EXPECT_TRUE(names.empty());
    const auto json = nlohmann::json::parse(compare_json(*c));
    EXPECT_FALSE(json.contains("selectors"));
    EXPECT_EQ(json["settings"][0]["setting"], "as set");
    EXPECT_EQ(json["settings"][0]["psnr_db"], 25);
    EXPECT_EQ(json["settings"][1]["setting"], "resolution=50,hysteresis=1.5");
    EXPECT_EQ(json["settings"][1]["psnr_db"], 41);
    const std::string table = compare_table(*c);
    EXPECT_NE(table.find("resolution=50,hysteresis=1.5"), std::string::npos) << table;
}

TEST(Compare, NamesWhatTheLightLostFirstAndAtWhichValue) {
    FakeWalks walks{{}, {30, 31}};
    CompareRequest request = request_of({"threshold"}, 1);
    request.settings = {{"as set", request.walk}, {"buy_effects=true", request.walk}};
    const auto c =
        compare_selectors(request,
                          [&](const walk::WalkRequest& one, const Progress&) {
                              auto outcome = walks(one);
                              if (walks.walked.size() == 2)
                                  outcome->summary.dropped_parts = {{"fog", 40, 2, 12, 0.25}, {"shadows", 9, 1, 70, 1.5}};
                              return outcome;
                          },
                          nullptr, {});
    ASSERT_TRUE(c.ok());
    const auto json = nlohmann::json::parse(compare_json(*c))["settings"];
    EXPECT_TRUE(json[0]["dropped_parts"].empty());
    ASSERT_EQ(json[1]["dropped_parts"].size(), 2U);
    EXPECT_EQ(json[1]["dropped_parts"][0]["part"], "fog");
    EXPECT_EQ(json[1]["dropped_parts"][0]["first_frame"], 12);
    EXPECT_EQ(json[1]["dropped_parts"][0]["value_per_us"], 0.25);
    EXPECT_EQ(json[1]["dropped_parts"][1]["times"], 1);
    const std::string line = "buy_effects=true: drops fog from frame 12 on, at 0.25 px/us; 40 frames without, dropped 2 times\n";
    EXPECT_NE(compare_table(*c).find(line), std::string::npos) << compare_table(*c);
    EXPECT_EQ(compare_table(*c).find("as set: drops"), std::string::npos);
}

TEST(Compare, AWalkWithoutPicturesAndAStopAreErrors) {
    FakeWalks walks{{}, {20, 20}};
    walks.pictures = 0;
    const auto none = compare(walks, request_of({"flat"}, 1));
    ASSERT_FALSE(none.ok());
    EXPECT_NE(none.error().text().find("--seconds"), std::string::npos) << none.error().text();
    walks.pictures = 1;
    const std::atomic<bool> stop{true};
    const auto stopped = compare(walks, request_of({"flat", "two-stage"}, 1), {.report = {}, .stop = &stop, .notify = {}});
    ASSERT_FALSE(stopped.ok());
    EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
    EXPECT_EQ(walks.walked.size(), 2U) << "nothing walks after a stop";
}

}  // namespace
}  // namespace surefoot::accuracy
