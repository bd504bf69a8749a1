// Triangles cut for baked light: the same surface, no cracks, not too many, and only where light changes.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "render/bake/refine.hpp"
#include "render/bake/stage.hpp"
#include "tests/bake/lit_scenes.hpp"

namespace surefoot {
namespace {

bake::RefinedMeshes refined(const importer::Scene& scene, const bake::ForAll& for_all = lit::one_by_one) {
    const auto rays = bake::make_light_rays(scene, {});
    const bake::RefineLight light{glm::normalize(dvec3(0.4, 0.8, 0.3)), {}, &rays->opaque, &rays->lamps};
    return bake::refine_for_light(scene, light, for_all, [] { return false; });
}

const importer::Mesh& shown(const importer::Scene& scene, const bake::RefinedMeshes& meshes, std::size_t m) {
    return meshes[m] ? *meshes[m] : scene.meshes[m];
}

double area_of(const importer::Primitive& p) {
    double sum = 0;
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
        const dvec3 a(p.positions[p.indices[i]]), b(p.positions[p.indices[i + 1]]), c(p.positions[p.indices[i + 2]]);
        sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return sum;
}

using Corners = std::array<dvec3, 3>;
std::vector<Corners> placed_triangles(const importer::Scene& scene, const bake::RefinedMeshes& meshes, bool without_posts) {
    std::vector<Corners> out;
    for (const importer::Node& node : scene.nodes) {
        if (without_posts && node.name == "post") continue;  // they stand on edges
        for (const importer::Primitive& p : shown(scene, meshes, node.mesh).primitives)
            for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
                Corners t;
                for (std::size_t k = 0; k < 3; ++k) t[k] = dvec3(node.world * dvec4(dvec3(p.positions[p.indices[i + k]]), 1.0));
                out.push_back(t);
            }
    }
    return out;
}

/// Corners that lie on an edge of another triangle, between its ends.
std::size_t cracks(const importer::Scene& scene, const bake::RefinedMeshes& meshes) {
    const auto less = [](const dvec3& a, const dvec3& b) {
        for (int c = 0; c < 3; ++c)
            if (std::abs(a[c] - b[c]) > 1e-4) return a[c] < b[c];
        return false;
    };
    std::set<dvec3, decltype(less)> corners(less);
    const std::vector<Corners> triangles = placed_triangles(scene, meshes, true);
    for (const Corners& t : triangles) corners.insert(t.begin(), t.end());
    std::size_t found = 0;
    for (const Corners& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const dvec3 a = t[k], way = t[(k + 1) % 3] - a;
            const double size = glm::length(way);
            for (const dvec3& p : corners) {
                const double at = glm::dot(p - a, way) / (size * size);
                if (at * size < 0.01 || (1 - at) * size < 0.01) continue;
                found += glm::length(a + at * way - p) < 1e-3 ? 1 : 0;
            }
        }
    return found;
}

/// A post on a floor of two triangles.
importer::Scene post_on_floor(float half_m = 20) {
    importer::Scene scene;
    lit::put(scene, lit::floor_of(half_m), "floor", dvec3(0));
    lit::put(scene, lit::post(1), "post", dvec3(0));
    return scene;
}

TEST(Refine, CutsWhereAShadowFallsAndKeepsTheSurface) {
    importer::Scene scene = post_on_floor();
    for (const vec2& uv : scene.meshes[0].primitives[0].uvs)
        scene.meshes[0].primitives[0].colours.push_back({static_cast<std::uint8_t>(255 * uv.x), 100, 0, 255});
    const bake::RefinedMeshes meshes = refined(scene);
    ASSERT_TRUE(meshes[0].has_value());
    EXPECT_FALSE(meshes[1].has_value()) << "the post's triangles are small";
    const importer::Primitive &was = scene.meshes[0].primitives[0], &is = meshes[0]->primitives[0];
    EXPECT_GT(is.indices.size() / 3, 200U);
    EXPECT_LE(is.indices.size() / 3, 20'002U);
    EXPECT_NEAR(area_of(is), area_of(was), 1e-6 * area_of(was));
    ASSERT_EQ(is.normals.size(), is.positions.size());
    ASSERT_EQ(is.uvs.size(), is.positions.size());
    ASSERT_EQ(is.colours.size(), is.positions.size());
    for (std::size_t v = 0; v < is.positions.size(); ++v) {
        EXPECT_EQ(is.positions[v].y, 0.0F);
        EXPECT_NEAR(glm::length(is.normals[v] - vec3(0, 1, 0)), 0, 1e-6);
        EXPECT_NEAR(is.uvs[v].x, is.positions[v].z / 40 + 0.5F, 1e-5);
        EXPECT_NEAR(is.uvs[v].y, is.positions[v].x / 40 + 0.5F, 1e-5);
        EXPECT_NEAR(is.colours[v][0], 255 * is.uvs[v].x, 4) << "rounded up at each cut";
        EXPECT_EQ(is.colours[v][1], 100);
    }
    double shortest = 1e9;
    for (std::size_t i = 0; i < is.indices.size(); ++i) {
        const std::uint32_t a = is.indices[i], b = is.indices[i % 3 == 2 ? i - 2 : i + 1];
        shortest = std::min(shortest, glm::length(dvec3(is.positions[a] - is.positions[b])));
    }
    EXPECT_GE(shortest, 0.49);
    EXPECT_LT(shortest, 1);
    EXPECT_EQ(cracks(scene, meshes), 0U);
    double nearest = 1e9;  // far from the post nothing is cut finely
    for (const vec3& at : is.positions) nearest = std::min(nearest, glm::length(dvec3(at) - dvec3(-15, 0, -15)));
    EXPECT_GT(nearest, 1);
}

TEST(Refine, CutsBentSurfacesOnTheirOldTriangles) {
    importer::Scene scene;
    importer::Primitive hills = bake::hills(5, 60);
    for (vec3& n : hills.normals) n = glm::normalize(vec3(0.3F, 1, -0.2F));
    lit::put(scene, std::move(hills), "hills", dvec3(0));
    for (int i = 0; i < 5; ++i) lit::put(scene, lit::post(0.5F, 12), "post", dvec3(8 + 10 * i, 0, 30));
    const bake::RefinedMeshes meshes = refined(scene);
    ASSERT_TRUE(meshes[0].has_value());
    const importer::Primitive &was = scene.meshes[0].primitives[0], &is = meshes[0]->primitives[0];
    EXPECT_NEAR(area_of(is), area_of(was), 1e-6 * area_of(was));
    EXPECT_EQ(cracks(scene, meshes), 0U);
    for (std::size_t v = 0; v < is.positions.size(); ++v) {
        const dvec3 at(is.positions[v]);
        double off = 1e9;
        for (std::size_t i = 0; i + 2 < was.indices.size(); i += 3) {
            const dvec3 a(was.positions[was.indices[i]]), b(was.positions[was.indices[i + 1]]),
                c(was.positions[was.indices[i + 2]]);
            const double all = (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x);  // no triangle is upright
            const double s = ((at.x - a.x) * (c.z - a.z) - (at.z - a.z) * (c.x - a.x)) / all;
            const double t = ((b.x - a.x) * (at.z - a.z) - (b.z - a.z) * (at.x - a.x)) / all;
            if (s > -1e-5 && t > -1e-5 && s + t < 1 + 1e-5)
                off = std::min(off, std::abs(a.y + s * (b.y - a.y) + t * (c.y - a.y) - at.y));
        }
        ASSERT_LT(off, 1e-4) << v;
    }
}

TEST(Refine, LeavesNoCracksBetweenTiles) {
    importer::Scene scene;
    lit::put(scene, lit::floor_of(10), "west", dvec3(0));
    lit::put(scene, lit::floor_of(10), "east", dvec3(0));
    scene.nodes[1].world = glm::rotate(dmat4(1.0), 1.5707963267948966, dvec3(0, 1, 0));  // its ends differ by rounding
    scene.nodes[0].world[3] = dvec4(0.1, 0.3, 0.7, 1);
    scene.nodes[1].world[3] = dvec4(20.1, 0.3, 0.7, 1);
    for (int i = 0; i < 4; ++i) lit::put(scene, lit::post(0.4F, 9), "post", dvec3(10.5 - 0.7 * i, 0.3, -8 + 5 * i));
    const bake::RefinedMeshes meshes = refined(scene);
    ASSERT_TRUE(meshes[0].has_value());
    ASSERT_TRUE(meshes[1].has_value());
    EXPECT_EQ(cracks(scene, meshes), 0U);
}

TEST(Refine, LeavesNoCracksWhereRoundingPartsCoordinates) {
    for (const double shift : {0.0, 1e-7, -1e-7}) {
        for (const double size : {6.25, 7.813, 8.125}) {  // their halves lie between millimetres
            importer::Scene scene;
            const auto half = static_cast<float>(size);
            lit::put(scene, lit::floor_of(half), "west", dvec3(-size, 0, 0));
            lit::put(scene, lit::floor_of(half), "east", dvec3(size + shift, shift, -shift));
            for (vec3& n : scene.meshes[1].primitives[0].normals) n = {0, -1, 0};  // it sees no light: the other decides
            for (int i = 0; i < 4; ++i) lit::put(scene, lit::post(0.7F, 5), "post", dvec3(i % 2 == 0 ? 1 : -1, 0, 3 * i - 5));
            const bake::RefinedMeshes meshes = refined(scene);
            ASSERT_TRUE(meshes[0].has_value());
            EXPECT_EQ(cracks(scene, meshes), 0U) << size << " " << shift;
        }
    }
}

TEST(Refine, PassesCutsOnAlongMeshesThatStandTwice) {
    // Tile i stands beside tile i - 1 once, and beside tile i + 1 in another place: one shadow cuts all of them.
    importer::Scene scene;
    constexpr std::size_t tiles = 7;
    for (std::size_t i = 0; i < tiles; ++i) {
        const double side = i % 2 == 0 ? -8 : 8;
        const importer::Index tile =
            lit::put(scene, lit::floor_of(8), "tile " + std::to_string(i), dvec3(side, 0, 100.0 * static_cast<double>(i)));
        bake::place(scene, tile, dvec3(side, 0, 100.0 * static_cast<double>(i + 1)));
    }
    lit::put(scene, lit::post(0.4F, 9), "post", dvec3(0.5, 0, 1));
    lit::put(scene, lit::post(0.4F, 9), "post", dvec3(-0.5, 0, -4));
    const bake::RefinedMeshes meshes = refined(scene);
    for (std::size_t i = 0; i < tiles; ++i) EXPECT_TRUE(meshes[i].has_value()) << i;
    EXPECT_EQ(cracks(scene, meshes), 0U);
}

TEST(Refine, LeavesNoCracksAlongAMeshOfTwoSizes) {
    importer::Scene scene;
    const importer::Index tile = lit::put(scene, lit::floor_of(2), "small and large", dvec3(-2, 0, 0));
    bake::place(scene, tile, dvec3(-108, 0, 0), dvec3(4));
    lit::put(scene, lit::floor_of(2), "beside the small", dvec3(2, 0, 0));
    lit::put(scene, lit::floor_of(8), "beside the large", dvec3(-92, 0, 0));
    lit::put(scene, lit::post(0.4F, 9), "post", dvec3(-100, 0, 1));
    lit::put(scene, lit::post(0.4F, 9), "post", dvec3(-101, 0, -3));
    const bake::RefinedMeshes meshes = refined(scene);
    ASSERT_TRUE(meshes[0].has_value());
    EXPECT_EQ(cracks(scene, meshes), 0U);
}

TEST(Refine, KeepsWithinAQuarterMoreTriangles) {
    importer::Scene scene;
    const importer::Index floor = lit::put(scene, lit::floor_of(60), "floor", dvec3(0));
    for (int i = 1; i < 4; ++i) bake::place(scene, floor, dvec3(1000 * i, 0, 0));
    importer::Primitive post = lit::post(0.3F, 8);
    const importer::Index mesh = bake::add_mesh(scene, std::move(post), "post");
    for (int x = 0; x < 10; ++x)
        for (int z = 0; z < 10; ++z) bake::place(scene, mesh, dvec3(-50 + 11 * x, 0, -50 + 11 * z));
    const std::uint64_t before = scene.triangles(), allowed = std::max<std::uint64_t>(before / 4, 20'000);
    const bake::RefinedMeshes meshes = refined(scene);
    ASSERT_TRUE(meshes[0].has_value());
    const std::uint64_t after = placed_triangles(scene, meshes, false).size();
    EXPECT_GT(after, before + 1000);
    EXPECT_LE(after, before + allowed) << "in all of the four places";
}

TEST(Refine, LeavesAloneWhatIsEvenlyLitSmallOrNotToBeCut) {
    importer::Scene plain;
    lit::put(plain, lit::floor_of(20), "floor", dvec3(0));
    EXPECT_FALSE(refined(plain)[0].has_value()) << "no shadow, no lamp";
    importer::Scene small = post_on_floor();
    small.meshes[0].primitives[0] = lit::floor_of(20, 60);
    EXPECT_FALSE(refined(small)[0].has_value()) << "edges below a metre";
    importer::Scene bare = post_on_floor();
    bare.meshes[0].primitives[0].normals.clear();
    EXPECT_FALSE(refined(bare)[0].has_value()) << "no normals";
    importer::Scene unlit = post_on_floor();
    unlit.materials[0].unlit = true;
    EXPECT_FALSE(refined(unlit)[0].has_value());
    for (const model::AlphaMode alpha : {model::AlphaMode::mask, model::AlphaMode::blend}) {
        importer::Scene masked = post_on_floor();
        masked.materials.emplace_back().alpha = alpha;
        masked.meshes[0].primitives[0].material = 1;
        EXPECT_FALSE(refined(masked)[0].has_value());
    }
    importer::Scene many = post_on_floor();
    for (int i = 1; i < 5; ++i) bake::place(many, 0, dvec3(100 * i, 0, 0));
    EXPECT_FALSE(refined(many)[0].has_value()) << "in five places";
    many.nodes.pop_back();
    EXPECT_TRUE(refined(many)[0].has_value()) << "in four";
    EXPECT_TRUE(refined({}).empty());
}

TEST(Refine, CutsWhereALampShines) {
    importer::Scene scene;
    lit::put(scene, lit::floor_of(40), "floor", dvec3(0));
    scene.lamps = {lit::bulb(dvec3(7, 3, 5), 200)};
    const bake::RefinedMeshes meshes = refined(scene);
    ASSERT_TRUE(meshes[0].has_value());
    const auto& at = meshes[0]->primitives[0].positions;
    const auto near = std::count_if(at.begin(), at.end(), [](const vec3& p) { return glm::length(p - vec3(7, 0, 5)) < 12; });
    const auto far = std::count_if(at.begin(), at.end(), [](const vec3& p) { return glm::length(p - vec3(-30, 0, -30)) < 12; });
    EXPECT_GT(near, 10);
    EXPECT_LT(far, near / 2);
}

TEST(Refine, IsTheSameForAnyNumberOfThreads) {
    importer::Scene scene = post_on_floor();
    lit::put(scene, lit::floor_of(10), "second", dvec3(30, 0, 0));
    lit::put(scene, lit::post(), "post", dvec3(28, 0, 0));
    const bake::RefinedMeshes one = refined(scene);
    tbb::task_arena arena(4);
    const bake::RefinedMeshes four = arena.execute([&] {
        return refined(scene,
                       [](std::size_t count, const std::function<void(std::size_t)>& body) { bake::for_all(count, body); });
    });
    for (std::size_t m = 0; m < one.size(); ++m) {
        ASSERT_EQ(one[m].has_value(), four[m].has_value());
        if (!one[m]) continue;
        EXPECT_EQ(one[m]->primitives[0].indices, four[m]->primitives[0].indices);
        EXPECT_EQ(one[m]->primitives[0].positions, four[m]->primitives[0].positions);
    }
    EXPECT_TRUE(one[0].has_value());
}

TEST(Refine, OfFlatAndHugePlacementsIsNoTrouble) {
    importer::Scene scene = post_on_floor();
    for (const dvec3& scale : {dvec3(0), dvec3(1, 0, 1), dvec3(-1, 1, 1)}) {
        importer::Scene odd = scene;
        bake::place(odd, 0, dvec3(100, 0, 0), scale);
        const bake::RefinedMeshes meshes = refined(odd);
        ASSERT_TRUE(meshes[0].has_value());
        for (const vec3& at : meshes[0]->primitives[0].positions)
            EXPECT_TRUE(std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z));
        std::swap(odd.nodes.front(), odd.nodes.back());
        EXPECT_TRUE(refined(odd)[0].has_value()) << "whichever comes first";
    }
    importer::Scene huge = scene;
    huge.nodes[0].world = glm::scale(dmat4(1.0), dvec3(1e6));
    for (const auto& mesh : refined(huge))
        if (mesh) {
            EXPECT_LE(mesh->primitives[0].indices.size() / 3, 20'002U);
        }
}

TEST(Refine, StopsBetweenRounds) {
    const importer::Scene scene = post_on_floor();
    const auto rays = bake::make_light_rays(scene, {});
    const bake::RefineLight light{glm::normalize(dvec3(0.4, 0.8, 0.3)), {}, &rays->opaque, &rays->lamps};
    EXPECT_FALSE(bake::refine_for_light(scene, light, lit::one_by_one, [] { return true; })[0].has_value());
    int rounds = 0;
    const bake::RefinedMeshes some = bake::refine_for_light(scene, light, lit::one_by_one, [&] { return ++rounds > 3; });
    EXPECT_EQ(rounds, 4);
    EXPECT_EQ(cracks(scene, some), 0U);
}

}  // namespace
}  // namespace surefoot
