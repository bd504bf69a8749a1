// When what could not be opened is tried again: soon at first, then rarer, for ever. Pure.
#pragma once

#include <algorithm>
#include <cstdint>

namespace surefoot::input {

/// Waits longer after each failure, from 100 ms to 2 s: at most 20 tries in the first half minute (R8), and never given up.
struct Retry {
    std::int64_t next_ns = 0, wait_ns = 0;
    [[nodiscard]] bool due(std::int64_t now_ns) const { return now_ns >= next_ns; }
    void failed(std::int64_t now_ns) {
        wait_ns = wait_ns == 0 ? 100'000'000 : wait_ns * 2 > 2'000'000'000 ? 2'000'000'000 : wait_ns * 2;
        next_ns = now_ns + wait_ns;
    }
    void succeeded() { next_ns = wait_ns = 0; }
    /// Something changed about it: one try at once; the waits go on from where they were.
    void hurry(std::int64_t now_ns) { next_ns = std::min(next_ns, now_ns); }
};

}  // namespace surefoot::input
