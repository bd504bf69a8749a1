// Points of a scene, followed by calculation through the pictures that would show them. Bounds are compared with this.
#pragma once

#include <cstdint>
#include <vector>

#include "render/cache/update.hpp"
#include "tools/cache_study/study_scenes.hpp"

namespace surefoot::cache_study {

/// Where each picture shows points of its box: carried from plane to plane as pictures are drawn into pictures.
class TracedPoints {
public:
    /// Up to points_a_leaf points of the triangles in each leaf.
    explicit TracedPoints(const StudyScene& scene);
    static constexpr std::uint32_t points_a_leaf = 8;

    [[nodiscard]] std::size_t count() const { return points_.size(); }
    /// The pictures of the frame are made. Every frame once, in order.
    void follow(const cache::CachePlan& plan);
    /// Largest angle between a point and its image, of all points that the frame shows by pictures, rad.
    [[nodiscard]] double max_error_rad(const cache::CachePlan& plan, const dvec3& eye) const;

private:
    [[nodiscard]] dvec3& image(std::uint32_t point, std::uint32_t level) { return images_[std::size_t{point} * levels_ + level]; }

    const cache::BoxTree& tree_;
    std::uint32_t levels_ = 1;
    std::vector<dvec3> points_;
    std::vector<dvec3> images_;                              ///< one a point and level: on the picture of the box there
    std::vector<std::vector<std::uint32_t>> points_of_box_;  ///< of boxes of all levels
};

}  // namespace surefoot::cache_study
