// Plants of masked cards, and fences: the meshes of the garden. Metres; all stand on y = 0.
#pragma once

#include "tools/scenes/scene_maker.hpp"

namespace surefoot::scenes {

/// Bark and wood are coloured by their vertices. The other materials are masked pictures, seen from both sides.
struct GardenMaterials {
    Index bark = 0, wood = 0;
    Index sprays = 0, fronds = 0, blades = 0, petals = 0;
    Index wire_mesh = 0;  ///< repeats
};

GardenMaterials garden_materials(SceneMaker& maker, std::uint64_t seed);

importer::Mesh apple_tree(const GardenMaterials& materials, std::uint64_t seed);  ///< 5 m high, 380 cards
importer::Mesh hedge(const GardenMaterials& materials, std::uint64_t seed);       ///< 1.5 m along x, 1.1 high, 150 cards
importer::Mesh fern_of_fronds(const GardenMaterials& materials, std::uint64_t seed);
importer::Mesh rose(const GardenMaterials& materials, std::uint64_t seed);  ///< 1.3 m high, stems of 6 mm
importer::Mesh tuft_of_blades(const GardenMaterials& materials, std::uint64_t seed);

constexpr double panel_m = 2.0;  ///< of a fence, along x from 0
importer::Mesh picket_panel(const GardenMaterials& materials);
importer::Mesh wire_panel(const GardenMaterials& materials);

}  // namespace surefoot::scenes
