// Light of a walk: sunlight as a setting, switches by a device, and an hour that runs, with the same cuts.
#include <gtest/gtest.h>

#include <memory>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/walk/steered_fixture.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/report/report.hpp"

namespace surefoot {
namespace {

TEST(SunWalk, WithoutItNoFrameHasItAndPicturesAreComparedWithoutIt) {
    walk::WalkRequest request = test::Forest::get().virtual_request(12);
    request.backend = "egl";
    request.width = 160;
    request.height = 90;
    request.pictures = 3;
    model::CostModel costs = model::default_costs();
    costs.prices = {{model::effect_sun, 0, 0, 0}};  // what it saves would buy other forms
    request.given_costs = std::make_shared<const model::CostModel>(costs);
    const walk::WalkOutcome with = test::walk(request);
    request.sunlight = false;
    const walk::WalkOutcome without = test::walk(request);
    ASSERT_EQ(with.records.size(), without.records.size());
    for (std::size_t i = 0; i < with.records.size(); ++i) {
        EXPECT_TRUE(with.records[i].light.on.sunlight);
        EXPECT_FALSE(without.records[i].light.on.sunlight);
        EXPECT_EQ(with.records[i].cut_hash, without.records[i].cut_hash) << "light changes no choice";
        EXPECT_EQ(without.records[i].guard_violations, 0U);
    }
    EXPECT_GT(without.summary.picture.psnr_db, 15) << "full detail is drawn without it too";
    EXPECT_NE(with.summary.picture.psnr_db, without.summary.picture.psnr_db);
}

/// Buttons 1 to 4 of the pad switch the light.
std::string switching_pad() {
    std::string text = "[[device]]\nname = \"switches\"\n";
    for (std::size_t i = 0; i < rt::switch_count; ++i)
        text += "[[device.button]]\ncontrol = \"button-" + std::to_string(i + 1) + "\"\naction = \"" +
                std::string(rt::light_switches[i].name) + "\"\n";
    return text;
}

TEST(SunWalk, ADeviceSwitchesEachPartOfTheLightByItself) {
    test::GamepadSession session;
    session.report({});
    for (unsigned i = 0; i < rt::switch_count; ++i) session.hold({}, 0.2).press(1U << i);  // 0.4 s each
    session.hold({}, 0.2).press(4);
    walk::WalkRequest request = test::steered_request(session, "switches");
    request.steering_file = test::Forest::get().dir + "/switches.toml";
    ASSERT_TRUE(write_text(request.steering_file, switching_pad()).ok());
    request.fog = false;
    const walk::WalkOutcome outcome = test::walk(request);
    EXPECT_EQ(test::at(outcome, 0.15).light.on, (rt::Switches{true, true, true, false}));
    EXPECT_EQ(test::at(outcome, 0.55).light.on, (rt::Switches{false, true, true, false}));
    EXPECT_EQ(test::at(outcome, 0.95).light.on, (rt::Switches{false, false, true, false}));
    EXPECT_EQ(test::at(outcome, 1.35).light.on, (rt::Switches{false, false, false, false}));
    EXPECT_EQ(test::at(outcome, 1.75).light.on, (rt::Switches{false, false, false, true})) << "it was off at first";
    EXPECT_EQ(outcome.records.back().light.on, (rt::Switches{false, false, true, true})) << "and on again";
    for (std::size_t i = 0; i < rt::switch_count; ++i) {  // pressed at 0.2 s, and every 0.4 s from then on
        const rt::FrameRecord& second_frame = test::at(outcome, 0.2 + 0.4 * static_cast<double>(i) + 2.0 / 30);
        EXPECT_EQ(second_frame.light.on.*rt::light_switches[i].on, rt::light_switches[i].name == "fog") << i;
    }
    EXPECT_EQ(outcome.summary.misses, 0U);
    const auto json = nlohmann::json::parse(report::to_json(outcome.summary));
    for (const auto& [key, presses] :
         {std::pair{"sunlight_presses", 1}, {"shadows_presses", 1}, {"lamps_presses", 2}, {"fog_presses", 1}})
        EXPECT_EQ(json["input"][key], presses) << key;
    for (const rt::FrameRecord& r : outcome.records) EXPECT_EQ(r.guard_violations, 0U);
    EXPECT_EQ(outcome.summary.input.guard_violations, 0U);
}

TEST(SunWalk, AnHourThatRunsChangesPicturesAndNoCut) {
    walk::WalkRequest request = test::Forest::get().virtual_request(12);
    request.backend = "egl";
    request.width = 160;
    request.height = 90;
    request.pictures = 3;
    const walk::WalkOutcome own = test::walk(request);
    request.hour = 12;
    request.hour_speed = 600;  // ten hours a second
    const walk::WalkOutcome running = test::walk(request);
    ASSERT_EQ(own.records.size(), running.records.size());
    std::set<float> hours;
    for (std::size_t i = 0; i < running.records.size(); ++i) {
        const rt::FrameRecord& r = running.records[i];
        EXPECT_FALSE(rt::has_hour(own.records[i].light));
        EXPECT_NEAR(r.light.hour, 12 + 10 * static_cast<double>(r.slot) / 30, 0.5 / 30 + 1e-5);
        hours.insert(r.light.hour);
        EXPECT_EQ(r.cut_hash, own.records[i].cut_hash) << "light changes no choice";
        EXPECT_EQ(r.guard_violations, 0U);
    }
    EXPECT_EQ(hours.size(), running.records.size());
    EXPECT_GT(running.summary.picture.psnr_db, 15) << "full detail is drawn in the frame's light";
    EXPECT_NE(own.summary.picture.psnr_db, running.summary.picture.psnr_db);
}

TEST(SunWalk, AnHourThatRunsNeedsNoMemoryOnTheRealClock) {
    walk::WalkRequest request = test::Forest::get().virtual_request(60);
    request.clock = rt::ClockKind::real;
    request.fifo = false;
    request.rate_hz = 60;
    request.hour = 23;
    request.hour_speed = 120;
    const walk::WalkOutcome outcome = test::walk(request);
    std::set<float> hours;
    for (const rt::FrameRecord& r : outcome.records) {
        EXPECT_EQ(r.guard_violations, 0U);
        hours.insert(r.light.hour);
    }
    EXPECT_GT(2 * hours.size(), outcome.records.size()) << "an hour a frame, but for those that were skipped";
    EXPECT_LT(outcome.records.back().light.hour, 12) << "past midnight";
}

}  // namespace
}  // namespace surefoot
