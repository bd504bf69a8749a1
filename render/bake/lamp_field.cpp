// Lamps in cells of 16 m; those that reach far are tried everywhere.
#include "render/bake/lamp_field.hpp"

#include <algorithm>
#include <cmath>

#include "render/bake/lit_vertices.hpp"

namespace surefoot::bake {

namespace {

constexpr double cell_m = 16;
constexpr double min_lux = 0.02;   // darker than moonlight is not lit
constexpr double full_lux = 10;    // a well lit street
constexpr double max_near_m = 56;  // of a lamp that is put into cells: 8 of them a side

std::int64_t cell_of(double value) { return static_cast<std::int64_t>(std::floor(std::clamp(value, -1e6, 1e6) / cell_m)); }

std::uint64_t key_of(std::int64_t x, std::int64_t y, std::int64_t z) {
    constexpr std::uint64_t mask = (1U << 21U) - 1;
    return (static_cast<std::uint64_t>(x) & mask) << 42U | (static_cast<std::uint64_t>(y) & mask) << 21U |
           (static_cast<std::uint64_t>(z) & mask);
}

}  // namespace

LampField::LampField(const std::vector<importer::Lamp>& lamps, const RayTree& opaque) : opaque_(opaque) {
    for (const importer::Lamp& lamp : lamps) {
        const double seen_m = std::sqrt(lamp.candela / min_lux);
        const auto index = static_cast<std::uint32_t>(lamps_.size());
        lamps_.push_back({lamp, lamp.range_m > 0 ? std::min(lamp.range_m, seen_m) : seen_m});
        const double range = lamps_.back().range_m;
        if (range > max_near_m) {
            far_reaching_.push_back(index);
            continue;
        }
        const auto from = [&](int axis) { return cell_of(lamp.at[axis] - range); };
        const auto to = [&](int axis) { return cell_of(lamp.at[axis] + range); };
        for (std::int64_t x = from(0); x <= to(0); ++x)
            for (std::int64_t y = from(1); y <= to(1); ++y)
                for (std::int64_t z = from(2); z <= to(2); ++z) by_cell_[key_of(x, y, z)].push_back(index);
    }
}

dvec3 LampField::lux_of(const ReachingLamp& from, const dvec3& at, const dvec3& normal) const {
    const importer::Lamp& lamp = from.lamp;
    const dvec3 way = lamp.at - at;
    const double distance = glm::length(way);
    if (!(distance < from.range_m) || !(distance > 0)) return dvec3(0);
    const dvec3 towards = way / distance;
    double falling = glm::dot(normal, towards);
    if (!(falling > 0)) return dvec3(0);
    if (lamp.spot()) {
        const double cosine = glm::dot(-towards, lamp.towards);
        if (cosine <= lamp.cos_outer) return dvec3(0);
        const double share = (cosine - lamp.cos_outer) / std::max(lamp.cos_inner - lamp.cos_outer, 1e-6);
        falling *= std::min(share, 1.0) * std::min(share, 1.0);
    }
    if (lamp.range_m > 0) falling *= std::clamp(1 - std::pow(distance / lamp.range_m, 4), 0.0, 1.0);
    constexpr double housing_m = 0.3;  // the lamp's own housing hides nothing
    if (distance > housing_m && opaque_.is_blocked({at, towards, distance - housing_m})) return dvec3(0);
    const double near_m = std::max(distance, 0.1);
    return dvec3(lamp.colour) * (lamp.candela * falling / (near_m * near_m));
}

dvec3 LampField::lux_at(const dvec3& at, const dvec3& normal) const {
    dvec3 sum(0);
    const dvec3 from = at + ray_lift_m * normal;
    if (!std::isfinite(from.x + from.y + from.z)) return sum;
    for (const std::uint32_t i : far_reaching_) sum += lux_of(lamps_[i], from, normal);
    const auto cell = by_cell_.find(key_of(cell_of(from.x), cell_of(from.y), cell_of(from.z)));
    if (cell == by_cell_.end()) return sum;
    for (const std::uint32_t i : cell->second) sum += lux_of(lamps_[i], from, normal);
    return sum;
}

vec3 shown_light(const dvec3& lux) {
    vec3 out(0);
    for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(std::pow(1 - std::exp(-std::max(lux[c], 0.0) / full_lux), 1 / 2.2));
    return out;
}

}  // namespace surefoot::bake
