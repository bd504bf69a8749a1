// Wavefront MTL: the colours, opacities and pictures of an OBJ file's materials.
#include "render/import/obj_material.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "render/import/finish.hpp"
#include "render/import/lamps.hpp"
#include "render/import/text_cursor.hpp"
#include "rt/base/file.hpp"

namespace surefoot::importer {
namespace {

struct Reading {
    const std::string& obj_file;
    std::string place;  ///< the library's own file
    Scene& scene;
    std::map<std::string, Picture> pictures;
    Index current = none;
    std::string opacity_map;  ///< of the current material
};

/// Options before the name: -o and -s take one to three numbers, -clamp one word, -bm one number.
std::string texture_name(TextCursor& cursor, bool& clamp) {
    while (true) {
        TextCursor ahead = cursor;
        const std::string_view option = ahead.word();
        if (option.size() < 2 || option[0] != '-') break;
        if (option == "-o" || option == "-s" || option == "-t" || option == "-mm") {
            double ignored = 0;
            while (ahead.number(ignored)) {
            }
        } else {
            const std::string_view value = ahead.word();
            if (option == "-clamp") clamp = value == "on";
        }
        cursor = ahead;
    }
    return std::string(cursor.line_text());
}

Index picture(Reading& reading, Material& material, const std::string& name) {
    const auto [found, added] = reading.pictures.try_emplace(name);
    if (added) found->second = load_texture(reading.scene, reading.place, name);
    return picture_for(material, found->second);
}

/// Masked when nearly every texel is either there or not; blended when many lie between.
model::AlphaMode alpha_of(const image::Image& image) {
    std::size_t clear = 0, between = 0;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) {
        clear += image.rgba[i] < 16 ? 1 : 0;
        between += image.rgba[i] >= 16 && image.rgba[i] < 240 ? 1 : 0;
    }
    if (clear + between == 0) return model::AlphaMode::opaque;
    return between * 4 > clear ? model::AlphaMode::blend : model::AlphaMode::mask;
}

/// A separate picture of opacities goes into the alpha of a copy of the colours (or of plain white).
void merge_opacity(Reading& reading, Material& material, const std::string& name) {
    const Index source = picture(reading, material, name);
    if (source == none) return;
    image::Image merged = reading.scene.images[source];
    bool own_alpha = false;
    for (std::size_t i = 3; i < merged.rgba.size() && !own_alpha; i += 4) own_alpha = merged.rgba[i] != 255;
    const image::Image* colours = material.image == none ? nullptr : &reading.scene.images[material.image];
    if (colours != nullptr && (colours->width != merged.width || colours->height != merged.height)) {
        reading.scene.warnings.push_back(
            fmt::format("Material '{}': map_d '{}' is left out, because its size is not that of map_Kd", material.name, name));
        return;
    }
    for (std::size_t i = 0; i < merged.rgba.size(); i += 4) {
        const std::uint8_t opacity = own_alpha ? merged.rgba[i + 3] : merged.rgba[i];
        for (std::size_t c = 0; c < 3; ++c) merged.rgba[i + c] = colours != nullptr ? colours->rgba[i + c] : std::uint8_t{255};
        merged.rgba[i + 3] = opacity;
    }
    merged.name = material.name + " with opacity";
    reading.scene.images.push_back(std::move(merged));
    material.image = static_cast<Index>(reading.scene.images.size() - 1);
}

void end_material(Reading& reading) {
    if (reading.current == none) return;
    Material& material = reading.scene.materials[reading.current];
    if (!reading.opacity_map.empty()) merge_opacity(reading, material, reading.opacity_map);
    if (material.image != none) material.alpha = alpha_of(reading.scene.images[material.image]);
    if (material.emission_image) material.emission = vec3(0);
    if (material.colour[3] < 1.0F) material.alpha = model::AlphaMode::blend;
    reading.opacity_map.clear();
}

void begin_material(Reading& reading, std::string_view name) {
    end_material(reading);
    Material material;
    material.name = name;
    material.two_sided = true;  // the format says nothing of facing: a back face is better than a hole
    reading.scene.materials.push_back(std::move(material));
    reading.current = static_cast<Index>(reading.scene.materials.size() - 1);
}

void read_colour(TextCursor& cursor, Material& material) {
    std::array<float, 3> c{};
    if (!cursor.number(c[0])) return;  // "spectral" and "xyz" forms: left white
    if (!cursor.number(c[1]) || !cursor.number(c[2])) c[1] = c[2] = c[0];
    for (std::size_t i = 0; i < 3; ++i) material.colour[i] = std::clamp(c[i], 0.0F, 1.0F);
}

/// Linear, for it may be above 1: exporters write colour times strength.
void read_emission(TextCursor& cursor, Material& material, Scene& scene) {
    dvec3 c(0);
    if (!cursor.number(c[0])) return;  // "spectral" and "xyz" forms: it does not glow
    if (!cursor.number(c[1]) || !cursor.number(c[2])) c[1] = c[2] = c[0];
    if (set_emission(material, c))
        scene.warnings.push_back(
            fmt::format("Material '{}': its emission Ke is not finite, negative or too strong; it is taken "
                        "as {:.3g}, {:.3g}, {:.3g}",
                        material.name, material.emission.r, material.emission.g, material.emission.b));
}

void read_statement(Reading& reading, TextCursor& cursor) {
    const std::string_view key = cursor.word();
    if (key == "newmtl") return begin_material(reading, cursor.line_text());
    if (reading.current == none) return;
    Material& material = reading.scene.materials[reading.current];
    float value = 1.0F;
    bool clamp = false;
    if (key == "Kd") {
        read_colour(cursor, material);
    } else if (key == "Ke") {
        read_emission(cursor, material, reading.scene);
    } else if (key == "map_Ke") {
        material.emission_image = true;
    } else if (key == "d") {
        if (cursor.number(value)) material.colour[3] = std::clamp(value, 0.0F, 1.0F);
    } else if (key == "Tr") {
        if (cursor.number(value)) material.colour[3] = std::clamp(1.0F - value, 0.0F, 1.0F);
    } else if (key == "map_Kd") {
        material.image = picture(reading, material, texture_name(cursor, clamp));
        if (material.image != none && clamp) reading.scene.images[material.image].clamp = true;
    } else if (key == "map_d") {
        reading.opacity_map = texture_name(cursor, clamp);
    }
}

}  // namespace

std::string read_mtl(const std::string& obj_file, const std::string& library, Scene& scene) {
    const std::string place = place_beside(obj_file, library);
    const auto plain = require_plain(place);
    auto text = plain ? read_text(place) : plain.error();
    if (!text) {
        scene.warnings.push_back(fmt::format("Materials are left white: {}", in_short(text.error())));
        return scene.warnings.back();
    }
    Reading reading{obj_file, place, scene, {}, none, {}};
    for (TextCursor cursor(*text); !cursor.done(); cursor.next_line()) {
        if (!cursor.at_line_end()) read_statement(reading, cursor);
    }
    end_material(reading);
    return {};
}

}  // namespace surefoot::importer
