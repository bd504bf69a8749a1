// Geometry and representations into the model's flat arrays.
#include "render/bake/emit.hpp"

#include <algorithm>
#include <cmath>

#include "render/bake/alpha_bleed.hpp"
#include "render/bake/materials.hpp"
#include "render/bake/objects.hpp"
#include "render/effects/effects.hpp"

namespace surefoot::bake {

void clear_emitted(model::Model& model) {
    model.names.assign(1, '\0');
    model.vertices.clear();
    model.indices.clear();
    model.parts.clear();
    model.placements.clear();
    model.reps.clear();
    model.nodes.clear();
}

model::Index add_name(model::Model& model, const std::string& name) {
    if (name.empty()) return 0;
    const auto at = static_cast<model::Index>(model.names.size());
    model.names += name;
    model.names.push_back('\0');
    return at;
}

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

void emit_representations(const EmittedChain& emitted, const dmat4& world, model::Model& model, model::Index motion) {
    model::Placement placement;
    placement.motion = motion;
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
        if (level.error_m == model::trimmed_error_m) rep.error_m = std::min(rep.error_m, model::max_trimmed_error_m);
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

constexpr std::uint32_t columns = 3, rows = 2;  // of faces in a picture
constexpr float shown_alpha = 0.5F;

/// The cell of a face, and the rim about it.
struct Cells {
    std::uint32_t cell, rim;
    explicit Cells(std::uint32_t pixels) : cell(pixels * 8 / 7), rim((cell - pixels) / 2) {}
};

/// A material that shows the box's six pictures.
model::Index add_box_material(const BoxForm& form, model::Model& model) {
    const Cells cells(form.pixels);
    const std::uint32_t n = form.pixels, width = columns * cells.cell, height = rows * cells.cell;
    std::vector<std::uint8_t> atlas(std::size_t{4} * width * height);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const FaceCapture& face = form.faces[y / cells.cell * columns + x / cells.cell];
            const auto inside = [&](std::uint32_t at) {
                return std::clamp(at % cells.cell, cells.rim, cells.rim + n - 1) - cells.rim;
            };
            const std::size_t from = static_cast<std::size_t>(inside(y)) * n + inside(x);
            std::copy_n(&face.rgba[4 * from], 4, &atlas[4 * (static_cast<std::size_t>(y) * width + x)]);
        }
    }
    bleed_colours(atlas, width, height, true, 0);
    std::uint32_t levels = 1;
    while (cells.rim >> levels != 0) ++levels;
    model::Material m;
    m.texture = add_texture(model, atlas, width, height, true, levels, 255 * shown_alpha);
    m.alpha = model::AlphaMode::mask;
    m.two_sided = true;  // the far half shows through this one's holes
    m.alpha_cutoff = shown_alpha;
    effects::MaterialFacts facts;
    facts.image = true;
    facts.in_fog = model.light.fog_visibility_m > 0;
    facts.alpha = m.alpha;
    m.effects = effects::called_for_by(facts) | (form.lit ? model::effect_lit_picture : model::EffectMask{0});
    model.materials.push_back(m);
    return static_cast<model::Index>(model.materials.size() - 1);
}

/// To the vertex that was added last. Those before it without light of their own see all of the sun and no lamp.
void give_light(const FaceLight& light, std::size_t corner, model::Model& model) {
    std::copy(light.of_all.from.begin(), light.of_all.from.end(), model.vertices.back().hidden);
    model.sun_seen.resize(model.vertices.size(), model::always_in_sun);
    model.sun_seen.back() = light.of_all.sun;
    if (model.lamp_light.empty()) return;
    model.lamp_light.resize(model.vertices.size());
    std::copy(light.lamps[corner].begin(), light.lamps[corner].end(), model.lamp_light.back().before);
}

/// One face: four vertices and two triangles. `f`: down and up along x, y, z. Only its part that shows something.
void emit_face(const BoxForm& form, std::uint32_t f, model::Model& model, model::Part& part) {
    const vec3 half(form.box.half());
    const int axis = static_cast<int>(f) / 2, u = (axis + 1) % 3, w = (axis + 2) % 3;
    const bool high = f % 2 == 1;
    const std::uint32_t base = part.vertex_count;
    const Cells cells(std::max(form.pixels, 8U));
    const std::uint32_t left = f % columns * cells.cell + cells.rim, low = f / columns * cells.cell + cells.rim;
    const auto n = static_cast<float>(form.pixels);
    const std::array<std::uint32_t, 4> shown =
        form.textured ? shown_texels(form.faces[f], form.pixels) : std::array<std::uint32_t, 4>{0, 0, form.pixels, form.pixels};
    for (int corner = 0; corner < 4; ++corner) {
        const bool cu = (corner == 1 || corner == 2) == high, cw = corner >= 2;  // counter-clockwise from outside
        const auto x = static_cast<float>(shown[cu ? 2 : 0]), y = static_cast<float>(shown[cw ? 3 : 1]);
        model::Vertex v{};
        v.position[axis] = high ? half[axis] : -half[axis];
        v.position[u] = half[u] * (2 * x / n - 1);
        v.position[w] = half[w] * (2 * y / n - 1);
        v.normal[axis] = high ? 127 : -127;
        for (std::size_t k = 0; k < 4; ++k) v.colour[k] = form.textured ? 255 : form.faces[f].mean[k];
        v.uv[0] = (static_cast<float>(left) + x) / static_cast<float>(columns * cells.cell);
        v.uv[1] = (static_cast<float>(low) + y) / static_cast<float>(rows * cells.cell);
        model.vertices.push_back(v);
        if (form.lit) give_light(form.faces[f].light, (cw ? 2U : 0U) + (cu ? 1U : 0U), model);
    }
    part.vertex_count += 4;
    for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) model.indices.push_back(base + i);
    part.index_count += 6;
}

}  // namespace

void emit_box(const BoxForm& form, model::Index proxy, model::Model& model, model::Index motion) {
    const model::Index material = form.textured ? add_box_material(form, model) : proxy;
    model::Representation rep;
    rep.kind = form.textured ? model::RepKind::textured_box : model::RepKind::colour_box;
    rep.everywhere = false;
    rep.error_m = form.error_m;
    rep.min_distance_m = static_cast<float>(0.5 * form.box.diagonal());
    rep.placement = static_cast<model::Index>(model.placements.size());
    model.placements.push_back({form.box.centre(), mat3(1.0F), motion});
    rep.first_part = static_cast<model::Index>(model.parts.size());
    rep.part_count = 1;
    rep.effects = model.materials[material].effects;
    model::Part part{material, static_cast<std::uint32_t>(model.indices.size()), 0,
                     static_cast<std::uint32_t>(model.vertices.size()), 0};
    for (std::uint32_t f = 0; f < box_faces; ++f) {
        if (form.faces[f].covered > 0) emit_face(form, f, model, part);
    }
    rep.triangles = part.index_count / 3;
    model.parts.push_back(part);
    model.reps.push_back(rep);
}

}  // namespace surefoot::bake
