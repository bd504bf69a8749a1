// A scene as glTF 2.0 binary, written with the same bytes for the same scene.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "render/image/image.hpp"
#include "rt/base/file.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot::scenes {
namespace {

using importer::Index;
using importer::none;
using nlohmann::json;

constexpr int float_type = 5126, ushort_type = 5123, uint_type = 5125;

class GlbWriter {
public:
    explicit GlbWriter(const importer::Scene& scene) : scene_(scene) {
        root_["asset"] = {{"version", "2.0"}, {"generator", "surefoot scene"}};
        root_["scene"] = 0;
    }

    Result<void> write(const std::string& file) {
        images();
        materials();
        meshes();
        nodes();
        root_["buffers"] = json::array({{{"byteLength", binary_.size()}}});
        return save(file);
    }

private:
    std::size_t view(std::span<const std::byte> bytes) {
        const std::size_t offset = binary_.size();
        binary_.insert(binary_.end(), bytes.begin(), bytes.end());
        binary_.resize((binary_.size() + 3) / 4 * 4);
        root_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
        return root_["bufferViews"].size() - 1;
    }

    template <class T>
    std::size_t accessor(const std::vector<T>& values, std::size_t count, int component, const char* type,
                         bool normalized = false) {
        json a{{"bufferView", view(std::as_bytes(std::span(values)))},
               {"componentType", component},
               {"count", count},
               {"type", type}};
        if (normalized) a["normalized"] = true;
        root_["accessors"].push_back(std::move(a));
        return root_["accessors"].size() - 1;
    }

    void images() {
        if (scene_.images.empty()) return;
        root_["samplers"] = json::array({{{"wrapS", 10497}, {"wrapT", 10497}, {"magFilter", 9729}, {"minFilter", 9987}},
                                         {{"wrapS", 33071}, {"wrapT", 33071}, {"magFilter", 9729}, {"minFilter", 9987}}});
        for (std::size_t i = 0; i < scene_.images.size(); ++i) {
            const image::Image& image = scene_.images[i];
            const std::vector<std::uint8_t> png = image::encode_png(image.width, image.height, image.rgba);
            root_["images"].push_back(
                {{"bufferView", view(std::as_bytes(std::span(png)))}, {"mimeType", "image/png"}, {"name", image.name}});
            root_["textures"].push_back({{"source", i}, {"sampler", image.clamp ? 1 : 0}});
        }
    }

    void materials() {
        for (const importer::Material& m : scene_.materials) {
            json pbr{{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}};
            pbr["baseColorFactor"] = {image::decode_srgb(m.colour[0]), image::decode_srgb(m.colour[1]),
                                      image::decode_srgb(m.colour[2]), m.colour[3]};
            if (m.image != none) pbr["baseColorTexture"] = {{"index", m.image}};
            json out{{"name", m.name}, {"pbrMetallicRoughness", std::move(pbr)}, {"doubleSided", m.two_sided}};
            if (m.alpha != model::AlphaMode::opaque) out["alphaMode"] = m.alpha == model::AlphaMode::mask ? "MASK" : "BLEND";
            if (m.alpha == model::AlphaMode::mask) out["alphaCutoff"] = m.alpha_cutoff;
            if (m.unlit) {
                out["extensions"]["KHR_materials_unlit"] = json::object();
                uses("KHR_materials_unlit");
            }
            if (m.emission != vec3(0)) emission(m.emission, out);
            root_["materials"].push_back(std::move(out));
        }
    }

    /// The factor may not be above 1: the rest is its strength.
    void emission(const vec3& light, json& material) {
        const float strength = std::max({light.r, light.g, light.b, 1.0F});
        material["emissiveFactor"] = {light.r / strength, light.g / strength, light.b / strength};
        if (strength == 1.0F) return;
        material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
        uses("KHR_materials_emissive_strength");
    }

    json attributes(const importer::Primitive& p) {
        const std::size_t count = p.positions.size();
        json out;
        out["POSITION"] = accessor(p.positions, count, float_type, "VEC3");
        vec3 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
        for (const vec3& v : p.positions) {
            low = glm::min(low, v);
            high = glm::max(high, v);
        }
        root_["accessors"].back()["min"] = {low.x, low.y, low.z};
        root_["accessors"].back()["max"] = {high.x, high.y, high.z};
        if (!p.normals.empty()) out["NORMAL"] = accessor(p.normals, count, float_type, "VEC3");
        if (!p.uvs.empty()) out["TEXCOORD_0"] = accessor(p.uvs, count, float_type, "VEC2");
        if (p.colours.empty()) return out;
        // Linear, as glTF wants; 16 bits, so that the 8 bits of sRGB come back exactly.
        std::vector<std::uint16_t> linear;
        linear.reserve(count * 4);
        for (const auto& c : p.colours) {
            for (std::size_t i = 0; i < 3; ++i) {
                const float value = image::decode_srgb(static_cast<float>(c[i]) / 255.0F) * 65535.0F;
                linear.push_back(
                    static_cast<std::uint16_t>(value + 0.5F));  // NOLINT(bugprone-incorrect-roundings): never negative
            }
            linear.push_back(static_cast<std::uint16_t>(c[3] * 257));
        }
        out["COLOR_0"] = accessor(linear, count, ushort_type, "VEC4", true);
        return out;
    }

