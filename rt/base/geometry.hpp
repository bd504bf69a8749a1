// Vectors, boxes and poses: double in the world, float only relative to the eye.
// Right-handed, +Y up, metres; a camera looks along its local -Z.
#pragma once

#include <limits>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace surefoot {

using glm::dmat3;
using glm::dmat4;
using glm::dquat;
using glm::dvec2;
using glm::dvec3;
using glm::dvec4;
using glm::mat3;
using glm::mat4;
using glm::vec2;
using glm::vec3;
using glm::vec4;

/// Turns normals as `linear` turns surfaces, also where it shears or mirrors. No inverse of what may be singular is taken.
template <class Matrix>
[[nodiscard]] Matrix cofactors(const Matrix& linear) {
    return {glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1])};
}

/// Axis-aligned box; empty when min > max on any axis.
struct Box {
    dvec3 min{std::numeric_limits<double>::infinity()};
    dvec3 max{-std::numeric_limits<double>::infinity()};

    [[nodiscard]] bool empty() const { return min.x > max.x || min.y > max.y || min.z > max.z; }
    [[nodiscard]] dvec3 centre() const { return 0.5 * (min + max); }
    [[nodiscard]] dvec3 half() const { return 0.5 * (max - min); }
    [[nodiscard]] double diagonal() const { return empty() ? 0.0 : glm::length(max - min); }
    void grow(const dvec3& p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
    void grow(const Box& b) {
        min = glm::min(min, b.min);
        max = glm::max(max, b.max);
    }
    [[nodiscard]] bool contains(const Box& b) const {
        return glm::all(glm::lessThanEqual(min, b.min)) && glm::all(glm::greaterThanEqual(max, b.max));
    }
    /// Distance from p to the box, 0 inside; metres.
    [[nodiscard]] double distance(const dvec3& p) const { return glm::length(glm::max(glm::max(min - p, p - max), dvec3(0.0))); }
};

/// Where the eye is and where it looks. Orientation is a unit quaternion, camera to world.
struct Pose {
    dvec3 position{0.0};
    dquat orientation{1.0, 0.0, 0.0, 0.0};  // w, x, y, z
    double fov_y_rad = 1.0471975511965976;  // 60 degrees

    [[nodiscard]] dvec3 forward() const { return orientation * dvec3(0.0, 0.0, -1.0); }
    [[nodiscard]] dvec3 up() const { return orientation * dvec3(0.0, 1.0, 0.0); }
    [[nodiscard]] dvec3 right() const { return orientation * dvec3(1.0, 0.0, 0.0); }
};

}  // namespace surefoot
