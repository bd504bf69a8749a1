// What every importer ends with: meshes cleaned, empty ones gone, at least one material, something drawable.
#include "render/import/finish.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "rt/base/file.hpp"

namespace surefoot::importer {
namespace {

/// Smaller than this is nothing that could be seen, and squares of it underflow float.
constexpr double smallest_m = 1e-9;

Box box_of(const Mesh& mesh) {
    Box box;
    for (const Primitive& primitive : mesh.primitives) {
        for (const vec3& p : primitive.positions) box.grow(dvec3(p));
    }
    return box;
}

bool is_finite(const dmat4& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    return true;
}

std::string why_not_drawable(const dmat4& world) {
    if (!is_finite(world)) return "transform is not finite";
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) {
            if (std::abs(world[c][r]) > farthest_m) return "transform is beyond 1e12 m";
        }
    }
    const dmat3 linear(world);
    const double size = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
    if (!(std::abs(glm::determinant(linear)) > 1e-12 * size)) return "transform is singular (a scale of 0)";
    for (int c = 0; c < 3; ++c) {
        if (glm::length(linear[c]) < smallest_m) return "transform shrinks it more than 1e9 times";
    }
    return {};
}

/// The mesh as it is placed: neither out of all measure nor too small to be anything.
std::string why_not_drawable(const Box& box, const dmat4& world) {
    if (std::string why = why_not_drawable(world); !why.empty()) return why;
    const dmat3 linear(world);
    const dvec3 half =
        glm::abs(linear[0]) * box.half().x + glm::abs(linear[1]) * box.half().y + glm::abs(linear[2]) * box.half().z;
    const dvec3 reach = glm::abs(dvec3(world * dvec4(box.centre(), 1.0))) + half;
    if (std::max({reach.x, reach.y, reach.z}) > farthest_m) return "geometry as placed is beyond 1e12 m";
    if (box.diagonal() < smallest_m || 2 * glm::length(half) < smallest_m) return "geometry is smaller than 1e-9 m";
    return {};
}

void clean_mesh(Scene& scene, Mesh& mesh) {
    Repairs counts;
    for (Primitive& primitive : mesh.primitives) {
        repair(primitive, counts);
        if (primitive.material >= scene.materials.size()) primitive.material = 0;
        if (scene.materials.empty()) continue;
        const Material& material = scene.materials[primitive.material];
        if (material.light == LightPlace::flat && !material.unlit) make_flat(primitive);
    }
    report_repairs(counts, mesh.name, scene.warnings, mesh.lacks);
    std::erase_if(mesh.primitives, [](const Primitive& p) { return p.indices.empty(); });
}

/// A stand-in that is not whole would be drawn so, where its object is whole.
void leave_out_lacking(Scene& scene) {
    std::erase_if(scene.stand_ins, [&](const StandIn& stand_in) {
        const std::vector<std::string>* lacks = &stand_in.mesh.lacks;
        for (const Primitive& primitive : stand_in.mesh.primitives)
            if (lacks->empty()) lacks = &scene.materials[primitive.material].lacks;
        if (!lacks->empty())
            scene.warnings.push_back(fmt::format("Stand-in '{}' is left out: {}", stand_in.name, lacks->front()));
        return !lacks->empty();
    });
}

void clean_meshes(Scene& scene, const Progress& progress) {
    for (StandIn& stand_in : scene.stand_ins) clean_mesh(scene, stand_in.mesh);
    leave_out_lacking(scene);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        clean_mesh(scene, scene.meshes[i]);
        progress.update("clean", static_cast<double>(i + 1) / static_cast<double>(scene.meshes.size()));
    }
}

/// Masks that nothing shows through, and images that fill memory.
void warn_of_images(Scene& scene) {
    for (const Material& material : scene.materials) {
        if (material.alpha != model::AlphaMode::mask || material.image == none) continue;
        const std::vector<std::uint8_t>& rgba = scene.images[material.image].rgba;
        bool shows = false;
        for (std::size_t i = 3; i < rgba.size() && !shows; i += 4)
            shows = static_cast<float>(rgba[i]) / 255 * material.colour[3] >= material.alpha_cutoff;
        if (!shows)
            scene.warnings.push_back(
                fmt::format("Material '{}': its mask hides all that wears it; is its alpha inverted?", material.name));
    }
    constexpr double large_mib = 256, mips = 4.0 / 3.0;
    for (const image::Image& image : scene.images) {
        const double mib = 4.0 * image.width * image.height * mips / (1 << 20);
        if (mib > large_mib)
            scene.warnings.push_back(fmt::format("Texture '{}' of {} x {} texels takes {:.0f} MiB; is it needed so large?",
                                                 image.name, image.width, image.height, mib));
    }
}

