// The walk's figures: percentiles that occurred, slots that add up, bare control frames kept out.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/report/records.hpp"
#include "tools/report/report.hpp"
#include "tools/report/verdict.hpp"

namespace surefoot::report {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Summary, RunAndSkippedSlotsAddUp) {
    WalkSummary s;
    summarize(frames_with_a_miss(), period_ns, s);
    EXPECT_EQ(s.frames, 4U);
    EXPECT_EQ(s.skipped, 1U);
    EXPECT_EQ(s.slots, 5U);
    EXPECT_NEAR(s.seconds, 5.0 / 30, 1e-6);
    EXPECT_EQ(s.misses, 1U);
    EXPECT_EQ(s.own_misses, 1U);
    EXPECT_EQ(s.miss_causes, (std::map<std::string, std::uint64_t>{{"raster", 1}}));
}

TEST(Summary, FiguresAreThoseOfTheFrames) {
    WalkSummary s;
    s.rasterisers = 2;
    summarize(good_frames(10), period_ns, s);
    EXPECT_NEAR(s.frame_ms.p50, 20, 1e-9);
    EXPECT_NEAR(s.wake_us.max, 50, 1e-9);
    EXPECT_NEAR(s.select_us.p99, 500, 1e-9);
    EXPECT_NEAR(s.submit_ms.p50, 10, 1e-9);
    EXPECT_NEAR(s.raster_ms.p50, 9, 1e-9);
    EXPECT_NEAR(s.budget_ms, 25, 1e-9);
    EXPECT_NEAR(s.budget_used_mean, 18.0 / 33.333333, 1e-6);  // 10 ms, and 16 ms over two rasterisers
    EXPECT_NEAR(s.budget_used_wall_mean, 0.8, 1e-6);
    EXPECT_NEAR(s.cost_error.p50, 0.1, 1e-6);
    EXPECT_EQ(s.accuracy_mean, 500);
    EXPECT_EQ(s.triangles_max, 1000U);
    EXPECT_EQ(s.switches_per_frame, 2);
    EXPECT_EQ(s.cut_hash.size(), 16U);
}

TEST(Summary, BareControlFramesDoNotCount) {
    auto records = good_frames(4);
    WalkSummary without;
    summarize(records, period_ns, without);
    auto bare = good_frame(9, 9);
    bare.control = bare.missed = true;
    bare.triangles = 1'000'000;
    bare.stolen_ns = 5'000'000;
    records.insert(records.begin() + 2, bare);
    WalkSummary with;
    summarize(records, period_ns, with);
    EXPECT_EQ(to_json(with), to_json(without));
}

TEST(Summary, CutHashFollowsTheOrderOfCuts) {
    auto records = good_frames(2);
    WalkSummary a, b;
    summarize(records, period_ns, a);
    std::swap(records[0].cut_hash, records[1].cut_hash);
    summarize(records, period_ns, b);
    EXPECT_NE(a.cut_hash, b.cut_hash);
}

TEST(Summary, SecondCallStartsAnew) {
    WalkSummary s;
    summarize(frames_with_a_miss(), period_ns, s);
    const auto first = to_json(s);
    summarize(frames_with_a_miss(), period_ns, s);
    EXPECT_EQ(to_json(s), first);
}

TEST(Summary, StealOfTheHostIsKeptUnlessTheFramesLostMore) {
    auto records = good_frames(2);
    records[0].stolen_ns = 3'000'000;
    WalkSummary s;
    s.steal_ms = 40;
    summarize(records, period_ns, s);
    EXPECT_EQ(s.steal_ms, 40);
    s.steal_ms = 0;
    summarize(records, period_ns, s);
    EXPECT_EQ(s.steal_ms, 3);
}

TEST(Summary, NoFramesAreNoFigures) {
    WalkSummary s;
    summarize({}, period_ns, s);
    EXPECT_EQ(s.slots, 0U);
    EXPECT_EQ(verdict_of(s), Verdict::bad);
    EXPECT_TRUE(nlohmann::json::accept(to_json(s)));
    EXPECT_FALSE(to_table(s, false).empty());
}

