// Lights and glow of glTF files: the sun, lamps of both kinds, what is wrong with them, very many of them, and emission.
#include <gtest/gtest.h>

#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "render/import/gltf_parts.hpp"
#include "tests/import/fixtures.hpp"

namespace surefoot::importer::test {
namespace {

constexpr double pi = std::numbers::pi;

/// A triangle and nodes with these lights, each as JSON; light i belongs to node i + 1, turned by `rotation`.
TriangleGltf with_lights(const std::string& lights, std::size_t count, const std::string& rotation = "[-0.5,0,0,0.8660254]") {
    TriangleGltf gltf;
    gltf.nodes = R"([{"mesh":0,"name":"thing"})";
    gltf.scenes = R"([{"nodes":[0)";
    for (std::size_t i = 0; i < count; ++i) {
        gltf.nodes += R"(,{"name":"lamp","rotation":)" + rotation + R"(,"extensions":{"KHR_lights_punctual":{"light":)" +
                      std::to_string(i) + "}}}";
        gltf.scenes += "," + std::to_string(i + 1);
    }
    gltf.nodes += "]";
    gltf.scenes += "]}]";
    gltf.more = R"(,"extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[)" + lights + "]}}";
    return gltf;
}

TEST(GltfLights, TheBrightestDistantOneIsTheSunAndLampsAreKept) {
    const Scene scene = import_good(with_lights(
        R"({"type":"directional","intensity":2,"name":"moon"},{"type":"directional","intensity":5,"name":"noon"},
           {"type":"directional","intensity":5,"name":"later"},{"type":"point","name":"bulb"},{"type":"point"})",
        5));
    ASSERT_TRUE(scene.sun.has_value());
    EXPECT_EQ(scene.sun->name, "noon");
    EXPECT_EQ(scene.sun->intensity, 5);
    EXPECT_NEAR(scene.sun->towards.y, std::sqrt(3.0) / 2, 1e-6);  // -Z turned down by 60 degrees
    EXPECT_NEAR(scene.sun->towards.z, 0.5, 1e-6);
    ASSERT_EQ(scene.lamps.size(), 2U);
    EXPECT_EQ(scene.lamps[0].name, "bulb");
    EXPECT_EQ(scene.lamps[1].name, "lamp") << "of its node";
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_FALSE(import_good({}).sun.has_value());
}

TEST(GltfLights, BrokenOnesAreNamedAndTheSceneIsReadAllTheSame) {
    const Scene dark = import_good(
        with_lights(R"({"type":"directional","intensity":-1,"name":"hole"},{"type":"directional","intensity":0})", 3));
    EXPECT_FALSE(dark.sun.has_value());
    EXPECT_TRUE(warns(dark, "Light 'hole' is ignored: its intensity is -1"));
    EXPECT_TRUE(warns(dark, "light 2 does not exist"));
    TriangleGltf odd = with_lights(R"({"type":"directional"})", 1);
    for (const char* number : {"1e300", "0.5", "-1", "\"0\""}) {
        TriangleGltf one = odd;
        const std::string known = R"("light":0)";
        one.nodes.replace(one.nodes.find(known), known.size(), R"("light":)" + std::string(number));
        const Scene scene = import_good(one);
        EXPECT_FALSE(scene.sun.has_value()) << number;
        EXPECT_TRUE(warns(scene, "does not exist")) << number;
    }
    const Scene night = import_good(with_lights(R"({"type":"directional","name":"set"})", 1, "[0.5,0,0,0.8660254]"));
    EXPECT_FALSE(night.sun.has_value());
    EXPECT_TRUE(warns(night, "Light 'set' is ignored: it shines from below the horizon"));
    std::string many = R"({"type":"directional"})";
    for (int i = 0; i < 499; ++i) many += R"(,{"type":"point"})";
    EXPECT_EQ(import_good(with_lights(many, 500)).lamps.size(), 499U);
}

