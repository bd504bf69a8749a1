// From a few places to pass and things to look at to a smooth camera path, 30 samples a second.
#include "tools/scenes/path_maker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace surefoot::scenes {
namespace {

constexpr double samples_per_s = 30.0;
constexpr int steps_a_stretch = 64;

struct Place {
    dvec3 eye;
    double waypoint;  ///< 2.25: a quarter of the way from the third to the fourth
};

/// Barry and Goldman's pyramid for centripetal Catmull-Rom: no loops, no overshoot at uneven distances.
dvec3 spline(const dvec3& p0, const dvec3& p1, const dvec3& p2, const dvec3& p3, double u) {
    const auto gap = [](const dvec3& a, const dvec3& b) { return std::max(std::sqrt(glm::length(b - a)), 1e-4); };
    const double t0 = 0, t1 = t0 + gap(p0, p1), t2 = t1 + gap(p1, p2), t3 = t2 + gap(p2, p3);
    const double t = t1 + (t2 - t1) * u;
    const auto blend = [t](const dvec3& a, const dvec3& b, double ta, double tb) {
        return a * ((tb - t) / (tb - ta)) + b * ((t - ta) / (tb - ta));
    };
    const dvec3 a1 = blend(p0, p1, t0, t1), a2 = blend(p1, p2, t1, t2), a3 = blend(p2, p3, t2, t3);
    return blend(blend(a1, a2, t0, t2), blend(a2, a3, t1, t3), t1, t2);
}

std::vector<Place> dense_curve(std::span<const Waypoint> w) {
    std::vector<Place> curve;
    for (std::size_t i = 0; i + 1 < w.size(); ++i) {
        const dvec3 p1 = w[i].eye, p2 = w[i + 1].eye;
        const dvec3 p0 = i > 0 ? w[i - 1].eye : p1 - (p2 - p1), p3 = i + 2 < w.size() ? w[i + 2].eye : p2 + (p2 - p1);
        for (int k = 0; k < steps_a_stretch; ++k) {
            const double u = static_cast<double>(k) / steps_a_stretch;
            curve.push_back({spline(p0, p1, p2, p3, u), static_cast<double>(i) + u});
        }
    }
    curve.push_back({w.back().eye, static_cast<double>(w.size() - 1)});
    return curve;
}

/// Times at which the dense points are passed, pauses included.
std::vector<double> times_of(const std::vector<Place>& curve, std::span<const Waypoint> w, double duration_s) {
    std::vector<double> efforts(curve.size(), 0.0);  // metres, longer where the pace is slower
    double total = 0, pauses = 0;
    for (std::size_t i = 1; i < curve.size(); ++i) {
        efforts[i] = glm::length(curve[i].eye - curve[i - 1].eye) / w[(i - 1) / steps_a_stretch].pace;
        total += efforts[i];
    }
    for (const Waypoint& point : w) pauses += point.pause_s;
    const double speed = total / std::max(duration_s - pauses, 0.1 * duration_s);
    std::vector<double> times(curve.size(), 0.0);
    double now = 0;
    for (std::size_t i = 0; i < curve.size(); ++i) {
        now += efforts[i] / speed;
        times[i] = now;
        if (i % steps_a_stretch == 0) now += w[i / steps_a_stretch].pause_s;
    }
    return times;
}

/// Gaussian over time, reflected at the ends. Even steps: sums in a fixed order.
template <class T>
std::vector<T> smooth(const std::vector<T>& in, double sigma_s) {
    const int reach = static_cast<int>(std::ceil(2.5 * sigma_s * samples_per_s));
    std::vector<double> weights;
    for (int k = -reach; k <= reach; ++k) weights.push_back(std::exp(-0.5 * std::pow(k / (sigma_s * samples_per_s), 2)));
    const int last = static_cast<int>(in.size()) - 1;
    std::vector<T> out(in.size());
    for (int i = 0; i <= last; ++i) {
        T sum(0);
        double total = 0;
        for (int k = -reach; k <= reach; ++k) {
            const int place = k + reach;
            const double weight = weights[static_cast<std::size_t>(place)];
            sum += weight * in[static_cast<std::size_t>(std::clamp(i + k, 0, last))];
            total += weight;
        }
        out[static_cast<std::size_t>(i)] = sum / total;
    }
    return out;
}

/// Where the eye is at each sample, and between which waypoints.
std::vector<Place> walk(const std::vector<Place>& curve, const std::vector<double>& times, std::span<const Waypoint> w,
                        double duration_s) {
    std::vector<Place> out;
    const auto count = static_cast<std::size_t>(std::lround(duration_s * samples_per_s)) + 1;
    std::size_t at = 0;
    for (std::size_t s = 0; s < count; ++s) {
        const double t = std::min(static_cast<double>(s) / samples_per_s, times.back());
        while (at + 2 < curve.size() && times[at + 1] < t) ++at;
        const bool waits = at % steps_a_stretch == 0;  // a pause lies before this step
        const double start = waits ? times[at] + w[at / steps_a_stretch].pause_s : times[at];
        const double span = times[at + 1] - start;
        const double u = span > 0 ? std::clamp((t - start) / span, 0.0, 1.0) : 0.0;
        out.push_back({curve[at].eye + (curve[at + 1].eye - curve[at].eye) * u,
                       curve[at].waypoint + (curve[at + 1].waypoint - curve[at].waypoint) * u});
    }
    return out;
}

/// Heading (0: -z, grows to the left) and lift of a look, radians.
dvec2 angles_of(const dvec3& look) { return {std::atan2(-look.x, -look.z), std::atan2(look.y, std::hypot(look.x, look.z))}; }

double nearest_turn(double angle, double to) {
    return angle - 2 * std::numbers::pi * std::round((angle - to) / (2 * std::numbers::pi));
}

/// One looks where one will be in a second or so, or at what the waypoint names; from one to the next the head turns the
/// way that was shorter when it began. Headings are unwrapped, so that they can be smoothed.
std::vector<dvec2> gazes_of(const std::vector<Place>& places, const std::vector<dvec3>& eyes, std::span<const Waypoint> w) {
    constexpr auto look_ahead = static_cast<std::size_t>(1.2 * samples_per_s);
    std::vector<dvec2> out;
    dvec3 ahead(0, 0, -1);
    double turn = 0;
    std::size_t between = w.size();
    for (std::size_t s = 0; s < eyes.size(); ++s) {
        const dvec3 step = eyes[std::min(s + look_ahead, eyes.size() - 1)] - eyes[s];
        if (glm::length(step) > 0.2) ahead = dvec3(step.x, 0.6 * step.y, step.z);
        const auto gaze = [&](std::size_t i) { return angles_of(w[i].ahead ? ahead : w[i].look - eyes[s]); };
        const auto i = std::min(static_cast<std::size_t>(places[s].waypoint), w.size() - 2);
        const dvec2 from = gaze(i), to = gaze(i + 1);
        turn = nearest_turn(to.x - from.x, i == between ? turn : 0.0);
        between = i;
        const double f = std::clamp(places[s].waypoint - static_cast<double>(i), 0.0, 1.0);
        const double eased = f * f * (3 - 2 * f);
        const double heading = from.x + turn * eased;
        out.emplace_back(out.empty() ? heading : nearest_turn(heading, out.back().x), from.y + (to.y - from.y) * eased);
    }
    return out;
}

}  // namespace

