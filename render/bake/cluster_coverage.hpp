// Meshes of clusters that show too little or too much of what is below them: they grow or shrink, or give way.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "render/bake/geometry.hpp"
#include "render/bake/picture_tree.hpp"

namespace surefoot::bake {

/// How many of loss_directions are counted: the first three. The others see about the same outlines from behind.
constexpr std::size_t outline_directions = 3;
constexpr std::uint32_t outline_px = 32;  ///< across a cluster, about: its samples of all directions are some hundreds

/// The meshes of a cluster. displacement_m: the part of their errors by which what is below moves.
struct ClusterChain {
    LodChain* chain = nullptr;  ///< null: a leaf
    double displacement_m = 0;
};

/// Scales or takes out levels of clusters that cover less than half or more than twice of full detail. `model`: emitted from the
/// chains. `chains`: by node. Whether any chain changed; nothing: step() said to stop. The same, whatever the threads.
std::optional<bool> mend_clusters(const model::Model& model, const std::vector<ClusterChain>& chains, const ForAll& for_all,
                                  const std::function<bool()>& step);
/// How many steps there are.
std::size_t mend_steps(const model::Model& model);

/// The full detail of one cluster, and what its levels cover.
struct ClusterCover {
    Box box;                              ///< relative to the chain's centre
    std::vector<FormView> views;          ///< by direction, relative to it too
    double displacement_m = 0;            ///< of ClusterChain
    std::uint64_t full = 0;               ///< samples that full detail covers, of all directions
    std::vector<bool> outlines;           ///< by sample of all directions: whether full detail covers it
    std::vector<std::uint64_t> levels;    ///< those of each level
    const model::Model* looks = nullptr;  ///< with materials and textures
};

/// Levels below half or above twice are scaled: each connected part about its own middle, within the box. How far this moves a
/// vertex is added to their error, so the bound holds; without the displacement it at most doubles. No more than 30 % of full
/// detail's samples may come to lie beside it. Levels that still cover too little or too much are taken out. If none would be
/// left, the one nearest to full detail stays. Whether the chain changed.
bool mend_cluster(LodChain& chain, const ClusterCover& cover);

}  // namespace surefoot::bake
