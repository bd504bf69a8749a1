// What of a model can hide the rest: the largest opaque triangles of its full detail, joined where they share an edge.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::prepare {

/// A triangle that is drawn without holes. The side that its normal points to shows; both if two_sided.
struct Occluder {
    dvec3 normal{0.0};    ///< world, unit
    double offset = 0;    ///< dot(normal, p) of its points p, m
    dvec3 centre{0.0};    ///< of its corners, world
    double radius_m = 0;  ///< of the ball about the centre that holds it
    double area_m2 = 0;
    std::array<std::uint32_t, 3> corners{};  ///< in Occluders::corners, counter-clockwise about the normal
    std::array<std::uint32_t, 3> edges{};    ///< edge i goes from corner i to the next
    bool two_sided = false;
};

struct Occluders {
    std::vector<dvec3> corners;  ///< world; what falls into one cell of a tenth of a millimetre is one
    std::vector<Occluder> triangles;
    std::uint32_t edge_count = 0;  ///< triangles share an edge where they share both of its corners
};

/// The `most` largest. Deterministic; about 0.1 us a triangle of the model. A model without opaque surfaces has none.
Occluders find_occluders(const model::Model& model, std::uint32_t most = 8192);

}  // namespace surefoot::prepare
