// Values between keys, and the keys of a motion (motion_tracks.hpp).
#include "render/import/motion_tracks.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::importer {
namespace {

constexpr int max_halvings = 12;  // of a spline's segment

dquat as_rotation(const dvec4& v) {
    const dquat q(v.w, v.x, v.y, v.z);
    const double length = glm::length(q);
    return length > 1e-12 ? q / length : dquat(1, 0, 0, 0);
}

dvec4 as_values(const dquat& q) { return {q.x, q.y, q.z, q.w}; }

double angle_between(const dquat& a, const dquat& b) {
    const dquat d = b * glm::conjugate(a);
    return 2 * std::atan2(glm::length(dvec3(d.x, d.y, d.z)), std::abs(d.w));
}

/// Within the segment that begins at `key`.
dvec4 in_segment(const Track& track, std::size_t key, double time_s, bool rotation) {
    const double begin = track.times[key], length = track.times[key + 1] - begin;
    if (track.between == Between::step || !(length > 0)) return track.value(key);
    const double s = std::clamp((time_s - begin) / length, 0.0, 1.0);
    if (track.between == Between::spline) {
        const double s2 = s * s, s3 = s2 * s;
        return (2 * s3 - 3 * s2 + 1) * track.value(key) + length * (s3 - 2 * s2 + s) * track.values[3 * key + 2] +
               (3 * s2 - 2 * s3) * track.value(key + 1) + length * (s3 - s2) * track.values[3 * (key + 1)];
    }
    if (rotation) return as_values(glm::slerp(as_rotation(track.value(key)), as_rotation(track.value(key + 1)), s));
    return glm::mix(track.value(key), track.value(key + 1), s);
}

/// `after`: of two values at one time the later one.
dvec4 value_at(const Track& track, double time_s, bool after, bool rotation) {
    const auto begin = track.times.begin(), end = track.times.end();
    const auto next = after ? std::upper_bound(begin, end, time_s) : std::lower_bound(begin, end, time_s);
    if (next == begin) return track.value(0);
    if (next == end) return track.value(track.times.size() - 1);
    return in_segment(track, static_cast<std::size_t>(next - begin) - 1, time_s, rotation);
}

NodePose pose_of(const NodeTracks& tracks, double time_s, bool after) {
    NodePose pose = tracks.rest;
    if (!tracks.translation.empty()) pose.translation = dvec3(value_at(tracks.translation, time_s, after, false));
    if (!tracks.rotation.empty()) pose.rotation = as_rotation(value_at(tracks.rotation, time_s, after, true));
    return pose;
}

double scale_of(const dmat4& parent) {
    return std::max({glm::length(dvec3(parent[0])), glm::length(dvec3(parent[1])), glm::length(dvec3(parent[2]))});
}

bool same_poses(const NodePose& a, const NodePose& b, double scale, double max_m, double max_rad) {
    return scale * glm::length(a.translation - b.translation) <= max_m && angle_between(a.rotation, b.rotation) <= max_rad;
}

/// All key times of the tracks within the animation, and its ends.
std::vector<double> times_of(const NodeTracks& tracks) {
    std::vector<double> times{tracks.from_s, tracks.to_s};
    for (const Track* track : {&tracks.translation, &tracks.rotation})
        for (const double t : track->times)
            if (t > tracks.from_s && t < tracks.to_s) times.push_back(t);
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

/// A pose of the node at a time of the animation.
struct TimedPose {
    double time_s = 0;
    NodePose pose;
};

/// Makes the poses between which a motion is straight.
class PoseList {
public:
    PoseList(const NodeTracks& tracks, std::size_t max_poses)
        : tracks_(tracks), scale_(scale_of(tracks.parent)), max_poses_(max_poses) {}

    std::vector<TimedPose> run() {
        const bool curved = tracks_.translation.between == Between::spline || tracks_.rotation.between == Between::spline;
        const std::vector<double> times = times_of(tracks_);
        for (std::size_t i = 0; i < times.size() && poses_.size() <= max_poses_; ++i) {
            const NodePose before = pose_of(tracks_, times[i], i == 0), after = pose_of(tracks_, times[i], true);
            if (curved && i > 0) cut_chord(poses_.back(), {times[i], before}, 0);
            poses_.push_back({times[i], before});
            if (!same_poses(before, after, 1, 0, 1e-9)) poses_.push_back({times[i], after});
        }
        return std::move(poses_);
    }

private:
    void cut_chord(const TimedPose& a, const TimedPose& b, int depth) {
        if (depth == max_halvings || poses_.size() > max_poses_) return;
        bool near = true;
        for (const double share : {0.25, 0.5, 0.75}) {
            const NodePose at = pose_of(tracks_, glm::mix(a.time_s, b.time_s, share), true);
            const NodePose chord{glm::mix(a.pose.translation, b.pose.translation, share),
                                 glm::slerp(a.pose.rotation, b.pose.rotation, share)};
            near = near && same_poses(at, chord, scale_, spline_tolerance_m, spline_tolerance_rad);
        }
        if (near) return;
        const double middle = 0.5 * (a.time_s + b.time_s);
        const TimedPose half{middle, pose_of(tracks_, middle, true)};
        cut_chord(a, half, depth + 1);
        poses_.push_back(half);
        cut_chord(half, b, depth + 1);
    }

    const NodeTracks& tracks_;
    double scale_;
    std::size_t max_poses_;
    std::vector<TimedPose> poses_;
};

/// A rotation in a frame that may be scaled and mirrored, as one in the world.
dquat in_world(const dmat3& frame, const dquat& rotation) {
    const dvec3 axis =
        glm::normalize(frame[0]) * rotation.x + glm::normalize(frame[1]) * rotation.y + glm::normalize(frame[2]) * rotation.z;
    const double side = glm::determinant(frame) < 0 ? -1 : 1;
    return {rotation.w, side * axis.x, side * axis.y, side * axis.z};
}

}  // namespace

bool keeps_angles(const dmat4& parent) {
    const dmat3 frame(parent);
    const double scale = scale_of(parent);
    bool even = scale > 0;
    for (int c = 0; c < 3; ++c) {
        even = even && glm::length(frame[c]) >= (1 - 1e-4) * scale;
        even = even && std::abs(glm::dot(frame[c], frame[(c + 1) % 3])) <= 1e-4 * scale * scale;
    }
    return even;
}

bool loops(const NodeTracks& tracks) {
    return same_poses(pose_of(tracks, tracks.from_s, true), pose_of(tracks, tracks.to_s, true), scale_of(tracks.parent),
                      same_pose_m, same_pose_rad);
}

bool stays(const NodeTracks& tracks) {
    const double scale = scale_of(tracks.parent);
    const std::vector<double> times = times_of(tracks);
    const bool curved = tracks.translation.between == Between::spline || tracks.rotation.between == Between::spline;
    const auto at_rest = [&](double t, bool after) {
        return same_poses(pose_of(tracks, t, after), tracks.rest, scale, same_pose_m, same_pose_rad);
    };
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (!at_rest(times[i], false) || !at_rest(times[i], true)) return false;
        for (const double share : {0.25, 0.5, 0.75})
            if (curved && i > 0 && !at_rest(glm::mix(times[i - 1], times[i], share), true)) return false;
    }
    return true;
}

