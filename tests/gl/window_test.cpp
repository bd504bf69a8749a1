// A window on a real X server (Xvfb): its picture fills it in its own shape at any size, and its visitor's keys, pointer, focus
// and closing arrive. Skipped with the reason where there is no such server.
#include "render/gl/window_events.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/device.hpp"
#include "tests/gl/small_models.hpp"
#include "tests/gl/x_server.hpp"

namespace surefoot {
namespace {

using Kind = WindowEvent::Kind;

/// All events until one fits, for two seconds at most.
std::vector<WindowEvent> events_until(gl::WindowEvents& window, const std::function<bool(const WindowEvent&)>& last) {
    std::vector<WindowEvent> events;
    for (int i = 0; i < 400; ++i) {
        for (WindowEvent event; window.next(event);) {
            events.push_back(event);
            if (last(event)) return events;
        }
        test::wait_ms(5);
    }
    ADD_FAILURE() << "no such event of " << events.size();
    return events;
}

std::vector<WindowEvent> events_until(gl::WindowEvents& window, Kind last) {
    return events_until(window, [&](const WindowEvent& e) { return e.kind == last; });
}

/// A red square that fills the middle of the picture, on the sky.
struct WindowScene {
    model::Model model;
    std::vector<gl::DrawItem> items;
};
WindowScene red_square() {
    test::SmallModel scene;
    const auto paint = scene.material(test::plain(1, 0, 0));
    const auto node = scene.square(paint, test::at(0, 0, -2), 0.5F);
    WindowScene out;
    out.items.push_back({node, node - 1});
    out.model = scene.finish();
    return out;
}

void show(gl::Device& device, const WindowScene& scene) {
    device.draws.plays();
    device.begin_frame(Pose{});
    device.draw(scene.items);
    device.end_slice();
    device.end_items();
    device.finish_frame();
    device.present();
}

/// The screen once the server has drawn what was sent to it: as soon as it looks so, or after a second.
test::ScreenPicture screen_when(test::XVisitor& visitor, const std::function<bool(const test::ScreenPicture&)>& looks) {
    test::ScreenPicture screen = visitor.look_at_screen();
    for (int i = 0; i < 200 && !looks(screen); ++i) {
        test::wait_ms(5);
        screen = visitor.look_at_screen();
    }
    return screen;
}

bool is_black(const test::ScreenPixel& p) { return p == test::ScreenPixel{}; }
bool is_red(const test::ScreenPixel& p) { return p.r > 100 && p.g < 60 && p.b < 60; }

TEST(WindowOnServer, FillsAnySizeInItsOwnShapeWithBlackBesideIt) {
    auto server = test::XServer::start();
    if (!server) GTEST_SKIP() << server.error().text();
    auto visitor = test::XVisitor::come();
    if (!visitor) GTEST_SKIP() << visitor.error().text();
    const WindowScene scene = red_square();
    gl::DeviceOptions options;
    options.kind = gl::BackendKind::window;
    options.viewport = {160, 120};
    auto device = gl::open_device(options);
    if (!device) GTEST_SKIP() << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    const auto window = (*device)->window();
    ASSERT_NE(window, nullptr);
    events_until(*window, Kind::focus_in);
    show(**device, scene);
    test::ScreenPicture screen = screen_when(**visitor, [](const test::ScreenPicture& s) { return is_red(s.at(80, 60)); });
    EXPECT_TRUE(is_red(screen.at(80, 60))) << "one picture is enough; there is " << screen.at(80, 60).r << " "
                                           << screen.at(80, 60).g << " " << screen.at(80, 60).b;
    EXPECT_FALSE(is_black(screen.at(1, 1))) << "the sky";
    EXPECT_TRUE(is_black(screen.at(161, 60))) << "beside the window";
    const test::ScreenPixel sky = screen.at(1, 1);

    struct Case {
        unsigned width, height;
        int left, top;  // of black
    };
    for (const Case c :
         {Case{320, 240, 0, 0}, Case{400, 240, 40, 0}, Case{160, 300, 0, 90}, Case{37, 120, 0, 46}, Case{160, 120, 0, 0}}) {
        (*visitor)->resize(window->id(), c.width, c.height);
        events_until(*window, [&](const WindowEvent& e) {
            return e.kind == Kind::resized && e.x == static_cast<int>(c.width) && e.y == static_cast<int>(c.height);
        });
        for (int i = 0; i < 3; ++i) show(**device, scene);
        const int w = static_cast<int>(c.width), h = static_cast<int>(c.height);
        screen = screen_when(**visitor, [&](const test::ScreenPicture& s) {
            return is_red(s.at(w / 2, h / 2)) && s.at(w - c.left - 3, h / 2) == sky && s.at(w / 2, h - c.top - 3) == sky;
        });
        const std::string size = std::to_string(w) + "x" + std::to_string(h);
        EXPECT_TRUE(is_red(screen.at(w / 2, h / 2))) << size;
        for (const auto& [x, y] : {std::pair{c.left + 2, h / 2}, std::pair{w - c.left - 3, h / 2}, std::pair{w / 2, c.top + 2},
                                   std::pair{w / 2, h - c.top - 3}})
            EXPECT_EQ(screen.at(x, y), sky) << size << " at " << x << "," << y;
        if (c.left > 0) {
            EXPECT_TRUE(is_black(screen.at(c.left - 2, h / 2)) && is_black(screen.at(w - c.left + 1, h / 2))) << size;
        }
        if (c.top > 0) {
            EXPECT_TRUE(is_black(screen.at(w / 2, c.top - 2)) && is_black(screen.at(w / 2, h - c.top + 1))) << size;
        }
    }
    window->toggle_fullscreen();
    events_until(*window, [](const WindowEvent& e) { return e.kind == Kind::resized && e.x == 640; });
    for (int i = 0; i < 3; ++i) show(**device, scene);
    screen = screen_when(**visitor, [&](const test::ScreenPicture& s) { return s.at(637, 477) == sky; });
    for (const auto& [x, y] : {std::pair{2, 2}, std::pair{637, 2}, std::pair{2, 477}, std::pair{637, 477}})
        EXPECT_EQ(screen.at(x, y), sky) << "640x480 has the picture's shape: all is filled";
    window->toggle_fullscreen();
    events_until(*window, [](const WindowEvent& e) { return e.kind == Kind::resized && e.x == 160; });
}

TEST(WindowOnServer, ARefusedWindowIsAnErrorThatNamesTheRequest) {
    auto server = test::XServer::start();
    if (!server) GTEST_SKIP() << server.error().text();
    const auto visitor = test::XVisitor::come();  // without a connection the server would start anew
    if (!visitor) GTEST_SKIP() << visitor.error().text();
    const std::uint32_t before = gl::x11::refusals().count;
    const auto refused = gl::WindowEvents::open({0, 64}, "test", false);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().what.find("refuses the window: Bad"), std::string::npos) << refused.error().text();
    EXPECT_GT(gl::x11::refusals().count, before);
    const auto good = gl::WindowEvents::open({64, 64}, "test", false);
    EXPECT_TRUE(good.ok()) << (good.ok() ? "" : good.error().text()) << ": a refusal of before is not this one's";
}

TEST(WindowOnServer, ItsVisitorsEventsArrive) {
    auto server = test::XServer::start();
    if (!server) GTEST_SKIP() << server.error().text();
    auto visitor = test::XVisitor::come();
    if (!visitor) GTEST_SKIP() << visitor.error().text();
    auto opened = gl::WindowEvents::open({200, 100}, "test", true);
    ASSERT_TRUE(opened.ok()) << opened.error().text();
    gl::WindowEvents& window = **opened;
    EXPECT_EQ(window.size(), (gl::WindowSize{640, 480})) << "it begins with the whole screen";
    events_until(window, Kind::focus_in);
    (*visitor)->tap('w');
    auto events = events_until(window, Kind::key_up);
    const auto down = std::ranges::find(events, Kind::key_down, &WindowEvent::kind);
    ASSERT_NE(down, events.end());
    EXPECT_EQ(down->symbol, static_cast<std::uint32_t>('w'));
    EXPECT_EQ(down->code, events.back().code);
    EXPECT_GT(down->stamp_ns, 0);

    // A key that is held repeats, and sends no release in between.
    (*visitor)->set_repeat(60, 20);
    (*visitor)->key('d', true);
    events = events_until(window, [n = 0](const WindowEvent& e) mutable { return e.kind == Kind::key_down && ++n == 3; });
    EXPECT_EQ(std::ranges::count(events, Kind::key_up, &WindowEvent::kind), 0);
    (*visitor)->key('d', false);
    events_until(window, Kind::key_up);

    (*visitor)->move_to(50, 60);
    (*visitor)->button(1, true);
    (*visitor)->move_to(70, 55);
    (*visitor)->button(1, false);
    events = events_until(window, Kind::button_up);
    const auto pressed = std::ranges::find(events, Kind::button_down, &WindowEvent::kind);
    ASSERT_NE(pressed, events.end());
    EXPECT_EQ(pressed->code, 1U);
    EXPECT_EQ(events.back().x - pressed->x, 20);
    EXPECT_EQ(events.back().y - pressed->y, -5);
    EXPECT_EQ(pressed->x_screen, 50);
    EXPECT_EQ(pressed->y_screen, 60);

    ASSERT_TRUE(window.capture());
    window.centre_pointer();
    events_until(window, [](const WindowEvent& e) { return e.kind == Kind::motion && e.x == 320 && e.y == 240; });
    window.release();

    (*visitor)->take_focus();
    events_until(window, Kind::focus_out);
    (*visitor)->key('a', true);
    (*visitor)->give_focus(window.id());
    events = events_until(window, Kind::held_keys);
    (*visitor)->key('a', false);
    const auto released = events_until(window, Kind::key_up).back();
    EXPECT_TRUE(((events.back().held[released.code / 8] >> (released.code % 8)) & 1U) != 0) << "it was held before";

    (*visitor)->move_to(50, 60);
    (*visitor)->let_focus_follow_pointer();
    (*visitor)->tap('s');
    events = events_until(window, Kind::key_up);
    EXPECT_EQ(std::ranges::count(events, Kind::focus_in, &WindowEvent::kind), 0) << "the keyboard is the pointer's";
    (*visitor)->close(window.id());
    events_until(window, Kind::close);
}

}  // namespace
}  // namespace surefoot
