// Stand-ins: simpler meshes that an artist made for objects seen from far. Named in glTF, or in a TOML file beside the scene.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "render/import/scene.hpp"

namespace surefoot::importer {

/// A mesh and where it is.
struct Placed {
    Index mesh = none;
    dmat4 at{1.0};
};
/// Copies of these meshes, as one mesh.
Mesh joined(const Scene& scene, std::span<const Placed> placed, const std::string& name);

/// The meshes at and below a node, relative to the frame of that node.
std::vector<Placed> below(const Scene& scene, Index node);

/// Reads a model file that holds one stand-in.
using ReadModel = std::function<Result<Scene>(const std::string& file)>;

/// The name of the list of stand-ins of a model file: house.stand_ins.toml for house.glb.
std::string stand_in_list_of(const std::string& file);

/// Reads the list beside the model file, if there is one. Each [[stand_in]] has `object`, the name of a node or mesh. It has
/// `node`, a node of the scene that is no longer drawn by itself, or `file`, another model. The frame of the stand-in is laid on
/// the object's. Errors: a list that cannot be read, an unknown key. What is not there is a warning, and the object stays as it
/// is.
Result<void> read_stand_ins(const std::string& file, Scene& scene, const ReadModel& read);

}  // namespace surefoot::importer
