// Pictures on levels: moved, squeezed, repeated, absent.
#include "render/bake/picture_shift.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace surefoot::bake {
namespace {

/// A plate of 8 x 8 squares, 2 m wide, its picture laid on by `uv` of 0..1; and as coarse level its two triangles from corner to
/// corner.
struct Plate {
    Geometry full;
    Level coarse;
};
Plate plate(const std::function<vec2(vec2)>& uv) {
    constexpr std::uint32_t n = 8;
    Plate out;
    GeometryPart part{0, {}};
    for (std::uint32_t y = 0; y <= n; ++y) {
        for (std::uint32_t x = 0; x <= n; ++x) {
            const vec2 at(static_cast<float>(x) / n, static_cast<float>(y) / n);
            const vec2 t = uv(at);
            model::Vertex v{};
            v.position[0] = 2 * at.x;
            v.position[1] = 2 * at.y;
            v.uv[0] = t.x;
            v.uv[1] = t.y;
            out.full.vertices.push_back(v);
            if (x == n || y == n) continue;
            const std::uint32_t a = y * (n + 1) + x, b = a + n + 1;
            for (const std::uint32_t i : {a, a + 1, b, a + 1, b + 1, b}) part.indices.push_back(i);
        }
    }
    out.full.parts = {part};
    const std::uint32_t last = n * (n + 1);
    out.coarse.parts = {{0, {0, n, last, n, last + n, last}}};
    out.coarse.triangles = 2;
    return out;
}

float shift(const Plate& p, Picture picture = Picture::repeats) { return PictureReference(p.full, {picture}).shift_m(p.coarse); }

TEST(PictureShift, IsNoneWhereThePictureLiesStraight) {
    EXPECT_NEAR(shift(plate([](vec2 t) { return t; })), 0, 1e-5);
    EXPECT_NEAR(shift(plate([](vec2 t) { return vec2(3 * t.x + t.y, 2 - t.y); })), 0, 1e-5);
}

TEST(PictureShift, IsTheDistanceByWhichAPictureIsMoved) {
    // Squeezed to the left: at x = 1/2 of the plate, 1/4 of the picture has passed; at the quantile, about 0.4 m of 2.
    const float squeezed = shift(plate([](vec2 t) { return vec2(t.x * t.x, t.y); }));
    EXPECT_GT(squeezed, 0.2F);
    EXPECT_LT(squeezed, 1.0F);
}

TEST(PictureShift, IsOfTexturedPartsOnly) {
    EXPECT_EQ(shift(plate([](vec2 t) { return vec2(t.x * t.x, t.y); }), Picture::none), 0);
}

TEST(PictureShift, CountsAWholeRepeatAsNone) {
    // Every square has the whole picture; the coarse plate has it eight times, which is the same.
    EXPECT_NEAR(shift(plate([](vec2 t) { return 8.0F * t; })), 0, 1e-4);
}

TEST(PictureShift, IsAWholePictureWhereOneThatIsClampedLiesOneFurther) {
    Plate p = plate([](vec2 t) { return t; });
    for (std::uint32_t& index : p.coarse.parts[0].indices) {  // the same corners, one picture further
        model::Vertex v = p.full.vertices[index];
        v.uv[0] += 1;
        index = static_cast<std::uint32_t>(p.full.vertices.size());
        p.full.vertices.push_back(v);
    }
    EXPECT_NEAR(shift(p, Picture::repeats), 0, 1e-5);
    EXPECT_NEAR(shift(p, Picture::clamped), 2, 1e-4);  // metres: the plate's width
}

TEST(PictureShift, ALevelThatSqueezesItsPictureShowsColoursInstead) {
    for (const bool squeezed : {false, true}) {
        Geometry g = plate([&](vec2 t) { return vec2(squeezed ? t.x * t.x : t.x, t.y); }).full;
        for (std::size_t i = 0; i < g.vertices.size(); ++i) {
            g.vertices[i].position[2] = 0.02F * static_cast<float>(i % 3);  // else the first level is exact
            g.baked.push_back({10, 20, 30, 255});
        }
        const double diagonal_m = g.box().diagonal();
        ChainOptions options;
        options.pictures = {Picture::clamped, Picture::none};
        options.proxy_material = 1;
        options.proxy_below = 0;
        options.smallest = 2;
        const LodChain chain = make_chain(g, options);
        ASSERT_GE(chain.levels.size(), 3U);
        const PictureReference pictures(chain.full, options.pictures);
        std::size_t coloured = 0;
        for (const Level& level : chain.levels) {
            EXPECT_GE(level.error_m, pictures.shift_m(level) - 1e-6F) << "of those that kept it";
            if (level.parts[0].material != 1) continue;
            ++coloured;
            EXPECT_GE(level.error_m, 0.999 * diagonal_m / 4);
            EXPECT_EQ(chain.full.vertices[level.parts[0].indices[0]].colour[1], 20);
        }
        EXPECT_EQ(coloured > 0, squeezed);
        EXPECT_EQ(chain.levels.back().parts[0].material, 0U) << "never the full detail";
    }
}

TEST(PictureShift, IsFiniteForPicturesWithoutExtentAndForNothing) {
    EXPECT_EQ(shift(plate([](vec2) { return vec2(0.5F); })), 0);
    EXPECT_EQ(PictureReference({}, {Picture::repeats}).shift_m({}), 0);
    const float wild = shift(plate([](vec2 t) { return vec2(1e30F * t.x * t.x, t.y); }));
    EXPECT_TRUE(std::isfinite(wild));
}

}  // namespace
}  // namespace surefoot::bake
