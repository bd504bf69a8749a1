// What a mask shows at each mip level: as much as the picture does, whether it is thin, dense or scattered.
#include "render/bake/mask_coverage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "render/bake/materials.hpp"
#include "rt/base/random.hpp"

namespace surefoot::bake {
namespace {

constexpr std::uint32_t mask_side = 256;
constexpr float half_alpha = 127.5F;

/// Its own mip chain: green where something is shown, black elsewhere.
struct Chain {
    Chain(const std::function<int(std::uint32_t, std::uint32_t)>& alpha, float cutoff) {
        std::vector<std::uint8_t> rgba;
        for (std::uint32_t y = 0; y < mask_side; ++y) {
            for (std::uint32_t x = 0; x < mask_side; ++x) {
                const int a = alpha(x, y);
                for (const int c : {0, a > 0 ? 200 : 0, 0, a}) rgba.push_back(static_cast<std::uint8_t>(c));
            }
        }
        add_texture(model, rgba, mask_side, mask_side, false, 32, cutoff);
    }
    [[nodiscard]] std::uint32_t levels() const { return model.textures[0].levels; }
    [[nodiscard]] double coverage(std::uint32_t level, float cutoff) const {
        std::uint64_t at = model.textures[0].first_byte;
        for (std::uint32_t l = 0; l < level; ++l) at += 4ULL * (mask_side >> l) * (mask_side >> l);
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(model.texels.data()) + at;
        const std::uint32_t n = mask_side >> level;
        std::vector<std::uint8_t> copy(bytes, bytes + std::size_t{4} * n * n);
        return mask_coverage({copy, n, n, false}, cutoff);
    }
    model::Model model;
};

int wires(std::uint32_t x, std::uint32_t) { return x % 32 < 3 ? 255 : 0; }
int holes(std::uint32_t x, std::uint32_t y) { return x % 16 < 6 && y % 16 < 6 ? 0 : 255; }
/// Needles of many lengths and directions, with soft edges.
int needles(std::uint32_t x, std::uint32_t y) {
    static const std::vector<int> picture = [] {
        std::vector<int> out(std::size_t{mask_side} * mask_side, 0);
        Random random(5);
        for (int needle = 0; needle < 260; ++needle) {
            const double from_x = random.range(0, mask_side), from_y = random.range(0, mask_side);
            const double angle = random.range(0, 6.283), length = random.range(8, 40);
            for (double s = 0; s < length; s += 0.25) {
                const auto px = static_cast<std::uint32_t>(from_x + s * std::cos(angle) + mask_side) % mask_side;
                const auto py = static_cast<std::uint32_t>(from_y + s * std::sin(angle) + mask_side) % mask_side;
                out[std::size_t{py} * mask_side + px] = 160 + needle % 96;
            }
        }
        return out;
    }();
    return picture[std::size_t{y} * mask_side + x];
}

TEST(MaskCoverage, OfAPictureIsTheShareThatIsShown) {
    std::vector<std::uint8_t> rgba(std::size_t{4} * 64 * 64, 0);
    for (std::size_t i = 0; i < rgba.size(); i += 16) rgba[i + 3] = 255;  // every fourth column
    EXPECT_NEAR(mask_coverage({rgba, 64, 64, false}, half_alpha), 0.25, 1e-9);
    EXPECT_NEAR(mask_coverage({rgba, 64, 64, false}, 1.0F), 0.5, 1e-9) << "bilinear filtering widens a column to two";
    EXPECT_EQ(mask_coverage({rgba, 64, 64, false}, 255.5F), 0);
}

TEST(MaskCoverage, IsKeptByEveryLevelThatCanShowIt) {
    struct Case {
        const char* name;
        int (*alpha)(std::uint32_t, std::uint32_t);
        std::uint32_t last;  ///< the last whose texels are a quarter of what lies between its parts
    };
    for (const Case& c : {Case{"wires", wires, 3}, Case{"holes", holes, 3}, Case{"needles", needles, 5}}) {
        const Chain kept(c.alpha, half_alpha), plain(c.alpha, 0);
        const double wanted = kept.coverage(0, half_alpha), part = std::min(wanted, 1 - wanted);
        double worst = 0, worst_plain = 0;
        for (std::uint32_t level = 1; level <= c.last; ++level) {
            worst = std::max(worst, std::abs(kept.coverage(level, half_alpha) - wanted) / part);
            worst_plain = std::max(worst_plain, std::abs(plain.coverage(level, half_alpha) - wanted) / part);
        }
        std::printf("%s: %.1f %% shown; off by %.1f %% of the smaller part at most, plain means by %.0f %%\n", c.name,
                    100 * wanted, 100 * worst, 100 * worst_plain);
        EXPECT_LE(worst, 0.12) << c.name;
        EXPECT_GE(worst_plain, 0.5) << "void: plain means do as well with " << c.name;
    }
}

TEST(MaskCoverage, IsThatOfTheMaterialsOwnCutoff) {
    for (const float cutoff : {0.3F * 255, 0.6F * 255}) {
        const Chain kept(needles, cutoff), other(needles, half_alpha);
        const double wanted = kept.coverage(0, cutoff);
        for (std::uint32_t level = 1; level <= 6; ++level) {
            EXPECT_NEAR(kept.coverage(level, cutoff) / wanted, 1, 0.15) << level;
            EXPECT_GT(std::abs(other.coverage(level, cutoff) / wanted - 1), 0.15) << "void: the cutoff makes no difference";
        }
    }
}

TEST(MaskCoverage, LeavesTheFirstLevelAndWhatIsNoMaskAlone) {
    const Chain kept(needles, half_alpha), plain(needles, 0);
    const std::size_t first = std::size_t{4} * mask_side * mask_side;
    EXPECT_TRUE(std::equal(kept.model.texels.begin(), kept.model.texels.begin() + first, plain.model.texels.begin()));
    EXPECT_EQ(plain.levels(), 9U);
    EXPECT_LT(kept.levels(), 9U) << "one texel shows all or nothing";
    std::vector<std::uint8_t> all(std::size_t{4} * 8 * 8, 200), none(std::size_t{4} * 8 * 8, 9), before = all;
    keep_coverage({all, 8, 8, false}, half_alpha, 1);
    EXPECT_EQ(all, before);
    before = none;
    keep_coverage({none, 8, 8, false}, half_alpha, 0);
    EXPECT_EQ(none, before);
}

TEST(MaskCoverage, OfAMaterialThatFadesIsNotTouched) {
    importer::Scene scene;
    image::Image image;
    image.width = image.height = mask_side;
    for (std::uint32_t y = 0; y < mask_side; ++y)
        for (std::uint32_t x = 0; x < mask_side; ++x)
            for (const int c : {10, 200, 30, needles(x, y)}) image.rgba.push_back(static_cast<std::uint8_t>(c));
    scene.images.push_back(image);
    importer::Material mask, blend;
    mask.image = blend.image = 0;
    mask.alpha = model::AlphaMode::mask;
    mask.alpha_cutoff = 0.5F;
    blend.alpha = model::AlphaMode::blend;
    scene.materials = {mask, blend};
    model::Model m;
    add_materials(scene, m);
    ASSERT_NE(m.materials[0].texture, m.materials[1].texture);
    EXPECT_LT(m.textures[m.materials[0].texture].levels, 9U);
    EXPECT_EQ(m.textures[m.materials[1].texture].levels, 9U);
    // Of many cutoffs that show the same texels one texture is enough; what fades never takes a mask's.
    for (int i = 1; i <= 8; ++i) {
        scene.materials.push_back(mask);
        scene.materials.back().alpha_cutoff = 0.5F + 0.0001F * static_cast<float>(i);
    }
    model::Model many;
    add_materials(scene, many);
    EXPECT_EQ(many.textures.size(), 2U);
}

TEST(MaskCoverage, LevelsEndBeforeTheyShowAllOrNothing) {
    for (const auto alpha : {wires, holes, needles}) {
        const Chain kept(alpha, half_alpha);
        EXPECT_GE(kept.levels(), 4U);
        EXPECT_LT(kept.levels(), 9U);
        const double wanted = kept.coverage(0, half_alpha);
        for (std::uint32_t level = 1; level < kept.levels(); ++level)
            EXPECT_NEAR(kept.coverage(level, half_alpha), wanted, 0.6 * std::min(wanted, 1 - wanted)) << level;
    }
}

}  // namespace
}  // namespace surefoot::bake
