// Materials, textures with mip levels, baked colours, and what the scene calls for.
#include "render/bake/materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "render/bake/alpha_bleed.hpp"
#include "render/bake/mask_coverage.hpp"
#include "render/effects/effects.hpp"

namespace surefoot::bake {

namespace {

std::vector<std::uint8_t> halve(std::span<const std::uint8_t> rgba, std::uint32_t w, std::uint32_t h) {
    const std::uint32_t nw = std::max(1U, w / 2), nh = std::max(1U, h / 2);
    std::vector<std::uint8_t> out(static_cast<std::size_t>(nw) * nh * 4);
    for (std::uint32_t y = 0; y < nh; ++y) {
        for (std::uint32_t x = 0; x < nw; ++x) {
            std::uint32_t alpha = 0;
            std::array<std::uint32_t, 3> sum{}, plain{};
            for (std::uint32_t k = 0; k < 4; ++k) {
                const std::uint32_t sx = std::min(w - 1, 2 * x + (k & 1U)), sy = std::min(h - 1, 2 * y + (k >> 1U));
                const std::uint8_t* texel = rgba.data() + (static_cast<std::size_t>(sy) * w + sx) * 4;
                alpha += texel[3];
                for (std::size_t c = 0; c < 3; ++c) {
                    sum[c] += static_cast<std::uint32_t>(texel[c]) * texel[3];
                    plain[c] += texel[c];
                }
            }
            std::uint8_t* to = out.data() + (static_cast<std::size_t>(y) * nw + x) * 4;
            // Weighted by alpha: what is transparent must not bleed its colour into what is not.
            for (std::size_t c = 0; c < 3; ++c) to[c] = static_cast<std::uint8_t>(alpha > 0 ? sum[c] / alpha : plain[c] / 4);
            to[3] = static_cast<std::uint8_t>((alpha + 2) / 4);
        }
    }
    return out;
}

/// A level may show so much more or less than the picture, as a share of what is shown or of what is not, whichever is less:
/// where a texel is wider than a mask's parts lie apart, it shows all or nothing, and the level before is better.
constexpr double max_coverage_off = 0.5;

}  // namespace

model::Index add_texture(model::Model& model, std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height,
                         bool clamp, std::uint32_t max_levels, float cutoff) {
    model::Texture texture;
    texture.width = width;
    texture.height = height;
    texture.clamp = clamp;
    texture.first_byte = model.texels.size();
    std::vector<std::uint8_t> level(rgba.begin(), rgba.end()), shown = level;
    const double coverage = cutoff > 0 ? mask_coverage({shown, width, height, clamp}, cutoff) : 0;
    std::uint32_t w = width, h = height;
    while (true) {
        const auto* bytes = reinterpret_cast<const std::byte*>(shown.data());
        model.texels.insert(model.texels.end(), bytes, bytes + shown.size());
        ++texture.levels;
        if ((w == 1 && h == 1) || texture.levels == max_levels) break;
        // The next one from alphas as they were: factors must not pile up.
        level = halve(level, w, h);
        w = std::max(1U, w / 2);
        h = std::max(1U, h / 2);
        shown = level;
        if (cutoff > 0 &&
            keep_coverage({shown, w, h, clamp}, cutoff, coverage) > max_coverage_off * std::min(coverage, 1 - coverage))
            break;
    }
    model.textures.push_back(texture);
    return static_cast<model::Index>(model.textures.size() - 1);
}

namespace {

/// An image, and how it is shown.
struct Shown {
    importer::Index image = importer::none;
    std::optional<std::uint8_t> hidden;  ///< hidden_alpha()
    bool masked = false;                 ///< by a mask that hides something

