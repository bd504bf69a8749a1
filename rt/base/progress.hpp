// Progress of long work, and the request to stop it: passed as an argument, never global.
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

namespace surefoot {

/// Passed to long work. `report` is called about 10 times a second on the thread that runs the work; it may be empty.
struct Progress {
    /// stage: a word or two; done in 0..1 of that stage.
    std::function<void(std::string_view stage, double done)> report;
    /// Set (by a signal handler) when the user wants the work to stop; the work returns an Error soon after.
    const std::atomic<bool>* stop = nullptr;
    /// Shows the user a message at once, on the calling thread. If empty, the result carries the message.
    std::function<void(std::string_view text)> notify;

    [[nodiscard]] bool stopped() const { return stop != nullptr && stop->load(std::memory_order_relaxed); }
    void update(std::string_view stage, double done) const {
        if (report) report(stage, done);
    }
};

}  // namespace surefoot
