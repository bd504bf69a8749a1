// clean() with separate counts, so that a mesh of many primitives gets one warning of each kind.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/import/scene.hpp"

namespace surefoot::importer {

/// Counts of repairs; sums over the primitives of a mesh.
struct Mended {
    std::uint64_t arrays = 0;  ///< dropped: their length is not that of the positions
    std::uint64_t partial = 0, out_of_range = 0, non_finite = 0, enormous = 0;  ///< triangles
    std::uint64_t repeated = 0, zero_area = 0;                                  ///< triangles
    std::uint64_t uvs = 0, normals = 0;                                         ///< repaired
};

/// Cleans the primitive and adds to the counts.
void mend(Primitive& primitive, Mended& counts);
/// Adds one warning for each count above zero. Those of broken (not only useless) data are added to `lacks` too.
void say(const Mended& counts, const std::string& mesh_name, std::vector<std::string>& warnings, std::vector<std::string>& lacks);

}  // namespace surefoot::importer