    auto operator<=>(const Shown&) const = default;  // NOLINT(modernize-use-nullptr): the compiler's own comparison with 0
};

/// A texture, and the alpha, 0..255, from which the first mask that shows it does so.
struct ShownTexture {
    float cutoff = 0;
    model::Index index = model::none;
};
using ShownTextures = std::map<Shown, ShownTexture>;

Shown shown_by(const importer::Material& material, std::optional<std::uint8_t> hidden) {
    return {material.image, hidden, hidden && material.alpha == model::AlphaMode::mask && material.colour[3] > 0};
}

float cutoff_of(const importer::Material& material, const Shown& shown) {
    // As hidden_alpha() has it: what is at the cutoff counts as shown.
    return shown.masked ? material.alpha_cutoff * 0.9999F * 255.0F / material.colour[3] : 0.0F;
}

model::Index add_shown(const importer::Scene& scene, const Shown& shown, float cutoff, model::Model& model) {
    const image::Image& image = scene.images[shown.image];
    std::vector<std::uint8_t> bled;
    if (shown.hidden) {
        bled = image.rgba;
        bleed_colours(bled, image.width, image.height, image.clamp, *shown.hidden);
    }
    return add_texture(model, bled.empty() ? image.rgba : bled, image.width, image.height, image.clamp, 32, cutoff);
}

/// Textures that one image becomes at most.
constexpr std::uint32_t max_ways = 4;

/// Of each material. An image that many share is looked at once.
std::vector<std::optional<std::uint8_t>> hidden_alphas(const importer::Scene& scene) {
    std::vector<std::optional<Alphas>> there(scene.images.size());
    std::vector<std::optional<std::uint8_t>> out;
    for (const importer::Material& material : scene.materials) {
        out.emplace_back();
        if (material.image == importer::none) continue;
        if (!there[material.image]) there[material.image] = alphas_of(scene.images[material.image]);
        out.back() = hidden_alpha(material, *there[material.image]);
    }
    return out;
}

/// A texture of the same image that this material can share, a mask for a mask. A small colour fringe is better than another
/// copy.
Shown nearest_way(const ShownTextures& textures, const Shown& shown) {
    auto found = textures.end();
    for (auto at = textures.lower_bound({shown.image, std::nullopt, false});
         at != textures.end() && at->first.image == shown.image; ++at) {
        if (found == textures.end() || at->first.masked == shown.masked) found = at;
    }
    return found->first;
}

/// A material's texture. Materials may show different texels of one image. Then the image becomes several textures, and the first
/// has the image's own index.
std::vector<model::Index> add_images(const importer::Scene& scene, model::Model& model) {
    ShownTextures textures;
    std::vector<Shown> wanted;
    std::vector<std::uint32_t> ways(scene.images.size(), 0);
    const std::vector<std::optional<std::uint8_t>> hidden = hidden_alphas(scene);
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        Shown shown = shown_by(scene.materials[i], hidden[i]);
        if (shown.image != importer::none && !textures.contains(shown) && ++ways[shown.image] > max_ways)
            shown = nearest_way(textures, shown);
        wanted.push_back(shown);
        textures.try_emplace(shown, ShownTexture{cutoff_of(scene.materials[i], shown), model::none});
    }
    for (importer::Index i = 0; i < scene.images.size(); ++i) {
        const auto first = textures.lower_bound({i, std::nullopt, false});
        const bool used = first != textures.end() && first->first.image == i;
        const model::Index texture = used ? add_shown(scene, first->first, first->second.cutoff, model)
                                          : add_shown(scene, {i, std::nullopt, false}, 0, model);
        if (used) first->second.index = texture;
    }
    for (auto& [shown, texture] : textures)
        if (shown.image != importer::none && texture.index == model::none)
            texture.index = add_shown(scene, shown, texture.cutoff, model);
    std::vector<model::Index> out;
    out.reserve(wanted.size());
    for (const Shown& shown : wanted) out.push_back(textures.at(shown).index);
    return out;
}

}  // namespace

std::vector<bool> cut_out_materials(const importer::Scene& scene) {
    std::vector<bool> out;
    for (const std::optional<std::uint8_t>& hidden : hidden_alphas(scene)) {
        out.push_back(hidden && scene.materials[out.size()].alpha == model::AlphaMode::mask);
    }
    return out;
}

namespace {

/// By material of the scene: whether some vertex has a colour that is not white.
std::vector<bool> coloured_materials(const importer::Scene& scene) {
    std::vector<bool> out(scene.materials.size(), false);
    const auto mark = [&](const importer::Mesh& mesh) {
        for (const importer::Primitive& p : mesh.primitives) {
            const bool coloured = std::any_of(p.colours.begin(), p.colours.end(), [](const auto& c) {
                return c[0] != 255 || c[1] != 255 || c[2] != 255 || c[3] != 255;
            });
            if (coloured) out[p.material] = true;
        }
    };
    for (const importer::Mesh& mesh : scene.meshes) mark(mesh);
    for (const importer::StandIn& stand_in : scene.stand_ins) mark(stand_in.mesh);
    return out;
}

}  // namespace

