// A walk in a window on a real X server (Xvfb), with a visitor who presses real keys: they lead the eye off the path, show in
// pictures, are released with the focus, and end the walk. Skipped with the reason where there is no such server.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "rt/clock/clock.hpp"
#include "rt/threads/guard.hpp"
#include "tests/gl/x_server.hpp"
#include "tests/walk/steered_fixture.hpp"
#include "tools/walk/tour_controller.hpp"
#include "tools/walk/window_thread.hpp"

namespace surefoot {
namespace {

using test::wait_ms;

constexpr unsigned long symbol_escape = 0xff1b, symbol_f11 = 0xffc8;

/// What the visitor did, and when.
struct Times {
    std::int64_t pressed_ns = 0, lifted_ns = 0, dragged_ns = 0, turned_ns = 0, lost_ns = 0, rested_ns = 0, left_ns = 0;
};

/// Records of frames that were due from one time until another.
std::vector<rt::FrameRecord> between(const walk::WalkOutcome& outcome, std::int64_t from_ns, std::int64_t until_ns) {
    std::vector<rt::FrameRecord> out;
    for (const rt::FrameRecord& r : outcome.records)
        if (r.due_ns >= from_ns && r.due_ns < until_ns) out.push_back(r);
    return out;
}

double walked_m(const std::vector<rt::FrameRecord>& frames) {
    return frames.empty() ? 0 : glm::length(test::eye(frames.back()) - test::eye(frames.front()));
}

double turned_rad(const rt::FrameRecord& a, const rt::FrameRecord& b) {
    return 2 * std::acos(std::min(1.0, std::abs(glm::dot(test::orientation(a), test::orientation(b)))));
}

std::size_t different(const test::ScreenPicture& a, const test::ScreenPicture& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i) count += a.pixels[i] == b.pixels[i] ? 0 : 1;
    return count;
}

struct Pictures {
    test::ScreenPicture before, after, filled;
};

double black_share(const test::ScreenPicture& picture) {
    double black = 0;
    for (const test::ScreenPixel& p : picture.pixels) black += p == test::ScreenPixel{} ? 1 : 0;
    return black / static_cast<double>(std::max<std::size_t>(1, picture.pixels.size()));
}

/// The frames of a walk so far, as sf-monitor hands them on: twice a second.
class FramesSoFar {
public:
    using Frames = std::vector<rt::FrameRecord>;
    void add(const rt::FrameRecord& record) {
        const std::scoped_lock lock(mutex_);
        records_.push_back(record);
        changed_.notify_all();
    }
    /// Until the frames that were due from `from_ns` on are as wanted; false: they are not within 20 seconds.
    bool wait(std::int64_t from_ns, const std::function<bool(const Frames&)>& wanted) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(20), [&] {
            Frames frames;
            for (const rt::FrameRecord& r : records_)
                if (r.due_ns >= from_ns) frames.push_back(r);
            return !frames.empty() && wanted(frames);
        });
    }
    bool wait_for_frames(std::size_t count) {
        return wait(0, [&](const Frames& frames) { return frames.size() >= count; });
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    Frames records_;
};

/// Frames of so long have come, and the last tenth of a second stood still.
bool rests(const std::vector<rt::FrameRecord>& frames, std::int64_t for_ns) {
    if (frames.size() < 6 || frames.back().due_ns - frames.front().due_ns < for_ns) return false;
    return walked_m({frames.end() - 6, frames.end()}) < 1e-4;
}

