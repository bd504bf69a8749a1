// A window's events, without a window: keys, repeats, focus, dragging, a captured pointer, and what is ordered of the window.
#include "input/window/window_reports.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "input/window/window_device.hpp"
#include "input/window/window_feed.hpp"
#include "input/window/window_keys.hpp"

namespace surefoot::input {
namespace {

using Kind = WindowEvent::Kind;
using Command = WindowCommand;

constexpr std::uint32_t symbol_up = 0xff52, symbol_shift = 0xffe1;

WindowEvent key(Kind kind, std::uint32_t code, std::uint32_t symbol) {
    WindowEvent e;
    e.kind = kind;
    e.code = code;
    e.symbol = symbol;
    return e;
}
WindowEvent at(Kind kind, std::int32_t x, std::int32_t y, std::uint32_t button = 0) {
    WindowEvent e;
    e.kind = kind;
    e.x = x;
    e.y = y;
    e.x_screen = x + 30;  // the window's place
    e.y_screen = y + 20;
    e.code = button;
    return e;
}
WindowEvent plain(Kind kind) { return at(kind, 0, 0); }

std::uint64_t bit_of(std::uint32_t symbol) { return std::uint64_t{1} << static_cast<unsigned>(window_key_of(symbol)); }

struct Window {
    WindowReports reports{800, 600};
    std::int64_t dx = 0, dy = 0;
    Command take(const WindowEvent& event) {
        const auto step = reports.take(event);
        if (step.reports) dx += reports.report().dx, dy += reports.report().dy;
        return step.command;
    }
    Command press(std::uint32_t code, std::uint32_t symbol) { return take(key(Kind::key_down, code, symbol)); }
    Command lift(std::uint32_t code, std::uint32_t symbol) { return take(key(Kind::key_up, code, symbol)); }
    [[nodiscard]] std::uint64_t keys() const { return reports.report().keys; }
};

TEST(WindowKeys, AreThoseOfAHidKeyboard) {
    const auto usage = [](std::uint32_t symbol) { return window_keys()[static_cast<std::size_t>(window_key_of(symbol))].usage; };
    EXPECT_EQ(usage('w'), 0x1a);
    EXPECT_EQ(usage('a'), 0x04);
    EXPECT_EQ(usage('0'), 0x27);
    EXPECT_EQ(usage(symbol_up), 0x52);
    EXPECT_EQ(usage(symbol_shift), 0xe1);
    EXPECT_EQ(window_key_of(symbol_escape), -1);
    EXPECT_EQ(window_key_of(symbol_f11), -1);
    EXPECT_EQ(window_key_of(0x20ac), -1);
    const auto controls = window_controls();
    ASSERT_EQ(controls.size(), window_keys().size() + 2);
    for (std::size_t i = 0; i < controls.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            EXPECT_NE(controls[i].name, controls[k].name);
            EXPECT_FALSE(controls[i].usage == controls[k].usage && controls[i].usage_page == controls[k].usage_page) << i;
        }
}

TEST(WindowReports, AKeyCountsFromPressToReleaseHoweverOftenItRepeats) {
    Window w;
    EXPECT_TRUE(w.reports.take(key(Kind::key_down, 25, 'w')).reports);
    EXPECT_EQ(w.keys(), bit_of('w'));
    for (int i = 0; i < 5; ++i) EXPECT_FALSE(w.reports.take(key(Kind::key_down, 25, 'w')).reports) << "a repeat is no press";
    w.press(111, symbol_up);
    EXPECT_EQ(w.keys(), bit_of('w') | bit_of(symbol_up));
    w.lift(25, 'w');
    EXPECT_EQ(w.keys(), bit_of(symbol_up));
    w.lift(111, symbol_up);
    EXPECT_EQ(w.keys(), 0U);
}

TEST(WindowReports, AKeyThatIsReleasedUnderAnotherLayoutIsReleased) {
    Window w;
    w.press(25, 'w');
    w.lift(25, 'z');
    EXPECT_EQ(w.keys(), 0U);
}

TEST(WindowReports, LosingTheFocusReleasesAllKeysAndTheDrag) {
    Window w;
    w.take(plain(Kind::focus_in));
    w.press(25, 'w');
    w.take(at(Kind::button_down, 100, 100, 1));
    EXPECT_TRUE(w.reports.take(plain(Kind::focus_out)).reports);
    EXPECT_EQ(w.keys(), 0U);
    w.take(at(Kind::motion, 300, 100));
    EXPECT_EQ(w.dx, 0);
    EXPECT_FALSE(w.reports.take(key(Kind::key_up, 25, 'w')).reports) << "a late release changes nothing";
    EXPECT_EQ(w.keys(), 0U);
}

TEST(WindowReports, AKeyThatWasHeldWhenTheFocusCameCountsOnceItWasUp) {
    Window w;
    w.take(plain(Kind::focus_in));
    WindowEvent before = plain(Kind::held_keys);
    before.held[25 / 8] = 1U << (25 % 8);
    w.take(before);
    w.press(25, 'w');  // it repeats
    EXPECT_EQ(w.keys(), 0U);
    w.lift(25, 'w');
    w.press(25, 'w');
    EXPECT_EQ(w.keys(), bit_of('w'));
}

WindowEvent held(std::initializer_list<std::uint32_t> codes) {
    WindowEvent e = plain(Kind::held_keys);
    for (const std::uint32_t code : codes) e.held[code / 8] = static_cast<std::uint8_t>(e.held[code / 8] | 1U << (code % 8));
    return e;
}

TEST(WindowReports, AKeyThatWentUpUnseenIsReleased) {
    Window w;
    w.press(25, 'w');
    w.press(40, 'd');
    EXPECT_TRUE(w.reports.take(held({40})).reports);
    EXPECT_EQ(w.keys(), bit_of('d'));
    EXPECT_FALSE(w.reports.take(held({40})).reports) << "nothing is new";
    w.lift(40, 'd');
    EXPECT_EQ(w.keys(), 0U);
}

TEST(WindowReports, WhatWasHeldOnceSwallowsNoLaterPress) {
    Window w;
    w.take(held({9, 25}));  // the pointer came, and left: without the focus no release is seen
    w.take(held({}));
    EXPECT_EQ(w.press(9, symbol_escape), Command::leave);
    w.lift(9, symbol_escape);
    w.take(held({9}));
    w.take(plain(Kind::focus_in));
    EXPECT_EQ(w.press(9, symbol_escape), Command::leave);
    w.lift(9, symbol_escape);
    w.take(held({9}));
    w.take(plain(Kind::focus_out));
    EXPECT_EQ(w.press(9, symbol_escape), Command::leave);
}

TEST(WindowReports, AStopThatIsHeldWhenTheFocusComesStops) {
    WindowReports reports(800, 600, bit_of(' '));
    reports.take(plain(Kind::focus_in));
    reports.take(held({25, 65}));
    EXPECT_FALSE(reports.take(key(Kind::key_down, 25, 'w')).reports);
    EXPECT_TRUE(reports.take(key(Kind::key_down, 65, ' ')).reports) << "it repeats";
    EXPECT_EQ(reports.report().keys, bit_of(' '));
    EXPECT_TRUE(reports.take(key(Kind::key_up, 65, ' ')).reports);
    EXPECT_EQ(reports.report().keys, 0U);
}

TEST(WindowReports, WhereTheKeyboardFollowsThePointerItsLeavingReleasesTheKeys) {
    Window w;
    w.press(25, 'w');
    w.take(plain(Kind::pointer_out));
    EXPECT_EQ(w.keys(), 0U);
    w.take(plain(Kind::focus_in));
    w.press(25, 'w');
    w.take(plain(Kind::pointer_out));
    EXPECT_EQ(w.keys(), bit_of('w')) << "the keyboard stays";
}

TEST(WindowReports, OnlyADragTurns) {
    Window w;
    w.take(at(Kind::motion, 50, 50));
    EXPECT_EQ(w.dx, 0);
    w.take(at(Kind::button_down, 200, 200, 1));
    w.take(at(Kind::motion, 230, 190));
    w.take(at(Kind::motion, 260, 190));
    EXPECT_EQ(w.dx, 60);
    EXPECT_EQ(w.dy, -10);
    w.take(at(Kind::button_up, 260, 190, 1));
    w.take(at(Kind::motion, 500, 500));
    EXPECT_EQ(w.dx, 60);
}

TEST(WindowReports, ACapturedPointerTurnsWithoutEnd) {
    Window w;
    EXPECT_EQ(w.take(at(Kind::button_down, 700, 100, 3)), Command::capture);
    w.take(at(Kind::motion, 400, 300));  // the window put it there
    EXPECT_EQ(w.dx, 0);
    // Ten times to the right, each time put back in the middle: the way there does not count.
    std::int32_t x = 400;
    for (int i = 0; i < 100; ++i) {
        x += 30;
        if (w.take(at(Kind::motion, x, 300)) != Command::centre) continue;
        x += 30;
        EXPECT_EQ(w.take(at(Kind::motion, x, 300)), Command::none) << "on its way it moves on";
        w.take(at(Kind::motion, 400, 300));
        x = 400;
        ++i;
    }
    EXPECT_EQ(w.dx, 3000);
    EXPECT_EQ(w.dy, 0);
    EXPECT_EQ(w.take(at(Kind::button_down, 400, 300, 3)), Command::release);
    w.take(at(Kind::motion, 10, 10));
    EXPECT_EQ(w.dx, 3000);
}

TEST(WindowReports, AWindowThatIsMovedOrResizedTurnsNothing) {
    Window w;
    w.take(at(Kind::button_down, 200, 200, 1));
    WindowEvent moved = at(Kind::motion, 120, 160);  // by 80 and 40: the pointer stays on the screen
    moved.x_screen += 80;
    moved.y_screen += 40;
    w.take(moved);
    EXPECT_EQ(w.dx, 0);
    EXPECT_EQ(w.dy, 0);
    moved.x += 5;
    moved.x_screen += 5;
    w.take(moved);
    EXPECT_EQ(w.dx, 5);
}

TEST(WindowReports, TheWayToAMiddleOfAnEarlierSizeTurnsNothing) {
    Window w;
    w.take(at(Kind::button_down, 700, 100, 3));
    w.take(at(Kind::resized, 1600, 1200));
    w.take(at(Kind::motion, 400, 300));  // ordered before
    EXPECT_EQ(w.dx, 0);
    EXPECT_EQ(w.take(at(Kind::motion, 401, 300)), Command::none) << "a quarter of the new width is not passed";
    EXPECT_EQ(w.take(at(Kind::motion, 390, 290)), Command::centre);
    w.take(at(Kind::motion, 800, 600));
    EXPECT_EQ(w.dx, -10);
}

TEST(WindowReports, CentringThatNeverComesIsOrderedAgain) {
    Window w;
    w.take(at(Kind::button_down, 400, 300, 3));  // it is in the middle already: no event comes
    int ordered = 0;
    for (int i = 1; i <= 300; ++i) ordered += w.take(at(Kind::motion, 400 + i, 300)) == Command::centre ? 1 : 0;
    EXPECT_GE(ordered, 1);
    EXPECT_LE(ordered, 3);
    EXPECT_EQ(w.dx, 300);
    w.take(at(Kind::resized, 600, 600));
    EXPECT_EQ(w.take(at(Kind::motion, 590, 300)), Command::centre) << "a new size needs no waiting";
}

TEST(WindowReports, EscapeReleasesTheCapturedPointerFirstAndItsRepeatsDoNotLeave) {
    Window w;
    w.take(at(Kind::button_down, 10, 10, 3));
    EXPECT_EQ(w.press(9, symbol_escape), Command::release);
    EXPECT_EQ(w.press(9, symbol_escape), Command::none) << "held";
    EXPECT_EQ(w.lift(9, symbol_escape), Command::none);
    EXPECT_EQ(w.press(9, symbol_escape), Command::leave);
}

TEST(WindowReports, AFocusThatGoesFreesThePointer) {
    Window w;
    w.take(at(Kind::button_down, 10, 10, 3));
    EXPECT_EQ(w.take(plain(Kind::focus_out)), Command::release);
    EXPECT_FALSE(w.reports.captured());
}

TEST(WindowReports, ClosingLeavesAndF11FillsTheScreenOnceAPress) {
    Window w;
    EXPECT_EQ(w.press(95, symbol_f11), Command::fullscreen);
    EXPECT_EQ(w.press(95, symbol_f11), Command::none);
    w.lift(95, symbol_f11);
    EXPECT_EQ(w.press(95, symbol_f11), Command::fullscreen);
    w.take(at(Kind::button_down, 10, 10, 3));
    EXPECT_EQ(w.take(plain(Kind::close)), Command::leave) << "even with a captured pointer";
}

TEST(WindowFeed, SumsUpWhatFindsNoRoomAndLosesNoRelease) {
    WindowFeed feed;
    WindowReport report;
    report.keys = 1;
    report.dx = 1;
    for (int i = 0; i < 5000; ++i) feed.push(report);
    report.keys = 0;
    report.dx = 0;
    feed.push(report);
    EXPECT_FALSE(feed.flush());
    std::int64_t dx = 0;
    WindowReport last;
    for (WindowReport taken; feed.take(taken); last = taken) dx += taken.dx;
    EXPECT_TRUE(feed.flush());
    for (WindowReport taken; feed.take(taken); last = taken) dx += taken.dx;
    EXPECT_EQ(dx, 5000);
    EXPECT_EQ(last.keys, 0U);
}

TEST(WindowFeed, ATapWithinTheOverflowIsPressedAndReleased) {
    WindowFeed feed;
    WindowReport report;
    report.dx = 1;
    while (feed.flush()) feed.push(report);  // the last one finds no room
    report.dx = 0;
    for (const std::uint64_t keys : {4U, 0U, 8U, 9U, 1U}) {
        report.keys = keys;
        ++report.stamp_ns;
        feed.push(report);
    }
    WindowReport taken;
    ASSERT_TRUE(feed.take(taken));
    EXPECT_FALSE(feed.flush()) << "there is room for one of two";
    while (feed.take(taken) && taken.keys == 0) {
    }
    EXPECT_EQ(taken.keys, 4U | 8U | 1U) << "all that were pressed meanwhile";
    EXPECT_EQ(taken.dx, 1);
    EXPECT_TRUE(feed.flush());
    ASSERT_TRUE(feed.take(taken));
    EXPECT_EQ(taken.keys, 1U) << "then those that are still down";
    EXPECT_EQ(taken.dx, 0);
    EXPECT_EQ(taken.stamp_ns, 5);
    EXPECT_FALSE(feed.take(taken));
}

}  // namespace
}  // namespace surefoot::input
