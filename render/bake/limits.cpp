// Refusing what 32-bit numbers cannot name (limits.hpp).
#include "render/bake/limits.hpp"

#include <array>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "render/model/model.hpp"

namespace surefoot::bake {

Counts& Counts::operator+=(const Counts& more) {
    vertices += more.vertices;
    indices += more.indices;
    parts += more.parts;
    placements += more.placements;
    materials += more.materials;
    representations += more.representations;
    nodes += more.nodes;
    name_bytes += more.name_bytes;
    return *this;
}

namespace {

Counts counts_of(const LodChain& chain) {
    Counts counts;
    counts.vertices = chain.full.vertices.size();
    for (const Level& level : chain.levels) {
        counts.parts += level.parts.size();
        for (const GeometryPart& part : level.parts) counts.indices += part.indices.size();
    }
    return counts;
}

constexpr Counts a_box{24, 36, 1, 1, 1, 1, 0, 0};

}  // namespace

Counts counts_of(const ProxyInput& input, std::span<const BoxForm> object_boxes) {
    Counts counts;
    counts.materials = input.model->materials.size();
    counts.name_bytes = 1;
    for (const MeshForm& form : input.forms) counts += counts_of(form.chain);
    for (const PlacedObject& object : input.objects)
        counts += {0, 0, 0, 1, 0, input.forms[object.mesh].chain.levels.size(), 1, object.name.size() + 1};
    for (const ClusterForm& cluster : input.clusters) {
        counts += counts_of(cluster.chain);
        counts += {0, 0, 0, 1, 0, cluster.chain.levels.size(), 1, 0};
        if (cluster.has_box) counts += a_box;
    }
    for (const BoxForm& box : object_boxes) {
        if (!box.box.empty()) counts += a_box;
    }
    return counts;
}

Result<void> check_limits(const Counts& counts, const std::string& place) {
    struct Limit {
        std::string_view what;
        std::uint64_t count, most;
    };
    // A draw command's base vertex is signed; the last number of an Index says `none`.
    constexpr std::uint64_t most_vertices = std::numeric_limits<std::int32_t>::max(), most = model::none;
    const std::array limits = {
        Limit{"vertices", counts.vertices, most_vertices},
        Limit{"indices", counts.indices, most},
        Limit{"parts", counts.parts, most},
        Limit{"placements", counts.placements, most},
        Limit{"materials", counts.materials, most},
        Limit{"representations", counts.representations, most},
        Limit{"nodes", counts.nodes, most},
        Limit{"bytes of names", counts.name_bytes, most},
    };
    for (const Limit& limit : limits) {
        if (limit.count <= limit.most) continue;
        return Error{place,
                     fmt::format("The model is out of limits: {} {} with all levels of detail, at most {}", limit.count,
                                 limit.what, limit.most),
                     "Bake it in several parts, or with fewer triangles", ErrorKind::out_of_limits};
    }
    return {};
}

}  // namespace surefoot::bake
