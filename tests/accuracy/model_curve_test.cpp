// Curves of models: their parts, their line, and what `inspect --curve` prints.
#include "tools/accuracy/model_curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "rt/base/random.hpp"
#include "tests/prepare/random_model.hpp"

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

}  // namespace
}  // namespace surefoot::accuracy
