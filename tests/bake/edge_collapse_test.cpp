// Edge collapses on plates, roofs, seams and broken meshes: what must stay stays, and the cheapest goes first.
#include "render/bake/edge_collapse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <tuple>

#include "render/bake/mesh_surface.hpp"
#include "render/bake/picture_shift.hpp"
#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {
namespace {

constexpr std::uint32_t plate_side = 16;

/// A plate of 16 x 16 squares, 16 m wide, facing +Z: `shape` gives each vertex its height, normal, uv and colour.
Geometry plate_of(const std::function<void(vec2, model::Vertex&)>& shape) {
    Geometry g;
    GeometryPart part{0, {}};
    for (std::uint32_t y = 0; y <= plate_side; ++y) {
        for (std::uint32_t x = 0; x <= plate_side; ++x) {
            model::Vertex v{};
            v.position[0] = static_cast<float>(x);
            v.position[1] = static_cast<float>(y);
            v.normal[2] = 127;
            v.uv[0] = v.position[0] / plate_side;
            v.uv[1] = v.position[1] / plate_side;
            std::fill_n(v.colour, 4, std::uint8_t{255});
            shape(vec2(v.position[0], v.position[1]), v);
            g.vertices.push_back(v);
            if (x == plate_side || y == plate_side) continue;
            const std::uint32_t a = y * (plate_side + 1) + x, b = a + plate_side + 1;
            for (const std::uint32_t i : {a, a + 1, b, a + 1, b + 1, b}) part.indices.push_back(i);
        }
    }
    g.parts = {part};
    return g;
}
const auto as_it_is = [](vec2, model::Vertex&) {};

std::uint32_t triangles_of(const std::vector<GeometryPart>& parts) {
    std::size_t n = 0;
    for (const GeometryPart& part : parts) n += part.indices.size() / 3;
    return static_cast<std::uint32_t>(n);
}

std::vector<GeometryPart> reduced(const Geometry& g, std::uint32_t triangles, const CollapseOptions& options = {}) {
    EdgeCollapse mesh(g.vertices, g.parts, options);
    const std::uint32_t left = mesh.reduce_to(triangles);
    EXPECT_EQ(left, triangles_of(mesh.parts()));
    return mesh.parts();
}

/// An upper bound of the two-sided distance.
float distance(const Geometry& g, const std::vector<GeometryPart>& parts) {
    const MeshSurface full(g.vertices, g.parts), coarse(g.vertices, parts);
    return measure::two_sided_distance(full.view(), coarse.view(), {}).upper;
}

using Place = std::tuple<float, float, float>;
Place place_of(const model::Vertex& v) { return {v.position[0], v.position[1], v.position[2]}; }

/// Triangles at each edge between two places.
std::map<std::set<Place>, int> edges_of(const Geometry& g, const std::vector<GeometryPart>& parts) {
    std::map<std::set<Place>, int> edges;
    for (const GeometryPart& part : parts)
        for (std::size_t i = 0; i < part.indices.size(); ++i)
            ++edges[{place_of(g.vertices[part.indices[i]]), place_of(g.vertices[part.indices[i - i % 3 + (i + 1) % 3]])}];
    return edges;
}

bool on_rim(const Place& p) {
    const auto at_end = [](float x) { return x == 0 || x == plate_side; };
    return at_end(std::get<0>(p)) || at_end(std::get<1>(p));
}

TEST(EdgeCollapse, LeavesTwoTrianglesOfAFlatPlateAndItsPictureInPlace) {
    const Geometry g = plate_of(as_it_is);
    const std::vector<GeometryPart> parts = reduced(g, 2);
    EXPECT_EQ(triangles_of(parts), 2U);
    EXPECT_LT(distance(g, parts), 1e-3F);
    EXPECT_LT(PictureReference(g, {Picture::clamped}).shift_m({parts, 2, 0}), 1e-4F);
}

TEST(EdgeCollapse, LeavesFixedBordersAsTheyAre) {
    const Geometry g = plate_of(as_it_is);
    CollapseOptions options;
    options.fixed_borders = true;
    const std::vector<GeometryPart> parts = reduced(g, 2, options);
    // A polygon with 64 corners, and one vertex within: on any corner it would lie in line with two others.
    EXPECT_LE(triangles_of(parts), 4 * plate_side);
    for (const auto& [edge, triangles] : edges_of(g, g.parts)) {
        if (triangles == 1) {
            EXPECT_EQ(edges_of(g, parts)[edge], 1);
        }
    }
}

TEST(EdgeCollapse, KeepsTheRidgeOfARoof) {
    const Geometry g = plate_of([](vec2 at, model::Vertex& v) { v.position[2] = 8 - std::abs(at.x - 8); });
    EXPECT_LT(distance(g, reduced(g, 4)), 1e-3F);
}

TEST(EdgeCollapse, GoesWhereAHillIsFlattestFirst) {
    const Geometry g = plate_of([](vec2 at, model::Vertex& v) {
        v.position[2] = 6 * std::exp(-0.2F * ((at.x - 8) * (at.x - 8) + (at.y - 8) * (at.y - 8)));
    });
    EXPECT_LT(distance(g, reduced(g, 100)), 0.5F);
    EXPECT_LT(distance(g, reduced(g, 200)), distance(g, reduced(g, 50)));
}

// What only attributes show has no error of its own in the surface.
TEST(EdgeCollapse, KeepsTheEdgeOfAColour) {
    const Geometry g = plate_of([](vec2 at, model::Vertex& v) {
        if (at.x >= 8) v.colour[0] = v.colour[1] = 0;
    });
    for (const GeometryPart& part : reduced(g, 40)) {
        for (std::size_t i = 0; i < part.indices.size(); i += 3) {
            float low = plate_side, high = 0;
            bool dark = false, bright = false;
            for (std::size_t k = 0; k < 3; ++k) {
                const model::Vertex& v = g.vertices[part.indices[i + k]];
                low = std::min(low, v.position[0]);
                high = std::max(high, v.position[0]);
                (v.colour[0] == 0 ? dark : bright) = true;
            }
            if (dark && bright) {
                EXPECT_LE(high - low, 1.0F) << "the colours change between 7 and 8";
            }
        }
    }
}

TEST(EdgeCollapse, KeepsABentPicture) {
    const Geometry g = plate_of([](vec2 at, model::Vertex& v) { v.uv[0] = at.x < 8 ? at.x / 32 : at.x / 16 * 1.5F - 0.5F; });
    const std::vector<GeometryPart> parts = reduced(g, 8);
    EXPECT_LT(PictureReference(g, {Picture::clamped}).shift_m({parts, 8, 0}), 0.05F);
}

// The left and the right half have vertices of their own where they meet: another material, or a seam in the picture.
Geometry halves(bool materials) {
    Geometry g = plate_of(as_it_is);
    GeometryPart left{0, {}}, right{materials ? 1U : 0U, {}};
    std::map<std::uint32_t, std::uint32_t> copies;
    const std::vector<std::uint32_t> all = g.parts[0].indices;
    for (std::size_t i = 0; i < all.size(); i += 3) {
        const bool is_left =
            std::all_of(all.begin() + static_cast<std::ptrdiff_t>(i), all.begin() + static_cast<std::ptrdiff_t>(i + 3),
                        [&](std::uint32_t v) { return g.vertices[v].position[0] <= 8; });
        for (std::size_t k = 0; k < 3; ++k) {
            std::uint32_t v = all[i + k];
            if (!is_left && g.vertices[v].position[0] == 8) {
                const auto [copy, fresh] = copies.try_emplace(v, static_cast<std::uint32_t>(g.vertices.size()));
                if (fresh) {
                    model::Vertex other = g.vertices[v];
                    if (!materials) other.uv[0] += 3;
                    g.vertices.push_back(other);
                }
                v = copy->second;
            } else if (!is_left && !materials) {
                g.vertices[v].uv[0] += g.vertices[v].uv[0] < 3 ? 3.0F : 0.0F;
            }
            (is_left ? left : right).indices.push_back(v);
        }
    }
    g.parts = {left, right};
    if (!materials) {
        g.parts[0].indices.insert(g.parts[0].indices.end(), right.indices.begin(), right.indices.end());
        g.parts.pop_back();
    }
    return g;
}

TEST(EdgeCollapse, LetsNoMaterialsPart) {
    const Geometry g = halves(true);
    for (const std::uint32_t triangles : {100U, 20U, 4U}) {
        const std::vector<GeometryPart> parts = reduced(g, triangles);
        ASSERT_EQ(parts.size(), 2U);
        for (const auto& [edge, count] : edges_of(g, parts)) {
            const bool inner = std::any_of(edge.begin(), edge.end(), [](const Place& p) { return !on_rim(p); });
            if (inner) {
                EXPECT_EQ(count, 2);
            }
        }
        EXPECT_LT(distance(g, parts), 1e-3F);
    }
}

TEST(EdgeCollapse, LaysNoTriangleAcrossASeam) {
    const Geometry g = halves(false);
    const std::vector<GeometryPart> parts = reduced(g, 4);
    for (std::size_t i = 0; i < parts[0].indices.size(); i += 3) {
        float low = 9, high = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            low = std::min(low, g.vertices[parts[0].indices[i + k]].uv[0]);
            high = std::max(high, g.vertices[parts[0].indices[i + k]].uv[0]);
        }
        EXPECT_LT(high - low, 1.5F);
    }
}

