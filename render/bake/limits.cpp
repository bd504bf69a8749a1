// Counts in advance what emit.cpp will add to the model (limits.hpp).
#include "render/bake/limits.hpp"

namespace surefoot::bake {

namespace {

/// Parts and vertices of a chain: once, however many are placed.
Counts counts_of(const LodChain& chain) {
    Counts counts;
    counts.vertices = chain.full.vertices.size();
    for (const Level& level : chain.levels) {
        counts.parts += level.parts.size();
        for (const GeometryPart& part : level.parts) counts.indices += part.indices.size();
    }
    return counts;
}

/// What one placement of a chain adds.
Counts placed_once(const LodChain& chain) {
    Counts counts;
    counts.placements = counts.nodes = 1;
    counts.representations = chain.levels.size();
    for (const Level& level : chain.levels) counts.drawn_parts += level.parts.size();
    return counts;
}

constexpr Counts a_box{24, 36, 1, 1, 1, 1, 0, 0, 1, 1};

}  // namespace

Counts counts_of(const ProxyInput& input, std::size_t boxes) {
    Counts counts;
    counts.materials = input.model->materials.size();
    counts.textures = input.model->textures.size();
    counts.name_bytes = 1;
    for (const MeshForm& form : input.forms) counts += counts_of(form.chain);
    for (const PlacedObject& object : input.objects) {
        counts += placed_once(input.forms[object.mesh].chain);
        counts.name_bytes += object.name.size() + 1;
    }
    for (const ClusterForm& cluster : input.clusters) {
        counts += counts_of(cluster.chain);
        counts += placed_once(cluster.chain);
    }
    for (std::size_t i = 0; i < boxes; ++i) counts += a_box;
    return counts;
}

}  // namespace surefoot::bake
