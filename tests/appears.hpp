// Waiting for a file or folder that another thread or process moves into its place.
#pragma once

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "rt/clock/clock.hpp"

namespace surefoot::test {

inline bool has_entry(const std::string& folder, std::string_view prefix) {
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().filename().string().starts_with(prefix)) return true;
    return false;
}

/// Waits until an entry of the folder has a name with that prefix; false: none has after `seconds`.
inline bool appears(const std::string& folder, std::string_view prefix, double seconds) {
    const int changes = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
    inotify_add_watch(changes, folder.c_str(), IN_MOVED_TO | IN_CREATE);
    const rt::RealClock clock;
    const std::int64_t until_ns = clock.now_ns() + static_cast<std::int64_t>(seconds * 1e9);
    bool found = false;
    for (std::int64_t now_ns = 0; !(found = has_entry(folder, prefix)) && (now_ns = clock.now_ns()) < until_ns;) {
        const std::int64_t left_ns = until_ns - now_ns;
        const timespec left{left_ns / 1'000'000'000, left_ns % 1'000'000'000};
        pollfd one{changes, POLLIN, 0};
        std::array<std::byte, 4096> events{};
        if (ppoll(&one, 1, &left, nullptr) > 0) (void)!read(changes, events.data(), events.size());
    }
    close(changes);
    return found;
}

}  // namespace surefoot::test