TEST(EdgeCollapse, MakesNoPartVanish) {
    Geometry g;
    GeometryPart part{0, {}};
    for (int i = 0; i < 20; ++i) {  // tetrahedra and single triangles in turns
        const auto base = static_cast<std::uint32_t>(g.vertices.size());
        for (const vec3& at : {vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)}) {
            model::Vertex v{};
            v.position[0] = at.x + 3 * static_cast<float>(i);
            v.position[1] = at.y;
            v.position[2] = at.z;
            g.vertices.push_back(v);
        }
        const std::vector<std::uint32_t> corners =
            i % 2 == 0 ? std::vector<std::uint32_t>{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3} : std::vector<std::uint32_t>{0, 1, 2};
        for (const std::uint32_t c : corners) part.indices.push_back(base + c);
    }
    g.parts = {part};
    std::map<std::uint32_t, std::size_t> left;
    const std::vector<GeometryPart> parts = reduced(g, 1);
    for (const std::uint32_t v : parts.at(0).indices) ++left[v / 4];
    EXPECT_EQ(left.size(), 20U);
    for (const auto& [one, corners] : left) EXPECT_EQ(corners, one % 2 == 0 ? 12U : 3U) << "a tetrahedron keeps its volume";
}

// The tip of a cone with a corner a triangle, as flat shading has it: to look all round it for each step would take hours.
TEST(EdgeCollapse, LeavesHubsInTime) {
    Geometry g;
    GeometryPart part{0, {}};
    constexpr std::uint32_t sides = 8000;
    for (std::uint32_t i = 0; i < sides; ++i) {
        const auto base = static_cast<std::uint32_t>(g.vertices.size());
        for (const std::uint32_t k : {i, (i + 1) % sides, sides}) {
            const float turn = 6.2831853F * static_cast<float>(k) / sides;
            model::Vertex v{};
            v.normal[0] = static_cast<std::int8_t>(i % 100);
            if (k < sides) v.position[0] = std::cos(turn), v.position[2] = std::sin(turn);
            v.position[1] = k < sides ? 0.0F : 1.0F;
            g.vertices.push_back(v);
        }
        for (const std::uint32_t k : {0U, 1U, 2U}) part.indices.push_back(base + k);
    }
    g.parts = {part};
    const std::uint32_t left = triangles_of(reduced(g, sides / 2));
    EXPECT_GT(left, 2U);
    EXPECT_LE(left, sides / 2);
}