TEST(GltfLights, APointLampStandsWhereItsNodeIsAndHasItsColourIntensityAndRange) {
    TriangleGltf gltf = with_lights(R"({"type":"point","name":"bulb","color":[1,0.5,0.25],"intensity":40,"range":12})", 1);
    gltf.nodes = R"([{"mesh":0,"name":"thing"},{"translation":[100,2,3],"scale":[2,2,2],"children":[2]},
                     {"translation":[1,0.5,0],"scale":[0,0,0],"extensions":{"KHR_lights_punctual":{"light":0}}}])";
    gltf.scenes = R"([{"nodes":[0,1]}])";
    const Scene scene = import_good(gltf);
    ASSERT_EQ(scene.lamps.size(), 1U);
    const Lamp& lamp = scene.lamps[0];
    EXPECT_EQ(lamp.at, dvec3(102, 3, 3)) << "the scale of nodes moves it";
    EXPECT_EQ(lamp.colour, vec3(1, 0.5F, 0.25F));
    EXPECT_EQ(lamp.candela, 40);
    EXPECT_EQ(lamp.range_m, 12) << "the scale of nodes does not change its light";
    EXPECT_FALSE(lamp.spot());
    EXPECT_EQ(lamp.cos_inner, -1);
    EXPECT_EQ(lamp.cos_outer, -1);
    EXPECT_TRUE(scene.warnings.empty());
    const Scene plain = import_good(with_lights(R"({"type":"point"})", 1));
    ASSERT_EQ(plain.lamps.size(), 1U);
    EXPECT_EQ(plain.lamps[0].colour, vec3(1));
    EXPECT_EQ(plain.lamps[0].candela, 1);
    EXPECT_EQ(plain.lamps[0].range_m, 0);
}

TEST(GltfLights, ASpotShinesAlongMinusZOfItsNode) {
    const std::string lights = R"({"type":"spot","spot":{"innerConeAngle":0.3,"outerConeAngle":0.6}},{"type":"spot","spot":{}})";
    const Scene scene = import_good(with_lights(lights, 2, "[-0.5,0,0,0.8660254]"));
    ASSERT_EQ(scene.lamps.size(), 2U);
    EXPECT_TRUE(scene.lamps[0].spot());
    EXPECT_NEAR(scene.lamps[0].towards.y, -std::sqrt(3.0) / 2, 1e-6);  // turned down by 60 degrees
    EXPECT_NEAR(scene.lamps[0].towards.z, -0.5, 1e-6);
    EXPECT_NEAR(glm::length(scene.lamps[0].towards), 1, 1e-12);
    EXPECT_NEAR(scene.lamps[0].cos_inner, std::cos(0.3), 1e-12);
    EXPECT_NEAR(scene.lamps[0].cos_outer, std::cos(0.6), 1e-12);
    EXPECT_NEAR(scene.lamps[1].cos_inner, 1, 1e-12);
    EXPECT_NEAR(scene.lamps[1].cos_outer, std::cos(pi / 4), 1e-9);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfLights, ALampThatIsOffIsNoneAndNoFault) {
    const Scene scene = import_good(with_lights(R"({"type":"point","intensity":0},{"type":"point","color":[0,0,0]})", 2));
    EXPECT_TRUE(scene.lamps.empty());
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfLights, AFaultOfALampIsNamedAndMendedOrTheLampIsLeftOut) {
    struct Case {
        const char *light, *warning;
        std::size_t lamps;
    };
    for (const Case& c : {
             Case{R"({"type":"point","name":"a","intensity":-3})", "Light 'a' is ignored: its intensity is -3", 0},
             Case{R"({"type":"point","name":"a","intensity":1e300})", "Light 'a': its intensity of 1e+300 cd is taken", 1},
             Case{R"({"type":"point","name":"a","color":[1,-1,0.5]})", "Light 'a': its colour", 1},
             Case{R"({"type":"point","name":"a","color":[1,1]})", "Light 'a': its colour", 1},
             Case{R"({"type":"point","name":"a","color":[-1,0,0]})", "Light 'a': its colour", 0},
             Case{R"({"type":"point","name":"a","range":-2})", "Light 'a': its range of -2 m is taken as no limit", 1},
             Case{R"({"type":"area","name":"a"})", "Light 'a' is ignored: its type 'area' is unknown", 0},
             Case{R"({"type":"spot","name":"a","spot":{"innerConeAngle":0.7,"outerConeAngle":0.5}})", "Light 'a': its cone", 1},
             Case{R"({"type":"spot","name":"a","spot":{"innerConeAngle":-0.7}})", "Light 'a': its cone", 1},
             Case{R"({"type":"spot","name":"a","spot":{"outerConeAngle":2}})", "Light 'a': its cone", 1},
             Case{R"({"type":"spot","name":"a","spot":{"outerConeAngle":0}})", "Light 'a': its cone", 1},
         }) {
        const Scene scene = import_good(with_lights(c.light, 1));
        EXPECT_EQ(scene.warnings.size(), 1U) << c.light;
        EXPECT_TRUE(warns(scene, c.warning)) << c.light << ": " << (scene.warnings.empty() ? "" : scene.warnings[0]);
        ASSERT_EQ(scene.lamps.size(), c.lamps) << c.light;
        EXPECT_EQ(scene.triangles(), 1U);
        EXPECT_TRUE(scene.damage.empty());
        if (scene.lamps.empty()) continue;
        const Lamp& lamp = scene.lamps[0];
        EXPECT_TRUE(lamp.candela > 0 && lamp.candela <= 1e12) << c.light;
        EXPECT_GE(lamp.range_m, 0) << c.light;
        for (int i = 0; i < 3; ++i) EXPECT_TRUE(lamp.colour[i] >= 0 && lamp.colour[i] <= 1) << c.light;
        EXPECT_TRUE(!lamp.spot() || (lamp.cos_inner >= lamp.cos_outer && lamp.cos_inner <= 1)) << c.light;
    }
}

