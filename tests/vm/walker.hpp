// The input thread's loop, run by a test: live devices to the steering, a tick every millisecond, at the input thread's priority.
#pragma once

#include <sched.h>

#include <glm/geometric.hpp>

#include <functional>
#include <vector>

#include "input/devices/device_router.hpp"
#include "input/devices/live.hpp"
#include "input/steering.hpp"
#include "tests/vm/checks.hpp"

namespace surefoot::vm {

class Walker {
public:
    Walker() {
        auto made = input::open_live({}, true);
        if (!made) std::fprintf(stderr, "%s\n", made.error().text().c_str());
        if (made) source = std::move(*made);
        const sched_param fifo{75};
        if (sched_setscheduler(0, SCHED_FIFO, &fifo) != 0) std::fprintf(stderr, "SCHED_FIFO is refused\n");
    }

    ~Walker() {
        const sched_param other{0};
        (void)sched_setscheduler(0, SCHED_OTHER, &other);
    }
    Walker(const Walker&) = delete;
    Walker& operator=(const Walker&) = delete;

    /// One wake-up; the speed after it.
    double step() {
        const std::int64_t began = now_ns();
        if (last_ns != 0) longest_gap_ns = std::max(longest_gap_ns, began - last_ns);
        last_ns = began;
        source->wait(now_ns() + 1'000'000);
        for (const input::DeviceEvent& e : source->take()) {
            if (e.kind == input::DeviceEvent::Kind::added) added_ns = e.stamp_ns, node = e.plugged->node;
            if (e.kind == input::DeviceEvent::Kind::removed) removed_ns = e.stamp_ns;
            if (e.kind == input::DeviceEvent::Kind::report && first_report_ns == 0) first_report_ns = e.stamp_ns;
            router.dispatch(e);
        }
        steering.steers.plays();
        sample = steering.tick(lines, now_ns());
        greatest = std::max(greatest, speed());
        if (!(speed() < 1e9)) ++wrong;  // NaN too
        return speed();
    }
    [[nodiscard]] double speed() const { return glm::length(sample.velocity_m_s) + glm::length(sample.angular_rad_s); }
    void run_ms(double ms) {
        for (const std::int64_t from = now_ns(); ms_since(from) < ms;) step();
    }
    /// Sends every millisecond, as a streaming device does, while the walk runs.
    void hold(const std::function<void()>& send, double ms) {
        for (const std::int64_t from = now_ns(); ms_since(from) < ms;) {
            send();
            const std::int64_t sent = now_ns();
            do step();
            while (now_ns() < sent + 1'000'000);
        }
    }
    /// False: not within so long.
    bool until(const std::function<bool()>& true_now, double within_ms) {
        for (const std::int64_t from = now_ns(); ms_since(from) < within_ms; step())
            if (true_now()) return true;
        return true_now();
    }

    std::vector<std::string> messages;
    std::string node;  ///< of the device that came last
    input::Steering steering{input::MotionLimits{}, input::SafetyLimits{}};
    input::DeviceRouter router{{}, steering, [this](std::string_view text) { messages.emplace_back(text); }};
    std::unique_ptr<input::LiveDevices> source;
    input::Lines lines;
    input::NavigationSample sample;
    std::int64_t added_ns = 0, removed_ns = 0, first_report_ns = 0;
    std::int64_t last_ns = 0, longest_gap_ns = 0;  ///< between two steps; set it to 0 to begin anew
    double greatest = 0;
    int wrong = 0;
};

}  // namespace surefoot::vm
