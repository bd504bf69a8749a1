// Animations of glTF nodes: what comes in moves as the file says, and what cannot be moved rigidly is named and stands still.
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/import/fixtures.hpp"

namespace surefoot::importer {
namespace {

using test::import_good;
using test::TriangleGltf;
using test::warns;

constexpr float half_root = 0.70710678F;

/// A file of one or more nodes with animations, built channel by channel.
struct AnimatedGltf {
    TriangleGltf gltf;
    std::string channels, samplers, animations;
    int accessors = 2, views = 2, sampler_count = 0;

    int floats(const std::vector<float>& values, int components) {
        const std::size_t at = 44 + gltf.bytes.size();
        test::put(gltf.bytes, values);
        gltf.views += R"(,{"buffer":0,"byteOffset":)" + std::to_string(at) + R"(,"byteLength":)" +
                      std::to_string(values.size() * sizeof(float)) + "}";
        gltf.accessors += R"(,{"bufferView":)" + std::to_string(views++) + R"(,"componentType":5126,"count":)" +
                          std::to_string(values.size() / static_cast<std::size_t>(components)) + R"(,"type":")" +
                          (components == 1   ? "SCALAR"
                           : components == 3 ? "VEC3"
                                             : "VEC4") +
                          R"("})";
        return accessors++;
    }
    AnimatedGltf& channel(int node, const std::string& path, const std::vector<float>& times, const std::vector<float>& values,
                          const std::string& interpolation = "LINEAR") {
        const int in = floats(times, 1), out = floats(values, path == "rotation" ? 4 : path == "weights" ? 1 : 3);
        samplers += (samplers.empty() ? "" : ",") + (R"({"input":)" + std::to_string(in)) + R"(,"output":)" +
                    std::to_string(out) + R"(,"interpolation":")" + interpolation + R"("})";
        channels += (channels.empty() ? "" : ",") + (R"({"sampler":)" + std::to_string(sampler_count++)) +
                    R"(,"target":{"node":)" + std::to_string(node) + R"(,"path":")" + path + R"("}})";
        return *this;
    }
    AnimatedGltf& end(const std::string& name) {
        animations += (animations.empty() ? "" : ",") + (R"({"name":")" + name) + R"(","channels":[)" + channels +
                      R"(],"samplers":[)" + samplers + "]}";
        channels.clear();
        samplers.clear();
        sampler_count = 0;
        return *this;
    }
    Scene read() {
        gltf.more = R"(,"animations":[)" + animations + "]";
        return import_good(gltf);
    }
};

/// Where a point of the node's mesh is at a time.
dvec3 point_at(const Scene& scene, std::size_t node, const dvec3& at, double time_s) {
    model::Model model;
    model.motions = scene.motions;
    model.motion_keys = scene.motion_keys;
    const dvec3 rest(scene.nodes[node].world * dvec4(at, 1));
    return model::pose_at(model, scene.nodes[node].motion, time_s)(rest);
}

void expect_near(const dvec3& a, const dvec3& b, double max_m = 1e-5) {
    EXPECT_LT(glm::length(a - b), max_m) << a.x << " " << a.y << " " << a.z;
}

/// Exactly one warning, which has this in it.
void expect_one_warning(const Scene& scene, const std::string& part) {
    EXPECT_EQ(scene.warnings.size(), 1U);
    EXPECT_TRUE(warns(scene, part)) << (scene.warnings.empty() ? "no warning" : scene.warnings[0]);
}

TEST(GltfAnimation, TranslationMovesBetweenItsKeysAndLoops) {
    const Scene scene = AnimatedGltf().channel(0, "translation", {0, 1, 3}, {0, 0, 0, 0, 2, 0, 0, 0, 0}).end("lift").read();
    ASSERT_EQ(scene.motions.size(), 1U);
    EXPECT_EQ(scene.nodes[0].motion, 0U);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_DOUBLE_EQ(scene.motions[0].period_s, 3);
    for (const double lap : {0.0, 3.0, 300.0}) {
        expect_near(point_at(scene, 0, {1, 0, 0}, lap + 0.5), {1, 1, 0});
        expect_near(point_at(scene, 0, {1, 0, 0}, lap + 1), {1, 2, 0});
        expect_near(point_at(scene, 0, {1, 0, 0}, lap + 2), {1, 1, 0});
    }
}

