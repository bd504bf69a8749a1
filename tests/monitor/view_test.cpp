// The pages for people: they fit the screen, keep their colours to themselves, and show slots as they were.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/monitor/page.hpp"
#include "tools/monitor/text.hpp"
#include "tools/monitor/view.hpp"

namespace surefoot::monitor {
namespace {

using nlohmann::json;

/// A walk at 50 Hz; every 40th frame is late and skips a slot.
json viewed_status(int frames, const std::string& model = "/srv/models/town.walk", bool cache = false) {
    const auto telemetry = std::make_unique<rt::Telemetry>();
    telemetry->begin({20'000'000, rt::LatePolicy::lock, 2});
    std::uint64_t slot = 0;
    bool was_late = false;
    for (int i = 0; i < frames; ++i) {
        rt::FrameRecord f;
        f.frame = static_cast<std::uint64_t>(i);
        f.slot = slot += was_late ? 2 : 1;
        f.skipped_before = was_late ? 1 : 0;
        f.due_ns = 1'000'000'000 + static_cast<std::int64_t>(slot) * 20'000'000;
        f.deadline_ns = f.due_ns + 20'000'000;
        was_late = f.missed = i % 40 == 39;
        f.cause = f.missed ? rt::Cause::stolen : rt::Cause::none;
        f.woken_ns = f.selected_ns = f.submitted_ns = f.due_ns + 100'000;
        f.rastered_ns = f.complete_ns = f.due_ns + (f.missed ? 25'000'000 : 10'000'000);
        f.show_ns = f.handed_ns = f.presented_ns = f.shown_ns = f.deadline_ns + (f.missed ? 20'000'000 : 0);
        f.shown_by = rt::ShownBy::hand_over;
        f.accuracy = 100;
        if (cache) {
            f.pictures = 1200;
            f.pictures_made = 3;
            f.pictures_reused = 1198;
            f.boxes_as_triangles = 17;
            f.picture_bytes = 28U << 20U;
            f.captures_us = 2200;
            f.uncovered_items = i % 5 == 0 ? 2 : 0;
        }
        telemetry->add(f);
    }
    MonitorPage page;
    page.figures = &telemetry->figures();
    page.version = "1.2.3";
    page.state = ServicePhase::walking;
    page.walk.model = model;
    page.walk.rate_hz = 50;
    page.walk.cache = cache;
    page.walk.setup = telemetry->figures().setup;
    page.degraded = {{rt::LackKind::fifo, "SCHED_FIFO is refused", "grant CAP_SYS_NICE"}};
    page.threads = rt::read_busy_threads();
    return json::parse(status_json(page));
}

std::string joined(const std::vector<std::string>& lines) {
    std::string all;
    for (const std::string& line : lines) all += line + "\n";
    return all;
}

TerminalStyle a_style(std::size_t width, std::size_t height, bool colour = false, bool unicode = false) {
    return {colour, unicode, width, height};
}

TEST(View, StatusIsAPageThatNamesWhatMatters) {
    const auto lines = status_page(viewed_status(400), {});
    const std::string all = joined(lines);
    for (const char* text : {"surefoot 1.2.3", "town.walk", "50 Hz", "SCHED_FIFO is refused", "-> grant CAP_SYS_NICE",
                             "10 misses", "stolen 10", "p99.9", "9 skipped", "1 % low"})
        EXPECT_NE(all.find(text), std::string::npos) << text << " is not in\n" << all;
    EXPECT_LE(lines.size(), 40U) << "a page of a screen";
    EXPECT_EQ(all.find('\033'), std::string::npos) << "colour where none is wanted";
    EXPECT_NE(status_page(viewed_status(400), a_style(80, 24, true))[0].find("\033["), std::string::npos);
}

TEST(View, AFailedCheckIsNamedWithItsPlaceAndCount) {
    json status = viewed_status(400);
    EXPECT_EQ(joined(status_page(status, {})).find("check failed"), std::string::npos) << "none has";
    status["rare_checks"] = {{{"place", "render/engine.cpp:171"}, {"sentence", "there is room"}, {"count", 12}}};
    EXPECT_NE(joined(status_page(status, {})).find("a check failed 12 times: there is room (render/engine.cpp:171)"),
              std::string::npos)
        << joined(status_page(status, {}));
}

TEST(View, BeforeTheFirstFrameThereIsAPageToo) {
    for (const json& status : {viewed_status(0), viewed_status(0, ""), viewed_status(1)}) {
        EXPECT_GT(status_page(status, {}).size(), 3U);
        EXPECT_GT(top_page(status, json(), 0, {}).size(), 3U);
        EXPECT_FALSE(top_line(status, json(), 0).empty());
    }
}

TEST(View, TopFitsAnyWindow) {
    const json before = viewed_status(300), now = viewed_status(350);
    for (const std::size_t width : {1U, 20U, 40U, 80U, 200U})
        for (const std::size_t height : {3U, 10U, 24U, 60U})
            for (const bool colour : {false, true}) {
                const auto lines = top_page(now, before, 1, a_style(width, height, colour, true));
                EXPECT_LE(lines.size(), height);
                for (const std::string& line : lines) EXPECT_LE(places(line), width) << line;
            }
}

TEST(View, TopShowsRatesSlotsAndCauses) {
    const json before = viewed_status(300), now = viewed_status(350);
    const std::string all = joined(top_page(now, before, 1, a_style(100, 30)));
    EXPECT_NE(all.find("50 frames/s"), std::string::npos) << all;
    EXPECT_NE(all.find("stolen 8"), std::string::npos) << all;
    EXPECT_NE(all.find("least -5.00 ms"), std::string::npos) << all;
    EXPECT_NE(all.find("not fully real-time: fifo"), std::string::npos) << all;
    EXPECT_EQ(all.find('\xe2'), std::string::npos) << "plain characters where the terminal knows no others";
    // A service that was started anew has no rates against the old one.
    EXPECT_NE(top_line(before, now, 1).find("walking - frames/s"), std::string::npos) << top_line(before, now, 1);
}

TEST(View, TopNamesThePartsOfTheLightThatTheFrameHadNoTimeFor) {
    json now = viewed_status(350);
    EXPECT_TRUE(now["now"]["dropped_parts"].is_array() && now["now"]["dropped_parts"].empty());
    EXPECT_EQ(joined(top_page(now, now, 1, a_style(100, 30))).find("no time for"), std::string::npos);
    now["now"]["dropped_parts"] = {"shadows", "lamps"};
    EXPECT_NE(joined(top_page(now, now, 1, a_style(100, 40))).find("no time for shadows, lamps"), std::string::npos);
}

TEST(View, TopShowsThePicturesOfAWalkThatHasACache) {
    const std::string town = "/srv/models/town.walk";
    const json before = viewed_status(300, town, true), now = viewed_status(350, town, true);
    EXPECT_EQ(now["now"]["pictures"]["shown"], 1200);
    EXPECT_EQ(now["totals"]["pictures_made"], 3 * 350);
    const std::string all = joined(top_page(now, before, 1, a_style(100, 30)));
    EXPECT_NE(all.find("pictures 1 200 shown, 1 198 of them reused; 17 boxes as triangles; 28 MiB"), std::string::npos) << all;
    EXPECT_NE(all.find("a second: 150 made, in 2.20 ms a frame; 20 items in place"), std::string::npos) << all;
    const std::string first = joined(top_page(now, json(), 0, a_style(100, 30)));
    EXPECT_NE(first.find("a second: - made, in - ms a frame"), std::string::npos) << "no rate without an earlier page\n" << first;
    const json without = viewed_status(350);
    EXPECT_TRUE(without["now"]["pictures"].is_null());
    EXPECT_EQ(joined(top_page(without, without, 1, a_style(100, 30))).find("pictures"), std::string::npos);
    EXPECT_GT(top_page(viewed_status(0, town, true), json(), 0, {}).size(), 3U) << "before the first frame";
}

TEST(View, ASkippedSlotIsAColumnOfItsOwn) {
    const json frames = json::parse("[[5.0, 0, false], [25.0, 0, true], [10.0, 2, false]]");
    const auto chart = frame_chart(frames, 20, {}, 6, 5);
    ASSERT_EQ(chart.size(), 5U);
    EXPECT_EQ(chart[4], " ##xx#");
    EXPECT_EQ(chart[3], "  #  #") << "half of the period is two rows";
    EXPECT_EQ(chart[2], "  #   ");
    EXPECT_EQ(chart[0], "  #   ") << "over the deadline is over the fourth row";
    EXPECT_EQ(frame_chart(frames, 20, {}, 2, 5)[4], "x#") << "the newest are at the right";
    EXPECT_EQ(frame_chart(json("nonsense"), 20, {}, 3, 2)[0], "   ");
}

TEST(View, NumbersForPeople) {
    EXPECT_EQ(grouped(1234567), "1 234 567");
    EXPECT_EQ(grouped(-1234), "-1 234");
    EXPECT_EQ(grouped(std::nan("")), "-");
    EXPECT_EQ(duration(90061), "1 d 1:01:01");
}

TEST(View, SomethingElseIsNotTakenForAStatus) {
    const Address address = *parse_address("127.0.0.1:9464");
    for (const char* text : {"", "{}", "[1,2]", "<html>", "{\"version\":1}"})
        EXPECT_FALSE(parse_status(address, text).ok()) << text;
    EXPECT_TRUE(parse_status(address, viewed_status(3).dump()).ok());
}

}  // namespace
}  // namespace surefoot::monitor
