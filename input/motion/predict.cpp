// Where the eye will be, and how surely.
#include <algorithm>
#include <cmath>

#include "input/motion/motion.hpp"

namespace surefoot::input {

namespace {

/// The most that a velocity can stray by time t, integrated: stopped at once and then driven off anywhere.
double strayed(double rate, double speed, double t) { return speed * t + 0.5 * rate * t * t; }

}  // namespace

Pose carried(const NavigationSample& sample, double by_s) {
    Pose pose = sample.pose;
    pose.position += sample.velocity_m_s * by_s;
    if (sample.zoom_rate != 0) pose.fov_y_rad = 2 * std::atan(std::tan(pose.fov_y_rad / 2) * std::exp(-sample.zoom_rate * by_s));
    const double turning = glm::length(sample.angular_rad_s);
    if (turning > 0) {
        const double half = 0.5 * turning * by_s;
        const dvec3 axis = sample.angular_rad_s * (std::sin(half) / turning);
        pose.orientation = glm::normalize(dquat(std::cos(half), axis.x, axis.y, axis.z) * pose.orientation);
    }
    return pose;
}

Prediction predict(const NavigationSample& sample, const MotionLimits& limits, double lead_s, double rise_m_s2) {
    const double t = std::clamp(std::isfinite(lead_s) ? lead_s : 0.0, 0.0, 1.0);
    const double speed = glm::length(sample.velocity_m_s - sample.carried_m_s);
    const double turning = glm::length(sample.angular_rad_s - dvec3(0, sample.carried_rad_s, 0));
    const double carried = glm::length(sample.carried_m_s) + sample.max_carried_m_s;
    const double carried_turning = std::abs(sample.carried_rad_s) + sample.max_carried_rad_s;
    Prediction ahead;
    ahead.pose = surefoot::input::carried(sample, t);
    const double accel_rad_s2 = limits.accel_rad_s2 + (sample.pointed ? limits.pointer_rad_s2 : 0);
    const double accel = limits.accel_m_s2 + rise_m_s2 + speed * (turning + carried_turning + 0.5 * accel_rad_s2 * t);
    ahead.uncertainty_m = strayed(accel, speed, t) + carried * t;
    // Heading and pitch turn one after the other, the prediction about one axis: they differ by half their product.
    const double max_turning = turning + carried_turning + accel_rad_s2 * t;
    ahead.uncertainty_rad = strayed(accel_rad_s2, turning, t) + 0.5 * max_turning * max_turning * t * t + carried_turning * t;
    // A side of the view lies at tan(a) = c e^-z, so a changes by sin(2 a) / 2 of what z does.
    if (sample.zoom_rate != 0) ahead.uncertainty_rad += 0.5 * strayed(zoom_accel_s2, std::abs(sample.zoom_rate), t);
    return ahead;
}

}  // namespace surefoot::input