TEST(Summary, ExactPicturesHaveInfiniteAccuracyAndDoNotSpoilTheMean) {
    auto records = good_frames(3);
    records[1].accuracy = std::numeric_limits<float>::infinity();
    WalkSummary s;
    summarize(records, period_ns, s);
    EXPECT_EQ(s.accuracy_mean, 500);
    for (auto& r : records) r.accuracy = std::numeric_limits<float>::infinity();
    summarize(records, period_ns, s);
    EXPECT_EQ(s.accuracy_mean, infinity);
    EXPECT_TRUE(nlohmann::json::parse(to_json(s))["accuracy"]["mean"].is_null());
}

TEST(Summary, FramesWithoutAPredictionHaveNoErrorOfIt) {
    auto records = good_frames(4);
    WalkSummary with, without;
    summarize(records, period_ns, without);
    auto coarse = good_frame(4, 4);
    coarse.predicted_us = 0;
    records.push_back(coarse);
    summarize(records, period_ns, with);
    EXPECT_EQ(with.cost_error.max, without.cost_error.max);
}

TEST(Summary, DriversAllocationsAreReportedPerFrame) {
    auto records = good_frames(4);
    for (auto& r : records) r.driver_allocations = 42;
    WalkSummary s;
    summarize(records, period_ns, s);
    EXPECT_EQ(nlohmann::json::parse(to_json(s))["rt"]["driver_allocations_per_frame"], 42.0);
    EXPECT_NE(to_table(s, false).find("42.0 allocations"), std::string::npos);
}

TEST(Summary, MissingCostTableIsReportedOnceAndNotAsALackOfRealTime) {
    WalkSummary s;
    summarize(good_frames(2), period_ns, s);
    EXPECT_TRUE(nlohmann::json::parse(to_json(s))["calibrated"]);
    s.uncalibrated = "no cost table here";
    const std::string table = to_table(s, false);
    EXPECT_NE(table.find("uncalibrated"), std::string::npos);
    EXPECT_EQ(table.find("no cost table"), table.rfind("no cost table"));
    EXPECT_EQ(table.find("degraded"), std::string::npos);
    EXPECT_FALSE(nlohmann::json::parse(to_json(s))["calibrated"]);
}

TEST(Summary, ThreadsOfTheCensusAreNamedWithTheirPlacing) {
    WalkSummary s;
    summarize(good_frames(2), period_ns, s);
    s.threads = {{"sf-frame", 1, rt::Policy::fifo, 80, rt::CpuMask{1}},
                 {"llvmpipe-", 2, rt::Policy::fifo, 70, rt::CpuMask{0, 1}}};
    EXPECT_NE(to_table(s, false).find("sf-frame SCHED_FIFO 80 on 1; 2 llvmpipe- SCHED_FIFO 70 on 0-1"), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(to_json(s))["threads"][1]["count"], 2);
}

std::set<std::string> keys_of(const nlohmann::json& object) {
    std::set<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.insert(key);
    return keys;
}

