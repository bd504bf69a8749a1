// The keys that are down, and the pointer.
#include "input/window/window_reports.hpp"

#include <cstdlib>

#include "input/window/window_keys.hpp"

namespace surefoot::input {

namespace {

constexpr std::uint32_t left_button = 1, middle_button = 2, right_button = 3;

}  // namespace

WindowReports::Step WindowReports::take(const WindowEvent& event) {
    using Kind = WindowEvent::Kind;
    report_.dx = report_.dy = 0;
    report_.stamp_ns = event.stamp_ns;
    switch (event.kind) {
        case Kind::key_down:
            return key_down(event);
        case Kind::key_up:
            return key_up(event);
        case Kind::button_down:
        case Kind::button_up:
            return button(event);
        case Kind::motion:
            return motion(event);
        case Kind::focus_in:
            focused_ = true;
            return {};
        case Kind::focus_out:
            return lose_focus();
        case Kind::held_keys:
            for (std::size_t code = 0; code < 256; ++code)
                if (((event.held[code / 8] >> (code % 8)) & 1U) != 0 && !down_[code]) passed_over_.set(code);
            return {};
        case Kind::pointer_out:  // where the keyboard follows the pointer, it has gone too
            return {!focused_ && release_keys(), WindowCommand::none};
        case Kind::resized:
            width_ = event.x;
            height_ = event.y;
            return {};
        case Kind::close:
            return {false, WindowCommand::leave};
    }
    return {};
}

WindowReports::Step WindowReports::key_down(const WindowEvent& event) {
    const std::size_t code = event.code & 0xffU;
    if (down_[code] || passed_over_[code]) return {};  // it repeats, or was down before
    down_.set(code);
    key_of_[code] = static_cast<std::int8_t>(window_key_of(event.symbol));
    if (event.symbol == symbol_f11) return {false, WindowCommand::fullscreen};
    if (event.symbol == symbol_escape) {
        const bool releases = captured_;
        captured_ = centring_ = false;
        return {false, releases ? WindowCommand::release : WindowCommand::leave};
    }
    if (key_of_[code] < 0) return {};
    sum_keys();
    return {true, WindowCommand::none};
}

WindowReports::Step WindowReports::key_up(const WindowEvent& event) {
    const std::size_t code = event.code & 0xffU;
    passed_over_.reset(code);
    if (!down_[code]) return {};
    down_.reset(code);
    sum_keys();
    return {key_of_[code] >= 0, WindowCommand::none};
}

void WindowReports::sum_keys() {
    report_.keys = 0;
    for (std::size_t code = 0; code < 256; ++code)
        if (down_[code] && key_of_[code] >= 0) report_.keys |= std::uint64_t{1} << static_cast<unsigned>(key_of_[code]);
}

bool WindowReports::release_keys() {
    const bool held = report_.keys != 0;
    down_.reset();
    passed_over_.reset();
    report_.keys = 0;
    return held;
}

/// Nobody will say when a key or button goes up.
WindowReports::Step WindowReports::lose_focus() {
    const bool releases = captured_;
    focused_ = captured_ = centring_ = false;
    dragging_.reset();
    return {release_keys(), releases ? WindowCommand::release : WindowCommand::none};
}

WindowReports::Step WindowReports::button(const WindowEvent& event) {
    const bool down = event.kind == WindowEvent::Kind::button_down;
    if (event.code == left_button || event.code == middle_button) {
        dragging_.set(event.code, down);
        if (down && !captured_) x_ = event.x, y_ = event.y;
        return {};
    }
    if (event.code != right_button || !down) return {};
    captured_ = !captured_;
    centring_ = captured_;
    x_ = event.x, y_ = event.y;
    return {false, captured_ ? WindowCommand::capture : WindowCommand::release};
}

WindowReports::Step WindowReports::motion(const WindowEvent& event) {
    const std::int32_t middle_x = width_ / 2, middle_y = height_ / 2;
    if (captured_ && centring_ && event.x == middle_x && event.y == middle_y) {
        centring_ = false;
        x_ = middle_x, y_ = middle_y;
        return {};
    }
    report_.dx = event.x - x_;
    report_.dy = event.y - y_;
    x_ = event.x, y_ = event.y;
    Step step;
    step.reports = (captured_ || dragging_.any()) && (report_.dx != 0 || report_.dy != 0);
    const bool far = std::abs(x_ - middle_x) > width_ / 4 || std::abs(y_ - middle_y) > height_ / 4;
    if (captured_ && far && !centring_) {
        centring_ = true;
        step.command = WindowCommand::centre;
    }
    return step;
}

}  // namespace surefoot::input
