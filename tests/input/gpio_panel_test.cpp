// Wired controls: debounce, lost edges, encoders, stops by broken wires and vanished chips. As logic, without lines.
#include "input/gpio/panel.hpp"

#include <gtest/gtest.h>

#include "rt/base/random.hpp"
#include "tests/input/fake_lines.hpp"
#include "tests/time_units.hpp"

namespace surefoot::input {
namespace {

using test::FakeChip;

TEST(Contact, AssertsAtOnceAndReleasesAfterItsSettleTime) {
    Random random(1);
    for (int round = 0; round < 500; ++round) {
        Contact c;
        std::int64_t now = round * 1000 * ms;
        edge(c, true, now, 10 * ms);
        ASSERT_TRUE(c.asserted);
        bool level = true;
        for (int i = 0, edges = 2 * static_cast<int>(random.below(11)); i < edges; ++i) {  // bounces of 0.2 to 5 ms
            now += 200'000 + random.below(4'800'000);
            release_when_due(c, 10 * ms, now);
            edge(c, level = !level, now, 10 * ms);
            ASSERT_TRUE(c.asserted);
        }
        ASSERT_EQ(c.presses, 1U) << "bounces are no presses";
        edge(c, false, now += 5 * ms, 10 * ms);
        release_when_due(c, 10 * ms, now + 10 * ms - 1);
        ASSERT_TRUE(c.asserted);
        release_when_due(c, 10 * ms, now + 10 * ms);
        ASSERT_FALSE(c.asserted);
    }
}

TEST(Contact, LostEdgesAreFoundByReadingAgainAndCounted) {
    Contact c;
    reread(c, true, 5 * ms, 10 * ms);
    EXPECT_TRUE(c.asserted);
    EXPECT_EQ(c.lost_edges, 1U);
    edge(c, true, 6 * ms, 10 * ms);
    EXPECT_EQ(c.lost_edges, 2U);
    EXPECT_EQ(c.raw_releases, 1U) << "the lost one was a release";
    reread(c, true, 7 * ms, 10 * ms);
    EXPECT_EQ(c.lost_edges, 2U);
}

TEST(Quadrature, AMillionStepsWithBounceDoNotDrift) {
    constexpr std::array<std::uint8_t, 4> gray = {0, 1, 3, 2};
    Random random(4);
    Quadrature q;
    q.turn(false, false);
    std::int64_t truth = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        truth += random.below(100) < 55 ? 1 : -1;
        const std::uint8_t state = gray[static_cast<std::size_t>(truth & 3)], before = q.state;
        if (random.below(100) < 5)  // the line that changes bounces
            for (std::uint32_t k = 0; k < 1 + random.below(10); ++k) {
                q.turn((state & 2) != 0, (state & 1) != 0);
                q.turn((before & 2) != 0, (before & 1) != 0);
            }
        q.turn((state & 2) != 0, (state & 1) != 0);
        ASSERT_EQ(q.steps, truth);
    }
    EXPECT_EQ(q.illegal, 0U);
}

TEST(Quadrature, IllegalTransitionsAreCountedNotGuessed) {
    Quadrature q;
    q.turn(true, true);
    EXPECT_EQ(q.illegal, 0U) << "the first levels are no step";
    EXPECT_EQ(q.turn(false, false), 0);
    EXPECT_EQ(q.turn(true, true), 0);
    EXPECT_EQ(q.illegal, 2U);
    EXPECT_EQ(q.steps, 0);
    EXPECT_EQ(q.turn(true, true), 0);
    EXPECT_EQ(q.illegal, 2U);
    EXPECT_EQ(q.turn(true, false), 1) << "11 to 10 counts up";
}

LineConfig line(const std::string& name, LineRole role) {
    LineConfig c;
    c.name = name;
    c.role = role;
    c.request.chip = "gpiochip0";
    c.request.line = role == LineRole::encoder_b ? name + "-b" : name;
    return c;
}

std::vector<LineConfig> all_lines() {
    return {line("stop", LineRole::stop),      line("hand", LineRole::dead_man),  line("next", LineRole::button),
            line("knob", LineRole::encoder_a), line("knob", LineRole::encoder_b), line("reset", LineRole::stop_reset)};
}
enum : std::uint32_t { stop_line, hand_line, next_line, a_line, b_line, reset_line };

struct Rig {
    FakeChip chip;
    GpioPanel panel{all_lines(), test::open_fake, &chip};
    std::int64_t now = 0;
    Rig() {
        chip.level[stop_line] = true;  // closed
        serve();
    }
    Lines serve(std::int64_t passed = ms) {
        panel.service(now += passed);
        return panel.take_lines();
    }
};

TEST(Panel, ConfigurationsAreCheckedWithTheLinesName) {
    EXPECT_TRUE(check_lines(all_lines()).ok());
    const auto problem = [](auto&& change) {
        auto lines = all_lines();
        change(lines);
        const auto checked = check_lines(lines);
        return checked.ok() ? std::string() : checked.error().text();
    };
    EXPECT_NE(problem([](auto& l) { l.erase(l.begin() + 4); }).find("'knob'"), std::string::npos);
    EXPECT_NE(problem([](auto& l) { l[4].request.chip = "gpiochip1"; }).find("partner"), std::string::npos) << "one request";
    EXPECT_NE(problem([](auto& l) { l[2].name = "stop"; }).find("twice"), std::string::npos);
    EXPECT_NE(problem([](auto& l) { l[2].request.line = "stop"; }).find("Another entry uses the same line"), std::string::npos);
    EXPECT_NE(problem([](auto& l) { l[2].name = ""; }), "");
}

TEST(Panel, AStopIsAssertedByEveryOpeningHoweverShort) {
    Rig rig;
    rig.serve();
    EXPECT_FALSE(rig.serve().stop);
    rig.chip.set(stop_line, false, rig.now + 100);  // 10 us
    rig.chip.set(stop_line, true, rig.now + 10'100);
    EXPECT_TRUE(rig.serve().stop);
    EXPECT_TRUE(rig.serve().stop) << "until it settled";
    EXPECT_FALSE(rig.serve(20 * ms).stop);
    rig.chip.level[stop_line] = false;  // a broken wire whose edge was lost
    EXPECT_TRUE(rig.serve().stop);
    EXPECT_EQ(rig.panel.lost_edges(), 1U);
}

TEST(Panel, AVanishedChipIsAStopAndComesBackByRetry) {
    Rig rig;
    rig.serve();
    rig.chip.set(hand_line, true, rig.now);
    EXPECT_TRUE(rig.serve().has_dead_man);
    EXPECT_TRUE(rig.serve().dead_man);
    rig.chip.gone = true;
    Lines lines = rig.serve();
    EXPECT_TRUE(lines.stop);
    EXPECT_TRUE(lines.has_dead_man);
    EXPECT_FALSE(lines.dead_man);
    EXPECT_FALSE(rig.panel.state().connected);
    EXPECT_NE(rig.panel.problem().find("gone"), std::string::npos);
    const int tried = rig.chip.tried;
    for (int i = 0; i < 10'000; ++i) EXPECT_TRUE(rig.serve().stop);
    EXPECT_LE(rig.chip.tried - tried, 10) << "no busy loop";
    EXPECT_GE(rig.chip.tried - tried, 5) << "never gives up";
    rig.chip.gone = false;
    rig.serve(2100 * ms);
    EXPECT_TRUE(rig.panel.open());
    EXPECT_FALSE(rig.serve().stop);
    EXPECT_TRUE(rig.panel.problem().empty());
    EXPECT_EQ(rig.panel.opens(), 2U);
}

TEST(Panel, ABusyLineNamesItsUserAndIsTriedAgain) {
    FakeChip chip;
    chip.busy_by = "gpiomon";
    GpioPanel panel(all_lines(), test::open_fake, &chip);
    panel.service(0);
    EXPECT_NE(panel.problem().find("'gpiomon'"), std::string::npos);
    EXPECT_TRUE(panel.take_lines().stop) << "a stop that cannot be read is asserted";
    chip.busy_by.clear();
    chip.level[stop_line] = true;
    panel.service(150 * ms);
    EXPECT_TRUE(panel.open());
}

TEST(Panel, TheDeadManIsReleasedByASingleEdgeBetweenTwoTicks) {
    Rig rig;
    rig.chip.set(hand_line, true, rig.now);
    rig.serve();
    EXPECT_TRUE(rig.serve().dead_man);
    rig.chip.set(hand_line, false, rig.now + 10);
    rig.chip.set(hand_line, true, rig.now + 20);
    EXPECT_FALSE(rig.serve().dead_man);
    EXPECT_TRUE(rig.serve().dead_man) << "safety/ debounces the new press";
}

TEST(Panel, BurstsEndAtTheLineLevelWithTheLossCounted) {
    for (const bool version1 : {true, false}) {
        Random random(12);
        for (int round = 0; round < 200; ++round) {
            Rig rig;
            rig.chip.queue_limit = version1 ? 16 : 64;
            rig.chip.drops_newest = version1;
            rig.serve();
            const int edges = 1 + static_cast<int>(random.below(2000));  // 10 kHz
            for (int i = 0; i < edges; ++i) {
                rig.now += 100'000;
                rig.chip.set(next_line, !rig.chip.level[next_line], rig.now);
            }
            rig.serve(0);
            rig.serve(10 * ms);
            const bool lost = edges > static_cast<int>(rig.chip.queue_limit);
            EXPECT_EQ(rig.panel.state().value[0] != 0, rig.chip.level[next_line]);
            // Version 1 drops the newest unnumbered: an even loss leaves no trace but the level, which is right.
            EXPECT_TRUE((version1 && edges % 2 == 0) || (rig.panel.lost_edges() > 0) == lost) << edges;
        }
    }
}

TEST(Panel, NumberedEdgesCountExactlyHowManyWereLost) {
    Rig rig;
    rig.chip.set(next_line, true, 1);
    rig.serve();
    rig.chip.queue_limit = 64;
    for (int i = 0; i < 1000; ++i) rig.chip.set(next_line, i % 2 == 1, rig.now += 1000);
    rig.serve();
    EXPECT_EQ(rig.panel.lost_edges(), 1000U - 64U);
    // A loss on the stop's line may have been a stop.
    rig.serve(50 * ms);
    EXPECT_FALSE(rig.serve().stop);
    rig.chip.set(stop_line, false, rig.now);
    rig.chip.set(stop_line, true, rig.now + 1);
    rig.serve();
    rig.serve(50 * ms);
    rig.serve();
    for (int i = 0; i < 2; ++i) rig.chip.set(stop_line, i % 2 == 1, rig.now + i);
    for (int i = 0; i < 64; ++i) rig.chip.set(next_line, i % 2 == 0, rig.now + 10 + i);
    EXPECT_TRUE(rig.serve().stop || rig.panel.lost_edges() == 936);
}

TEST(Panel, EncodersTurnAsRelativeControlsAndButtonsAsButtons) {
    Rig rig;
    ASSERT_EQ(rig.panel.controls().size(), 2U);
    EXPECT_EQ(rig.panel.controls()[0].name, "next");
    EXPECT_EQ(rig.panel.controls()[1].name, "knob");
    EXPECT_TRUE(rig.panel.controls()[1].relative);
    std::int64_t sum = 0;
    constexpr std::array<std::uint8_t, 4> gray = {0, 1, 3, 2};
    for (int i = 1; i <= 4000; ++i) {
        const std::uint8_t s = gray[static_cast<std::size_t>(i & 3)];
        rig.chip.set(a_line, (s & 2) != 0, rig.now + i);
        rig.chip.set(b_line, (s & 1) != 0, rig.now + i);
        if (i % 7 != 0) continue;
        const auto reports = rig.panel.state().reports;
        rig.serve();
        if (rig.panel.state().reports != reports) sum += rig.panel.state().value[1];
    }
    rig.serve();
    sum += rig.panel.state().value[1];
    EXPECT_EQ(sum, 4000);
    EXPECT_EQ(rig.panel.illegal_encoder_steps(), 0U);
    rig.chip.set(next_line, true, rig.now);
    rig.serve();
    EXPECT_EQ(rig.panel.state().value[0], 1);
}

TEST(Panel, AnEncoderWhoseTwoLinesChangeUnseenTurnsByNothingAndIsCounted) {
    Rig rig;
    rig.chip.level[a_line] = rig.chip.level[b_line] = true;  // no edge of either came
    rig.serve();
    EXPECT_EQ(rig.panel.state().value[1], 0) << "up or down by two: nobody knows";
    EXPECT_EQ(rig.panel.illegal_encoder_steps(), 1U);
    rig.chip.level[b_line] = false;
    rig.serve();
    EXPECT_EQ(rig.panel.state().value[1], 1) << "11 to 10 counts up";
    EXPECT_EQ(rig.panel.illegal_encoder_steps(), 1U);
}

TEST(Panel, TheBackEndNamesItselfAndRefusesWhatIsNotThere) {
    const std::string back_end = gpio_back_end();
    EXPECT_FALSE(back_end.empty());
    std::printf("GPIO back end: %s\n", back_end.c_str());
    const std::vector<LineRequest> requests = {{"no-such-chip", "ESTOP", false, Bias::as_is}};
    const auto opened = open_lines(requests, "surefoot", nullptr);
    ASSERT_FALSE(opened.ok());
    EXPECT_NE(opened.error().text().find("no-such-chip"), std::string::npos) << opened.error().text();
}

}  // namespace
}  // namespace surefoot::input
