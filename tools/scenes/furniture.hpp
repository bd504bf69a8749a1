// Furniture and household things, each a mesh of its own to be placed again and again. Metres; stands on y = 0 and looks
// to +z unless the comment has another rule.
#pragma once

#include "tools/scenes/scene_maker.hpp"

namespace surefoot::scenes {

/// Materials that furniture is made of; all but pictures are tinted by the vertices.
struct Stuff {
    Index plain = 0, thin = 0;  ///< no texture; `thin` is seen from both sides
    Index wood = 0, cloth = 0, glass = 0, spines = 0, leaves = 0;
    Index rug = 0;
    std::array<Index, 4> paintings{};
};

/// How finely curves are cut: 1 for a room that one stands in.
struct Detail {
    double factor = 1.0;
    /// `n` sides or rings at factor 1, at least `min`.
    [[nodiscard]] int cut(int n, int min = 5) const;
    /// Seen from the street through a window: legs are square and knobs are left out.
    [[nodiscard]] bool coarse() const { return factor < 0.3; }
};

Stuff make_stuff(SceneMaker& maker, std::uint64_t seed);

importer::Mesh dining_table(const Stuff& stuff, const Detail& detail);  ///< 1.9 x 0.95, 0.75 high, long along x
importer::Mesh chair(const Stuff& stuff, const Detail& detail, const Colour& seat);
importer::Mesh sofa(const Stuff& stuff, const Detail& detail, const Colour& cloth);      ///< 2.1 wide
importer::Mesh armchair(const Stuff& stuff, const Detail& detail, const Colour& cloth);  ///< 0.95 wide
importer::Mesh coffee_table(const Stuff& stuff, const Detail& detail);                   ///< 1.1 x 0.6, oval
importer::Mesh bookshelf(const Stuff& stuff, double width, double height, int shelves);  ///< 0.3 deep, back at z = 0
/// Stands on y = 0, spines to +z. `fine`: covers and pages apart, else plain blocks.
importer::Mesh row_of_books(const Stuff& stuff, double width, bool fine, std::uint64_t seed);
importer::Mesh sideboard(const Stuff& stuff, const Detail& detail);                   ///< 1.6 x 0.45, 0.85 high, back at z = 0
importer::Mesh bed(const Stuff& stuff, const Detail& detail, const Colour& blanket);  ///< 1.4 x 2.05, head at z = 0
importer::Mesh wardrobe(const Stuff& stuff, const Detail& detail);                    ///< 1.5 x 0.6, 2.1 high, back at z = 0
importer::Mesh kitchen(const Stuff& stuff, const Detail& detail);                     ///< 2.4 x 0.6, back at z = 0
importer::Mesh rug(const Stuff& stuff, const Detail& detail, double width, double depth);

importer::Mesh floor_lamp(const Stuff& stuff, const Detail& detail);
importer::Mesh table_lamp(const Stuff& stuff, const Detail& detail);
importer::Mesh pendant_lamp(const Stuff& stuff, const Detail& detail);               ///< hangs from y = 0
importer::Mesh picture(const Stuff& stuff, int which, double width, double height);  ///< middle at 0, back at z = 0
importer::Mesh curtain(const Stuff& stuff, const Detail& detail, double width, double height,
                       const Colour& colour);  ///< hangs from y = height
importer::Mesh potted_plant(const Stuff& stuff, const Detail& detail, std::uint64_t seed);
importer::Mesh vase_of_flowers(const Stuff& stuff, const Detail& detail, std::uint64_t seed);
importer::Mesh bowl_of_fruit(const Stuff& stuff, const Detail& detail);
importer::Mesh teapot(const Stuff& stuff, const Detail& detail);
importer::Mesh cup(const Stuff& stuff, const Detail& detail);
importer::Mesh plate(const Stuff& stuff, const Detail& detail);
importer::Mesh candlestick(const Stuff& stuff, const Detail& detail);
importer::Mesh radiator(const Stuff& stuff, const Detail& detail);    ///< 1.2 wide, 0.6 high, back at z = 0
importer::Mesh wall_clock(const Stuff& stuff, const Detail& detail);  ///< middle at 0, back at z = 0

}  // namespace surefoot::scenes