TEST(GltfLights, AColourAboveOneGivesTheSameLightAndIsNoFault) {
    const Scene scene = import_good(with_lights(R"({"type":"point","color":[4,2,0],"intensity":10})", 1));
    ASSERT_EQ(scene.lamps.size(), 1U);
    EXPECT_EQ(scene.lamps[0].colour, vec3(1, 0.5F, 0));
    EXPECT_EQ(scene.lamps[0].candela, 40);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfLights, AnyByteChangedGivesSoundLampsOrNone) {
    const std::string whole =
        with_lights(R"({"type":"spot","color":[1,0.5,1],"range":9,"intensity":3,"spot":{"innerConeAngle":0.1}},{"type":"point"})",
                    2)
            .file();
    const Folder folder;
    std::size_t read = 0;
    for (std::size_t i = whole.find(R"("lights":[)"); i < whole.find("]}}"); ++i) {
        for (const char bits : {'\x01', '\x08', '\x20', '\xff'}) {
            std::string changed = whole;
            changed[i] = static_cast<char>(changed[i] ^ bits);
            const auto scene = import_files({folder.write("changed.glb", changed)}, {});
            if (!scene.ok()) continue;
            read += scene->lamps.empty() ? 0 : 1;
            for (const Lamp& lamp : scene->lamps) {
                EXPECT_TRUE(lamp.candela > 0 && std::isfinite(lamp.candela) && lamp.range_m >= 0) << i;
                EXPECT_TRUE(std::isfinite(glm::length(lamp.at)) && std::abs(glm::length(lamp.towards) - 1) < 1e-9) << i;
                EXPECT_TRUE(!lamp.spot() || (lamp.cos_inner >= lamp.cos_outer && lamp.cos_inner <= 1)) << i;
            }
        }
    }
    EXPECT_GT(read, 100U);
}

