// Random views and boxes (views.hpp). Drawn in one order by every compiler: never two in the arguments of one call.
#include "tools/selftest/views.hpp"

#include <cmath>

#include "render/model/pixels.hpp"
#include "tools/selftest/separating.hpp"

namespace surefoot::selftest {

namespace {

constexpr double pi = 3.141592653589793;

}  // namespace

dquat any_turn(Random& random) {
    const dquat q{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
    return glm::length(q) > 1e-3 ? glm::normalize(q) : dquat(1, 0, 0, 0);
}

Pose any_pose(Random& random, double reach_m) {
    Pose pose;
    pose.position = {random.range(-reach_m, reach_m), random.range(-reach_m, reach_m), random.range(-reach_m, reach_m)};
    pose.orientation = any_turn(random);
    pose.fov_y_rad =
        random.below(4) == 0 ? (random.below(2) == 0 ? pi / 180 : 179 * pi / 180) : random.range(pi / 180, 179 * pi / 180);
    return pose;
}

Box any_box(Random& random) {
    const double size = std::pow(10.0, random.range(-3, 6)), reach = std::pow(10.0, random.range(-1, 4));
    dvec3 half{random.range(0, size), random.range(0, size), random.range(0, size)};
    if (random.below(8) == 0) half[static_cast<int>(random.below(3))] = 0;
    if (random.below(16) == 0) half = dvec3(0);
    const dvec3 centre{random.range(-reach, reach), random.range(-reach, reach), random.range(-reach, reach)};
    return {centre - half, centre + half};
}

std::vector<Placed> awkward_places(const model::Model& model, std::uint64_t max_places) {
    std::vector<Placed> places;
    Random random(11);
    while (places.size() < max_places) {
        const model::Node& node = model.nodes[random.below(static_cast<std::uint32_t>(model.nodes.size()))];
        const dvec3 size = node.box.max - node.box.min;
        dvec3 at;
        for (int axis = 0; axis < 3; ++axis) {
            const std::array<double, 6> spots{0, 0.5, 1, random.unit(), -1e-9, 1 + 1e-9};
            at[axis] = node.box.min[axis] + spots[random.below(6)] * size[axis];
        }
        Placed placed{any_pose(random, 1), viewports[random.below(viewports.size())]};
        placed.pose.position = at;
        places.push_back(placed);
    }
    return places;
}

bool sound_view(const Pose& pose, model::Viewport viewport) {
    const mat4 p = model::projection(pose, viewport);
    bool fine = p[0][0] > 0 && p[1][1] > 0 && p[3][2] > 0;
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) fine = fine && std::isfinite(p[c][r]);
    const double angle = model::pixel_angle(pose, viewport);
    fine = fine && std::isfinite(angle) && angle > 0;
    for (const double turned : {0.0, 0.1}) {
        const model::ViewScale scale = model::make_view_scale(pose, viewport, turned);
        for (const float v : {scale.tan_half_x, scale.tan_half_y, scale.pixels_per_radian, scale.viewport_pixels})
            fine = fine && std::isfinite(v) && v > 0;
    }
    const model::Frustum frustum = model::make_frustum(pose, viewport, 1000, 1, 0.1);
    for (const dvec4& plane : frustum.planes) fine = fine && std::isfinite(plane.x + plane.y + plane.z + plane.w);
    for (const dvec3& corner : frustum.corners) fine = fine && std::isfinite(corner.x + corner.y + corner.z);
    return fine;
}

LeavesInView leaves_in_view(const model::Model& model, const select::Cut& cut, const Pose& pose, model::Viewport viewport) {
    LeavesInView leaves;
    std::vector<bool> shown(model.nodes.size(), false);
    for (const select::CutItem& item : cut.items) shown[item.node] = true;
    const Pyramid pyramid = pyramid_of(pose, viewport);
    for (model::Index n = 0; n < model.nodes.size(); ++n) {
        if (n > 0) shown[n] = shown[n] || shown[model.nodes[n].parent];
        if (model.nodes[n].child_count > 0 || !(overlap(pyramid, model.nodes[n].box) > touching)) continue;
        ++leaves.seen;
        leaves.lost += shown[n] ? 0 : 1;
    }
    return leaves;
}

}  // namespace surefoot::selftest
