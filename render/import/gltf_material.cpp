// glTF materials, textures and pictures to a Scene's.

#include <cmath>
#include <map>

#include <fmt/format.h>

#include "render/image/image.hpp"
#include "render/import/finish.hpp"
#include "render/import/gltf_parts.hpp"

namespace surefoot::importer {
namespace {

double number_of(const tinygltf::Value& object, const char* key, double otherwise) {
    if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return otherwise;
    return object.Get(key).GetNumberAsDouble();
}

std::vector<double> numbers_of(const tinygltf::Value& object, const char* key) {
    std::vector<double> out;
    if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsArray()) return out;
    const tinygltf::Value& array = object.Get(key);
    for (int i = 0; i < static_cast<int>(array.ArrayLen()); ++i) {
        if (array.Get(i).IsNumber()) out.push_back(array.Get(i).GetNumberAsDouble());
    }
    return out;
}

/// A texture reference, from the core material or from an extension's JSON.
struct Reference {
    int texture = -1, set = 0;
    tinygltf::Value transform;
};

Reference core_reference(const tinygltf::TextureInfo& info) {
    Reference reference{info.index, info.texCoord, {}};
    if (const auto found = info.extensions.find("KHR_texture_transform"); found != info.extensions.end())
        reference.transform = found->second;
    return reference;
}

Reference extension_reference(const tinygltf::Value& info) {
    Reference reference;
    reference.texture = static_cast<int>(number_of(info, "index", -1));
    reference.set = static_cast<int>(number_of(info, "texCoord", 0));
    if (info.IsObject() && info.Has("extensions") && info.Get("extensions").Has("KHR_texture_transform")) {
        reference.transform = info.Get("extensions").Get("KHR_texture_transform");
    }
    return reference;
}

TextureUse use_of(const Reference& reference) {
    TextureUse use;
    use.set = static_cast<int>(number_of(reference.transform, "texCoord", reference.set));
    use.rotation_rad = static_cast<float>(number_of(reference.transform, "rotation", 0));
    if (const auto offset = numbers_of(reference.transform, "offset"); offset.size() == 2)
        use.offset = vec2(offset[0], offset[1]);
    if (const auto scale = numbers_of(reference.transform, "scale"); scale.size() == 2) use.scale = vec2(scale[0], scale[1]);
    return use;
}

/// Decodes each picture that a base colour asks for, once a way of wrapping.
class Pictures {
public:
    Pictures(const tinygltf::Model& model, const std::string& file, Scene& scene) : model_(model), file_(file), scene_(scene) {}

    Index of_texture(int texture, Material& material) {
        if (texture < 0) return none;
        if (static_cast<std::size_t>(texture) >= model_.textures.size())
            return missing(material, fmt::format("texture {} does not exist", texture));
        const tinygltf::Texture& wanted = model_.textures[static_cast<std::size_t>(texture)];
        if (wanted.source < 0 || static_cast<std::size_t>(wanted.source) >= model_.images.size())
            return missing(material, fmt::format("texture {} {}", texture, why_no_picture(wanted)));
        const bool clamp = clamps(wanted.sampler);
        const auto [found, added] = done_.try_emplace(std::pair(wanted.source, clamp));
        if (added) {
            found->second = decode(wanted.source);
            if (found->second.image != none) scene_.images[found->second.image].clamp = clamp;
        }
        return picture_for(material, found->second);
    }

private:
    Index missing(Material& material, const std::string& why) {
        scene_.warnings.push_back(fmt::format("Material '{}' is left white: {}", material.name, why));
        material.lacks.push_back(scene_.warnings.back());
        return none;
    }

    static std::string why_no_picture(const tinygltf::Texture& wanted) {
        for (const auto& [extension, kind] :
             {std::pair{"KHR_texture_basisu", "KTX2"}, {"EXT_texture_webp", "WebP"}, {"MSFT_texture_dds", "DDS"}}) {
            if (wanted.extensions.contains(extension))
                return fmt::format("has only a {} picture, which is not read; convert it to PNG or JPEG", kind);
        }
        return "has no picture that can be read";
    }

    [[nodiscard]] bool clamps(int sampler) const {
        if (sampler < 0 || static_cast<std::size_t>(sampler) >= model_.samplers.size()) return false;
        const tinygltf::Sampler& s = model_.samplers[static_cast<std::size_t>(sampler)];
        return s.wrapS == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE && s.wrapT == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    }

    Picture decode(int source) {
        const tinygltf::Image& image = model_.images[static_cast<std::size_t>(source)];
        if (!image.uri.empty()) return load_texture(scene_, file_, decode_uri(image.uri));
        const std::string name = image.name.empty() ? fmt::format("image {}", source) : image.name;
        return add_picture(scene_, name, image::decode_image(encoded(image), file_ + ": " + name));
    }

    /// Views of images were checked by load_gltf.
    [[nodiscard]] std::span<const std::byte> encoded(const tinygltf::Image& image) const {
        if (image.bufferView < 0) return std::as_bytes(std::span(image.image));
        const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(image.bufferView)];
        const auto& buffer = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
        return std::as_bytes(std::span(buffer).subspan(view.byteOffset, view.byteLength));
    }

