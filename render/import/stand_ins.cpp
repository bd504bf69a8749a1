// Joining the meshes of a stand-in, and the list beside a scene (stand_ins.hpp).
#include "render/import/stand_ins.hpp"

#include <algorithm>
#include <filesystem>
#include <map>

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
        if (auto known = one.finish(); !known) return known;  // a misspelt key comes before a missing one
        if (entry.object.empty()) one.refuse("object", "is missing", "Name the node or mesh that the stand-in is for");
        if (entry.node.empty() && entry.file.empty())
            one.refuse("node", "is missing, and so is the key file", "Name a node of the scene, or another model file");
        if (!entry.node.empty() && !entry.file.empty()) one.refuse("file", "stands beside the key node", "Give one of them");
        entries.push_back(std::move(entry));
        return one.finish();
    });
    if (auto done = reader.finish(); !done) return done.error();
    return entries;
}

std::string did_you_mean(const std::string& name, const Scene& scene) {
    std::vector<std::string_view> names;
    for (const Node& node : scene.nodes)
        if (node.name != name) names.push_back(node.name);
    const std::string_view nearest = nearest_word(name, names);
    return nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest);
}

Index node_named(const Scene& scene, const std::string& name) {
    const auto found = std::find_if(scene.nodes.begin(), scene.nodes.end(), [&](const Node& n) { return n.name == name; });
    return found == scene.nodes.end() ? none : static_cast<Index>(found - scene.nodes.begin());
}

/// The mesh of the first node of that name, or of its instances; else the mesh of that name.
Index mesh_named(const Scene& scene, const std::string& name) {
    for (const Node& node : scene.nodes) {
        if (node.mesh == none) continue;
        const bool instance = node.parent != none && scene.nodes[node.parent].name == name && node.name.starts_with(name + " #");
        if (node.name == name || instance) return node.mesh;
    }
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

/// A scene whose list is read. Nodes that become stand-ins stay as they are until the end, so that several objects may share one.
class ListReader {
public:
    ListReader(const std::string& file, Scene& scene, const ReadModel& read)
        : file_(file), scene_(scene), read_(read), taken_(scene.nodes.size(), false) {}

    void take(const Entry& entry) {
        const Index of = mesh_named(scene_, entry.object);
        if (of == none)
            return left_out(entry, "no node with triangles has the object's name" + did_you_mean(entry.object, scene_));
        if (!placed(of, taken_)) return left_out(entry, "its object is not drawn, or is a stand-in itself");
        if (entry.node.empty()) return take_file(entry, of);
        const Index root = node_named(scene_, entry.node);
        if (root == none) return left_out(entry, "no node has that name" + did_you_mean(entry.node, scene_));
        const std::vector<Placed> meshes = below(scene_, root);
        if (meshes.empty()) return left_out(entry, "it has no triangles");
        std::vector<bool> taken = subtree(scene_, root);
        for (std::size_t n = 0; n < taken.size(); ++n) taken[n] = taken[n] || taken_[n];
        objects_.push_back(of);
        const bool all_left = std::all_of(objects_.begin(), objects_.end(), [&](Index object) { return placed(object, taken); });
        if (!all_left) {
            objects_.pop_back();
            return left_out(entry, "the object, or one before it in the list, is a part of it");
        }
        taken_ = std::move(taken);
        made_.push_back({entry.node, of, joined(scene_, meshes, entry.node)});
    }

    /// The nodes of stand-ins are no longer drawn by themselves.
    void finish() {
        for (std::size_t n = 0; n < taken_.size(); ++n)
            if (taken_[n]) scene_.nodes[n].mesh = none;
        for (StandIn& stand_in : made_) scene_.stand_ins.push_back(std::move(stand_in));
    }

private:
    void left_out(const Entry& entry, const std::string& why) {
        scene_.warnings.push_back(fmt::format("Stand-in '{}' of '{}' is left out: {}", entry.name(), entry.object, why));
    }

    [[nodiscard]] bool placed(Index mesh, const std::vector<bool>& without) const {
        for (std::size_t n = 0; n < scene_.nodes.size(); ++n)
            if (scene_.nodes[n].mesh == mesh && !without[n]) return true;
        return false;
    }

    void take_file(const Entry& entry, Index of) {
        const auto known = files_.find(entry.file);
        if (known == files_.end()) {
            auto other = read_(place_beside(file_, entry.file));
            if (!other) return left_out(entry, in_short(other.error()));
            if (!other->damage.empty()) return left_out(entry, other->damage.front().what);
            files_[entry.file] = adopt(std::move(*other), entry.file);
        }
        objects_.push_back(of);
        made_.push_back({entry.file, of, files_[entry.file]});
    }

    /// The meshes of another scene as one; its materials and images are added to this one.
    Mesh adopt(Scene&& from, const std::string& name) {
        std::vector<Placed> placed;
        for (const Node& node : from.nodes)
            if (node.mesh != none) placed.push_back({node.mesh, node.world});
        Mesh one = joined(from, placed, name);
        from.nodes.clear();
        from.stand_ins.clear();
        from.meshes.clear();
        from.meshes.push_back(std::move(one));
        append(scene_, std::move(from));
        one = std::move(scene_.meshes.back());
        scene_.meshes.pop_back();
        return one;
    }

    const std::string& file_;
    Scene& scene_;
    const ReadModel& read_;
    std::vector<bool> taken_;     ///< by node
    std::vector<Index> objects_;  ///< meshes that have stand-ins
    std::vector<StandIn> made_;
    std::map<std::string, Mesh> files_;
};

}  // namespace

Mesh joined(const Scene& scene, std::span<const Placed> placed, const std::string& name) {
    Mesh out;
    out.name = name;
    for (const Placed& one : placed) {
        const std::vector<std::string>& lacks = scene.meshes[one.mesh].lacks;
        out.lacks.insert(out.lacks.end(), lacks.begin(), lacks.end());
        const dmat3 linear(one.at);
        const dmat3 cofactor = cofactors(linear);
        const bool mirrored = glm::dot(linear[0], cofactor[0]) < 0;
        for (Primitive primitive : scene.meshes[one.mesh].primitives) {
            for (vec3& p : primitive.positions) p = vec3(one.at * dvec4(dvec3(p), 1.0));
            for (vec3& n : primitive.normals) {
                const dvec3 turned = cofactor * dvec3(n) * (mirrored ? -1.0 : 1.0);
                const double length = glm::length(turned);
                n = length > 0 ? vec3(turned / length) : vec3(0);  // to be made from its triangles
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
    ListReader reader(file, scene, read);
    for (const Entry& entry : *entries) reader.take(entry);
    reader.finish();
    return {};
}

}  // namespace surefoot::importer
