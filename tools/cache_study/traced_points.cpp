// Follows points through pictures. Shares no formula with the bounds that it is compared with.
#include "tools/cache_study/traced_points.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::cache_study {

namespace {

/// Where the ray from the picture's eye through a point meets its plane.
dvec3 on_plane(const cache::Picture& picture, const dvec3& point) {
    const dvec3 ray = point - picture.eye;
    return picture.eye + ray * (picture.plane_m / glm::dot(ray, picture.forward));
}

double angle_between_rad(const dvec3& a, const dvec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

}  // namespace

TracedPoints::TracedPoints(const StudyScene& scene) : tree_(scene.tree), points_of_box_(scene.tree.boxes.size()) {
    for (cache::Index leaf = 0; leaf < tree_.boxes.size(); ++leaf) {
        const cache::CacheBox& box = tree_.boxes[leaf];
        levels_ = std::max(levels_, box.level + 1);
        if (box.child_count > 0) continue;
        const std::uint32_t every = box.primitive_count / points_a_leaf + 1;
        for (std::uint32_t i = 0; i < box.primitive_count; i += every) {
            const cache::Triangle& triangle = scene.triangles[tree_.primitives[box.first_primitive + i]];
            const auto inside = std::find_if(triangle.begin(), triangle.end(),
                                             [&](const dvec3& corner) { return box.box.distance(corner) == 0; });
            if (inside == triangle.end()) continue;
            const auto point = static_cast<std::uint32_t>(points_.size());
            points_.push_back(*inside);
            for (cache::Index above = leaf; above != cache::none; above = tree_.boxes[above].parent)
                points_of_box_[above].push_back(point);
        }
    }
    images_.resize(points_.size() * levels_);
}

void TracedPoints::follow(const cache::CachePlan& plan) {
    for (const cache::Refresh& refresh : plan.refreshes) {
        const cache::Picture& picture = plan.after.pictures[refresh.box];
        const std::uint32_t level = tree_.boxes[refresh.box].level;
        for (const std::uint32_t point : points_of_box_[refresh.box])
            image(point, level) = on_plane(picture, refresh.from_children ? image(point, level + 1) : points_[point]);
    }
}

double TracedPoints::max_error_rad(const cache::CachePlan& plan, const dvec3& eye) const {
    double max = 0;
    for (const cache::BoxDraw& draw : plan.draws) {
        if (!draw.picture) continue;
        const std::uint32_t level = tree_.boxes[draw.box].level;
        for (const std::uint32_t point : points_of_box_[draw.box]) {
            const dvec3& shown = images_[std::size_t{point} * levels_ + level];
            max = std::max(max, angle_between_rad(points_[point] - eye, shown - eye));
        }
    }
    return max;
}

}  // namespace surefoot::cache_study