    const tinygltf::Model& model_;
    const std::string& file_;
    Scene& scene_;
    std::map<std::pair<int, bool>, Picture> done_;
};

void set_colour(Material& material, const std::vector<double>& linear) {
    if (linear.size() != 4) return;
    for (std::size_t c = 0; c < 3; ++c) material.colour[c] = image::encode_srgb(static_cast<float>(linear[c]));
    material.colour[3] = std::clamp(static_cast<float>(linear[3]), 0.0F, 1.0F);
}

/// Extras `water`: true or false.
std::optional<bool> water_of(const tinygltf::Material& from, const std::string& name, Scene& scene) {
    if (!from.extras.IsObject() || !from.extras.Has("water")) return {};
    const tinygltf::Value& value = from.extras.Get("water");
    if (value.IsBool()) return value.Get<bool>();
    scene.warnings.push_back(fmt::format("Material '{}': the extra 'water' is not true or false; it is left out", name));
    return {};
}

/// Extras `light`: "flat", "vertex" or "pixel".
LightPlace light_place_of(const tinygltf::Material& from, const std::string& name, Scene& scene) {
    if (!from.extras.IsObject() || !from.extras.Has("light")) return LightPlace::by_bake;
    const tinygltf::Value& value = from.extras.Get("light");
    const std::string word = value.IsString() ? value.Get<std::string>() : "";
    if (word == "flat") return LightPlace::flat;
    if (word == "vertex") return LightPlace::vertex;
    if (word == "pixel") return LightPlace::pixel;
    scene.warnings.push_back(
        fmt::format("Material '{}': the extra 'light' is left out. Set it to flat, vertex or pixel, or remove it", name));
    return LightPlace::by_bake;
}

/// KHR_materials_emissive_strength included. What is unlit shows its colour as it is, and glows no further.
void read_emission(const tinygltf::Material& from, Material& material, Scene& scene) {
    if (material.unlit || from.emissiveFactor.size() != 3) return;
    double strength = 1;
    if (const auto found = from.extensions.find("KHR_materials_emissive_strength"); found != from.extensions.end())
        strength = number_of(found->second, "emissiveStrength", 1);
    const bool broken = !std::isfinite(strength) || strength < 0;
    if (broken) strength = 1;
    const auto& factor = from.emissiveFactor;
    if (set_emission(material, strength * dvec3(factor[0], factor[1], factor[2])) || broken)
        scene.warnings.push_back(
            fmt::format("Material '{}': its emission is not finite, negative or too strong; it is taken as "
                        "{:.3g}, {:.3g}, {:.3g}",
                        material.name, material.emission.r, material.emission.g, material.emission.b));
    material.emission_image = from.emissiveTexture.index >= 0 && material.emission != vec3(0);
    if (material.emission_image) material.emission = vec3(0);
}

}  // namespace

vec2 TextureUse::apply(vec2 uv) const {
    const vec2 scaled = uv * scale;
    const float c = std::cos(rotation_rad), s = std::sin(rotation_rad);
    return offset + vec2(c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y);
}

std::vector<TextureUse> read_materials(const tinygltf::Model& model, const std::string& file, Scene& scene,
                                       const Progress& progress) {
    std::vector<TextureUse> uses;
    Pictures pictures(model, file, scene);
    for (std::size_t i = 0; i < model.materials.size(); ++i) {
        const tinygltf::Material& from = model.materials[i];
        Material material;
        material.name = from.name.empty() ? fmt::format("material {}", i) : from.name;
        set_colour(material, from.pbrMetallicRoughness.baseColorFactor);
        Reference reference = core_reference(from.pbrMetallicRoughness.baseColorTexture);
        if (const auto old = from.extensions.find("KHR_materials_pbrSpecularGlossiness"); old != from.extensions.end()) {
            set_colour(material, numbers_of(old->second, "diffuseFactor"));
            if (old->second.Has("diffuseTexture")) reference = extension_reference(old->second.Get("diffuseTexture"));
        }
        material.image = pictures.of_texture(reference.texture, material);
        material.alpha = from.alphaMode == "MASK"    ? model::AlphaMode::mask
                         : from.alphaMode == "BLEND" ? model::AlphaMode::blend
                                                     : model::AlphaMode::opaque;
        material.alpha_cutoff = static_cast<float>(from.alphaCutoff);
        material.two_sided = from.doubleSided;
        material.unlit = from.extensions.contains("KHR_materials_unlit");
        material.water = water_of(from, material.name, scene);
        material.light = light_place_of(from, material.name, scene);
        read_emission(from, material, scene);
        scene.materials.push_back(std::move(material));
        uses.push_back(use_of(reference));
        progress.update("textures", static_cast<double>(i + 1) / static_cast<double>(model.materials.size()));
    }
    scene.materials.push_back(Material{.name = "default"});
    uses.emplace_back();
    return uses;
}

}  // namespace surefoot::importer