/// JSON knows no NaN: the reader is asked without a file.
TEST(GltfLights, NumbersThatAreNoneAreRefusedWhereverTheyStand) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    const auto read = [](const auto& change, const dmat4& world = dmat4(1.0)) {
        tinygltf::Model model;
        model.lights.emplace_back();
        tinygltf::Light& light = model.lights[0];
        light.type = "spot";
        light.name = "odd";
        light.color = {1, 1, 1};
        change(light);
        tinygltf::Node node;
        node.extensions["KHR_lights_punctual"] = tinygltf::Value(tinygltf::Value::Object{{"light", tinygltf::Value(0)}});
        Scene scene;
        LightReader reader(model, scene);
        reader.add(node, world);
        reader.finish();
        return scene;
    };
    const auto nothing = [](tinygltf::Light&) {};
    EXPECT_EQ(read(nothing).lamps.size(), 1U);
    for (const double bad : {nan, inf, -inf}) {
        const Scene dark = read([&](tinygltf::Light& l) { l.intensity = bad; });
        EXPECT_TRUE(dark.lamps.empty() && warns(dark, "Light 'odd' is ignored: its intensity is"));
        const Scene tinted = read([&](tinygltf::Light& l) { l.color[1] = bad; });
        ASSERT_EQ(tinted.lamps.size(), 1U);
        EXPECT_EQ(tinted.lamps[0].colour, vec3(1, 0, 1));
        EXPECT_TRUE(warns(tinted, "colour"));
        const Scene far = read([&](tinygltf::Light& l) { l.range = bad; });
        ASSERT_EQ(far.lamps.size(), 1U);
        EXPECT_EQ(far.lamps[0].range_m, 0);
        EXPECT_TRUE(warns(far, "range"));
        const Scene wide = read([&](tinygltf::Light& l) { l.spot.outerConeAngle = l.spot.innerConeAngle = bad; });
        ASSERT_EQ(wide.lamps.size(), 1U);
        EXPECT_NEAR(wide.lamps[0].cos_outer, std::cos(pi / 4), 1e-12);
        EXPECT_TRUE(warns(wide, "cone"));
        dmat4 moved(1.0), turned(1.0);
        moved[3].y = bad;
        turned[2].x = bad;
        EXPECT_TRUE(read(nothing, moved).lamps.empty() && warns(read(nothing, moved), "its place is not finite"));
        EXPECT_TRUE(read(nothing, turned).lamps.empty() && warns(read(nothing, turned), "its direction"));
    }
    dmat4 flat(1.0), beyond(1.0);
    flat[2] = dvec4(0);
    beyond[3].x = 1e13;
    EXPECT_TRUE(read(nothing, flat).lamps.empty() && warns(read(nothing, flat), "its direction has a length of 0"));
    EXPECT_TRUE(read(nothing, beyond).lamps.empty() && warns(read(nothing, beyond), "beyond 1e12 m"));
}

TEST(GltfLights, OfTooManyTheBrightestAreKeptInOrderAndTheOthersCounted) {
    std::string many;
    const int count = 20000;
    for (int i = 0; i < count; ++i)  // every 7th is ten times as bright, and all of these are alike
        many += fmt::format(R"({}{{"type":"point","name":"{}","intensity":{}}})", i == 0 ? "" : ",", i, i % 7 == 0 ? 10 : 1);
    const Scene scene = import_good(with_lights(many, count));
    ASSERT_EQ(scene.lamps.size(), max_lamps);
    std::size_t next = 0, bright = 0;
    for (const Lamp& lamp : scene.lamps) {
        const std::size_t number = std::stoul(lamp.name);
        EXPECT_GE(number, next) << "in the file's order";
        next = number + 1;
        bright += number % 7 == 0 ? 1 : 0;
    }
    EXPECT_EQ(bright, 2858U) << "all of the bright ones";
    EXPECT_EQ(scene.lamps[1].name, "1") << "of those that are alike the first";
    EXPECT_EQ(scene.warnings.size(), 1U);
    EXPECT_TRUE(warns(scene, "15904 lamps are left out"));
    EXPECT_TRUE(warns(scene, ". Let fewer and brighter lamps give the same light")) << "what to do";
}

/// As a file of them is read, node by node; many_lamps_test.cpp has the file.
TEST(GltfLights, AMillionTakeTheMemoryOfThoseThatAreKept) {
    tinygltf::Model model;
    model.lights.resize(2);
    for (tinygltf::Light& light : model.lights) light.type = "point", light.color = {1, 1, 1};
    model.lights[1].intensity = 10;
    std::array<tinygltf::Node, 2> nodes;
    for (int i = 0; i < 2; ++i)
        nodes[static_cast<std::size_t>(i)].extensions["KHR_lights_punctual"] =
            tinygltf::Value(tinygltf::Value::Object{{"light", tinygltf::Value(i)}});
    Scene scene;
    LightReader reader(model, scene);
    constexpr std::size_t million = 1'000'000, kept_bytes = 1'000 * max_lamps;
    const auto held_bytes = [] { return mallinfo2().uordblks + mallinfo2().hblkhd; };  // large blocks are counted apart
    const std::size_t before = held_bytes();
    for (std::size_t i = 0; i < million; ++i) reader.add(nodes[i % 1000 == 0 ? 1 : 0], dmat4(1.0));
    EXPECT_LT(held_bytes(), before + kept_bytes);
    reader.finish();
    ASSERT_EQ(scene.lamps.size(), max_lamps);
    EXPECT_EQ(std::count_if(scene.lamps.begin(), scene.lamps.end(), [](const Lamp& l) { return l.candela == 10; }), 1000);
    ASSERT_EQ(scene.warnings.size(), 1U);
    EXPECT_TRUE(warns(scene, "995904 lamps are left out"));
}

