// Mean light, by what surfaces would show in a light of 1: that makes the mean colour of a face right. Lamps differ by corners.
#include "render/bake/box_light.hpp"

#include <algorithm>
#include <cmath>

#include "render/effects/surface_light.hpp"
#include "render/model/sun_time.hpp"

namespace surefoot::bake {

namespace {

constexpr float min_light = 0.05F;         // that a captured colour is divided by
constexpr float min_brightness = 0.01F;    // of a surface: black ones count where nothing else is
constexpr float room_brightness = 0.947F;  // of a room's light, its mean colour
constexpr float byte_margin = 1.01F;       // bytes of light may be a little darker
constexpr float steepness = 3;             // of means about corners: they change a third of what an even light does
constexpr std::uint32_t light_cells = 4;   // along a face's side, in which light is added up

using Corners = std::array<LightSums, 4>;

/// How much of a place, 0..1 both ways, belongs to a corner.
float share_of_corner(std::size_t corner, const vec2& at) {
    return (corner % 2 == 0 ? 1 - at.x : at.x) * (corner < 2 ? 1 - at.y : at.y);
}

/// Where a texel's middle lies in what a face shows, 0..1 both ways. Texels about that have its border's place.
vec2 place_in(const std::array<std::uint32_t, 4>& shown, std::uint32_t x, std::uint32_t y) {
    const vec2 low(shown[0], shown[1]), size(shown[2] - shown[0], shown[3] - shown[1]);
    return glm::clamp((vec2(x, y) + 0.5F - low) / size, 0.0F, 1.0F);
}

/// The light of a face: means, and lamps at its corners.
struct MeanLight {
    LightSums all;
    std::array<vec3, 4> lamps{};
};

/// The mean of lamps over the face is that of what it shows. Day has one light for a face: with four, divided pictures are harder
/// to compress, and files 8 % larger instead of 3.
MeanLight mean_of(const std::array<LightSums, std::size_t{light_cells} * light_cells>& parts) {
    MeanLight out;
    Corners sums{};
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
        const vec2 at = (vec2(i % light_cells, i / light_cells) + 0.5F) / static_cast<float>(light_cells);
        for (std::size_t c = 0; c < sums.size(); ++c) sums[c].add(parts[i], share_of_corner(c, at));
        out.all.add(parts[i], 1);
    }
    const float weight = out.all.weight;
    for (float& light : out.all.of) light /= weight;
    for (std::size_t k = 0; k < 3; ++k) {
        const float mean = out.all.of[LightSums::red + k];
        const int channel = static_cast<int>(k);
        float shown = 0;
        for (std::size_t c = 0; c < sums.size(); ++c) {
            const float here = sums[c].weight > 0.02F * weight ? sums[c].of[LightSums::red + k] / sums[c].weight : mean;
            out.lamps[c][channel] = std::max(0.0F, mean + steepness * (here - mean));
            shown += out.lamps[c][channel] * sums[c].weight / weight;
        }
        for (vec3& corner : out.lamps) corner[channel] *= shown > 0 ? mean / shown : 0.0F;
    }
    return out;
}

std::uint8_t byte_of(float share) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0F, 1.0F))); }

/// Bytes of light that is `times` as bright.
FaceLight bytes_of(const MeanLight& light, float times) {
    FaceLight out;
    const float scale = times / effects::max_picture_light;
    const auto& of = light.all.of;
    out.of_all.from = {byte_of(scale * of[LightSums::sky]), byte_of(scale * of[LightSums::ground]),
                       byte_of(scale * of[LightSums::room]), 0};
    for (std::size_t m = 0; m < sizeof(model::SunSeen); ++m)
        out.of_all.sun.share[m] = byte_of(scale * of[LightSums::first_sun + m]);
    for (std::size_t c = 0; c < out.lamps.size(); ++c)
        for (int k = 0; k < 3; ++k) out.lamps[c][static_cast<std::size_t>(k)] = byte_of(std::sqrt(times * light.lamps[c][k]));
    return out;
}

vec3 own_light(const FaceLight& light, const model::Daylight& own) {
    return glm::max(effects::light_on_picture(light.of_all, own), vec3(min_light));
}

}  // namespace

void LightSums::add(const LightSums& more, float times) {
    weight += times * more.weight;
    for (std::size_t k = 0; k < of.size(); ++k) of[k] += times * more.of[k];
}

BoxLight::BoxLight(const model::Model& model)
    : model_(model), own_(model::daylight_of_model(model.sun_direction, model.light)), normals_(model.nodes.size(), mat3(1.0F)) {
    const model::LightFacts& facts = model.light;
    suns_[0] = own_.sun_direction;
    for (std::uint32_t i = 0; i < model::sun_moments; ++i)
        suns_[1 + i] =
            vec3(model::towards_sun({model::hour_of_moment(i, facts.day, facts.latitude_deg), facts.day, facts.latitude_deg}));
    for (std::size_t n = 0; n < model.nodes.size(); ++n) {
        const model::Node& node = model.nodes[n];
        if (node.child_count > 0) continue;
        const mat3& linear = model.placements[model.reps[node.first_rep + node.rep_count - 1].placement].linear;
        normals_[n] = cofactors(linear) * (glm::determinant(linear) < 0 ? -1.0F : 1.0F);
    }
}