std::vector<model::MotionKey> keys_of(const NodeTracks& tracks, bool forth_and_back, std::size_t max_keys) {
    std::vector<TimedPose> poses = PoseList(tracks, max_keys).run();
    const double length = tracks.to_s - tracks.from_s;
    for (TimedPose& one : poses) one.time_s -= tracks.from_s;
    if (forth_and_back) {
        for (std::size_t i = poses.size() - 1; i-- > 0;) poses.push_back({2 * length - poses[i].time_s, poses[i].pose});
    }
    if (poses.size() > max_keys) return {};
    const dmat3 frame(tracks.parent);
    std::vector<model::MotionKey> keys;
    keys.reserve(poses.size());
    for (const TimedPose& one : poses) {
        const dquat turned = in_world(frame, one.pose.rotation * glm::conjugate(tracks.rest.rotation));
        const dquat q = glm::normalize(turned);
        keys.push_back({one.time_s,
                        frame * (one.pose.translation - tracks.rest.translation),
                        {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)}});
    }
    if (!forth_and_back) {  // no jump remains, however small
        const bool other_sign = glm::dot(poses.front().pose.rotation, poses.back().pose.rotation) < 0;
        keys.back().translation = keys.front().translation;
        for (std::size_t i = 0; i < 4; ++i) keys.back().rotation[i] = keys.front().rotation[i] * (other_sign ? -1.0F : 1.0F);
    }
    keys.front().time_s = 0;
    keys.back().time_s = forth_and_back ? 2 * length : length;
    return keys;
}

}  // namespace surefoot::importer
