// Wavefront MTL: the colours, opacities and pictures of an OBJ file's materials.
#pragma once

#include <string>

#include "render/import/scene.hpp"

namespace surefoot::importer {

/// Appends the library's materials to the scene. A missing library or picture is a warning; materials are then white. Returns why
/// the library could not be read; empty: it was.
std::string read_mtl(const std::string& obj_file, const std::string& library, Scene& scene);

}  // namespace surefoot::importer