TEST(GltfLights, TheColourCountsForHowBrightALampIs) {
    Lamp blue{.name = "blue", .colour = {0, 0, 1}, .candela = 20}, green{.name = "green", .colour = {0, 1, 0}, .candela = 10};
    EXPECT_LT(brightness(blue), brightness(green));
}

TEST(GltfLights, ManyBadOnesGiveOneWarningOfEachKind) {
    std::string many;
    for (int i = 0; i < 1000; ++i)
        many +=
            fmt::format(R"({}{{"type":"point","name":"{}","{}":-1}})", i == 0 ? "" : ",", i, i % 2 == 0 ? "range" : "intensity");
    const Scene scene = import_good(with_lights(many, 1000));
    EXPECT_EQ(scene.lamps.size(), 500U);
    EXPECT_EQ(scene.warnings.size(), 2U);
    EXPECT_TRUE(warns(scene, "Light '0': its range of -1 m is taken as no limit; 499 others are like it"));
    EXPECT_TRUE(warns(scene, "Light '1' is ignored: its intensity is -1; 499 others are like it"));
}

TEST(GltfLights, LampsOfSeveralFilesAreOneListAndNeverTooMany) {
    Scene all;
    for (const int round : {0, 1}) {
        Scene scene;
        for (std::size_t i = 0; i < 3000; ++i) scene.lamps.push_back(Lamp{.name = "x", .candela = round + 1.0});
        append(all, std::move(scene));
    }
    ASSERT_EQ(all.lamps.size(), max_lamps);
    EXPECT_EQ(std::count_if(all.lamps.begin(), all.lamps.end(), [](const Lamp& l) { return l.candela == 2; }), 3000);
    EXPECT_TRUE(warns(all, "1904 lamps are left out"));
}

TEST(GltfLights, AStandInBringsNoLampsOfItsOwn) {
    TriangleGltf gltf = with_lights(R"({"type":"point","name":"near"},{"type":"point","range":-1,"name":"copy"})", 2);
    gltf.nodes = R"([{"mesh":0,"name":"thing","extras":{"stand_ins":"far"}},
                     {"name":"a","extensions":{"KHR_lights_punctual":{"light":0}}},
                     {"mesh":0,"name":"far","extensions":{"KHR_lights_punctual":{"light":1}}}])";
    const Scene scene = import_good(gltf);
    ASSERT_EQ(scene.stand_ins.size(), 1U);
    ASSERT_EQ(scene.lamps.size(), 1U);
    EXPECT_EQ(scene.lamps[0].name, "near");
    EXPECT_TRUE(warns(scene, "Light 'copy': its range"));
}

TriangleGltf with_material(const std::string& material, const std::string& more = "") {
    TriangleGltf gltf;
    gltf.primitive += R"(,"material":0)";
    gltf.more = R"(,"materials":[{"name":"m",)" + material + "}]" + more;
    return gltf;
}

TEST(GltfEmission, FactorTimesStrength) {
    EXPECT_EQ(import_good({}).materials[0].emission, vec3(0));
    const Scene plain = import_good(with_material(R"("emissiveFactor":[1,0.5,0])"));
    EXPECT_EQ(plain.materials[0].emission, vec3(1, 0.5F, 0));
    const Scene strong = import_good(with_material(
        R"("emissiveFactor":[1,0.5,0],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8}})",
        R"(,"extensionsUsed":["KHR_materials_emissive_strength"],"extensionsRequired":["KHR_materials_emissive_strength"])"));
    EXPECT_EQ(strong.materials[0].emission, vec3(8, 4, 0));
    EXPECT_TRUE(plain.warnings.empty() && strong.warnings.empty());
    const Scene unlit = import_good(with_material(R"("emissiveFactor":[1,1,1],"extensions":{"KHR_materials_unlit":{}})"));
    EXPECT_EQ(unlit.materials[0].emission, vec3(0));
}

