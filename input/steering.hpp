// The loop body of the input thread: reports in, navigation samples out. Joins map/, safety/ and motion/.
#pragma once

#include <cstdint>
#include <vector>

#include "input/controls.hpp"
#include "input/map/mapper.hpp"
#include "input/motion/motion.hpp"
#include "input/safety/safety.hpp"

namespace surefoot::input {

/// One thread. After the constructor nothing allocates, frees, locks or reads a clock.
///
///   each wake-up:  for each readable device: read until nothing is left, report() each, then drained()
///                  then tick(): publish what it returns
class Steering {
public:
    Steering(const MotionLimits& motion, const SafetyLimits& safety, bool stop_latched = false);

    /// A device came. Returns its number, or -1 if max_devices are attached. It requests nothing until it was seen neutral.
    /// A returning device with a stop or dead-man must get its old number (`again`): while it is away these hold the walk, and no
    /// other device gets the number. `mapper` is swapped with the number's former mapper, so that a caller that must not free
    /// memory can keep it.
    int attach(Mapper&& mapper, std::size_t controls, Reporting reporting, int again = -1);
    /// Unplugged, or its reader failed.
    void detach(int device);

    /// The device sends no more reports (end of a recording): from now on silence means rest.
    void ended(int device);

    /// One accepted report. Anything but `state.connected` false counts as the device being there.
    void report(int device, const DeviceState& state, std::int64_t now_ns);
    /// After a drain that read until nothing was left: how many reports it read, and whether some were lost on the way.
    void drained(int device, std::uint32_t reports, bool lost = false);

    NavigationSample tick(const Lines& lines, std::int64_t now_ns, const Ground& ground = {});

    bool place(const Pose& pose) { return surefoot::input::place(motion_, pose); }
    [[nodiscard]] const SafetyState& safety() const { return safety_; }
    [[nodiscard]] const MotionState& motion() const { return motion_; }
    [[nodiscard]] const Mapper& mapper(int device) const;
    /// Largest lag of mapping and filter together, seconds; limits of speed and acceleration are not counted.
    [[nodiscard]] double worst_lag_s() const;

private:
    struct Device {
        Mapper mapper;
        std::size_t controls = 0;
        DeviceState newest;
        bool ticked = true;  ///< nothing was asked since the last tick
    };
    [[nodiscard]] std::int64_t age_limit_ns(std::size_t device) const;

    MotionLimits motion_limits_;
    SafetyLimits safety_limits_;
    MotionState motion_;
    SafetyState safety_;
    std::vector<Device> devices_;  ///< max_devices of them
    std::array<Source, max_devices> sources_{};
};

}  // namespace surefoot::input
