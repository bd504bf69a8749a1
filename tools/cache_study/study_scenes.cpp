// Scenes and walks of the studies.
#include "tools/cache_study/study_scenes.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "tools/scenes/scenes.hpp"

namespace surefoot::cache_study {

namespace {

constexpr double walking_eye_m = 1.7;

/// A wide plain of equal complexity everywhere: upright triangles on a grid, so flat that no box is split in height.
constexpr int plain_cells = 64;
constexpr double plain_side_m = 512, plain_height_m = 3;

struct StudyEntry {
    Named name;
    std::uint32_t frames;
    cache::TreeOptions tree;
    Result<std::vector<cache::Triangle>> (*triangles)();
    dvec2 from, to;             ///< ends of the way, along x and z, as shares of the scene
    double before_scene_m = 0;  ///< the way is so far outside, along z
};

Result<std::vector<cache::Triangle>> plain() {
    std::vector<cache::Triangle> out;
    constexpr double cell_m = plain_side_m / plain_cells;
    for (int row = 0; row < plain_cells; ++row) {
        for (int column = 0; column < plain_cells; ++column) {
            const double x = column * cell_m, z = row * cell_m;
            out.push_back({dvec3(x, 0, z), dvec3(x + cell_m, 0, z + cell_m), dvec3(x, plain_height_m, z + cell_m)});
        }
    }
    return out;
}

/// All instances, in the world.
std::vector<cache::Triangle> triangles_of(const importer::Scene& scene) {
    std::vector<cache::Triangle> out;
    out.reserve(scene.triangles());
    for (const importer::Node& node : scene.nodes) {
        if (node.mesh == importer::none) continue;
        const auto place = [&](const vec3& p) { return dvec3(node.world * dvec4(dvec3(p), 1.0)); };
        for (const importer::Primitive& part : scene.meshes[node.mesh].primitives)
            for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3)
                out.push_back({place(part.positions[part.indices[i]]), place(part.positions[part.indices[i + 1]]),
                               place(part.positions[part.indices[i + 2]])});
    }
    return out;
}

Result<std::vector<cache::Triangle>> generated(std::string_view name) {
    auto made = scenes::generate(name, 1, 1);
    if (!made) return made.error();
    return triangles_of(made->scene);
}

const std::array<StudyEntry, 4> entries = {
    StudyEntry{{"flat", "a plain of 512 m, crossed on its diagonal (figures 6 and 9)"},
               120,
               {.branching = 4, .levels = 5},
               plain,
               {0.1, 0.1},
               {0.9, 0.9}},
    StudyEntry{{"forest", "100 trees, passed sideways (figure 7, left)"},
               100,
               {.branching = 8, .levels = 4},
               [] { return generated("forest"); },
               {0, 1},
               {1, 1},
               5},
    StudyEntry{{"zoom", "the same trees, from a corner to the middle (figure 7, right)"},
               100,
               {.branching = 8, .levels = 4},
               [] { return generated("forest"); },
               {0, 0},
               {0.5, 0.5}},
    StudyEntry{{"room", "a furnished room, through it inside (figures 10 and 11)"},
               100,
               {.branching = 8, .levels = 3},
               [] { return generated("room"); },
               {0.4, 0.78},
               {0.88, 0.78}},
};

/// share: of the way.
dvec3 eye_of(const StudyEntry& entry, const Box& scene, double share) {
    const dvec2 at = entry.from + share * (entry.to - entry.from);
    const dvec3 side = scene.max - scene.min;
    return {scene.min.x + at.x * side.x, walking_eye_m, scene.min.z + at.y * side.z + entry.before_scene_m};
}

const StudyEntry* entry_of(std::string_view study) {
    for (const StudyEntry& entry : entries)
        if (entry.name.name == study) return &entry;
    return nullptr;
}

}  // namespace

std::span<const Named> studies() {
    static const std::vector<Named> names = [] {
        std::vector<Named> all;
        all.reserve(entries.size());
        for (const StudyEntry& entry : entries) all.push_back(entry.name);
        return all;
    }();
    return names;
}

std::uint32_t usual_frames(std::string_view study) {
    const StudyEntry* const entry = entry_of(study);
    return entry == nullptr ? 0 : entry->frames;
}

Result<StudyScene> make_study(std::string_view study, std::uint32_t frames) {
    const StudyEntry* const entry = entry_of(study);
    if (entry == nullptr)
        return Error{std::string(study), "There is no study of this name", "Choose one of " + names_in_words(studies()),
                     ErrorKind::not_found};
    auto triangles = entry->triangles();
    if (!triangles) return triangles.error();
    StudyScene scene;
    scene.triangles = std::move(*triangles);
    auto tree = cache::make_boxes(scene.triangles, entry->tree);
    if (!tree) return tree.error();
    scene.tree = std::move(*tree);
    const Box& all = scene.tree.boxes.front().box;
    const double steps = std::max(frames, 2U) - 1.0;
    for (std::uint32_t frame = 0; frame < frames; ++frame) scene.eyes.push_back(eye_of(*entry, all, frame / steps));
    scene.walked_m = glm::length(scene.eyes.back() - scene.eyes.front());
    scene.step_m = scene.walked_m / steps;
    return scene;
}

}  // namespace surefoot::cache_study
