// What the eye tells apart limits what is prepared; the field of view may change; levels follow the direction of the pose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>

#include "render/prepare/prepared.hpp"
#include "tests/prepare/random_model.hpp"

namespace surefoot::prepare {
namespace {

constexpr double seen_arcmin = std::numbers::pi / 180 / 60;
const model::CostModel seen_costs = model::default_costs();

PreparedFrame seen_from(const model::Model& m, const Pose& pose, double acuity_rad, float resolution = 1, double focus = 0.5,
                        model::Viewport viewport = {}, double acuity_fov_y_rad = 0) {
    PrepareOptions options;
    options.acuity_rad = acuity_rad;
    options.acuity_fov_y_rad = acuity_fov_y_rad;
    options.focus_strength = focus;
    options.max_visits = 0;
    Preparer preparer(m, seen_costs, options);
    PreparedFrame frame;
    preparer.reserve(frame);
    frame.resolution = resolution;
    preparer.run({pose, 0.1, 0.05}, viewport, 0, 1.0, 0.1, frame);
    return frame;
}

Pose before_the_town(double fov_y_deg) {
    Pose pose;
    pose.position = {0, 20, 600};
    pose.fov_y_rad = fov_y_deg * std::numbers::pi / 180;
    return pose;
}

TEST(Acuity, BelowAnEighthOfAPixelChangesNothingAtAll) {
    const model::Model m = test::town(5);
    const Pose pose = before_the_town(60);  // a pixel is 5.5 arcminutes
    const PreparedFrame without = seen_from(m, pose, 0), with = seen_from(m, pose, 0.6 * seen_arcmin);
    EXPECT_EQ(with.target_error_rad, without.target_error_rad);
    EXPECT_EQ(with.visits, without.visits);
    ASSERT_EQ(with.choices.size(), without.choices.size());
    EXPECT_EQ(std::memcmp(with.choices.data(), without.choices.data(), with.choices.size() * sizeof(Choice)), 0);
}

TEST(Acuity, AboveAPixelLimitsTheErrorsThatAreOffered) {
    const model::Model m = test::town(5);
    const Pose pose = before_the_town(5.4);  // 10 cm at 60 cm and 1280 pixels: a pixel is 0.45 arcminutes
    const PreparedFrame without = seen_from(m, pose, 0), with = seen_from(m, pose, seen_arcmin);
    const double pixel_rad = model::pixel_angle(pose, without.viewport);
    ASSERT_LT(pixel_rad, 0.5 * seen_arcmin);
    EXPECT_NEAR(without.target_error_rad, 0.125 * pixel_rad, 1e-9);
    EXPECT_NEAR(with.target_error_rad, seen_arcmin, 1e-9);
    EXPECT_NEAR(resolved_rad(without), pixel_rad, 1e-12);
    EXPECT_NEAR(resolved_rad(with), seen_arcmin, 1e-12);
    EXPECT_LT(with.choices[0].benefit, 0.95F * without.choices[0].benefit) << "the same error is less of what shows";
    EXPECT_LT(with.full_cost.raster_us + with.full_cost.submit_us, without.full_cost.raster_us + without.full_cost.submit_us);
    // Of drawn pixels: at half the resolution an eighth of one is still below the acuity.
    EXPECT_NEAR(seen_from(m, pose, seen_arcmin, 0.5F).target_error_rad, seen_arcmin, 1e-9);
    EXPECT_NEAR(seen_from(m, pose, 0, 0.5F).target_error_rad, 0.25 * pixel_rad, 1e-9);
}

TEST(Acuity, IsAsMuchFinerAsThePictureIsMagnified) {
    const model::Model m = test::town(3);
    const Pose seat = before_the_town(60);
    Pose zoomed = seat;
    zoomed.fov_y_rad = 2 * std::atan(std::tan(seat.fov_y_rad / 2) / 4);
    const auto acuity_at = [&](const Pose& pose) {
        return seen_from(m, pose, seen_arcmin, 1, 0.5, {}, seat.fov_y_rad).acuity_rad;
    };
    EXPECT_EQ(acuity_at(seat), seen_arcmin);
    EXPECT_NEAR(acuity_at(zoomed), seen_arcmin / 4, 1e-15);
    EXPECT_EQ(seen_from(m, zoomed, seen_arcmin).acuity_rad, seen_arcmin) << "of a picture whose field of view is not known";
}

TEST(Acuity, ThatIsNoAngleCountsAsNone) {
    const model::Model m = test::town(3);
    for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        EXPECT_EQ(seen_from(m, before_the_town(5.4), bad).acuity_rad, 0) << bad;
}

/// Two equal objects, 25 degrees to the left and to the right.
model::Model two_objects() {
    Random random(1);
    model::Model m;
    m.placements.emplace_back();
    m.nodes.resize(3);
    m.nodes[0].box = {dvec3(-12, -1, -21), dvec3(12, 1, -19)};
    m.nodes[0].child_count = 2;
    m.nodes[0].first_child = 1;
    m.nodes[1].box = {dvec3(-10, -1, -21), dvec3(-8, 1, -19)};
    m.nodes[2].box = {dvec3(8, -1, -21), dvec3(10, 1, -19)};
    for (model::Node& node : m.nodes) {
        if (&node != m.nodes.data()) node.parent = 0;
        test::add_reps(m, node, random, 1, 0.5, 600);
    }
    return m;
}

/// How much more the left one is worth than the right one because of the direction.
double left_by_focus(double yaw_rad, model::Viewport viewport) {
    static const model::Model m = two_objects();
    Pose pose;
    pose.orientation = glm::angleAxis(yaw_rad, dvec3(0, 1, 0));
    const auto ratio = [&](double strength) {
        const PreparedFrame frame = seen_from(m, pose, 0, 1, strength, viewport);
        std::map<Index, double> value;
        for (const Candidate& c : frame.candidates)
            value[c.node] = static_cast<double>(frame.choices[c.first_choice + c.choice_count - 1].value);
        return value[1] / value[2];
    };
    return ratio(0.5) / ratio(0.0);
}

TEST(Focus, FollowsTheDirectionOfThePoseAndOffAxisTheMiddleOfThePicture) {
    EXPECT_GT(left_by_focus(0.2, {}), 1.01) << "looks to the left";
    EXPECT_LT(left_by_focus(-0.2, {}), 0.99) << "looks to the right";
    EXPECT_NEAR(left_by_focus(0, {}), 1, 0.01);
    EXPECT_LT(left_by_focus(0, {1280, 720, 0.4, 0}), 0.99) << "the screen lies to the right";
}

}  // namespace
}  // namespace surefoot::prepare
