// One tree of what is opaque, and two rounds over the lit vertices.
#include "render/bake/scene_light.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "render/bake/ground.hpp"
#include "render/bake/stage.hpp"

namespace surefoot::bake {

namespace {

const ForAll on_all_cores = [](std::size_t count, const std::function<void(std::size_t)>& body) { for_all(count, body); };

/// How many materials glow where most triangles do; else 0. Then a program wrote its ambient light as emission, for which the
/// light of rooms and sky stands. A scene of few materials may well glow.
std::size_t ambient_materials(const importer::Scene& scene) {
    constexpr std::size_t min_materials = 4;
    std::uint64_t all = 0, glowing = 0;
    const auto glows = [&](const importer::Primitive& p) {
        const vec3& emission = scene.materials[p.material].emission;
        return std::max({emission.r, emission.g, emission.b}) > 0;
    };
    std::vector<bool> used(scene.materials.size(), false);
    for (const importer::Node& node : scene.nodes) {
        if (node.mesh == importer::none) continue;
        for (const importer::Primitive& p : scene.meshes[node.mesh].primitives) {
            all += p.indices.size();
            if (!glows(p)) continue;
            glowing += p.indices.size();
            used[p.material] = true;
        }
    }
    const auto materials = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
    return 2 * glowing > all && materials >= min_materials ? materials : 0;
}

/// By material of the model. Copies without the sun glow as what they are copies of.
std::vector<vec3> emission_of(const importer::Scene& scene, model::Model& model, const Openness& openness) {
    std::vector<vec3> out(model.materials.size(), vec3(0));
    if (const std::size_t count = ambient_materials(scene); count > 0) {
        model.provenance.warnings.push_back(
            fmt::format("{} materials glow, on most of the scene: that is taken for ambient light, and not used", count));
        return out;
    }
    for (std::size_t m = 0; m < scene.materials.size(); ++m) out[m] = scene.materials[m].emission;
    for (const auto& [copy, original] : openness.copies) out[copy] = out[original];
    return out;
}

}  // namespace

std::unique_ptr<LightRays> make_light_rays(const importer::Scene& scene, const Progress& progress) {
    return std::make_unique<LightRays>(make_opaque_ground(scene, progress), make_leaf_ground(scene, progress), scene);
}

RefinedMeshes refine_scene(const importer::Scene& scene, const model::Model& model, const LightRays& rays,
                           const Progress& progress) {
    Stage stage(progress, "cutting for light", 1);
    const RefineLight light{glm::normalize(model.sun_direction), model.light, &rays.opaque, &rays.lamps, &rays.leaves};
    RefinedMeshes refined = refine_for_light(scene, light, on_all_cores, [&] { return progress.stopped(); });
    stage.step();
    return refined;
}

std::vector<SkySides> find_scene_sides(std::span<const MeshInPlaces> meshes, const model::Model& model, const LightRays& rays,
                                       const Progress& progress) {
    Stage stage(progress, "sky", sky_steps(meshes));
    return find_sky_sides(meshes, model.materials, rays.opaque, on_all_cores, [&] { return stage.step(); });
}

std::optional<SceneLight> measure_scene_light(const importer::Scene& scene, const LightRays& rays, const ClosedVertices& closed,
                                              model::Model& model, const Progress& progress) {
    SceneLight found;
    {
        Stage stage(progress, "light", openness_steps(model));
        found.openness = measure_openness(model, rays.opaque, closed, on_all_cores, [&] { return stage.step(); });
    }
    if (progress.stopped()) return {};
    const std::vector<vec3> emission = emission_of(scene, model, found.openness);
    Stage stage(progress, "shadows", baked_light_steps(model));
    found.baked = measure_baked_light(model, {rays.lamps, emission, found.openness.within, rays.opaque, &rays.leaves},
                                      on_all_cores, [&] { return stage.step(); });
    if (progress.stopped()) return {};
    return found;
}

void set_own_light(const importer::Scene& scene, const std::optional<model::SunTime>& time, double fog_visibility_m,
                   model::Model& model) {
    if (scene.sun) model.sun_direction = scene.sun->towards;
    if (time) {
        model.sun_direction = model::towards_sun(*time);
        model.light = {time->day, time->latitude_deg};
    }
    model.light.fog_visibility_m = static_cast<float>(fog_visibility_m);
}

void fill_scene_light(model::Model& model) {
    if (!model.sun_seen.empty()) model.sun_seen.resize(model.vertices.size(), model::always_in_sun);
    if (!model.lamp_light.empty()) model.lamp_light.resize(model.vertices.size());
}

}  // namespace surefoot::bake