TEST(Json, HasExactlyTheKeysOfTheContract) {
    WalkSummary s;
    summarize(frames_with_a_miss(), period_ns, s);
    s.control.blocks.resize(1);
    const auto json = nlohmann::json::parse(to_json(s));
    using Keys = std::set<std::string>;
    EXPECT_EQ(keys_of(json), (Keys{"frames",
                                   "slots",
                                   "skipped",
                                   "misses",
                                   "own_misses",
                                   "miss_causes",
                                   "core_steal_misses",
                                   "frame_ms",
                                   "wake_us",
                                   "select_us",
                                   "prepare_cpu_us",
                                   "prepared_age",
                                   "budget_ms",
                                   "budget_used",
                                   "cost_error",
                                   "accuracy",
                                   "triangles",
                                   "downgrades",
                                   "switches_per_frame",
                                   "cut_hash",
                                   "steal_ms",
                                   "rt",
                                   "control",
                                   "threads",
                                   "calibrated",
                                   "input",
                                   "picture",
                                   "seat",
                                   "acuity_arcmin",
                                   "unused_ms",
                                   "coarse_frames",
                                   "floor_frames",
                                   "cost_scale",
                                   "resolution",
                                   "rest",
                                   "samples",
                                   "filter",
                                   "trilinear_frames",
                                   "shadow_map",
                                   "pictures",
                                   "shown_by",
                                   "shown_missing",
                                   "shown_interval_ms",
                                   "shown_error_us",
                                   "animation_error_ms",
                                   "one_percent_low_hz",
                                   "display",
                                   "dropped_parts"}));
    EXPECT_TRUE(json["dropped_parts"].is_array() && json["dropped_parts"].empty());
    EXPECT_TRUE(json["display"].is_null()) << "it reported nothing";
    for (const char* shown : {"shown_by", "shown_interval_ms", "shown_error_us", "animation_error_ms", "one_percent_low_hz"})
        EXPECT_TRUE(json[shown].is_null()) << shown << ": nothing was shown, so nothing is said of it";
    EXPECT_EQ(keys_of(json["rest"]), (Keys{"frames", "full_detail_frames", "samples", "full_detail_ms"}));
    for (const auto* tail : {"frame_ms", "wake_us", "select_us", "prepare_cpu_us"})
        EXPECT_EQ(keys_of(json[tail]), (Keys{"p50", "p99", "p999", "max"})) << tail;
    EXPECT_EQ(keys_of(json["prepared_age"]), (Keys{"p50", "p99", "max"}));
    EXPECT_EQ(keys_of(json["budget_used"]), (Keys{"mean", "p99"}));
    EXPECT_EQ(keys_of(json["cost_error"]), (Keys{"p50", "p90", "p99"}));
    EXPECT_EQ(keys_of(json["accuracy"]), (Keys{"min", "mean"}));
    EXPECT_EQ(keys_of(json["resolution"]), (Keys{"mean", "min"}));
    EXPECT_EQ(keys_of(json["triangles"]), (Keys{"mean", "max"}));
    EXPECT_EQ(keys_of(json["rt"]),
              (Keys{"fifo", "pinned", "isolated", "locked", "page_faults", "guard_violations", "driver_allocations_per_frame"}));
    EXPECT_EQ(keys_of(json["control"]), (Keys{"misses", "p_value", "blocks"}));
    EXPECT_EQ(keys_of(json["unused_ms"]), (Keys{"mean", "p50", "p99"}));
    EXPECT_TRUE(json["picture"].is_null()) << "no picture was compared";
    EXPECT_TRUE(json["core_steal_misses"].is_null()) << "nobody read the cores' steal";
    EXPECT_EQ(json["miss_causes"]["raster"], 1);
    EXPECT_TRUE(json["control"]["p_value"].is_null()) << "no control ran";
    EXPECT_EQ(json["control"]["blocks"].size(), 1U);
}

/// As `lock` shows them: on the grid, and the last but one 2 ms after it.
std::vector<rt::FrameRecord> shown_frames(std::size_t count) {
    std::vector<rt::FrameRecord> frames = good_frames(count);
    for (rt::FrameRecord& f : frames) {
        f.show_ns = f.handed_ns = f.presented_ns = f.shown_ns = f.due_ns + period_ns;
        f.shown_by = rt::ShownBy::hand_over;
    }
    frames[count - 2].presented_ns = frames[count - 2].shown_ns += 2'000'000;
    return frames;
}

TEST(Summary, ShownTimesAreMeasuredAndSayWhoToldThem) {
    WalkSummary s;
    s.late_policy = "lock";
    summarize(shown_frames(200), period_ns, s);
    auto json = nlohmann::json::parse(to_json(s));
    EXPECT_EQ(json["shown_by"], "hand-over");
    EXPECT_FALSE(json.contains("shown_missing"));
    EXPECT_NEAR(json["shown_interval_ms"]["p50"].get<double>(), 33.333, 1e-3);
    EXPECT_NEAR(json["shown_interval_ms"]["max"].get<double>(), 35.333, 1e-3);
    EXPECT_NEAR(json["animation_error_ms"]["max"].get<double>(), 2, 1e-3) << "the poses are a period apart";
    EXPECT_EQ(json["shown_error_us"]["p50"], 0);
    EXPECT_EQ(json["shown_error_us"]["max"], 2000);
    EXPECT_NE(to_table(s, false).find("picture to picture, by hand-over"), std::string::npos);
    s.late_policy = "float";  // no picture is planned for a point of the grid
    summarize(shown_frames(200), period_ns, s);
    json = nlohmann::json::parse(to_json(s));
    EXPECT_TRUE(json["shown_error_us"].is_null());
    EXPECT_FALSE(json["shown_interval_ms"].is_null());
}

