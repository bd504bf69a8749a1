// The bake's small rasteriser against samples counted by hand.
#include "render/bake/form_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rt/base/random.hpp"
#include "tests/bake/squares.hpp"

namespace surefoot::bake {
namespace {

FormPicture picture_of(const model::Model& m, std::initializer_list<model::Index> reps, const Box& box = unit_box,
                       std::uint32_t pixels = 64) {
    FormPicture picture;
    picture.clear(view_of(box, front, dvec3(0), pixels));
    for (const model::Index r : reps) draw_form(m, m.reps[r], picture);
    return picture;
}

std::size_t covered(const FormPicture& picture) {
    return static_cast<std::size_t>(
        std::count_if(picture.samples.begin(), picture.samples.end(), [](const FormSample& s) { return s.covered(); }));
}

const FormSample& at(const FormPicture& picture, std::int64_t x, std::int64_t y) {
    return picture.samples.at(static_cast<std::size_t>((y - picture.view.low) * picture.view.width + x - picture.view.left));
}

TEST(FormView, APixelIsAPowerOfTwoAndARimIsLeft) {
    const FormView view = view_of(unit_box, front, dvec3(0), 64);
    EXPECT_EQ(view.exponent, -6) << "the outline is 1 m x 1 m";
    EXPECT_EQ(view.left, -4) << "64 / 2 pixels about the middle at 32, 1.1 times as many, and one";
    EXPECT_EQ(view.width, 73U);
    EXPECT_EQ(view_of(unit_box, front, dvec3(0), 40).exponent, -5) << "never more than the pixels that were asked for";
    EXPECT_EQ(view_of({dvec3(0), dvec3(2, 2, 1)}, front, dvec3(0), 64).exponent, -5);
}

TEST(FormView, OddBoxesHaveAnEmptyPicture) {
    for (const Box& box :
         {Box{}, Box{dvec3(1), dvec3(1)}, Box{dvec3(-1e300), dvec3(1e300)}, Box{dvec3(1e9), dvec3(1e9 + 1e-7)}}) {
        FormPicture picture;
        picture.clear(view_of(box, front, dvec3(0), 64));
        EXPECT_TRUE(picture.samples.empty());
        draw_form(squares({{}}), squares({{}}).reps[0], picture);
    }
}

/// Whether a sample of the picture lies in a triangle whose corners are in pixels, counter-clockwise.
bool holds(const std::array<vec2, 3>& t, const vec2& p) {
    const auto side = [](const vec2& a, const vec2& b) { return a.x * b.y - a.y * b.x; };
    const float area = side(t[1] - t[0], t[2] - t[0]), wa = side(t[2] - t[1], p - t[1]), wb = side(t[0] - t[2], p - t[2]);
    return wa >= 0 && wb >= 0 && area - wa - wb >= 0;
}

TEST(FormPicture, TrianglesOfAnySlantCoverTheSamplesInThem) {
    model::Model looks;
    looks.materials.emplace_back();
    looks.materials[0].two_sided = true;
    Random random(5);
    std::size_t drawn = 0;
    for (int i = 0; i < 3000; ++i) {
        // Small and large, beyond the picture too; every third has an edge that is nearly level.
        const float size = i % 2 == 0 ? 1.0F : 40.0F, level = std::ldexp(1.0F, -6 - i % 16);
        const auto anywhere = [&] { return size * (static_cast<float>(random.unit()) - 0.5F) + 0.5F; };
        std::array<vec2, 3> corners;
        for (vec2& corner : corners) corner.x = anywhere(), corner.y = anywhere();
        if (i % 3 == 0) corners[1].y = corners[0].y + level * (static_cast<float>(random.unit()) - 0.5F);
        Geometry g;
        g.parts.push_back({0, {0, 1, 2}});
        for (const vec2& corner : corners) {
            model::Vertex v{};
            v.position[0] = corner.x, v.position[1] = corner.y;
            g.vertices.push_back(v);
        }
        FormPicture picture;
        picture.clear(view_of(unit_box, front, dvec3(0), 64));
        draw_geometry(looks, g.vertices, g.parts, picture);
        const float px = std::ldexp(1.0F, -picture.view.exponent);
        for (vec2& corner : corners) corner = corner * px - vec2(picture.view.left, picture.view.low);
        const vec2 u = corners[1] - corners[0], v = corners[2] - corners[0];
        if (u.x * v.y - u.y * v.x < 0) std::swap(corners[1], corners[2]);
        for (std::uint32_t y = 0; y < picture.view.height; ++y) {
            for (std::uint32_t x = 0; x < picture.view.width; ++x) {
                const bool is = picture.samples[static_cast<std::size_t>(y) * picture.view.width + x].covered();
                ASSERT_EQ(is, holds(corners, vec2(x, y))) << i << ": " << x << ' ' << y;
                drawn += is ? 1 : 0;
            }
        }
    }
    EXPECT_GT(drawn, 100'000U);
}

TEST(FormPicture, ASquareCoversTheSamplesInItAndOnItsEdges) {
    const model::Model m = squares({{}});
    const FormPicture picture = picture_of(m, {0});
    EXPECT_EQ(covered(picture), 65U * 65U);
    EXPECT_TRUE(at(picture, 0, 0).covered());
    EXPECT_TRUE(at(picture, 64, 64).covered());
    EXPECT_FALSE(at(picture, 65, 64).covered());
    EXPECT_EQ(at(picture, 10, 10).rgb[0], (std::array<std::uint8_t, 3>{255, 0, 0}));
    EXPECT_EQ(at(picture, 10, 10).depth, 0);
}

TEST(FormPicture, TheNearerShowsWhateverTheOrder) {
    Square near;
    near.z = 0.5F, near.size = 0.5F, near.colour = {0, 1, 0, 1};
    const model::Model m = squares({{}, near});
    for (const auto& order : {std::initializer_list<model::Index>{0, 1}, {1, 0}}) {
        const FormPicture picture = picture_of(m, order);
        EXPECT_EQ(covered(picture), 65U * 65U);
        EXPECT_EQ(at(picture, 32, 32).rgb[0][1], 255);
        EXPECT_EQ(at(picture, 33, 32).rgb[0][1], 0);
    }
}

TEST(FormPicture, BackFacesShowWhereAMaterialHasTwoSides) {
    const Direction back = direction_of(3.14159265358979, 0);
    for (const bool two_sided : {false, true}) {
        for (const bool mirrored : {false, true}) {
            Square square;
            square.two_sided = two_sided;
            model::Model m = squares({square});
            if (mirrored) m.placements[0].linear[2][2] = -1;  // of a square at z = 0: its front turns round
            FormPicture seen, behind;
            seen.clear(view_of(unit_box, front, dvec3(0), 64));
            behind.clear(view_of(unit_box, back, dvec3(0), 64));
            draw_form(m, m.reps[0], seen);
            draw_form(m, m.reps[0], behind);
            EXPECT_EQ(covered(seen) > 0, two_sided || !mirrored);
            EXPECT_EQ(covered(behind) > 0, two_sided || mirrored);
        }
    }
}

TEST(FormPicture, BlendedSurfacesShowInAsManySamplesAsTheyAreOpaque) {
    Square glass;
    glass.alpha = model::AlphaMode::blend, glass.colour[3] = 0.25F;
    const FormPicture picture = picture_of(squares({glass}), {0});
    EXPECT_NEAR(static_cast<double>(covered(picture)), 0.25 * 65 * 65, 70);
}

TEST(FormPicture, WhatIsBelowTheCutoffIsCutOut) {
    Square fence;
    fence.alpha = model::AlphaMode::mask, fence.colour[3] = 0.4F;
    EXPECT_EQ(covered(picture_of(squares({fence}), {0})), 0U);
    fence.colour[3] = 0.6F;
    EXPECT_GT(covered(picture_of(squares({fence}), {0})), 0U);
}

TEST(FormPicture, TexturesBlurFromLevelToLevel) {
    Square square;
    square.textured = true;  // 64 x 64 texels in a board of black and white, grey from the first mip level on
    const FormPicture picture = picture_of(squares({square}), {0});
    const FormSample& sample = at(picture, 10, 10);
    EXPECT_TRUE(sample.rgb[0][0] == 0 || sample.rgb[0][0] == 255);
    EXPECT_TRUE(sample.rgb[1][0] == 0 || sample.rgb[1][0] == 255) << "a texel a pixel";
    EXPECT_EQ(sample.rgb[2][0], 128);
}

TEST(FormPicture, OfAChildMakesThatOfItsParent) {
    Square near;
    near.z = 0.25F, near.size = 0.3F, near.colour = {0, 0, 1, 1};
    const model::Model m = squares({{}, near});
    const Direction from = direction_of(0.3, 0.15);
    const Box parent{dvec3(-0.7, -0.2, -1), dvec3(3, 3, 1)};
    FormPicture child, made, drawn;
    child.clear(view_of(unit_box, from, parent.centre(), 64));
    made.clear(view_of(parent, from, parent.centre(), 64));
    drawn.clear(made.view);
    EXPECT_GT(made.view.exponent, child.view.exponent);
    for (const model::Representation& rep : m.reps) {
        draw_form(m, rep, child);
        draw_form(m, rep, drawn);
    }
    draw_picture(child, made);
    EXPECT_GT(covered(drawn), 200U);
    for (std::size_t i = 0; i < drawn.samples.size(); ++i) {
        EXPECT_EQ(made.samples[i].covered(), drawn.samples[i].covered()) << i;
        EXPECT_EQ(made.samples[i].rgb, drawn.samples[i].rgb) << i;
    }
    draw_picture(drawn, child);  // coarse to fine: refused
}

}  // namespace
}  // namespace surefoot::bake
