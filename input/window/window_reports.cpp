// The keys that are down, and the pointer.
#include "input/window/window_reports.hpp"

#include <cstdlib>

#include "input/window/window_keys.hpp"

namespace surefoot::input {

namespace {

constexpr std::uint32_t left_button = 1, middle_button = 2, right_button = 3;
constexpr int max_awaited = 64;  // motion events in which a pointer that was put into the middle must have come there

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
            passed_over_.reset();  // held_keys follows
            return {};
        case Kind::focus_out:
            return lose_focus();
        case Kind::held_keys:
            return compare_keys(event);
        case Kind::pointer_out:  // Without focus, keys are released when the pointer leaves.
            return {!focused_ && release_keys(), WindowCommand::none};
        case Kind::resized:
            width_ = event.x;
            height_ = event.y;
            centring_ = false;  // the middle is elsewhere
            return {};
        case Kind::close:
            return {false, WindowCommand::leave};
    }
    return {};
}

WindowReports::Step WindowReports::key_down(const WindowEvent& event) {
    const std::size_t code = event.code & 0xffU;
    const int key = window_key_of(event.symbol);
    const bool stops = key >= 0 && ((stop_keys_ >> static_cast<unsigned>(key)) & 1U) != 0;
    if (down_[code] || (passed_over_[code] && !stops)) return {};  // it repeats, or was down before
    passed_over_.reset(code);
    down_.set(code);
    key_of_[code] = static_cast<std::int8_t>(key);
    if (event.symbol == symbol_f11) return {false, WindowCommand::fullscreen};
    if (event.symbol == symbol_escape) {
        const bool releases = captured_;
        captured_ = centring_ = false;
        awaited_ = 0;
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

/// A key that went up unseen is released; one that went down unseen counts once it was up.
WindowReports::Step WindowReports::compare_keys(const WindowEvent& event) {
    std::bitset<256> held;
    for (std::size_t code = 0; code < held.size(); ++code) held.set(code, ((event.held[code / 8] >> (code % 8)) & 1U) != 0);
    passed_over_ = held & ~down_;
    down_ &= held;
    const std::uint64_t before = report_.keys;
    sum_keys();
    return {report_.keys != before, WindowCommand::none};
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
    awaited_ = 0;
    dragging_.reset();
    return {release_keys(), releases ? WindowCommand::release : WindowCommand::none};
}

WindowReports::Step WindowReports::button(const WindowEvent& event) {
    const bool down = event.kind == WindowEvent::Kind::button_down;
    if (event.code == left_button || event.code == middle_button) {
        dragging_.set(event.code, down);
        if (down && !captured_) keep_place(event);
        return {};
    }
    if (event.code != right_button || !down) return {};
    captured_ = !captured_;
    keep_place(event);
    if (captured_)
        await_middle();
    else
        capture_refused();
    return {false, captured_ ? WindowCommand::capture : WindowCommand::release};
}

void WindowReports::keep_place(const WindowEvent& event) {
    x_screen_ = event.x_screen;
    y_screen_ = event.y_screen;
}

void WindowReports::await_middle() {
    centring_ = true;
    awaited_ = max_awaited;
    middle_x_ = width_ / 2;
    middle_y_ = height_ / 2;
}

WindowReports::Step WindowReports::motion(const WindowEvent& event) {
    if (awaited_ > 0 && event.x == middle_x_ && event.y == middle_y_) {
        centring_ = false;
        awaited_ = 0;
        keep_place(event);
        return {};
    }
    if (awaited_ > 0 && --awaited_ == 0) centring_ = false;  // it was there already, or the server refused
    report_.dx = event.x_screen - x_screen_;
    report_.dy = event.y_screen - y_screen_;
    keep_place(event);
    Step step;
    step.reports = (captured_ || dragging_.any()) && (report_.dx != 0 || report_.dy != 0);
    const bool far = std::abs(event.x - width_ / 2) > width_ / 4 || std::abs(event.y - height_ / 2) > height_ / 4;
    if (captured_ && far && !centring_) {
        await_middle();
        step.command = WindowCommand::centre;
    }
    return step;
}

}  // namespace surefoot::input