TEST(Summary, AnIntervalNeedsTwoPicturesThatFollowOneAnother) {
    std::vector<rt::FrameRecord> frames = shown_frames(4);
    frames[1].shown_by = rt::ShownBy::nothing;
    WalkSummary s;
    s.late_policy = "lock";
    summarize(frames, period_ns, s);
    EXPECT_NEAR(s.shown.interval_ms.max, 31.333, 1e-3) << "the last one alone: the first is followed by none that was shown";
    frames[1] = frames[0];
    frames[1].control = true;
    summarize(frames, period_ns, s);
    EXPECT_NEAR(s.shown.interval_ms.max, 31.333, 1e-3) << "a bare frame lies between";
}

TEST(Summary, SamplesAndFilterAreTheWalks) {
    std::vector<rt::FrameRecord> frames = good_frames(2);
    WalkSummary s;
    summarize(frames, period_ns, s);
    EXPECT_EQ(to_table(s, false).find("samples"), std::string::npos) << "nothing to say of one sample";
    for (rt::FrameRecord& f : frames) {
        f.samples = 2;
        f.other_samples = true;
        f.filter = rt::TextureFilter::trilinear;
    }
    summarize(frames, period_ns, s);
    const std::string table = to_table(s, false);
    EXPECT_NE(table.find("2 a pixel: the driver lacks the requested number"), std::string::npos) << table;
    EXPECT_NE(table.find("trilinear"), std::string::npos) << table;
    const auto json = nlohmann::json::parse(to_json(s));
    EXPECT_EQ(json["samples"]["drawn"], 2);
    EXPECT_EQ(json["samples"]["as_requested"], false);
    EXPECT_EQ(json["filter"], "trilinear");
}

TEST(Summary, CountsTheFramesThatBoughtTheSecondMipLevel) {
    std::vector<rt::FrameRecord> frames = good_frames(5);
    WalkSummary s;
    summarize(frames, period_ns, s);
    EXPECT_EQ(to_table(s, false).find("trilinear"), std::string::npos) << "nothing to say of none";
    frames[1].filter = frames[2].filter = rt::TextureFilter::trilinear;
    summarize(frames, period_ns, s);
    EXPECT_NE(to_table(s, false).find("trilinear in 2 frames of 5"), std::string::npos) << to_table(s, false);
    const auto json = nlohmann::json::parse(to_json(s));
    EXPECT_EQ(json["filter"], "bilinear") << "of the last frame";
    EXPECT_EQ(json["trilinear_frames"], 2);
}

TEST(Summary, ResolutionIsTheMeanAndTheLeastOfTheFrames) {
    std::vector<rt::FrameRecord> frames = good_frames(4);
    WalkSummary s;
    summarize(frames, period_ns, s);
    EXPECT_EQ(s.resolution_min, 1);
    EXPECT_EQ(to_table(s, false).find("resolution"), std::string::npos) << "nothing to say at 100 %";
    frames[1].resolution = 0.5F;
    frames[2].resolution = 0.75F;
    summarize(frames, period_ns, s);
    EXPECT_DOUBLE_EQ(s.resolution_mean, 0.8125);
    EXPECT_DOUBLE_EQ(s.resolution_min, 0.5);
    EXPECT_NE(to_table(s, false).find("resolution"), std::string::npos);
}

TEST(Summary, UnusedTimeIsOfFramesThatDetailCouldImprove) {
    std::vector<rt::FrameRecord> frames = good_frames(3);
    for (rt::FrameRecord& f : frames) f.rastered_ns = f.deadline_ns - 8'000'000;
    frames[0].value = 1;  // all of its detail is there
    frames[1].value = 0.5F;
    frames[2].value = 0.98F;
    frames[2].rastered_ns = frames[2].deadline_ns + 1;  // late: nothing was left
    frames[2].downgraded_slices = 3;
    WalkSummary s;
    summarize(frames, period_ns, s);
    EXPECT_DOUBLE_EQ(s.unused_ms.mean, 4);
    EXPECT_DOUBLE_EQ(s.unused_ms.max, 8);
    EXPECT_EQ(s.coarse_frames, 1U);
    summarize(frames, period_ns, s);
    EXPECT_EQ(s.coarse_frames, 1U) << "a summary is made anew";
    frames[0].resolution = 0.5F;
    summarize(frames, period_ns, s);
    EXPECT_NEAR(s.unused_ms.mean, 16.0 / 3, 1e-9) << "all of its detail, but smaller";
}

