// KHR_lights_punctual: a distant light becomes the scene's sun; points and spots become its lamps.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "render/import/finish.hpp"
#include "render/import/gltf_parts.hpp"

namespace surefoot::importer {

namespace {

constexpr const char* extension_name = "KHR_lights_punctual";

/// Brighter ones are taken as this: sums of squares of it stay finite in a float.
constexpr double max_candela = 1e12;
/// Exporters write angles as rounded floats.
constexpr double angle_rounding_rad = 1e-5;

bool good(double value) { return std::isfinite(value) && value >= 0; }

}  // namespace

/// The light of a node; null: it has none, or one that does not exist.
const tinygltf::Light* LightReader::light_of(const tinygltf::Node& node) {
    const auto found = node.extensions.find(extension_name);
    if (found == node.extensions.end() || !found->second.IsObject() || !found->second.Has("light")) return nullptr;
    const tinygltf::Value& value = found->second.Get("light");
    const double number = value.IsNumber() ? value.GetNumberAsDouble() : -1;
    if (number >= 0 && number < static_cast<double>(model_.lights.size()) && number == std::floor(number))
        return &model_.lights[static_cast<std::size_t>(number)];
    flawed(Flaw::missing, [&] { return fmt::format("Node '{}': light {} does not exist; it is ignored", node.name, number); });
    return nullptr;
}

void LightReader::add(const tinygltf::Node& node, const dmat4& world) {
    const tinygltf::Light* const light = light_of(node);
    if (light == nullptr) return;
    const std::string& name = light->name.empty() ? node.name : light->name;
    if (light->type == "directional") return add_sun(*light, name, world);
    if (light->type == "point" || light->type == "spot") return add_lamp(*light, name, world);
    flawed(Flaw::kind, [&] { return fmt::format("Light '{}' is ignored: its type '{}' is unknown", name, light->type); });
}

void LightReader::add_sun(const tinygltf::Light& light, const std::string& name, const dmat4& world) {
    const dvec3 towards(world[2]);  // it shines along -Z
    const double length = glm::length(towards);
    if (!good(light.intensity) || !std::isfinite(length) || !(length > 0))
        return flawed(Flaw::sun, [&] {
            return fmt::format("Light '{}' is ignored: its intensity is {}, and its direction has a length of {:.3g}", name,
                               light.intensity, length);
        });
    if (!(light.intensity > 0)) return;  // switched off
    if (towards.y <= 0)
        return flawed(Flaw::horizon,
                      [&] { return fmt::format("Light '{}' is ignored: it shines from below the horizon", name); });
    if (scene_.sun && scene_.sun->intensity >= light.intensity) return;
    scene_.sun = Sun{name, towards / length, light.intensity};
}

void LightReader::add_lamp(const tinygltf::Light& light, const std::string& name, const dmat4& world) {
    Lamp lamp;
    lamp.name = name;
    lamp.at = dvec3(world[3]);
    for (int c = 0; c < 3; ++c) {
        if (!(std::abs(lamp.at[c]) <= farthest_m))
            return flawed(Flaw::place,
                          [&] { return fmt::format("Light '{}' is ignored: its place is not finite, or beyond 1e12 m", name); });
    }
    if (!set_light(light, lamp)) return;
    if (light.type == "spot" && !set_cone(light, world, lamp)) return;
    lamps_.add(std::move(lamp));
}

bool LightReader::set_light(const tinygltf::Light& light, Lamp& lamp) {
    if (!good(light.intensity)) {
        flawed(Flaw::intensity,
               [&] { return fmt::format("Light '{}' is ignored: its intensity is {}", lamp.name, light.intensity); });
        return false;
    }
    dvec3 colour(1);
    bool sound = light.color.empty() || light.color.size() == 3;
    if (light.color.size() == 3) {
        for (int c = 0; c < 3; ++c) {
            colour[c] = light.color[static_cast<std::size_t>(c)];
            if (good(colour[c])) continue;
            colour[c] = 0;
            sound = false;
        }
    }
    if (!sound)
        flawed(Flaw::colour, [&] {
            return fmt::format("Light '{}': its colour is not three numbers of 0 to 1; it is taken as {:.3g}, {:.3g}, {:.3g}",
                               lamp.name, colour.r, colour.g, colour.b);
        });
    // The same light by a colour of 0 to 1.
    const double above = std::max({1.0, colour.r, colour.g, colour.b});
    lamp.colour = vec3(colour / above);
    lamp.candela = std::min(light.intensity * above, max_candela);
    if (light.intensity * above > max_candela)
        flawed(Flaw::intensity, [&] {
            return fmt::format("Light '{}': its intensity of {:.3g} cd is taken as {:.0e} cd", lamp.name, light.intensity * above,
                               max_candela);
        });
    lamp.range_m = good(light.range) ? light.range : 0;
    if (!good(light.range))
        flawed(Flaw::range,
               [&] { return fmt::format("Light '{}': its range of {} m is taken as no limit", lamp.name, light.range); });
    return brightness(lamp) > 0;  // else it is switched off, or black
}

bool LightReader::set_cone(const tinygltf::Light& light, const dmat4& world, Lamp& lamp) {
    const dvec3 towards(-world[2]);  // it shines along -Z
    const double length = glm::length(towards);
    if (!std::isfinite(length) || !(length > 0)) {
        flawed(Flaw::direction,
               [&] { return fmt::format("Light '{}' is ignored: its direction has a length of {:.3g}", lamp.name, length); });
        return false;
    }
    constexpr double largest = 0.5 * std::numbers::pi, usual = 0.25 * std::numbers::pi;
    double inner = light.spot.innerConeAngle, outer = light.spot.outerConeAngle;
    const bool sound =
        good(inner) && good(outer) && outer > 0 && outer <= largest + angle_rounding_rad && inner <= outer + angle_rounding_rad;
    outer = good(outer) && outer > 0 ? std::min(outer, largest) : usual;
    inner = good(inner) ? std::min(inner, outer) : 0;
    if (!sound)
        flawed(Flaw::cone, [&] {
            return fmt::format("Light '{}': its cone of {:.4g} to {:.4g} rad is taken as {:.4g} to {:.4g} rad", lamp.name,
                               light.spot.innerConeAngle, light.spot.outerConeAngle, inner, outer);
        });
    lamp.towards = towards / length;
    lamp.cos_outer = std::max(0.0, std::cos(outer));
    lamp.cos_inner = std::max(lamp.cos_outer, std::cos(inner));
    return true;
}

void LightReader::warn() {
    for (Flawed& flaw : flaws_) {
        if (flaw.count == 2) flaw.first += "; 1 other is like it";
        if (flaw.count > 2) flaw.first += fmt::format("; {} others are like it", flaw.count - 1);
        if (flaw.count > 0) scene_.warnings.push_back(std::move(flaw.first));
        flaw = {};
    }
}

void LightReader::finish() {
    warn();
    keep_brightest(scene_, std::move(lamps_));
}

}  // namespace surefoot::importer
