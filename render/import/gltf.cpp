// glTF 2.0 and GLB to a Scene: meshes once, nodes with their world matrices, instances kept.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/image/image.hpp"
#include "render/import/finish.hpp"
#include "render/import/gltf_parts.hpp"

namespace surefoot::importer {
namespace {

/// Strips and fans (glTF 2.0, 3.7.2.1) to triples; odd triangles of a strip are turned to keep their side.
std::vector<std::uint32_t> expand(const std::vector<std::uint32_t>& in, int mode) {
    if (mode == TINYGLTF_MODE_TRIANGLES) return in;
    std::vector<std::uint32_t> out;
    if (in.size() < 3) return out;
    out.reserve((in.size() - 2) * 3);
    for (std::size_t i = 0; i + 2 < in.size(); ++i) {
        const bool odd = i % 2 == 1;
        if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
            out.insert(out.end(), {in[0], in[i + 1], in[i + 2]});
        } else {
            out.insert(out.end(), {in[i], in[odd ? i + 2 : i + 1], in[odd ? i + 1 : i + 2]});
        }
    }
    return out;
}

template <class Vector>
Result<std::vector<Vector>> read_vectors(const tinygltf::Model& model, int accessor, std::size_t components,
                                         const std::string& place) {
    auto floats = read_floats(model, accessor, place);
    if (!floats) return floats.error();
    if (floats->components != components)
        return Error{place,
                     fmt::format("Accessor {} has {} components where {} belong", accessor, floats->components, components),
                     export_again, ErrorKind::damaged};
    std::vector<Vector> out(floats->count());
    static_assert(sizeof(Vector) % sizeof(float) == 0);
    std::copy(floats->values.begin(), floats->values.end(), out.empty() ? nullptr : &out[0][0]);
    return out;
}

Result<std::vector<std::array<std::uint8_t, 4>>> read_colours(const tinygltf::Model& model, int accessor,
                                                              const std::string& place) {
    auto floats = read_floats(model, accessor, place);
    if (!floats) return floats.error();
    if (floats->components < 3)
        return Error{place, fmt::format("Accessor {} has colours of {} components", accessor, floats->components), export_again,
                     ErrorKind::damaged};
    std::vector<std::array<std::uint8_t, 4>> out(floats->count());
    for (std::size_t i = 0; i < out.size(); ++i) {
        const float* c = floats->values.data() + i * floats->components;
        out[i] = {image::to_byte(image::encode_srgb(c[0])), image::to_byte(image::encode_srgb(c[1])),
                  image::to_byte(image::encode_srgb(c[2])), floats->components > 3 ? image::to_byte(c[3]) : std::uint8_t{255}};
    }
    return out;
}

struct Context {
    const tinygltf::Model& model;
    const std::string& file;
    const std::vector<TextureUse>& uses;
    Scene& scene;
};

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

void lack(const Context& context, Mesh& mesh, std::string what) {
    context.scene.warnings.push_back(what);
    mesh.lacks.push_back(std::move(what));
}

/// The attributes beside positions: one that cannot be read is left out, and the mesh lacks it; the triangles stay.
void read_attributes(const Context& context, const tinygltf::Primitive& from, const std::string& place, Mesh& mesh,
                     Primitive& to) {
    const auto left_out = [&](const char* what, const Error& why) { lack(context, mesh, what + in_short(why)); };
    if (const int at = attribute(from, "NORMAL"); at >= 0) {
        auto normals = read_vectors<vec3>(context.model, at, 3, place);
        if (normals)
            to.normals = std::move(*normals);
        else
            left_out("Normals are left out: ", normals.error());
    }
    const TextureUse& use = context.uses[to.material];
    if (const int at = attribute(from, fmt::format("TEXCOORD_{}", use.set)); at >= 0) {
        auto uvs = read_vectors<vec2>(context.model, at, 2, place);
        if (uvs)
            to.uvs = std::move(*uvs);
        else
            left_out("Texture coordinates are left out: ", uvs.error());
        if (!use.identity()) std::transform(to.uvs.begin(), to.uvs.end(), to.uvs.begin(), [&](vec2 uv) { return use.apply(uv); });
    }
    if (const int at = attribute(from, "COLOR_0"); at >= 0) {
        auto colours = read_colours(context.model, at, place);
        if (colours)
            to.colours = std::move(*colours);
        else
            left_out("Colours are left out: ", colours.error());
    }
}

Result<Primitive> read_primitive(const Context& context, const tinygltf::Primitive& from, const std::string& place, Mesh& mesh) {
    const tinygltf::Model& model = context.model;
    Primitive to;
    const auto plain = static_cast<Index>(context.scene.materials.size() - 1);
    to.material = from.material >= 0 && static_cast<Index>(from.material) < plain ? static_cast<Index>(from.material) : plain;
    if (from.material >= 0 && static_cast<Index>(from.material) >= plain)
        lack(context, mesh, fmt::format("{}: Material {} does not exist; the primitive is left white", place, from.material));
    const int positions_at = attribute(from, "POSITION");
    if (positions_at < 0) return Error{place, "The primitive has no positions", export_again, ErrorKind::damaged};
    auto positions = read_vectors<vec3>(model, positions_at, 3, place);
    if (!positions) return positions.error();
    to.positions = std::move(*positions);
    std::vector<std::uint32_t> corners;
    if (from.indices >= 0) {
        auto indices = read_indices(model, from.indices, place);
        if (!indices) return indices.error();
        corners = std::move(*indices);
    } else {
        corners.resize(to.positions.size());
        for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
    }
    to.indices = expand(corners, from.mode);
    read_attributes(context, from, place, mesh, to);
    return to;
}

void read_mesh(const Context& context, const tinygltf::Mesh& from, Mesh& to) {
    auto& warnings = context.scene.warnings;
    std::size_t not_triangles = 0, morphed = 0;
    for (std::size_t i = 0; i < from.primitives.size(); ++i) {
        const tinygltf::Primitive& primitive = from.primitives[i];
        morphed += primitive.targets.empty() ? 0 : 1;
        if (primitive.mode < TINYGLTF_MODE_TRIANGLES || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
            ++not_triangles;
            continue;
        }
        auto read = read_primitive(context, primitive, fmt::format("{}: mesh '{}' primitive {}", context.file, to.name, i), to);
        if (read) {
            to.primitives.push_back(std::move(*read));
        } else {
            lack(context, to, "A primitive is dropped: " + in_short(read.error()));
        }
    }
    if (not_triangles > 0)
        warnings.push_back(fmt::format("Mesh '{}': {} primitives of points or lines are dropped", to.name, not_triangles));
    if (morphed > 0)
        warnings.push_back(
            fmt::format("Mesh '{}': {} primitives are taken in their rest shape (morph targets). Apply the shape before the "
                        "export",
                        to.name, morphed));
}

}  // namespace

Result<Scene> import_gltf(const std::string& file, const Progress& progress) {
    Scene scene;
    auto model = load_gltf(file, scene.warnings);
    if (!model) return model.error();
    const std::vector<TextureUse> uses = read_materials(*model, file, scene, progress);
    const Context context{*model, file, uses, scene};
    scene.meshes.resize(model->meshes.size());
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        if (progress.stopped()) return Error{file, "The import was stopped", "", ErrorKind::stopped};
        scene.meshes[i].name = model->meshes[i].name.empty() ? fmt::format("mesh {}", i) : model->meshes[i].name;
        read_mesh(context, model->meshes[i], scene.meshes[i]);
        progress.update("import", static_cast<double>(i + 1) / static_cast<double>(scene.meshes.size()));
    }
    if (auto placed = read_nodes(*model, file, scene); !placed) return placed.error();
    model->buffers.clear();
    if (auto usable = finish(scene, file, progress); !usable) return usable.error();
    return scene;
}

}  // namespace surefoot::importer
