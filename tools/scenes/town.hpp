// The town: blocks of furnished houses on a grid of streets, trees and lamps, a square with a fountain and a town hall.
#pragma once

#include <unordered_map>

#include "tools/scenes/building.hpp"
#include "tools/scenes/plants.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot::scenes {

/// 9 * scale blocks, each 38 m wide with 6 m of road between; the square is the block at 44, 44 m.
/// `lit`: street lamps shine, the kitchen on the path has a lamp, and about two windows of five glow. All else stays as it is.
GeneratedScene make_town(double scale, std::uint64_t seed, bool lit);

/// Outdoor materials beside a Stuff's; plaster and tiles are tinted by the vertices.
struct TownStuff {
    Stuff stuff;
    PlantMaterials plants;  ///< leaves are masked sprays
    Index brick = 0, plaster = 0, tiles = 0, floor = 0, paving = 0, cobbles = 0, asphalt = 0, grass = 0, water = 0;
    Index lamp_glass = 0;              ///< tinted by the vertices; glows in a lit town
    Index lit_glass = importer::none;  ///< of windows; none in a town that is not lit
};

/// One kind of house, its furniture included: a group of meshes to be placed again and again. Its front is the plane
/// z = 0 looking to +z, its west corner x = 0; door at house_door_m; ground floor at y = 0.
struct House {
    /// One mesh of the house, and where it stands in it.
    struct HousePart {
        const char* name;
        Index mesh;
        dmat4 where;
    };
    std::vector<HousePart> parts;
    std::vector<Index> lit_windows{};  ///< in place of the part `windows`: other panes glow in each; empty if the town is not lit
};

constexpr double house_width_m = 8.5, house_depth_m = 9.0;
constexpr double house_door_m = 1.5;  ///< middle of the front door
constexpr int house_kinds = 4;
constexpr dvec3 kitchen_lamp_m(6.6, 2.65, -6.4);  ///< where the pendant lamp over the kitchen's table hangs from
/// Furniture made so far, by what it looks like: all houses share it.
using FurnitureMade = std::unordered_map<std::uint64_t, Index>;

/// `detail` cuts the furniture; kinds differ in storeys, walls, shutters and furniture.
House make_house(SceneMaker& maker, const TownStuff& stuff, const Detail& detail, int kind, std::uint64_t seed,
                 FurnitureMade& made);

constexpr double balcony_m = 4.5;  ///< height of the town hall's balcony
/// Its front is the plane z = 0, looking to +z, with x from -13 to 13. An outer stair climbs from x = 11 on the ground to x = 3
/// on the balcony. The balcony has x from -7 to 3, and z from 0 to 2.4.
importer::Mesh town_hall(const TownStuff& stuff, const Detail& detail);
importer::Mesh fountain(const TownStuff& stuff, const Detail& detail);     ///< basin of 4 m radius
importer::Mesh street_lamp(const TownStuff& stuff, const Detail& detail);  ///< arm towards +z
constexpr dvec3 street_lamp_light_m(0, 3.05, 0.7);                         ///< below the head of a street lamp
importer::Mesh bench(const TownStuff& stuff, const Detail& detail);
importer::Mesh market_stall(const TownStuff& stuff, const Detail& detail, const Colour& stripe);
importer::Mesh hedge(const TownStuff& stuff, double length, std::uint64_t seed);

}  // namespace surefoot::scenes
