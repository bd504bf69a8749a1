// What clean() does, with its counts kept apart so that a mesh of many primitives gets one warning a kind.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/import/scene.hpp"

namespace surefoot::importer {

/// How many of what; sums over the primitives of a mesh.
struct Mended {
    std::uint64_t arrays = 0;  ///< dropped: their length is not that of the positions
    std::uint64_t partial = 0, out_of_range = 0, non_finite = 0, enormous = 0;  ///< triangles
    std::uint64_t repeated = 0, zero_area = 0;                                  ///< triangles
    std::uint64_t uvs = 0, normals = 0;                                         ///< mended
};

/// Cleans the primitive and adds to the counts.
void mend(Primitive& primitive, Mended& counts);
/// One line for each kind that is not zero; what is broken, not only useless, is what the mesh lacks, too.
void say(const Mended& counts, const std::string& mesh_name, std::vector<std::string>& warnings, std::vector<std::string>& lacks);

}  // namespace surefoot::importer
