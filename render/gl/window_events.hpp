// A window of the X server, and the connection that owns it: what its visitor does, and what is done to it. The driver draws
// through a connection of its own, so no event ever waits for a frame, and no frame for an event.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "render/gl/present_times.hpp"
#include "render/gl/x11.hpp"
#include "render/model/view.hpp"
#include "rt/base/result.hpp"
#include "rt/base/window_event.hpp"

namespace surefoot::gl {

/// Width and height of a window, in pixels.
struct WindowSize {
    std::uint32_t width = 0, height = 0;
    bool operator==(const WindowSize&) const = default;
};

/// The window lives as long as this. One thread at a time calls all members but size() and id().
class WindowEvents {
public:
    /// Opens the connection and shows the window. Errors: no library, no server.
    static Result<std::shared_ptr<WindowEvents>> open(model::Viewport viewport, const std::string& title, bool fullscreen);
    ~WindowEvents();
    WindowEvents(const WindowEvents&) = delete;
    WindowEvents& operator=(const WindowEvents&) = delete;

    /// Readable when next() may have something.
    [[nodiscard]] int fd() const;
    /// The next event; false: none waits. Never blocks, and sends what was ordered before.
    bool next(WindowEvent& event);

    /// Keeps the pointer in the window, hidden. False: another program holds it.
    bool capture();
    void release();
    /// Puts the pointer into the window's middle: a motion event to (width / 2, height / 2) follows.
    void centre_pointer();
    void toggle_fullscreen();

    /// When its pictures were shown; null where the server does not report it.
    [[nodiscard]] PresentTimes* present_times() const { return times_.get(); }

    /// Any thread: as of the last event.
    [[nodiscard]] WindowSize size() const;
    [[nodiscard]] x11::Id id() const { return window_; }

private:
    explicit WindowEvents(const x11::Functions& x) : x_(x) {}
    void show(model::Viewport viewport, const std::string& title);
    bool translate(x11::Event& from, WindowEvent& event);
    bool translate_configure(const x11::ConfigureEvent& from, WindowEvent& event);
    void take_focus();
    void request_state(bool add);
    [[nodiscard]] bool is_managed() const;
    void make_hidden_cursor();

    x11::Functions x_;
    x11::Display* display_ = nullptr;
    x11::Id window_ = 0, closing_ = 0, protocols_ = 0, state_ = 0, state_fullscreen_ = 0, hidden_cursor_ = 0;
    bool fullscreen_ = false;
    int before_x_ = 0, before_y_ = 0, x_px_ = 0, y_px_ = 0;  ///< places: before fullscreen without a window manager; now
    WindowSize before_;
    std::unique_ptr<PresentTimes> times_;
    std::atomic<std::uint64_t> size_{0};  ///< width in the upper half
};

}  // namespace surefoot::gl
