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
    double radius_m = std::min(region.radius_m + glm::length(foreseen.eye - region.centre.position), foreseen.clear_m);
    if (predicted.carried_m > 0) {  // a lift leaves walls below, and others above
        for (const double rise_m : {-predicted.carried_m, predicted.carried_m}) {
            const dvec3 rise(0, rise_m, 0);
            const model::Walker::Foreseen there = walker_.foresee(predicted.feet + rise, predicted.eye, predicted.way, wide_m);
            radius_m = std::max(radius_m, there.clear_m + glm::length(there.eye - foreseen.eye));
        }
        radius_m = std::min(std::max(radius_m, predicted.carried_m),
                            region.radius_m + glm::length(foreseen.eye - region.centre.position));
    }
    region.radius_m = radius_m;
    region.centre.position = foreseen.eye;
}

}  // namespace surefoot::walk
