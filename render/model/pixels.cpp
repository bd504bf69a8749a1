// How many pixels a representation rasterises: the shared estimate (pixels.hpp).
#include "render/model/pixels.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::model {

namespace {

constexpr double largest_half_angle_rad = 89.0 * 3.14159265358979323846 / 180.0;
constexpr float most_pixels = 1e9F;  // a thousand layers of a megapixel: costs beyond it mean nothing

/// Half extent of the box along a unit axis.
float extent_along(const vec3& half, const vec3& axis) {
    return half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
}

/// [centre - half, centre + half] cut to [-limit, limit]: its length (<= 0: nothing) and its middle.
struct Overlap {
    float length, middle;
};
Overlap overlap(float centre, float half, float limit) {
    const float low = std::max(centre - half, -limit);
    const float high = std::min(centre + half, limit);
    return {high - low, 0.5F * (high + low)};
}

}  // namespace

ViewScale make_view_scale(const Pose& pose, Viewport viewport, double angle_rad) {
    ViewScale scale;
    scale.right = vec3(pose.right());
    scale.up = vec3(pose.up());
    scale.forward = vec3(pose.forward());
    const double width = std::max(1.0, static_cast<double>(viewport.width));
    const double height = std::max(1.0, static_cast<double>(viewport.height));
    const double half_y = std::clamp(0.5 * pose.fov_y_rad, 1e-4, largest_half_angle_rad);
    const double half_x = std::atan(std::tan(half_y) * width / height);
    scale.tan_half_y = static_cast<float>(std::tan(std::min(half_y + angle_rad, largest_half_angle_rad)));
    scale.tan_half_x = static_cast<float>(std::tan(std::min(half_x + angle_rad, largest_half_angle_rad)));
    scale.pixels_per_radian = static_cast<float>(0.5 * height / std::tan(half_y));
    scale.viewport_pixels = static_cast<float>(width * height);
    return scale;
}

float rasterised_pixels(const Representation& rep, const Box& node_box, const dvec3& eye, const ViewScale& scale) {
    if (node_box.empty()) return 0;
    const vec3 centre(node_box.centre() - eye);
    const vec3 half(node_box.half());
    const float thinnest = 1e-5F + 1e-6F * (std::abs(centre.x) + std::abs(centre.y) + std::abs(centre.z));
    // The box as seen along the view's axes.
    const float x = glm::dot(centre, scale.right);
    const float y = glm::dot(centre, scale.up);
    const float z = glm::dot(centre, scale.forward);
    const float hx = extent_along(half, scale.right) + thinnest;
    const float hy = extent_along(half, scale.up) + thinnest;
    const float hz = extent_along(half, scale.forward) + thinnest;
    const float z_near = std::max(z - hz, scale.near_m);
    const float z_far = z + hz;
    if (!(z_far > z_near)) return 0;

    // pixels = f^2 * integral over the box's volume in view of (sum_k area_k |p_k|) / z^3 (a patch of area A at p, facing
    // axis k, covers A |p_k| / z^3 of the image plane at depth 1). With q = 1 / (z + a) the integrand is nearly flat both
    // where the view is narrower than the box and where it is wider, so three midpoints do.
    const float a = 0.5F * (hx / scale.tan_half_x + hy / scale.tan_half_y);
    const float q_near = 1 / (z_near + a);
    const float q_far = 1 / (z_far + a);
    constexpr int samples = 3;
    const float step = (q_near - q_far) / samples;
    float sum = 0;
    for (int i = 0; i < samples; ++i) {
        const float reach = 1 / (q_far + (static_cast<float>(i) + 0.5F) * step);
        const float depth = std::max(reach - a, z_near);
        const Overlap ox = overlap(x, hx, depth * scale.tan_half_x);
        const Overlap oy = overlap(y, hy, depth * scale.tan_half_y);
        if (ox.length <= 0 || oy.length <= 0) continue;
        const vec3 middle = scale.right * ox.middle + scale.up * oy.middle + scale.forward * depth;
        // Around the eye the mean of |p_k| is not |mean|: a quarter of the visible width is its least value.
        const vec3 spread = 0.25F * (glm::abs(scale.right) * ox.length + glm::abs(scale.up) * oy.length);
        const vec3 facing = glm::max(glm::abs(middle), spread);
        const float seen = rep.area_m2[0] * facing.x + rep.area_m2[1] * facing.y + rep.area_m2[2] * facing.z;
        sum += seen * ox.length * oy.length * (reach * reach) / (depth * depth * depth);
    }
    const float f = scale.pixels_per_radian;
    const float pixels = f * f * sum * step / (8 * hx * hy * hz);
    return pixels > 0 ? std::min(pixels, most_pixels) : (pixels <= 0 ? 0.0F : most_pixels);
}

}  // namespace surefoot::model