TEST(GltfAnimation, RotationTurnsAboutTheNodeWhereverItStands) {
    AnimatedGltf file;
    file.gltf.nodes = R"([{"mesh":0,"name":"fan","translation":[10,20,30]}])";
    file.channel(0, "rotation", {0, 1, 2, 3, 4},
                 {0, 0, 0, 1, 0, half_root, 0, half_root, 0, 1, 0, 0, 0, half_root, 0, -half_root, 0, 0, 0, -1});
    const Scene scene = file.end("turn").read();
    ASSERT_EQ(scene.motions.size(), 1U);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    expect_near(scene.motions[0].pivot, {10, 20, 30});
    for (const double t : {0.0, 0.3, 1.0, 1.5, 2.2, 3.9}) {
        const double angle = t * std::numbers::pi / 2;
        expect_near(point_at(scene, 0, {1, 0, 0}, t), dvec3(10 + std::cos(angle), 20, 30 - std::sin(angle)));
    }
}

TEST(GltfAnimation, AStepStaysUntilTheNextKey) {
    const Scene scene =
        AnimatedGltf().channel(0, "translation", {0, 1, 2}, {0, 0, 0, 5, 0, 0, 0, 0, 0}, "STEP").end("door").read();
    ASSERT_EQ(scene.motions.size(), 1U);
    expect_near(point_at(scene, 0, {}, 0.999), {0, 0, 0});
    expect_near(point_at(scene, 0, {}, 1.001), {5, 0, 0});
    expect_near(point_at(scene, 0, {}, 1.999), {5, 0, 0});
    expect_near(point_at(scene, 0, {}, 2.001), {0, 0, 0});
}

TEST(GltfAnimation, ASplineStaysWithinAMillimetreAndATenthOfADegree) {
    // From 0 to 4 m in 2 s and back, with tangents of 0: 2 s^3 - 3 s^2.
    const std::vector<float> moves{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const std::vector<float> turns{0, 0,    0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.6F,
                                   0, 0.8F, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0};
    const Scene scene = AnimatedGltf()
                            .channel(0, "translation", {0, 2, 4}, moves, "CUBICSPLINE")
                            .channel(0, "rotation", {0, 2, 4}, turns, "CUBICSPLINE")
                            .end("ease")
                            .read();
    ASSERT_EQ(scene.motions.size(), 1U);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    model::Model model;
    model.motions = scene.motions;
    model.motion_keys = scene.motion_keys;
    for (int i = 0; i <= 1000; ++i) {
        const double t = 0.004 * i, s = t < 2 ? t / 2 : 2 - t / 2, share = s * s * (3 - 2 * s);
        const model::RigidPose pose = model::pose_at(model, 0, t == 4 ? 0 : t);
        EXPECT_LT(std::abs(pose.translation.x - (t == 4 ? 0 : 4 * share)), 1e-3) << t;
        const dquat true_turn = glm::normalize(dquat(1 - 0.2 * share, 0, 0.6 * share, 0));
        const double off = 2 * std::acos(std::min(1.0, std::abs(glm::dot(pose.rotation, true_turn))));
        EXPECT_LT(t == 4 ? 0 : off, 0.1 * std::numbers::pi / 180) << t;
    }
    EXPECT_LT(scene.motion_keys.size(), 300U);
}

TEST(GltfAnimation, WhatIsBelowMovesAlongAndMotionsCarryEachOther) {
    AnimatedGltf file;
    file.gltf.nodes = R"([{"name":"arm","children":[1,2],"translation":[5,0,0]},
        {"mesh":0,"name":"hand","translation":[1,0,0],"children":[3]},{"mesh":0,"name":"sleeve"},{"mesh":0,"name":"ring"}])";
    file.channel(0, "translation", {0, 1, 2}, {5, 0, 0, 5, 3, 0, 5, 0, 0}).end("rise");
    file.channel(1, "rotation", {0, 1, 2, 3, 4},
                 {0, 0, 0, 1, 0, half_root, 0, half_root, 0, 1, 0, 0, 0, half_root, 0, -half_root, 0, 0, 0, -1});
    const Scene scene = file.end("spin").read();
    ASSERT_EQ(scene.motions.size(), 2U);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    const auto node = [&](const std::string& name) {
        for (std::size_t n = 0; n < scene.nodes.size(); ++n)
            if (scene.nodes[n].name == name) return n;
        return std::size_t{999};
    };
    EXPECT_EQ(scene.nodes[node("sleeve")].motion, 0U);
    EXPECT_EQ(scene.nodes[node("ring")].motion, scene.nodes[node("hand")].motion);
    EXPECT_EQ(scene.motions[1].outer, 0U);
    for (const double t : {0.0, 0.5, 1.3, 2.7, 5.1}) {
        const double up = 3 * (1 - std::abs(std::fmod(t, 2.0) - 1)), angle = t * std::numbers::pi / 2;
        expect_near(point_at(scene, node("sleeve"), {}, t), {5, up, 0});
        expect_near(point_at(scene, node("hand"), {1, 0, 0}, t), dvec3(6 + std::cos(angle), up, -std::sin(angle)));
        expect_near(point_at(scene, node("ring"), {1, 0, 0}, t), dvec3(6 + std::cos(angle), up, -std::sin(angle)));
    }
}

