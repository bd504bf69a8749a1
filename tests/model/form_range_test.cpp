// Ranges of forms: no eye is in one wrongly, and levels are chosen as the published fragment says.
#include "render/model/form_range.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <sstream>
#include <string>

#include "tests/random_direction.hpp"

namespace surefoot::model {
namespace {

/// The legality of a choice and its error, from the box itself: shares nothing with ranges.
bool valid_from_eye(const Node& node, const Representation& rep, const dvec3& eye, double max_error_rad) {
    dvec3 away(0);
    for (int axis = 0; axis < 3; ++axis)
        away[axis] =
            eye[axis] < node.box.min[axis] ? node.box.min[axis] - eye[axis] : std::max(0.0, eye[axis] - node.box.max[axis]);
    const double distance = std::sqrt(away.x * away.x + away.y * away.y + away.z * away.z);
    if (!rep.everywhere && !(distance > 0)) return false;
    return distance >= static_cast<double>(rep.min_distance_m) &&
           static_cast<double>(rep.error_m) <= max_error_rad * std::max(distance, 0.05) * (1 + 1e-6);
}

Node any_node(Random& random) {
    Node node;
    const dvec3 half = any_in(random, dvec3(0.01), dvec3(1)) * std::exp(random.range(-2, 4));
    const dvec3 at = test::any_direction(random) * std::exp(random.range(-2, 9));
    node.box = {at - half, at + half};
    return node;
}

Representation any_form(Random& random) {
    Representation rep;
    rep.everywhere = random.below(2) == 0;
    rep.error_m = random.below(5) == 0 ? 0.0F : static_cast<float>(std::exp(random.range(-9, 1)));
    if (!rep.everywhere && random.below(4) > 0) rep.min_distance_m = static_cast<float>(random.range(0, 30));
    return rep;
}

void expect_no_eye_wrongly_inside(int eyes) {
    Random random(5);
    int inside = 0, valid = 0;
    for (int tried = 0; tried < eyes;) {
        const Node node = any_node(random);
        const Representation rep = any_form(random);
        const double max_error_rad = std::exp(random.range(-9, 0));
        const ConicRange range = form_range(node, rep, max_error_rad);
        ASSERT_FALSE(range.empty()) << "far enough away every form is valid";
        const double at_m = std::max(range.min_m, 0.3 * node.box.diagonal());
        for (int i = 0; i < 20; ++i, ++tried) {
            const double m = i % 2 == 0 ? at_m * random.range(0.999, 1.001) : at_m * random.range(0, 3);
            const dvec3 eye = range.centre + test::any_direction(random) * m;
            const bool is_valid = valid_from_eye(node, rep, eye, max_error_rad);
            valid += is_valid ? 1 : 0;
            if (!contains(range, eye)) continue;
            ++inside;
            ASSERT_TRUE(is_valid) << "wrongly inside";
            ASSERT_TRUE(legal(rep, static_cast<float>(node.box.distance(eye))));
        }
        const double far_m = 0.5 * node.box.diagonal() + valid_from_m(rep, max_error_rad);
        EXPECT_LE(range.min_m, far_m * (1 + 1e-6) + 1e-6) << "no more is left out than the sphere round the box";
    }
    EXPECT_GT(inside, eyes / 3);
    EXPECT_LT(inside, valid) << "a sphere leaves out what is beside a face";
    EXPECT_LT(valid, eyes);
}

TEST(FormRanges, HoldNoEyeOfAMillionWrongly) { expect_no_eye_wrongly_inside(1'000'000); }

TEST(FormRanges, TheirEdgesAreWhereTheySay) {
    Node node;
    node.box = {dvec3(-1, -2, -2), dvec3(1, 2, 2)};  // three from its middle to a corner
    Representation rep;
    rep.error_m = 0.5F;
    EXPECT_EQ(form_range(node, rep).min_m, 0) << "legal everywhere, inside too";
    EXPECT_NEAR(form_range(node, rep, 0.01).min_m, 3 + 50, 1e-6);
    EXPECT_TRUE(form_range(node, rep, 0).empty()) << "it is never exact";
    EXPECT_EQ(form_range(node, rep, 10).min_m, 0) << "as much as the error seen from the near plane";
    rep.everywhere = false;
    EXPECT_NEAR(form_range(node, rep, 10).min_m, 3, 1e-6);
    EXPECT_FALSE(contains(form_range(node, rep, 10), node.box.max)) << "on the box is not outside of it";
    rep.min_distance_m = 60;
    EXPECT_NEAR(form_range(node, rep, 0.01).min_m, 3 + 60, 1e-6);
    rep.error_m = 0;
    EXPECT_NEAR(form_range(node, rep, 0).min_m, 3 + 60, 1e-6);
    EXPECT_TRUE(form_range(Node{}, rep, 1).empty()) << "a node without a box has no distance";
}

/// Figure 10 of Pasman and Jansen 2002, as it is printed.
constexpr const char* figure_10 = R"(
LOD
{
  level
  [
    DEF MyCylinder Shape { geometry Cylinder {} }
    SimpleImposter { children [ USE MyCylinder ] }
    MeshedImposter { children [ USE MyCylinder ] }
  ]
  range [
    ConicRange{ },
    ConicRange { distance 10 1000 },
    ConicRange{ } ]
}
)";

/// The ranges of the fragment, in their order.
std::vector<ConicRange> ranges_of_figure_10() {
    std::vector<ConicRange> ranges;
    const std::string text = figure_10;
    for (std::size_t at = text.find("ConicRange"); at != std::string::npos; at = text.find("ConicRange", at + 1)) {
        ConicRange& range = ranges.emplace_back();
        const std::size_t open = text.find('{', at);
        std::istringstream fields(text.substr(open + 1, text.find('}', open) - open - 1));
        for (std::string field; fields >> field;)
            if (field == "distance") fields >> range.min_m >> range.max_m;
    }
    return ranges;
}

/// A cylinder with the levels of the fragment as forms of the model, within their ranges and a permitted error.
struct Cylinder {
    static constexpr std::array<std::uint32_t, 3> triangles{960, 12, 120};
    static constexpr std::array<float, 3> error_m{0, 0.3F, 0.02F};
    Model model;
    Cylinder() {
        Node& node = model.nodes.emplace_back();
        node.box = {dvec3(-1), dvec3(1)};
        node.rep_count = 3;
        for (std::size_t i = 0; i < 3; ++i) {
            Representation& rep = model.reps.emplace_back();
            rep.triangles = triangles[i];
            rep.error_m = error_m[i];
        }
    }
    [[nodiscard]] std::vector<RangedLevel> levels(double max_error_rad) const {
        std::vector<RangedLevel> levels = levels_of(model, 0, max_error_rad);
        const std::vector<ConicRange> ranges = ranges_of_figure_10();
        for (std::size_t i = 0; i < levels.size(); ++i) levels[i].range = intersection(levels[i].range, ranges[i], dvec3(0));
        return levels;
    }
};

// "A simple imposter will only be used if the distance to the viewer is larger than 10 and below 1000." Of what is valid and
// accurate enough, the level that takes least is drawn.
TEST(LevelsOfFigure10, AreChosenAsTheTextSaysFromHalfAMetreToTwoThousand) {
    const Cylinder cylinder;
    const double corner_m = std::sqrt(3.0);
    const dvec3 direction = glm::normalize(dvec3(1, 0.2, -0.4));
    for (const double max_error_rad : {100.0, 0.01, 0.001}) {
        const std::vector<RangedLevel> levels = cylinder.levels(max_error_rad);
        // Where the errors of 0.3 and 0.02 m are small enough, from the corners of the box.
        const double simple_m = max_error_rad > 1 ? 0 : corner_m + 0.3 / max_error_rad;
        const double meshed_m = max_error_rad > 1 ? 0 : corner_m + 0.02 / max_error_rad;
        std::array<int, 3> chosen{};
        for (double m = 0.5; m <= 2000; m *= 1.002) {
            std::size_t level = 0;
            if (m >= meshed_m) level = 2;
            if (m >= 10 && m <= 1000 && m >= simple_m) level = 1;
            ASSERT_EQ(cheapest_level(levels, direction * m), level) << m << " m, " << max_error_rad << " rad";
            ++chosen[level];
        }
        EXPECT_GT(chosen[1], 500);
        EXPECT_GT(chosen[2], 300);
        EXPECT_EQ(chosen[0] > 0, max_error_rad < 1) << "the cylinder itself is drawn only where no picture is good enough";
    }
}

TEST(LevelsOfFigure10, ChangeAtTheDistancesOfTheText) {
    const std::vector<RangedLevel> levels = Cylinder().levels(100);
    const std::vector<LevelFrom> along = levels_along(levels, dvec3(0), {1, 0, 0});
    ASSERT_EQ(along.size(), 3U);
    EXPECT_EQ(along[0].from_m, 0);
    EXPECT_EQ(along[1].from_m, 10);
    EXPECT_EQ(along[2].from_m, 1000);
    EXPECT_EQ(along[0].level, 2U);
    EXPECT_EQ(along[1].level, 1U);
    EXPECT_EQ(along[2].level, 2U);
    // Where a visitor may be anywhere within 5 m, no eye of these may be too near or too far.
    EXPECT_EQ(cheapest_level(levels, {14, 0, 0}, 5), 2U);
    EXPECT_EQ(cheapest_level(levels, {16, 0, 0}, 5), 1U);
    EXPECT_EQ(cheapest_level(levels, {996, 0, 0}, 5), 2U);
}

TEST(FormRanges, WhereNoLevelServesThereIsNone) {
    RangedLevel far;
    far.range.min_m = 5;
    const std::array levels{far};
    EXPECT_EQ(cheapest_level(levels, {1, 0, 0}), 1U);
    EXPECT_EQ(cheapest_level(levels, {6, 0, 0}), 0U);
    const auto along = levels_along(levels, dvec3(0), {0, 0, 1});
    ASSERT_EQ(along.size(), 2U);
    EXPECT_EQ(along[0].level, 1U);
    EXPECT_EQ(along[1].from_m, 5);
}

}  // namespace
}  // namespace surefoot::model
