// Random views and boxes, as extreme as the numbers allow, and what must hold for each. For the rows that compare with an oracle.
#pragma once

#include <array>
#include <vector>

#include "render/model/model.hpp"
#include "render/model/view.hpp"
#include "render/select/select.hpp"
#include "rt/base/random.hpp"

namespace surefoot::selftest {

constexpr double touching = 1e-6;  ///< share of the sizes compared; the oracle reads its pyramid off a float matrix

constexpr std::array<model::Viewport, 6> viewports = {{{1280, 720}, {1, 1}, {8192, 1}, {1, 8192}, {640, 480}, {16384, 16384}}};

dquat any_turn(Random& random);
/// Fields of view from 1 to 179 degrees, one in four at one end.
Pose any_pose(Random& random, double reach_m);
/// From crumbs to boxes that hold the whole frustum, flat ones and points among them.
Box any_box(Random& random);

/// A view and a box in it.
struct Placed {
    Pose pose;
    model::Viewport viewport;
};

/// At what can divide by nothing: on faces, corners, centres and in the insides of the boxes of nodes.
std::vector<Placed> awkward_places(const model::Model& model, std::uint64_t max_places);

/// Every number that follows from the view, and from a region about it, is finite; sizes are positive.
bool sound_view(const Pose& pose, model::Viewport viewport);

/// Leaves that the exact test sees, and of them those that no item of the cut stands for.
struct LeavesInView {
    std::uint64_t seen = 0, lost = 0;
};
LeavesInView leaves_in_view(const model::Model& model, const select::Cut& cut, const Pose& pose, model::Viewport viewport);

}  // namespace surefoot::selftest
