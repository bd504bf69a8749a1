// The ground of a scene: its blocking triangles (ground_classes.hpp) in shared trees (ground_build.hpp).
#pragma once

#include <vector>

#include "render/import/scene.hpp"
#include "render/model/ground.hpp"
#include "render/model/moving_ground.hpp"
#include "rt/base/progress.hpp"

namespace surefoot::bake {

/// By node of the scene, for each triangle of its mesh: whether it blocks.
using BlockingTriangles = std::vector<std::vector<bool>>;

/// From full detail, independent of what is drawn. Runs on the threads of the caller's arena; the same bits for any number of
/// them. Empty if the user stops it. `blocking`, if given, receives the classes. `moving`, if given, receives what blocks of
/// nodes with a motion, with numbers of Scene::motions; without it they stand as at rest.
model::Ground make_ground(const importer::Scene& scene, const Progress& progress, BlockingTriangles* blocking = nullptr,
                          model::MovingGround* moving = nullptr);

/// The opaque triangles of all placed nodes, whatever stops a walker: what hides the sky. Glass and cut-out cards are left out,
/// and so are parts smaller than a foot. As make_ground() else.
model::Ground make_opaque_ground(const importer::Scene& scene, const Progress& progress);
/// What shades besides: leaves, cards and wires cut out by masks, and solid parts smaller than a foot. Glass does not.
model::Ground make_leaf_ground(const importer::Scene& scene, const Progress& progress);

/// Guesses that a person should know of: no floor, or a size at which nobody can walk. One line each. `all`: the model's box.
std::vector<std::string> ground_warnings(const model::Ground& ground, const Box& all);

}  // namespace surefoot::bake
