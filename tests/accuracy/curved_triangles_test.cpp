// Which triangles count as long and curved, where they stand.
#include "tools/accuracy/curved_triangles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

/// A square of this side, a quarter of whose normals is turned.
void add_turned_square(test::SmallModel& scene, model::Index material, float side_m, double degrees,
                       const mat3& linear = mat3(1)) {
    std::vector<model::Vertex> vertices;
    for (const auto& [x, y] : {std::pair{0.0F, 0.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}}) {
        model::Vertex v{};
        v.position[0] = side_m * x;
        v.position[1] = side_m * y;
        v.normal[2] = 127;
        vertices.push_back(v);
    }
    const double angle_rad = degrees * std::numbers::pi / 180;
    vertices[1].normal[0] = static_cast<std::int8_t>(std::lround(127 * std::sin(angle_rad)));
    vertices[1].normal[2] = static_cast<std::int8_t>(std::lround(127 * std::cos(angle_rad)));
    scene.object(vertices, {0, 1, 2, 0, 2, 3}, material, test::at(3, 2, 1, linear));
}

accuracy::CurvedTriangles found_in(test::SmallModel& scene) { return accuracy::curved_triangles(scene.finish()); }

TEST(CurvedTriangles, AreLongAndHaveNormalsThatDiffer) {
    test::SmallModel scene;
    const model::Index lit = scene.material(test::plain(1, 1, 1, 1, model::effect_sun));
    add_turned_square(scene, lit, 1, 30);     // one of its two triangles
    add_turned_square(scene, lit, 1, 10);     // nearly flat
    add_turned_square(scene, lit, 0.3F, 30);  // too small
    add_turned_square(scene, lit, 0.3F, 30, mat3(2.0F));
    const accuracy::CurvedTriangles found = found_in(scene);
    EXPECT_EQ(found.lit, 8U);
    EXPECT_EQ(found.curved, 2U);
    EXPECT_EQ(in_words(found), "of 8 triangles lit at the vertices, 2 are longer than 0.5 m with normals over 15 degrees apart");
}

TEST(CurvedTriangles, AreNoneOfWhatIsUnlitOrLitByThePixel) {
    test::SmallModel scene;
    add_turned_square(scene, scene.material(test::plain(1, 1, 1)), 1, 60);
    const auto by_pixel = model::effect_sun | model::effect_light_by_pixel;
    add_turned_square(scene, scene.material(test::plain(1, 1, 1, 1, by_pixel)), 1, 60);
    EXPECT_EQ(found_in(scene).lit, 0U);
    EXPECT_EQ(in_words(found_in(scene)), "");
    add_turned_square(scene, scene.material(test::plain(1, 1, 1, 1, model::effect_openness)), 1, 60);
    EXPECT_EQ(found_in(scene).curved, 1U);
}

}  // namespace
}  // namespace surefoot