bool is_named_water(std::string_view name) {
    for (const std::string_view ending : {".png", ".jpg", ".jpeg", ".tga", ".dds", ".bmp"})
        if (name.ends_with(ending)) name.remove_suffix(ending.size());
    const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
    while (!name.empty() && !is_letter(name.back())) name.remove_suffix(1);  // a number, and what stands before it
    constexpr std::string_view word = "water";
    if (name.size() < word.size()) return false;
    const std::string_view last = name.substr(name.size() - word.size());
    const bool same =
        std::ranges::equal(last, word, [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
    if (!same || last.size() == name.size()) return same;
    const char before = name[name.size() - word.size() - 1];
    return !is_letter(before) || (last.front() == 'W' && std::islower(static_cast<unsigned char>(before)) != 0);
}

model::Index add_materials(const importer::Scene& scene, model::Model& model, const MaterialRules& rules) {
    const std::vector<model::Index> textures = add_images(scene, model);
    const std::vector<bool> coloured = coloured_materials(scene);
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const importer::Material& from = scene.materials[i];
        model::Material to;
        to.colour = from.colour;
        to.texture = textures[i];
        to.alpha = from.alpha;
        to.alpha_cutoff = from.alpha_cutoff;
        to.two_sided = from.two_sided;
        effects::MaterialFacts facts;
        facts.image = from.image != importer::none;
        facts.vertex_colours = coloured[i];
        facts.lit = !from.unlit;
        facts.in_fog = model.light.fog_visibility_m > 0;
        facts.water = from.water.value_or(rules.water_by_name && is_named_water(from.name));
        facts.light_by_pixel =
            from.light == importer::LightPlace::pixel || (from.light == importer::LightPlace::by_bake && rules.light_by_pixel);
        facts.alpha = from.alpha;
        to.effects = effects::called_for_by(facts);
        model.materials.push_back(to);
    }
    model::Material proxy;
    proxy.two_sided = true;  // a simplified crowd has no inside to hide
    effects::MaterialFacts facts;
    facts.vertex_colours = true;
    facts.lit = std::any_of(scene.materials.begin(), scene.materials.end(), [](const importer::Material& m) { return !m.unlit; });
    facts.in_fog = model.light.fog_visibility_m > 0;
    proxy.effects = effects::called_for_by(facts);
    model.materials.push_back(proxy);
    return static_cast<model::Index>(model.materials.size() - 1);
}

std::vector<Picture> pictures_of(const model::Model& model) {
    std::vector<Picture> out;
    for (const model::Material& material : model.materials) {
        const bool none = material.texture == model::none;
        out.push_back(none ? Picture::none : model.textures[material.texture].clamp ? Picture::clamped : Picture::repeats);
    }
    return out;
}

std::array<std::uint8_t, 4> tinted(const model::Material& material, const model::Vertex& vertex, const vec3& picture) {
    std::array<std::uint8_t, 4> out{0, 0, 0, 255};
    for (std::size_t c = 0; c < 3; ++c) {
        const float own =
            (material.effects & model::effect_vertex_colour) != 0 ? static_cast<float>(vertex.colour[c]) / 255.0F : 1.0F;
        const float colour = own * material.colour[c] * picture[static_cast<int>(c)] / 255.0F;
        out[c] = static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(colour, 0.0F, 1.0F)));
    }
    return out;
}

namespace {

/// Mean of RGBA8 texels, weighted by alpha where there is any.
vec3 mean_shown(std::span<const std::byte> rgba) {
    vec3 sum(0), plain(0);
    float alpha = 0;
    for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
        const vec3 colour(std::to_integer<int>(rgba[i]), std::to_integer<int>(rgba[i + 1]), std::to_integer<int>(rgba[i + 2]));
        const auto weight = static_cast<float>(std::to_integer<int>(rgba[i + 3]));
        sum += weight * colour;
        plain += colour;
        alpha += weight;
    }
    return alpha > 0 ? sum / alpha : plain / (static_cast<float>(rgba.size()) / 4);
}

}  // namespace

