// What every importer ends with: meshes cleaned, empty ones gone, at least one material, something drawable.
#pragma once

#include <string>

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

}  // namespace surefoot::importer
