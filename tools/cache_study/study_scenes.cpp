// Scenes and walks of the studies.
#include "tools/cache_study/study_scenes.hpp"

#include <array>
#include <string>

#include "tools/scenes/scenes.hpp"

namespace surefoot::cache_study {

namespace {

/// The paper gives neither speeds nor rates: a person walks, at 30 Hz.
constexpr double step_m = 1.4 / 30;
constexpr double walking_eye_m = 1.7;

/// A wide plain of equal complexity everywhere: upright triangles on a grid, so flat that no box is split in height.
constexpr int plain_cells = 64;
constexpr double plain_side_m = 512, plain_height_m = 3;

struct StudyEntry {
    Named name;
    std::uint32_t frames;
    cache::TreeOptions tree;
    Result<std::vector<cache::Triangle>> (*triangles)();
    dvec3 (*eye)(const Box& scene, double way_m);
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

const dvec3 diagonal = dvec3(1, 0, 1) / 1.4142135623730951;

const std::array<StudyEntry, 4> entries = {
    StudyEntry{{"flat", "a plain of 512 m, on its diagonal (figures 6 and 9)"},
               120,
               {.branching = 4, .levels = 5},
               plain,
               [](const Box& scene, double way_m) {
                   const dvec3 side = scene.max - scene.min;
                   return scene.min + dvec3(0.3 * side.x, walking_eye_m, 0.3 * side.z) + way_m * diagonal;
               }},
    StudyEntry{{"forest", "100 trees, passed sideways (figure 7, left)"},
               100,
               {.branching = 8, .levels = 4},
               [] { return generated("forest"); },
               [](const Box& scene, double way_m) {
                   return dvec3(0.45 * (scene.min.x + scene.max.x) + way_m, walking_eye_m, scene.max.z + 5);
               }},
    StudyEntry{
        {"zoom", "the same trees, from a corner towards the middle (figure 7, right)"},
        100,
        {.branching = 8, .levels = 4},
        [] { return generated("forest"); },
        [](const Box& scene, double way_m) { return dvec3(scene.min.x, walking_eye_m, scene.min.z) + (way_m - 10) * diagonal; }},
    StudyEntry{{"room", "a furnished room, towards it from outside (figures 10 and 11)"},
               100,
               {.branching = 8, .levels = 3},
               [] { return generated("room"); },
               [](const Box& scene, double way_m) { return dvec3(scene.centre().x, walking_eye_m, scene.max.z + 6 - way_m); }},
};

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
    for (std::uint32_t frame = 0; frame < frames; ++frame)
        scene.eyes.push_back(entry->eye(scene.tree.boxes.front().box, frame * step_m));
    return scene;
}

}  // namespace surefoot::cache_study
