// The floor plan: walls cut at breast height, the path, its viewpoints, and its title.
#include "tools/report/floor_plan.hpp"

#include <gtest/gtest.h>

#include "tests/ground/grounds.hpp"

namespace surefoot::test {

namespace {

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
    return found;
}

Path along_x(double y) {
    Path path;
    path.samples = {{0, {{0, y, 0}}}, {10, {{4, y, 0}}}};
    return path;
}

model::Model hall() {
    Triangles t;
    add_floor(t, -4, 8, -4, 4, 0);
    add_wall(t, {6, -4}, {6, 4}, 0, 3);
    add_wall(t, {-2, -4}, {-2, 4}, 0, 0.5);  // lower than breast height
    model::Model model;
    model.ground = ground_of(t);
    model.nodes.push_back({});
    model.nodes[0].box = {dvec3(-4, 0, -4), dvec3(8, 3, 4)};
    return model;
}

}  // namespace

TEST(FloorPlan, CutsWallsAtBreastHeightAndShowsPathAndViewpoints) {
    const std::string plan = report::floor_plan_svg(hall(), along_x(1.7), "a < b & c");
    EXPECT_EQ(plan.find("<svg "), 0U);
    EXPECT_EQ(count(plan, "<circle "), 8U) << "viewpoints";
    EXPECT_NE(plan.find("a &lt; b &amp; c: 4 m in 10 s"), std::string::npos) << plan.substr(plan.size() - 200);
    // A picture 14 m wide by 1200 pixels: the high wall, of two triangles, at x = 6 m; the low one nowhere.
    const std::size_t walls = plan.find("stroke-width=\"1.3\"");
    ASSERT_NE(walls, std::string::npos);
    const std::size_t begins = plan.rfind("<path d=\"", walls);
    const std::string cut = plan.substr(begins, walls - begins);
    EXPECT_EQ(count(cut, "M"), 2U) << cut;
    EXPECT_EQ(count(cut, "M942.9 ") + count(cut, "L942.9 "), 4U) << cut;
}

TEST(FloorPlan, OfAPathThatFliesShowsOutlines) {
    const std::string plan = report::floor_plan_svg(hall(), along_x(30), "above");
    EXPECT_EQ(plan.find("stroke-width=\"1.3\""), std::string::npos);
    EXPECT_NE(plan.find("stroke-width=\"0.7\""), std::string::npos);
}

}  // namespace surefoot::test
