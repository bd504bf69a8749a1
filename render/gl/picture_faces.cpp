// Faces of boxes with pictures (picture_faces.hpp).
#include "render/gl/picture_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/model/view.hpp"

namespace surefoot::gl {

namespace {

/// What is nearer than this is not ahead. The cache ends at the near plane; boxes are grown a little after that.
constexpr double min_ahead_m = 0.5 * model::near_plane_m;
/// Farther away on the plane than this is no place for a driver.
constexpr double max_away_m = 1e9;

/// A corner on the picture's plane. All of it is linear along an edge.
struct OnPlane {
    dvec3 place;       ///< relative to the eye
    double scale = 1;  ///< by which the corner of the box was moved along its ray
    dvec2 at;          ///< 0..1 in the square
};

/// A quadrilateral of which four cuts may each make one corner more.
struct Polygon {
    std::array<OnPlane, 8> corners;
    std::size_t count = 0;
    void add(const OnPlane& corner) {
        if (count < corners.size()) corners[count++] = corner;
    }
};

/// Leaves what has side * (at[axis] - limit) >= 0.
void cut(Polygon& polygon, int axis, double side, double limit) {
    const Polygon before = polygon;
    polygon.count = 0;
    for (std::size_t i = 0; i < before.count; ++i) {
        const OnPlane &a = before.corners[i], &b = before.corners[(i + 1) % before.count];
        const double in_a = side * (a.at[axis] - limit), in_b = side * (b.at[axis] - limit);
        if (in_a >= 0) polygon.add(a);
        if ((in_a >= 0) == (in_b >= 0)) continue;
        const double share = in_a / (in_a - in_b);
        polygon.add({a.place + share * (b.place - a.place), a.scale + share * (b.scale - a.scale), a.at + share * (b.at - a.at)});
        polygon.corners[polygon.count - 1].at[axis] = limit;
    }
}

PictureVertex vertex_of(const OnPlane& corner, const PicturePlace& place) {
    const dvec2 texel = dvec2(place.column, place.row) + corner.at * static_cast<double>(place.texels);
    const vec3 at(texel / static_cast<double>(picture_layer_px), place.layer), where(corner.place);
    return {{where.x, where.y, where.z, static_cast<float>(corner.scale)}, {at.x, at.y, at.z}};
}

/// Where a frame's eye meets the plane of a picture.
struct Seen {
    dvec3 eye, from_picture;  ///< from_picture: of the frame's eye
    double ahead_m;           ///< of the plane
};

/// False: the corner is not ahead.
bool project(const CachePicture& picture, const Seen& seen, const dvec3& corner, OnPlane& to) {
    const dvec3 ray = corner - seen.eye;
    const double depth = glm::dot(ray, picture.forward);
    if (!(depth >= min_ahead_m)) return false;
    to.scale = seen.ahead_m / depth;
    to.place = ray * to.scale;
    const dvec3 from = seen.from_picture + to.place;
    to.at = (dvec2(glm::dot(from, picture.right), glm::dot(from, picture.up)) - picture.low_m) / picture.side_m;
    return glm::length(to.place) < max_away_m && std::isfinite(to.at.x) && std::isfinite(to.at.y);
}

}  // namespace

bool lies_within(const PicturePlace& place, std::uint32_t layers) {
    return place.layer < layers && place.texels > 0 && place.column + std::uint32_t{place.texels} <= picture_layer_px &&
           place.row + std::uint32_t{place.texels} <= picture_layer_px;
}

double nearest_depth_m(const CachePicture& picture) {
    double near = std::numeric_limits<double>::infinity();
    for (unsigned i = 0; i < 8; ++i) {
        const dvec3 corner((i & 1U) != 0 ? picture.box.max.x : picture.box.min.x,
                           (i & 2U) != 0 ? picture.box.max.y : picture.box.min.y,
                           (i & 4U) != 0 ? picture.box.max.z : picture.box.min.z);
        near = std::min(near, glm::dot(corner - picture.eye, picture.forward));
    }
    constexpr double before = 0.999;  // six planes cut the box: depth must not
    return std::max(before * near, min_ahead_m);
}

mat4 capture_projection(const CachePicture& picture) {
    const double near = nearest_depth_m(picture);
    const dvec2 middle = (2.0 * picture.low_m + picture.side_m) / picture.side_m;
    const double scale = 2 * picture.plane_m / picture.side_m;
    const dvec3 x = scale * picture.right - middle.x * picture.forward, y = scale * picture.up - middle.y * picture.forward;
    dmat4 m(0.0);
    for (int c = 0; c < 3; ++c) m[c] = dvec4(x[c], y[c], 0, picture.forward[c]);
    m[3][2] = near;
    return mat4(m);
}

std::size_t add_picture(const CachePicture& picture, const dvec3& eye, std::span<PictureVertex> to) {
    const dvec3 moved = eye - picture.eye;
    const Seen seen{eye, moved, picture.plane_m - glm::dot(moved, picture.forward)};
    if (!(seen.ahead_m >= min_ahead_m) || !(picture.side_m > 0) || picture.place.texels == 0) return 0;
    const double edge = 0.5 / picture.place.texels;
    const std::array<const dvec3*, 2> ends{&picture.box.min, &picture.box.max};
    std::size_t used = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int second = (axis + 1) % 3, third = (axis + 2) % 3;
        for (std::size_t end = 0; end < 2; ++end) {
            const double face = (*ends[end])[axis];
            if (!(end == 0 ? eye[axis] < face : eye[axis] > face)) continue;
            // Each ray ends on the plane of the smaller box's face: that moves no point on the screen.
            const double inner = face + (end == 0 ? picture.grown_m : -picture.grown_m);
            const double farther = (inner - eye[axis]) / (face - eye[axis]);
            Polygon polygon;
            bool whole = true;
            for (const unsigned i : {0U, 1U, 3U, 2U}) {
                dvec3 corner;
                corner[axis] = face;
                corner[second] = (*ends[i & 1U])[second];
                corner[third] = (*ends[i >> 1U])[third];
                OnPlane on_plane;
                if (!project(picture, seen, corner, on_plane)) return 0;
                for (const double at : {on_plane.at.x, on_plane.at.y}) whole = whole && at >= edge && at <= 1 - edge;
                on_plane.scale /= farther;
                polygon.add(on_plane);
            }
            for (int across = 0; across < 2 && !whole; ++across) {
                cut(polygon, across, 1, edge);
                cut(polygon, across, -1, 1 - edge);
            }
            for (std::size_t i = 2; i < polygon.count && used + 3 <= to.size(); ++i) {
                for (const std::size_t corner : {std::size_t{0}, i - 1, i})
                    to[used++] = vertex_of(polygon.corners[corner], picture.place);
            }
        }
    }
    return used;
}

}  // namespace surefoot::gl