TEST(GltfAnimation, AMirroredAndScaledParentMovesItAsTheFileSays) {
    AnimatedGltf file;
    file.gltf.nodes =
        R"([{"name":"mirror","children":[1],"scale":[-2,2,2],"rotation":[0,0.6,0,0.8]},{"mesh":0,"name":"thing","scale":[1,3,1]}])";
    file.channel(1, "rotation", {0, 1, 2}, {0, 0, 0, 1, half_root, 0, 0, half_root, 0, 0, 0, 1});
    file.channel(1, "translation", {0, 1, 2}, {0, 0, 0, 1, 2, 3, 0, 0, 0});
    const Scene scene = file.end("move").read();
    ASSERT_EQ(scene.motions.size(), 1U);
    const dmat4 parent = scene.nodes[0].world;
    for (const double t : {0.0, 0.25, 0.5, 1.0}) {
        const dquat turn = glm::angleAxis(t * std::numbers::pi / 2, dvec3(1, 0, 0));
        const dvec3 at(0.2, 0.4, 0.1), local = turn * (at * dvec3(1, 3, 1)) + t * dvec3(1, 2, 3);
        expect_near(point_at(scene, 1, at, t), dvec3(parent * dvec4(local, 1)), 1e-4);
    }
}

TEST(GltfAnimation, AllPlayAtOnceEachWithItsPeriodFromItsFirstKey) {
    AnimatedGltf file;
    file.gltf.nodes = R"([{"mesh":0,"name":"a"},{"mesh":0,"name":"b"}])";
    file.gltf.scenes = R"([{"nodes":[0,1]}])";
    file.channel(0, "translation", {1, 2, 3}, {0, 0, 0, 1, 0, 0, 0, 0, 0}).end("first");
    file.channel(1, "translation", {0, 2.5F, 5}, {0, 0, 0, 1, 0, 0, 0, 0, 0}).end("second");
    const Scene scene = file.read();
    ASSERT_EQ(scene.motions.size(), 2U);
    EXPECT_DOUBLE_EQ(scene.motions[0].period_s, 2);
    EXPECT_DOUBLE_EQ(scene.motions[1].period_s, 5);
    expect_near(point_at(scene, 0, {}, 0.5), {0.5, 0, 0});
}

TEST(GltfAnimation, OneThatDoesNotLoopIsPlayedForthAndBackWithAllThatItMoves) {
    AnimatedGltf file;
    file.gltf.nodes = R"([{"mesh":0,"name":"gate"},{"mesh":0,"name":"light"}])";
    file.gltf.scenes = R"([{"nodes":[0,1]}])";
    file.channel(0, "translation", {0, 2}, {0, 0, 0, 4, 0, 0});
    file.channel(1, "translation", {0, 1, 2}, {0, 0, 0, 0, 1, 0, 0, 0, 0});
    const Scene scene = file.end("open").read();
    expect_one_warning(scene, "Animation 'open' does not end where it began (node 'gate')");
    EXPECT_DOUBLE_EQ(scene.motions[0].period_s, 4);
    EXPECT_DOUBLE_EQ(scene.motions[1].period_s, 4);
    expect_near(point_at(scene, 0, {}, 1.5), {3, 0, 0});
    expect_near(point_at(scene, 0, {}, 3), {2, 0, 0});
    expect_near(point_at(scene, 1, {}, 3), {0, 1, 0});
}

