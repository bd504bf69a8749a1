// Small files for import tests: a folder that goes away, and glTF built from JSON and bytes.
#pragma once

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "render/import/scene.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot::importer::test {

struct Folder : surefoot::test::TemporaryFolder {
    std::string file(const std::string& name) const { return *this / name; }
    std::string write(const std::string& name, const std::string& content) const {
        std::ofstream(file(name), std::ios::binary) << content;
        return file(name);
    }
};

/// Appends values as they lie in memory.
template <class T>
void put(std::string& bytes, const std::vector<T>& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

inline std::string word(std::uint32_t value) {
    std::string out(4, '\0');
    std::memcpy(out.data(), &value, 4);
    return out;
}

/// JSON and one binary chunk as GLB.
inline std::string glb(std::string json, std::string bin) {
    while (json.size() % 4 != 0) json += ' ';
    while (bin.size() % 4 != 0) bin += '\0';
    const std::string chunks = word(static_cast<std::uint32_t>(json.size())) + "JSON" + json +
                               word(static_cast<std::uint32_t>(bin.size())) + std::string("BIN\0", 4) + bin;
    return "glTF" + word(2) + word(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

/// A triangle (three float positions at byte 0, three u16 indices at byte 36), `more` inserted at top level of the JSON.
struct TriangleGltf {
    std::string nodes = R"([{"mesh":0,"name":"thing"}])";
    std::string scenes = R"([{"nodes":[0]}])";
    std::string attributes = R"("POSITION":0)";
    std::string primitive = R"(,"indices":1)";
    std::string accessors;  ///< after the two of the triangle
    std::string views;      ///< after the two of the triangle
    std::string more;
    std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::vector<std::uint16_t> indices{0, 1, 2};
    std::string bytes;  ///< after the triangle's, from byte 44

    std::string json() const {
        return R"({"asset":{"version":"2.0"},"scene":0,"scenes":)" + scenes + R"(,"nodes":)" + nodes +
               R"(,"meshes":[{"name":"mesh","primitives":[{"attributes":{)" + attributes + "}" + primitive +
               R"(}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"})" +
               accessors + R"(],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6})" +
               views + R"(],"buffers":[{"byteLength":)" + std::to_string(bin().size()) + "}]" + more + "}";
    }
    std::string bin() const {
        std::string out;
        put(out, positions);
        put(out, indices);
        out.resize(44);
        return out + bytes;
    }
    std::string file() const { return glb(json(), bin()); }
};

inline bool lacks(const Scene& scene, const std::string& part) {
    return std::any_of(scene.damage.begin(), scene.damage.end(),
                       [&](const Damage& d) { return d.what.find(part) != std::string::npos && !d.file.empty(); });
}

inline bool warns(const Scene& scene, const std::string& part) {
    for (const std::string& warning : scene.warnings) {
        if (warning.find(part) != std::string::npos) return true;
    }
    return false;
}

/// Through a file of this name.
inline Result<Scene> import_bytes(const std::string& bytes, const std::string& name = "model.glb") {
    const Folder folder;
    return import_files({folder.write(name, bytes)}, {});
}

/// Of a file that must be readable.
inline Scene import_good(const TriangleGltf& gltf) {
    auto scene = import_bytes(gltf.file());
    EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().text());
    return scene.ok() ? std::move(*scene) : Scene{};
}

/// Where the real data is, if anywhere.
inline std::optional<std::filesystem::path> data_folder() {
    const char* data = std::getenv("SUREFOOT_DATA");
    if (data == nullptr || !std::filesystem::is_directory(data)) return std::nullopt;
    return std::filesystem::path(data);
}

}  // namespace surefoot::importer::test
