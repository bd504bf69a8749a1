// From events of a window to reports, as a keyboard with a mouse would send them, and to what the window is to do. Pure.
//
//   key, button, motion ─► down keys, drag or captured pointer ─► WindowReport (a bit per key, pixels moved)
//   Escape, F11, right button, closing ─────────────────────────► WindowCommand
#pragma once

#include <array>
#include <bitset>
#include <cstdint>

#include "rt/base/window_event.hpp"

namespace surefoot::input {

/// State of all keys, and how far the pointer has turned the eye since the report before.
struct WindowReport {
    std::uint64_t keys = 0;       ///< a bit each, in the order of window_keys()
    std::int32_t dx = 0, dy = 0;  ///< pixels, to the right and downwards
    std::int64_t stamp_ns = 0;    ///< of its newest event
};

/// What the window is to do after an event.
enum class WindowCommand : std::uint8_t {
    none,
    leave,       ///< the visitor wants to go
    capture,     ///< hold the pointer, hidden, and put it into the middle
    release,     ///< let it go
    centre,      ///< put it into the middle again
    fullscreen,  ///< F11 switches full screen on and off
};

/// The keys that are down and the pointer's state. One thread. Neither allocates nor reads a clock.
class WindowReports {
public:
    /// What one event led to.
    struct Step {
        bool reports = false;  ///< report() is new
        WindowCommand command = WindowCommand::none;
    };
    /// `stop_keys`: a bit each; such a key counts as pressed even if it was down when the focus came, once it repeats.
    WindowReports(std::int32_t width, std::int32_t height, std::uint64_t stop_keys = 0)
        : width_(width), height_(height), stop_keys_(stop_keys) {}

    Step take(const WindowEvent& event);
    /// After a step with `reports`.
    [[nodiscard]] const WindowReport& report() const { return report_; }
    /// The window could not hold the pointer: it stays free.
    void capture_refused() {
        captured_ = centring_ = false;
        awaited_ = 0;
    }
    [[nodiscard]] bool captured() const { return captured_; }

private:
    Step key_down(const WindowEvent& event);
    Step key_up(const WindowEvent& event);
    Step button(const WindowEvent& event);
    Step motion(const WindowEvent& event);
    Step lose_focus();
    Step compare_keys(const WindowEvent& event);
    void keep_place(const WindowEvent& event);
    void await_middle();
    bool release_keys();
    void sum_keys();

    std::int32_t width_, height_;
    std::uint64_t stop_keys_;
    WindowReport report_;
    std::bitset<256> down_;                     ///< codes; pressed while the keyboard is the window's
    std::bitset<256> passed_over_;              ///< held since before it was: they count once they were up
    std::array<std::int8_t, 256> key_of_{};     ///< of each code that is down: index of its key, or -1
    std::bitset<8> dragging_;                   ///< buttons
    std::int32_t x_screen_ = 0, y_screen_ = 0;  ///< the pointer's last place
    bool focused_ = false, captured_ = false;
    bool centring_ = false;                     ///< the pointer was put into the middle, and has not come there yet
    int awaited_ = 0;                           ///< motion events in which it may still come
    std::int32_t middle_x_ = 0, middle_y_ = 0;  ///< where it was put
};

}  // namespace surefoot::input
