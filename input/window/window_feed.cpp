// The ring, and the descriptor that wakes its reader.
#include "input/window/window_feed.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

namespace surefoot::input {

WindowFeed::WindowFeed() : event_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

WindowFeed::~WindowFeed() {
    if (event_fd_ >= 0) ::close(event_fd_);
}

void WindowFeed::push(const WindowReport& report) {
    pushes_.plays();
    if (waits_ == 0) {
        waiting_[0] = report;
        waits_ = 1;
    } else {
        WindowReport& sum = waiting_[0];
        sum.keys |= report.keys;
        sum.dx += report.dx;
        sum.dy += report.dy;
        sum.stamp_ns = report.stamp_ns;
        waiting_[1] = report;
        waiting_[1].dx = waiting_[1].dy = 0;
        waits_ = 2;
    }
    (void)flush();
}

bool WindowFeed::flush() {
    pushes_.plays();
    bool pushed = false;
    while (waits_ > 0 && !ring_.full() && ring_.try_push(waiting_[0])) {
        waiting_[0] = waiting_[1];
        --waits_;
        pushed = true;
    }
    constexpr std::uint64_t one = 1;
    if (pushed && event_fd_ >= 0) (void)!::write(event_fd_, &one, sizeof one);
    return waits_ == 0;
}

bool WindowFeed::take(WindowReport& report) {
    if (ring_.try_pop(report)) return true;
    std::uint64_t count = 0;
    if (event_fd_ >= 0) (void)!::read(event_fd_, &count, sizeof count);
    return ring_.try_pop(report);  // what came before the descriptor was emptied
}

}  // namespace surefoot::input
