// The importers' common door: choice by ending, several files into one scene, and what every scene must have.
#include "render/import/scene.hpp"

#include <exception>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>

#include "render/import/formats.hpp"
#include "render/import/lamps.hpp"
#include "render/import/stand_ins.hpp"

namespace surefoot::importer {
namespace {

namespace fs = std::filesystem;

/// The most frequent mistakes, reported before any reader starts.
Result<void> check_file(const std::string& file) {
    std::error_code code;
    const fs::file_status status = fs::status(file, code);
    if (!fs::exists(status)) return Error{file, "There is no such file", "Check the name", ErrorKind::not_found};
    if (fs::is_directory(status))
        return Error{file, "The name is a folder, not a file", "Name the model file in it", ErrorKind::unreadable};
    if (!fs::is_regular_file(status))
        return Error{file, "The name is not a plain file", "Name a model file", ErrorKind::unreadable};
    if (fs::file_size(file, code) == 0) return Error{file, "The file is empty", "Export the model again", ErrorKind::damaged};
    return {};
}

Result<Scene> import_model(const std::string& file, const Progress& progress) {
    if (auto usable = check_file(file); !usable) return usable.error();
    if (const Format* format = format_of(file)) return format->read(file, progress);
    const std::string ending = ending_of(file);
    return Error{file, ending.empty() ? "The file name has no ending" : fmt::format("The ending '{}' is unknown", ending),
                 fmt::format("Convert it to one of {}", endings_in_words()), ErrorKind::unsupported};
}

Result<Scene> import_one(const std::string& file, const Progress& progress) {
    auto scene = import_model(file, progress);
    if (!scene) return scene;
    const auto read = [&](const std::string& other) { return import_model(other, progress); };
    if (auto done = read_stand_ins(file, *scene, read); !done) return done.error();
    return scene;
}

void shift(Index& index, std::size_t by) {
    if (index != none) index += static_cast<Index>(by);
}

template <class T>
void move_all(std::vector<T>& to, std::vector<T>& from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

namespace {

/// Together they may be more than a model holds: then the later scene stands still.
void append_motions(Scene& to, Scene& from) {
    const bool fits = to.motions.size() + from.motions.size() <= model::max_motions &&
                      to.motion_keys.size() + from.motion_keys.size() <= model::max_motion_keys;
    if (!fits) to.warnings.emplace_back("Too many motions: those of a later file are left out, and its nodes stand still");
    for (Node& node : from.nodes) {
        if (!fits) node.motion = none;
        shift(node.motion, to.motions.size());
    }
    if (!fits) return;
    for (model::Motion& motion : from.motions) {
        motion.first_key += static_cast<std::uint32_t>(to.motion_keys.size());
        shift(motion.outer, to.motions.size());
    }
    move_all(to.motions, from.motions);
    move_all(to.motion_keys, from.motion_keys);
}

}  // namespace

void append(Scene& to, Scene&& from) {
    append_motions(to, from);
    for (Mesh& mesh : from.meshes) {
        for (Primitive& primitive : mesh.primitives) shift(primitive.material, to.materials.size());
    }
    for (StandIn& stand_in : from.stand_ins) {
        for (Primitive& primitive : stand_in.mesh.primitives) shift(primitive.material, to.materials.size());
        shift(stand_in.of, to.meshes.size());
    }
    for (Node& node : from.nodes) {
        shift(node.parent, to.nodes.size());
        shift(node.mesh, to.meshes.size());
    }
    for (Material& material : from.materials) shift(material.image, to.images.size());
    move_all(to.meshes, from.meshes);
    move_all(to.nodes, from.nodes);
    move_all(to.materials, from.materials);
    move_all(to.images, from.images);
    move_all(to.stand_ins, from.stand_ins);
    if (from.sun && (!to.sun || from.sun->intensity > to.sun->intensity)) to.sun = std::move(from.sun);
    if (from.fog_visibility_m > 0 && !(to.fog_visibility_m > 0 && to.fog_visibility_m < from.fog_visibility_m))
        to.fog_visibility_m = from.fog_visibility_m;
    to.sky = to.sky || from.sky;
    move_all(to.lamps, from.lamps);
    keep_brightest(to);
    move_all(to.sources, from.sources);
    move_all(to.warnings, from.warnings);
    move_all(to.damage, from.damage);
}

void Scene::damaged(std::string line) {
    warnings.push_back(line);
    damage.push_back({{}, std::move(line)});
}

std::uint64_t Scene::triangles() const {
    std::vector<std::uint64_t> of_mesh(meshes.size(), 0);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        for (const Primitive& primitive : meshes[i].primitives) of_mesh[i] += primitive.indices.size() / 3;
    }
    std::uint64_t sum = 0;
    for (const Node& node : nodes) sum += node.mesh == none ? 0 : of_mesh[node.mesh];
    return sum;
}

Result<Scene> import_files(const std::vector<std::string>& files, const Progress& progress) {
    if (files.empty())
        return Error{"import", "No file is given", fmt::format("Name at least one model ({})", endings_in_words()),
                     ErrorKind::misuse};
    Scene scene;
    for (const std::string& file : files) {
        try {
            Result<Scene> one = import_one(file, progress);
            if (!one) return one.error();
            append(scene, std::move(one).value());
        } catch (const std::bad_alloc&) {
            return Error{file, "The model needs more memory than this machine gives",
                         fmt::format("Split the model, or import it as {}", ostf_ending), ErrorKind::no_memory};
        } catch (const std::exception& trouble) {
            return Error{file, fmt::format("The file cannot be read: {}", trouble.what()), "Export the model again",
                         ErrorKind::damaged};
        }
    }
    return scene;
}

}  // namespace surefoot::importer
