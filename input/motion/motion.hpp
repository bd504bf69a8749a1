// From commands to poses: filter, limits of speed and acceleration, integration in double, prediction.
//
//   Command ─► One-Euro filter ─► speed limit ─► acceleration limit ─► [ground] ─► pose
//
// Pure functions of injected time: nothing here allocates, locks or reads a clock.
#pragma once

#include <cstdint>

#include "input/controls.hpp"
#include "input/motion/filter.hpp"
#include "input/motion/pointer_turn.hpp"

namespace surefoot::input {

/// What things that move did with the eye in a step of a Ground, and at most do in the next ones.
struct Carried {
    dvec3 way{0.0};       ///< of the step's way; world
    double turn_rad = 0;  ///< by which the walker turns to the left with its floor
    double max_m_s = 0, max_rad_s = 0;
};

/// Collision with walls, floors and stairs: returns where a step may end. `context` belongs to the caller. Must not throw or
/// allocate. The answer may be nearer or aside; it is shortened to the wanted length. A non-finite answer holds the eye where it
/// is. One that walks (rise_m_s2 > 0) also moves the eye up and down, is asked at every step, and for level moves only. Its
/// answers are taken as they are: it may put a walker elsewhere. Whoever hands it in makes a jump of that.
struct Ground {
    using Query = dvec3 (*)(void* context, const dvec3& from, const dvec3& wanted, double dt_s) noexcept;
    Query query = nullptr;
    void* context = nullptr;
    double rise_m_s2 = 0;                            ///< largest acceleration that it gives to the eye, which may stop at once
    void (*halt)(void* context) noexcept = nullptr;  ///< a stop: what falls or rises does so no more
    Carried (*carried)(void* context) noexcept = nullptr;  ///< of the last query; null: nothing moves
    [[nodiscard]] bool walks() const { return query != nullptr && rise_m_s2 > 0; }
};

/// Speeds, accelerations and limits of the walker.
struct MotionLimits {
    double walk_m_s = 1.4;               ///< at full deflection with speed 0
    double slowest = 0.25, fastest = 4;  ///< factors at speed -1 and 1; geometric in between
    double max_m_s = 6;                  ///< never exceeded
    double accel_m_s2 = 8;               ///< of the velocity in the walker's frame
    double turn_rad_s = 1.2, look_rad_s = 0.9;
    double accel_rad_s2 = 8;
    double pointer_rad_s = 8, pointer_rad_s2 = 40;  ///< of turns by a pointer, beside those
    double max_pitch_rad = 1.48;
    double max_zoom = 8;        ///< largest magnification; 1: there is no zoom
    double zoom_per_s = 2;      ///< the magnification's factor in a second of full request
    double brake_s = 0.03;      ///< Order::brake reaches its request within this, from any speed
    bool level = false;         ///< true: forward is level however the eye looks; false: along the eye's -Z
    double frame_s = 1.0 / 30;  ///< how far ahead a sample's uncertainty is stated
    FilterSettings filter;
};
/// Maximum time integrated in one step: after a stall the walk continues without a leap.
constexpr double longest_step_s = 0.05;
/// Acceleration of the magnification's natural logarithm, 1/s2.
constexpr double zoom_accel_s2 = 4;

/// An angle summed with compensation (Kahan 1965), so that horizon and heading do not drift in hours.
struct Angle {
    double value = 0, carry = 0;  ///< the true sum is value - carry
    void add(double increment);
    void wrap();  ///< into -pi..pi, by 2 pi in double-double
    void set(double to) { value = to, carry = 0; }
};

/// State of the walker between two steps.
struct MotionState {
    dvec3 position{0.0};
    Angle yaw, pitch;                     ///< yaw > 0 to the left, pitch > 0 upwards
    double roll = 0;                      ///< of the pose it was placed with; nothing here changes it
    double fov_y_rad = Pose{}.fov_y_rad;  ///< of magnification 1
    double zoom = 0, zoom_rate = 0;       ///< natural logarithm of the magnification, and its rate, 1/s
    dvec3 velocity{0.0};                  ///< walker's frame: right, up, back; m/s
    double rise_m_s = 0;                  ///< upwards, by the ground
    Carried carried;                      ///< in the last step
    double carried_s = 0;                 ///< how long that was
    dvec2 rates{0.0};                     ///< yaw, pitch; rad/s
    OneEuro<dvec3> walk;
    OneEuro<dvec2> turning;
    PointerTurn pointer;
    std::int64_t last_ns = -1;
    std::int64_t pointed_ns = -1;  ///< when a pointer last moved
    std::uint64_t sequence = 0;
    PressCounts presses;
    std::uint64_t refused = 0;     ///< non-finite commands or ground answers; taken as rest
    std::uint64_t clock_back = 0;  ///< steps with a time before the last one; time stood still
};

/// Moves the eye to a pose, at rest. `zooms`: its field of view is a magnified one of before; else that of magnification 1.
/// False: the pose is not finite, and nothing changed.
bool place(MotionState& state, const Pose& pose, bool zooms = false);
[[nodiscard]] Pose pose_of(const MotionState& state);

/// One step to `now_ns`. The rate of steps may vary. The first step only sets the time.
NavigationSample step(MotionState& state, const MotionLimits& limits, const Command& command, std::int64_t now_ns,
                      const Ground& ground = {});

/// A predicted pose, with the bound of its error.
struct Prediction {
    Pose pose;
    double uncertainty_m = 0, uncertainty_rad = 0;
};
/// The sample's pose, that much later at the same rates; earlier where negative.
Pose carried(const NavigationSample& sample, double by_s);

/// The pose `lead_s` after the sample if the hand stays as it is. Its uncertainty bounds the distance to any pose that the limits
/// allow then. The bound covers a stop at any moment, by order or by a wall, and a new start in any direction. It holds for every
/// input and order, except `brake` towards a moving request and the first moment of a zoom and of a pointer's turn. `rise_m_s2`:
/// that of the Ground. The bound: |v(s) - v0| <= |v0| + A s, integrated over the lead t, with A = a + |v0| (|w0| + alpha t / 2),
/// as the walker's frame turns. What carries the eye may stop at once, or begin: that adds |c0| t + c_max t, and the same to
/// turns.
Prediction predict(const NavigationSample& sample, const MotionLimits& limits, double lead_s, double rise_m_s2 = 0);

}  // namespace surefoot::input
