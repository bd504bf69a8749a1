// The light of all lamps of a scene at a point of a surface, with what hides them.
// Source: point and spot lights after KHR_lights_punctual (Khronos 2018), "Range property" and "Inner and outer cone angles".
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "render/bake/ray_tree.hpp"
#include "render/import/scene.hpp"

namespace surefoot::bake {

/// Lamps by where they reach. Constant once made; any thread may ask. The tree must outlive it.
class LampField {
public:
    LampField(const std::vector<importer::Lamp>& lamps, const RayTree& opaque);

    /// Lux a channel on a surface with this unit normal, from lamps that nothing opaque hides.
    [[nodiscard]] dvec3 lux_at(const dvec3& at, const dvec3& normal) const;
    [[nodiscard]] bool empty() const { return lamps_.empty(); }

private:
    /// A lamp, and how far it lights more than nothing.
    struct ReachingLamp {
        importer::Lamp lamp;
        double range_m = 0;
    };
    [[nodiscard]] dvec3 lux_of(const ReachingLamp& from, const dvec3& at, const dvec3& normal) const;

    std::vector<ReachingLamp> lamps_;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> by_cell_;
    std::vector<std::uint32_t> far_reaching_;
    const RayTree& opaque_;
};

/// As a display value a channel, 0..1: 1 - exp(-lux / 10), gamma-encoded. So a well lit street is bright, and nothing is white.
vec3 shown_light(const dvec3& lux);

}  // namespace surefoot::bake
