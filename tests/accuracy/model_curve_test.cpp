// Curves of models, and walks that spend triangles in place of time.
#include "tools/accuracy/model_curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "rt/base/random.hpp"
#include "tests/prepare/random_model.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/accuracy/compare.hpp"

namespace surefoot::accuracy {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr model::Resources in_triangles{0, 0, 1, 0};

/// By plain recursion: the fewest triangles of a cut of which no form has more error than this.
double fewest_triangles(const model::Model& m, model::Index n, double error_m) {
    const model::Node& node = m.nodes[n];
    double own = infinity, below = node.child_count > 0 ? 0 : infinity;
    for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
        const double error = model::is_full_detail(node, r, m.reps[r].error_m) ? 0.0 : double{m.reps[r].error_m};
        if (error <= error_m) own = std::min(own, double{static_cast<double>(m.reps[r].triangles)});
    }
    for (std::uint32_t c = 0; c < node.child_count; ++c) below += fewest_triangles(m, node.first_child + c, error_m);
    return std::min(own, below);
}

TEST(ModelCurve, PromisesNoMoreThanTheCheapestCutTakes) {
    int compared = 0, near = 0, exact = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        const model::Model m = test::random_model(seed, 40);
        const model::Curve curve = model::relative_curve(m, 0, in_triangles);
        ASSERT_TRUE(curve.known()) << seed;
        const double size_m = model::diameter_of(m.nodes[0]);
        Random random(seed);
        for (int i = 0; i < 40; ++i) {
            const double accuracy = std::exp(random.range(-1, 8));
            const double fewest = fewest_triangles(m, 0, size_m / accuracy * (1 - 1e-9)), takes = curve.at(accuracy).triangles;
            ASSERT_GE(takes, fewest * (1 - 1e-9)) << "seed " << seed << " at " << accuracy;
            ++compared;
            near += takes <= 1.5 * fewest ? 1 : 0;
        }
        if (!std::isinf(curve.end())) continue;  // something below has no size
        ++exact;
        EXPECT_GE(curve.at(infinity).triangles, fewest_triangles(m, 0, 0)) << "exact, seed " << seed;
        EXPECT_LE(curve.at(infinity).triangles, 1.2 * fewest_triangles(m, 0, 0)) << "exact, seed " << seed;
    }
    EXPECT_GT(near, compared * 3 / 4);
    EXPECT_GT(exact, 5);
}

TEST(ModelCurve, IsFoundByNameAndWritten) {
    const model::Model m = test::random_model(3, 30);
    const auto root = find_curve("m.walk", m, "");
    ASSERT_TRUE(root.ok());
    EXPECT_EQ(root->index, 0U);
    const auto json = nlohmann::json::parse(curve_json(*root));
    EXPECT_EQ(json["curve"].size(), root->curve.parts().size());
    EXPECT_EQ(json["forms"].size(), root->points.size());
    EXPECT_FALSE(curve_table(*root).empty());
    EXPECT_NE(curve_svg(*root).find("class=\"line\""), std::string::npos);
    const auto none = find_curve("m.walk", m, "no such name");
    ASSERT_FALSE(none.ok());
    EXPECT_EQ(none.error().kind, ErrorKind::misuse);
    EXPECT_NE(none.error().remedy.find("--tree"), std::string::npos);
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
                               {1, 180, 180, std::numeric_limits<float>::infinity(), infinity, 0, 1, 0}};
    ASSERT_TRUE(write_compare_page(folder / "page", c).ok());
    std::ifstream csv(folder / "page/pictures.csv");
    std::stringstream text;
    text << csv.rdbuf();
    EXPECT_NE(text.str().find("\"threshold\",0,190,400,20.0000,11.5000"), std::string::npos) << text.str();
    EXPECT_NE(text.str().find("\"threshold\",1,180,180,inf,inf"), std::string::npos) << text.str();
    EXPECT_NE(compare_table(c).find("180 to 190 triangles a picture, SNR 11.5 to 11.5 dB"), std::string::npos)
        << compare_table(c);
    EXPECT_EQ(nlohmann::json::parse(compare_json(c))["budget_triangles"], 200);
    c.selectors[0].pictures.erase(c.selectors[0].pictures.begin());
    EXPECT_NE(compare_table(c).find("all equal to full detail"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::accuracy
