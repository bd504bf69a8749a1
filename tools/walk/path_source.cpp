// Where a walk's path comes from: the requested file, the one beside the model, the model's own, or one around its box.
#include "tools/walk/path_source.hpp"

#include <cmath>
#include <filesystem>
#include <numbers>

#include "config/seat.hpp"

namespace surefoot::walk {

namespace {

dquat looking_at(const dvec3& from, const dvec3& to) {
    const dvec3 forward = glm::normalize(to - from);
    const dvec3 right = glm::normalize(glm::cross(forward, dvec3(0, 1, 0)));
    return glm::normalize(glm::quat_cast(dmat3(right, glm::cross(right, forward), -forward)));
}

}  // namespace

Path generated_tour(const model::Model& model) {
    const Box& box = model.nodes[0].box;
    const dvec3 centre = box.centre();
    const dvec3 half = glm::max(box.half(), dvec3(0.05));
    const double radius = std::hypot(half.x, half.z);
    Path path;
    constexpr int steps = 160;
    for (int i = 0; i <= steps; ++i) {
        const double t = static_cast<double>(i) / steps;
        const double angle = 2.0 * std::numbers::pi * t * 1.25;
        const double reach = radius * (1.5 - 1.15 * t * t * (3.0 - 2.0 * t));
        PathSample sample;
        sample.time_s = 40.0 * t;
        sample.pose.position =
            centre + dvec3(std::cos(angle) * reach, half.y * (1.2 - 0.7 * t) + 0.1 * radius * (1.0 - t), std::sin(angle) * reach);
        sample.pose.orientation = looking_at(sample.pose.position, centre - dvec3(0, 0.3 * half.y, 0));
        path.samples.push_back(sample);
    }
    return path;
}

Pose random_pose(const Path& path, Random& random) {
    Pose pose = sample_path(path, random.range(0, path.duration_s()));
    const double right = random.range(-3, 3), up = random.range(-0.3, 1.5), back = random.range(-3, 3);
    pose.position += dvec3(right, up, back);
    const double yaw = random.range(-std::numbers::pi, std::numbers::pi), pitch = random.range(-0.3, 0.3);
    pose.orientation = glm::normalize(glm::angleAxis(yaw, dvec3(0, 1, 0)) * glm::angleAxis(pitch, dvec3(1, 0, 0)));
    return pose;
}

Result<ChosenPath> choose_path(const std::string& requested, const std::string& model_file, const model::Model& model,
                               double lift_m) {
    if (!(std::abs(lift_m) <= 1e7))
        return Error{"--lift", "The lift is not a height", "Give metres, for example 1.5", ErrorKind::misuse};
    ChosenPath chosen;
    std::string file = requested;
    if (file.empty()) {
        const std::string beside = std::filesystem::path(model_file).replace_extension(".path.csv").string();
        std::error_code ignored;
        if (std::filesystem::exists(beside, ignored)) file = beside;
    }
    if (requested.empty() && file.empty() && !model.tour.samples.empty()) {
        chosen.path = model.tour;
        chosen.source = "default path, " + model.tour_kind;
    } else if (file.empty() || requested == no_path) {
        chosen.path = generated_tour(model);
        chosen.source = "generated tour";
    } else {
        auto path = read_path(file);
        if (!path) return path.error();
        chosen.path = std::move(*path);
        chosen.source = file;
    }
    for (PathSample& sample : chosen.path.samples) sample.pose.position.y += lift_m;
    return chosen;
}

void apply_seat(const config::Settings& settings, Path& path) {
    const auto seat = config::seat_of(settings);
    if (!seat) return;
    for (PathSample& sample : path.samples) sample.pose.fov_y_rad = seat->fov_y_rad;
}

}  // namespace surefoot::walk
