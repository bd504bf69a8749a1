// The adapter of the walker.
#include "tools/walk/walking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/model/ground/near.hpp"
#include "render/model/model.hpp"
#include "tools/walk/tour_controller.hpp"

namespace surefoot::walk {

Walking::Walking(const model::Ground& ground, const model::Body& body, rt::WalkingMode mode, const model::Model* moving)
    : mode_(mode) {
    if (mode == rt::WalkingMode::fly) return;
    if (moving != nullptr && !moving->moving_ground.empty())
        walker_.emplace(*moving, body);
    else if (!ground.empty())
        walker_.emplace(ground, body);
}

input::Ground Walking::ground(bool flies, double time_s) {
    walks_ = walker_ && !(flies && mode_ == rt::WalkingMode::automatic);
    if (!walks_) return {};
    walked_ = true;
    walker_->set_time(time_s);
    const auto query = [](void* walker, const dvec3& from, const dvec3& wanted, double dt_s) noexcept {
        return static_cast<model::Walker*>(walker)->walk(from, wanted, dt_s);
    };
    const auto halt = [](void* context) noexcept { static_cast<model::Walker*>(context)->halt(); };
    const auto carried = [](void* context) noexcept {
        const model::Walker::Ride& ride = static_cast<model::Walker*>(context)->ride();
        return input::Carried{ride.way, ride.turn_rad, ride.max_m_s, ride.max_turn_rad_s};
    };
    return {query, &*walker_, walker_rise_m_s2, halt, carried};
}

std::uint32_t Walking::jumps() const {
    return walker_ ? static_cast<std::uint32_t>(walker_->returns() + walker_->freed() + walker_->put_aside()) : 0;
}

namespace {

constexpr double head_m = 0.1, piece_m = 1;  // pieces keep the boxes of long ways small

bool crosses(const model::Ground& ground, const dvec3& from, const dvec3& to) {
    const int pieces = static_cast<int>(std::clamp(std::ceil(glm::length(to - from) / piece_m), 1.0, 1000.0));
    const dvec3 way = (to - from) / static_cast<double>(pieces);
    bool crosses = false;
    for (int i = 0; i < pieces && !crosses; ++i) {
        const dvec3 start = from + static_cast<double>(i) * way;
        Box box{start, start};
        box.grow(start + way);
        model::for_triangles_near(ground, box, [&](const model::GroundTriangle& t) {
            crosses = crosses || model::crossing_of(start, way, t).share <= 1;
        });
    }
    return crosses;
}

bool in_wall(const model::Ground& ground, const dvec3& eye) {
    bool inside = false;
    model::for_triangles_near(ground, {eye - head_m, eye + head_m}, [&](const model::GroundTriangle& t) {
        inside = inside || model::separation({eye, 0, head_m}, t).distance < head_m;
    });
    return inside;
}

}  // namespace

std::string path_warning(const model::Ground& ground, const Path& path) {
    std::size_t walls = 0;
    double first_s = 0;
    for (std::size_t i = 1; i < path.samples.size(); ++i) {
        if (!crosses(ground, path.samples[i - 1].pose.position, path.samples[i].pose.position)) continue;
        if (walls++ == 0) first_s = path.samples[i].time_s - path.samples[0].time_s;
    }
    std::string viewpoints;
    for (int i = 0; i < viewpoint_count; ++i) {
        if (!in_wall(ground, sample_path(path, path.duration_s() * i / viewpoint_count).position)) continue;
        viewpoints += fmt::format("{}{}", viewpoints.empty() ? "" : ", ", i + 1);
    }
    std::string text;
    if (walls > 0)
        text = fmt::format("The path leads through walls or floors {}, first after {:.1f} s.",
                           walls == 1 ? "once" : fmt::format("{} times", walls), first_s);
    if (!viewpoints.empty())
        text += fmt::format("{}Viewpoints in a wall: {}. Who walks on from there is put beside it.", text.empty() ? "" : " ",
                            viewpoints);
    return text;
}

}  // namespace surefoot::walk
