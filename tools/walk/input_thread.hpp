// The input thread: sleeps until a report or a tick is due, and makes the step. Below the frame thread, above the rasterisers.
#pragma once

#include <atomic>
#include <cstdint>
#include <latch>
#include <optional>
#include <thread>

#include "rt/base/result.hpp"
#include "rt/threads/placement.hpp"
#include "tools/walk/input_stepper.hpp"

namespace surefoot::walk {

/// Runs an InputStepper on a thread of its own.
class InputThread {
public:
    /// Start from a neutral thread, after stepper.begin(). When this returns, the thread has applied `placement`.
    InputThread(InputStepper& stepper, rt::Placement placement);
    ~InputThread() { stop(); }
    InputThread(const InputThread&) = delete;
    InputThread& operator=(const InputThread&) = delete;

    void stop();
    /// After stop(): allocations, frees inside its loop; must be 0.
    [[nodiscard]] std::uint64_t guard_violations() const { return guard_violations_; }
    /// The error if it could not be placed.
    [[nodiscard]] const std::optional<Error>& misplaced() const { return misplaced_; }

private:
    void run();

    InputStepper& stepper_;
    rt::Placement placement_;
    std::uint64_t guard_violations_ = 0;
    std::optional<Error> misplaced_;  ///< written before placed_
    std::latch placed_{1};
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

}  // namespace surefoot::walk
