// A region's centre is led along walls; its radius ends at the nearest one.
#include "tools/walk/region_clip.hpp"

#include <algorithm>

namespace surefoot::walk {

void RegionClip::clip(PredictedRegion& predicted) {
    if (!predicted.known || !predicted.on_foot) return;
    prepare::Region& region = predicted.region;
    const dvec3 unled = predicted.eye + predicted.way;
    const double wide_m = region.radius_m + glm::length(region.centre.position - unled);
    const model::Walker::Foreseen foreseen = walker_.foresee(predicted.feet, predicted.eye, predicted.way, wide_m);
    const double clear_m = foreseen.clear_m + predicted.carried_m;  // walls beside a lift stop nobody upwards or downwards
    region.radius_m = std::min(region.radius_m + glm::length(foreseen.eye - region.centre.position), clear_m);
    region.centre.position = foreseen.eye;
}

}  // namespace surefoot::walk
