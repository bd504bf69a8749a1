// The result of an importer: meshes, materials, images, a tree of named and placed nodes, warnings and damage.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/image/image.hpp"
#include "render/model/model.hpp"
#include "rt/base/geometry.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"

namespace surefoot::importer {

using Index = std::uint32_t;
constexpr Index none = model::none;

/// Where the light of a surface is worked out: as the bake says, once a triangle, at the vertices, or for each pixel.
enum class LightPlace : std::uint8_t { by_bake, flat, vertex, pixel };

/// A material of the scene.
struct Material {
    std::string name;
    std::array<float, 4> colour{1, 1, 1, 1};
    Index image = none;
    float alpha_cutoff = 0.5F;
    model::AlphaMode alpha = model::AlphaMode::opaque;
    bool two_sided = false;
    bool unlit = false;
    std::optional<bool> water = {};  ///< as its file says
    LightPlace light = LightPlace::by_bake;
    vec3 emission{0};             ///< linear RGB of the light that it sends out by itself; finite, 0 or more, strength included
    bool emission_image = false;  ///< the file spreads its glow by an image, which is not used: emission is 0
    std::vector<std::string> lacks = {};  ///< missing things that the file asks for: images, the material itself
};

/// Triangles of one material. Optional arrays are empty or as long as positions. Colours are sRGB-encoded, as in Material and
/// Image; linear colours of glTF are encoded on import. v = 0 of a uv is the top row of the image.
struct Primitive {
    std::vector<vec3> positions;  ///< finite, metres in the mesh's frame
    std::vector<vec3> normals;    ///< unit
    std::vector<vec2> uvs;
    std::vector<std::array<std::uint8_t, 4>> colours;
    std::vector<std::uint32_t> indices;  ///< triples, each < positions.size(), no two equal, area > 0
    Index material = 0;
};

/// A mesh: one primitive for each of its materials.
struct Mesh {
    std::string name;
    std::vector<Primitive> primitives;
    std::vector<std::string> lacks = {};  ///< its broken or missing data
};

/// Whether a walker is stopped: by the rules of the bake, or as the scene's author says.
enum class WalkRule : std::uint8_t { by_rule, block, pass };

/// parent < own index (parents come first), none for roots.
struct Node {
    std::string name;
    Index parent = none;
    Index mesh = none;
    dmat4 world{1.0};  ///< mesh frame to world
    float importance = 1.0F;
    WalkRule walk = WalkRule::by_rule;  ///< handed down to its children
    Index motion = none;                ///< in Scene::motions; handed down to its children, unless they have their own
};

/// A missing or broken thing that the scene draws.
struct Damage {
    std::string file, what;
};

/// A simpler mesh that an artist made for one seen from far.
struct StandIn {
    std::string name;
    Index of = none;  ///< mesh that it stands for, in all placements
    Mesh mesh;        ///< in the frame of that mesh
};

/// A distant light above the horizon.
struct Sun {
    std::string name;
    dvec3 towards{0, 1, 0};  ///< unit
    double intensity = 0;    ///< as the file has it, above 0
};

/// A light at one place: it shines in all directions, or as a spot. Falls off with the square of the distance.
struct Lamp {
    std::string name;
    dvec3 at{0};                            ///< finite, metres in the world
    dvec3 towards{0, -1, 0};                ///< unit; where a spot shines
    vec3 colour{1};                         ///< linear RGB, 0..1, not black
    double candela = 1;                     ///< above 0 and finite
    double range_m = 0;                     ///< lights nothing beyond; 0: no limit
    double cos_inner = -1, cos_outer = -1;  ///< of a spot: 1 >= cos_inner >= cos_outer >= 0; -1, -1: in all directions
    [[nodiscard]] bool spot() const { return cos_outer >= 0; }
};

/// A scene has no more lamps than this.
constexpr std::size_t max_lamps = 4096;

/// An imported scene, in metres with +Y up.
struct Scene {
    std::vector<Mesh> meshes;
    std::vector<Node> nodes;
    std::vector<Material> materials;  ///< at least one
    std::vector<image::Image> images;
    std::vector<StandIn> stand_ins;
    std::optional<Sun> sun;              ///< the brightest one
    double fog_visibility_m = 0;         ///< extras.fog_visibility_m of the glTF scene; 0: no fog
    bool sky = false;                    ///< extras.sky of the glTF scene: there is a sky behind everything
    std::vector<Lamp> lamps;             ///< the brightest max_lamps, in the file's order
    std::vector<model::Motion> motions;  ///< from where nodes stand at rest; outer ones come first
    std::vector<model::MotionKey> motion_keys;
    std::vector<std::string> sources;
    std::vector<std::string> warnings;              ///< repaired or dropped data, one line each with counts
    std::vector<Damage> damage;                     ///< warnings about drawn things, which a person should repair
    void damaged(std::string line);                 ///< adds a warning, and damage in any case
    [[nodiscard]] std::uint64_t triangles() const;  ///< instances counted each
};

/// Adds all of one scene to another. Of more than max_lamps lamps the brightest stay; a warning counts the others. Of two suns
/// the brighter one stays, and of two fogs the thicker one. A sky is there for both. Of too many motions the first ones stay.
void append(Scene& to, Scene&& from);

/// By ending (formats.hpp), with the stand-ins listed beside each file (stand_ins.hpp). Several files become one scene.
/// Errors: missing, empty or truncated file; unknown ending; nothing drawable. Missing textures are damage, and white.
Result<Scene> import_files(const std::vector<std::string>& files, const Progress& progress);

Result<Scene> import_gltf(const std::string& file, const Progress& progress);
Result<Scene> import_obj(const std::string& file, const Progress& progress);

/// Drops triangles that are not finite, out of range, repeated or of zero area; adds a line to `warnings` for each kind.
/// Normalises normals, and makes missing ones (area-weighted mean of the triangles). Drops unused vertices.
void clean(Primitive& primitive, const std::string& mesh_name, std::vector<std::string>& warnings);

}  // namespace surefoot::importer