TEST(Pictures, PsnrIsPooledAndTheWorstFrameIsNamed) {
    EXPECT_EQ(compare_pictures({}).frames, 0U);
    std::vector<ReportSnapshot> snapshots(4);
    for (std::size_t i = 1; i < 4; ++i) {  // the first has no picture: a walk without a device
        snapshots[i].walk = {0, 0, 0, 255};
        snapshots[i].frame = 10 * i;
        snapshots[i].ssim = 0.9;
        snapshots[i].flip = 0.1 * static_cast<double>(i);
    }
    snapshots[2].mse = 195.075;  // 65025 / 195.075 = 1000 / 3
    const PictureSummary p = compare_pictures(snapshots);
    EXPECT_EQ(p.frames, 3U);
    EXPECT_NEAR(p.psnr_db, 30, 1e-9) << "of the mean error, not the mean of decibels";
    EXPECT_NEAR(p.worst_psnr_db, 10 * std::log10(1000.0 / 3), 1e-9);
    EXPECT_EQ(p.worst_frame, 20U);
    EXPECT_NEAR(p.ssim, 0.9, 1e-12);
    EXPECT_NEAR(p.flip, 0.2, 1e-12);
    for (ReportSnapshot& snapshot : snapshots) snapshot.mse = 0;
    EXPECT_EQ(compare_pictures(snapshots).psnr_db, max_psnr_db) << "equal pictures, no infinity in JSON";
    WalkSummary s;
    s.picture = p;
    const auto json = nlohmann::json::parse(to_json(s));
    EXPECT_EQ(keys_of(json["picture"]),
              (std::set<std::string>{"frames", "psnr_db", "worst_psnr_db", "worst_frame", "ssim", "flip", "popping"}));
    EXPECT_TRUE(json["picture"]["popping"].is_null()) << "no frame before was kept";
    EXPECT_NE(to_table(s, false).find("PSNR 30.0 dB (worst 25.2, frame 20)"), std::string::npos) << to_table(s, false);
}

TEST(Pictures, PoppingIsOfThoseWithTheFrameBefore) {
    std::vector<ReportSnapshot> snapshots(3);
    for (ReportSnapshot& snapshot : snapshots) snapshot.walk = {0, 0, 0, 255};
    snapshots[1].pops_compared = snapshots[2].pops_compared = true;
    snapshots[1].popped_share = 0.0004;
    snapshots[2].pop_mse = 130.05;  // 65025 / (130.05 / 2) = 1000
    const PictureSummary p = compare_pictures(snapshots);
    EXPECT_EQ(p.pop_frames, 2U);
    EXPECT_DOUBLE_EQ(p.popped_share, 0.0002);
    EXPECT_DOUBLE_EQ(p.worst_popped_share, 0.0004);
    EXPECT_NEAR(p.pop_psnr_db, 30, 1e-9);
    WalkSummary s;
    s.picture = p;
    const auto popping = nlohmann::json::parse(to_json(s))["picture"]["popping"];
    EXPECT_EQ(keys_of(popping), (std::set<std::string>{"frames", "pixels", "worst_pixels", "psnr_db"}));
    EXPECT_DOUBLE_EQ(popping["pixels"].get<double>(), 0.0002) << "not rounded away";
}

TEST(Summary, FloorFramesAreCountedAnew) {
    std::vector<rt::FrameRecord> frames = good_frames(3);
    frames[1].floor_frame = true;
    WalkSummary s;
    summarize(frames, period_ns, s);
    summarize(frames, period_ns, s);
    EXPECT_EQ(s.floor_frames, 1U);
    EXPECT_NE(to_table(s, false).find("shown without need in 1"), std::string::npos) << to_table(s, false);
}

