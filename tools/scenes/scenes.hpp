// Generated scenes and the paths through them: the same bits from the same (name, scale, seed).
// forest: 100 trees, 105 000 polygons at scale 1 (the scene of Schaufler & Stuerzlinger 1996, figure 7). room: furniture
// that interpenetrates, about 60 000. town: streets, houses with rooms, furniture, trees, lamps, about a million.
// garden: plants of masked cards, fences and wires, about 140 000. gallery: two spheres, a cylinder and a statue.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/import/scene.hpp"
#include "rt/base/path.hpp"
#include "rt/base/result.hpp"

namespace surefoot::scenes {

/// A generated scene, with a path through it.
struct GeneratedScene {
    importer::Scene scene;  ///< metres, +Y up, ground about y = 0; instances share meshes
    Path path;              ///< 60 s at scale 1, at walking height but for its overlook; smooth
};

constexpr std::string_view gallery_name = "gallery", town_name = "town";

/// forest, room, town, garden, gallery.
std::vector<std::string> scene_names();

constexpr double min_scale = 0.01, max_scale = 200.0;

/// scale > 0 multiplies what there is (trees, rooms' area, blocks of houses), 1 is the size named above; 0.01 to 200.
/// `lamps`: as in the evening, with lamps that shine and windows that glow. Errors: unknown name, scale out of range, a scene
/// that has no lamps.
Result<GeneratedScene> generate(std::string_view name, double scale, std::uint64_t seed, bool lamps = false);

/// The gallery with another statue, of a model file that the importer reads. Errors: of the importer, scale out of range.
Result<GeneratedScene> generate_gallery(double scale, std::uint64_t seed, const std::string& statue_file,
                                        const Progress& progress);

/// ".glb, .ostf".
std::string written_endings();
/// Whether a scene can be written under this name, and its lamps too.
Result<void> check_ending(const std::string& out, bool lamps);
/// By ending; and beside it `out` with its ending replaced by .path.csv. OSTF holds neither lamps nor glow: they are left out.
Result<void> write_scene(const std::string& out, const GeneratedScene& generated);

/// glTF 2.0 binary: shared meshes, node tree with matrices and names, PNG pictures, vertex colours as linear 16-bit numbers.
/// Each lamp becomes a root node behind all others.
Result<void> write_glb(const std::string& file, const importer::Scene& scene);

}  // namespace surefoot::scenes
