// The colour that a vertex carries when its pictures are gone.
#include <gtest/gtest.h>

#include "render/bake/materials.hpp"

namespace surefoot::bake {
namespace {

/// A leaf: green in the middle, black and transparent round it.
model::Model leaf() {
    model::Model m;
    std::vector<std::uint8_t> rgba;
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) {
            const bool inside = x >= 5 && x < 11 && y >= 5 && y < 11;
            for (const int c : {inside ? 20 : 0, inside ? 200 : 0, inside ? 40 : 0, inside ? 255 : 0}) {
                rgba.push_back(static_cast<std::uint8_t>(c));
            }
        }
    }
    add_texture(m, rgba, 16, 16, false, 32);
    return m;
}

model::Material material_of(model::AlphaMode alpha) {
    model::Material material;
    material.colour = {1, 1, 1, 1};
    material.texture = 0;
    material.alpha = alpha;
    return material;
}

TEST(BakedColour, OfALeafsCornerIsTheLeafs) {
    const model::Model m = leaf();
    model::Vertex corner{};
    for (const model::AlphaMode alpha : {model::AlphaMode::mask, model::AlphaMode::blend}) {
        const auto colour = baked_colour(m, material_of(alpha), corner);
        EXPECT_NEAR(colour[0], 20, 2);
        EXPECT_NEAR(colour[1], 200, 2);
        EXPECT_NEAR(colour[2], 40, 2);
    }
}

TEST(BakedColour, OfWhatIsOpaqueIsOfItsPlace) {
    const model::Model m = leaf();
    model::Vertex corner{}, middle{};
    middle.uv[0] = middle.uv[1] = 0.5F;
    EXPECT_LT(baked_colour(m, material_of(model::AlphaMode::opaque), corner)[1], 10);
    EXPECT_GT(baked_colour(m, material_of(model::AlphaMode::opaque), middle)[1], 190);
}

}  // namespace
}  // namespace surefoot::bake