/// Presses W until it has walked, drags by 100 pixels, loses the focus with D held, fills the screen, and leaves.
void steer(test::XVisitor& visitor, FramesSoFar& frames, Times& times, Pictures& pictures) {
    using Frames = FramesSoFar::Frames;
    const rt::RealClock clock;
    const auto window = visitor.find_window();
    visitor.move_to(60, 60);
    EXPECT_TRUE(frames.wait(0, [](const Frames& f) { return f.size() > 2 && walked_m(f) > 0.02; })) << "on the path";
    pictures.before = visitor.look_at_screen();
    times.pressed_ns = clock.now_ns();
    visitor.key('w', true);
    EXPECT_TRUE(frames.wait(times.pressed_ns + 50'000'000, [](const Frames& f) { return walked_m(f) > 0.2; })) << "W walks";
    visitor.key('w', false);
    times.lifted_ns = clock.now_ns();
    EXPECT_TRUE(frames.wait(times.lifted_ns, [](const Frames& f) { return rests(f, 350'000'000); })) << "after W";
    pictures.after = visitor.look_at_screen();
    times.dragged_ns = clock.now_ns();
    visitor.button(1, true);
    for (int x = 60; x <= 160; x += 20) {
        visitor.move_to(x, 60);
        wait_ms(10);  // the pace of a hand
    }
    visitor.button(1, false);
    EXPECT_TRUE(frames.wait(times.dragged_ns, [](const Frames& f) { return turned_rad(f.front(), f.back()) > 0.26; }))
        << "15 degrees";
    visitor.key('d', true);
    EXPECT_TRUE(frames.wait(times.dragged_ns, [](const Frames& f) { return walked_m(f) > 0.05; })) << "D walks";
    times.turned_ns = clock.now_ns();
    visitor.take_focus();
    times.lost_ns = clock.now_ns();
    EXPECT_TRUE(frames.wait(times.lost_ns, [](const Frames& f) { return rests(f, 400'000'000); })) << "without the focus";
    times.rested_ns = clock.now_ns();
    visitor.key('d', false);
    visitor.give_focus(window);
    visitor.tap(symbol_f11);
    for (int i = 0; i < 500 && (i == 0 || black_share(pictures.filled) >= 0.01); ++i) {
        wait_ms(10);
        pictures.filled = visitor.look_at_screen();
    }
    visitor.button(3, true);
    visitor.button(3, false);
    visitor.tap(symbol_escape);  // releases the pointer
    const std::int64_t released_ns = clock.now_ns();
    EXPECT_TRUE(frames.wait(released_ns, [](const Frames& f) { return f.size() > 3; })) << "it walks on";
    times.left_ns = clock.now_ns();
    visitor.tap(symbol_escape);
}

/// Starts an X server, and lets a visitor come.
class WindowThread : public ::testing::Test {
protected:
    void SetUp() override {
        auto server = test::XServer::start("320x240x24");
        if (!server) GTEST_SKIP() << server.error().text();
        server_ = std::move(*server);
        auto visitor = test::XVisitor::come();
        if (visitor)
            visitor_ = std::move(*visitor);
        else
            no_visitor_ = visitor.error().text();
    }

    std::unique_ptr<test::XServer> server_;
    std::unique_ptr<test::XVisitor> visitor_;  ///< null: none could come, for the reason below
    std::string no_visitor_;
};

class WindowWalk : public WindowThread {
protected:
    void SetUp() override {
#ifdef SUREFOOT_WATCHES_THREADS
        GTEST_SKIP() << "drivers cannot be opened under the thread sanitizer";
#endif
        WindowThread::SetUp();
    }
};