/// The period of a node whose way of 2 s ends `off` units from where it began, below parents of that scale together.
double period_below(double scale, float off) {
    AnimatedGltf file;
    file.gltf.nodes = R"([{"name":"top","children":[1],"scale":[2,2,2]},{"name":"parent","children":[2],"scale":[)" +
                      fmt::format("{0},{0},{0}", scale / 2) + R"(]},{"mesh":0,"name":"thing"}])";
    file.channel(2, "translation", {0, 1, 2}, {0, 0, 0, 4, 0, 0, off, 0, 0});
    const Scene scene = file.end("way").read();
    EXPECT_EQ(scene.warnings.size(), scene.motions.size() == 1 && scene.motions[0].period_s == 4 ? 1U : 0U);
    return scene.motions.empty() ? 0 : scene.motions[0].period_s;
}

TEST(GltfAnimation, ALoopIsJudgedInMetresOfTheWorld) {
    EXPECT_DOUBLE_EQ(period_below(1, 0.0005F), 2);
    EXPECT_DOUBLE_EQ(period_below(1, 0.002F), 4);
    EXPECT_DOUBLE_EQ(period_below(0.01, 0.05F), 2) << "half a millimetre in a file of centimetres";
    EXPECT_DOUBLE_EQ(period_below(0.01, 0.2F), 4);
    EXPECT_DOUBLE_EQ(period_below(100, 0.0005F), 4) << "it would jump by 5 cm";
}

TEST(GltfAnimation, WhatStaysAtRestHasNoMotion) {
    AnimatedGltf file;
    file.gltf.nodes = R"([{"mesh":0,"name":"post","translation":[1,2,3],"scale":[2,2,2]}])";
    file.channel(0, "translation", {0, 1, 2}, {1, 2, 3, 1, 2, 3, 1, 2, 3}).channel(0, "rotation", {0}, {0, 0, 0, 1});
    file.channel(0, "scale", {0, 2}, {2, 2, 2, 2, 2, 2});
    const Scene scene = file.end("export").read();
    EXPECT_TRUE(scene.motions.empty());
    EXPECT_TRUE(scene.motion_keys.empty());
    EXPECT_EQ(scene.nodes[0].motion, none);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
}

