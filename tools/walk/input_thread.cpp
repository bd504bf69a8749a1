// The loop of the input thread.
#include "tools/walk/input_thread.hpp"

#include "rt/clock/clock.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/memory.hpp"

namespace surefoot::walk {

InputThread::InputThread(InputStepper& stepper, rt::Placement placement)
    : stepper_(stepper), placement_(std::move(placement)), thread_([this] { run(); }) {
    placed_.wait();
}

void InputThread::stop() {
    stopping_.store(true);
    if (thread_.joinable()) thread_.join();
}

void InputThread::run() {
    if (auto placed = rt::place_thread(0, placement_); !placed) misplaced_ = placed.error();
    placed_.count_down();
    rt::prefault_stack();
    rt::RealClock clock;
    const std::uint64_t before = rt::guard_counters().own_violations;
    {
        const rt::OwnScope own;
        while (!stopping_.load(std::memory_order_relaxed)) {
            stepper_.wait(clock);
            stepper_.step(clock.now_ns());
        }
    }
    guard_violations_ = rt::guard_counters().own_violations - before;
}

}  // namespace surefoot::walk
