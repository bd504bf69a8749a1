// Occluders: the largest opaque triangles of a model's full detail, joined along shared edges.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::prepare {

/// An opaque triangle without holes. Its front side, to which the normal points, is visible; both sides if two_sided.
struct Occluder {
    dvec3 normal{0.0};    ///< world, unit
    double offset = 0;    ///< dot(normal, p) of its points p, m
    dvec3 centre{0.0};    ///< of its corners, world
    double radius_m = 0;  ///< of the bounding sphere about the centre
    double area_m2 = 0;
    std::array<std::uint32_t, 3> corners{};  ///< in Occluders::corners, counter-clockwise about the normal
    std::array<std::uint32_t, 3> edges{};    ///< edge i goes from corner i to the next
    bool two_sided = false;
};

/// The occluders of a model. Constant after they are collected.
struct Occluders {
    std::vector<dvec3> corners;  ///< world; corners within one 0.1 mm cell are merged
    std::vector<Occluder> triangles;
    std::uint32_t edge_count = 0;  ///< two triangles share an edge if they share both its corners
    bool has_rooms = false;        ///< model::has_rooms_apart()
};

/// The `max_occluders` largest occluders; none if the model has no opaque surface. Deterministic; about 0.1 us a triangle of the
/// model.
Occluders find_occluders(const model::Model& model, std::uint32_t max_occluders = 8192);

}  // namespace surefoot::prepare