TEST(GltfAnimation, BonesAndCamerasAreNoMotions) {
    AnimatedGltf file;
    file.gltf.nodes = R"([{"mesh":0,"name":"thing"},{"name":"bone"}])";
    file.gltf.scenes = R"([{"nodes":[0,1]}])";
    file.channel(1, "scale", {0, 1}, {1, 1, 1, 2, 2, 2}).channel(1, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
    const Scene scene = file.end("walk").read();
    EXPECT_TRUE(scene.motions.empty());
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
}

/// What one bad animation is refused for; a second node's good one is kept.
struct Refused {
    const char* name;
    const char* warning;
    void (*make)(AnimatedGltf&);
    const char* nodes = R"([{"mesh":0,"name":"bad"},{"mesh":0,"name":"good"}])";
};

/// A warning's last sentence says what to do: it begins with a capital after a full stop.
bool ends_with_a_remedy(const std::string& warning) {
    const std::size_t stop = warning.rfind(". ");
    return stop != std::string::npos && stop + 12 < warning.size() && std::isupper(warning[stop + 2]) != 0;
}

class RefusedAnimation : public testing::TestWithParam<Refused> {};

TEST_P(RefusedAnimation, IsNamedAndTheNodeStandsStill) {
    AnimatedGltf file;
    file.gltf.nodes = GetParam().nodes;
    file.gltf.scenes = R"([{"nodes":[0,1]}])";
    GetParam().make(file);
    if (!file.channels.empty()) file.end("bad one");
    const Scene scene = file.channel(1, "translation", {0, 1, 2}, {0, 0, 0, 1, 0, 0, 0, 0, 0}).end("good one").read();
    ASSERT_GE(scene.nodes.size(), 2U);
    expect_one_warning(scene, GetParam().warning);
    for (const std::string& warning : scene.warnings) EXPECT_TRUE(ends_with_a_remedy(warning)) << warning;
    EXPECT_TRUE(scene.damage.empty());
    for (const Node& node : scene.nodes) EXPECT_EQ(node.motion == none, node.name != "good") << node.name;
    EXPECT_EQ(scene.motions.size(), 1U);
}

constexpr float no_number = std::numeric_limits<float>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Each, RefusedAnimation,
    testing::Values(
        Refused{"Scale", "Node 'bad' is drawn at rest: its animation changes its scale",
                [](AnimatedGltf& f) {
                    f.channel(0, "scale", {0, 1, 2}, {1, 1, 1, 2, 2, 2, 1, 1, 1});
                }},
        Refused{"ScaleBesideMotion", "Node 'bad' is drawn at rest: its animation changes its scale",
                [](AnimatedGltf& f) {
                    f.channel(0, "translation", {0, 1, 2}, {0, 0, 0, 1, 0, 0, 0, 0, 0});
                    f.channel(0, "scale", {0, 1, 2}, {1, 1, 1, 2, 2, 2, 1, 1, 1});
                }},
        Refused{"Weights", "Node 'bad' is drawn at rest: its animation changes weights of morph targets",
                [](AnimatedGltf& f) {
                    f.channel(0, "weights", {0, 1}, {0, 1});
                }},
        Refused{"Number", "Node 'bad' is drawn at rest: a number of its animation is not finite",
                [](AnimatedGltf& f) {
                    f.channel(0, "translation", {0, 1, 2}, {0, 0, 0, no_number, 0, 0, 0, 0, 0});
                }},
        Refused{"Time", "Node 'bad' is drawn at rest: a number of its animation is not finite",
                [](AnimatedGltf& f) {
                    f.channel(0, "translation", {0, no_number, 2}, {0, 0, 0, 1, 0, 0, 0, 0, 0});
                }},
        Refused{"Far", "Node 'bad' is drawn at rest: its animation leads beyond 1e12 m",
                [](AnimatedGltf& f) {
                    f.channel(0, "translation", {0, 1, 2}, {0, 0, 0, 1e13F, 0, 0, 0, 0, 0});
                }},
        Refused{"Quaternion", "Node 'bad' is drawn at rest: a rotation of its animation is no quaternion",
                [](AnimatedGltf& f) {
                    f.channel(0, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 0, 0});
                }},
        Refused{"Length", "Node 'bad' is drawn at rest: the times and values of its animation do not fit each other",
                [](AnimatedGltf& f) {
                    f.channel(0, "translation", {0, 1, 2}, {0, 0, 0, 1, 0, 0});
                }},
        Refused{"Accessor", "Node 'bad' is drawn at rest: an accessor of its animation is missing",
                [](AnimatedGltf& f) {
                    f.channels = R"({"sampler":0,"target":{"node":0,"path":"translation"}})";
                    f.samplers = R"({"input":77,"output":78})";
                }},
        Refused{"Node", "Animation 'bad one': a channel is ignored, since its node or sampler does not exist",
                [](AnimatedGltf& f) {
                    f.channel(7, "translation", {0, 1, 2}, {0, 0, 0, 1, 0, 0, 0, 0, 0});
                }},
        Refused{"Sampler", "Animation 'bad one': a channel is ignored, since its node or sampler does not exist",
                [](AnimatedGltf& f) {
                    f.channel(0, "translation", {0, 1, 2}, {0, 0, 0, 1, 0, 0, 0, 0, 0});
                    f.channels = R"({"sampler":5,"target":{"node":0,"path":"translation"}})";
                }},
        Refused{"NoTime", "Animation 'bad one' is ignored: it lasts 0 s",
                [](AnimatedGltf& f) {
                    f.channel(0, "translation", {1, 1}, {0, 0, 0, 1, 0, 0});
                }},
        Refused{"ForEver", "Animation 'bad one' is ignored: it lasts 1e+07 s",
                [](AnimatedGltf& f) {
                    f.channel(0, "translation", {0, 1, 1e7F}, {0, 0, 0, 1, 0, 0, 0, 0, 0});
                }},
        Refused{"ManyKeys", "Node 'bad' is drawn at rest: its animation has more than 65536 keys",
                [](AnimatedGltf& f) {
                    std::vector<float> times(70000), values(210000, 0.0F);
                    for (std::size_t i = 0; i < times.size(); ++i) times[i] = static_cast<float>(i);
                    values[3000] = 1;
                    f.channel(0, "translation", times, values);
                }},
        Refused{"Matrix", "Node 'bad' is drawn at rest: it is animated, and has a matrix",
                [](AnimatedGltf& f) {
                    f.channel(0, "translation", {0, 1, 2}, {0, 0, 0, 1, 0, 0, 0, 0, 0});
                },
                R"([{"mesh":0,"name":"bad","matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]},{"mesh":0,"name":"good"}])"},
        Refused{"Shear", "Node 'bad' is drawn at rest: its rotation would shear it",
                [](AnimatedGltf& f) {
                    f.channel(2, "rotation", {0, 1, 2}, {0, 0, 0, 1, 0, 0.6F, 0, 0.8F, 0, 0, 0, 1});
                },
                R"([{"name":"long","scale":[1,1,4],"children":[2]},{"mesh":0,"name":"good"},{"mesh":0,"name":"bad"}])"},
        Refused{"Pointer", "Node 'bad' is drawn at rest: its animation changes 'pointer'",
                [](AnimatedGltf& f) {
                    f.channel(0, "pointer", {0, 1}, {0, 0, 0, 1, 0, 0});
                }},
        Refused{"Empty", "Animation 'bad one' is ignored: it has no channels", [](AnimatedGltf& f) { f.end("bad one"); }},
        Refused{"Taken", "is ignored at node 'good'",
                [](AnimatedGltf& f) {
                    f.channel(1, "translation", {0, 3, 9}, {0, 0, 0, 0, 1, 0, 0, 0, 0}).end("first one");
                }}),
    [](const auto& one) { return std::string(one.param.name); });

