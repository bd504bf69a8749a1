// The baked model, as a .walk file holds it: flat arrays of nodes, representations, parts, geometry, materials.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/model/daylight.hpp"
#include "render/model/effects.hpp"
#include "render/model/ground.hpp"
#include "render/model/motion.hpp"
#include "render/model/moving_ground.hpp"
#include "render/model/picture_loss.hpp"
#include "rt/base/geometry.hpp"
#include "rt/base/named.hpp"
#include "rt/base/page_memory.hpp"
#include "rt/base/path.hpp"
#include "rt/base/result.hpp"

namespace surefoot::model {

using Index = std::uint32_t;
constexpr Index none = 0xffffffffU;

/// One layout of 32 bytes for all meshes. A program reads only the attributes that its effects need.
struct Vertex {
    float position[3];       ///< in the geometry's own frame, metres before its Placement
    std::int8_t normal[4];   ///< unit normal * 127; w unused
    std::uint8_t colour[4];  ///< RGBA, sRGB-encoded as in the source; white where the source has none
    float uv[2];             ///< texture coordinates, repeat
    /// Shares of 255 that are hidden: of the sky before and behind the surface, and of the room before and behind it. Zero where
    /// it was not measured. Read with effect_openness.
    std::uint8_t hidden[4]{};
};
static_assert(sizeof(Vertex) == 32);

/// world = origin + linear * v. det(linear) < 0: mirrored. Shared by all representations of one placed object.
struct Placement {
    dvec3 origin{0.0};
    mat3 linear{1.0F};    ///< column-major; |det| > 0
    Index motion = none;  ///< in Model::motions: what it is moved by from where it stands at rest; none: it stands still
};

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

/// A material: factors, texture and alpha test.
struct Material {
    std::array<float, 4> colour{1, 1, 1, 1};  ///< RGBA factor
    Index texture = none;
    float alpha_cutoff = 0.5F;  ///< used when alpha == mask
    AlphaMode alpha = AlphaMode::opaque;
    bool two_sided = false;
    EffectMask effects = 0;  ///< effects that drawing with it needs, sun and vertex colour included
};

/// RGBA8, sRGB-encoded; all mip levels, largest first, level i of max(1, w >> i) x max(1, h >> i), tightly packed.
struct Texture {
    std::uint32_t width = 0, height = 0, levels = 0;
    std::uint64_t first_byte = 0;  ///< in Model::texels
    bool clamp = false;            ///< else repeat
};

/// A range of triangles with one material: the unit of drawing.
struct Part {
    Index material = 0;
    std::uint32_t first_index = 0, index_count = 0;    ///< in Model::indices; count % 3 == 0; counter-clockwise front
    std::uint32_t first_vertex = 0, vertex_count = 0;  ///< indices are relative to first_vertex and < vertex_count
};

enum class RepKind : std::uint8_t { mesh, colour_box, textured_box };

/// One drawable form of a node.
struct Representation {
    RepKind kind = RepKind::mesh;
    bool everywhere = true;    ///< valid for the eye anywhere, inside included; false for boxes
    float error_m = 0;         ///< upper bound of the two-sided distance to the node's full detail, world metres
    float min_distance_m = 0;  ///< valid only when the eye is at least this far from the node's box (0: everywhere)
    Index placement = 0;
    Index first_part = 0;
    std::uint32_t part_count = 0;
    std::uint32_t triangles = 0;
    EffectMask effects = 0;  ///< union over its parts
    /// Rasterised area in m^2 seen along the world axes x, y, z, overdraw included. Sum over triangles of area * |n_axis|, halved
    /// where back faces are culled. Pixels ~ area / distance^2.
    std::array<float, 3> area_m2{};
};

enum class NodeKind : std::uint8_t { cluster, object, piece };
inline constexpr std::array<std::string_view, 3> node_kinds = {"cluster", "object", "piece"};  ///< in the order of NodeKind
constexpr std::string_view name_of(NodeKind kind) { return node_kinds[static_cast<std::size_t>(kind)]; }

/// A node of the hierarchy. Children are contiguous and come after their parent; node 0 is the root.
struct Node {
    Box box;  ///< world, of the full detail below, at all times where it moves
    Index parent = none;
    Index first_child = none;
    std::uint32_t child_count = 0;  ///< 0: a leaf; its finest representation is the full detail
    Index first_rep = 0;
    std::uint32_t rep_count = 0;  ///< >= 1; coarse to fine: error falls, triangles rise; >= 1 is valid everywhere
    Index name = none;            ///< offset in Model::names
    Index object = none;          ///< index of the conceptual object (leaves and pieces), none for clusters
    float importance = 1.0F;      ///< 0..1
    NodeKind kind = NodeKind::cluster;
    std::uint64_t triangles = 0;  ///< full detail below
};

/// Error, before placing, of a leaf's full detail without what its masks hide. It shows the same. The error is there because
/// errors fall from form to form.
constexpr float trimmed_error_m = 1e-9F, max_trimmed_error_m = 1e-6F;
/// Angular errors up to this count as none. Trimmed forms have no more at any distance. A pixel of 1280 x 720 has 70 times as
/// much.
constexpr float exact_up_to_rad = 2e-5F;

/// Whether the representation shows the node's full detail: the finest of a leaf, or the same without what its masks hide.
inline bool is_full_detail(const Node& node, Index rep, float error_m) {
    return node.child_count == 0 && (rep + 1 == node.first_rep + node.rep_count || error_m <= max_trimmed_error_m);
}

/// Sources, warnings and quality of the bake. Shown by `inspect`.
struct Provenance {
    std::vector<std::string> sources;
    std::string quality;                ///< draft | full
    std::vector<std::string> warnings;  ///< one line each: "Mesh 'lamp': 12 triangles are dropped: zero area"
};

/// A baked model: the tree and its representations in flat arrays. Constant while a walk runs; any thread may read it.
struct Model {
    std::vector<Node> nodes;
    std::vector<Representation> reps;
    std::vector<PictureLoss> losses;        ///< one a representation; empty: not measured
    std::vector<LossOfGroup> group_losses;  ///< of clusters' forms, by LossGroups; empty: not measured
    ColourSpread colours;                   ///< of what the leaves show, as measured with the losses
    std::vector<Part> parts;
    std::vector<Placement> placements;
    std::vector<Motion> motions;  ///< empty where nothing moves
    std::vector<MotionKey> motion_keys;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t> indices;
    std::vector<std::byte, PageMemory<std::byte>> texels;  ///< empty in an Engine: the device holds them
    std::string names;                                     ///< zero-terminated strings, offset 0 is ""
    std::vector<EffectFinding> effects;                    ///< one an effect, bit order
    Ground ground;                                         ///< for walking; empty in older files
    MovingGround moving_ground;                            ///< what of it moves
    Path tour;                                             ///< the default path; empty in older files
    std::string tour_kind;                                 ///< what it does: "through its free space"
    std::uint32_t object_count = 0;
    dvec3 sun_direction{0.36, 0.80, 0.48};  ///< towards the sun, unit
    LightFacts light;
    std::vector<SunSeen> sun_seen;      ///< by vertex; empty: not called for
    std::vector<LampLight> lamp_light;  ///< by vertex; empty: not called for
    Provenance provenance;

