// A fan of rays, spread by the cosine. Those that rise tell of the sky.
#include "render/bake/sky_rays.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/bake/lit_vertices.hpp"

namespace surefoot::bake {

namespace {

constexpr std::size_t min_rising = 6;  // rays that tell of the sky: of a wall, half of them
constexpr double min_way_up = 0.1;     // rays to the sky rise: what lies below the horizon is ground

bool rises(const dvec3& way) { return way.y >= min_way_up; }

/// Spread evenly over a hemisphere about +Z, by the cosine.
std::array<dvec3, rays_of_side> cosine_directions() {
    constexpr double turn = std::numbers::pi * (3 - 2.2360679774997896);  // the golden angle
    std::array<dvec3, rays_of_side> out;
    for (std::size_t i = 0; i < rays_of_side; ++i) {
        const double squared = (static_cast<double>(i) + 0.5) / rays_of_side, radius = std::sqrt(squared);
        const double angle = turn * static_cast<double>(i);
        out[i] = {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - squared)};
    }
    return out;
}

}  // namespace

SkyRays::SkyRays(const RayTree& opaque, double far_m) : opaque_(opaque), directions_(cosine_directions()), far_m_(far_m) {}

std::uint8_t SkyRays::hidden_byte(double seen) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(1 - seen, 0.0, 1.0)));
}

SkyRays::Fan SkyRays::fan_of(const dvec3& at, const dvec3& normal) const {
    const dvec3 other = std::abs(normal.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
    const dvec3 x = glm::normalize(glm::cross(other, normal)), y = glm::cross(normal, x);
    Fan fan;
    fan.from = at + ray_lift_m * normal;
    std::transform(directions_.begin(), directions_.end(), fan.ways.begin(),
                   [&](const dvec3& d) { return d.x * x + d.y * y + d.z * normal; });
    fan.rising = static_cast<std::size_t>(std::count_if(fan.ways.begin(), fan.ways.end(), rises));
    fan.looks_up = fan.rising >= min_rising;
    return fan;
}

std::optional<dvec3> SkyRays::Fan::to_sky(const dvec3& way) const {
    if (rises(way)) return way;
    if (looks_up) return {};
    return glm::normalize(dvec3(way.x, min_way_up, way.z));
}

void SkyRays::add_seen(const dvec3& at, const dvec3& normal, SideSees& seen) const {
    const Fan fan = fan_of(at, normal);
    std::size_t open = 0;
    for (const dvec3& way : fan.ways) {
        const double near_m = opaque_.nearest_hit_m({fan.from, way, room_reach_m});
        seen.room += std::min(near_m, room_reach_m) / room_reach_m / rays_of_side;
        if (rises(way) && near_m < room_reach_m) continue;
        const std::optional<dvec3> to_sky = fan.to_sky(way);
        if (to_sky && !opaque_.is_blocked({fan.from, *to_sky, far_m_})) ++open;
    }
    seen.sky += static_cast<double>(open) / static_cast<double>(fan.looks_up ? fan.rising : rays_of_side);
}

void SkyRays::add_room(const dvec3& at, const dvec3& normal, SideSees& seen) const {
    const Fan fan = fan_of(at, normal);
    for (const dvec3& way : fan.ways)
        seen.room += std::min(opaque_.nearest_hit_m({fan.from, way, room_reach_m}), room_reach_m) / room_reach_m / rays_of_side;
}

bool SkyRays::sees_sky(const Fan& fan) const {
    return std::any_of(fan.ways.begin(), fan.ways.end(), [&](const dvec3& way) {
        const std::optional<dvec3> to_sky = fan.to_sky(way);
        return to_sky && !opaque_.is_blocked({fan.from, *to_sky, far_m_});
    });
}

std::optional<double> SkyRays::room_without_sky(const dvec3& at, const dvec3& normal) const {
    if (sees_sky(fan_of(at, normal))) return {};
    SideSees seen;
    add_room(at, normal, seen);
    return seen.room;
}

}  // namespace surefoot::bake
