// Hands a window's reports from the thread that reads its events to the thread that steers.
#pragma once

#include <poll.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "input/window/window_reports.hpp"
#include "rt/base/thread_annotations.hpp"
#include "rt/exchange/spsc_ring.hpp"

namespace surefoot::input {

/// One thread pushes, one takes. Neither waits, allocates or locks. Where the taker is too slow, reports are summed up in two.
/// The first has every key that was down meanwhile, and all pixels. The second has the keys as they are now. So no press is lost.
class WindowFeed {
public:
    WindowFeed();
    ~WindowFeed();
    WindowFeed(const WindowFeed&) = delete;
    WindowFeed& operator=(const WindowFeed&) = delete;

    /// Pushing thread.
    void push(const WindowReport& report);
    /// Pushing thread: tries again what found no room. False: it still finds none.
    bool flush();
    /// Taking thread. False: none waits.
    bool take(WindowReport& report);
    /// Readable when reports may wait.
    [[nodiscard]] pollfd polled() const { return {event_fd_, POLLIN, 0}; }

private:
    rt::SpscRing<WindowReport> ring_{1024};
    [[no_unique_address]] ThreadRole pushes_;
    std::array<WindowReport, 2> waiting_ GUARDED_BY(pushes_);  ///< the sum, then the newest keys
    std::size_t waits_ GUARDED_BY(pushes_) = 0;                ///< how many of them
    int event_fd_;                                             ///< -1: none could be had; then the taker's own rhythm serves
};

}  // namespace surefoot::input
