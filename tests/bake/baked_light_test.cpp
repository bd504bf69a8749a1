// Light that does not move, of whole bakes: shadows by hour, lamps on both sides, glow, and nothing where nothing changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <iterator>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/bake/lit_vertices.hpp"
#include "render/model/daylight.hpp"
#include "tests/bake/lit_scenes.hpp"

namespace surefoot {
namespace {

constexpr model::EffectMask light_effects = model::effect_shadow | model::effect_lamps;

model::Model lit_bake(const importer::Scene& scene, bake::BakeOptions options = {}) {
    options.quality = bake::Quality::full;
    auto model = bake::bake(scene, options, {});
    EXPECT_TRUE(model.ok()) << (model.ok() ? "" : model.error().text());
    return model.ok() ? std::move(*model) : model::Model{};
}

/// A vertex of an object's full detail.
struct Seen {
    std::size_t vertex = 0;
    dvec3 at{0.0};  ///< in the world
    const model::Material* material = nullptr;
};

std::vector<Seen> vertices_of(const model::Model& m, const std::string& name) {
    std::vector<Seen> out;
    for (const model::Node& node : m.nodes) {
        if (node.child_count > 0 || name != m.name_of(node)) continue;
        const model::Representation& full = m.reps[node.first_rep + node.rep_count - 1];
        const model::Placement& place = m.placements[full.placement];
        for (model::Index p = full.first_part; p < full.first_part + full.part_count; ++p)
            for (std::uint32_t i = 0; i < m.parts[p].index_count; ++i) {
                const std::size_t v = m.parts[p].first_vertex + m.indices[m.parts[p].first_index + i];
                const float* at = m.vertices[v].position;
                out.push_back(
                    {v, place.origin + dmat3(place.linear) * dvec3(at[0], at[1], at[2]), &m.materials[m.parts[p].material]});
            }
    }
    EXPECT_FALSE(out.empty()) << name;
    return out;
}

vec3 light_of(const model::Model& m, const std::uint8_t* bytes) {
    vec3 out;
    for (int c = 0; c < 3; ++c) out[c] = m.light.max_lamp_light * std::pow(static_cast<float>(bytes[c]) / 255, 2.0F);
    return out;
}

/// How well a post of this height at the origin hides the sun: 0, not at all; 1, surely; none: near the border.
std::optional<int> hides(const dvec3& at, const dvec3& sun, double radius_m, double height_m) {
    const dvec2 way(sun.x, sun.z), from(at.x, at.z);
    const double along = -glm::dot(from, way) / glm::dot(way, way);
    const double off = glm::length(from + along * way), height = at.y + along * sun.y;
    if (along < 0 || off > radius_m + 0.15 || height > height_m + 1)
        return glm::length(from) > radius_m + 0.2 ? std::optional(0) : std::nullopt;
    if (off < radius_m - 0.15 && height < height_m - 1 && glm::length(from) > radius_m + 0.2) return 1;
    return {};
}

importer::Scene post_in_the_sun() {
    importer::Scene scene;
    lit::put(scene, lit::floor_of(15, 6), "floor", dvec3(0));
    lit::put(scene, lit::post(0.6F, 6), "post", dvec3(0));
    return scene;
}

TEST(BakedLight, SmallThingsLetAThirdOfTheSunThroughAndGlassAllOfIt) {
    importer::Scene scene;
    scene.sun = importer::Sun{"noon", dvec3(0, 1, 0), 3};
    lit::put(scene, lit::floor_of(15, 6), "floor", dvec3(0));
    lit::put(scene, lit::floor_of(0.12F), "leaf", dvec3(5, 2, 5));
    scene.materials.emplace_back().alpha = model::AlphaMode::blend;
    scene.materials.back().colour[3] = 0.3F;
    importer::Primitive pane = lit::floor_of(1);
    pane.material = 1;
    lit::put(scene, std::move(pane), "glass", dvec3(-5, 2, -5));
    const model::Model m = lit_bake(scene);
    std::size_t below = 0;
    for (const Seen& v : vertices_of(m, "floor")) {
        const bool shaded = std::abs(v.at.x - 5) < 0.1 && std::abs(v.at.z - 5) < 0.1;
        EXPECT_EQ(m.sun_seen[v.vertex].share[0], shaded ? 85 : 255) << v.at.x << ' ' << v.at.z;
        below += shaded ? 1 : 0;
    }
    EXPECT_GT(below, 0U);
}

TEST(BakedLight, ShadowsOfAPostFallWhereTheSunOfEachHourThrowsThem) {
    bake::BakeOptions options;
    options.sun = model::SunTime{15, 100, 40};
    const model::Model m = lit_bake(post_in_the_sun(), options);
    ASSERT_EQ(m.sun_seen.size(), m.vertices.size());
    EXPECT_EQ(m.light.day, 100);
    EXPECT_EQ(m.light.latitude_deg, 40);
    std::size_t east_by_morning = 0, west_by_morning = 0, east_by_evening = 0, west_by_evening = 0;
    for (std::uint32_t s = 0; s < 16; ++s) {
        const dvec3 sun = s == 0 ? m.sun_direction : model::towards_sun({model::hour_of_moment(s - 1, 100, 40), 100, 40});
        std::size_t dark = 0, bright = 0;
        for (const Seen& v : vertices_of(m, "floor")) {
            EXPECT_NE(v.material->effects & model::effect_shadow, 0U);
            const int share = m.sun_seen[v.vertex].share[s];
            const bool in_shadow = share < 128 && glm::length(dvec2(v.at.x, v.at.z)) > 1;
            if (in_shadow && s == 3) ++(v.at.x > 0 ? east_by_morning : west_by_morning);
            if (in_shadow && s == 13) ++(v.at.x > 0 ? east_by_evening : west_by_evening);
            if (sun.y < 0.05) continue;
            const std::optional<int> hidden = hides(v.at, sun, 0.6, 6);
            if (!hidden) continue;
            EXPECT_EQ(share, *hidden == 1 ? 0 : 255) << s << " at " << v.at.x << " " << v.at.z;
            ++(*hidden == 1 ? dark : bright);
        }
        if (sun.y >= 0.05) {
            EXPECT_GT(dark, 0U) << s;
            EXPECT_GT(bright, 0U) << s;
        }
    }
    EXPECT_GT(west_by_morning, 0U);
    EXPECT_EQ(east_by_morning, 0U) << "the sun rises in the east";
    EXPECT_GT(east_by_evening, 0U);
    EXPECT_EQ(west_by_evening, 0U);
}

TEST(BakedLight, FirstShareIsOfTheScenesOwnSun) {
    importer::Scene scene = post_in_the_sun();
    scene.sun = importer::Sun{"low", glm::normalize(dvec3(1, 0.5, -1)), 3};
    const model::Model m = lit_bake(scene);
    std::size_t dark = 0;
    for (const Seen& v : vertices_of(m, "floor")) {
        const std::optional<int> hidden = hides(v.at, scene.sun->towards, 0.6, 6);
        if (!hidden) continue;
        EXPECT_EQ(m.sun_seen[v.vertex].share[0], *hidden == 1 ? 0 : 255);
        dark += *hidden == 1 ? 1 : 0;
    }
    EXPECT_GT(dark, 0U);
}

TEST(BakedLight, OfALampIsBeforeASheetAndNotBehindIt) {
    importer::Scene scene;
    scene.materials.resize(1);
    scene.materials[0].two_sided = true;
    lit::put(scene, lit::sheet(vec3(0, 3, 0), vec3(2, 0, 0), vec3(0, 2, 0), 4), "sheet", dvec3(0));  // looks south, +Z
    scene.lamps = {lit::bulb(dvec3(0, 3, 3), 200)};
    scene.lamps[0].colour = {1, 0.25F, 0};
    for (const bool turned : {false, true}) {
        if (turned) scene.lamps[0].at.z = -3;
        const model::Model m = lit_bake(scene);
        ASSERT_EQ(m.lamp_light.size(), m.vertices.size());
        for (const Seen& v : vertices_of(m, "sheet")) {
            const model::LampLight& light = m.lamp_light[v.vertex];
            const vec3 here = light_of(m, turned ? light.behind : light.before);
            const double distance = glm::length(scene.lamps[0].at - v.at);
            const vec3 expected = bake::shown_light(dvec3(1, 0.25, 0) * (200 * 3 / (distance * distance * distance)));
            EXPECT_NEAR(glm::length(here - expected), 0, 0.02);
            EXPECT_EQ(light_of(m, turned ? light.before : light.behind), vec3(0));
            EXPECT_EQ(light.before[3] + light.behind[3], 0);
            EXPECT_NE(v.material->effects & model::effect_lamps, 0U);
        }
    }
}

TEST(BakedLight, OfAMeshInTwoPlacesIsTheMeanOfBoth) {
    importer::Scene scene;
    const importer::Index tile = lit::put(scene, lit::floor_of(1, 4), "tile", dvec3(0));
    bake::place(scene, tile, dvec3(0, 0, 2000));
    scene.lamps = {lit::bulb(dvec3(0, 3, 0), 100)};
    const model::Model m = lit_bake(scene);
    ASSERT_EQ(m.lamp_light.size(), m.vertices.size());
    for (const Seen& v : vertices_of(m, "tile")) {
        const dvec3 at = v.at.z > 1000 ? v.at - dvec3(0, 0, 2000) : v.at;
        const double distance = glm::length(scene.lamps[0].at - at);
        const vec3 expected = bake::shown_light(dvec3(0.5 * 100 * 3 / (distance * distance * distance)));
        EXPECT_NEAR(light_of(m, m.lamp_light[v.vertex].before).r, expected.r, 0.02);
    }
}

TEST(BakedLight, GlowIsDividedByTheColourAndCountsOnceForAllLevels) {
    importer::Scene scene;
    scene.materials.resize(2);
    scene.materials[0].colour = {0.5F, 0.5F, 0.01F, 1};
    scene.materials[0].emission = {0.2F, 0, 1e6F};
    lit::put(scene, bake::ball(24, 2), "ball", dvec3(0));
    lit::put(scene, lit::sheet(vec3(0), vec3(0, 0, 2), vec3(2, 0, 0), 2, 1), "dark", dvec3(50, 0, 0));
    const model::Model m = lit_bake(scene);
    ASSERT_EQ(m.lamp_light.size(), m.vertices.size());
    std::size_t levels = 0;
    for (const model::Node& node : m.nodes)
        if (node.child_count == 0) levels = std::max<std::size_t>(levels, node.rep_count);
    ASSERT_GT(levels, 2U) << "they share vertices";
    EXPECT_FLOAT_EQ(m.light.max_lamp_light, 16) << "blue is limited";
    EXPECT_EQ(m.light.night_room_light, 1) << "what glows is no lamp of a room";
    for (const Seen& v : vertices_of(m, "ball"))
        for (const std::uint8_t* side : {m.lamp_light[v.vertex].before, m.lamp_light[v.vertex].behind}) {
            EXPECT_NEAR(light_of(m, side).r, std::pow(0.2F, 1 / 2.2F) / 0.5F, 0.03);
            EXPECT_EQ(side[1], 0);
            EXPECT_EQ(side[2], 255);
        }
    for (const Seen& v : vertices_of(m, "dark")) {
        EXPECT_EQ(light_of(m, m.lamp_light[v.vertex].before), vec3(0));
        EXPECT_EQ(v.material->effects & model::effect_lamps, 0U);
    }
}

TEST(BakedLight, WhereNothingHidesAndNothingShinesNothingIsAdded) {
    importer::Scene scene;
    lit::put(scene, lit::floor_of(10, 4), "floor", dvec3(0));
    const model::Model m = lit_bake(scene);
    EXPECT_TRUE(m.sun_seen.empty());
    EXPECT_TRUE(m.lamp_light.empty());
    bake::BakeOptions draft;
    const auto plain = bake::bake(scene, draft, {});
    ASSERT_TRUE(plain.ok());
    ASSERT_EQ(m.materials.size(), plain->materials.size());
    for (std::size_t i = 0; i < m.materials.size(); ++i) EXPECT_EQ(m.materials[i].effects, plain->materials[i].effects);
    EXPECT_FALSE(m.effects[6].called_for);
    EXPECT_FALSE(m.effects[7].called_for);
}

TEST(BakedLight, OfADraftIsNotMeasured) {
    importer::Scene scene = post_in_the_sun();
    scene.lamps = {lit::bulb(dvec3(3, 3, 3), 500)};
    scene.materials[0].emission = vec3(1);
    const auto m = bake::bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    EXPECT_TRUE(m->sun_seen.empty());
    EXPECT_TRUE(m->lamp_light.empty());
    for (const model::Material& material : m->materials) EXPECT_EQ(material.effects & light_effects, 0U);
    EXPECT_NE(m->effects[6].reason.find("draft"), std::string::npos);
}

TEST(BakedLight, ReachesBoxesWhichSeeAllOfTheSunAndNoLamp) {
    importer::Scene scene;
    scene.materials.resize(1);
    lit::put(scene, lit::floor_of(30, 4), "floor", dvec3(0));
    const importer::Index ball = bake::add_mesh(scene, bake::ball(20, 1.5F), "ball");
    for (int x = 0; x < 4; ++x)
        for (int z = 0; z < 4; ++z) bake::place(scene, ball, dvec3(-12 + 7 * x, 1.5, -12 + 7 * z));
    for (auto& primitive : scene.meshes[ball].primitives)
        primitive.colours.assign(primitive.positions.size(), {200, 100, 50, 255});  // else boxes are not made
    scene.lamps = {lit::bulb(dvec3(0, 5, 0), 500)};
    const model::Model m = lit_bake(scene);
    ASSERT_EQ(m.sun_seen.size(), m.vertices.size());
    ASSERT_EQ(m.lamp_light.size(), m.vertices.size());
    EXPECT_TRUE(model::validate(m).ok());
    std::size_t boxes = 0;
    for (const model::Representation& rep : m.reps) {
        if (rep.kind == model::RepKind::mesh) continue;
        ++boxes;
        const model::Part& part = m.parts[rep.first_part];
        for (std::size_t v = part.first_vertex; v < part.first_vertex + part.vertex_count; ++v) {
            EXPECT_TRUE(
                std::all_of(std::begin(m.sun_seen[v].share), std::end(m.sun_seen[v].share), [](int s) { return s == 255; }));
            EXPECT_EQ(m.lamp_light[v].before[0] + m.lamp_light[v].behind[0], 0);
        }
    }
    EXPECT_GT(boxes, 0U);
    model::Model grown = m;
    grown.vertices.emplace_back();
    bake::fill_scene_light(grown);
    ASSERT_EQ(grown.sun_seen.size(), grown.vertices.size());
    ASSERT_EQ(grown.lamp_light.size(), grown.vertices.size());
    EXPECT_EQ(grown.sun_seen.back().share[9], 255);
    model::Model none;
    none.vertices.resize(3);
    bake::fill_scene_light(none);
    EXPECT_TRUE(none.sun_seen.empty());
    EXPECT_TRUE(none.lamp_light.empty());
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(BakedLight, IsTheSameForAnyNumberOfThreads) {
    importer::Scene scene = post_in_the_sun();
    scene.lamps = {lit::bulb(dvec3(3, 3, 3), 500), lit::bulb(dvec3(-4, 2, 3), 50)};
    bake::BakeOptions options;
    options.workers = 1;
    const model::Model one = lit_bake(scene, options);
    options.workers = 4;
    const model::Model four = lit_bake(scene, options);
    EXPECT_TRUE(same_bytes(one.vertices, four.vertices));
    EXPECT_TRUE(same_bytes(one.indices, four.indices));
    EXPECT_TRUE(same_bytes(one.sun_seen, four.sun_seen));
    EXPECT_TRUE(same_bytes(one.lamp_light, four.lamp_light));
    EXPECT_EQ(one.light, four.light);
    EXPECT_FALSE(one.sun_seen.empty());
    EXPECT_FALSE(one.lamp_light.empty());
    EXPECT_FLOAT_EQ(one.light.night_room_light, 0.4F) << "lamps of its own";
}

TEST(BakedLight, WhereMostGlowsThatIsNoGlow) {
    for (const std::size_t materials : {3U, 4U}) {
        importer::Scene scene;
        for (std::size_t i = 0; i < materials; ++i) {
            importer::Primitive p = lit::floor_of(1);
            scene.materials.emplace_back().emission = vec3(0.3F);
            p.material = static_cast<importer::Index>(i);
            lit::put(scene, std::move(p), "plate", dvec3(0, static_cast<double>(i), 0));
        }
        const model::Model m = lit_bake(scene);
        EXPECT_EQ(m.lamp_light.empty(), materials == 4);
        const auto& warnings = m.provenance.warnings;
        const std::string text = "4 materials glow, on most of the scene: that is taken for ambient light, and not used";
        EXPECT_EQ(std::count(warnings.begin(), warnings.end(), text), materials == 4 ? 1 : 0);
    }
}

TEST(BakedLight, StoppedMidwayLeavesTheModelWithoutIt) {
    importer::Scene scene = post_in_the_sun();
    scene.meshes[0].primitives[0] = lit::floor_of(15, 60);  // several tasks
    scene.lamps = {lit::bulb(dvec3(3, 3, 3), 500)};
    auto m = bake::bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    const auto rays = bake::make_light_rays(scene, {});
    const std::vector<vec3> emission(m->materials.size(), vec3(1));
    const bake::LightInput input{rays->lamps, emission, {}, rays->opaque};
    ASSERT_GT(bake::baked_light_steps(*m), 4U);
    std::vector<model::EffectMask> before;
    for (const model::Material& material : m->materials) before.push_back(material.effects);
    int steps = 0;
    const bake::BakedLight stopped = bake::measure_baked_light(*m, input, lit::one_by_one, [&] { return ++steps < 3; });
    EXPECT_EQ(steps, 3);
    EXPECT_EQ(stopped.vertices + stopped.in_shadow + stopped.lit, 0U);
    EXPECT_TRUE(m->sun_seen.empty());
    EXPECT_TRUE(m->lamp_light.empty());
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(m->materials[i].effects, before[i]);
    const bake::BakedLight whole = bake::measure_baked_light(*m, input, lit::one_by_one, [] { return true; });
    EXPECT_GT(whole.in_shadow, 0U);
    EXPECT_GT(whole.vertices, whole.in_shadow);
    EXPECT_GT(whole.lit, 0U);
    EXPECT_EQ(m->sun_seen.size(), m->vertices.size());
}

TEST(BakedLight, OfAWholeBakeThatIsStoppedIsAnError) {
    std::atomic<bool> stop{false};
    for (const char* stage : {"cutting for light", "light", "shadows"}) {
        stop = false;
        Progress progress;
        progress.stop = &stop;
        progress.report = [&](std::string_view name, double) { stop = stop || name == stage; };
        bake::BakeOptions options;
        options.quality = bake::Quality::full;
        options.workers = 1;
        const auto m = bake::bake(post_in_the_sun(), options, progress);
        EXPECT_TRUE(stop) << stage;
        ASSERT_FALSE(m.ok()) << stage;
        EXPECT_EQ(m.error().kind, ErrorKind::stopped);
    }
}

/// Squares of a metre side by side along X: columns of two vertices, so vertex 2 i and 2 i + 1 are at x = i. `apart`: squares
/// share no vertex.
model::Model strip(std::uint32_t squares, bool apart) {
    model::Model m;
    const auto add = [&](std::uint32_t column) {
        for (int z = 0; z < 2; ++z) {
            model::Vertex v{};
            v.position[0] = static_cast<float>(column);
            v.position[2] = static_cast<float>(z);
            v.normal[1] = 127;
            m.vertices.push_back(v);
        }
    };
    for (std::uint32_t i = 0; i <= squares; ++i) {
        add(i);
        if (apart && i > 0 && i < squares) add(i);
    }
    for (std::uint32_t i = 0; i < squares; ++i) {
        const std::uint32_t a = apart ? 4 * i : 2 * i;
        m.indices.insert(m.indices.end(), {a, a + 1, a + 3, a, a + 3, a + 2});
    }
    m.parts.push_back({0, 0, static_cast<std::uint32_t>(m.indices.size()), 0, static_cast<std::uint32_t>(m.vertices.size())});
    return m;
}

std::vector<bake::VertexFill> fills_of(const model::Model& m, const std::vector<std::uint32_t>& unknown) {
    bake::VertexRange range;
    range.count = static_cast<std::uint32_t>(m.vertices.size());
    range.parts = {0};
    std::vector<bool> which(range.count, false);
    for (const std::uint32_t v : unknown) which[v] = true;
    return bake::vertex_fills(m, range, which);
}

TEST(VertexFills, GoOutwardsFromWhatIsKnownLayerByLayer) {
    const auto fills = fills_of(strip(5, false), {4, 5, 6, 7, 8, 9});  // columns 2, 3 and 4
    ASSERT_EQ(fills.size(), 6U);
    std::vector<bool> known(12, true);
    for (std::uint32_t v = 4; v < 10; ++v) known[v] = false;
    for (const bake::VertexFill& fill : fills) {
        EXPECT_FALSE(known[fill.vertex]) << "each once";
        ASSERT_FALSE(fill.from.empty());
        for (const std::uint32_t from : fill.from) {
            EXPECT_TRUE(known[from]) << "after what it takes from";
            EXPECT_LE(std::abs(static_cast<int>(from / 2) - static_cast<int>(fill.vertex / 2)), 1) << "of one square";
        }
        for (const std::uint32_t from : fill.from) EXPECT_NE(from / 2, fill.vertex / 2) << "a layer takes nothing from itself";
        known[fill.vertex] = true;
    }
}

TEST(VertexFills, TakeTheNearestThatLooksTheSameWayWhereNoTriangleReachesOut) {
    model::Model m = strip(6, true);  // square i has the vertices 4 i to 4 i + 3
    std::vector<std::uint32_t> unknown(20);
    std::iota(unknown.begin(), unknown.end(), 4);
    auto fills = fills_of(m, unknown);
    std::vector<std::uint32_t> from(24, 99);
    for (const bake::VertexFill& fill : fills) {
        ASSERT_EQ(fill.from.size(), 1U);
        from[fill.vertex] = fill.from[0];
    }
    EXPECT_EQ(from[4], 2U) << "in the same place";
    EXPECT_EQ(from[5], 3U);
    EXPECT_EQ(from[6], 2U) << "a metre away";
    EXPECT_EQ(from[11], 3U) << "two metres away";
    EXPECT_EQ(from[15], 99U) << "not three";
    for (std::uint32_t v = 4; v < 24; ++v) m.vertices[v].normal[1] = 0, m.vertices[v].normal[0] = 127;
    EXPECT_TRUE(fills_of(m, unknown).empty()) << "they look another way";
}

TEST(VertexFills, AreNoneWhereAllOrNothingIsKnown) {
    const model::Model m = strip(3, false);
    EXPECT_TRUE(fills_of(m, {}).empty());
    EXPECT_TRUE(fills_of(m, {0, 1, 2, 3, 4, 5, 6, 7}).empty());
}

TEST(Fog, IsOnAllThatIsDrawnBoxesIncluded) {
    importer::Scene scene = bake::small_town();
    scene.fog_visibility_m = 150;
    bake::BakeOptions options;
    auto m = bake::bake(scene, options, {});
    ASSERT_TRUE(m.ok());
    EXPECT_EQ(m->light.fog_visibility_m, 150);
    std::size_t pictures = 0;
    for (const model::Representation& rep : m->reps) {
        pictures += rep.kind == model::RepKind::textured_box ? 1 : 0;
        EXPECT_NE(rep.effects & model::effect_fog, 0U);
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
            EXPECT_NE(m->materials[m->parts[p].material].effects & model::effect_fog, 0U);
    }
    EXPECT_GT(pictures, 0U);
    EXPECT_TRUE(m->effects[8].called_for);
    EXPECT_NE(m->effects[8].reason.find("one sees 150 m far"), std::string::npos) << m->effects[8].reason;
    options.fog_visibility_m = 0;
    m = bake::bake(scene, options, {});
    ASSERT_TRUE(m.ok());
    EXPECT_FALSE(m->effects[8].called_for) << "the option counts more than the scene";
    EXPECT_EQ(m->effects[8].reason, "the scene names no fog");
    options.fog_visibility_m = 80;
    m = bake::bake(scene, options, {});
    ASSERT_TRUE(m.ok());
    EXPECT_EQ(m->light.fog_visibility_m, 80);
}

}  // namespace
}  // namespace surefoot
