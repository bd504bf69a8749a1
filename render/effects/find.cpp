// Which effects a model calls for, with the evidence: from the materials of its parts.
#include <fmt/format.h>

#include <set>

#include "render/effects/effects.hpp"

namespace surefoot::effects {

namespace {

struct Evidence {
    std::set<model::Index> materials, textures;
    std::uint64_t triangles = 0;  ///< of full detail
    std::uint64_t parts = 0;
};

void collect(const model::Model& model, const model::Representation& rep, bool full_detail, model::EffectMask bit,
             Evidence& found) {
    for (std::uint32_t p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        const model::Part& part = model.parts[p];
        const model::Material& material = model.materials[part.material];
        if ((material.effects & bit) == 0) continue;
        found.materials.insert(part.material);
        if (material.texture != model::none) found.textures.insert(material.texture);
        ++found.parts;
        if (full_detail) found.triangles += part.index_count / 3;
    }
}

std::string counted(std::uint64_t n, std::string_view one, std::string_view many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::string reason(model::Effect bit, const Evidence& found) {
    const std::string materials = counted(found.materials.size(), "material", "materials");
    std::string text;
    switch (bit) {
        case model::effect_texture:
            text = fmt::format("{} on {}", counted(found.textures.size(), "image", "images"), materials);
            break;
        case model::effect_vertex_colour:
            text = fmt::format("colours at the vertices of {}", counted(found.parts, "part", "parts"));
            break;
        case model::effect_sun:
            text = fmt::format("{} with normals, lit", materials);
            break;
        case model::effect_alpha_mask:
            text = fmt::format("{} with holes (alpha mode mask)", materials);
            break;
        case model::effect_blend:
            text = fmt::format("{} see-through (alpha mode blend)", materials);
            break;
    }
    if (found.triangles == 0) text += ", on stand-ins only";
    return text;
}

}  // namespace

std::vector<model::EffectFinding> find_effects(const model::Model& model) {
    std::vector<model::EffectFinding> findings;
    for (const EffectModule& module : all_effects()) {
        Evidence found;
        for (const model::Node& node : model.nodes) {
            for (std::uint32_t r = 0; r < node.rep_count; ++r) {
                const bool full = node.child_count == 0 && r + 1 == node.rep_count;
                collect(model, model.reps[node.first_rep + r], full, module.bit, found);
            }
        }
        model::EffectFinding finding;
        finding.bit = module.bit;
        finding.called_for = found.parts > 0;
        finding.triangles = found.triangles;
        finding.reason = found.parts > 0 ? reason(module.bit, found) : fmt::format("no {}", module.asked_by.substr(2));
        findings.push_back(std::move(finding));
    }
    return findings;
}

}  // namespace surefoot::effects
