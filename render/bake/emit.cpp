// Geometry and representations into the model's flat arrays.
#include "render/bake/emit.hpp"

#include <algorithm>
#include <cmath>

#include "render/bake/materials.hpp"
#include "render/bake/objects.hpp"

namespace surefoot::bake {

EmittedChain emit_chain(const LodChain& chain, model::Model& model) {
    EmittedChain out;
    out.chain = &chain;
    out.centre = chain.full.centre;
    const auto first_vertex = static_cast<std::uint32_t>(model.vertices.size());
    const auto vertex_count = static_cast<std::uint32_t>(chain.full.vertices.size());
    model.vertices.insert(model.vertices.end(), chain.full.vertices.begin(), chain.full.vertices.end());
    for (const Level& level : chain.levels) {
        EmittedChain::Level e{static_cast<model::Index>(model.parts.size()), 0, level.triangles, level.error_m, 0};
        for (const GeometryPart& part : level.parts) {
            model.parts.push_back({part.material, static_cast<std::uint32_t>(model.indices.size()),
                                   static_cast<std::uint32_t>(part.indices.size()), first_vertex, vertex_count});
            model.indices.insert(model.indices.end(), part.indices.begin(), part.indices.end());
            e.effects |= model.materials[part.material].effects;
            ++e.part_count;
        }
        out.levels.push_back(e);
    }
    return out;
}

void emit_representations(const EmittedChain& emitted, const dmat4& world, model::Model& model) {
    model::Placement placement;
    const dmat3 linear(world);
    placement.origin = dvec3(world * dvec4(emitted.centre, 1.0));
    placement.linear = mat3(linear);
    const auto index = static_cast<model::Index>(model.placements.size());
    model.placements.push_back(placement);
    const double stretch = largest_stretch(linear);
    bool first = true;
    for (const EmittedChain::Level& level : emitted.levels) {
        model::Representation rep;
        rep.error_m = static_cast<float>(level.error_m * stretch);
        // Rounding may make two errors equal: then the finer level gains nothing.
        if (!first && rep.error_m >= model.reps.back().error_m) continue;
        first = false;
        rep.placement = index;
        rep.first_part = level.first_part;
        rep.part_count = level.part_count;
        rep.triangles = level.triangles;
        rep.effects = level.effects;
        model.reps.push_back(rep);
    }
}

namespace {

/// A material that shows the box's six pictures.
model::Index add_box_material(const BoxForm& form, model::Index proxy, model::Model& model) {
    // Six pictures in one: three columns, two rows; no mip levels, they would mix the faces.
    const std::uint32_t n = form.pixels;
    std::vector<std::uint8_t> atlas(static_cast<std::size_t>(n) * n * 6 * 4);
    for (std::uint32_t f = 0; f < 6; ++f) {
        for (std::uint32_t y = 0; y < n; ++y) {
            const std::uint8_t* row = form.faces[f].rgba.data() + static_cast<std::size_t>(y) * n * 4;
            const std::size_t pixel = std::size_t{(f / 3) * n + y} * 3 * n + std::size_t{f % 3} * n;
            std::copy_n(row, n * 4, atlas.begin() + static_cast<std::ptrdiff_t>(pixel * 4));
        }
    }
    model::Material m;
    m.texture = add_texture(model, atlas, 3 * n, 2 * n, true, 1);
    m.alpha = model::AlphaMode::mask;
    m.two_sided = true;  // the far half shows through this one's holes
    m.alpha_cutoff = 0.5F;
    m.effects = model::effect_texture | model::effect_alpha_mask | (model.materials[proxy].effects & model::effect_sun);
    model.materials.push_back(m);
    return static_cast<model::Index>(model.materials.size() - 1);
}

/// One face: four vertices and two triangles. `f`: down and up along x, y, z.
void emit_face(const BoxForm& form, std::uint32_t f, model::Model& model, model::Part& part) {
    const vec3 half(form.box.half());
    const int axis = static_cast<int>(f) / 2, u = (axis + 1) % 3, w = (axis + 2) % 3;
    const bool high = f % 2 == 1;
    const std::uint32_t base = part.vertex_count;
    for (int corner = 0; corner < 4; ++corner) {
        const bool cu = (corner == 1 || corner == 2) == high, cw = corner >= 2;  // counter-clockwise from outside
        model::Vertex v{};
        v.position[axis] = high ? half[axis] : -half[axis];
        v.position[u] = cu ? half[u] : -half[u];
        v.position[w] = cw ? half[w] : -half[w];
        v.normal[axis] = high ? 127 : -127;
        for (std::size_t k = 0; k < 4; ++k) v.colour[k] = form.textured ? 255 : form.faces[f].mean[k];
        const float inset = 0.5F / static_cast<float>(std::max(1U, form.pixels));  // half a texel: neighbours stay out
        const auto column = f % 3, row = f / 3;
        v.uv[0] = (static_cast<float>(column) + (cu ? 1 - inset : inset)) / 3.0F;
        v.uv[1] = (static_cast<float>(row) + (cw ? 1 - inset : inset)) / 2.0F;
        model.vertices.push_back(v);
    }
    part.vertex_count += 4;
    for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) model.indices.push_back(base + i);
    part.index_count += 6;
}

}  // namespace

void emit_box(const BoxForm& form, model::Index proxy, model::Model& model) {
    const model::Index material = form.textured ? add_box_material(form, proxy, model) : proxy;
    model::Representation rep;
    rep.kind = form.textured ? model::RepKind::textured_box : model::RepKind::colour_box;
    rep.everywhere = false;
    rep.error_m = form.error_m;
    rep.min_distance_m = static_cast<float>(0.5 * form.box.diagonal());
    rep.placement = static_cast<model::Index>(model.placements.size());
    model.placements.push_back({form.box.centre(), mat3(1.0F)});
    rep.first_part = static_cast<model::Index>(model.parts.size());
    rep.part_count = 1;
    rep.effects = model.materials[material].effects;
    model::Part part{material, static_cast<std::uint32_t>(model.indices.size()), 0,
                     static_cast<std::uint32_t>(model.vertices.size()), 0};
    for (std::uint32_t f = 0; f < 6; ++f) {
        if (form.faces[f].covered > 0) emit_face(form, f, model, part);
    }
    rep.triangles = part.index_count / 3;
    model.parts.push_back(part);
    model.reps.push_back(rep);
}

}  // namespace surefoot::bake
