// Leaves by their triangles, corners by the texels near them; a normal that carries what the sun does there.
#include "render/bake/box_light.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/bake/materials.hpp"
#include "render/effects/surface_light.hpp"
#include "render/model/daylight.hpp"

namespace surefoot::bake {

namespace {

constexpr model::EffectMask open_or_closed = model::effect_sun | model::effect_openness;
constexpr float min_brightness = 0.02F;       // of a colour: what is black still counts where nothing else is
constexpr float min_divisor = 0.05F;          // of a picture, by its light
constexpr float all_open = 0.999F;            // a share of the sky's factor
constexpr std::uint32_t samples_across = 32;  // of a leaf

/// Mean colour of a picture where it shows, by its smallest level; 0..255.
vec3 mean_of_picture(const model::Model& model, const model::Texture& texture) {
    std::uint32_t width = texture.width, height = texture.height;
    const std::byte* texels = model.texels.data() + texture.first_byte;
    for (std::uint32_t level = 0; level + 1 < texture.levels; ++level) {
        texels += std::size_t{4} * width * height;
        width = std::max(1U, width / 2);
        height = std::max(1U, height / 2);
    }
    vec3 sum(0), plain(0);
    float shown = 0;
    const std::size_t count = std::size_t{width} * height;
    for (std::size_t i = 0; i < count; ++i) {
        const auto byte = [&](std::size_t k) { return static_cast<float>(std::to_integer<int>(texels[4 * i + k])); };
        const vec3 colour(byte(0), byte(1), byte(2));
        sum += byte(3) * colour;
        plain += colour;
        shown += byte(3);
    }
    return shown > 0 ? sum / shown : plain / static_cast<float>(std::max<std::size_t>(count, 1));
}

/// How many samples of a small picture of a leaf each of its triangles has, as it is seen from there: others hide what they hide.
std::vector<std::uint32_t> samples_of_triangles(const model::Model& model, const model::Node& leaf,
                                                const model::Representation& full, std::uint32_t face) {
    const model::Placement& place = model.placements[full.placement];
    const bool mirrored = glm::determinant(place.linear) < 0;
    const dvec3 centre = leaf.box.centre();
    const vec3 origin(place.origin - centre);
    FormPicture picture;
    picture.clear(view_of({leaf.box.min - centre, leaf.box.max - centre}, direction_of_face(face), dvec3(0.0), samples_across),
                  false);
    std::vector<GeometryPart> triangle(1);
    triangle[0].indices = mirrored ? std::vector<std::uint32_t>{0, 2, 1} : std::vector<std::uint32_t>{0, 1, 2};
    std::vector<model::Vertex> corners(3);
    model::Index number = 0;
    for (model::Index p = full.first_part; p < full.first_part + full.part_count; ++p) {
        const model::Part& part = model.parts[p];
        triangle[0].material = part.material;
        for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) {
            for (std::size_t k = 0; k < 3; ++k) {
                corners[k] = model.vertices[part.first_vertex + model.indices[part.first_index + i + k]];
                float* const at = corners[k].position;
                const vec3 placed = place.linear * vec3(at[0], at[1], at[2]) + origin;
                for (int c = 0; c < 3; ++c) at[c] = placed[c];
            }
            picture.owner = number++;
            draw_geometry(model, corners, triangle, picture);
        }
    }
    std::vector<std::uint32_t> samples(number, 0);
    for (const FormSample& sample : picture.samples)
        if (sample.covered()) ++samples[sample.owner];
    return samples;
}

/// Adds up the corners of a leaf's triangles.
struct LightSum {
    const model::Model& model;
    const SunDirections& suns;
    const std::vector<vec3>& pictures;
    vec3 towards;
    mat3 to_world;  ///< turns normals
    SeenLight light{};
    float seen = 0;  ///< of what is lit

    /// samples: of its triangles.
    void add(const model::Part& part, const std::uint32_t* samples);
    void add_corner(const model::Material& material, std::uint32_t vertex, float samples);
};

void LightSum::add(const model::Part& part, const std::uint32_t* samples) {
    const model::Material& material = model.materials[part.material];
    if ((material.effects & open_or_closed) == 0) return;
    for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) {
        const auto third = static_cast<float>(samples[i / 3]) / 3;
        for (std::uint32_t k = 0; k < 3 && third > 0; ++k)
            add_corner(material, part.first_vertex + model.indices[part.first_index + i + k], third);
    }
}

