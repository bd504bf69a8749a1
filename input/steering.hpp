// The loop body of the input thread: reports in, navigation samples out. Joins map/, safety/ and motion/.
#pragma once

#include <cstdint>
#include <vector>

#include "input/controls.hpp"
#include "input/map/mapper.hpp"
#include "input/motion/motion.hpp"
#include "input/safety/safety.hpp"
#include "rt/base/thread_annotations.hpp"

namespace surefoot::input {

/// All members belong to the thread with the role `steers`. After the constructor nothing allocates, frees, locks or reads a
/// clock.
///
///   each wake-up:  for each readable device: read until nothing is left, report() each, then drained()
///                  then tick(): publish what it returns
class Steering {
public:
    /// The role of the input thread, or on the virtual clock of the frame thread. Before and after the walk, of the maker's
    /// thread.
    [[no_unique_address]] ThreadRole steers;

    Steering(const MotionLimits& motion, const SafetyLimits& safety, bool stop_latched = false);

    /// A device came. Returns its number, or -1 if max_devices are attached. It requests nothing until it was seen neutral.
    /// A returning device with a stop or dead-man must get its old number (`again`). While such a device is away, its stop holds
    /// the walk, and no other device gets its number. `mapper` is swapped with the number's former mapper, so that a caller that
    /// must not free memory can keep it.
    int attach(Mapper&& mapper, std::size_t controls, Reporting reporting, int again = -1) REQUIRES(steers);
    /// Unplugged, or its reader failed.
    void detach(int device) REQUIRES(steers);

    /// The device sends no more reports (end of a recording): from now on silence means rest.
    void ended(int device) REQUIRES(steers);

    /// One accepted report. The device counts as connected unless `state.connected` is false.
    void report(int device, const DeviceState& state, std::int64_t now_ns) REQUIRES(steers);
    /// After a drain that read until nothing was left: how many reports it read, and whether some were lost on the way.
    void drained(int device, std::uint32_t reports, bool lost = false) REQUIRES(steers);

    NavigationSample tick(const Lines& lines, std::int64_t now_ns, const Ground& ground = {}) REQUIRES(steers);

    bool place(const Pose& pose, bool zooms = false) REQUIRES(steers) { return surefoot::input::place(motion_, pose, zooms); }
    /// Whether the device that moved the eye last moves it freely in space (DeviceMapping::flies).
    [[nodiscard]] bool flies() const REQUIRES(steers) { return flies_; }
    [[nodiscard]] const SafetyState& safety() const REQUIRES(steers) { return safety_; }
    [[nodiscard]] const MotionState& motion() const REQUIRES(steers) { return motion_; }
    [[nodiscard]] const Mapper& mapper(int device) const REQUIRES(steers);
    /// Largest lag of mapping and filter together, seconds; limits of speed and acceleration are not counted.
    [[nodiscard]] double worst_lag_s() const REQUIRES(steers);

private:
    struct Device {
        Mapper mapper;
        std::size_t controls = 0;
        DeviceState newest;
        bool ticked = true;  ///< no report since the last tick
    };
    [[nodiscard]] std::int64_t age_limit_ns(std::size_t device) const REQUIRES(steers);

    MotionLimits motion_limits_;
    SafetyLimits safety_limits_;
    MotionState motion_ GUARDED_BY(steers);
    SafetyState safety_ GUARDED_BY(steers);
    std::vector<Device> devices_ GUARDED_BY(steers);  ///< max_devices of them
    std::array<Source, max_devices> sources_ GUARDED_BY(steers){};
    bool flies_ GUARDED_BY(steers) = false;
};

}  // namespace surefoot::input
