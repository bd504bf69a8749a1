// What a glTF file has and a walk has not: skins, morph targets and sounds are left out, each by name and with a remedy.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cctype>
#include <string>

#include "tests/import/fixtures.hpp"

namespace surefoot::importer::test {
namespace {

/// Its one warning has this in it, and ends with a sentence that says what to do. All is drawn.
void expect_left_out(const TriangleGltf& gltf, const std::string& what) {
    const Scene scene = import_good(gltf);
    EXPECT_EQ(scene.triangles(), 1U);
    EXPECT_TRUE(scene.damage.empty());
    ASSERT_EQ(scene.warnings.size(), 1U) << what << "; " << (scene.warnings.empty() ? "" : scene.warnings.back());
    const std::string& warning = scene.warnings[0];
    EXPECT_NE(warning.find(what), std::string::npos) << warning;
    const std::size_t stop = warning.rfind(". ");
    ASSERT_NE(stop, std::string::npos) << warning;
    EXPECT_TRUE(stop + 12 < warning.size() && std::isupper(warning[stop + 2]) != 0) << warning;
}

TEST(GltfLeftOut, ASkinIsNamed) {
    TriangleGltf gltf;
    gltf.nodes = R"([{"mesh":0,"name":"guard","skin":0},{"name":"bone"}])";
    gltf.scenes = R"([{"nodes":[0,1]}])";
    gltf.more = R"(,"skins":[{"joints":[1],"inverseBindMatrices":0}])";
    expect_left_out(gltf, "Node 'guard' is taken in its rest pose (skin)");
}

TEST(GltfLeftOut, MorphTargetsAreNamed) {
    TriangleGltf gltf;
    gltf.primitive += R"(,"targets":[{"POSITION":0}])";
    expect_left_out(gltf, "Mesh 'mesh': 1 primitives are taken in their rest shape (morph targets)");
}

TEST(GltfLeftOut, SoundIsNamedByItsExtension) {
    for (const std::string name :
         {"KHR_audio", "KHR_audio_emitter", "KHR_audio_graph", "MSFT_audio_emitter", "OMI_audio_emitter"}) {
        const std::string list = "[\"" + name + "\"]", what = "Sounds are left out (" + name + ")";
        TriangleGltf used, required, unnamed;
        used.more = fmt::format(R"(,"extensionsUsed":{},"extensions":{{"{}":{{"sources":[],"emitters":[]}}}})", list, name);
        required.more = fmt::format(R"(,"extensionsUsed":{0},"extensionsRequired":{0})", list);
        unnamed.more = fmt::format(R"(,"extensions":{{"{}":{{}}}})", name);
        expect_left_out(used, what);
        expect_left_out(required, what);
        expect_left_out(unnamed, what);
    }
    TriangleGltf two;
    two.more = R"(,"extensionsUsed":["MSFT_audio_emitter","KHR_texture_transform","KHR_audio_emitter"])";
    expect_left_out(two, "Sounds are left out (KHR_audio_emitter, MSFT_audio_emitter)");
    TriangleGltf none;
    none.more = R"(,"extensionsUsed":["KHR_texture_transform","VENDOR_audio"],"extensions":7)";
    const auto odd = import_bytes(none.file());
    ASSERT_TRUE(odd.ok());
    EXPECT_TRUE(odd->warnings.empty()) << odd->warnings[0];
}

}  // namespace
}  // namespace surefoot::importer::test
