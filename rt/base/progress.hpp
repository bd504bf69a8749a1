// Progress of long work and the wish to stop it: handed down, never global.
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

namespace surefoot {

/// Handed to long work. `report` may be empty; it is called from the thread that runs the work, about 10 times a second.
struct Progress {
    /// stage: a word or two; done in 0..1 of that stage.
    std::function<void(std::string_view stage, double done)> report;
    /// Set (by a signal handler) when the user wants the work to stop; the work returns an Error soon after.
    const std::atomic<bool>* stop = nullptr;
    /// Something that the user should know now; on the thread that called. Empty: it is handed back with the result.
    std::function<void(std::string_view text)> note;

    [[nodiscard]] bool stopped() const { return stop != nullptr && stop->load(std::memory_order_relaxed); }
    void say(std::string_view stage, double done) const {
        if (report) report(stage, done);
    }
};

}  // namespace surefoot
