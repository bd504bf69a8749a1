// Estimates the rasterised pixels of a representation seen from a pose, from its box and areas alone. Sufficient far away; nearby
// it is a part of the estimate in pixel_estimator.hpp.
#pragma once

#include <array>

#include "render/model/model.hpp"
#include "render/model/view.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::model {

constexpr float max_pixels = 1e9F;  ///< a thousand layers of a megapixel; larger estimates are clamped

/// A view in the form that the estimates need, made once a frame. right, up, forward: unit vectors in world space.
/// across, rise: the same, sheared so that an off-axis image is symmetric about 0. p is in the image if
/// |across . p| <= tan_half_x * (forward . p) and |rise . p| <= tan_half_y * (forward . p).
struct ViewScale {
    vec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
    vec3 across{1, 0, 0}, rise{0, 1, 0};   ///< right and up, minus the image's centre times forward
    vec3 middle{0, 0, -1};                 ///< centre of the image at depth 1
    float tan_half_x = 1, tan_half_y = 1;  ///< half extents of the image at depth 1
    float pixels_per_radian = 1;           ///< in view direction
    float viewport_pixels = 1;             ///< width * height
    float near_m = static_cast<float>(near_plane_m);
};
/// angle_rad widens the view on each side, for a region of poses. Half angles are capped below 89 degrees.
ViewScale make_view_scale(const Pose& pose, Viewport viewport, double angle_rad = 0.0);

/// The same view in a picture of a lower resolution: a share of the width and height.
inline ViewScale scaled(ViewScale scale, float resolution) {
    scale.pixels_per_radian *= resolution;
    scale.viewport_pixels *= resolution * resolution;
    return scale;
}

/// Rasterised pixels, overdraw included, of `rep` of a node with box `node_box`, seen from `eye`. 0 if the box is outside the
/// view. Assumes that the areas of the representation are spread evenly over the box. Far and wholly in view: a closed form at
/// the box's centre, about 15 ns. Otherwise: 16 rays through the visible part of the box, about 70 ns. Finite and >= 0 for all
/// input. Falls with distance for a box that stays in view.
float rasterised_pixels(const Representation& rep, const Box& node_box, const dvec3& eye, const ViewScale& scale);

/// Computes Representation::area_m2. Along each world axis: the larger of the two areas that face it; both if two-sided.
/// A closed mesh has equal areas; of an open sheet, such as ground, the visible side counts.
std::array<float, 3> rasterised_area(const Model& model, const Representation& rep);

}  // namespace surefoot::model
