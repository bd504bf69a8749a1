// When the kernel hangs a hidraw node up, seen by a reader of our own.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

#include "tests/vm/checks.hpp"

namespace surefoot::vm {

/// `node`: "hidraw3". Watches in a thread of its own while it lives.
class HangUp {
public:
    explicit HangUp(const std::string& node) : fd_(::open(("/dev/" + node).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
        watcher_ = std::thread([this] {
            for (pollfd one{fd_, 0, 0}; !ending_;)
                if (::poll(&one, 1, 20) > 0 && (one.revents & (POLLHUP | POLLERR)) != 0) {
                    at_ns_ = now_ns();
                    return;
                }
        });
    }
    ~HangUp() {
        ending_ = true;
        watcher_.join();
        if (fd_ >= 0) ::close(fd_);
    }
    HangUp(const HangUp&) = delete;
    HangUp& operator=(const HangUp&) = delete;
    /// CLOCK_MONOTONIC; 0: not yet.
    [[nodiscard]] std::int64_t at_ns() const { return at_ns_; }

private:
    int fd_;
    std::atomic<std::int64_t> at_ns_ = 0;
    std::atomic<bool> ending_ = false;
    std::thread watcher_;
};

}  // namespace surefoot::vm
