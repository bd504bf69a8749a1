// What lies where the eye looks: boxes in view, and what is drawn after the pictures.
#include <algorithm>
#include <cmath>

#include "render/cache/in_view.hpp"
#include "render/cache/walk_cache.hpp"

namespace surefoot::cache {

WalkCache::Cone WalkCache::cone_of(const Box& box, const dvec3& eye) {
    const dvec3 to = box.centre() - eye;
    const double distance = glm::length(to), radius = 0.5 * box.diagonal();
    if (!(distance > radius)) return {{}, -1, 0, distance + radius};
    const double sin = radius / distance;
    return {to / distance, std::sqrt(1 - sin * sin), sin, distance + radius};
}

void WalkCache::look_from(const dvec3& eye) {
    for (std::size_t i = 0; i < blended_.size(); ++i) cones_[i] = cone_of(blended_[i], eye);
    cones_eye_ = eye;
}

/// Whether something blended may be seen through the box, from the eye of look_from().
bool WalkCache::before_blended(const Box& box) const {
    if (cones_.empty()) return false;
    const Cone of_box = cone_of(box, cones_eye_);
    const double near_m = of_box.far_m - box.diagonal();
    return std::any_of(cones_.begin(), cones_.end(), [&](const Cone& cone) {
        if (cone.far_m <= near_m) return false;
        return !(glm::dot(cone.direction, of_box.direction) < cone.cos * of_box.cos - cone.sin * of_box.sin) || cone.cos < 0;
    });
}

void WalkCache::find_in_view() {
    for (Index i = 0; i < in_view_.size(); ++i) {
        const CacheBox& box = boxes_.tree().boxes[i];
        const unsigned among = box.parent == none ? all_planes : planes_across_[box.parent];
        planes_across_[i] = static_cast<std::uint8_t>(planes_across(seen_, boxes_.filled(i), among));
        in_view_[i] = planes_across_[i] != out_of_view;
    }
}

}  // namespace surefoot::cache
