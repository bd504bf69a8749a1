// Triangles on which light at the vertices may differ much from light by the pixel.
#pragma once

#include <cstdint>
#include <string>

#include "render/model/model.hpp"

namespace surefoot::accuracy {

/// Triangles of full detail that are lit at their vertices, and those of them that are long and curved.
struct CurvedTriangles {
    std::uint64_t lit = 0;
    std::uint64_t curved = 0;  ///< longer than 0.5 m, with two normals more than 15 degrees apart
};

CurvedTriangles curved_triangles(const model::Model& model);
/// A sentence's end for people; empty where nothing is lit at the vertices.
std::string in_words(const CurvedTriangles& found);

}  // namespace surefoot::accuracy
