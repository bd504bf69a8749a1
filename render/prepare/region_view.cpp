// The view that a prepared frame has of its region: from the frame and the options to RegionView.
#include <algorithm>
#include <cmath>

#include "render/prepare/evaluate.hpp"

namespace surefoot::prepare {

Region cleaned(const Region& region, const Box& root) {
    Region r = region;
    const dvec3& p = r.centre.position;
    if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)))
        r.centre.position = root.empty() ? dvec3(0.0) : root.centre();
    const dquat& q = r.centre.orientation;
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    r.centre.orientation = std::isfinite(length) && length > 1e-9 ? q / length : dquat(1.0, 0.0, 0.0, 0.0);
    r.centre.fov_y_rad = finite_or(r.centre.fov_y_rad, Pose{}.fov_y_rad);
    r.radius_m = std::clamp(finite_or(r.radius_m, 0.0), 0.0, 1e9);
    r.angle_rad = std::clamp(finite_or(r.angle_rad, 0.0), 0.0, 3.2);
    return r;
}

RegionView region_view(const PreparedFrame& frame, const PrepareOptions& options, float target_factor, double speed_mps,
                       double turn_rps) {
    const Region& region = frame.region;
    const model::Viewport& viewport = frame.viewport;
    const float resolution = frame.resolution;
    const Pose& pose = region.centre;
    RegionView view;
    view.eye = pose.position;
    view.radius_m = region.radius_m;
    view.scale = model::scaled(model::make_view_scale(pose, viewport), resolution);
    view.wide = model::make_view_scale(pose, viewport, region.angle_rad);
    view.resolved_rad = static_cast<float>(resolved_rad(frame));
    const double drawn_rad = double{static_cast<float>(model::pixel_angle(pose, viewport))} / resolution;
    const double target =
        options.target_error_rad > 0.0 ? options.target_error_rad : std::max(0.125 * drawn_rad, frame.acuity_rad);
    view.target_error_rad = static_cast<float>(target) * target_factor;
    view.full_depth = options.full_depth;
    view.without = frame.without;
    view.full_factor = frame.full_factor;
    view.coarse_factor = frame.coarse_factor;
    view.focus_strength = static_cast<float>(std::clamp(finite_or(options.focus_strength, 0.0), 0.0, 1.0));
    view.speed_mps = static_cast<float>(std::clamp(finite_or(speed_mps, 0.0), 0.0, 1e4));
    view.turn_rps = static_cast<float>(std::clamp(finite_or(turn_rps, 0.0), 0.0, 1e3));
    return view;
}

}  // namespace surefoot::prepare
