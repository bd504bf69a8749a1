// What one side of a surface sees of the sky and of its room, by rays over a hemisphere.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "render/bake/ray_tree.hpp"

namespace surefoot::bake {

constexpr std::size_t rays_of_side = 24;
constexpr double room_reach_m = 3;          ///< what is nearer shades
constexpr std::uint8_t within_share = 230;  ///< of a room that is hidden, of 255: the mean ray is 0.3 m long

/// Shares of the sky and of the room that a side sees. Sums, where it stands in several places.
struct SideSees {
    double sky = 0, room = 0;
};

/// Rays through what is opaque. Constant once made; any thread may ask.
class SkyRays {
public:
    /// far_m: beyond all of the scene.
    SkyRays(const RayTree& opaque, double far_m);

    void add_seen(const dvec3& at, const dvec3& normal, SideSees& seen) const;
    /// The room alone: for sides that are known to see no sky.
    void add_room(const dvec3& at, const dvec3& normal, SideSees& seen) const;
    /// The share of the room, if add_seen() would find no sky at all. Ends at the first ray that meets nothing.
    [[nodiscard]] std::optional<double> room_without_sky(const dvec3& at, const dvec3& normal) const;

    /// Whether add_seen() would find any.
    [[nodiscard]] bool sees_sky(const dvec3& at, const dvec3& normal) const { return sees_sky(fan_of(at, normal)); }

    static std::uint8_t hidden_byte(double seen);

private:
    /// The rays of one side.
    struct Fan {
        dvec3 from{0.0};
        std::array<dvec3, rays_of_side> ways{};
        std::size_t rising = 0;
        bool looks_up = false;
        /// Where the sky is looked for along a way; none: nowhere.
        [[nodiscard]] std::optional<dvec3> to_sky(const dvec3& way) const;
    };
    [[nodiscard]] bool sees_sky(const Fan& fan) const;
    [[nodiscard]] Fan fan_of(const dvec3& at, const dvec3& normal) const;

    const RayTree& opaque_;
    std::array<dvec3, rays_of_side> directions_;
    double far_m_;
};

}  // namespace surefoot::bake