// Needles, a triangle without area, one that is there twice, three at one edge, an unused vertex, and lengths of 10^18 m.
TEST(EdgeCollapse, TakesBrokenMeshes) {
    Geometry g = plate_of([](vec2 at, model::Vertex& v) { v.position[2] = 1e-7F * at.x * at.y; });
    std::vector<std::uint32_t>& indices = g.parts[0].indices;
    for (const std::uint32_t i : {0U, 0U, 1U, 0U, 1U, 2U, 0U, 1U, 17U, 0U, 1U, 17U, 0U, 1U, 200U}) indices.push_back(i);
    model::Vertex far{};
    far.position[0] = 1e18F;
    far.uv[0] = 1e30F;
    g.vertices.push_back(far);
    for (const std::uint32_t i : {0U, 1U, static_cast<std::uint32_t>(g.vertices.size() - 1)}) indices.push_back(i);
    g.vertices.push_back(far);
    const std::vector<GeometryPart> parts = reduced(g, 10);
    EXPECT_GT(triangles_of(parts), 0U);
    EXPECT_LT(triangles_of(parts), triangles_of(g.parts));
    for (const std::uint32_t v : parts.at(0).indices) EXPECT_LT(v, g.vertices.size());
}

TEST(EdgeCollapse, OfNothingIsNothing) {
    const Geometry g;
    EXPECT_TRUE(reduced(g, 10).empty());
}

}  // namespace
}  // namespace surefoot::bake