TEST(GltfAnimation, TheFirstOfTwoForANodeWins) {
    const Scene scene = AnimatedGltf()
                            .channel(0, "translation", {0, 1, 2}, {0, 0, 0, 1, 0, 0, 0, 0, 0})
                            .end("first")
                            .channel(0, "rotation", {0, 1, 2}, {0, 0, 0, 1, 0, 0.6F, 0, 0.8F, 0, 0, 0, 1})
                            .end("second")
                            .read();
    expect_one_warning(scene, "Animation 'second' is ignored at node 'thing': 'first' moves it already");
    expect_near(point_at(scene, 0, {1, 0, 0}, 1), {2, 0, 0});
}

TEST(GltfAnimation, KeysOutOfOrderAreSortedAndOddRotationsNormalized) {
    const Scene scene = AnimatedGltf()
                            .channel(0, "translation", {2, 0, 1}, {0, 0, 0, 0, 0, 0, 4, 0, 0})
                            .channel(0, "rotation", {0, 1, 2}, {0, 0, 0, 5, 0, 1.8F, 0, 2.4F, 0, 0, 0, 1})
                            .end("mixed")
                            .read();
    EXPECT_EQ(scene.warnings.size(), 2U);
    EXPECT_TRUE(warns(scene, "Node 'thing': the keys of its animation are out of order; they are sorted"));
    EXPECT_TRUE(warns(scene, "Node 'thing': rotations of its animation have not the length 1; they are normalized"));
    const double angle = 2 * std::atan2(0.6, 0.8);
    expect_near(point_at(scene, 0, {1, 0, 0}, 1), dvec3(4 + std::cos(angle), 0, -std::sin(angle)));
    expect_near(point_at(scene, 0, {}, 0.5), {2, 0, 0});
}

TEST(GltfAnimation, ManyOfAKindAreOneWarning) {
    AnimatedGltf file;
    file.gltf.nodes = R"([{"mesh":0,"name":"a"},{"mesh":0,"name":"b"},{"mesh":0,"name":"c"}])";
    file.gltf.scenes = R"([{"nodes":[0,1,2]}])";
    for (int n = 0; n < 3; ++n) file.channel(n, "scale", {0, 1}, {1, 1, 1, 2, 2, 2});
    expect_one_warning(file.end("grow").read(),
                       "Node 'a' is drawn at rest: its animation changes its scale; 2 others are like it");
}

/// As many nodes, all with one sampler of as many keys.
AnimatedGltf one_track_of_many(int nodes, std::size_t keys, const std::string& path = "translation",
                               const std::string& interpolation = "LINEAR") {
    AnimatedGltf file;
    std::string names, all, roots;
    for (int n = 0; n < nodes; ++n) {
        roots += (n == 0 ? "" : ",") + std::to_string(n);
        names += (n == 0 ? "[" : ",") + std::string(R"({"mesh":0})");
        all += (n == 0 ? "" : ",") + std::string(R"({"sampler":0,"target":{"node":)") + std::to_string(n) + R"(,"path":")" +
               path + R"("}})";
    }
    file.gltf.nodes = names + "]";
    file.gltf.scenes = R"([{"nodes":[)" + roots + "]}]";
    const std::size_t each = interpolation == "CUBICSPLINE" ? 3 : 1;
    std::vector<float> times(keys), values(3 * each * keys, path == "scale" ? 1.0F : 0.0F);
    for (std::size_t k = 0; k < keys; ++k) times[k] = static_cast<float>(k);
    if (path == "translation") values[each == 3 ? 12 : 3] = 1;
    file.channel(0, path, times, values, interpolation);
    file.channels = all;
    file.end("all of them");
    file.gltf.more = R"(,"animations":[)" + file.animations + "]";
    return file;
}

