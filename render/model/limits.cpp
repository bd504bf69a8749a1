// Refusing what 32-bit numbers cannot name (limits.hpp).
#include "render/model/limits.hpp"

#include <array>
#include <string_view>

#include <fmt/format.h>

namespace surefoot::model {

Counts& Counts::operator+=(const Counts& more) {
    vertices += more.vertices;
    indices += more.indices;
    parts += more.parts;
    placements += more.placements;
    materials += more.materials;
    representations += more.representations;
    nodes += more.nodes;
    name_bytes += more.name_bytes;
    textures += more.textures;
    drawn_parts += more.drawn_parts;
    return *this;
}

Counts counts_of(const Model& model) {
    Counts counts;
    counts.vertices = model.vertices.size();
    counts.indices = model.indices.size();
    counts.parts = model.parts.size();
    counts.placements = model.placements.size();
    counts.materials = model.materials.size();
    counts.representations = model.reps.size();
    counts.nodes = model.nodes.size();
    counts.name_bytes = model.names.size();
    counts.textures = model.textures.size();
    for (const Representation& rep : model.reps) counts.drawn_parts += rep.part_count;
    return counts;
}

Result<void> check_limits(const Counts& counts, const std::string& place, const Counts& max) {
    struct Limited {
        std::string_view what;
        std::uint64_t Counts::*count;
    };
    constexpr std::array all = {
        Limited{"vertices", &Counts::vertices},   Limited{"indices", &Counts::indices},
        Limited{"parts", &Counts::parts},         Limited{"placements", &Counts::placements},
        Limited{"materials", &Counts::materials}, Limited{"forms", &Counts::representations},
        Limited{"nodes", &Counts::nodes},         Limited{"bytes of names", &Counts::name_bytes},
        Limited{"textures", &Counts::textures},   Limited{"parts of forms", &Counts::drawn_parts},
    };
    for (const Limited& one : all) {
        if (counts.*one.count <= max.*one.count) continue;
        return Error{place,
                     fmt::format("The model is out of limits: {} {} with all levels of detail, at most {}", counts.*one.count,
                                 one.what, max.*one.count),
                     "Bake it in several parts, or with fewer triangles", ErrorKind::out_of_limits};
    }
    return {};
}

}  // namespace surefoot::model
