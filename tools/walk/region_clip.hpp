// Regions of poses end at walls, so that nothing is prepared for a place that no walker gets to.
#pragma once

#include "render/model/ground/walker.hpp"
#include "tools/walk/prepare_thread.hpp"

namespace surefoot::walk {

/// Clips regions of poses by walls. For the thread that prepares; the constructor allocates, clip() does not.
class RegionClip {
public:
    /// The ground must outlive this.
    RegionClip(const model::Ground& ground, const model::Body& body) : walker_(ground, body) {}
    /// No pose of a region on foot lies beyond a wall then; what is seen from there is not clipped. Where something may carry the
    /// walker, the region is larger by that: walls beside a lift do not stop it. Other regions stay as they are.
    void clip(PredictedRegion& predicted);

private:
    model::Walker walker_;
};

}  // namespace surefoot::walk
