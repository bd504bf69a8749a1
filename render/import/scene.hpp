// What importers make: meshes, materials, images, and a tree of named, placed nodes; and what they had to mend.
#pragma once

#include <array>
#include <cstdint>
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

struct Material {
    std::string name;
    std::array<float, 4> colour{1, 1, 1, 1};
    Index image = none;
    float alpha_cutoff = 0.5F;
    model::AlphaMode alpha = model::AlphaMode::opaque;
    bool two_sided = false;
    bool unlit = false;
    std::vector<std::string> lacks = {};  ///< what the file asks for and has not got: pictures, the material itself
};

/// Triangles of one material. Optional arrays are empty or as long as positions. Colours are sRGB-encoded, as a Material's
/// and an Image's are (glTF's linear ones are encoded on import); v = 0 of a uv is the picture's top row.
struct Primitive {
    std::vector<vec3> positions;  ///< finite, metres in the mesh's frame
    std::vector<vec3> normals;    ///< unit
    std::vector<vec2> uvs;
    std::vector<std::array<std::uint8_t, 4>> colours;
    std::vector<std::uint32_t> indices;  ///< triples, each < positions.size(), no two equal, area > 0
    Index material = 0;
};

struct Mesh {
    std::string name;
    std::vector<Primitive> primitives;
    std::vector<std::string> lacks = {};  ///< what of it is broken or left out
};

/// parent < own index (parents come first), none for roots.
struct Node {
    std::string name;
    Index parent = none;
    Index mesh = none;
    dmat4 world{1.0};  ///< mesh frame to world
    float importance = 1.0F;
};

/// Something drawn that a file asks for and has not got.
struct Damage {
    std::string file, what;
};

struct Scene {
    std::vector<Mesh> meshes;
    std::vector<Node> nodes;
    std::vector<Material> materials;  ///< at least one
    std::vector<image::Image> images;
    std::vector<std::string> sources;
    std::vector<std::string> warnings;              ///< what was repaired or dropped, one line each with counts
    std::vector<Damage> damage;                     ///< those of them that a person should mend: of things that are drawn
    void damaged(std::string line);                 ///< a warning, and damage whatever is drawn
    [[nodiscard]] std::uint64_t triangles() const;  ///< instances counted each
};

/// By ending (formats.hpp). Several files become one scene.
/// Errors: missing, empty or truncated file, unknown ending, nothing drawable in it. Missing textures: damage, and white.
Result<Scene> import_files(const std::vector<std::string>& files, const Progress& progress);

Result<Scene> import_gltf(const std::string& file, const Progress& progress);
Result<Scene> import_obj(const std::string& file, const Progress& progress);

/// Drops what is not finite, out of range, repeated or of zero area, and says so in `warnings`; renormalises normals, and
/// makes those that are missing (the triangles' mean by area). Vertices that no triangle uses go. Every importer ends with it.
void clean(Primitive& primitive, const std::string& mesh_name, std::vector<std::string>& warnings);

}  // namespace surefoot::importer