    [[nodiscard]] const char* name_of(const Node& node) const { return node.name == none ? "" : names.c_str() + node.name; }
    [[nodiscard]] EffectMask called_for() const;  ///< union of the findings
    [[nodiscard]] std::uint64_t triangles() const { return nodes.empty() ? 0 : nodes[0].triangles; }
};

/// The motion of a node's forms, which all move alike; none: they stand still. Children of a still node may move.
inline Index motion_of(const Model& model, const Node& node) {
    return model.motions.empty() ? none : model.placements[model.reps[node.first_rep].placement].motion;
}

/// Checks every index, range, order and number on which the renderer relies. Errors name array and element.
/// Run on every model that comes from a file.
Result<void> validate(const Model& model);

/// Calls use(const Material&, const vec3& a, const vec3& b, const vec3& c) for every triangle of a part. Corners are in the
/// part's coordinates; Representation::placement maps them to the world.
template <class Use>
void for_triangles(const Model& model, Index of_part, Use use) {
    const Part& part = model.parts[of_part];
    const auto corner = [&](std::uint32_t i) {
        const float* v = model.vertices[part.first_vertex + model.indices[part.first_index + i]].position;
        return vec3(v[0], v[1], v[2]);
    };
    for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3)
        use(model.materials[part.material], corner(i), corner(i + 1), corner(i + 2));
}

/// The same for every part of a representation, in order.
template <class Use>
void for_triangles(const Model& model, const Representation& rep, Use use) {
    for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) for_triangles(model, p, use);
}

/// The forms in which a node may be drawn: a name and help for each RepKind, in its order.
inline constexpr std::array forms = {
    Named{"mesh", "triangles, coarse to fine"},
    Named{"colour_box", "a box with one mean colour a side"},
    Named{"textured_box", "a box with captured images on its sides"},
};

constexpr const Named& form_of(RepKind kind) { return forms[static_cast<std::size_t>(kind)]; }

static_assert(form_of(RepKind::mesh).name == "mesh" && form_of(RepKind::textured_box).name == "textured_box");
static_assert(forms.size() == static_cast<std::size_t>(RepKind::textured_box) + 1);

}  // namespace surefoot::model
