// Walks that spend triangles in place of time: their costs, their pictures, and how much of the budget they draw.
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "rt/base/file.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/text_pieces.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/accuracy/compare.hpp"

namespace surefoot::accuracy {
namespace {

constexpr double infinite_snr = std::numeric_limits<double>::infinity();

TEST(TriangleBudget, IsSpentOnWhatThePoseSees) {
    constexpr double budget = 600, filled = 0.95;
    const auto walk_by = [&](const std::string& selector) {
        walk::WalkRequest request = test::Forest::get().virtual_request(20);
        spend_triangles(request);
        request.selector = selector;
        request.rate_hz = 1.5;  // far apart: what a walk prepares for the way between is no part of a still
        request.budget_ms = triangle_budget_ms(budget);
        return test::walk(request);
    };
    const walk::WalkOutcome full = walk_by("flat"), within = walk_by("curve-budget");
    ASSERT_EQ(full.records.size(), within.records.size());
    std::uint32_t limited = 0;
    for (std::size_t i = 0; i < within.records.size(); ++i) {
        const auto wanted = static_cast<double>(full.records[i].triangles),
                   drawn = static_cast<double>(within.records[i].triangles);
        EXPECT_LE(drawn, budget) << i;
        if (wanted <= budget) continue;
        ++limited;
        EXPECT_GE(drawn, filled * budget) << i << ": full detail has " << wanted;
    }
    EXPECT_GT(limited, 10U);
}

TEST(TriangleBudget, CostsAreTrianglesExactly) {
    const model::CostModel costs = triangle_costs();
    for (const float triangles : {1.0F, 2.0F, 12.0F, 199.0F, 200.0F, 5804.0F, 1e6F})
        for (const float pixels : {0.0F, 1.0F, 9e5F}) {
            const model::ItemCost cost = costs.item(triangles, pixels, costs.grids[0]);
            EXPECT_EQ(cost.submit_us, triangles);
            EXPECT_EQ(cost.raster_us, 0);
        }
    EXPECT_EQ(costs.combine.frame_us(200, 0), 200);
    EXPECT_GT(triangle_budget_ms(200) * 1e3, 200);
    EXPECT_LT(triangle_budget_ms(200) * 1e3, 201);
}

TEST(TriangleBudget, ThePageHoldsEveryPicture) {
    const test::TemporaryFolder folder;
    Comparison c;
    c.model = "m.walk";
    c.rate_hz = 10;
    c.in_triangles = true;
    c.budget_ms = triangle_budget_ms(200);
    c.selectors.push_back({});
    c.selectors[0].selector = "threshold";
    c.selectors[0].pictures = {{0, 190, 400, 20, 11.5, 3, 0.9, 0.1},
                               {1, 180, 180, std::numeric_limits<float>::infinity(), infinite_snr, 0, 1, 0}};
    ASSERT_TRUE(write_compare_page(folder / "page", c).ok());
    std::ifstream csv(folder / "page/pictures.csv");
    std::stringstream text;
    text << csv.rdbuf();
    EXPECT_NE(text.str().find("\"threshold\",0,190,400,20.0000,11.5000"), std::string::npos) << text.str();
    EXPECT_NE(text.str().find("\"threshold\",1,180,180,inf,inf"), std::string::npos) << text.str();
    const std::string charts = *read_text(folder / "page/pictures.svg");
    for (const char* part : {"xmlns=", "threshold: Triangles<", "threshold: SNR, dB<"})
        EXPECT_NE(charts.find(part), std::string::npos) << part;
    EXPECT_EQ(test::count_of(charts, "<svg"), 4U) << "three charts in one";
    EXPECT_EQ(test::count_of(charts, "</svg>"), 4U);
    EXPECT_NE(compare_table(c).find("180 to 190 triangles a picture, SNR 11.5 to 11.5 dB"), std::string::npos)
        << compare_table(c);
    EXPECT_EQ(nlohmann::json::parse(compare_json(c))["budget_triangles"], 200);
    c.selectors[0].pictures.erase(c.selectors[0].pictures.begin());
    EXPECT_NE(compare_table(c).find("all equal to full detail"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::accuracy
