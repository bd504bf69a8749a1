// Trees, bushes and undergrowth, grown from a few numbers to a wanted number of triangles.
#pragma once

#include "rt/base/random.hpp"
#include "tools/scenes/mesh_maker.hpp"

namespace surefoot::scenes {

/// Bark and leaves are coloured by their vertices; leaves are seen from both sides.
struct PlantMaterials {
    Index bark = 0, leaf = 0;
};

/// Metres. Leaves grow in clumps at the ends of branches.
struct TreeShape {
    double height = 12, crown_base = 4, crown_radius = 3, trunk_radius = 0.22;
    int branches = 9;
    double leaf_length = 0.9, leaf_width = 0.28;
    double clump_radius = 1.2;
    bool needles = false;  ///< leaves point away from the clump's middle
    Colour bark = rgb(92, 74, 56), dark = rgb(46, 84, 30), light = rgb(126, 160, 62);
    bool bark_marks = false;  ///< birch
};

/// A broad-leaved tree or pine of exactly `triangles` (even, and more than its wood takes).
importer::Mesh broad_tree(const std::string& name, const PlantMaterials& materials, const TreeShape& shape, std::size_t triangles,
                          std::uint64_t seed);
/// A spruce of exactly `triangles` (a multiple of 4 above its trunk).
importer::Mesh spruce(const std::string& name, const PlantMaterials& materials, double height, double radius,
                      std::size_t triangles, std::uint64_t seed);

importer::Mesh fern(const PlantMaterials& materials, std::uint64_t seed);        ///< 40 triangles
importer::Mesh grass_tuft(const PlantMaterials& materials, std::uint64_t seed);  ///< 10
importer::Mesh rock(const PlantMaterials& materials, std::uint64_t seed);        ///< 20
importer::Mesh fallen_log(const PlantMaterials& materials, std::uint64_t seed);  ///< 60
/// Leaves in a ball on the ground, `triangles` (even) of them.
importer::Mesh bush(const std::string& name, const PlantMaterials& materials, double radius, std::size_t triangles,
                    const Colour& dark, const Colour& light, std::uint64_t seed);

}  // namespace surefoot::scenes
