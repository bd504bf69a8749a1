// When a device that could not be opened is tried again: soon at first, then rarer, for ever. Pure.
#pragma once

#include <algorithm>
#include <cstdint>

namespace surefoot::input {

/// 0.1, 0.2, 0.4, 0.8, 1.6 s and then every 2 s: at most 20 tries in the first half minute (R8), and never given up.
class Retry {
public:
    static constexpr std::int64_t first_ns = 100'000'000, longest_ns = 2'000'000'000;

    [[nodiscard]] std::int64_t due_ns() const { return due_ns_; }
    [[nodiscard]] bool due(std::int64_t now_ns) const { return now_ns >= due_ns_; }
    void failed(std::int64_t now_ns) {
        due_ns_ = now_ns + step_ns_;
        step_ns_ = std::min(2 * step_ns_, longest_ns);
    }
    /// Something changed about it: one try at once, and the schedule goes on from where it was.
    void hurry(std::int64_t now_ns) { due_ns_ = std::min(due_ns_, now_ns); }

private:
    std::int64_t due_ns_ = 0, step_ns_ = first_ns;
};

}  // namespace surefoot::input