TEST(Verdict, MissesOfTheHostAreNotTheWalksOwn) {
    WalkSummary s;
    summarize(good_frames(1800), period_ns, s);
    EXPECT_EQ(verdict_of(s), Verdict::good);
    EXPECT_EQ(headline(s), "1800 frames, 0 missed: the slowest took 20.0 of 33.3 ms.");
    s.misses = 3;
    EXPECT_EQ(verdict_of(s), Verdict::warn);
    EXPECT_NE(headline(s).find("none of them by its own doing"), std::string::npos);
    s.own_misses = 2;
    EXPECT_EQ(verdict_of(s), Verdict::warn);
    s.own_misses = 3;
    EXPECT_EQ(verdict_of(s), Verdict::bad);
    s.own_misses = 0;
    s.control.ran = true;
    s.control.verdict.own_holds = true;
    s.control.verdict.control_holds = false;
    EXPECT_EQ(verdict_of(s), Verdict::bad);
}

/// Columns on screen, without colour codes.
std::size_t columns_of(const std::string& line) {
    std::size_t columns = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '\x1b') {
            i = line.find('m', i);
            continue;
        }
        columns += (static_cast<unsigned char>(line[i]) & 0xc0U) != 0x80U ? 1 : 0;
    }
    return columns;
}

TEST(Table, KeepsWithinAHundredColumnsAndColoursOnlyOnRequest) {
    WalkSummary s;
    summarize(frames_with_a_miss(), period_ns, s);
    s.model = "/a/very/long/path/" + std::string(150, 'm') + "/forest.walk";
    s.renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
    s.degraded = {{rt::LackKind::fifo, "FIFO refused",
                   std::string("grant it: ") + std::string(120, 'x') + " and then log in again, once more and again"}};
    s.census_problems = {std::string(40, 'a') + " " + std::string(70, 'b')};
    EXPECT_EQ(to_table(s, false).find('\x1b'), std::string::npos);
    const std::string table = to_table(s, true);
    EXPECT_NE(table.find('\x1b'), std::string::npos);
    for (std::size_t at = 0; at < table.size();) {
        const auto end = table.find('\n', at);
        EXPECT_LE(columns_of(table.substr(at, end - at)), 100U) << table.substr(at, end - at);
        at = end + 1;
    }
    EXPECT_NE(table.find("forest.walk"), std::string::npos) << "the end of a long path must stay";
}

TEST(Input, IsNullForAPathAndAnObjectWithUnitsAndWordsForAVisitor) {
    WalkSummary s;
    summarize(frames_with_a_miss(), period_ns, s);
    EXPECT_TRUE(nlohmann::json::parse(to_json(s))["input"].is_null());
    EXPECT_EQ(to_table(s, false).find("\ninput"), std::string::npos);
    s.input.given = true;
    s.input.source = "pad.hid";
    s.input.devices = {{"session \"pad\"", "navigation", "default: gamepad"}};
    s.input.reports = 1234;
    s.input.illegal_encoder_steps = 3;
    s.input.age_ms = quantiles({10, 20, 30.25});
    const auto json = nlohmann::json::parse(to_json(s))["input"];
    EXPECT_EQ(json["devices"], 1);
    EXPECT_EQ(json["steered_by"][0]["mapping"], "default: gamepad");
    EXPECT_EQ(json["reports"], 1234);
    EXPECT_EQ(json["illegal_encoder_steps"], 3);
    EXPECT_EQ(json["age_ms"]["p50"], 20);
    EXPECT_EQ(json["age_ms"]["max"], 30.25);
    EXPECT_EQ(json["stops"], 0);
    EXPECT_NE(input_words(s.input).find("30.2 at most"), std::string::npos) << input_words(s.input);
    EXPECT_EQ(input_words(s.input).find("stop"), std::string::npos);
    s.input.stops = 2;
    s.input.stopped_frames = 61;
    s.input.stop_latched = true;
    EXPECT_NE(input_words(s.input).find("2 emergency stops; the walk stood still for 61 frames, and until the end"),
              std::string::npos)
        << input_words(s.input);
}

TEST(Words, OfAnAccuracyAreAnAngle) {
    EXPECT_EQ(accuracy_words(57.29577951308232), "1°");
    EXPECT_EQ(accuracy_words(1e4), "0.34′");
    EXPECT_EQ(accuracy_words(0.1), "over 180°");
    EXPECT_EQ(accuracy_words(std::numeric_limits<double>::infinity()), "exact");
    EXPECT_EQ(accuracy_words(0), "unknown");
}

}  // namespace
}  // namespace surefoot::report
