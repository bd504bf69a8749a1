// The glTF node graph to a Scene's nodes: world matrices in double, instances, cycles refused.
#pragma once

#include <string>

#include "render/import/scene.hpp"
#include "render/import/tinygltf.hpp"

namespace surefoot::importer {

/// The default scene (else the first, else every root). Errors: a cycle, by node name. Warnings: what is taken otherwise than
/// written.
Result<void> read_nodes(const tinygltf::Model& model, const std::string& file, Scene& scene);

}  // namespace surefoot::importer
