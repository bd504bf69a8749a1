// Effects spread over materials, by what the vertices of each hold.
#include "tools/accuracy/all_on.hpp"

#include <algorithm>
#include <cstddef>

#include "render/effects/effects.hpp"

namespace surefoot::accuracy {

namespace {

/// A material, and whether anything is drawn with it.
struct Held {
    effects::MaterialUse use;
    bool any_part = false;
};

std::vector<Held> held_by_materials(const model::Model& m) {
    std::vector<Held> out(m.materials.size());
    for (const model::Part& part : m.parts) {
        Held& held = out[part.material];
        effects::MaterialUse& use = held.use;
        held.any_part = true;
        const bool two_sided = m.materials[part.material].two_sided;
        for (std::uint32_t i = 0; i < part.index_count; ++i) {
            const model::Vertex& v = m.vertices[part.first_vertex + m.indices[part.first_index + i]];
            use.white = use.white && std::ranges::all_of(v.colour, [](std::uint8_t c) { return c == 255; });
            use.open = use.open && std::ranges::all_of(v.hidden, [](std::uint8_t h) { return h == 0; });
            use.no_sky = use.no_sky && v.hidden[0] == 255 && (!two_sided || v.hidden[1] == 255);
        }
    }
    return out;
}

model::Index add_white_texture(model::Model& m) {
    model::Texture white{};
    white.width = white.height = white.levels = 1;
    white.first_byte = m.texels.size();
    m.texels.insert(m.texels.end(), 4, std::byte{255});
    m.textures.push_back(white);
    return static_cast<model::Index>(m.textures.size() - 1);
}

/// Those of `all` that the material may have besides its own, its picture staying as it is.
model::EffectMask addable(const model::Material& material, effects::MaterialUse use, model::EffectMask all) {
    use.effects = material.effects;
    for (const effects::EffectModule& module : effects::all_effects())
        if ((all & module.bit) != 0 && module.changes_nothing != nullptr && module.changes_nothing(use))
            use.effects |= module.bit;
    return use.effects & ~material.effects;
}

}  // namespace

std::vector<TrianglesByEffect> triangles_of_reps(const model::Model& m) {
    std::vector<TrianglesByEffect> out(m.reps.size(), TrianglesByEffect{});
    for (std::size_t r = 0; r < m.reps.size(); ++r) {
        const model::Representation& rep = m.reps[r];
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
            for (std::size_t e = 0; e < out[r].size(); ++e)
                if ((m.materials[m.parts[p].material].effects >> e & 1U) != 0) out[r][e] += m.parts[p].index_count / 3;
    }
    return out;
}

TrianglesByEffect triangles_of_full_detail(const model::Model& m, std::uint64_t& all) {
    TrianglesByEffect out{};
    all = 0;
    const std::vector<TrianglesByEffect> of_reps = triangles_of_reps(m);
    for (const model::Node& node : m.nodes) {
        if (node.child_count > 0) continue;
        const model::Index full = node.first_rep + node.rep_count - 1;
        all += m.reps[full].triangles;
        for (std::size_t e = 0; e < out.size(); ++e) out[e] += of_reps[full][e];
    }
    return out;
}

std::uint32_t programs_of(const model::Model& m, model::EffectMask off) {
    std::vector<model::EffectMask> masks;
    for (const model::Part& part : m.parts) masks.push_back(m.materials[part.material].effects & ~off);
    std::sort(masks.begin(), masks.end());
    return static_cast<std::uint32_t>(std::unique(masks.begin(), masks.end()) - masks.begin());
}

AllOn turn_all_on(model::Model& m) {
    AllOn out;
    const TrianglesByEffect before = triangles_of_full_detail(m, out.triangles);
    const std::vector<Held> held = held_by_materials(m);
    model::EffectMask all = 0;
    for (std::size_t i = 0; i < held.size(); ++i)
        if (held[i].any_part) all |= m.materials[i].effects;
    const model::Index white = (all & model::effect_texture) != 0 ? add_white_texture(m) : model::none;
    for (std::size_t i = 0; i < held.size(); ++i) {
        model::Material& material = m.materials[i];
        const model::EffectMask added = addable(material, held[i].use, all);
        if ((added & model::effect_texture) != 0) material.texture = white;
        if ((added & model::effect_alpha_mask) != 0) material.alpha_cutoff = 0;
        material.effects |= added;
    }
    for (model::Representation& rep : m.reps)
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
            rep.effects |= m.materials[m.parts[p].material].effects;
    std::uint64_t same = 0;
    const TrianglesByEffect after = triangles_of_full_detail(m, same);
    for (const effects::EffectModule& module : effects::all_effects()) {
        if ((all & module.bit) == 0) continue;
        const std::size_t e = out.effects.size();
        out.effects.push_back({std::string(module.name), 0, 0, ""});
        for (std::size_t bit = 0; bit < after.size(); ++bit) {
            if (module.bit != 1U << bit) continue;
            out.effects[e].triangles = before[bit];
            out.effects[e].all_on_triangles = after[bit];
            if (after[bit] < out.triangles) out.effects[e].why_not = module.not_everywhere;
        }
    }
    return out;
}

}  // namespace surefoot::accuracy
