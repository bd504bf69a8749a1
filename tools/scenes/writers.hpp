// The writer of generated scenes as GLB, everything embedded. OSTF is written by its importer's room.
#pragma once

#include <string>

#include "render/import/scene.hpp"
#include "rt/base/result.hpp"

namespace surefoot::scenes {

/// glTF 2.0 binary: shared meshes, node tree with matrices and names, PNG pictures, vertex colours as linear 16-bit numbers.
Result<void> write_glb(const std::string& file, const importer::Scene& scene);

}  // namespace surefoot::scenes
