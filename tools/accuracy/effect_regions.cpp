// Reasons by region, from the effects below its node.
#include "tools/accuracy/effect_regions.hpp"

#include <bit>

#include <fmt/format.h>

#include "render/effects/effects.hpp"
#include "render/model/effects_below.hpp"

namespace surefoot::accuracy {

namespace {

std::string region_name(const model::Model& m, const model::RegionEffects& below, const Box& box) {
    const dvec3 size = box.max - box.min;
    std::string object = below.largest == model::none ? "" : m.name_of(m.nodes[below.largest]);
    if (object.empty()) object = "an object without a name";
    const std::string others = below.leaves > 1 ? fmt::format(" and {} other leaves", below.leaves - 1) : "";
    return fmt::format("{}{}, {:.3g} x {:.3g} x {:.3g} m", object, others, size.x, size.y, size.z);
}

/// What was measured of light tells more than the materials. What no region has is explained by the whole model's finding.
std::string reason_of(const model::Model& m, const model::RegionEffects& below, const RegionEffect& effect,
                      const effects::EffectModule& module) {
    if (effect.called_for) return fmt::format("{} of {} triangles have it", effect.triangles, below.triangles);
    if (effect.coarse_only) return "coarse forms alone need it";
    const bool measured = (below.full & model::effect_openness) != 0;
    if (module.bit == model::effect_sun) return measured ? "no vertex sees any sky" : std::string(module.not_here);
    constexpr model::EffectMask of_sun = model::effect_shadow | model::effect_moving_shadow;
    if ((module.bit & of_sun) != 0 && measured && (below.full & model::effect_sun) == 0) return "the sun reaches nothing";
    for (const model::EffectFinding& f : m.effects)
        if (f.bit == module.bit && !f.called_for) return f.reason;
    return std::string(module.not_here);
}

}  // namespace

std::vector<EffectRegion> regions_of(const model::Model& m) {
    const std::vector<model::RegionEffects> below = model::effects_below(m);
    std::vector<EffectRegion> out;
    for (const model::Index n : model::main_regions(m, max_regions)) {
        EffectRegion region;
        region.node = n;
        region.box = m.nodes[n].box;
        region.name = region_name(m, below[n], region.box);
        region.leaves = below[n].leaves;
        region.triangles = below[n].triangles;
        for (const effects::EffectModule& module : effects::all_effects()) {
            RegionEffect effect;
            effect.name = module.name;
            effect.called_for = (below[n].full & module.bit) != 0;
            effect.coarse_only = !effect.called_for && (below[n].coarse & module.bit) != 0;
            effect.triangles = below[n].with_effect[static_cast<std::size_t>(std::countr_zero(module.bit + 0U))];
            effect.of_model = (m.called_for() & module.bit) != 0;
            effect.reason = reason_of(m, below[n], effect, module);
            region.effects.push_back(std::move(effect));
        }
        out.push_back(std::move(region));
    }
    return out;
}

std::string effects_in_words(const EffectRegion& region) {
    std::string full, coarse;
    const auto add = [](std::string& to, const std::string& name) { to += (to.empty() ? "" : ", ") + name; };
    for (const RegionEffect& effect : region.effects) {
        if (effect.called_for) add(full, effect.name);
        if (effect.coarse_only) add(coarse, effect.name);
    }
    if (full.empty()) full = "none";
    return coarse.empty() ? full : full + "; coarse forms: " + coarse;
}

std::string reasons_in_words(const EffectRegion& region) {
    const std::string sun = effects::effects_text(model::effect_sun);
    for (const RegionEffect& effect : region.effects)
        if (effect.name == sun) return fmt::format("{}: {}", effect.name, effect.reason);
    return {};
}

std::vector<std::string> reason_lines(const EffectRegion& region) {
    std::vector<std::string> lines;
    for (const RegionEffect& effect : region.effects)
        if (effect.of_model) lines.push_back(fmt::format("{}: {}", effect.name, effect.reason));
    return lines;
}

}  // namespace surefoot::accuracy
