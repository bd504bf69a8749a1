// How many pixels a representation rasterises, by its box (pixels.hpp).
#include "render/model/pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/model/model.hpp"

namespace surefoot::model {

namespace {

constexpr double largest_half_angle_rad = 89.0 * 3.14159265358979323846 / 180.0;

/// Half extent of the box along a unit axis.
float extent_along(const vec3& half, const vec3& axis) {
    return half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
}

/// Ends of [low, high] / depth over depths from near to far: where the interval is seen.
struct Slopes {
    float low, high;
};
Slopes slopes(float low, float high, float near, float far) {
    return {low / (low < 0 ? near : far), high / (high > 0 ? near : far)};
}

/// Projected area of surfaces whose areas along the axes are `area`, for a displacement m: the mean of a box's, sum a_k |m_k|,
/// and an ellipsoid's, |(a_k m_k)|.
float facing_area(const vec3& area, const vec3& m) {
    const vec3 each = area * glm::abs(m);
    return 0.5F * (each.x + each.y + each.z + std::sqrt(glm::dot(each, each)));
}

constexpr int rays = 16;
// A lattice with every column and every row once: a strip, however it lies, is hit in proportion to its width.
constexpr std::array<float, rays> column_of_ray{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
constexpr std::array<float, rays> row_of_ray{0, 7, 14, 5, 12, 3, 10, 1, 8, 15, 6, 13, 4, 11, 2, 9};

/// Mean number of surfaces that a ray through the rectangle of slopes crosses in the box [low, high] (relative to the eye):
/// with areas spread evenly over the volume V, a ray that moves by m inside crosses facing_area(m) / V of them. The loops are
/// of fixed length and without branches: the compiler makes them four rays wide.
float mean_crossings(const vec3& low, const vec3& high, const vec3& area, Slopes across, Slopes up_down, const ViewScale& scale) {
    std::array<float, rays> enter, leave, sum, squares;  // NOLINT: filled below
    for (std::size_t i = 0; i < rays; ++i) {
        enter[i] = scale.near_m;
        leave[i] = std::numeric_limits<float>::max();
        sum[i] = squares[i] = 0;
    }
    const float step_x = (across.high - across.low) / rays;
    const float step_y = (up_down.high - up_down.low) / rays;
    for (int axis = 0; axis < 3; ++axis) {
        const float by_column = scale.right[axis] * step_x;
        const float by_row = scale.up[axis] * step_y;
        const float first =
            scale.middle[axis] + scale.right[axis] * across.low + scale.up[axis] * up_down.low + 0.5F * (by_column + by_row);
        const float l = low[axis];
        const float h = high[axis];
        const float a = area[axis];
        for (std::size_t i = 0; i < rays; ++i) {
            const float d = first + column_of_ray[i] * by_column + row_of_ray[i] * by_row;
            const float inverse = 1.0F / (d + std::copysign(1e-12F, d));
            const float t = l * inverse;
            const float u = h * inverse;
            enter[i] = std::max(enter[i], std::min(t, u));
            leave[i] = std::min(leave[i], std::max(t, u));
            const float each = a * std::abs(d);
            sum[i] += each;
            squares[i] += each * each;
        }
    }
    float crossed = 0;
    for (std::size_t i = 0; i < rays; ++i) {
        crossed += 0.5F * (sum[i] + std::sqrt(squares[i])) * std::max(0.0F, leave[i] - enter[i]);
    }
    const vec3 size = high - low;
    return crossed / (static_cast<float>(rays) * size.x * size.y * size.z);
}

}  // namespace

ViewScale make_view_scale(const Pose& pose, Viewport viewport, double angle_rad) {
    ViewScale scale;
    scale.right = vec3(pose.right());
    scale.up = vec3(pose.up());
    scale.forward = vec3(pose.forward());
    const double width = std::max(1.0, static_cast<double>(viewport.width));
    const double height = std::max(1.0, static_cast<double>(viewport.height));
    const SideAngles sides = side_angles(pose, viewport);
    const auto turned = [&](double side) { return std::tan(std::min(side + angle_rad, largest_half_angle_rad)); };
    const double left = -turned(-sides.left), right = turned(sides.right), down = -turned(-sides.down), up = turned(sides.up);
    scale.tan_half_x = static_cast<float>(0.5 * (right - left));
    scale.tan_half_y = static_cast<float>(0.5 * (up - down));
    const auto middle_x = static_cast<float>(0.5 * (left + right)), middle_y = static_cast<float>(0.5 * (down + up));
    scale.across = scale.right - middle_x * scale.forward;
    scale.rise = scale.up - middle_y * scale.forward;
    scale.middle = scale.forward + middle_x * scale.right + middle_y * scale.up;
    scale.pixels_per_radian = static_cast<float>(0.5 * height / picture_extent(pose, viewport).half_y);
    scale.viewport_pixels = static_cast<float>(width * height);
    return scale;
}

float rasterised_pixels(const Representation& rep, const Box& node_box, const dvec3& eye, const ViewScale& scale) {
    if (node_box.empty()) return 0;
    const vec3 centre(node_box.centre() - eye);
    vec3 half(node_box.half());
    const float largest = std::max({half.x, half.y, half.z});
    half = glm::max(half, vec3(1e-4F + 1e-4F * largest));  // what is flat still has an inside
    const float x = glm::dot(centre, scale.across);
    const float y = glm::dot(centre, scale.rise);
    const float z = glm::dot(centre, scale.forward);
    const float hx = extent_along(half, scale.across);
    const float hy = extent_along(half, scale.rise);
    const float hz = extent_along(half, scale.forward);
    const float near = std::max(z - hz, scale.near_m);
    const float far = z + hz;
    if (!(far > near)) return 0;
    const vec3 area(rep.area_m2[0], rep.area_m2[1], rep.area_m2[2]);
    const float f = scale.pixels_per_radian;
    const float tx = scale.tan_half_x;
    const float ty = scale.tan_half_y;
    float pixels = 0;
    if (z > 4 * hz && std::abs(x) + hx < near * tx && std::abs(y) + hy < near * ty) {
        // Wholly in view and far: a patch of area A at p, facing axis k, covers A |p_k| / z^3 of the image plane at depth 1.
        pixels = f * f * facing_area(area, centre) / (z * z * z);
    } else {
        Slopes across = slopes(x - hx, x + hx, near, far);
        Slopes up_down = slopes(y - hy, y + hy, near, far);
        across = {std::max(across.low, -tx), std::min(across.high, tx)};
        up_down = {std::max(up_down.low, -ty), std::min(up_down.high, ty)};
        if (!(across.high > across.low) || !(up_down.high > up_down.low)) return 0;
        const float rectangle = (across.high - across.low) * (up_down.high - up_down.low);
        pixels = f * f * rectangle * mean_crossings(centre - half, centre + half, area, across, up_down, scale);
    }
    return pixels > 0 ? std::min(pixels, max_pixels) : (pixels <= 0 ? 0.0F : max_pixels);
}

std::array<float, 3> rasterised_area(const Model& model, const Representation& rep) {
    const mat3& linear = model.placements[rep.placement].linear;
    dvec3 total(0.0);
    dvec3 forth(0.0);
    dvec3 back(0.0);
    for_triangles(model, rep, [&](const Material& material, const vec3& a, const vec3& b, const vec3& c) {
        const dvec3 first(linear * a);
        const dvec3 area = 0.5 * glm::cross(dvec3(linear * b) - first, dvec3(linear * c) - first);
        if (material.two_sided) {
            total += glm::abs(area);
        } else {
            forth += glm::max(area, dvec3(0.0));
            back += glm::max(-area, dvec3(0.0));
        }
    });
    const dvec3 sum = total + glm::max(forth, back);
    return {static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z)};
}

}  // namespace surefoot::model