/// Glow that a picture spreads would be too much if all of the surface had it.
void warn_of_glow(Scene& scene) {
    const Material* first = nullptr;
    std::size_t others = 0;
    for (const Material& material : scene.materials) {
        if (!material.emission_image) continue;
        others += first == nullptr ? 0 : 1;
        if (first == nullptr) first = &material;
    }
    if (first == nullptr) return;
    const std::string rest = others == 0 ? "" : fmt::format("; so is that of {} other{}", others, others == 1 ? "" : "s");
    scene.warnings.push_back(
        fmt::format("Material '{}': its glow is left out, because images of emission are not used{}", first->name, rest));
}

/// What things that are drawn lack. A library of materials may name pictures that nobody uses.
void collect_damage(Scene& scene, const std::string& file) {
    std::vector<bool> mesh_drawn(scene.meshes.size(), false), material_drawn(scene.materials.size(), false);
    for (const Node& node : scene.nodes)
        if (node.mesh != none) mesh_drawn[node.mesh] = true;
    std::set<std::string> known;
    const auto take = [&](const std::vector<std::string>& lacks) {
        for (const std::string& what : lacks)
            if (known.insert(what).second) scene.damage.push_back({{}, what});
    };
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        if (!mesh_drawn[i]) continue;
        take(scene.meshes[i].lacks);
        for (const Primitive& primitive : scene.meshes[i].primitives) material_drawn[primitive.material] = true;
    }
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
        if (material_drawn[i]) take(scene.materials[i].lacks);
    for (Damage& d : scene.damage) d.file = file;
}

}  // namespace

Result<void> finish(Scene& scene, const std::string& file, const Progress& progress) {
    if (scene.materials.empty()) scene.materials.push_back(Material{.name = "white"});
    clean_meshes(scene, progress);
    warn_of_images(scene);
    warn_of_glow(scene);
    collect_damage(scene, file);
    std::vector<Box> boxes;
    for (const Mesh& mesh : scene.meshes) boxes.push_back(box_of(mesh));
    for (Node& node : scene.nodes) {
        if (node.mesh == none) continue;
        if (scene.meshes[node.mesh].primitives.empty()) {
            node.mesh = none;
        } else if (const std::string why = why_not_drawable(boxes[node.mesh], node.world); !why.empty()) {
            scene.warnings.push_back(fmt::format("Node '{}' is dropped: its {}", node.name, why));
            if (!is_finite(node.world)) scene.damage.push_back({file, scene.warnings.back()});
            node.mesh = none;
        }
    }
    scene.sources.push_back(file);
    if (scene.triangles() > 0) return {};
    std::string why;
    for (std::size_t i = 0; i < std::min<std::size_t>(scene.warnings.size(), 3); ++i)
        why += (i == 0 ? ": " : "; ") + scene.warnings[i];
    return Error{file, "The file holds nothing drawable" + why, "Export the model with its triangles", ErrorKind::damaged};
}

std::string in_short(const Error& error) { return error.place.empty() ? error.what : error.place + ": " + error.what; }

std::string place_beside(const std::string& file, const std::string& name) {
    std::string portable = name;
    std::replace(portable.begin(), portable.end(), '\\', '/');
    return (std::filesystem::path(file).parent_path() / portable).string();
}

Picture load_texture(Scene& scene, const std::string& file, const std::string& name) {
    const std::string place = place_beside(file, name);
    const auto plain = require_plain(place);
    auto bytes = plain ? read_file(place) : plain.error();
    auto image = bytes ? image::decode_image(*bytes, place) : Result<image::Image>(bytes.error());
    return add_picture(scene, name, std::move(image));
}

Picture add_picture(Scene& scene, const std::string& name, Result<image::Image> image) {
    if (!image) {
        scene.warnings.push_back(fmt::format("Texture '{}' is left white: {}", name, in_short(image.error())));
        return {none, scene.warnings.back()};
    }
    image->name = name;
    scene.images.push_back(std::move(*image));
    return {static_cast<Index>(scene.images.size() - 1), {}};
}

}  // namespace surefoot::importer
