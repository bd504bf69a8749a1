// The process that keeps the timetable of loads, and the processes that it makes for them. They end with the soak, however it
// ends. Each has the kernel signal it when its parent dies, and sets an alarm for a time when it must have ended.
#pragma once

#include <sys/types.h>

#include "rt/base/result.hpp"
#include "tools/soak/load_board.hpp"
#include "tools/soak/plan.hpp"

namespace surefoot::soak {

/// The process of the loads. One thread calls all members.
class LoadRunner {
public:
    /// Forks: call it while this process has one thread. Nothing is loaded until begin().
    static Result<LoadRunner> start(const LoadPlan& plan, const LoadSettings& settings);
    LoadRunner(LoadRunner&& other) noexcept;
    LoadRunner& operator=(LoadRunner&&) = delete;
    LoadRunner(const LoadRunner&) = delete;
    LoadRunner& operator=(const LoadRunner&) = delete;
    ~LoadRunner();

    /// The plan's time 0, monotonic. After the plan's end the CPU load goes on until stop(), for the proof that the load is real.
    /// A mix without CPU load goes on as a whole.
    void begin(std::int64_t start_ns) { board_->start_ns.store(start_ns); }
    /// Ends all of it and waits; then the counters stand still.
    void stop();
    [[nodiscard]] const LoadBoard& board() const { return *board_; }
    [[nodiscard]] pid_t pid() const { return pid_; }

private:
    LoadRunner(LoadBoard* board, pid_t pid) : board_(board), pid_(pid) {}
    LoadBoard* board_ = nullptr;
    pid_t pid_ = -1;
};

/// What runs after the plan's end.
LoadSet proof_loads(LoadSet mix);

}  // namespace surefoot::soak
