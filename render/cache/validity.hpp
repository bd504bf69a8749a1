// When a picture of a box may stand for its contents: the plane that it is on, and bounds of its errors as angles.
// Source: Schaufler and Stuerzlinger 1996, sections 3 and 4.2, corrected: README.md has the formulas and the reasons.
#pragma once

#include <cstdint>
#include <optional>

#include "render/model/conic_range.hpp"
#include "render/model/view.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::cache {

/// Angles of a view's pixels, rad.
struct PixelAngles {
    double smallest_rad = 0;  ///< at the corner that is farthest from the view direction: what errors are measured by
    double middle_rad = 0;    ///< in the view direction, where it is largest
    double mean_rad = 0;      ///< field of view / rows: the measure of 1996
};
PixelAngles pixel_angles(const Pose& pose, model::Viewport viewport);

/// The smallest pixels of a view, by where in it something is seen.
struct ViewPixels {
    dvec3 eye{0.0}, forward{0, 0, -1};
    double pixel = 0, corner = 0;  ///< as tangents: a pixel's side; the corner that is farthest from the view direction
    double turn_rad = 0;           ///< by which the view may turn
    /// Of all places where a point of the box may be seen, rad.
    [[nodiscard]] double smallest_rad(const Box& box) const;
};
ViewPixels view_pixels(const Pose& pose, model::Viewport viewport, double turn_rad = 0);

/// Where a picture's plane stands, between the nearest and the farthest depth of its box.
enum class PlanePlace : std::uint8_t { harmonic_mean, middle, near_face, far_face };

/// A picture of a box: seen from `eye`, square, on a plane across `forward`. Lengths in m.
struct Picture {
    dvec3 eye{0.0};
    dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  ///< unit; forward: from the eye to the middle of the box
    double near_m = 0, far_m = 0;                          ///< depths of the box along forward
    double plane_m = 0;                                    ///< depth of the plane
    double tangent = 0;                                    ///< of the largest angle between forward and a point of the box
    dvec2 low_m{0.0};                                      ///< on the plane: its lower left corner, along right and up
    double side_m = 0;                                     ///< on the plane
    std::uint32_t texels = 0;                              ///< of a side; 0: there is no picture
    double inherited = 0;                                  ///< error of what was drawn into it, seen from `eye`, as a tangent
    std::uint32_t generation = 0;                          ///< 0: of triangles; else one more than the children's
    std::uint32_t frame = 0;                               ///< in which it was made
};

/// The picture of a box from an eye, without texels. Nothing where the box has a point that is not at least
/// model::near_plane_m before the eye, or is empty or not finite.
std::optional<Picture> picture_of(const Box& box, const dvec3& eye, PlanePlace place = PlanePlace::harmonic_mean);

/// Bounds of the angle between a point of the box and its image, for an eye that has moved. As tangents, which are no less.
/// Infinite where the eye is beyond the box, or nearer than model::near_plane_m.
struct PictureErrors {
    double translation = 0, approach = 0, inherited = 0;
    [[nodiscard]] double total() const { return translation + approach + inherited; }
};
PictureErrors picture_errors(const Picture& picture, const dvec3& eye);

/// The same for all eyes within a distance of one: no less than any of theirs.
PictureErrors picture_errors(const Picture& picture, const dvec3& eye, double radius_m);

/// Whether neither error nor texel is over max_rad, seen from all eyes within a distance of one.
bool valid_around(const Picture& picture, const dvec3& eye, double radius_m, double max_rad);

/// The largest angle of a texel, seen from an eye, rad. Infinite as above, and without texels.
double texel_rad(const Picture& picture, const dvec3& eye);

/// Texels of a side, so that none is larger than max_texel_rad seen from the picture's eye. 0: of a box without size.
double needed_texels(const Picture& picture, double max_texel_rad);

/// Error that a picture inherits: what `error`, of a picture drawn into it, is on its own plane. tangent: Picture::tangent.
double inherited_error(double error, double tangent);

/// Solid angle of a box's faces that an eye sees, by their middles; 0 from inside.
double faces_sr(const Box& box, const dvec3& eye);

/// A sphere of eyes round the picture's own. Seen from each of them neither error nor texel is over max_rad. May be empty.
model::ConicRange valid_range(const Picture& picture, double max_rad);

/// The tests of 1996, for comparison: translation and approach, each by itself, by the depths from the picture's own eye.
struct PublishedErrors {
    double translation = 0, approach = 0;
};
PublishedErrors published_errors(const Picture& picture, const dvec3& eye);

/// Whether each of them is at most max_rad.
bool published_valid(const Picture& picture, const dvec3& eye, double max_rad);

}  // namespace surefoot::cache
