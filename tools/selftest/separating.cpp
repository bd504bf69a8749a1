// Separating axes of a box and a pyramid without end. Source: Gottschalk, Lin & Manocha 1996 (OBBTree), for a pyramid.
#include "tools/selftest/separating.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::selftest {

Pyramid pyramid_of(const Pose& pose, model::Viewport viewport) {
    const mat4 projection = model::projection(pose, viewport);
    Pyramid p;
    p.eye = pose.position;
    p.right = pose.right();
    p.up = pose.up();
    p.forward = pose.forward();
    p.tan_x = 1.0 / static_cast<double>(projection[0][0]);
    p.tan_y = 1.0 / static_cast<double>(projection[1][1]);
    p.middle_x = static_cast<double>(projection[2][0]) * p.tan_x;
    p.middle_y = static_cast<double>(projection[2][1]) * p.tan_y;
    return p;
}

double overlap(const Pyramid& pyramid, const Box& box) {
    const dvec3 centre = box.centre() - pyramid.eye, half = box.half();
    const double scale = glm::length(centre) + glm::length(half) + pyramid.near_m;
    std::array<dvec3, 4> edges;
    for (std::size_t i = 0; i < 4; ++i)
        edges[i] = pyramid.forward + (pyramid.middle_x + ((i & 1U) != 0 ? 1.0 : -1.0) * pyramid.tan_x) * pyramid.right +
                   (pyramid.middle_y + ((i & 2U) != 0 ? 1.0 : -1.0) * pyramid.tan_y) * pyramid.up;
    double best = std::numeric_limits<double>::infinity();
    const auto try_axis = [&](const dvec3& axis) {
        const double length = glm::length(axis);
        if (!(length > 1e-9)) return;  // two parallel edges: no axis of its own
        const dvec3 a = axis / length;
        const double middle = glm::dot(a, centre), reach = glm::dot(glm::abs(a), half);
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const dvec3& edge : edges) {
            const double along = glm::dot(a, edge), at_near = pyramid.near_m * along;
            const double none = 1e-12 * glm::length(edge);  // an edge in the plane of the axis, but for rounding
            low = std::min(low, along < -none ? -std::numeric_limits<double>::infinity() : at_near);
            high = std::max(high, along > none ? std::numeric_limits<double>::infinity() : at_near);
        }
        best = std::min(best, std::min(high - (middle - reach), (middle + reach) - low) / scale);
    };
    for (const dvec3& axis : {dvec3(1, 0, 0), dvec3(0, 1, 0), dvec3(0, 0, 1)}) {
        try_axis(axis);
        try_axis(glm::cross(axis, pyramid.right));
        try_axis(glm::cross(axis, pyramid.up));
        for (const dvec3& edge : edges) try_axis(glm::cross(axis, edge));
    }
    try_axis(pyramid.forward);
    for (const double side : {-1.0, 1.0}) {
        try_axis(side * pyramid.right + (pyramid.tan_x - side * pyramid.middle_x) * pyramid.forward);
        try_axis(side * pyramid.up + (pyramid.tan_y - side * pyramid.middle_y) * pyramid.forward);
    }
    return best;
}

}  // namespace surefoot::selftest
