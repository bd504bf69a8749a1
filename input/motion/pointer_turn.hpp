// Turns by a pointer: exactly as far as it was moved, and smoothly, within limits of rate and acceleration.
#pragma once

#include <algorithm>
#include <cmath>

#include "rt/base/geometry.hpp"

namespace surefoot::input {

/// Follows the displacements of a pointer, unless they are faster than the largest rate for long. x: yaw, y: pitch.
struct PointerTurn {
    dvec2 owed{0.0};   ///< not turned yet, rad
    dvec2 rates{0.0};  ///< rad/s

    static constexpr double follow_s = 0.03;         ///< time constant of small turns
    static constexpr double rest_within_rad = 2e-4;  ///< less is turned at once: a low pass alone would creep for ever

    static constexpr double max_owed_rad = 3;  ///< a hand faster than the largest rate is not followed for ever

    void add(const dvec2& displacement) {
        owed += displacement;
        if (const double length = glm::length(owed); length > max_owed_rad) owed *= max_owed_rad / length;
    }
    [[nodiscard]] bool moves() const { return owed != dvec2(0.0) || rates != dvec2(0.0); }
    void rest() { owed = rates = dvec2(0.0); }

    /// What is turned in this step, rad. The rate follows what is owed, and is small enough to end there without turning back.
    dvec2 step(double max_rad_s, double accel_rad_s2, double dt_s) {
        if (!moves() || dt_s <= 0) return dvec2(0.0);
        const double left = glm::length(owed);
        const double wanted = std::min({left / follow_s, std::sqrt(accel_rad_s2 * left), max_rad_s});
        const dvec2 target = left > 0 ? owed * (wanted / left) : dvec2(0.0);
        const dvec2 way = target - rates;
        const double length = glm::length(way), max_step = accel_rad_s2 * dt_s;
        const dvec2 before = rates;
        rates = length <= max_step ? target : rates + way * (max_step / length);
        dvec2 turned = 0.5 * (before + rates) * dt_s;
        if (left <= rest_within_rad && glm::length(rates) <= rest_within_rad / follow_s + max_step) {
            turned = owed;
            rest();
        } else if (left > 0 && glm::dot(turned, owed) > left * left) {  // a long step would turn too far
            turned = owed;
            owed = dvec2(0.0);
        } else {
            owed -= turned;
        }
        return turned;
    }
};

}  // namespace surefoot::input
