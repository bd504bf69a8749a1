// What every importer ends with: meshes cleaned, empty ones gone, at least one material, something drawable.
#pragma once

#include <string>

#include "render/import/scene.hpp"

namespace surefoot::importer {

/// Cleans each primitive, drops empty primitives, takes meshes without triangles and transforms that cannot be drawn off
/// their nodes, gives a white material where there is none. Errors: nothing drawable left (says the first reason).
Result<void> finish(Scene& scene, const std::string& file, const Progress& progress);

/// Loads a texture by name beside `file`. Missing or undecodable: a warning, and none is returned (white).
Index load_texture(Scene& scene, const std::string& file, const std::string& name);

}  // namespace surefoot::importer
