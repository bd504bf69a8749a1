// Random views and boxes (views.hpp). Drawn in one order by every compiler: never two in the arguments of one call.
#include "tools/selftest/views.hpp"

#include <cmath>

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

std::vector<Placed> awkward_places(const model::Model& model, std::uint64_t most) {
    std::vector<Placed> places;
    Random random(11);
    while (places.size() < most) {
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

}  // namespace surefoot::selftest
