// The thread that reads a window's events: hands its keys and pointer to the input thread, and does what the visitor orders of
// the window. No thread waits for this one. It waits only for the X server.
#pragma once

#include <atomic>
#include <cstdint>
#include <latch>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "input/window/window_feed.hpp"
#include "render/gl/window_events.hpp"
#include "rt/base/result.hpp"
#include "rt/threads/placement.hpp"
#include "tools/report/report.hpp"

namespace surefoot::walk {

/// Settings of the thread.
struct WindowThreadOptions {
    std::shared_ptr<input::WindowFeed> feed;  ///< null: keys and pointer do not steer
    bool may_leave = false;                   ///< Escape and closing end the walk; without it and a feed F11 does nothing too
    std::uint64_t stop_keys = 0;              ///< see input::WindowReports
};

/// Runs from the constructor to stop().
class WindowThread {
public:
    /// Start it from a neutral thread. When this returns, the thread has applied `placement`.
    WindowThread(std::shared_ptr<gl::WindowEvents> window, WindowThreadOptions options, rt::Placement placement);
    ~WindowThread();
    WindowThread(const WindowThread&) = delete;
    WindowThread& operator=(const WindowThread&) = delete;

    void stop();
    /// After stop(): what the display reported of the pictures.
    [[nodiscard]] report::DisplaySummary displayed() const;
    /// Set once the visitor has closed the window or pressed Escape. For any thread.
    [[nodiscard]] const std::atomic<bool>& left() const { return left_; }
    /// After stop(): what the X server refused meanwhile, a sentence; empty: nothing.
    [[nodiscard]] std::string refused() const;
    /// The error if it could not be placed.
    [[nodiscard]] const std::optional<Error>& misplaced() const { return misplaced_; }

private:
    void run();
    void take_events(input::WindowReports& reports);
    void take_shown();
    void obey(input::WindowCommand command, input::WindowReports& reports);

    std::shared_ptr<gl::WindowEvents> window_;
    WindowThreadOptions options_;
    rt::Placement placement_;
    std::optional<Error> misplaced_;  ///< written before placed_
    std::uint32_t refused_before_;    ///< requests of this process, before the thread began
    std::latch placed_{1};
    std::atomic<bool> left_{false}, stopping_{false};
    int wake_fd_;
    std::vector<double> shown_ms_;  ///< from hand-over to the display, of the newest pictures
    std::uint64_t shown_ = 0, replaced_ = 0;
    std::thread thread_;
};

}  // namespace surefoot::walk
