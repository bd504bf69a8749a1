// What hides what: sheets by hand, each case one that a visitor would notice.
#include <gtest/gtest.h>

#include <cmath>

#include "render/prepare/occlusion.hpp"
#include "render/prepare/prepared.hpp"
#include "rt/base/random.hpp"
#include "tests/select/count_malloc.hpp"

namespace surefoot {
namespace {

using prepare::Occlusion;
using prepare::Region;

struct Sheet {
    std::vector<dvec3> corners;  ///< counter-clockwise, seen from the side that shows; convex
    model::AlphaMode alpha = model::AlphaMode::opaque;
    bool two_sided = false;
};

/// Facing +z, the eye's side.
Sheet upright(double x0, double x1, double y0, double y1, double z) {
    return {{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}}};
}

/// A root, and a leaf a sheet.
model::Model model_of(const std::vector<Sheet>& sheets, const dmat3& linear = dmat3(1.0)) {
    model::Model m;
    m.placements.push_back({dvec3(0.0), mat3(linear)});
    m.nodes.resize(1 + sheets.size());
    m.nodes[0].first_child = 1;
    m.nodes[0].child_count = static_cast<std::uint32_t>(sheets.size());
    for (std::size_t s = 0; s < sheets.size(); ++s) {
        const Sheet& sheet = sheets[s];
        model::Material material;
        material.alpha = sheet.alpha;
        material.two_sided = sheet.two_sided;
        model::Part part;
        part.material = static_cast<model::Index>(m.materials.size());
        part.first_index = static_cast<std::uint32_t>(m.indices.size());
        part.first_vertex = static_cast<std::uint32_t>(m.vertices.size());
        part.vertex_count = static_cast<std::uint32_t>(sheet.corners.size());
        model::Node& node = m.nodes[1 + s];
        node.parent = 0;
        for (const dvec3& at : sheet.corners) {
            model::Vertex v{};
            for (int k = 0; k < 3; ++k) v.position[k] = static_cast<float>(at[k]);
            m.vertices.push_back(v);
            node.box.grow(linear * at);
        }
        for (std::uint32_t k = 1; k + 1 < part.vertex_count; ++k) m.indices.insert(m.indices.end(), {0, k, k + 1});
        part.index_count = static_cast<std::uint32_t>(m.indices.size()) - part.first_index;
        model::Representation rep;
        rep.first_part = static_cast<model::Index>(m.parts.size());
        rep.part_count = 1;
        rep.triangles = part.index_count / 3;
        node.first_rep = static_cast<model::Index>(m.reps.size());
        node.rep_count = 1;
        m.nodes[0].box.grow(node.box);
        m.materials.push_back(material);
        m.parts.push_back(part);
        m.reps.push_back(rep);
    }
    m.nodes[0].first_rep = 0;
    m.nodes[0].rep_count = 1;
    return m;
}

Box cube(const dvec3& centre, double half) { return {centre - dvec3(half), centre + dvec3(half)}; }

/// Seen from the origin, looking along -z.
bool hidden(const std::vector<Sheet>& sheets, const Box& box, double radius_m = 0, double angle_rad = 0,
            const dmat3& linear = dmat3(1.0)) {
    const model::Model m = model_of(sheets, linear);
    const prepare::Occluders occluders = prepare::find_occluders(m);
    Occlusion occlusion(occluders);
    Region region;
    region.radius_m = radius_m;
    region.angle_rad = angle_rad;
    occlusion.draw(region, {1280, 720});
    return occlusion.hides(box);
}

const Sheet wall = upright(-2, 2, -2, 2, -4);

TEST(Occlusion, AWallHidesWhatIsBehindIt) {
    EXPECT_TRUE(hidden({wall}, cube({0, 0, -8}, 1)));
    EXPECT_FALSE(hidden({upright(10, 12, -2, 2, -4)}, cube({0, 0, -8}, 1)));
}

TEST(Occlusion, NotWhatIsBeforeItOrReachesThroughOrBesideIt) {
    EXPECT_FALSE(hidden({wall}, cube({0, 0, -3}, 0.5)));
    EXPECT_FALSE(hidden({wall}, cube({0, 0, -4}, 0.5)));
    EXPECT_FALSE(hidden({wall}, cube({4, 0, -8}, 1)));  // the wall ends at 4 m there
    EXPECT_FALSE(hidden({wall}, cube({0, 0, -4.0001}, 0.0)));
}

TEST(Occlusion, AnEyeThatMovesSeesPastTheEdge) {
    const Box beside = cube({2.6, 0, -8}, 0.5);  // its far edge is seen at 3.1 / 7.5, the wall's at 2 / 4
    EXPECT_TRUE(hidden({wall}, beside));
    EXPECT_TRUE(hidden({wall}, beside, 0.05));
    EXPECT_FALSE(hidden({wall}, beside, 0.8));
}

TEST(Occlusion, AWallNearerThanTheEyeMayComeHidesNothing) {
    const Sheet near = upright(-2, 2, -2, 2, -0.5);
    EXPECT_TRUE(hidden({near}, cube({0, 0, -8}, 1), 0.2));
    EXPECT_FALSE(hidden({near}, cube({0, 0, -8}, 1), 0.5));
}

TEST(Occlusion, TheBackOfASheetShowsWhatIsBehindIt) {
    Sheet back = wall;
    std::reverse(back.corners.begin(), back.corners.end());
    EXPECT_FALSE(hidden({back}, cube({0, 0, -8}, 1)));
    back.two_sided = true;
    EXPECT_TRUE(hidden({back}, cube({0, 0, -8}, 1)));
}

TEST(Occlusion, AMirroredPlacementTurnsTheSideThatShows) {
    const dmat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
    EXPECT_TRUE(hidden({wall}, cube({0, 0, -8}, 1), 0, 0, mirror));  // drawn with the other winding: still its front
}

TEST(Occlusion, GlassAndFoliageHideNothing) {
    for (const auto alpha : {model::AlphaMode::mask, model::AlphaMode::blend}) {
        Sheet thin = wall;
        thin.alpha = alpha;
        EXPECT_FALSE(hidden({thin}, cube({0, 0, -8}, 1)));
    }
}

TEST(Occlusion, SheetsThatShareAnEdgeHideAcrossIt) {
    const Sheet left = upright(-2, 0, -2, 2, -4), right = upright(0, 2, -2, 2, -4);
    EXPECT_TRUE(hidden({left, right}, cube({0, 0, -8}, 1), 0.3));
    const Sheet apart = upright(0.01, 2, -2, 2, -4);  // a gap of a centimetre
    EXPECT_FALSE(hidden({left, apart}, cube({0, 0, -8}, 1), 0.3));
    EXPECT_FALSE(hidden({left, apart}, cube({0, 0, -8}, 1)));
}

TEST(Occlusion, ACornerBetweenTwoWallsIsClosedAnOpenOneIsNot) {
    const Sheet left{{{-3, -2, -2}, {0, -2, -5}, {0, 2, -5}, {-3, 2, -2}}},
        right{{{0, -2, -5}, {3, -2, -2}, {3, 2, -2}, {0, 2, -5}}};
    EXPECT_TRUE(hidden({left, right}, cube({0, 0, -9}, 1), 0.3));
    const Sheet farther{{{0, -2, -5.5}, {3, -2, -2.5}, {3, 2, -2.5}, {0, 2, -5.5}}};
    EXPECT_FALSE(hidden({left, farther}, cube({0, 0, -9}, 1), 0.3)) << "between the two one sees past the corner";
}

TEST(Occlusion, AFarSheetDoesNotFillAHoleInANearOne) {
    // Two halves with a slit, and a wall farther off behind the slit: what lies between is seen through it.
    const Sheet left = upright(-2, -0.2, -2, 2, -2), right = upright(0.2, 2, -2, 2, -2), far = upright(-3, 3, -3, 3, -10);
    EXPECT_FALSE(hidden({left, right, far}, cube({0, 0, -5}, 0.5)));
    EXPECT_TRUE(hidden({left, right, far}, cube({0, 0, -13}, 0.5)));
}

TEST(Occlusion, ABorderBehindTheShoulderIsRememberedWhenTheEyeMovesFar) {
    // A wall on the right that ends behind the eye, in planks: an eye 2 m to the right and back looks past its end.
    const dvec3 foot{2.115 * std::sin(1.9024), 0, -2.115 * std::cos(1.9024)}, end = foot + 14.0 * dvec3(0.326, 0, -0.946);
    std::vector<Sheet> planks;
    for (int i = -33; i < 33; ++i) {
        const dvec3 low(0, 0.3 * i, 0), high(0, 0.3 * (i + 1), 0);
        planks.push_back({{end + low, foot + low, foot + high, end + high}});
    }
    const Box far = cube({40 * std::sin(0.733), 0, -40 * std::cos(0.733)}, 0.1);
    EXPECT_TRUE(hidden(planks, far, 0.1, 0.06));
    EXPECT_FALSE(hidden(planks, far, 2.0, 0.06));
}

TEST(Occlusion, ALongBoxIsHiddenInParts) {
    // A ceiling overhead, and the floor above it: no one depth tells them apart.
    const Sheet ceiling{{{-30, 1, 5}, {-30, 1, -60}, {30, 1, -60}, {30, 1, 5}}};  // faces down
    const Box above{{-10, 1.7, -12}, {10, 2, 2}};
    EXPECT_TRUE(hidden({ceiling}, above, 0.3));
    EXPECT_FALSE(hidden({ceiling}, {{-10, 0.9, -12}, {10, 2, 2}}, 0.3));
}

TEST(Occlusion, ViewsThatAreTooWideAndNumbersThatAreNoneHideNothing) {
    const model::Model m = model_of({wall});
    const prepare::Occluders occluders = prepare::find_occluders(m);
    Occlusion occlusion(occluders);
    Region region;
    region.angle_rad = 1.5;
    occlusion.draw(region, {1280, 720});
    EXPECT_TRUE(occlusion.empty());
    region.angle_rad = 0;
    occlusion.draw(region, {1280, 720});
    EXPECT_FALSE(occlusion.empty());
    EXPECT_FALSE(occlusion.hides(Box{}));
    EXPECT_FALSE(occlusion.hides({dvec3(std::nan("")), dvec3(1)}));
    EXPECT_FALSE(occlusion.hides({dvec3(-1e300), dvec3(1e300)}));
}

model::Model many_sheets(double farthest_m) {
    Random random(5);
    std::vector<Sheet> sheets;
    for (int i = 0; i < 2000; ++i) {
        const double x = random.range(-20, 20), y = random.range(-20, 20), z = random.range(-farthest_m, -1);
        const double wide = random.range(0.5, 5), high = random.range(0.5, 5);
        sheets.push_back(upright(x, x + wide, y, y + high, z));
    }
    return model_of(sheets);
}

TEST(Occlusion, DrawingAndLookingAllocateNothing) {
    const model::Model m = many_sheets(30);
    const prepare::Occluders occluders = prepare::find_occluders(m);
    Occlusion occlusion(occluders);
    std::size_t hidden_boxes = 0;
    const std::uint64_t before = test::allocations();
    for (int i = 0; i < 20; ++i) {
        Region region;
        region.centre.position.x = 0.1 * i;
        region.radius_m = 0.02 * i;
        occlusion.draw(region, {1280, 720});
        for (const model::Node& node : m.nodes) hidden_boxes += occlusion.hides(node.box) ? 1 : 0;
    }
    EXPECT_EQ(test::allocations(), before);
    EXPECT_GT(hidden_boxes, 1000U);
}

/// Behind a wall along the line of sight a long box is hidden part by part: each has a depth of its own. Where rooms are a tree
/// of their own, boxes are taken apart further, as long as there is work left.
TEST(Occlusion, TheWorkOfAllBoxesIsBounded) {
    const model::Model m = model_of({{{{2, -3, -1}, {2, -3, -80}, {2, 3, -80}, {2, 3, -1}}, model::AlphaMode::opaque, true}});
    prepare::Occluders occluders = prepare::find_occluders(m);
    occluders.has_rooms = true;
    Occlusion occlusion(occluders);
    occlusion.draw({}, {1280, 720});
    constexpr std::uint32_t few = 100, many = 10'000'000;
    std::size_t hidden_by_many = 0, hidden_by_few = 0, hidden_by_usual = 0;
    std::uint32_t many_left = many, few_left = few, none_left = 0;
    for (int k = 0; k < 600; ++k) {
        const int row = k / 20;
        const Box box{{2.05 + 0.05 * (k % 20), -1, -10.0 - 2 * row}, {9, 1, -6}};
        hidden_by_many += occlusion.hides(box, many_left) ? 1 : 0;
        hidden_by_few += occlusion.hides(box, few_left) ? 1 : 0;
        hidden_by_usual += occlusion.hides(box, none_left) ? 1 : 0;
        ASSERT_LE(few_left, few);
        ASSERT_EQ(none_left, 0U);
    }
    EXPECT_GT(many - many_left, 2 * few) << "or there is nothing to bound";
    EXPECT_EQ(few_left, 0U) << "all of it is used";
    EXPECT_GE(hidden_by_many, hidden_by_few);
    EXPECT_GE(hidden_by_few, hidden_by_usual);
    EXPECT_GT(hidden_by_usual, 0U);
}

TEST(Occlusion, TheSameIsHiddenHoweverManyWorkersLook) {
    const model::Model m = many_sheets(60);
    const model::CostModel costs = model::default_costs();
    std::vector<model::Index> first;
    for (const int workers : {1, 2, 4}) {
        prepare::PrepareOptions options;
        options.workers = workers;
        options.full_depth = true;
        prepare::Preparer preparer(m, costs, options);
        prepare::PreparedFrame frame;
        preparer.reserve(frame);
        for (int i = 0; i < 3; ++i) preparer.run({{}, 0.2, 0.05}, {1280, 720}, 0, 1, 0, frame);
        EXPECT_GT(frame.hidden, 100U);
        std::vector<model::Index> kept;
        for (const prepare::Candidate& candidate : frame.candidates) kept.push_back(candidate.node);
        if (workers == 1) first = kept;
        EXPECT_EQ(kept, first) << workers << " workers";
    }
}

TEST(Occlusion, PreparingLeavesOutWhatIsHiddenAndCountsIt) {
    const model::Model m = model_of({wall, upright(-1, 1, -1, 1, -8), upright(3, 4, -1, 1, -8)});
    for (const bool on : {true, false}) {
        prepare::PrepareOptions options;
        options.occlusion = on;
        options.full_depth = true;
        const model::CostModel costs = model::default_costs();
        prepare::Preparer preparer(m, costs, options);
        prepare::PreparedFrame frame;
        preparer.reserve(frame);
        preparer.run({}, {1280, 720}, 0, 0, 0, frame);
        EXPECT_EQ(frame.hidden, on ? 1U : 0U);
        EXPECT_EQ(frame.candidates.size(), on ? 3U : 4U);
    }
}

TEST(Occlusion, WhatIsHiddenStillKeepsTheSkyFromWhatIsBeforeIt) {
    model::Model alone = model_of({wall, upright(-1, 1, -1, 1, 8)}), before = model_of({wall, upright(-3.2, 3.2, -3.2, 3.2, -8)});
    std::array<float, 2> wall_value{};
    for (model::Model* m : {&alone, &before}) {
        m->losses.assign(m->reps.size(), {});
        m->colours = {{0.1F, 0.1F, 0.1F}, 0.01F};
        const model::CostModel costs = model::default_costs();
        prepare::PrepareOptions options;
        options.full_depth = true;
        prepare::Preparer preparer(*m, costs, options);
        prepare::PreparedFrame frame;
        preparer.reserve(frame);
        preparer.run({}, {1280, 720}, 0, 0, 0, frame);
        EXPECT_EQ(frame.hidden, m == &before ? 1U : 0U);
        ASSERT_GE(frame.candidates.size(), 2U);
        const prepare::Candidate& of_wall = frame.candidates[1];
        wall_value[m == &before ? 1 : 0] = frame.choices[of_wall.first_choice + of_wall.choice_count - 1].value;
    }
    EXPECT_LT(wall_value[1], 0.6F * wall_value[0]) << "something is behind most of it";
    EXPECT_GT(wall_value[1], 0);
}

}  // namespace
}  // namespace surefoot
