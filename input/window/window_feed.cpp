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
    if (waits_) {
        waiting_.keys = report.keys;
        waiting_.dx += report.dx;
        waiting_.dy += report.dy;
        waiting_.stamp_ns = report.stamp_ns;
    } else {
        waiting_ = report;
    }
    waits_ = true;
    (void)flush();
}

bool WindowFeed::flush() {
    pushes_.plays();
    if (!waits_) return true;
    if (ring_.full()) return false;
    waits_ = !ring_.try_push(waiting_);
    constexpr std::uint64_t one = 1;
    if (event_fd_ >= 0) (void)!::write(event_fd_, &one, sizeof one);
    return !waits_;
}

bool WindowFeed::take(WindowReport& report) {
    if (ring_.try_pop(report)) return true;
    std::uint64_t count = 0;
    if (event_fd_ >= 0) (void)!::read(event_fd_, &count, sizeof count);
    return ring_.try_pop(report);  // what came before the descriptor was emptied
}

}  // namespace surefoot::input
