// What every importer ends with: meshes cleaned, empty ones gone, at least one material, something drawable.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/import/scene.hpp"

namespace surefoot::importer {

/// Cleans each primitive, drops empty primitives, takes meshes without triangles and transforms that cannot be drawn off
/// their nodes, gives a white material where there is none. Errors: nothing drawable left (says the first reason).
Result<void> finish(Scene& scene, const std::string& file, const Progress& progress);

/// A picture of a scene, or why there is none.
struct Picture {
    Index image = none;
    std::string lack;
};
/// For a material that asks for it: the image, or the lack noted.
inline Index picture_for(Material& material, const Picture& picture) {
    if (!picture.lack.empty()) material.lacks.push_back(picture.lack);
    return picture.image;
}

/// Where `name`, as it stands in `file`, lies: beside it, with either system's slashes.
std::string place_beside(const std::string& file, const std::string& name);

/// Loads a texture by name beside `file`. Missing or undecodable: a warning, and white.
Picture load_texture(Scene& scene, const std::string& file, const std::string& name);

/// The same of one that is decoded already, or could not be.
Picture add_picture(Scene& scene, const std::string& name, Result<image::Image> image);

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
