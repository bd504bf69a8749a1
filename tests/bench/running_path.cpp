// Writes the path that the image cache is judged on: 60 s of running, turning and jumping along another path. Every 10 s the eye
// jumps elsewhere, runs, turns once round on the spot, stands, and runs on while it looks aside.
// bench_running_path PATH.csv [SPEED_M_S 4] [LIFT_M 0] > RUN.csv
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "rt/base/path.hpp"
#include "rt/base/result.hpp"

namespace {

using namespace surefoot;

constexpr double part_s = 10, step_s = 1.0 / 60, jump_s = 1e-3;
constexpr double runs_until_s = 4, turns_until_s = 6, stands_until_s = 7;  // of a part
constexpr double looks_aside_rad = 0.6;
/// Where each part begins, as a share of the way: no two neighbours are near each other.
constexpr std::array<double, 6> begins = {0.0, 0.6, 0.15, 0.8, 0.35, 0.95};

/// Places of a path by the way to them.
class Way {
public:
    explicit Way(const Path& path) {
        for (const PathSample& sample : path.samples) {
            const double step = places_.empty() ? 0.0 : glm::length(sample.pose.position - places_.back());
            if (!places_.empty() && !(step > 1e-3)) continue;
            length_m_.push_back(length_m_.empty() ? 0.0 : length_m_.back() + step);
            places_.push_back(sample.pose.position);
        }
    }
    [[nodiscard]] double length_m() const { return length_m_.back(); }
    /// Forth and back, as often as it takes.
    [[nodiscard]] dvec3 at(double way_m) const {
        const double twice = std::fmod(std::abs(way_m), 2 * length_m());
        const double here = twice <= length_m() ? twice : 2 * length_m() - twice;
        const auto next = std::upper_bound(length_m_.begin() + 1, length_m_.end() - 1, here);
        const auto i = static_cast<std::size_t>(next - length_m_.begin());
        const double share = (here - length_m_[i - 1]) / (length_m_[i] - length_m_[i - 1]);
        return glm::mix(places_[i - 1], places_[i], std::clamp(share, 0.0, 1.0));
    }

private:
    std::vector<dvec3> places_;
    std::vector<double> length_m_;
};

/// How far a part has run after a time, and how far it has turned away from where it runs.
double run_m(double time_s, double speed_m_s) {
    return speed_m_s * (std::min(time_s, runs_until_s) + std::max(0.0, time_s - stands_until_s));
}
double turned_rad(double time_s) {
    const double turn = std::clamp((time_s - runs_until_s) / (turns_until_s - runs_until_s), 0.0, 1.0);
    const double aside = std::max(0.0, time_s - stands_until_s) / (part_s - stands_until_s);
    return 2 * std::numbers::pi * turn + looks_aside_rad * std::sin(2 * std::numbers::pi * aside);
}

Pose pose_at(const Way& way, double begin_m, double time_s, double speed_m_s) {
    const double here = begin_m + run_m(time_s, speed_m_s);
    Pose pose;
    pose.position = way.at(here);
    const dvec3 ahead = way.at(here + 0.5) - way.at(here);
    const double heading = std::hypot(ahead.x, ahead.z) > 1e-6 ? std::atan2(-ahead.x, -ahead.z) : 0.0;
    pose.orientation = glm::angleAxis(heading + turned_rad(time_s), dvec3(0, 1, 0));
    return pose;
}

}  // namespace

int main(int argc, char** argv) {
    const auto path = read_path(argc > 1 ? argv[1] : "");
    if (!path) return fmt::print(stderr, "{}\n", path.error().text()), 1;
    const Way way(*path);
    const double speed_m_s = argc > 2 ? std::atof(argv[2]) : 4, lift_m = argc > 3 ? std::atof(argv[3]) : 0;
    if (!(way.length_m() > 10) || !(speed_m_s > 0))
        return fmt::print(stderr, "bench_running_path: the path is shorter than 10 m, or the speed is no number above 0\n"), 1;
    fmt::print("# {:g} m/s along a path: running, turning, and jumping every {:g} s. bench_running_path has the plan.\n",
               speed_m_s, part_s);
    fmt::print("time_s,x,y,z,qx,qy,qz,qw,fov_y_deg\n");
    for (std::size_t part = 0; part < begins.size(); ++part) {
        const double begin_m = begins[part] * way.length_m();
        const bool is_last = part + 1 == begins.size();
        for (int i = 0; i * step_s <= part_s + 1e-9; ++i) {
            const double within_s =
                std::min(i * step_s, is_last ? part_s : part_s - jump_s);  // the next part begins right after it
            const Pose pose = pose_at(way, begin_m, within_s, speed_m_s);
            const dquat& q = pose.orientation;
            fmt::print("{:.4f},{:.4f},{:.4f},{:.4f},{:.7f},{:.7f},{:.7f},{:.7f},60\n",
                       static_cast<double>(part) * part_s + within_s, pose.position.x, pose.position.y + lift_m, pose.position.z,
                       q.x, q.y, q.z, q.w);
        }
    }
    return 0;
}
