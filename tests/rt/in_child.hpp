// A test's body in a process of its own: for what cannot be undone, and for what happens to a process as a whole.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <functional>

namespace surefoot::rt::test {

constexpr int passed = 0, failed = 1;

/// Told once by one process and waited for by another; made before the fork.
class StartSignal {
public:
    StartSignal() : open_(::pipe(ends_.data()) == 0) {}
    ~StartSignal() {
        for (const int end : ends_)
            if (open_) ::close(end);
    }
    StartSignal(const StartSignal&) = delete;
    StartSignal& operator=(const StartSignal&) = delete;
    void send() { (void)!::write(ends_[1], "x", 1); }
    void wait() {
        char byte = 0;
        (void)!::read(ends_[0], &byte, 1);
    }

private:
    std::array<int, 2> ends_{};
    bool open_;
};

/// Runs `body` in a forked child; its exit code. `meanwhile` runs here, beside it.
inline int in_child(const std::function<int()>& body, const std::function<void(pid_t)>& meanwhile = {}) {
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child == 0) ::_exit(body());
    if (meanwhile) meanwhile(child);
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace surefoot::rt::test
