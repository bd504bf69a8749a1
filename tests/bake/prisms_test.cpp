// Stacks of prisms: sections as wide as what shows, bounds that hold, and none where something else looks better.
#include "render/bake/prisms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "render/bake/bake.hpp"
#include "render/bake/prism_stack.hpp"
#include "tests/bake/scenes.hpp"
#include "tests/bake/surface.hpp"

namespace surefoot::bake {
namespace {

constexpr std::array<std::uint8_t, 4> bark{90, 60, 30, 255}, green{30, 120, 20, 255};

/// Adds a square with a side of 2 * half_m about a point, seen from both sides.
void add_leaf(Geometry& g, const vec3& at, const vec3& along, const vec3& up, const std::array<std::uint8_t, 4>& colour) {
    const auto base = static_cast<std::uint32_t>(g.vertices.size());
    const vec3 normal = glm::normalize(glm::cross(along, up));
    for (const vec2 c : {vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)}) {
        model::Vertex v{};
        for (int k = 0; k < 3; ++k) {
            v.position[k] = at[k] + c.x * along[k] + c.y * up[k];
            v.normal[k] = static_cast<std::int8_t>(std::lround(127 * normal[k]));
        }
        std::copy(colour.begin(), colour.end(), v.colour);
        g.vertices.push_back(v);
        g.baked.push_back(colour);
    }
    for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) g.parts[0].indices.push_back(base + i);
}

/// A round trunk, 0.4 m wide and 2 m high, under a crown of leaves: a ball of 3 m.
Geometry tree() {
    Geometry g;
    g.parts = {{0, {}}};
    constexpr int sides = 24;
    for (int s = 0; s < sides; ++s) {
        const float a = 6.2831853F * static_cast<float>(s) / sides;
        const vec3 out(std::cos(a), 0, std::sin(a)), along(-out.z, 0, out.x);
        add_leaf(g, 0.2F * out + vec3(0, 1, 0), 0.2F * std::tan(3.1415927F / sides) * along, vec3(0, 1, 0), bark);
    }
    Random random(7);
    const auto point = [&] { return vec3(any_in(random, dvec3(-1), dvec3(1))); };
    for (int i = 0; i < 600; ++i) {
        vec3 at = point();
        while (glm::dot(at, at) > 1) at = point();
        const vec3 along = glm::normalize(point() + vec3(0.01F, 0, 0));
        const vec3 up = glm::normalize(glm::cross(along, point()));
        add_leaf(g, 1.4F * at + vec3(0, 3.5F, 0), 0.14F * along, 0.14F * up, green);
    }
    return g;
}

/// Materials without textures: the second one shows colours of vertices.
model::Model plain_materials() {
    model::Model m;
    m.materials.resize(2);
    for (model::Material& material : m.materials) {
        material.effects = model::effect_vertex_colour | model::effect_sun;
        material.two_sided = true;
    }
    return m;
}

ChainOptions options_for(const model::Model& m) {
    ChainOptions options;
    options.proxy_material = 1;
    options.looks = &m;
    return options;
}

/// A chain, and how many of its vertices were there before its stacks.
struct WithPrisms {
    LodChain chain;
    std::size_t others = 0;
    [[nodiscard]] bool is_stack(const Level& level) const {
        return std::ranges::all_of(level.parts, [&](const GeometryPart& part) {
            return std::ranges::all_of(part.indices, [&](std::uint32_t index) { return index >= others; });
        });
    }
    [[nodiscard]] std::vector<Level> stacks() const {
        std::vector<Level> out;
        std::ranges::copy_if(chain.levels, std::back_inserter(out), [&](const Level& level) { return is_stack(level); });
        return out;
    }
};
WithPrisms with_prisms(Geometry g) {
    const model::Model looks = plain_materials();
    WithPrisms out{make_chain(std::move(g), options_for(looks))};
    out.others = out.chain.full.vertices.size();
    add_prisms(out.chain, options_for(looks));
    return out;
}

double area_shown(const Geometry& g, const std::vector<GeometryPart>& parts, double azimuth, double elevation) {
    FormPicture picture;
    picture.clear(view_of(g.box(), direction_of(azimuth, elevation), dvec3(0.0), 128));
    draw_geometry(plain_materials(), g.vertices, parts, picture);
    const auto covered = std::ranges::count_if(picture.samples, [](const FormSample& s) { return s.covered(); });
    return static_cast<double>(covered) * std::ldexp(1.0, 2 * picture.view.exponent);
}

