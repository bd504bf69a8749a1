// All that a bake of quality full finds out about light: what sees the sky, what the sun reaches, what lamps and glow add.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/bake/baked_light.hpp"
#include "render/bake/openness.hpp"
#include "render/bake/refine.hpp"
#include "render/bake/sky_sides.hpp"
#include "render/import/scene.hpp"
#include "render/model/model.hpp"
#include "render/model/sun_time.hpp"
#include "rt/base/progress.hpp"

namespace surefoot::bake {

/// What was found, for the findings.
struct SceneLight {
    Openness openness;
    BakedLight baked;
};

/// The model's own sun, by the time or the scene, and its fog.
void set_own_light(const importer::Scene& scene, const std::optional<model::SunTime>& time, double fog_visibility_m,
                   model::Model& model);

/// What is opaque in a scene, and its lamps: ready for rays.
struct LightRays {
    model::Ground ground, leaf_ground;
    RayTree opaque{ground}, leaves{leaf_ground};
    LampField lamps;

    LightRays(model::Ground solid, model::Ground leafy, const importer::Scene& scene)
        : ground(std::move(solid)), leaf_ground(std::move(leafy)), lamps(scene.lamps, opaque) {}
    LightRays(const LightRays&) = delete;
    LightRays& operator=(const LightRays&) = delete;
    ~LightRays() = default;
};
std::unique_ptr<LightRays> make_light_rays(const importer::Scene& scene, const Progress& progress);

/// Meshes whose large triangles are cut for the light of the model's sun and of the scene's lamps. On the calling arena.
RefinedMeshes refine_scene(const importer::Scene& scene, const model::Model& model, const LightRays& rays,
                           const Progress& progress);
/// What sees the sky, mesh by mesh, on all cores of the calling arena. Where the user stops it, what it returns is of no use.
std::vector<SkySides> find_scene_sides(std::span<const MeshInPlaces> meshes, const model::Model& model, const LightRays& rays,
                                       const Progress& progress);
/// Measures it on all cores of the calling arena. closed: as measure_openness() has it. Before boxes are captured, since their
/// pictures hold light. None: stopped.
std::optional<SceneLight> measure_scene_light(const importer::Scene& scene, const LightRays& rays, const ClosedVertices& closed,
                                              model::Model& model, const Progress& progress);
/// Vertices that came later, of boxes, see all of the sun and no lamp.
void fill_scene_light(model::Model& model);

}  // namespace surefoot::bake
