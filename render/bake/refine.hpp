// Cuts large triangles where baked light changes across them: light is kept at the vertices, and a street is two triangles.
// Edges are cut alike on all triangles that share them, so no cracks open.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "render/bake/lamp_field.hpp"
#include "render/bake/picture_tree.hpp"
#include "render/bake/ray_tree.hpp"
#include "render/import/scene.hpp"
#include "render/model/daylight.hpp"

namespace surefoot::bake {

/// The light that triangles are cut for.
struct RefineLight {
    dvec3 sun{0, 1, 0};       ///< towards it, as the model is baked
    model::LightFacts facts;  ///< of the day whose other shadows count too
    const RayTree* opaque;    ///< what hides
    const LampField* lamps;
    const RayTree* leaves = nullptr;  ///< lets some of the sun through; null: nothing does
};

/// By mesh of the scene: the same surface of more triangles. None: as it is.
using RefinedMeshes = std::vector<std::optional<importer::Mesh>>;

/// Edges are cut down to half a metre, the longest first, until a quarter more triangles are there, or 20 000. They count in each
/// place. Only lit opaque materials of meshes that stand in at most four places; of what is beside them, nothing else is cut.
/// An edge is cut wherever it lies, so in a mesh of several sizes it may be shorter in the small ones. for_all may run on many
/// threads; the same meshes at any number of them. `stop` is looked at between rounds; then what is there is returned.
RefinedMeshes refine_for_light(const importer::Scene& scene, const RefineLight& light, const ForAll& for_all,
                               const std::function<bool()>& stop);

}  // namespace surefoot::bake