TEST(GltfAnimation, ALongTrackOfVeryManyNodesStandsStillAndIsNamedWithItsTotal) {
    // A file of 8 MB, whose tracks would be 4 GB.
    const auto at_rest = test::import_bytes(one_track_of_many(100'000, 1000).gltf.file());
    ASSERT_TRUE(at_rest.ok()) << at_rest.error().text();
    EXPECT_EQ(at_rest->nodes.size(), 100'000U) << "all of it is drawn";
    EXPECT_TRUE(at_rest->motions.empty());
    EXPECT_TRUE(at_rest->motion_keys.empty());
    ASSERT_EQ(at_rest->warnings.size(), 1U);
    EXPECT_EQ(at_rest->warnings[0],
              "All nodes are drawn at rest: their animations have 100000000 keys, and a file may have 8388608. Export it with "
              "fewer keys a second, or with fewer animated nodes");
    EXPECT_EQ(import_good(one_track_of_many(100, 1000).gltf).motions.size(), 100U);
}

TEST(GltfAnimation, OnlyKeysThatAreKeptCountForTheTotal) {
    // As many values as are too many: scales that stay, tangents, and nodes with a matrix.
    EXPECT_TRUE(import_good(one_track_of_many(9'000, 1000, "scale").gltf).warnings.empty());
    AnimatedGltf spline = one_track_of_many(1, 21'000, "translation", "CUBICSPLINE");  // one node has it 140 times
    const std::string channel = R"({"sampler":0,"target":{"node":0,"path":"translation"}})";
    const std::size_t at = spline.gltf.more.find(channel);
    for (int i = 1; i < 140; ++i) spline.gltf.more.insert(at, channel + ",");
    const Scene moving = import_good(spline.gltf);
    EXPECT_EQ(moving.motions.size(), 1U);
    AnimatedGltf file = one_track_of_many(9'000, 1000);
    file.gltf.nodes = "[";
    for (int n = 0; n < 9'000; ++n)
        file.gltf.nodes += (n == 0 ? "" : ",") + std::string(R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]})");
    file.gltf.nodes += "]";
    expect_one_warning(import_good(file.gltf), "it is animated, and has a matrix; 8999 others are like it");
}

TEST(GltfAnimation, ASceneThatIsAppendedKeepsItsMotions) {
    const auto make = [](float height) {
        return AnimatedGltf().channel(0, "translation", {0, 1, 2}, {0, 0, 0, 0, height, 0, 0, 0, 0}).end("rise").read();
    };
    Scene both = make(1);
    append(both, make(5));
    ASSERT_EQ(both.motions.size(), 2U);
    ASSERT_EQ(both.nodes.size(), 2U);
    expect_near(point_at(both, 0, {}, 1), {0, 1, 0});
    expect_near(point_at(both, 1, {}, 1), {0, 5, 0});
}

TEST(GltfAnimation, AnyByteOfItChangedNeverCrashes) {
    AnimatedGltf file;
    file.channel(0, "translation", {0, 1, 2}, {0, 0, 0, 1, 0, 0, 0, 0, 0}, "CUBICSPLINE");
    file.channel(0, "rotation", {0, 1, 2}, {0, 0, 0, 1, 0, 0.6F, 0, 0.8F, 0, 0, 0, 1});
    file.end("all");
    file.gltf.more = R"(,"animations":[)" + file.animations + "]";
    const std::string good = file.gltf.file();
    for (std::size_t i = 0; i < good.size(); ++i) {
        std::string bad = good;
        bad[i] = static_cast<char>(bad[i] ^ 0x11);
        const auto read = test::import_bytes(bad);
        if (!read.ok()) continue;
        for (const Node& node : read->nodes) EXPECT_TRUE(node.motion == none || node.motion < read->motions.size());
    }
}

}  // namespace
}  // namespace surefoot::importer