TEST(PrismStack, ProfilesAreAsWideAsWhatShows) {
    const Geometry g = tree();
    const Profile profile = profile_of(g, g.parts, plain_materials());
    ASSERT_GT(profile.rows.size(), 10U);
    EXPECT_FALSE(profile.square);
    for (const ProfileRow& row : profile.rows) {
        if (row.height > 0.2 && row.height < 1.6) {
            EXPECT_NEAR(row.mean_width, 0.4, 0.1) << row.height;
        }
        if (row.height > 3.2 && row.height < 3.8) {
            EXPECT_NEAR(row.mean_width, 2.9, 0.3) << row.height;
        }
        if (row.height < 1.9 || row.height > 2.6) {  // elsewhere there are but a few leaves
            EXPECT_LT(glm::length(row.centre), 0.25) << row.height;
        }
    }
}

TEST(PrismStack, BendsWhereTheOutlineDoes) {
    const Geometry g = tree();
    const PrismStack stack = stack_of(profile_of(g, g.parts, plain_materials()), 5, 5);
    ASSERT_EQ(stack.rings.size(), 5U);
    EXPECT_TRUE(std::ranges::any_of(stack.rings, [](const PrismRing& r) { return std::abs(r.height - 2.0) < 0.4; }));
    for (std::size_t i = 0; i + 1 < stack.rings.size(); ++i) EXPECT_LT(stack.rings[i].height, stack.rings[i + 1].height);
    EXPECT_LT(stack.rings[0].half.x, 0.4) << "the trunk's foot";
}

TEST(PrismStack, OfABoxIsABox) {
    Geometry g;
    g.parts = {{0, {}}};
    const vec3 half(2, 1.5F, 1);
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0F, 1.0F}) {
            vec3 at(0), along(0), up(0);
            at[axis] = side * half[axis];
            along[(axis + 1) % 3] = half[(axis + 1) % 3];
            up[(axis + 2) % 3] = half[(axis + 2) % 3];
            add_leaf(g, at, along, up, bark);
        }
    const Profile profile = profile_of(g, g.parts, plain_materials());
    EXPECT_TRUE(profile.square);
    for (const PrismRing& ring : stack_of(profile, 3, 5).rings) {
        EXPECT_NEAR(ring.half.x, 2, 0.1);
        EXPECT_NEAR(ring.half.y, 1, 0.1);
    }
}

TEST(Prisms, StandForATreeAndCoverAsMuch) {
    const WithPrisms made = with_prisms(tree());
    const LodChain& chain = made.chain;
    const std::vector<Level> stacks = made.stacks();
    ASSERT_FALSE(stacks.empty());
    const std::vector<GeometryPart>& full = chain.levels.back().parts;
    for (const Level& stack : stacks)
        for (const double azimuth : {0.1, 0.9, 2.5}) {
            const double share = area_shown(chain.full, stack.parts, azimuth, 0.2) / area_shown(chain.full, full, azimuth, 0.2);
            EXPECT_NEAR(share, 1, 0.12) << azimuth;
        }
    for (std::size_t i = 0; i + 1 < chain.levels.size(); ++i) {
        EXPECT_GT(chain.levels[i].error_m, chain.levels[i + 1].error_m);
        EXPECT_LT(chain.levels[i].triangles, chain.levels[i + 1].triangles);
    }
    const Box box = tree().box();
    for (const Level& stack : stacks)
        for (const std::uint32_t index : stack.parts[0].indices) {
            const dvec3 at(position_of(chain.full.vertices[index]));
            EXPECT_EQ(glm::clamp(at, box.min - 1e-5, box.max + 1e-5), at) << "inside the object's box";
        }
}

TEST(Prisms, AreBoundedAsOtherForms) {
    importer::Scene scene;
    scene.materials.push_back({.name = "leaves"});
    scene.materials[0].two_sided = true;
    importer::Primitive p;
    const Geometry g = tree();
    for (const model::Vertex& v : g.vertices) {
        p.positions.push_back(position_of(v));
        p.normals.push_back(vec3(v.normal[0], v.normal[1], v.normal[2]) / 127.0F);
        p.uvs.push_back({0, 0});
        p.colours.push_back({v.colour[0], v.colour[1], v.colour[2], 255});
    }
    p.indices = g.parts[0].indices;
    const importer::Index mesh = add_mesh(scene, p, "tree");
    place(scene, mesh, {0, 0, 0});
    place(scene, mesh, {200, 0, 5}, {2, 3, -1});  // so far that no tree is cut into pieces
    auto model = bake(scene, {}, {});
    ASSERT_TRUE(model.ok());
    const auto as_small = [](std::uint32_t triangles) { return triangles >= 16 && triangles <= 46; };
    const WithPrisms made = with_prisms(tree());
    for (const Level& level : made.chain.levels) EXPECT_EQ(as_small(level.triangles), made.is_stack(level)) << level.triangles;
    std::size_t placed = 0;
    for (const Judged& j : judge(*model, 10000)) {
        EXPECT_LE(j.sampled, j.bound + j.rounding) << j.node << " " << j.rep;
        if (model->nodes[j.node].child_count == 0 && as_small(model->reps[j.rep].triangles)) ++placed;
    }
    EXPECT_EQ(placed, 2 * made.stacks().size()) << "both trees have them";
}

