// How many pixels a representation rasterises, seen from a pose, by its box and its areas alone: all that is needed far away, and
// part of the estimate nearby (surfaces.hpp).
#pragma once

#include <array>

#include "render/model/model.hpp"
#include "render/model/view.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::model {

constexpr float most_pixels = 1e9F;  ///< a thousand layers of a megapixel: costs beyond it mean nothing

/// What the estimate needs of a view, made once a frame. Unit vectors in world space, and the same sheared so that a picture off
/// axis lies evenly about 0: p is in it where |across . p| <= tan_half_x * (forward . p), and rise with tan_half_y.
struct ViewScale {
    vec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
    vec3 across{1, 0, 0}, rise{0, 1, 0};   ///< right and up, less the middle of the picture times forward
    vec3 middle{0, 0, -1};                 ///< of the picture at depth 1
    float tan_half_x = 1, tan_half_y = 1;  ///< half extents of the picture at depth 1
    float pixels_per_radian = 1;           ///< where the pose looks
    float viewport_pixels = 1;             ///< width * height
    float near_m = static_cast<float>(near_plane_m);
};
/// angle_rad widens the view on each side (a region of poses); half angles are capped below 89 degrees.
ViewScale make_view_scale(const Pose& pose, Viewport viewport, double angle_rad = 0.0);

/// By the box alone: rasterised pixels, overdraw included, of `rep` of a node with box `node_box` seen from `eye`; 0 where the
/// box is outside the view. The areas of the representation are taken as spread evenly over the box. Wholly in view and far:
/// closed form at the box's centre, about 15 ns; else 16 rays through what is seen of the box, about 70 ns. Finite and >= 0 for
/// all input; falls with distance for a box that stays in view.
float rasterised_pixels(const Representation& rep, const Box& node_box, const dvec3& eye, const ViewScale& scale);

/// Representation::area_m2 of its parts, in world axes: along each, the larger of the areas that face the two ways (a closed
/// mesh has equal ones; of an open sheet, such as ground, the side that shows counts), and both where both sides are drawn.
std::array<float, 3> rasterised_area(const Model& model, const Representation& rep);

}  // namespace surefoot::model
