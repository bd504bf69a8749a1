// KHR_lights_punctual: a distant light becomes the scene's sun. Lamps are counted and named, and not used.

#include <cmath>

#include <fmt/format.h>

#include "render/import/gltf_parts.hpp"

namespace surefoot::importer {

namespace {

constexpr const char* extension_name = "KHR_lights_punctual";

/// The light of a node; null: it has none, or one that does not exist.
const tinygltf::Light* light_of(const tinygltf::Model& model, const tinygltf::Node& node, Scene& scene) {
    const auto found = node.extensions.find(extension_name);
    if (found == node.extensions.end() || !found->second.IsObject() || !found->second.Has("light")) return nullptr;
    const tinygltf::Value& value = found->second.Get("light");
    const double number = value.IsNumber() ? value.GetNumberAsDouble() : -1;
    if (number >= 0 && number < static_cast<double>(model.lights.size()) && number == std::floor(number))
        return &model.lights[static_cast<std::size_t>(number)];
    scene.warnings.push_back(fmt::format("Node '{}': light {} does not exist; it is ignored", node.name, number));
    return nullptr;
}

}  // namespace

void LightReader::add(const tinygltf::Node& node, const dmat4& world) {
    const tinygltf::Light* const light = light_of(model_, node, scene_);
    if (light == nullptr) return;
    const std::string name = light->name.empty() ? node.name : light->name;
    if (light->type != "directional") {
        if (lamps_++ == 0) first_lamp_ = name;
        return;
    }
    const dvec3 towards(world[2]);  // it shines along -Z
    const double length = glm::length(towards);
    if (!std::isfinite(light->intensity) || light->intensity < 0 || !std::isfinite(length) || !(length > 0)) {
        scene_.warnings.push_back(
            fmt::format("Light '{}' is ignored: its intensity is {}, and its direction has a length of {:.3g}", name,
                        light->intensity, length));
        return;
    }
    if (!(light->intensity > 0)) return;  // switched off
    if (towards.y <= 0) {
        scene_.warnings.push_back(fmt::format("Light '{}' is ignored: it shines from below the horizon", name));
        return;
    }
    if (scene_.sun && scene_.sun->intensity >= light->intensity) return;
    scene_.sun = Sun{name, towards / length, light->intensity};
}

void LightReader::finish() {
    if (lamps_ == 0) return;
    scene_.warnings.push_back(
        lamps_ == 1 ? fmt::format("The lamp '{}' is not used: only distant lights are", first_lamp_)
                    : fmt::format("{} lamps are not used, '{}' among them: only distant lights are", lamps_, first_lamp_));
}

}  // namespace surefoot::importer