void LightSum::add_corner(const model::Material& material, std::uint32_t vertex, float samples) {
    const model::Vertex& v = model.vertices[vertex];
    vec3 n = to_world * vec3(v.normal[0], v.normal[1], v.normal[2]);
    const float length = glm::length(n);
    if (!(length > 0)) return;
    const bool turned = material.two_sided && glm::dot(n, towards) < 0;
    n *= (turned ? -1.0F : 1.0F) / length;
    const auto has = [&](model::Effect effect) { return (material.effects & effect) != 0; };
    const auto rgba = tinted(material, v, material.texture == model::none ? vec3(255) : pictures[material.texture]);
    const vec3 colour = vec3(rgba[0], rgba[1], rgba[2]) / 255.0F;
    const float weight = samples * std::max((colour.r + colour.g + colour.b) / 3, min_brightness);
    const auto open = [&](std::size_t what) { return 1 - static_cast<float>(v.hidden[turned ? what + 1 : what]) / 255.0F; };
    const bool measured = has(model::effect_openness);
    const float sky = !has(model::effect_sun) ? 0 : measured ? std::min(1.0F, 4 * open(0)) : 1;
    const float room = measured ? 0.6F + 0.4F * open(2) : 1;
    seen += samples;
    light.weight += weight;
    light.normal += weight * n;
    light.sky += weight * sky;
    light.room += weight * room;
    light.colour += samples * colour;
    for (std::size_t m = 0; m < suns.size() && sky > 0; ++m) {
        const float share = has(model::effect_shadow) ? static_cast<float>(model.sun_seen[vertex].share[m]) / 255.0F : 1.0F;
        light.sun[m] += weight * sky * room * share * std::max(glm::dot(n, vec3(suns[m])), 0.0F);
    }
    if (!has(model::effect_lamps)) return;
    const std::uint8_t* const lamps = turned ? model.lamp_light[vertex].behind : model.lamp_light[vertex].before;
    const vec3 root = vec3(lamps[0], lamps[1], lamps[2]) / 255.0F;
    light.lamps += samples * colour * root * root;
}

/// Light falls by a cosine, and shares only take from it. So where a corner stands for things that look many ways, its normal
/// leans to where the sun is when it shines on them. sun: by moment, how much it shines, by angle and shadow.
vec3 carrying_normal(const vec3& mean, const std::array<float, std::tuple_size_v<SunDirections>>& sun,
                     const SunDirections& suns) {
    vec3 bright(0);
    for (std::size_t m = 0; m < suns.size(); ++m) bright += sun[m] * vec3(suns[m]);
    if (!(glm::length(bright) > 0)) return mean;
    bright = glm::normalize(bright);
    constexpr std::array<float, 5> leans{0, 0.25F, 0.5F, 1, 2};
    constexpr float cost_of_leaning = 0.005F;  // against squares of what is missing
    vec3 best = mean;
    float min_missing = 1e9F;
    for (const float lean : leans) {
        const vec3 sum = mean + lean * bright;
        if (!(glm::length(sum) > 0.1F)) continue;
        const vec3 normal = glm::normalize(sum);
        float missing = cost_of_leaning * lean;
        for (std::size_t m = 0; m < suns.size(); ++m) {
            const float less = sun[m] - std::max(glm::dot(normal, vec3(suns[m])), 0.0F);
            if (less > 0) missing += less * less;
        }
        if (missing < min_missing) min_missing = missing, best = normal;
    }
    return best;
}

std::uint8_t share_byte(float share) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0F, 1.0F))); }

