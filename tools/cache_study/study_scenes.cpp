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
    Result<StudyScene> (*triangles)();
    dvec2 from, to;               ///< ends of the way, along x and z, as shares of the scene
    double before_scene_m = 0;    ///< the way is so far outside, along z
    bool looks_at_scene = false;  ///< across the way, against z; else along the way
};

/// Light of the sun on a surface, from above and a side.
constexpr double shade_low = 0.45;
double shade_of(const dvec3& normal) {
    const dvec3 sun = glm::normalize(dvec3(0.36, 0.80, 0.48));
    return shade_low + (1 - shade_low) * std::max(0.0, glm::dot(normal, sun));
}

std::array<std::uint8_t, 3> shaded(const dvec3& colour, double shade) {
    const dvec3 bytes = glm::clamp(colour * shade * 255.0 + 0.5, 0.0, 255.0);
    return {static_cast<std::uint8_t>(bytes.x), static_cast<std::uint8_t>(bytes.y), static_cast<std::uint8_t>(bytes.z)};
}

Result<StudyScene> plain() {
    StudyScene out;
    constexpr double cell_m = plain_side_m / plain_cells;
    for (int row = 0; row < plain_cells; ++row) {
        for (int column = 0; column < plain_cells; ++column) {
            const double x = column * cell_m, z = row * cell_m;
            out.triangles.push_back({dvec3(x, 0, z), dvec3(x + cell_m, 0, z + cell_m), dvec3(x, plain_height_m, z + cell_m)});
            const dvec3 colour(0.35 + 0.3 * (column % 3) / 2.0, 0.55 + 0.3 * (row % 4) / 3.0, 0.3);
            out.colours.push_back({shaded(colour, 1), shaded(colour, 1), shaded(colour, 1)});
            out.objects.push_back(static_cast<std::uint32_t>(out.objects.size()));
            out.two_sided.push_back(true);
        }
    }
    return out;
}

/// Colours of materials, those of their images in the mean.
std::vector<dvec3> colours_of(const importer::Scene& scene) {
    std::vector<dvec3> out;
    for (const importer::Material& material : scene.materials) {
        dvec3 mean(1.0);
        if (material.image != importer::none) {
            const std::vector<std::uint8_t>& rgba = scene.images[material.image].rgba;
            mean = dvec3(0.0);
            for (std::size_t i = 0; i < rgba.size(); i += 4) mean += dvec3(rgba[i], rgba[i + 1], rgba[i + 2]);
            mean /= 255.0 * std::max(1.0, static_cast<double>(rgba.size()) / 4.0);
        }
        out.push_back(mean * dvec3(material.colour[0], material.colour[1], material.colour[2]));
    }
    return out;
}

/// All instances, in the world.
StudyScene triangles_of(const importer::Scene& scene) {
    StudyScene out;
    const std::vector<dvec3> colours = colours_of(scene);
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
        const importer::Node& node = scene.nodes[n];
        if (node.mesh == importer::none) continue;
        const dmat3 turn = cofactors(dmat3(node.world));
        for (const importer::Primitive& part : scene.meshes[node.mesh].primitives) {
            for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
                cache::Triangle corners;
                CornerColours colour;
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::uint32_t at = part.indices[i + c];
                    corners[c] = dvec3(node.world * dvec4(dvec3(part.positions[at]), 1.0));
                    const dvec3 own = part.colours.empty()
                                          ? dvec3(1.0)
                                          : dvec3(part.colours[at][0], part.colours[at][1], part.colours[at][2]) / 255.0;
                    const double shade = part.normals.empty() ? 1 : shade_of(glm::normalize(turn * dvec3(part.normals[at])));
                    colour[c] = shaded(own * colours[part.material], shade);
                }
                out.triangles.push_back(corners);
                out.colours.push_back(colour);
                out.objects.push_back(static_cast<std::uint32_t>(n));
                out.two_sided.push_back(scene.materials[part.material].two_sided);
            }
        }
    }
    return out;
}

Result<StudyScene> generated(std::string_view name) {
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
               5,
               true},
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
    auto made = entry->triangles();
    if (!made) return made.error();
    StudyScene scene = std::move(*made);
    auto tree = cache::make_boxes(scene.triangles, entry->tree);
    if (!tree) return tree.error();
    scene.tree = std::move(*tree);
    const Box& all = scene.tree.boxes.front().box;
    const double steps = std::max(frames, 2U) - 1.0;
    for (std::uint32_t frame = 0; frame < frames; ++frame) scene.eyes.push_back(eye_of(*entry, all, frame / steps));
    scene.forward = entry->looks_at_scene ? dvec3(0, 0, -1) : glm::normalize(eye_of(*entry, all, 1) - eye_of(*entry, all, 0));
    scene.walked_m = glm::length(scene.eyes.back() - scene.eyes.front());
    scene.step_m = scene.walked_m / steps;
    return scene;
}

}  // namespace surefoot::cache_study