TEST_F(WindowWalk, KeysAndMouseLeadOffThePathAndEscapeEndsTheWalk) {
    if (visitor_ == nullptr) GTEST_SKIP() << no_visitor_;
    walk::WalkRequest request = test::Forest::get().virtual_request(0);
    request.clock = rt::ClockKind::real;
    request.backend = walk::window_input;
    request.may_leave = request.may_steer = true;
    request.width = 200;
    request.height = 150;
    request.rate_hz = 60;
    request.walking = rt::WalkingMode::fly;
    request.rest_after_ms = 0;
    Times times;
    Pictures pictures;
    FramesSoFar frames;
    std::atomic<std::int64_t> first_ns{0};
    std::thread hand([&] {  // there before the walk, which counts the threads that are its own
        first_ns.wait(0);
        rt::RealClock clock;
        clock.sleep_until_ns(first_ns.load());
        if (first_ns.load() > 1) steer(*visitor_, frames, times, pictures);
    });
    walk::WalkObserver observer;
    observer.on_record = [&](const rt::FrameRecord& record) { frames.add(record); };
    observer.on_started = [&](const walk::WalkStart& start) {
        first_ns.store(start.t0_ns);
        first_ns.notify_one();
    };
    const auto outcome = walk::run_walk(request, {}, observer);
    if (first_ns.load() == 0) first_ns.store(1);  // it never began
    first_ns.notify_one();
    hand.join();
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    ASSERT_FALSE(outcome->records.empty());
    EXPECT_TRUE(outcome->left);
    EXPECT_FALSE(outcome->stopped);
    EXPECT_EQ(outcome->summary.frames, outcome->records.size()) << "the summary is of all frames";
    const std::int64_t last_ns = outcome->records.back().due_ns;
    EXPECT_GT(last_ns, times.left_ns - 100'000'000) << "the first Escape only releases the pointer";
    EXPECT_LT(last_ns, times.left_ns + 200'000'000);

    const auto on_path = between(*outcome, 0, times.pressed_ns);
    ASSERT_GT(on_path.size(), 2U);
    EXPECT_GT(walked_m(on_path), 0.01) << "the path is followed until a key steers";
    const auto pressed = between(*outcome, times.pressed_ns + 50'000'000, times.lifted_ns);
    EXPECT_GT(walked_m(pressed), 0.15) << "W walks";
    const auto lifted = between(*outcome, times.lifted_ns + 300'000'000, times.dragged_ns);
    EXPECT_LT(walked_m(lifted), 1e-3) << "and its release rests: the path has ended";
    EXPECT_GT(different(pictures.before, pictures.after), 100U) << "of 30000 pixels";
    const auto dragged = between(*outcome, times.dragged_ns, times.turned_ns);
    ASSERT_GT(dragged.size(), 10U);
    EXPECT_NEAR(turned_rad(dragged.front(), dragged.back()), 100 * request.pointer_turn_deg * 3.14159265 / 180, 2e-3);
    EXPECT_GT(walked_m(dragged), 0.02) << "D walks aside";
    const auto rested = between(*outcome, times.lost_ns + 300'000'000, times.rested_ns);
    ASSERT_GT(rested.size(), 2U);
    EXPECT_LT(walked_m(rested), 1e-3) << "nobody walks on with a key that is held elsewhere";
    EXPECT_LT(black_share(pictures.filled), 0.01) << "the window fills the screen, which has the picture's shape";

    const report::InputSummary& in = outcome->summary.input;
    ASSERT_EQ(in.devices.size(), 1U);
    EXPECT_EQ(in.devices[0].mapping, "default: keyboard and mouse");
    EXPECT_GE(in.reports, 8U);
    EXPECT_EQ(outcome->summary.guard_violations, 0U);
    EXPECT_EQ(in.guard_violations, 0U);
    EXPECT_TRUE(outcome->summary.census_problems.empty()) << outcome->summary.census_problems.front();
}

/// A walk of a second in a window, while `hand` acts on it from its first frame on.
Result<walk::WalkOutcome> walk_in_window(walk::WalkRequest request, const std::function<void(FramesSoFar&)>& hand) {
    request.clock = rt::ClockKind::real;
    request.backend = walk::window_input;
    request.width = 80;
    request.height = 60;
    request.rate_hz = 60;
    FramesSoFar frames;
    std::atomic<std::int64_t> first_ns{0};
    std::thread visitor([&] {
        first_ns.wait(0);
        rt::RealClock clock;
        clock.sleep_until_ns(first_ns.load());
        if (first_ns.load() > 1) hand(frames);
    });
    walk::WalkObserver observer;
    observer.on_record = [&](const rt::FrameRecord& record) { frames.add(record); };
    observer.on_started = [&](const walk::WalkStart& start) {
        first_ns.store(start.t0_ns);
        first_ns.notify_one();
    };
    auto outcome = walk::run_walk(request, {}, observer);
    if (first_ns.load() == 0) first_ns.store(1);  // it never began
    first_ns.notify_one();
    visitor.join();
    return outcome;
}

