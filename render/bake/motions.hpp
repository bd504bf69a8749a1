// What moves, in the bake: its motions, a tree of clusters of its own, errors and boxes over the whole motion.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/bake/cluster.hpp"
#include "render/bake/objects.hpp"
#include "render/model/model.hpp"

namespace surefoot::bake {

/// Those motions of the scene that objects have, and those that carry them, into the model. Objects name them there. Returns
/// their numbers in the model by those in the scene.
std::vector<model::Index> adopt_motions(const importer::Scene& scene, std::vector<PlacedObject>& objects, model::Model& model);

/// Still objects alone have the clusters of grow_clusters(). What moves stands beside them, in clusters of its own. Objects of
/// one motion come together below one entity, which moves with it. Clusters above these stand still: their forms show what moves
/// at its rest, and ClusterTree::Cluster::displacement_m is how far off that may be.
/// in_rooms: by object, as grow_clusters_apart() has it for what stands still; empty: all together.
ClusterTree cluster_objects(std::span<const PlacedObject> objects, const std::vector<bool>& in_rooms, const model::Model& model,
                            std::uint32_t max_children);

/// Adds a displacement to the errors of a cluster's levels. They stay apart.
void add_displacement(LodChain& chain, double displacement_m);

/// Boxes of nodes from rest to all times, and those of the nodes above them.
void sweep_boxes(model::Model& model);

/// The ground with boxes around the ways of what moves, for tours: none leads through them. Nothing where all stands still. Call
/// it before sweep_boxes().
std::optional<model::Ground> ground_with_ways(const model::Model& model);

}  // namespace surefoot::bake
