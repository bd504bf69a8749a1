// What the files of the walker share; used by them only.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "render/model/ground/near.hpp"
#include "render/model/ground/walker.hpp"

namespace surefoot::model {

namespace walker_parts {

constexpr double skin_m = 1e-3;         ///< walls keep this much more off than the radius
constexpr double deep_m = 1e7;          ///< below every floor
constexpr double step_slack_m = 0.01;   ///< a step of exactly step_m is climbed
constexpr double max_overlap_m = 0.01;  ///< of a body that is free
constexpr double max_lag_m = 0.8;       ///< the eye behind the feet, climbing
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A level way of length 1; turn: 0..1, from +x towards +z.
inline dvec3 direction(double turn) {
    const double angle = 2 * std::numbers::pi * turn;
    return {std::cos(angle), 0, std::sin(angle)};
}

/// What a capsule touches on its way lies in it.
inline Box swept(const Capsule& capsule, const dvec3& move) {
    Box box{capsule.low - capsule.radius, capsule.low + capsule.radius};
    box.max.y += capsule.length;
    box.grow(Box{box.min + move, box.max + move});
    return box;
}

}  // namespace walker_parts

/// From the gathered triangles where they hold all of the box, else from the tree: the same ones.
template <class Use>
void Walker::for_still(const Box& box, const Use& use) const {
    if (!near_.holds(box)) return for_triangles_near(ground_, box, use);
    near_.for_triangles(box, [&](const GroundTriangle& t, const NearBlocks::Known&) {
        if (ground_tree::overlap(box, ground_tree::box_of(t))) use(t);
    });
}

/// Those that move too, as they stand now.
template <class Use>
void Walker::for_near(const Box& box, const Use& use) const {
    for_still(box, use);
    moving_.for_triangles(box, [&](const GroundTriangle& t, std::uint32_t) { use(t); });
}

}  // namespace surefoot::model