/// The forest's path, cut to a second.
std::shared_ptr<const Path> second_of_path() {
    auto path = read_path(test::Forest::get().path_file);
    EXPECT_TRUE(path.ok());
    Path cut;
    for (const PathSample& s : path->samples)
        if (s.time_s <= 1) cut.samples.push_back(s);
    return std::make_shared<const Path>(std::move(cut));
}

TEST_F(WindowWalk, LSwitchesTheSunOffAndOnWithinTwoFrames) {
    if (visitor_ == nullptr) GTEST_SKIP() << no_visitor_;
    walk::WalkRequest request = test::Forest::get().virtual_request(0);
    request.may_leave = request.may_steer = true;
    request.walking = rt::WalkingMode::fly;
    test::ScreenPicture sunny, dark, again;
    std::array<std::int64_t, 2> pressed_ns{};
    const rt::RealClock clock;
    const auto outcome = walk_in_window(request, [&](FramesSoFar& frames) {
        using Frames = FramesSoFar::Frames;
        const auto settled_picture = [&](bool sun, std::int64_t from_ns) {
            EXPECT_TRUE(frames.wait(from_ns, [&](const Frames& f) { return f.size() > 20 && f.back().light.on.sunlight == sun; }))
                << sun;
            return visitor_->look_at_screen();
        };
        visitor_->find_window();
        visitor_->tap('w');  // leaves the path, and stands still
        sunny = settled_picture(true, clock.now_ns());
        for (const bool sun : {false, true}) {
            pressed_ns[sun ? 1 : 0] = clock.now_ns();
            visitor_->tap('l');
            (sun ? again : dark) = settled_picture(sun, clock.now_ns());
        }
        visitor_->tap(symbol_escape);
    });
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    EXPECT_GT(different(sunny, dark), 500U) << "of 4800 pixels";
    EXPECT_GT(different(dark, again), 500U);
    EXPECT_EQ(outcome->summary.input.switches.sunlight, 2U);
    EXPECT_EQ(outcome->summary.guard_violations, 0U);
    for (std::size_t press = 0; press < 2; ++press) {
        const auto later = between(*outcome, pressed_ns[press], INT64_MAX);
        std::size_t until = 0;
        while (until < later.size() && later[until].light.on.sunlight != (press == 1)) ++until;
        ASSERT_LT(until, later.size());
        EXPECT_LE(until, 3U) << "two frames, and the one that was under way";
    }
}

TEST_F(WindowWalk, AnyKeyProlongsItAPauseToo) {
    if (visitor_ == nullptr) GTEST_SKIP() << no_visitor_;
    for (const unsigned long symbol : {0UL, 0x70UL, 0x78UL}) {  // none, P, and X, which has no action
        walk::WalkRequest request = test::Forest::get().virtual_request(0);
        request.given_path = second_of_path();
        request.may_leave = request.may_steer = true;
        const auto outcome = walk_in_window(request, [&](FramesSoFar& frames) {
            if (symbol == 0) return;
            visitor_->tap(symbol);
            (void)frames.wait_for_frames(75);  // its end passes
            visitor_->tap(symbol_escape);
        });
        ASSERT_TRUE(outcome.ok()) << outcome.error().text();
        EXPECT_EQ(outcome->left, symbol != 0) << symbol;
        if (symbol == 0) {
            EXPECT_EQ(outcome->records.size(), 60U);
            for (const rt::FrameRecord& r : outcome->records)
                EXPECT_LT(
                    glm::length(test::eye(r) - walk::pose_at(*request.given_path, static_cast<double>(r.slot) / 60.0).position),
                    1e-6)
                    << "frame " << r.frame << ": as on the path alone";
        } else
            EXPECT_GE(outcome->records.size(), 75U) << symbol;
    }
}