    void meshes() {
        for (const importer::Mesh& mesh : scene_.meshes) {
            json primitives = json::array();
            for (const importer::Primitive& p : mesh.primitives) {
                json out{{"attributes", attributes(p)}, {"material", p.material}};
                if (p.positions.size() < 65536) {
                    const std::vector<std::uint16_t> small(p.indices.begin(), p.indices.end());
                    out["indices"] = accessor(small, small.size(), ushort_type, "SCALAR");
                } else {
                    out["indices"] = accessor(p.indices, p.indices.size(), uint_type, "SCALAR");
                }
                primitives.push_back(std::move(out));
            }
            root_["meshes"].push_back({{"name", mesh.name}, {"primitives", std::move(primitives)}});
        }
    }

    /// A node that shines along its -Z. Lamps that differ in nothing but their place share a light.
    json placed(const importer::Lamp& lamp) {
        json light{{"name", lamp.name},
                   {"type", lamp.spot() ? "spot" : "point"},
                   {"color", {lamp.colour.r, lamp.colour.g, lamp.colour.b}},
                   {"intensity", lamp.candela}};
        if (lamp.range_m > 0) light["range"] = lamp.range_m;
        if (lamp.spot())
            light["spot"] = {{"innerConeAngle", std::acos(lamp.cos_inner)}, {"outerConeAngle", std::acos(lamp.cos_outer)}};
        json& lights = root_["extensions"]["KHR_lights_punctual"]["lights"];
        const auto [known, added] = light_numbers_.try_emplace(light.dump(), lights.size());
        if (added) lights.push_back(std::move(light));
        uses("KHR_lights_punctual");
        json out{{"name", lamp.name}, {"translation", {lamp.at.x, lamp.at.y, lamp.at.z}}};
        if (lamp.spot()) {
            const dquat q = from_forwards(lamp.towards);
            out["rotation"] = {q.x, q.y, q.z, q.w};
        }
        out["extensions"]["KHR_lights_punctual"]["light"] = known->second;
        return out;
    }

    /// Turns -Z to a direction.
    static dquat from_forwards(const dvec3& towards) {
        const dvec3 forwards(0, 0, -1);
        const dquat q(1 + glm::dot(forwards, towards), glm::cross(forwards, towards));
        return glm::length(q) > 1e-9 ? glm::normalize(q) : dquat(0, 0, 1, 0);
    }

    void uses(const char* extension) {
        json& used = root_["extensionsUsed"];
        if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
    }

    void nodes() {
        json roots = json::array(), list = json::array();
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
            const importer::Node& node = scene_.nodes[i];
            const dmat4 local = node.parent == none ? node.world : glm::inverse(scene_.nodes[node.parent].world) * node.world;
            json out{{"name", node.name}};
            if (node.mesh != none) out["mesh"] = node.mesh;
            if (local != dmat4(1.0)) {
                for (int c = 0; c < 4; ++c) {
                    for (int r = 0; r < 4; ++r) out["matrix"].push_back(local[c][r]);
                }
            }
            if (node.importance != 1.0F) out["extras"]["importance"] = node.importance;
            list.push_back(std::move(out));
            if (node.parent == none) {
                roots.push_back(i);
            } else {
                list[node.parent]["children"].push_back(i);
            }
        }
        for (const importer::Lamp& lamp : scene_.lamps) {
            roots.push_back(list.size());
            list.push_back(placed(lamp));
        }
        root_["nodes"] = std::move(list);
        root_["scenes"] = json::array({{{"nodes", std::move(roots)}}});
    }

    Result<void> save(const std::string& file) {
        std::string text = root_.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const std::uint64_t total = 12 + 8 + text.size() + 8 + binary_.size();
        if (total > std::numeric_limits<std::uint32_t>::max())
            return Error{file, "The scene needs more than the 4 GiB that a GLB may have", "Choose a smaller --scale",
                         ErrorKind::out_of_limits};
        std::vector<std::byte> out;
        out.reserve(total);
        const auto word = [&](std::uint64_t value) {
            const auto v = static_cast<std::uint32_t>(value);
            const auto bytes = std::as_bytes(std::span(&v, 1));
            out.insert(out.end(), bytes.begin(), bytes.end());
        };
        word(0x46546c67);
        word(2);
        word(total);
        word(text.size());
        word(0x4e4f534a);
        const auto json_bytes = std::as_bytes(std::span(text));
        out.insert(out.end(), json_bytes.begin(), json_bytes.end());
        word(binary_.size());
        word(0x004e4942);
        out.insert(out.end(), binary_.begin(), binary_.end());
        return write_file(file, out);
    }

    const importer::Scene& scene_;
    json root_;
    std::map<std::string, std::size_t> light_numbers_;  ///< by their JSON
    std::vector<std::byte> binary_;
};

}  // namespace

Result<void> write_glb(const std::string& file, const importer::Scene& scene) { return GlbWriter(scene).write(file); }

}  // namespace surefoot::scenes
