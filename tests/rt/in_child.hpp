// A test's body in a process of its own: for what cannot be undone, and for what happens to a process as a whole.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <functional>

namespace surefoot::rt::test {

constexpr int passed = 0, failed = 1;

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
