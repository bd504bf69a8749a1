// Levels by vertex clustering: which grids, and their bounds (vertex_clusters.hpp).
#include "render/bake/vertex_clusters.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>

#include "render/bake/mesh_surface.hpp"
#include "render/bake/vertex_grid.hpp"
#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {

namespace {

constexpr std::array<std::uint32_t, 15> grids = {1, 2, 3, 4, 5, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128};

/// The finest grid within the limit first, then coarser ones, each of at most half the triangles.
std::vector<GridMesh> choose_grids(const ClusterSource& source, const ClusteringLimits& limits) {
    std::vector<GridMesh> tried;
    for (const std::uint32_t steps : grids) {
        GridMesh mesh = grid_mesh(source, steps);
        const std::size_t count = mesh.triangles();
        if (count > limits.max_triangles && !tried.empty()) break;
        tried.push_back(std::move(mesh));
        if (count >= source.triangles.size()) break;  // finer grids only copy the source
    }
    std::vector<GridMesh> chosen;
    for (; !tried.empty(); tried.pop_back()) {
        if (!chosen.empty() && chosen.back().triangles() <= limits.min_triangles) break;
        if (!chosen.empty() && 2 * tried.back().triangles() > chosen.back().triangles()) continue;
        chosen.push_back(std::move(tried.back()));
    }
    return chosen;
}

float bound(const MeshSurface& source, const measure::TriangleTree& source_tree, const GridMesh& mesh, float slack) {
    const MeshSurface coarse(mesh.vertices, mesh.parts);
    measure::DistanceLimits limits;
    limits.relative = slack;
    limits.max_queries = 1000 + source.view().triangles() / 8;  // the grid's own bounds are near the truth already
    const measure::DistanceBounds there =
        measure::directed_distance(source.view(), measure::TriangleTree(coarse.view()), limits, mesh.source_bound);
    limits.known_lower = there.lower;
    return std::max(there.upper, measure::directed_distance(coarse.view(), source_tree, limits, mesh.out_bound).upper);
}

void adopt(LodChain& chain, GridMesh&& mesh, float error_m) {
    Geometry& g = chain.full;
    Level level;
    level.error_m = error_m;
    level.triangles = static_cast<std::uint32_t>(mesh.triangles());
    const auto base = static_cast<std::uint32_t>(g.vertices.size());
    g.vertices.insert(g.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    g.baked.insert(g.baked.end(), mesh.baked.begin(), mesh.baked.end());
    for (GeometryPart& part : mesh.parts) {
        if (part.indices.empty()) continue;
        meshopt_optimizeVertexCache(part.indices.data(), part.indices.data(), part.indices.size(), mesh.vertices.size());
        for (std::uint32_t& index : part.indices) index += base;
        level.parts.push_back(std::move(part));
    }
    chain.levels.push_back(std::move(level));
}

}  // namespace

LodChain cluster_vertices(const Geometry& g, std::span<const std::uint32_t> owners, const std::vector<bool>& two_sided,
                          const ClusteringLimits& limits) {
    std::vector<GridMesh> meshes = choose_grids(make_source(g, owners, two_sided), limits);
    const MeshSurface positions(g.vertices, g.parts);
    const measure::TriangleTree tree(positions.view());
    LodChain chain;
    chain.full.centre = g.centre;
    for (; !meshes.empty(); meshes.pop_back()) {  // from the coarsest: a finer one must be better, else it is left out
        const float error_m = bound(positions, tree, meshes.back(), limits.slack);
        if (chain.levels.empty() || error_m < chain.levels.back().error_m) adopt(chain, std::move(meshes.back()), error_m);
    }
    return chain;
}

}  // namespace surefoot::bake