std::array<std::uint8_t, 4> baked_colour(const model::Model& model, const model::Material& material,
                                         const model::Vertex& vertex) {
    if (material.texture == model::none) return tinted(material, vertex, vec3(255));
    const model::Texture& t = model.textures[material.texture];
    // The level of about 8 texels across: an average about the place, not the texel there. Of what is cut out or transparent,
    // the whole picture's mean, weighted by alpha: a leaf's corners lie where there is no leaf, and are black in most
    // pictures.
    const bool opaque = material.alpha == model::AlphaMode::opaque;
    const std::uint32_t max_texels = opaque ? 8 : 1;
    std::uint32_t level = 0, w = t.width, h = t.height;
    std::uint64_t at = t.first_byte;
    while (level + 1 < t.levels && std::max(w, h) > max_texels) {
        at += static_cast<std::uint64_t>(w) * h * 4;
        w = std::max(1U, w / 2);
        h = std::max(1U, h / 2);
        ++level;
    }
    if (!opaque) return tinted(material, vertex, mean_shown({model.texels.data() + at, std::size_t{4} * w * h}));
    const float u = vertex.uv[0] - std::floor(vertex.uv[0]), v = vertex.uv[1] - std::floor(vertex.uv[1]);
    const std::uint32_t x = std::min(w - 1, static_cast<std::uint32_t>(u * static_cast<float>(w)));
    const std::uint32_t y = std::min(h - 1, static_cast<std::uint32_t>(v * static_cast<float>(h)));
    const std::byte* texel = model.texels.data() + at + (static_cast<std::uint64_t>(y) * w + x) * 4;
    return tinted(material, vertex,
                  {std::to_integer<int>(texel[0]), std::to_integer<int>(texel[1]), std::to_integer<int>(texel[2])});
}

void keep_used_effects(model::Model& model, std::span<const std::pair<model::Index, model::Index>> copies) {
    std::vector<bool> used(model.materials.size(), false);
    for (const model::Part& part : model.parts) used[part.material] = true;
    for (const auto& [copy, original] : copies) {  // what only copies are drawn with is found without the sun
        if (!used[copy] || used[original]) continue;
        used[original] = true;
        model.materials[original].effects = model.materials[copy].effects;
    }
    for (std::size_t m = 0; m < used.size(); ++m)
        if (!used[m]) model.materials[m].effects = 0;
}

std::vector<model::EffectFinding> find_effects(const model::Model& model, const std::vector<std::uint64_t>& triangles_of_material,
                                               const SceneLight& light) {
    std::vector<model::EffectMask> masks;
    for (const model::Material& material : model.materials) masks.push_back(material.effects);
    for (const auto& [copy, original] : light.openness.copies)  // its triangles are the original's
        if (copy < masks.size() && original < masks.size()) masks[original] |= masks[copy];
    std::vector<model::EffectFinding> findings;
    for (const effects::EffectModule& module : effects::all_effects()) {
        model::EffectFinding f;
        f.bit = module.bit;
        std::size_t materials = 0;
        for (std::size_t m = 0; m < triangles_of_material.size(); ++m) {
            if ((masks[m] & f.bit) == 0 || triangles_of_material[m] == 0) continue;
            ++materials;
            f.triangles += triangles_of_material[m];
        }
        // Coarse forms carry their colours in the vertices, and boxes carry pictures: the bake's own forms call too.
        std::uint64_t own = 0;
        for (const model::Representation& rep : model.reps) own += (rep.effects & f.bit) != 0 ? 1 : 0;
        f.called_for = materials > 0 || own > 0;
        f.reason = materials > 0 ? fmt::format("{} of {} materials {}", materials, triangles_of_material.size(), module.have)
                   : own > 0     ? fmt::format("{}; {} baked representations need it", module.missing, own)
                                 : std::string(module.missing);
        findings.push_back(std::move(f));
    }
    add_to_findings(light.openness, findings);
    add_to_findings(light.baked, model.light, findings);
    return findings;
}

void add_scene_effects(const importer::Scene& scene, bool sky_by_bake, std::vector<model::EffectFinding>& findings) {
    const model::EffectMask called_for = effects::called_for_by(effects::SceneFacts{scene.sky || sky_by_bake});
    for (const effects::EffectModule& module : effects::all_effects())
        for (model::EffectFinding& f : findings) {
            if (f.bit != module.bit || (called_for & f.bit) == 0) continue;
            f.called_for = true;
            f.reason = fmt::format("{}, as {} says", module.have, scene.sky ? "the scene's file" : "bake --sky");
        }
}

void add_sun_reason(const importer::Scene& scene, const std::optional<model::SunTime>& time,
                    std::vector<model::EffectFinding>& findings) {
    for (model::EffectFinding& f : findings) {
        if (f.bit != model::effect_sun || !f.called_for) continue;
        if (time)
            f.reason += fmt::format("; from where it stands at {:.4g} h of day {:.4g} at {:.4g} degrees", time->hour, time->day,
                                    time->latitude_deg);
        else if (scene.sun)
            f.reason += fmt::format("; from where the scene's light '{}' shines", scene.sun->name);
    }
}

}  // namespace surefoot::bake