LightSums BoxLight::on(const FormSample& sample, const SampleSource& source) const {
    const model::Vertex& v = model_.vertices[source.vertex];
    const model::EffectMask effects = model_.materials[source.material()].effects;
    const auto has = [&](model::EffectMask any) { return (effects & any) != 0; };
    const bool turned = source.turned(), sunny = has(model::effect_sun), measured = has(model::effect_openness);
    vec3 n = normals_[sample.owner] * vec3(v.normal[0], v.normal[1], v.normal[2]);
    n *= (turned ? -1.0F : 1.0F) / std::sqrt(std::max(glm::dot(n, n), 1e-30F));
    const auto open = [&](std::size_t what) { return 1 - static_cast<float>(v.hidden[turned ? what + 1 : what]) / 255.0F; };
    const float near = measured ? 0.6F + 0.4F * open(2) : 1.0F;
    const float outside = sunny ? (measured ? std::min(1.0F, 4 * open(0)) : 1.0F) * near : 0.0F;
    const float up = 0.5F * n.y + 0.5F;
    LightSums out;
    out.of[LightSums::sky] = outside * up;
    out.of[LightSums::ground] = outside * (1 - up);
    out.of[LightSums::room] = near - outside;  // without the sun's effect it is lit as a room, or not at all
    for (std::size_t m = 0; m < suns_.size() && sunny; ++m) {
        const bool shaded = has(model::effect_shadow);
        const float seen = shaded ? static_cast<float>(model_.sun_seen[source.vertex].share[m]) / 255.0F : 1.0F;
        out.of[LightSums::first_sun + m] = outside * seen * std::max(glm::dot(n, suns_[m]), 0.0F);
    }
    const vec3 own = own_.sun_light * out.of[LightSums::first_sun] + own_.sky_light * out.of[LightSums::sky] +
                     own_.ground_light * out.of[LightSums::ground] + vec3(room_brightness * out.of[LightSums::room]);
    float weight = 0;
    for (std::size_t c = 0; c < 3; ++c)
        weight += static_cast<float>(sample.rgb[1][c]) / (3 * 255 * std::max(own[static_cast<int>(c)], min_light));
    out.weight = std::max(weight, min_brightness);
    for (std::size_t c = 0; c < 3 && has(model::effect_lamps); ++c) {
        const model::LampLight& lamps = model_.lamp_light[source.vertex];
        const float root = static_cast<float>(turned ? lamps.behind[c] : lamps.before[c]) / 255.0F;
        out.of[LightSums::red + c] = root * root;
    }
    for (float& light : out.of) light *= out.weight;
    return out;
}

void BoxLight::take_from(FaceCapture& face, const FaceSource& source) const {
    const std::array<std::uint32_t, 4> shown = shown_texels(face, source.pixels);
    std::array<LightSums, std::size_t{light_cells} * light_cells> parts{};
    float weight = 0;
    for (const FaceSample& s : source.samples) {
        const SampleSource& from = source.seen.sources[s.sample];
        const FormSample& sample = source.seen.samples[s.sample];
        if (from.vertex == model::none || sample.owner >= normals_.size()) continue;
        const glm::uvec2 cell(place_in(shown, s.texel % source.pixels, s.texel / source.pixels) * (light_cells - 0.001F));
        const LightSums light = on(sample, from);
        parts[std::size_t{light_cells} * cell.y + cell.x].add(light, 1);
        weight += light.weight;
    }
    if (!(weight > 0)) return;
    const MeanLight light = mean_of(parts);
    // What is brighter than the mean must not be brighter than white: then the light is, as far as its bytes allow.
    float brightest = 1 / byte_margin, largest = 1e-6F;
    const vec3 own = own_light(bytes_of(light, 1), own_);
    for (std::size_t at = 0; at + 3 < face.rgba.size(); at += 4)
        for (int c = 0; c < 3 && face.rgba[at + 3] >= opaque_alpha; ++c)
            brightest = std::max(brightest, static_cast<float>(face.rgba[at + static_cast<std::size_t>(c)]) / (255 * own[c]));
    for (std::size_t k = 0; k < light.all.of.size(); ++k)
        if (k < LightSums::red || k >= LightSums::first_sun) largest = std::max(largest, light.all.of[k]);
    face.light = bytes_of(light, std::min(byte_margin * brightest, effects::max_picture_light / largest));
    const vec3 by = own_light(face.light, own_);
    for (std::size_t at = 0; at + 3 < face.rgba.size(); at += 4)
        for (int c = 0; c < 3; ++c) {
            std::uint8_t& channel = face.rgba[at + static_cast<std::size_t>(c)];
            channel = static_cast<std::uint8_t>(std::lround(std::min(255.0F, static_cast<float>(channel) / by[c])));
        }
}

}  // namespace surefoot::bake