CornerLight corner_of_sum(const SeenLight& sum, const SunDirections& suns) {
    CornerLight out;
    const float sky = std::clamp(sum.sky / sum.weight, 0.0F, 1.0F), room = std::clamp(sum.room / sum.weight, 0.6F, 1.0F);
    const float hidden_sky = sky > all_open ? 0.0F : 1 - sky / 4, hidden_room = (1 - room) / 0.4F;
    out.hidden = {share_byte(hidden_sky), share_byte(hidden_sky), share_byte(hidden_room), share_byte(hidden_room)};
    std::array<float, std::tuple_size_v<SunDirections>> sun{};
    for (std::size_t m = 0; m < suns.size() && sky > 0; ++m) sun[m] = sum.sun[m] / (sum.weight * sky * room);
    const float length = glm::length(sum.normal);
    const vec3 mean = length > 0 ? sum.normal / length : vec3(0, 1, 0);
    const vec3 normal = carrying_normal(mean, sun, suns);
    for (int k = 0; k < 3; ++k) out.normal[static_cast<std::size_t>(k)] = static_cast<std::int8_t>(std::lround(127 * normal[k]));
    for (std::size_t m = 0; m < suns.size(); ++m) {
        const float all = glm::dot(normal, vec3(suns[m]));
        if (all > 1e-3F) out.sun.share[m] = share_byte(sun[m] / all);
    }
    for (int c = 0; c < 3; ++c) {
        const float light = sum.colour[c] > 0 ? sum.lamps[c] / sum.colour[c] : 0.0F;
        out.lamps.before[c] = out.lamps.behind[c] = share_byte(std::sqrt(light));
    }
    return out;
}

/// What light a corner calls for.
model::EffectMask effects_needed_by(const CornerLight& corner) {
    model::EffectMask mask = 0;
    if (corner.hidden[0] < 255) mask |= model::effect_sun;
    if (std::any_of(corner.hidden.begin(), corner.hidden.end(), [](std::uint8_t h) { return h > 0; }))
        mask |= model::effect_openness;
    for (const std::uint8_t share : corner.sun.share)
        if (share < 255) mask |= model::effect_shadow;
    for (int c = 0; c < 3; ++c)
        if (corner.lamps.before[c] > 0) mask |= model::effect_lamps;
    return mask;
}

vec3 light_of_corner(const CornerLight& corner, model::EffectMask mask, const model::Daylight& light) {
    effects::SurfacePoint point;
    point.normal = glm::normalize(vec3(corner.normal[0], corner.normal[1], corner.normal[2]));
    point.sees_sky = 1 - static_cast<float>(corner.hidden[0]) / 255.0F;
    point.sees_room = 1 - static_cast<float>(corner.hidden[2]) / 255.0F;
    point.sun_seen = corner.sun;
    return glm::max(effects::light_of(point, mask, light), vec3(min_divisor));
}

/// As the two triangles of a face have it. high: which way their common edge runs. at: 0..1 both ways.
vec3 light_between(const std::array<vec3, 4>& corners, bool high, const vec2& at) {
    const float x = at.x, y = at.y;
    if (high && x >= y) return corners[0] + x * (corners[1] - corners[0]) + y * (corners[3] - corners[1]);
    if (high) return corners[0] + y * (corners[2] - corners[0]) + x * (corners[3] - corners[2]);
    if (x + y <= 1) return corners[0] + x * (corners[1] - corners[0]) + y * (corners[2] - corners[0]);
    return corners[3] + (1 - x) * (corners[2] - corners[3]) + (1 - y) * (corners[1] - corners[3]);
}

/// Where a texel's middle lies in what a face shows, 0..1 both ways.
vec2 place_in(const std::array<std::uint32_t, 4>& shown, std::uint32_t x, std::uint32_t y) {
    return (vec2(x - shown[0], y - shown[1]) + 0.5F) / vec2(shown[2] - shown[0], shown[3] - shown[1]);
}

}  // namespace

void SeenLight::add(const SeenLight& more, float times) {
    weight += times * more.weight;
    normal += times * more.normal;
    sky += times * more.sky;
    room += times * more.room;
    for (std::size_t m = 0; m < sun.size(); ++m) sun[m] += times * more.sun[m];
    colour += times * more.colour;
    lamps += times * more.lamps;
}

LeafLight::LeafLight(const model::Model& model) : model_(model), suns_(sun_directions(model)) {
    for (const model::Texture& texture : model.textures) pictures_.push_back(mean_of_picture(model, texture));
}

