// From the animated values of a node to the keys of a rigid motion: joined times, steps, and splines within a tolerance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/model/motion.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::importer {

/// How values between keys follow (glTF 2.0, appendix C).
enum class Between : std::uint8_t { linear, step, spline };

/// One animated value of a node. Times do not fall. A spline has three values a key: tangent in, value, tangent out.
struct Track {
    std::vector<double> times;
    std::vector<dvec4> values;  ///< finite; x, y, z, and w of rotations, which are unit but for tangents
    Between between = Between::linear;
    [[nodiscard]] bool empty() const { return times.empty(); }
    [[nodiscard]] const dvec4& value(std::size_t key) const { return values[between == Between::spline ? 3 * key + 1 : key]; }
};

/// A node's own place: no scale, which a motion leaves as it is.
struct NodePose {
    dvec3 translation{0.0};
    dquat rotation{1, 0, 0, 0};
};

/// What moves a node below a parent. A track that is empty leaves the value at rest.
struct NodeTracks {
    Track translation, rotation;
    NodePose rest;
    dmat4 parent{1.0};            ///< parent's frame to world, at rest
    double from_s = 0, to_s = 0;  ///< of the animation; to_s > from_s
};

/// Splines become chords that stay this near.
constexpr double spline_tolerance_m = 0.5e-3, spline_tolerance_rad = 0.8e-3;
/// First and last poses that differ by no more are taken as the same; so are a pose and rest.
constexpr double same_pose_m = 1e-3, same_pose_rad = 1.7e-3;

/// Whether the parent's frame keeps angles, so that a rotation in it is one in the world.
bool keeps_angles(const dmat4& parent);
/// Whether the last pose is the first one.
bool loops(const NodeTracks& tracks);
/// Whether all poses are that at rest.
bool stays(const NodeTracks& tracks);
/// The motion's keys in the world, about the node's place at rest. forth_and_back: then the same way back, in twice the time.
/// Empty: there would be more than max_keys.
std::vector<model::MotionKey> keys_of(const NodeTracks& tracks, bool forth_and_back, std::size_t max_keys);

}  // namespace surefoot::importer
