// Writers of generated scenes: GLB with everything embedded, and OBJ with its materials and pictures beside it.
#pragma once

#include <string>

#include "render/import/scene.hpp"
#include "rt/base/result.hpp"

namespace surefoot::scenes {

/// glTF 2.0 binary: shared meshes, node tree with matrices and names, PNG pictures, vertex colours as linear 16-bit numbers.
Result<void> write_glb(const std::string& file, const importer::Scene& scene);
/// Instances are written out; FILE.mtl and FILE_N.png stand beside FILE.
Result<void> write_obj(const std::string& file, const importer::Scene& scene);

}  // namespace surefoot::scenes