SeenLight LeafLight::seen(const model::Node& leaf, std::uint32_t face) const {
    const model::Representation& full = model_.reps[leaf.first_rep + leaf.rep_count - 1];
    const mat3& linear = model_.placements[full.placement].linear;
    const mat3 to_world = cofactors(linear) * (glm::determinant(linear) < 0 ? -1.0F : 1.0F);
    const std::vector<std::uint32_t> samples = samples_of_triangles(model_, leaf, full, face);
    LightSum sum{model_, suns_, pictures_, direction_of_face(face).towards, to_world};
    const std::uint32_t* of_part = samples.data();
    for (model::Index p = full.first_part; p < full.first_part + full.part_count; ++p) {
        sum.add(model_.parts[p], of_part);
        of_part += model_.parts[p].index_count / 3;
    }
    SeenLight mean;
    if (sum.seen > 0) mean.add(sum.light, 1 / sum.seen);
    return mean;
}

std::vector<SeenLight> LeafLight::seen_of_all(std::uint32_t face, const ForAll& for_all) const {
    std::vector<SeenLight> out(model_.nodes.size());
    for_all(out.size(), [&](std::size_t n) {
        if (model_.nodes[n].child_count == 0) out[n] = seen(model_.nodes[n], face);
    });
    return out;
}

void light_corners(const std::vector<model::Index>& owners, std::span<const SeenLight> lights, const SunDirections& suns,
                   std::uint32_t pixels, FaceCapture& face) {
    face.light.clear();
    const std::array<std::uint32_t, 4> shown = shown_texels(face, pixels);
    std::array<SeenLight, 4> corners{};
    SeenLight all;
    for (std::uint32_t y = shown[1]; y < shown[3]; ++y) {
        for (std::uint32_t x = shown[0]; x < shown[2]; ++x) {
            const std::size_t texel = static_cast<std::size_t>(y) * pixels + x;
            const model::Index owner = owners[texel];
            if (face.rgba[4 * texel + 3] < opaque_alpha || owner >= lights.size()) continue;
            const vec2 at = place_in(shown, x, y);
            for (std::size_t c = 0; c < 4; ++c)
                corners[c].add(lights[owner], (c % 2 == 0 ? 1 - at.x : at.x) * (c < 2 ? 1 - at.y : at.y));
        }
    }
    for (const SeenLight& corner : corners) all.add(corner, 1);
    if (!(all.weight > 0)) return;
    for (const SeenLight& corner : corners) face.light.push_back(corner_of_sum(corner.weight > 0 ? corner : all, suns));
}

void take_light(const model::Model& model, BoxForm& box) {
    const auto lit = [](const FaceCapture& face) { return !(face.covered > 0) || !face.light.empty(); };
    box.light = 0;
    if (!std::all_of(box.faces.begin(), box.faces.end(), lit))
        for (FaceCapture& face : box.faces) face.light.clear();
    for (const FaceCapture& face : box.faces)
        for (const CornerLight& corner : face.light) box.light |= effects_needed_by(corner);
    if (model.sun_seen.empty() || (box.light & model::effect_sun) == 0) box.light &= ~model::EffectMask{model::effect_shadow};
    if (model.lamp_light.empty()) box.light &= ~model::EffectMask{model::effect_lamps};
    const model::Daylight own = model::daylight_of_model(model.sun_direction, model.light);
    for (std::uint32_t f = 0; f < box_faces; ++f) {
        FaceCapture& face = box.faces[f];
        if (face.light.empty()) continue;
        std::array<vec3, 4> corners{};
        for (std::size_t c = 0; c < 4; ++c) corners[c] = light_of_corner(face.light[c], box.light, own);
        const std::array<std::uint32_t, 4> shown = shown_texels(face, box.pixels);
        for (std::uint32_t y = shown[1]; y < shown[3]; ++y) {
            for (std::uint32_t x = shown[0]; x < shown[2]; ++x) {
                const vec3 light = light_between(corners, f % 2 == 1, place_in(shown, x, y));
                std::uint8_t* const rgba = &face.rgba[4 * (static_cast<std::size_t>(y) * box.pixels + x)];
                for (int c = 0; c < 3; ++c)
                    rgba[c] = static_cast<std::uint8_t>(std::lround(std::min(255.0F, static_cast<float>(rgba[c]) / light[c])));
            }
        }
    }
}

}  // namespace surefoot::bake