TEST_F(WindowWalk, KeysOfAWindowThatMayNotSteerDoNothing) {
    if (visitor_ == nullptr) GTEST_SKIP() << no_visitor_;
    walk::WalkRequest request = test::Forest::get().virtual_request(0);
    request.given_path = second_of_path();
    test::ScreenPicture screen;
    const auto outcome = walk_in_window(request, [&](FramesSoFar& frames) {
        visitor_->tap('w');
        visitor_->tap(symbol_f11);
        visitor_->tap(symbol_escape);
        visitor_->close(visitor_->find_window());
        EXPECT_TRUE(frames.wait_for_frames(20));
        screen = visitor_->look_at_screen();
    });
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    EXPECT_FALSE(outcome->left);
    EXPECT_FALSE(outcome->stopped);
    EXPECT_FALSE(outcome->summary.input.given) << "it follows its path, as without a window";
    EXPECT_EQ(outcome->records.size(), 60U);
    EXPECT_EQ(screen.at(200, 200), test::ScreenPixel{}) << "it keeps its size";
}

TEST_F(WindowWalk, ItsFramesAndItsInputNeedNoMemory) {
    if (!rt::guard_active()) GTEST_SKIP() << "allocations are not counted in this build";
    if (visitor_ == nullptr) GTEST_SKIP() << no_visitor_;
    walk::WalkRequest request = test::Forest::get().virtual_request(0);
    request.given_path = second_of_path();
    request.may_leave = request.may_steer = true;
    const auto outcome = walk_in_window(request, [&](FramesSoFar& frames) {
        visitor_->tap('w');
        visitor_->tap(symbol_f11);
        EXPECT_TRUE(frames.wait_for_frames(40));
        visitor_->tap(symbol_escape);
    });
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    EXPECT_GE(outcome->summary.input.reports, 2U);
    EXPECT_EQ(outcome->summary.guard_violations, 0U);
    EXPECT_EQ(outcome->summary.input.guard_violations, 0U);
}

TEST_F(WindowWalk, AProlongedWalkEndsWithAMessageWhenNoMoreIsKept) {
    walk::WalkRequest request = test::Forest::get().virtual_request(0);
    request.input_file = walk::window_input;
    request.may_leave = request.may_steer = true;
    request.given_path = second_of_path();
    request.max_kept_frames = 70;
    const auto outcome = walk_in_window(request, [](FramesSoFar&) {});
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    EXPECT_FALSE(outcome->left);
    EXPECT_FALSE(outcome->stopped);
    EXPECT_EQ(outcome->records.size(), 70U);
    ASSERT_FALSE(outcome->notes.empty());
    EXPECT_EQ(outcome->notes.back().find("The walk ended after 70 frames: no more are kept."), 0U) << outcome->notes.back();
}

TEST_F(WindowThread, WhatTheServerRefusesIsCountedAndNamed) {
    if (visitor_ == nullptr) GTEST_SKIP() << no_visitor_;
    auto window = gl::WindowEvents::open({64, 64}, "test", false);
    ASSERT_TRUE(window.ok()) << window.error().text();
    walk::WindowThread thread(*window, {}, {.policy = rt::Policy::other, .priority = 0, .cpus = {}, .name = "sf-window"});
    visitor_->give_focus((*window)->id() + 999);  // there is no such window
    thread.stop();
    EXPECT_EQ(thread.refused(), "The X server refused requests of the window: 1. The last: BadWindow (error 3) of request 42.");
}

TEST_F(WindowThread, ClosingTheWindowLeavesUnlessNobodyMay) {
    if (visitor_ == nullptr) GTEST_SKIP() << no_visitor_;
    for (const bool may_leave : {true, false}) {
        auto window = gl::WindowEvents::open({64, 64}, "test", false);
        ASSERT_TRUE(window.ok()) << window.error().text();
        walk::WindowThread thread(*window, {.feed = nullptr, .may_leave = may_leave, .stop_keys = 0},
                                  {.policy = rt::Policy::other, .priority = 0, .cpus = {}, .name = "sf-window"});
        visitor_->close((*window)->id());
        for (int i = 0; i < 100 && !thread.left().load() && (may_leave || i < 10); ++i) wait_ms(10);
        EXPECT_EQ(thread.left().load(), may_leave);
        thread.stop();
        EXPECT_EQ(thread.refused(), "");
    }
}

}  // namespace
}  // namespace surefoot