/// Two posts of 3 m, so far apart.
Geometry posts(float apart_m) {
    Geometry g;
    g.parts = {{0, {}}};
    for (const float x : {-0.5F * apart_m, 0.5F * apart_m})
        for (int i = 0; i < 20; ++i) {
            const float y = 0.15F * static_cast<float>(i) + 0.075F;
            add_leaf(g, {x, y, 0}, {0.06F, 0, 0}, {0, 0.075F, 0}, bark);
            add_leaf(g, {x, y, 0}, {0, 0, 0.06F}, {0, 0.075F, 0}, bark);
        }
    return g;
}

// Two posts have the mean outline of one between them.
TEST(Prisms, DoNotFillWhatIsOpen) {
    const Geometry apart = posts(3);
    ASSERT_FALSE(profile_of(apart, apart.parts, plain_materials()).rows.empty());
    const WithPrisms made = with_prisms(apart);
    EXPECT_TRUE(made.stacks().empty());
    EXPECT_EQ(made.chain.full.vertices.size(), made.others) << "nothing is left of those that were tried";
    EXPECT_EQ(made.chain.full.baked.size(), made.chain.full.vertices.size());
}

// Rails are flat from all sides.
TEST(Prisms, AreNotForWhatIsFlat) {
    Geometry g;
    g.parts = {{0, {}}};
    for (const float x : {-5.0F, 5.0F})
        for (int i = 0; i < 20; ++i) {
            const float z = static_cast<float>(i) - 9.5F;
            add_leaf(g, {x, 0, z}, {0.05F, 0, 0}, {0, 0, 0.5F}, bark);
            add_leaf(g, {x, 0, z}, {0, 0.05F, 0}, {0, 0, 0.5F}, bark);
        }
    EXPECT_TRUE(profile_of(g, g.parts, plain_materials()).rows.empty());
    EXPECT_TRUE(with_prisms(g).stacks().empty());
}

// The vertices of coarse levels, whose cards grow, are no part of the object.
TEST(PrismStack, MeasuresFullDetailAlone) {
    Geometry g = tree();
    const Box box = g.box();
    const std::vector<GeometryPart> full = g.parts;
    add_leaf(g, {0, 9, 0}, {5, 0, 0}, {0, 1, 0}, green);
    const Profile profile = profile_of(g, full, plain_materials());
    EXPECT_EQ(profile.box.min, box.min);
    EXPECT_EQ(profile.box.max, box.max);
}

// A wall that some views do not see, far from the origin: its middle is where it is.
TEST(PrismStack, IsWhereTheObjectIs) {
    Geometry g;
    g.parts = {{0, {}}};
    add_leaf(g, {40, 2, 10}, {1.5F, 0, 0}, {0, 2, 0}, bark);
    const Profile profile = profile_of(g, g.parts, plain_materials());
    ASSERT_FALSE(profile.rows.empty());
    for (const ProfileRow& row : profile.rows) {
        EXPECT_NEAR(row.centre.x, 40, 0.3) << row.height;
        EXPECT_NEAR(row.centre.y, 10, 0.3) << row.height;
    }
}

TEST(Prisms, NeedMaterialsAndColours) {
    const model::Model looks = plain_materials();
    ChainOptions no_looks = options_for(looks), no_colours = options_for(looks);
    no_looks.looks = nullptr;
    no_colours.proxy_material = model::none;
    for (const ChainOptions& without : {no_looks, no_colours}) {
        LodChain chain = make_chain(tree(), without);
        const std::size_t levels = chain.levels.size(), vertices = chain.full.vertices.size();
        add_prisms(chain, without);
        EXPECT_EQ(chain.levels.size(), levels);
        EXPECT_EQ(chain.full.vertices.size(), vertices);
    }
}

TEST(Prisms, OfAChainWithoutLevelsAreItsOnlyOnes) {
    const model::Model looks = plain_materials();
    LodChain chain;
    chain.full = tree();
    chain.levels.push_back({chain.full.parts, static_cast<std::uint32_t>(chain.full.triangles()), 0});
    add_prisms(chain, options_for(looks));
    ASSERT_GE(chain.levels.size(), 2U);
    EXPECT_EQ(chain.levels.back().error_m, 0);
}

// Two errors that are one float apart can become equal when they are placed.
TEST(Levels, ErrorsStayApartInAnyPlacement) {
    std::vector<Level> levels(3);
    levels[0].error_m = 0.5F;
    levels[1].error_m = 0.5F;
    raise_errors(levels);
    EXPECT_GT(levels[0].error_m, 1.0005F * levels[1].error_m);
    EXPECT_FLOAT_EQ(levels[1].error_m, 0.5F);
    EXPECT_EQ(levels[2].error_m, 0);
}

}  // namespace
}  // namespace surefoot::bake