TEST(GltfEmission, FaultsAreNamedAndMended) {
    const Scene negative = import_good(with_material(R"("emissiveFactor":[1,-1,0])"));
    EXPECT_EQ(negative.materials[0].emission, vec3(1, 0, 0));
    EXPECT_TRUE(warns(negative, "Material 'm': its emission"));
    for (const char* strength : {"-2", "1e300"}) {
        const Scene scene = import_good(
            with_material(R"("emissiveFactor":[1,1,1],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":)" +
                          std::string(strength) + "}}"));
        EXPECT_TRUE(warns(scene, "Material 'm': its emission")) << strength;
        EXPECT_TRUE(scene.materials[0].emission.r >= 1 && scene.materials[0].emission.r <= 1e10F) << strength;
    }
}

TEST(GltfEmission, WhatAnImageSpreadsIsLeftOutAndNamedOnce) {
    TriangleGltf gltf = with_material(R"("emissiveFactor":[1,1,1],"emissiveTexture":{"index":0})");
    gltf.more.insert(
        gltf.more.find(']', gltf.more.find("\"index\"")),
        R"(,{"name":"n","emissiveFactor":[1,1,1],"emissiveTexture":{"index":0}},{"name":"o","emissiveTexture":{"index":0}})");
    const Scene scene = import_good(gltf);
    EXPECT_EQ(scene.materials[0].emission, vec3(0)) << "a picture that is dark but for a few lights is the usual one";
    EXPECT_TRUE(scene.materials[0].emission_image && scene.materials[1].emission_image);
    EXPECT_FALSE(scene.materials[2].emission_image) << "times a factor of 0";
    ASSERT_EQ(scene.warnings.size(), 1U);
    EXPECT_TRUE(warns(scene, "Material 'm': its glow is left out"));
    EXPECT_TRUE(warns(scene, "so is that of 1 other"));
    EXPECT_TRUE(scene.damage.empty());
}

/// Of a scene whose extras are these.
Scene with_extras(const std::string& extras) {
    TriangleGltf gltf;
    gltf.scenes = R"([{"nodes":[0],"extras":)" + extras + "}]";
    return import_good(gltf);
}

TEST(GltfFog, IsTheScenesExtraIfThatIsANumberOfMetres) {
    EXPECT_EQ(import_good({}).fog_visibility_m, 0);
    EXPECT_EQ(with_extras(R"({"fog_visibility_m":120.5})").fog_visibility_m, 120.5);
    EXPECT_EQ(with_extras(R"({"fog_visibility_m":90})").fog_visibility_m, 90);
    EXPECT_TRUE(with_extras(R"({"fog_visibility_m":0})").warnings.empty());
    EXPECT_TRUE(with_extras(R"({"author":"me"})").warnings.empty());
    EXPECT_TRUE(with_extras(R"("foggy")").warnings.empty()) << "no object";
    for (const char* wrong : {R"("thick")", "-5", "1e9", "true", "[100]"}) {
        const Scene scene = with_extras(R"({"fog_visibility_m":)" + std::string(wrong) + "}");
        EXPECT_EQ(scene.fog_visibility_m, 0) << wrong;
        EXPECT_TRUE(warns(scene, "Scene: the extra 'fog_visibility_m' is no number of 0 to 1e7 metres; there is no fog"))
            << wrong;
        EXPECT_TRUE(scene.damage.empty());
    }
}

TEST(GltfFog, OfSeveralFilesTheThickestStays) {
    for (const bool thick_first : {true, false}) {
        Scene all, thick, thin;
        thick.fog_visibility_m = 50;
        thin.fog_visibility_m = 500;
        append(all, Scene{});
        append(all, Scene(thick_first ? thick : thin));
        append(all, Scene(thick_first ? thin : thick));
        append(all, Scene{});
        EXPECT_EQ(all.fog_visibility_m, 50);
    }
}

TEST(GltfSky, IsTheScenesExtraIfThatIsTrueOrFalse) {
    EXPECT_FALSE(import_good({}).sky);
    EXPECT_TRUE(with_extras(R"({"sky":true})").sky);
    EXPECT_TRUE(with_extras(R"({"sky":true,"fog_visibility_m":90})").warnings.empty());
    EXPECT_FALSE(with_extras(R"({"sky":false})").sky);
    EXPECT_TRUE(with_extras(R"({"sky":false})").warnings.empty());
    EXPECT_FALSE(with_extras(R"("sky")").sky) << "no object";
    for (const char* wrong : {R"("blue")", "1", "[true]"}) {
        const Scene scene = with_extras(R"({"sky":)" + std::string(wrong) + "}");
        EXPECT_FALSE(scene.sky) << wrong;
        EXPECT_TRUE(warns(scene, "Scene: the extra 'sky' is left out. Set it to true or false, or remove it")) << wrong;
        EXPECT_TRUE(scene.damage.empty());
    }
    EXPECT_FALSE(with_extras(R"({"sky":null})").sky);
}

