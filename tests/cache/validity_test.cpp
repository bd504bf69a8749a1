// Pictures of boxes displace no point by over a pixel: random boxes, eyes and movements, with every other rule exceeding it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/cache/displacement.hpp"

namespace surefoot::cache {
namespace {

constexpr double rounded_px = 1e-6;

/// Largest displacement over so many boxes, each seen by an eye that has gone as far as the rule lets it.
struct Worst {
    double px = 0;
    int trials = 0;  ///< boxes
};

/// corrected_far_plane: images stand at the far face, and the eye goes as far as the bound of the mean plane lets it.
enum class Rule { corrected, corrected_far_plane, published };

Worst worst_of(Rule rule, int wanted, std::uint64_t seed) {
    Random random(seed);
    Worst worst;
    while (worst.trials < wanted) {
        const Box box = any_box(random);
        const AnyView view(random);
        const auto picture = picture_of(box, dvec3(0));
        if (!picture) continue;
        const double max = view.pixels.smallest_rad;
        const dvec3 eye = last_eye(*picture, any_direction(random), [&](const dvec3& at) {
            if (rule == Rule::published) return published_valid(*picture, at, max);
            return picture_errors(*picture, at).total() <= max;
        });
        const double plane = rule == Rule::corrected_far_plane ? picture->far_m : picture->plane_m;
        ++worst.trials;
        for (int i = 0; i < 2; ++i) {
            const dvec3 point = any_point(random, box);
            const dvec3 image = image_on(*picture, picture->eye, point, plane);
            worst.px = std::max(worst.px, displacement_px(random, view, eye, point, image));
        }
    }
    return worst;
}

/// Of a picture that is combined from one of a box in it, made from another eye.
Worst worst_of_combined(int wanted, std::uint64_t seed, bool with_inherited) {
    Random random(seed);
    Worst worst;
    while (worst.trials < wanted) {
        const Box box = any_box(random);
        const AnyView view(random);
        Box part = box;
        for (int axis = 0; axis < 3; ++axis)
            (random.below(2) == 0 ? part.min : part.max)[axis] = 0.5 * (box.min[axis] + box.max[axis]);
        const auto child = picture_of(part, dvec3(0));
        if (!child) continue;
        const double max = view.pixels.smallest_rad, share = random.range(0.1, 1);
        const dvec3 between = last_eye(*child, any_direction(random),
                                       [&](const dvec3& at) { return picture_errors(*child, at).total() <= share * max; });
        auto parent = picture_of(box, between);
        if (!parent) continue;
        parent->inherited = inherited_error(picture_errors(*child, between).total(), parent->tangent);
        if (parent->inherited > max) continue;
        Picture tested = *parent;
        if (!with_inherited) tested.inherited = 0;
        const dvec3 eye =
            last_eye(tested, any_direction(random), [&](const dvec3& at) { return picture_errors(tested, at).total() <= max; });
        const dvec3 point = any_point(random, part);
        const dvec3 first = image_on(*child, child->eye, point, child->plane_m);
        worst.px =
            std::max(worst.px, displacement_px(random, view, eye, point, image_on(*parent, between, first, parent->plane_m)));
        ++worst.trials;
    }
    return worst;
}

void expect_a_pixel(int trials) {
    const Worst alone = worst_of(Rule::corrected, trials, 1);
    EXPECT_LE(alone.px, 1 + rounded_px);
    EXPECT_GT(alone.px, 0.9) << "the bound is far from what happens";
    const Worst combined = worst_of_combined(trials / 2, 2, true);
    EXPECT_LE(combined.px, 1 + rounded_px);
    EXPECT_GT(combined.px, 0.8);
}

TEST(Displacement, OfPointsInAHundredThousandBoxesIsWithinAPixel) { expect_a_pixel(100'000); }

TEST(DisplacementAtNight, OfPointsInAMillionBoxesIsWithinAPixel) { expect_a_pixel(1'000'000); }

TEST(Displacement, ExceedsAPixelByAnyOtherRule) {
    EXPECT_GT(worst_of(Rule::published, 20'000, 3).px, 1.5) << "each angle alone";
    EXPECT_GT(worst_of(Rule::corrected_far_plane, 20'000, 4).px, 1.5) << "images at the far face";
    EXPECT_GT(worst_of_combined(20'000, 5, false).px, 1.5) << "what children lack is forgotten";
}

TEST(Displacement, IsLeastWithThePlaneAtTheHarmonicMean) {
    Random random(6);
    for (int i = 0; i < 2000; ++i) {
        const Box box = any_box(random);
        const auto harmonic = picture_of(box, dvec3(0));
        if (!harmonic) continue;
        EXPECT_NEAR(harmonic->plane_m, 2 / (1 / harmonic->near_m + 1 / harmonic->far_m), 1e-9 * harmonic->far_m);
        const dvec3 eye = harmonic->right * 0.01;
        const double error = picture_errors(*harmonic, eye).translation;
        EXPECT_NEAR(error, 0.005 * (1 / harmonic->near_m - 1 / harmonic->far_m), 1e-12 + 1e-9 * error);
        for (const PlanePlace place : {PlanePlace::middle, PlanePlace::near_face, PlanePlace::far_face})
            EXPECT_GE(picture_errors(*picture_of(box, dvec3(0), place), eye).translation, error * (1 - 1e-9));
    }
}

TEST(Displacement, OfTheCorrectedRuleIsThatOfThePublishedOnesWhereTheyAreRight) {
    Random random(7);
    for (int i = 0; i < 2000; ++i) {
        const auto picture = picture_of(any_box(random), dvec3(0));
        if (!picture) continue;
        const double way = random.range(0, 0.5) * picture->near_m;
        const dvec3 aside = picture->eye + picture->up * way, ahead = picture->eye + picture->forward * way;
        EXPECT_NEAR(picture_errors(*picture, aside).total(), published_errors(*picture, aside).translation, 1e-9);
        const double approach = picture_errors(*picture, ahead).total();
        EXPECT_NEAR(approach, published_errors(*picture, ahead).approach, 1e-9 * (1 + approach));
    }
}

TEST(Validity, HoldsForEveryEyeOfItsRange) {
    Random random(8);
    int tried = 0, positive = 0;
    for (int i = 0; i < 3000; ++i) {
        auto picture = picture_of(any_box(random), any_in(random, dvec3(-1), dvec3(1)));
        if (!picture) continue;
        const double max = std::exp(random.range(-9, -4));
        picture->texels = static_cast<std::uint32_t>(1.3 * needed_texels(*picture, max)) + 1;
        picture->inherited = random.range(0, 1.1) * max;
        const model::ConicRange range = valid_range(*picture, max);
        EXPECT_EQ(range.empty(), picture->inherited > max);
        if (picture->inherited < 0.99 * max) {
            ++positive;
            EXPECT_GT(range.max_m, 0);
            // Nearly the largest one: no eye may be farther ahead and aside at once.
            const dvec3 beyond = picture->eye + 1.001 * range.max_m * (picture->forward + picture->right);
            EXPECT_FALSE(picture_errors(*picture, beyond).total() <= max && texel_rad(*picture, beyond) <= max);
        }
        for (int j = 0; j < 10 && !range.empty(); ++j, ++tried) {
            const dvec3 eye = picture->eye + any_direction(random) * range.max_m * (1 - 1e-9);
            EXPECT_TRUE(contains(range, eye));
            EXPECT_LE(picture_errors(*picture, eye).total(), max * (1 + 1e-9));
            EXPECT_LE(texel_rad(*picture, eye), max * (1 + 1e-9));
        }
    }
    EXPECT_GT(tried, 10'000);
    EXPECT_GT(positive, 1000);
}

TEST(Validity, TexelsAreNoLargerThanThePixelsAtTheCorner) {
    Random random(9);
    for (int i = 0; i < 2000; ++i) {
        const AnyView view(random);
        auto picture = picture_of(any_box(random), dvec3(0));
        if (!picture) continue;
        const double needed = needed_texels(*picture, view.pixels.smallest_rad);
        if (!(needed >= 20 && needed < 1e6)) continue;
        picture->texels = static_cast<std::uint32_t>(needed);
        EXPECT_LE(texel_rad(*picture, dvec3(0)), view.pixels.smallest_rad * (1 + 1e-9));
        EXPECT_GT(texel_rad(*picture, picture->forward * 0.5 * picture->near_m), view.pixels.smallest_rad * 1.1)
            << "seen from nearer";
    }
}

TEST(Validity, APixelAtTheCornerIsSmallerThanInTheMiddle) {
    const PixelAngles pixels = pixel_angles(Pose{}, {640, 480});
    const double tangent = std::tan(0.5 * Pose{}.fov_y_rad);
    EXPECT_NEAR(pixels.middle_rad, 2 * tangent / 480, 1e-8);
    EXPECT_NEAR(pixels.mean_rad, Pose{}.fov_y_rad / 480, 1e-12);
    const double corner = tangent * std::hypot(1, 640.0 / 480);
    EXPECT_NEAR(pixels.smallest_rad, pixels.middle_rad / (1 + corner * corner), 2e-6);
    EXPECT_LT(pixels.smallest_rad, pixels.mean_rad);
}

TEST(Validity, AnEyeInBehindOrOnTheBoxHasNoPicture) {
    const Box box{dvec3(-1), dvec3(1)};
    for (const dvec3& eye : {dvec3(0), dvec3(0.5), dvec3(1, 0, 0), dvec3(1.01, 0, 0), dvec3(1, 1, 1), dvec3(NAN, 0, 0)})
        EXPECT_FALSE(picture_of(box, eye)) << eye.x << " " << eye.y << " " << eye.z;
    EXPECT_FALSE(picture_of(Box{}, dvec3(0))) << "an empty box";
    const Box endless{dvec3(-1), dvec3(std::numeric_limits<double>::infinity())};
    EXPECT_FALSE(picture_of(endless, dvec3(-5))) << "a box without end";
    EXPECT_TRUE(picture_of(Box{dvec3(3), dvec3(3)}, dvec3(0))) << "a point";

    auto picture = picture_of(box, dvec3(0, 0, 5));
    ASSERT_TRUE(picture);
    picture->texels = 64;
    EXPECT_EQ(picture_errors(*picture, picture->eye).total(), 0);
    const dvec3 on_plane = picture->eye + picture->plane_m * picture->forward;
    for (const dvec3& eye : {on_plane, dvec3(0), dvec3(0, 0, 1), dvec3(0, 0, -5), dvec3(0, 0, NAN)}) {
        EXPECT_FALSE(picture_errors(*picture, eye).total() <= 1) << eye.z;
        EXPECT_FALSE(published_valid(*picture, eye, 1e-3)) << eye.z;
    }
    EXPECT_EQ(texel_rad(*picture, on_plane), std::numeric_limits<double>::infinity());
    EXPECT_FALSE(needed_texels(*picture, 0) <= 1e9) << "a pixel without size";
}

}  // namespace
}  // namespace surefoot::cache
