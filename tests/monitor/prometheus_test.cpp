// The Prometheus page and the status page: strict form, base units, monotone counters, bounded labels, true figures.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "rt/base/file.hpp"
#include "rt/threads/capability.hpp"
#include "tests/monitor/exposition.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/monitor/page.hpp"

namespace surefoot::monitor {
namespace {

constexpr std::int64_t period_30_ns = 33'333'333;

rt::FrameRecord monitored_frame(std::uint64_t i, bool late) {
    rt::FrameRecord f;
    f.frame = f.slot = i;
    f.due_ns = 1'000'000'000 + static_cast<std::int64_t>(i) * period_30_ns;
    f.deadline_ns = f.due_ns + period_30_ns;
    f.woken_ns = f.due_ns + 50'000;
    f.selected_ns = f.woken_ns + 400'000;
    f.submitted_ns = f.selected_ns + 6'000'000;
    f.rastered_ns = f.submitted_ns + (late ? 30'000'000 : 12'000'000);
    f.complete_ns = f.rastered_ns + 100'000;
    f.show_ns = f.handed_ns = f.deadline_ns + (late ? period_30_ns : 0);
    f.presented_ns = f.shown_ns = f.handed_ns + 40'000;
    f.shown_by = rt::ShownBy::hand_over;
    f.cpu_ns = 5'000'000;
    f.raster_cpu_ns = 20'000'000;
    f.missed = late;
    f.own_miss = late;
    f.cause = late ? rt::Cause::raster : rt::Cause::none;
    f.budget_us = 26'000;
    f.actual_us = 18'000;
    f.accuracy = 250;
    f.prepare_cpu_us = 3000;
    f.switches = 4;
    f.slices = 6;
    f.downgraded_slices = late ? 2 : 0;
    return f;
}

class MonitorPages : public ::testing::Test {
protected:
    MonitorPages() {
        telemetry_->begin({period_30_ns, rt::LatePolicy::lock, 2});
        page_.figures = &telemetry_->figures();
        page_.version = "1.2.3";
        page_.state = ServicePhase::walking;
        page_.walk.model = "town.walk";
        page_.walk.setup = telemetry_->figures().setup;
        page_.process = rt::read_process();
    }
    void run(int frames, int every_late) {
        for (int i = 0; i < frames; ++i) telemetry_->add(monitored_frame(next_++, every_late > 0 && i % every_late == 0));
    }
    test::Exposed scrape() {
        test::Exposed e = test::ExpositionReader::read(prometheus_text(page_));
        for (const std::string& problem : e.problems) ADD_FAILURE() << problem;
        return e;
    }
    std::unique_ptr<rt::Telemetry> telemetry_ = std::make_unique<rt::Telemetry>();
    MonitorPage page_;
    std::uint64_t next_ = 0;
};

TEST(Exposition, TheReaderIsStrict) {
    const auto bad = [](const std::string& text) { return !test::ExpositionReader::read(text).problems.empty(); };
    const std::string head = "# HELP x_total Some words here.\n# TYPE x_total counter\n";
    EXPECT_FALSE(bad(head + "x_total 1\n"));
    EXPECT_TRUE(bad(head + "x_total 1"));
    EXPECT_TRUE(bad(head + "x_total -1\n"));
    EXPECT_TRUE(bad(head + "x_total one\n"));
    EXPECT_TRUE(bad(head + "x_total 1\nx_total 1\n"));
    EXPECT_TRUE(bad(head + "y_total 1\n"));
    EXPECT_TRUE(bad(head));
    EXPECT_TRUE(bad("x_total 1\n"));
    EXPECT_TRUE(bad("# HELP x Some words here.\n# TYPE x counter\nx 1\n")) << "a counter without _total";
    EXPECT_TRUE(bad("# HELP x_total Some words here.\n# TYPE x_total gauge\nx_total 1\n"));
    EXPECT_TRUE(bad(head + "x_total{a=\"b} 1\n"));
    EXPECT_TRUE(bad(head + "x_total{1a=\"b\"} 1\n"));
    const std::string h = "# HELP h Some words here.\n# TYPE h histogram\n";
    EXPECT_FALSE(bad(h + "h_bucket{le=\"1\"} 1\nh_bucket{le=\"+Inf\"} 2\nh_sum 3\nh_count 2\n"));
    EXPECT_TRUE(bad(h + "h_bucket{le=\"1\"} 3\nh_bucket{le=\"+Inf\"} 2\nh_sum 3\nh_count 2\n")) << "not cumulative";
    EXPECT_TRUE(bad(h + "h_bucket{le=\"1\"} 1\nh_sum 3\nh_count 1\n")) << "no +Inf";
    EXPECT_TRUE(bad(h + "h_bucket{le=\"1\"} 1\nh_bucket{le=\"+Inf\"} 2\nh_sum 3\nh_count 1\n"));
    EXPECT_TRUE(bad(h + "h_bucket{le=\"2\"} 1\nh_bucket{le=\"1\"} 1\nh_bucket{le=\"+Inf\"} 2\nh_sum 3\nh_count 2\n"));
}

TEST_F(MonitorPages, AreStrictBeforeTheFirstFrameAndAfter) {
    scrape();
    run(300, 50);
    scrape();
    page_.walk.renderer = "llvmpipe (\"LLVM\" 15\\0)\nsecond line";
    page_.input.live = true;
    page_.input.devices = 2;
    const auto e = scrape();
    EXPECT_EQ(e.at("surefoot_input_devices"), 2);
}

// What Prometheus' own linter says of the page.
TEST_F(MonitorPages, PleasePromtool) {
    if (std::system("command -v promtool >/dev/null 2>&1") != 0)  // NOLINT(concurrency-mt-unsafe,cert-env33-c): one thread
        GTEST_SKIP() << "promtool is not installed (package prometheus)";
    const test::TemporaryFolder folder;
    run(300, 50);
    page_.input.live = true;
    page_.input.devices = 2;
    page_.last_frame_age_s = 0.01;
    ASSERT_TRUE(write_text(folder / "page", prometheus_text(page_)).ok());
    const std::string command = "promtool check metrics < " + (folder / "page") + " > " + (folder / "said") + " 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0);  // NOLINT(concurrency-mt-unsafe,cert-env33-c)
    EXPECT_EQ(*read_text(folder / "said"), "");
}

TEST_F(MonitorPages, NamesHaveBaseUnits) {
    run(10, 0);
    const std::set<std::string> without_unit = {
        "surefoot_state",          "surefoot_degraded",      "surefoot_standing_still",
        "surefoot_emergency_stop", "surefoot_input_devices", "process_open_fds",
        "process_max_fds",         "process_threads",        "surefoot_monitor_open_readers"};
    page_.input.live = true;
    for (const auto& [name, family] : scrape().families) {
        bool unit = without_unit.contains(name);
        for (const char* ending : {"_total", "_seconds", "_bytes", "_ratio", "_info", "_hertz", "_per_radian", "_frames"})
            unit = unit || name.ends_with(ending);
        EXPECT_TRUE(unit) << name;
        for (const char* scaled : {"_ms_", "_us_", "_ns_", "_milli", "_micro", "_kb_", "_mb_"})
            EXPECT_EQ((name + "_").find(scaled), std::string::npos) << name;
        EXPECT_TRUE(name.starts_with("surefoot_") || name.starts_with("process_")) << name;
        EXPECT_TRUE(family.help.ends_with(".") || family.help.ends_with("done.")) << name << ": HELP is a sentence";
    }
}

TEST_F(MonitorPages, CountersNeverGoBackAndNoSeriesVanishes) {
    run(1, 0);
    auto before = scrape();
    std::mt19937 random(7);
    for (int i = 0; i < 20; ++i) {
        run(static_cast<int>(random() % 40), static_cast<int>(random() % 5));
        auto after = scrape();
        test::expect_monotone(before, after);
        before = std::move(after);
    }
}

TEST_F(MonitorPages, ReportWhatHappened) {
    run(100, 10);
    const auto e = scrape();
    EXPECT_EQ(e.at("surefoot_frames_total"), 100);
    EXPECT_EQ(e.at("surefoot_misses_total{cause=\"raster\"}"), 10);
    EXPECT_EQ(e.at("surefoot_misses_total{cause=\"stolen\"}"), 0);
    EXPECT_EQ(e.at("surefoot_own_misses_total"), 10);
    EXPECT_EQ(e.at("surefoot_downgraded_slices_total"), 20);
    EXPECT_EQ(e.at("surefoot_switches_total"), 400);
    // On the edge itself, in full: T/4, T/2, T, 2T, of frames of 18.55 and 36.55 ms.
    EXPECT_EQ(e.at("surefoot_frame_seconds_bucket{le=\"0.008333333\"}"), 0);
    EXPECT_EQ(e.at("surefoot_frame_seconds_bucket{le=\"0.016666666\"}"), 0);
    EXPECT_EQ(e.at("surefoot_frame_seconds_bucket{le=\"0.033333333\"}"), 90);
    EXPECT_EQ(e.at("surefoot_frame_seconds_bucket{le=\"0.066666666\"}"), 100);
    EXPECT_EQ(e.at("surefoot_frame_seconds_bucket{le=\"0.02\"}"), 90) << "between 20 ms and the period there is more to see:";
    EXPECT_EQ(e.at("surefoot_frame_seconds_bucket{le=\"0.024999999\"}"), 90);
    EXPECT_EQ(e.at("surefoot_frame_seconds_bucket{le=\"0.041666665\"}"), 100);
    EXPECT_EQ(e.at("surefoot_frame_seconds_count"), 100);
    EXPECT_EQ(e.at("surefoot_frame_time_quantile_seconds_count"), 100);
    EXPECT_EQ(e.at("surefoot_frame_time_quantile_seconds_sum"), e.at("surefoot_frame_seconds_sum"));
    EXPECT_NEAR(e.at("surefoot_frame_seconds_sum"), 90 * 0.01855 + 10 * 0.03655, 1e-9);
    EXPECT_EQ(e.at("surefoot_phase_seconds_bucket{phase=\"wake\",le=\"0.00005\"}"), 100);
    EXPECT_EQ(e.at("surefoot_slack_seconds_count") + e.at("surefoot_lateness_seconds_count"), 100);
    EXPECT_EQ(e.at("surefoot_shown_frames_total{by=\"hand-over\"}"), 100);
    EXPECT_EQ(e.at("surefoot_shown_frames_total{by=\"display\"}"), 0);
    EXPECT_EQ(e.at("surefoot_shown_error_seconds_bucket{le=\"0.00002\"}"), 0);
    EXPECT_EQ(e.at("surefoot_shown_error_seconds_bucket{le=\"0.00005\"}"), 100) << "40 us after its point of the grid";
    EXPECT_EQ(e.at("surefoot_phase_seconds_bucket{phase=\"present\",le=\"0.00005\"}"), 100) << "what presenting took";
    EXPECT_NEAR(e.at("surefoot_budget_used_ratio"), (5e6 + 20e6 / 2) / period_30_ns, 1e-6);
    EXPECT_NEAR(e.at("surefoot_budget_seconds"), 0.026, 1e-9);
    EXPECT_EQ(e.at("surefoot_accuracy_per_radian"), 250);
    EXPECT_NEAR(e.at("surefoot_frame_time_quantile_seconds{quantile=\"1\"}"), 0.03655, 1e-12);
    EXPECT_EQ(e.at("surefoot_state{state=\"walking\"}"), 1);
    EXPECT_EQ(e.at("surefoot_state{state=\"failed\"}"), 0);
    EXPECT_GT(e.at("process_resident_memory_bytes"), 1e6);
    EXPECT_NE(e.families.at("surefoot_one_percent_low_hertz").help.find("1 / "), std::string::npos) << "its formula";
    EXPECT_NE(e.families.at("surefoot_animation_error_seconds").help.find("due[n]"), std::string::npos) << "its formula";
}

TEST_F(MonitorPages, PicturesOfTheCacheAreCounted) {
    run(2, 0);
    EXPECT_EQ(scrape().at("surefoot_pictures_made_total"), 0);
    for (int i = 0; i < 3; ++i) {
        auto f = monitored_frame(next_++, false);
        f.pictures = 40;
        f.pictures_made = 2;
        f.captures_us = 1500;
        f.uncovered_items = 1;
        f.picture_bytes = 65536;
        telemetry_->add(f);
    }
    const auto e = scrape();
    EXPECT_EQ(e.at("surefoot_pictures_shown_total"), 120);
    EXPECT_EQ(e.at("surefoot_pictures_made_total"), 6);
    EXPECT_NEAR(e.at("surefoot_picture_captures_seconds_total"), 0.0045, 1e-9);
    EXPECT_EQ(e.at("surefoot_uncovered_items_total"), 3);
    EXPECT_EQ(e.at("surefoot_picture_memory_bytes"), 65536);
}

TEST_F(MonitorPages, ExactPicturesHaveNoErrorAndUnknownIsNotZero) {
    auto f = monitored_frame(next_++, false);
    f.accuracy = std::numeric_limits<float>::infinity();
    telemetry_->add(f);
    EXPECT_TRUE(std::isinf(scrape().at("surefoot_accuracy_per_radian")));
    EXPECT_FALSE(scrape().samples.contains("surefoot_last_frame_age_seconds"));
    page_.process = rt::ProcessFigures();
    const auto e = scrape();
    EXPECT_FALSE(e.samples.contains("process_resident_memory_bytes"));
    EXPECT_FALSE(e.samples.contains("surefoot_host_steal_seconds_total"));
    const auto j = nlohmann::json::parse(status_json(page_));
    EXPECT_TRUE(j["now"]["accuracy"].is_null());
    EXPECT_TRUE(j["now"]["exact"].get<bool>());
    EXPECT_TRUE(j["process"]["rss_bytes"].is_null());
}

TEST_F(MonitorPages, MissesByTheStealOfCoresAreCountedWhereTheKernelSaysIt) {
    run(20, 5);
    EXPECT_FALSE(scrape().samples.contains("surefoot_core_steal_misses_total"));
    EXPECT_TRUE(nlohmann::json::parse(status_json(page_))["totals"]["core_steal_misses"].is_null());
    rt::FrameRecord f = monitored_frame(next_++, true);
    f.core_steal_ns = 10'000'000;
    f.by_core_steal = true;
    telemetry_->add(f);
    EXPECT_EQ(scrape().at("surefoot_core_steal_misses_total"), 1);
    EXPECT_EQ(nlohmann::json::parse(status_json(page_))["totals"]["core_steal_misses"], 1);
}

TEST_F(MonitorPages, LabelsAreBoundedWhateverTheMachineLacks) {
    rt::Capabilities c;  // as little as there can be
    c.rt_runtime_us = 100'000;
    std::set<std::string_view> named;
    for (const rt::Lack& lack : rt::find_lacking(c, 80)) {
        page_.degraded.push_back(lack);
        EXPECT_NE(lack.kind, rt::LackKind::other) << lack.what;
        named.insert(degraded_reason(lack.kind));
    }
    EXPECT_EQ(named.size(), 4U) << "FIFO, memory, core, throttling: each has its own word";
    // These words are the contract, and no rewording of a sentence changes them.
    for (const auto& [kind, reason] : {std::pair{rt::LackKind::fifo, "fifo"},
                                       {rt::LackKind::memory_lock, "memory_lock"},
                                       {rt::LackKind::isolated_core, "isolated_core"},
                                       {rt::LackKind::throttled, "throttled"},
                                       {rt::LackKind::placing, "placing"},
                                       {rt::LackKind::cost_table, "cost_table"},
                                       {rt::LackKind::switched_off, "switched_off"},
                                       {rt::LackKind::census, "census"},
                                       {rt::LackKind::sanitizer, "sanitizer"},
                                       {rt::LackKind::other, "other"}})
        EXPECT_EQ(degraded_reason(kind), reason);
    for (int i = 0; i < 100; ++i)
        page_.degraded.push_back({rt::LackKind::other, "trouble with the lock, core and census number " + std::to_string(i), ""});
    const auto e = scrape();
    EXPECT_EQ(e.values_of.at("surefoot_degraded/reason").size(), degraded_reasons().size());
    EXPECT_EQ(e.at("surefoot_degraded{reason=\"fifo\"}"), 1);
    EXPECT_EQ(e.at("surefoot_degraded{reason=\"census\"}"), 0);
    for (const auto& [label, values] : e.values_of) EXPECT_LE(values.size(), rt::Edges::max_edges + 1) << label;
}

TEST_F(MonitorPages, TheStatusPageIsOneLineOfJsonThatAgreesWithTheMetrics) {
    run(500, 20);
    const std::string text = status_json(page_);
    EXPECT_EQ(text.find('\n'), text.size() - 1);
    const auto j = nlohmann::json::parse(text);
    const auto e = scrape();
    EXPECT_EQ(j["totals"]["frames"].get<double>(), e.at("surefoot_frames_total"));
    EXPECT_EQ(j["totals"]["misses"].get<int>(), 25);
    EXPECT_EQ(j["totals"]["miss_causes"]["raster"].get<int>(), 25);
    EXPECT_NEAR(j["times"]["frame_ms"]["max"].get<double>(), 36.55, 1e-9);
    EXPECT_EQ(j["recent"]["frames"].get<int>(), 301) << "ten seconds at 30 Hz";
    EXPECT_NEAR(j["recent"]["slack_ms"]["min"].get<double>(), 33.333333 - 36.55, 1e-3);
    EXPECT_EQ(j["recent"]["frame_ms_skipped_missed"].size(), 301U);
    EXPECT_EQ(j["version"], "1.2.3");
    EXPECT_EQ(j["times"]["shown_by"], "hand-over");
    EXPECT_NEAR(j["times"]["shown_error_us"]["max"].get<double>(), 40, 1e-9);
}

TEST_F(MonitorPages, WhereNothingIsShownNothingIsSaidOfIt) {
    for (int i = 0; i < 10; ++i) {
        auto f = monitored_frame(next_++, false);
        f.shown_by = rt::ShownBy::nothing;
        telemetry_->add(f);
    }
    const auto j = nlohmann::json::parse(status_json(page_));
    EXPECT_TRUE(j["times"]["shown_by"].is_null());
    EXPECT_TRUE(j["times"]["one_percent_low_hz"].is_null());
    for (const char* name : {"shown_interval_ms", "shown_error_us", "animation_error_ms"})
        EXPECT_TRUE(j["times"][name].is_null()) << name << ": " << j["times"][name];
}

}  // namespace
}  // namespace surefoot::monitor
