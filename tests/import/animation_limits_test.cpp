// Limits on what the tracks of a glTF file take together: a small file names one long buffer by many accessors or at many nodes.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/import/fixtures.hpp"

namespace surefoot::importer::test {
namespace {

constexpr std::size_t max_values = 3U * 65536U;  ///< of an accessor that is read

/// So many nodes that an animation moves: times and values are their own accessors of two shared buffers.
class LongTracks {
public:
    explicit LongTracks(int nodes) : nodes_(nodes) {
        gltf_.nodes = gltf_.scenes = "";
        for (int n = 0; n < nodes; ++n) {
            gltf_.nodes += (n == 0 ? "[" : ",") + std::string(R"({"mesh":0})");
            gltf_.scenes += (n == 0 ? R"([{"nodes":[)" : ",") + std::to_string(n);
        }
        gltf_.nodes += "]";
        gltf_.scenes += "]}]";
        const std::vector<float> times{0, 1, 2}, moves{0, 0, 0, 1, 0, 0, 0, 0, 0};
        const int two = add(view(times), times.size(), "SCALAR"), there = add(view(moves), times.size(), "VEC3");
        for (int n = 0; n < nodes; ++n) channel(n, "translation", two, there);
    }
    /// A view of these bytes.
    int view(const std::vector<float>& values) {
        gltf_.views += fmt::format(R"(,{{"buffer":0,"byteOffset":{},"byteLength":{}}})", 44 + gltf_.bytes.size(),
                                   values.size() * sizeof(float));
        put(gltf_.bytes, values);
        return views_++;
    }
    int add(int view, std::size_t count, const char* type) {
        gltf_.accessors += fmt::format(R"(,{{"bufferView":{},"componentType":5126,"count":{},"type":"{}"}})", view, count, type);
        return accessors_++;
    }
    void channel(int node, const char* path, int in, int out) {
        channels_ += fmt::format(R"({}{{"sampler":{},"target":{{"node":{},"path":"{}"}}}})", samplers_ == 0 ? "" : ",", samplers_,
                                 node, path);
        all_samplers_ += fmt::format(R"({}{{"input":{},"output":{}}})", samplers_ == 0 ? "" : ",", in, out);
        ++samplers_;
    }
    Scene read() {
        gltf_.more = R"(,"animations":[{"name":"all","channels":[)" + channels_ + R"(],"samplers":[)" + all_samplers_ + "]}]";
        Scene scene = import_good(gltf_);
        EXPECT_EQ(scene.nodes.size(), static_cast<std::size_t>(nodes_)) << "all of it is drawn";
        return scene;
    }

private:
    int nodes_;
    TriangleGltf gltf_;
    std::string channels_, all_samplers_;
    int accessors_ = 2, views_ = 2, samplers_ = 0;
};

/// A node moves. So many tracks of scales that stay, each an accessor of its own to the same numbers.
Scene with_scales(int tracks) {
    LongTracks file(1);
    const int in = file.add(file.view({0.0F}), 1, "SCALAR");
    const int ones = file.view(std::vector<float>(3 * max_values, 1.0F));
    for (int i = 0; i < tracks; ++i) file.channel(0, "scale", in, file.add(ones, max_values, "VEC3"));
    return file.read();
}

TEST(AnimationLimits, ScalesHaveATotalOfTheirOwn) {
    const Scene moving = with_scales(42);  // 42 * 196 608 are 8 257 536
    EXPECT_EQ(moving.motions.size(), 1U);
    EXPECT_TRUE(moving.warnings.empty()) << moving.warnings[0];
    const Scene still = with_scales(43);
    EXPECT_TRUE(still.motions.empty());
    ASSERT_EQ(still.warnings.size(), 1U);
    EXPECT_EQ(still.warnings[0],
              "All nodes are drawn at rest: their animations have 8454144 keys of scales, and a file may have 8388608. Export it "
              "with fewer keys a second, or with fewer animated nodes");
}

TEST(AnimationLimits, TimesThatNoValuesFollowCountToo) {
    for (const int nodes : {42, 43}) {
        LongTracks file(nodes);
        const int times = file.view(std::vector<float>(max_values, 1.0F)),
                  few = file.add(file.view({0.0F, 0.0F, 0.0F, 1.0F}), 1, "VEC4");
        for (int n = 0; n < nodes; ++n) file.channel(n, "rotation", file.add(times, max_values, "SCALAR"), few);
        const Scene scene = file.read();
        EXPECT_TRUE(scene.motions.empty());
        ASSERT_EQ(scene.warnings.size(), 1U);
        EXPECT_EQ(warns(scene, "All nodes are drawn at rest: their animations have"), nodes == 43) << scene.warnings[0];
        EXPECT_EQ(warns(scene, "the times and values of its animation do not fit each other"), nodes == 42) << scene.warnings[0];
    }
}

}  // namespace
}  // namespace surefoot::importer::test
