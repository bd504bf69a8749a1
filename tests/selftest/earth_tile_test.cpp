// A real terrain tile in Earth-centred coordinates (SUREFOOT_DATA): its picture is that of the same tile at the origin.
#include <gtest/gtest.h>

#include <cstdlib>

#include "render/bake/bake.hpp"
#include "render/import/scene.hpp"
#include "render/measure/image_metrics.hpp"
#include "tools/selftest/hard.hpp"
#include "tools/selftest/picture.hpp"
#include "tools/selftest/shapes.hpp"

namespace surefoot::selftest {
namespace {

TEST(EarthTile, LooksAsAtTheOrigin) {
    const char* data = std::getenv("SUREFOOT_DATA");
    if (data == nullptr) GTEST_SKIP() << "SUREFOOT_DATA is not set";
    const auto scene =
        importer::import_files({std::string(data) + "/hard/obj-gltf-misc/huge_coordinates_ecef_tile_2582128.glb"}, {});
    if (!scene) GTEST_SKIP() << scene.error().text();
    const auto there = bake::bake(*scene, {}, {});
    ASSERT_TRUE(there) << there.error().text();
    EXPECT_EQ(there->triangles(), scene->triangles());
    const Box tile = there->nodes[0].box;
    EXPECT_GT(glm::length(tile.centre()), 6e6) << "this is no Earth-centred tile";
    for (const model::Vertex& v : there->vertices)
        ASSERT_LT(glm::length(vec3(v.position[0], v.position[1], v.position[2])), tile.diagonal());

    Outcome outcome;
    constexpr model::Viewport view{320, 240};
    const auto device = open_picture(view, {}, outcome);
    if (!device) GTEST_SKIP() << outcome.not_run;
    // From above the ground, which is whatever points away from the Earth's centre, obliquely down onto the tile's middle.
    const dvec3 up = glm::normalize(tile.centre()), aside = glm::normalize(glm::cross(up, dvec3(0.3, 0.2, 1)));
    const auto picture = [&](const model::Model& model, const dvec3& centre) {
        Pose pose;
        pose.position = centre + (0.2 * up + 0.3 * aside) * tile.diagonal();
        pose.orientation = glm::quatLookAt(glm::normalize(centre - pose.position), up);
        EXPECT_TRUE(load(*device, model, outcome));
        return draw(*device, finest_of(model), pose);
    };
    const gl::PixelImage a = picture(*there, tile.centre());
    const gl::PixelImage b = picture(moved_model(*there, -tile.centre()), dvec3(0));
    ASSERT_FALSE(a.rgba.empty());
    EXPECT_GE(measure::share_within(a.rgba, b.rgba, 1), 0.999);
    std::size_t drawn = 0;
    for (std::uint32_t y = 0; y < a.height; ++y)
        for (std::uint32_t x = 0; x < a.width; ++x) drawn += is_colour(a, x, y, {0, 0, 255}) ? 0U : 1U;
    EXPECT_GT(drawn, a.width * a.height / 4) << "the tile is not in the picture";
}

}  // namespace
}  // namespace surefoot::selftest