TEST(GltfSky, OfOneFileIsThereForAll) {
    for (const bool first : {true, false}) {
        Scene all, open, closed;
        open.sky = true;
        append(all, Scene(first ? open : closed));
        append(all, Scene(first ? closed : open));
        EXPECT_TRUE(all.sky);
    }
}

TEST(GltfWater, IsWhatAMaterialsExtraSays) {
    const auto of = [](const std::string& extras) {
        TriangleGltf gltf;
        gltf.primitive += R"(,"material":0)";
        gltf.more = R"(,"materials":[{"name":"pond",)" + extras + R"("doubleSided":true}])";
        return import_good(gltf);
    };
    EXPECT_EQ(of(R"("extras":{"water":true},)").materials[0].water, true);
    EXPECT_EQ(of(R"("extras":{"water":false},)").materials[0].water, false);
    EXPECT_EQ(of("").materials[0].water, std::nullopt);
    EXPECT_TRUE(of(R"("extras":{"wet":1},)").warnings.empty());
    const Scene wrong = of(R"("extras":{"water":"deep"},)");
    EXPECT_EQ(wrong.materials[0].water, std::nullopt);
    EXPECT_TRUE(warns(wrong, "Material 'pond': the extra 'water' is not true or false"));
}

TEST(GltfLightPlace, IsWhatAMaterialsExtraSays) {
    const auto of = [](const std::string& extras) {
        TriangleGltf gltf;
        gltf.primitive += R"(,"material":0)";
        gltf.more = R"(,"materials":[{"name":"column",)" + extras + R"("doubleSided":true}])";
        return import_good(gltf);
    };
    EXPECT_EQ(of(R"("extras":{"light":"pixel"},)").materials[0].light, LightPlace::pixel);
    EXPECT_EQ(of(R"("extras":{"light":"vertex"},)").materials[0].light, LightPlace::vertex);
    EXPECT_EQ(of(R"("extras":{"light":"flat"},)").materials[0].light, LightPlace::flat);
    EXPECT_EQ(of("").materials[0].light, LightPlace::by_bake);
    EXPECT_TRUE(of(R"("extras":{"light":"flat"},)").warnings.empty());
    for (const char* wrong : {R"("Pixel")", R"("bright")", "true", "4", R"(["pixel"])"}) {
        const Scene scene = of(R"("extras":{"light":)" + std::string(wrong) + "},");
        EXPECT_EQ(scene.materials[0].light, LightPlace::by_bake) << wrong;
        EXPECT_TRUE(
            warns(scene, "Material 'column': the extra 'light' is left out. Set it to flat, vertex or pixel, or remove it"))
            << wrong;
        EXPECT_TRUE(scene.damage.empty());
    }
}

// A tent: both of its sides have the ridge's two vertices.
TEST(GltfLightPlace, FlatGivesEachTriangleItsOwnNormal) {
    const auto of = [](const std::string& light) {
        TriangleGltf gltf;
        gltf.positions = {0, 1, 0, 0, 1, 1, 1, 0, 0};
        gltf.primitive += R"(,"material":0)";
        gltf.attributes += R"(,"NORMAL":2)";
        gltf.accessors = R"(,{"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"})";
        gltf.views = R"(,{"buffer":0,"byteOffset":44,"byteLength":36})";
        put(gltf.bytes, std::vector<float>{0, 1, 0, 0, 1, 0, 0, 1, 0});
        gltf.more = R"(,"materials":[{"extras":{"light":")" + light + R"("}}])";
        return import_good(gltf);
    };
    const auto heights = [](const Scene& scene) {
        std::vector<float> out;
        for (const vec3& n : scene.meshes.at(0).primitives.at(0).normals) out.push_back(n.y);
        return out;
    };
    EXPECT_EQ(heights(of("vertex")), (std::vector<float>{1, 1, 1}));
    const std::vector<float> flat = heights(of("flat"));
    ASSERT_EQ(flat.size(), 3U);
    for (const float y : flat) EXPECT_NEAR(y, std::sqrt(0.5F), 1e-6F);
}

}  // namespace
}  // namespace surefoot::importer::test
