// Schedule of retries for opening a device: soon at first, then less often, for ever. Pure.
#pragma once

#include <algorithm>
#include <cstdint>

namespace surefoot::input {

/// Waits after each failure: 100 ms, doubling to 2 s. At most 20 tries in the first 30 s; never gives up.
struct Retry {
    std::int64_t next_ns = 0, wait_ns = 0;
    [[nodiscard]] bool due(std::int64_t now_ns) const { return now_ns >= next_ns; }
    void failed(std::int64_t now_ns) {
        wait_ns = wait_ns == 0 ? 100'000'000 : wait_ns * 2 > 2'000'000'000 ? 2'000'000'000 : wait_ns * 2;
        next_ns = now_ns + wait_ns;
    }
    void succeeded() { next_ns = wait_ns = 0; }
    /// The device changed: one try at once; later waits continue as before.
    void hurry(std::int64_t now_ns) { next_ns = std::min(next_ns, now_ns); }
};

}  // namespace surefoot::input
