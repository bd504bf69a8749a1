// Which path a walk follows: the requested file, the one beside the model, the model's own, or the generated tour.
#include "tools/walk/path_source.hpp"

#include <gtest/gtest.h>

#include "rt/base/file.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot::walk {

namespace {

Path one_pose(const dvec3& at) {
    Path path;
    path.samples = {{0, {at}}};
    return path;
}

model::Model with_tour() {
    model::Model model;
    model.nodes.push_back({});
    model.nodes[0].box = {dvec3(-1), dvec3(1)};
    model.tour = one_pose({7, 1, 0});
    model.tour_kind = "through its free space";
    return model;
}

double first_x(const Result<ChosenPath>& chosen) { return chosen->path.samples.front().pose.position.x; }

}  // namespace

TEST(ChoosePath, PrefersTheRequestedFileThenTheOneBesideThenTheModelsOwn) {
    const test::TemporaryFolder folder;
    const std::string model_file = folder / "m.walk", beside = folder / "m.path.csv", other = folder / "o.csv";
    model::Model model = with_tour();
    auto chosen = choose_path("", model_file, model, 0.5);
    ASSERT_TRUE(chosen);
    EXPECT_EQ(chosen->source, "default path, through its free space");
    EXPECT_EQ(first_x(chosen), 7);
    EXPECT_EQ(chosen->path.samples[0].pose.position.y, 1.5) << "lifted";
    ASSERT_TRUE(write_path(beside, one_pose({8, 0, 0})));
    ASSERT_TRUE(write_path(other, one_pose({9, 0, 0})));
    chosen = choose_path("", model_file, model, 0);
    ASSERT_TRUE(chosen);
    EXPECT_EQ(chosen->source, beside);
    EXPECT_EQ(first_x(chosen), 8);
    chosen = choose_path(other, model_file, model, 0);
    ASSERT_TRUE(chosen);
    EXPECT_EQ(first_x(chosen), 9);
    EXPECT_FALSE(choose_path(folder / "absent.csv", model_file, model, 0));
}

TEST(ChoosePath, NoneAndAnOlderModelGetTheGeneratedTour) {
    const test::TemporaryFolder folder;
    const std::string model_file = folder / "m.walk";
    ASSERT_TRUE(write_path(folder / "m.path.csv", one_pose({8, 0, 0})));
    model::Model model = with_tour();
    EXPECT_EQ(choose_path("none", model_file, model, 0)->source, "generated tour") << "also beside a path's file";
    model.tour = {};
    EXPECT_EQ(choose_path("", folder / "older.walk", model, 0)->source, "generated tour");
}

}  // namespace surefoot::walk
