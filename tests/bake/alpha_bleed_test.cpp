// The colour of texels that are never shown: the nearest shown one's, in every mip level; and nobody else's picture changes.
#include <gtest/gtest.h>

#include <algorithm>

#include "render/bake/alpha_bleed.hpp"
#include "render/bake/materials.hpp"
#include "rt/base/random.hpp"

namespace surefoot::bake {
namespace {

using Texel = std::array<std::uint8_t, 4>;

Texel texel_of(std::span<const std::uint8_t> rgba, std::size_t i) {
    return {rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2], rgba[4 * i + 3]};
}

std::uint32_t steps(std::uint32_t a, std::uint32_t b, std::uint32_t size, bool clamp) {
    const std::uint32_t straight = std::max(a, b) - std::min(a, b);
    return clamp ? straight : std::min(straight, size - straight);
}

/// Each texel's colour is its own number: where one has another's, that one must be shown and no shown one nearer.
TEST(AlphaBleed, GivesTheColourOfANearestShownTexel) {
    Random random(25);
    for (int turn = 0; turn < 400; ++turn) {
        const std::uint32_t w = 1 + random.below(14), h = 1 + random.below(14), texels = w * h;
        const bool clamp = random.below(2) == 0;
        const std::uint32_t one_in = 1 + random.below(30);
        std::vector<std::uint8_t> before;
        for (std::uint32_t i = 0; i < texels; ++i) {
            const std::uint32_t alpha = random.below(one_in) == 0 ? 101 + random.below(155) : random.below(101);
            for (const std::uint32_t c : {i % 256, i / 256, 7U, alpha}) before.push_back(static_cast<std::uint8_t>(c));
        }
        const auto shown = [&](std::uint32_t i) { return before[4 * i + 3] > 100; };
        std::vector<std::uint8_t> after = before;
        bleed_colours(after, w, h, clamp, 100);
        for (std::uint32_t i = 0; i < texels; ++i) {
            ASSERT_EQ(after[4 * i + 3], before[4 * i + 3]);
            const std::uint32_t from = after[4 * i] + 256U * after[4 * i + 1];
            const auto away = [&](std::uint32_t j) { return steps(i % w, j % w, w, clamp) + steps(i / w, j / w, h, clamp); };
            std::uint32_t nearest = 100;
            for (std::uint32_t j = 0; j < texels; ++j)
                if (shown(j)) nearest = std::min(nearest, away(j));
            if (nearest == 100) {
                ASSERT_EQ(from, i) << "changed where nothing is shown";
            } else {
                ASSERT_TRUE(shown(from));
                ASSERT_EQ(away(from), nearest) << w << " x " << h << (clamp ? " clamped" : "") << ", texel " << i;
            }
        }
    }
}

image::Image image_of(const std::vector<Texel>& texels, std::uint32_t width, std::uint32_t height) {
    image::Image image{"picture", width, height, {}, true};
    for (const Texel& t : texels) image.rgba.insert(image.rgba.end(), t.begin(), t.end());
    return image;
}

importer::Material material_of(model::AlphaMode alpha, float cutoff, float opacity, importer::Index image = 0) {
    importer::Material material;
    material.alpha = alpha;
    material.alpha_cutoff = cutoff;
    material.colour[3] = opacity;
    material.image = image;
    return material;
}

TEST(AlphaBleed, HiddenIsWhatAMaskDropsOrWhatIsClear) {
    using model::AlphaMode;
    const auto image = image_of({{0, 0, 0, 0}, {0, 0, 0, 100}, {0, 0, 0, 128}, {0, 0, 0, 255}}, 2, 2);
    const auto hidden = [&](AlphaMode alpha, float cutoff, float opacity) {
        return hidden_alpha(material_of(alpha, cutoff, opacity), image);
    };
    EXPECT_EQ(hidden(AlphaMode::opaque, 0.5F, 1), std::nullopt);
    EXPECT_EQ(hidden(AlphaMode::mask, 0.5F, 1), 100);
    EXPECT_EQ(hidden(AlphaMode::mask, 0.3F, 1), 0);
    EXPECT_EQ(hidden(AlphaMode::mask, 0.5F, 0.75F), 128);
    EXPECT_EQ(hidden(AlphaMode::mask, 128.0F / 255, 1), 100) << "a texel at the cutoff is shown";
    EXPECT_EQ(hidden(AlphaMode::mask, 0, 1), std::nullopt);
    EXPECT_EQ(hidden(AlphaMode::mask, 2, 1), 255);
    EXPECT_EQ(hidden(AlphaMode::blend, 0.5F, 1), 0);
    EXPECT_EQ(hidden_alpha(material_of(AlphaMode::blend, 0.5F, 1), image_of({{0, 0, 0, 1}}, 1, 1)), std::nullopt);
}

/// Green where x < shown, magenta with alpha `hidden` elsewhere.
image::Image half_magenta(std::uint32_t shown, std::uint8_t hidden) {
    std::vector<Texel> texels;
    for (std::uint32_t i = 0; i < 37 * 20; ++i)
        texels.push_back(i % 37 < shown ? Texel{0, 200, 0, 255} : Texel{255, 0, 255, hidden});
    return image_of(texels, 37, 20);
}

TEST(AlphaBleed, LeavesNoHiddenColourInAnyMipLevel) {
    for (const auto& [alpha, hidden] :
         {std::pair{model::AlphaMode::mask, 100}, {model::AlphaMode::mask, 0}, {model::AlphaMode::blend, 0}}) {
        importer::Scene scene;
        scene.images = {half_magenta(3, static_cast<std::uint8_t>(hidden))};
        scene.materials = {material_of(alpha, 0.5F, 1)};
        model::Model model;
        add_materials(scene, model);
        ASSERT_EQ(model.textures.size(), 1U);
        EXPECT_EQ(model.textures[0].levels, alpha == model::AlphaMode::blend ? 6U : 5U)
            << "a mask's one texel shows all or nothing";
        for (std::size_t i = 0; i < model.texels.size(); i += 4) {
            ASSERT_EQ(std::to_integer<int>(model.texels[i]), 0) << i;
            ASSERT_EQ(std::to_integer<int>(model.texels[i + 1]), 200) << i;
        }
    }
}

TEST(AlphaBleed, WhatOneMaterialHidesAnotherMayShow) {
    using model::AlphaMode;
    importer::Scene scene;
    scene.images = {half_magenta(3, 0), half_magenta(9, 100), half_magenta(5, 0)};
    scene.materials = {material_of(AlphaMode::mask, 0.5F, 1, 0),  material_of(AlphaMode::opaque, 0.5F, 1, 0),
                       material_of(AlphaMode::blend, 0.5F, 1, 0), material_of(AlphaMode::mask, 0.5F, 1, 1),
                       material_of(AlphaMode::mask, 0.25F, 1, 1), material_of(AlphaMode::mask, 0.4F, 1, 1),
                       material_of(AlphaMode::mask, 0.5F, 1, 2),  material_of(AlphaMode::opaque, 0.5F, 1, importer::none)};
    model::Model model;
    add_materials(scene, model);
    const auto texture = [&](std::size_t m) { return model.materials[m].texture; };
    const auto last_texel = [&](std::size_t m) {
        const model::Texture& t = model.textures[texture(m)];
        const auto* texels = reinterpret_cast<const std::uint8_t*>(model.texels.data() + t.first_byte);
        return texel_of({texels, std::size_t{4} * t.width * t.height}, 36);
    };
    const Texel magenta{255, 0, 255, 0}, faint{255, 0, 255, 100}, clear{0, 200, 0, 0}, faint_green{0, 200, 0, 100};
    EXPECT_EQ(last_texel(0), clear);
    EXPECT_EQ(last_texel(1), magenta);
    EXPECT_NE(texture(2), texture(0)) << "a mask's levels are scaled, what fades is not";
    EXPECT_EQ(last_texel(2), clear);
    EXPECT_EQ(last_texel(3), faint_green);
    EXPECT_EQ(last_texel(4), faint);
    EXPECT_EQ(texture(5), texture(3)) << "one copy for all masks that hide the same texels";
    EXPECT_EQ(texture(6), 2U);
    EXPECT_EQ(last_texel(6), clear);
    EXPECT_EQ(texture(7), model::none);
    EXPECT_EQ(model.textures.size(), 6U);
}

}  // namespace
}  // namespace surefoot::bake