Path make_path(std::span<const Waypoint> waypoints, double duration_s, const std::function<double(double, double)>& ground) {
    const std::vector<Place> curve = dense_curve(waypoints);
    const std::vector<Place> places = walk(curve, times_of(curve, waypoints, duration_s), waypoints, duration_s);
    std::vector<dvec3> eyes;
    eyes.reserve(places.size());
    for (const Place& place : places) eyes.push_back(place.eye + dvec3(0, ground ? ground(place.eye.x, place.eye.z) : 0.0, 0));
    eyes = smooth(eyes, 0.3);
    const std::vector<dvec2> gazes = smooth(gazes_of(places, eyes, waypoints), 0.9);
    Path path;
    dquat before(1, 0, 0, 0);
    for (std::size_t i = 0; i < eyes.size(); ++i) {
        const dquat q = glm::angleAxis(gazes[i].x, dvec3(0, 1, 0)) * glm::angleAxis(gazes[i].y, dvec3(1, 0, 0));
        before = glm::dot(q, before) < 0 ? -q : q;
        path.samples.push_back({static_cast<double>(i) / samples_per_s, Pose{eyes[i], before, std::numbers::pi / 3}});
    }
    return path;
}

std::vector<dvec3> curve_points(std::span<const Waypoint> waypoints, double step_m) {
    std::vector<dvec3> out;
    for (const Place& place : dense_curve(waypoints)) {
        if (out.empty() || glm::length(place.eye - out.back()) >= step_m) out.push_back(place.eye);
    }
    return out;
}

}  // namespace surefoot::scenes
