// Keeps a latched emergency stop across restarts, in one small file. Never call it from the input or frame thread.
#pragma once

#include <atomic>
#include <string>

#include "rt/base/result.hpp"

namespace surefoot::input {

/// The stored stop, as it was read.
struct RememberedStop {
    bool latched = false;
    std::string note;  ///< why it counts as latched without a stored stop; else empty
};

/// No file: not latched. A file that cannot be read, or has other content than the two known texts: latched.
RememberedStop load_stop(const std::string& file);
/// Synced and renamed before it returns. Error: the file's, with the remedy.
Result<void> store_stop(const std::string& file, bool latched);

/// Between the thread that steps safety/ and the one that writes: set() is one atomic store, flush() writes what changed.
/// Latching is written at the first flush; until then an open stop line latches anew after a restart by itself.
class StopKeeper {
public:
    StopKeeper(std::string file, bool latched) : file_(std::move(file)), latched_(latched), written_(latched) {}
    void set(bool latched) noexcept { latched_.store(latched, std::memory_order_relaxed); }
    [[nodiscard]] bool latched() const noexcept { return latched_.load(std::memory_order_relaxed); }
    /// Call every few milliseconds from a service thread. A failed write is tried again at the next call.
    Result<void> flush();

private:
    std::string file_;
    std::atomic<bool> latched_;
    bool written_;
};

}  // namespace surefoot::input
