// Light that does not move: which vertices the sun reaches at which hour, and what lamps and glowing surfaces give them.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/bake/lamp_field.hpp"
#include "render/bake/picture_tree.hpp"
#include "render/bake/ray_tree.hpp"
#include "render/model/model.hpp"

namespace surefoot::bake {

/// What light was found.
struct BakedLight {
    std::uint64_t vertices = 0, in_shadow = 0;  ///< in the sun's programs, and of these without it at some moment of the day
    std::uint64_t lit = 0;                      ///< by lamps, or glowing
};

/// What shines on a model, and what hides it.
struct LightInput {
    const LampField& lamps;
    const std::vector<vec3>& emission;        ///< by material of the model
    const std::vector<std::uint8_t>& within;  ///< Openness::within
    const RayTree& opaque;
    const RayTree* leaves = nullptr;  ///< lets a third of the sun through; null: nothing does
};

/// Fills Model::sun_seen, lamp_light and light, and gives lit materials effect_shadow and effect_lamps, each only if something is
/// in shadow or lit. Call it after measure_openness(), which decides what the sun's programs draw. As there, `step` is called
/// baked_light_steps() times, on any thread, and ends it if it returns false.
BakedLight measure_baked_light(model::Model& model, const LightInput& input, const ForAll& for_all,
                               const std::function<bool()>& step);
std::size_t baked_light_steps(const model::Model& model);
/// Adds what was measured to the findings of shadows and lamps, and how far the fog lets see.
void add_to_findings(const BakedLight& baked, const model::LightFacts& facts, std::vector<model::EffectFinding>& findings);

}  // namespace surefoot::bake
