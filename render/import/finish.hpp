// The last step of every importer: cleans meshes, drops empty ones, adds a material if there is none.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/import/scene.hpp"

namespace surefoot::importer {

/// Farther than this from the origin even double loses the millimetre.
inline constexpr double farthest_m = 1e12;

/// Cleans each primitive and drops empty ones. Removes meshes from nodes if they have no triangles or an unusable transform.
/// Adds a white material if there is none. Error: nothing drawable is left; it names the first reasons.
Result<void> finish(Scene& scene, const std::string& file, const Progress& progress);

/// "place: What happened", for a warning that ends there.
std::string in_short(const Error& error);

/// An image of a scene, or why there is none.
struct Picture {
    Index image = none;
    std::string lack;
};
/// The image for a material. If there is none, the reason is added to the material's lacks.
inline Index picture_for(Material& material, const Picture& picture) {
    if (!picture.lack.empty()) material.lacks.push_back(picture.lack);
    return picture.image;
}

/// The path of `name`, as written in `file`: beside that file. Accepts both kinds of slashes.
std::string place_beside(const std::string& file, const std::string& name);

/// Loads a texture by name beside `file`. Missing or damaged: a warning, and white.
Picture load_texture(Scene& scene, const std::string& file, const std::string& name);

/// The same for an image that is already decoded, or could not be.
Picture add_picture(Scene& scene, const std::string& name, Result<image::Image> image);

/// Counts of repairs; sums over the primitives of a mesh. A mesh of many primitives gets one warning of each kind.
struct Repairs {
    std::uint64_t arrays = 0;  ///< dropped: their length is not that of the positions
    std::uint64_t partial = 0, out_of_range = 0, non_finite = 0, enormous = 0;  ///< triangles
    std::uint64_t repeated = 0, zero_area = 0;                                  ///< triangles
    std::uint64_t uvs = 0, normals = 0;                                         ///< repaired
};

/// Cleans the primitive and adds to the counts.
void repair(Primitive& primitive, Repairs& counts);
/// Of a repaired one: triangles share no vertex any more, and each has its own normal at its corners.
void make_flat(Primitive& primitive);
/// Adds one warning for each count above zero. Those of broken (not only useless) data are added to `lacks` too.
void report_repairs(const Repairs& counts, const std::string& mesh_name, std::vector<std::string>& warnings,
                    std::vector<std::string>& lacks);

}  // namespace surefoot::importer
