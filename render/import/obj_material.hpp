// Wavefront MTL: colours, opacities and images of an OBJ file's materials.
#pragma once

#include <string>

#include "render/import/scene.hpp"

namespace surefoot::importer {

/// Appends the library's materials to the scene. A missing library or image is a warning, and its materials are white.
/// Returns the reason if the library cannot be read, else an empty string.
std::string read_mtl(const std::string& obj_file, const std::string& library, Scene& scene);

}  // namespace surefoot::importer
