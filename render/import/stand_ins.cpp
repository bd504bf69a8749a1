// Joining the meshes of a stand-in, and the list beside a scene (stand_ins.hpp).
#include "render/import/stand_ins.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>

#include "render/import/finish.hpp"
#include "rt/base/file.hpp"
#include "rt/base/toml_reader.hpp"

namespace surefoot::importer {
namespace {

/// An entry of the list.
struct Entry {
    std::string object, node, file;
    [[nodiscard]] const std::string& name() const { return node.empty() ? file : node; }
};

Result<std::vector<Entry>> read_list(const std::string& list) {
    const auto text = read_text(list);
    if (!text) return text.error();
    const auto table = parse_toml(*text, list);
    if (!table) return table.error();
    std::vector<Entry> entries;
    TableReader reader(*table, list, "");
    reader.tables("stand_in", [&](TableReader& one) {
        Entry entry;
        one.text("object", entry.object);
        one.text("node", entry.node);
        one.text("file", entry.file);
        if (entry.object.empty()) one.refuse("object", "is missing", "Name the node or mesh that the stand-in is for");
        if (entry.node.empty() == entry.file.empty())
            one.refuse("node", "and the key file are two ways to name one stand-in", "Give one of them");
        entries.push_back(std::move(entry));
        return one.finish();
    });
    if (auto done = reader.finish(); !done) return done.error();
    return entries;
}

std::string did_you_mean(const std::string& name, const Scene& scene) {
    std::vector<std::string_view> names;
    for (const Node& node : scene.nodes) names.push_back(node.name);
    const std::string_view nearest = nearest_word(name, names);
    return nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest);
}

Index node_named(const Scene& scene, const std::string& name) {
    const auto found = std::find_if(scene.nodes.begin(), scene.nodes.end(), [&](const Node& n) { return n.name == name; });
    return found == scene.nodes.end() ? none : static_cast<Index>(found - scene.nodes.begin());
}

/// The mesh of the first node of that name that has one, else the mesh of that name.
Index mesh_named(const Scene& scene, const std::string& name) {
    for (const Node& node : scene.nodes)
        if (node.name == name && node.mesh != none) return node.mesh;
    const auto found = std::find_if(scene.meshes.begin(), scene.meshes.end(), [&](const Mesh& m) { return m.name == name; });
    return found == scene.meshes.end() ? none : static_cast<Index>(found - scene.meshes.begin());
}

/// By node: whether it is `root` or below it. Parents come first.
std::vector<bool> subtree(const Scene& scene, Index root) {
    std::vector<bool> in(scene.nodes.size(), false);
    for (Index n = root; n < scene.nodes.size(); ++n)
        in[n] = n == root || (scene.nodes[n].parent != none && in[scene.nodes[n].parent]);
    return in;
}

void take_node(Scene& scene, Index root, Index of) {
    StandIn stand_in{scene.nodes[root].name, of, joined(scene, below(scene, root), scene.nodes[root].name)};
    const std::vector<bool> in = subtree(scene, root);
    for (Index n = root; n < scene.nodes.size(); ++n)
        if (in[n]) scene.nodes[n].mesh = none;
    scene.stand_ins.push_back(std::move(stand_in));
}

void take_file(Scene& scene, Scene&& from, const Entry& entry, Index of) {
    std::vector<Placed> all;
    for (const Node& node : from.nodes)
        if (node.mesh != none) all.push_back({node.mesh, node.world});
    StandIn stand_in{entry.file, of, joined(from, all, entry.file)};
    for (Primitive& primitive : stand_in.mesh.primitives) primitive.material += static_cast<Index>(scene.materials.size());
    for (Material& material : from.materials)
        if (material.image != none) material.image += static_cast<Index>(scene.images.size());
    const auto move_all = [](auto& to, auto& of_file) {
        to.insert(to.end(), std::make_move_iterator(of_file.begin()), std::make_move_iterator(of_file.end()));
    };
    move_all(scene.materials, from.materials);
    move_all(scene.images, from.images);
    move_all(scene.sources, from.sources);
    move_all(scene.warnings, from.warnings);
    scene.stand_ins.push_back(std::move(stand_in));
}

void take(Scene& scene, const std::string& file, const Entry& entry, const ReadModel& read) {
    const auto left_out = [&](const std::string& why) {
        scene.warnings.push_back(fmt::format("Stand-in '{}' of '{}' is left out: {}", entry.name(), entry.object, why));
    };
    const Index of = mesh_named(scene, entry.object);
    if (of == none) return left_out("no node with triangles has the object's name" + did_you_mean(entry.object, scene));
    if (!entry.file.empty()) {
        auto other = read(place_beside(file, entry.file));
        return other ? take_file(scene, std::move(*other), entry, of) : left_out(in_short(other.error()));
    }
    const Index root = node_named(scene, entry.node);
    if (root == none) return left_out("no node has that name" + did_you_mean(entry.node, scene));
    const std::vector<bool> in = subtree(scene, root);
    const bool others = std::any_of(scene.nodes.begin(), scene.nodes.end(), [&](const Node& n) {
        return n.mesh == of && !in[static_cast<std::size_t>(&n - scene.nodes.data())];
    });
    if (!others) return left_out("the object is a part of it");
    if (below(scene, root).empty()) return left_out("it has no triangles");
    take_node(scene, root, of);
}

}  // namespace

Mesh joined(const Scene& scene, std::span<const Placed> placed, const std::string& name) {
    Mesh out;
    out.name = name;
    for (const Placed& one : placed) {
        const dmat3 linear(one.at);
        const dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                             glm::cross(linear[0], linear[1]));
        const bool mirrored = glm::dot(linear[0], cofactor[0]) < 0;
        for (Primitive primitive : scene.meshes[one.mesh].primitives) {
            for (vec3& p : primitive.positions) p = vec3(one.at * dvec4(dvec3(p), 1.0));
            for (vec3& n : primitive.normals) {
                const dvec3 turned = cofactor * dvec3(n) * (mirrored ? -1.0 : 1.0);
                const double length = glm::length(turned);
                n = length > 0 ? vec3(turned / length) : vec3(0, 1, 0);
            }
            for (std::size_t i = 0; mirrored && i + 2 < primitive.indices.size(); i += 3)
                std::swap(primitive.indices[i + 1], primitive.indices[i + 2]);
            out.primitives.push_back(std::move(primitive));
        }
    }
    return out;
}

std::vector<Placed> below(const Scene& scene, Index node) {
    const dmat4 to_frame = glm::inverse(scene.nodes[node].world);
    const std::vector<bool> in = subtree(scene, node);
    std::vector<Placed> out;
    for (Index n = node; n < scene.nodes.size(); ++n)
        if (in[n] && scene.nodes[n].mesh != none) out.push_back({scene.nodes[n].mesh, to_frame * scene.nodes[n].world});
    return out;
}

std::string stand_in_list_of(const std::string& file) {
    return std::filesystem::path(file).replace_extension(".stand_ins.toml").string();
}

Result<void> read_stand_ins(const std::string& file, Scene& scene, const ReadModel& read) {
    const std::string list = stand_in_list_of(file);
    std::error_code code;
    if (!std::filesystem::exists(list, code)) return {};
    const auto entries = read_list(list);
    if (!entries) return entries.error();
    scene.sources.push_back(list);
    for (const Entry& entry : *entries) take(scene, file, entry, read);
    return {};
}

}  // namespace surefoot::importer
