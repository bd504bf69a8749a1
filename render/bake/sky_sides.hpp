// Which vertices of a mesh see the sky, in each of its places. What sees none becomes a piece of its own, drawn without the sun.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "render/bake/geometry.hpp"
#include "render/bake/picture_tree.hpp"
#include "render/bake/ray_tree.hpp"

namespace surefoot::bake {

/// What the vertices of one mesh see. Empty: not measured, so that all of it counts as in the open.
struct SkySides {
    std::size_t vertices = 0, places = 0;
    std::vector<std::uint8_t> open;   ///< by place, and in it by vertex: sees sky on a side that shows, or is not lit
    std::vector<std::uint8_t> roomy;  ///< by vertex: sees room about it, wherever it sees no sky

    [[nodiscard]] bool empty() const { return open.empty(); }
    [[nodiscard]] bool is_open(std::size_t place, std::uint32_t vertex) const { return open[place * vertices + vertex] != 0; }
    /// Anywhere.
    [[nodiscard]] bool is_open(std::uint32_t vertex) const {
        for (std::size_t p = 0; p < places; ++p)
            if (is_open(p, vertex)) return true;
        return false;
    }
};

/// A mesh in full detail, and where it stands: mesh frame to world.
struct MeshInPlaces {
    const Geometry* geometry = nullptr;
    std::vector<dmat4> places;
};

/// One for each mesh, by the rays of measure_openness(). materials: of the model, complete. Meshes without lit triangles are not
/// measured; nor are any, if all are too much. `step` is called on any thread, sky_steps() times; false ends it, and what is
/// there is of no use. The same at any number of threads.
std::vector<SkySides> find_sky_sides(std::span<const MeshInPlaces> meshes, const std::vector<model::Material>& materials,
                                     const RayTree& opaque, const ForAll& for_all, const std::function<bool()>& step);
/// By mesh, and in it by place: whether no vertex sees sky, by the rays of find_sky_sides() from the mesh's own triangles alone.
/// Where a corner is within something, points of the triangle are tried, every half metre; one of over 64 m counts as open.
/// far_m: beyond all of the scene. What is not lit counts as open. `step` as there; then what is
/// there is of no use. Empty: all are too much.
std::vector<std::vector<bool>> find_closed(std::span<const MeshInPlaces> meshes, const std::vector<model::Material>& materials,
                                           const RayTree& opaque, double far_m, const ForAll& for_all,
                                           const std::function<bool()>& step);
/// How often either calls `step`.
std::size_t sky_steps(std::span<const MeshInPlaces> meshes);

}  // namespace surefoot::bake
