// Differences of colours with and without effects, at points of every leaf (effect_worth.hpp).
#include "render/effect_worth.hpp"

#include <algorithm>
#include <cmath>

#include "render/effects/surface_light.hpp"

namespace surefoot {

namespace {

constexpr std::uint32_t points_a_leaf = 16;

/// A point of a leaf, and how much of its surface it stands for.
struct WorthPoint {
    effects::SurfacePoint at;
    vec3 colour{1.0F};  ///< before light
    model::EffectMask effects = 0;
    float area = 0;
};

/// What lights shade: the moments, and the colour of fog in each.
struct WorthLights {
    std::vector<model::Daylight> moments;
    std::array<float, 3> sky;
};

/// The mean colour of a texture: its smallest mip level.
vec3 mean_texel(const model::Model& model, const model::Texture& texture) {
    std::uint64_t at = texture.first_byte;
    for (std::uint32_t level = 0; level + 1 < texture.levels; ++level)
        at += std::uint64_t{4} * std::max(1U, texture.width >> level) * std::max(1U, texture.height >> level);
    if (texture.levels == 0 || at + 4 > model.texels.size()) return vec3(1.0F);
    const auto channel = [&](std::size_t c) { return static_cast<float>(model.texels[at + c]) / 255.0F; };
    return {channel(0), channel(1), channel(2)};
}

vec3 surface_colour(const model::Model& model, const model::Material& material, const model::Vertex& vertex) {
    vec3 colour(material.colour[0], material.colour[1], material.colour[2]);
    if ((material.effects & model::effect_texture) != 0 && material.texture != model::none)
        colour *= mean_texel(model, model.textures[material.texture]);
    if ((material.effects & model::effect_vertex_colour) != 0)
        colour *= vec3(vertex.colour[0], vertex.colour[1], vertex.colour[2]) / 255.0F;
    return colour;
}

WorthPoint point_of(const model::Model& model, const model::Part& part, const mat3& to_world, std::uint32_t vertex, float area) {
    const model::Material& material = model.materials[part.material];
    const model::Vertex& v = model.vertices[vertex];
    WorthPoint point;
    point.area = area;
    point.effects = material.effects;
    point.colour = surface_colour(model, material, v);
    const vec3 normal = to_world * (vec3(v.normal[0], v.normal[1], v.normal[2]) / 127.0F);
    const float length = glm::length(normal);
    if (length > 0.0F) point.at.normal = normal / length;
    point.at.sees_sky = 1.0F - static_cast<float>(v.hidden[0]) / 255.0F;
    point.at.sees_room = 1.0F - static_cast<float>(v.hidden[2]) / 255.0F;
    if (!model.sun_seen.empty()) point.at.sun_seen = model.sun_seen[vertex];
    if (model.lamp_light.empty()) return point;
    const std::uint8_t* const lamps = model.lamp_light[vertex].before;
    point.at.by_lamps = vec3(lamps[0], lamps[1], lamps[2]) / 255.0F;
    return point;
}

/// Corners of triangles that are evenly spread over the list of a leaf's full detail.
void collect_points(const model::Model& model, const model::Node& leaf, std::vector<WorthPoint>& points) {
    points.clear();
    const model::Representation& rep = model.reps[leaf.first_rep + leaf.rep_count - 1];
    const mat3& linear = model.placements[rep.placement].linear;
    const mat3 to_world = cofactors(linear) * (glm::determinant(linear) < 0.0F ? -1.0F : 1.0F);
    const std::uint32_t stride = std::max(1U, (rep.triangles + points_a_leaf - 1) / points_a_leaf);
    std::uint32_t triangle = 0;
    for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        const model::Part& part = model.parts[p];
        for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3, ++triangle) {
            if (triangle % stride != 0) continue;
            const auto corner = [&](std::uint32_t k) { return part.first_vertex + model.indices[part.first_index + i + k]; };
            const auto place = [&](std::uint32_t k) {
                const float* const at = model.vertices[corner(k)].position;
                return linear * vec3(at[0], at[1], at[2]);
            };
            const float area = 0.5F * glm::length(glm::cross(place(1) - place(0), place(2) - place(0)));
            points.push_back(point_of(model, part, to_world, corner((triangle / stride) % 3), area));
        }
    }
}

float mean_square(const vec3& difference) { return glm::dot(difference, difference) / 3.0F; }

vec3 colour_shown(const WorthPoint& point, model::EffectMask mask, const model::Daylight& light) {
    return glm::clamp(point.colour * effects::light_of(point.at, mask, light), 0.0F, 1.0F);
}

/// Of a leaf in one light: the mean square of what its points show, and what they lose without each group.
struct LeafWorth {
    double energy = 0;
    std::array<float, prepare::max_effect_groups> losses{};
};

/// What a point loses without the group. Fog: what it would lose where nothing of its own colour were left.
float loss_of(const WorthPoint& point, const vec3& with, model::EffectMask own, const model::Daylight& light, const vec3& fog) {
    if (effects::hides_by_depth(own)) return mean_square(with - fog);
    return mean_square(with - colour_shown(point, point.effects & ~own, light));
}

/// What a point shows with all of its effects is worked out once for all groups.
LeafWorth worth_of_leaf(std::span<const WorthPoint> points, std::span<const EffectGroup> groups, const model::Daylight& light,
                        const vec3& fog) {
    LeafWorth worth;
    double areas = 0;
    std::array<double, prepare::max_effect_groups> sums{};
    for (const WorthPoint& point : points) {
        const auto area = static_cast<double>(point.area);
        const vec3 with = colour_shown(point, point.effects, light);
        areas += area;
        worth.energy += area * static_cast<double>(mean_square(with));
        for (std::size_t g = 0; g < groups.size(); ++g)
            if ((point.effects & groups[g].own) != 0)
                sums[g] += area * static_cast<double>(loss_of(point, with, groups[g].own, light, fog));
    }
    if (!(areas > 0 && std::isfinite(areas))) return {};
    worth.energy /= areas;
    for (std::size_t g = 0; g < groups.size(); ++g) worth.losses[g] = static_cast<float>(sums[g] / areas);
    return worth;
}

float size_of(const Box& box) {
    const dvec3 size = 2.0 * box.half();
    const double outline = size.x * size.y + size.y * size.z + size.z * size.x;
    return box.empty() || !std::isfinite(outline) ? 0.0F : static_cast<float>(outline);
}

/// A cluster's loss is the mean of its leaves', by their size.
void go_up(const model::Model& model, std::span<float> loss) {
    std::vector<double> weight(model.nodes.size()), sum(model.nodes.size());
    for (std::size_t n = model.nodes.size(); n-- > 0;) {
        const model::Node& node = model.nodes[n];
        if (node.child_count == 0) {
            weight[n] = static_cast<double>(size_of(node.box));
            sum[n] = weight[n] * static_cast<double>(loss[n]);
        }
        loss[n] = weight[n] > 0 ? static_cast<float>(sum[n] / weight[n]) : loss[n];
        if (node.parent == model::none) continue;
        weight[node.parent] += weight[n];
        sum[node.parent] += sum[n];
    }
}

}  // namespace

std::vector<EffectGroup> groups_of(std::span<const model::EffectMask> switches) {
    std::vector<EffectGroup> groups;
    for (const model::EffectMask mask : switches) {
        model::EffectMask own = mask;
        for (const model::EffectMask other : switches)
            if (other != mask && (other & ~mask) == 0) own &= ~other;
        groups.push_back({mask, own});
    }
    return groups;
}

EffectWorth::EffectWorth(const model::Model& model, std::span<const EffectGroup> groups, std::span<const double> hours,
                         const std::array<float, 3>& sky)
    : groups_(groups.begin(), groups.end()), hours_(hours.begin(), hours.end()), nodes_(model.nodes.size()) {
    if (groups.empty()) return;
    std::vector<model::Daylight> moments;
    for (const double hour : hours_) moments.push_back(model::daylight_at(hour, model.light));
    if (moments.empty()) moments.push_back(model::daylight_of_model(model.sun_direction, model.light));
    fog_density_ = moments.front().fog_density;
    losses_.resize(moments.size() * groups_.size() * nodes_);
    const auto of = [&](std::size_t moment, std::size_t group) {
        return std::span(losses_).subspan((moment * groups_.size() + group) * nodes_, nodes_);
    };
    const model::Daylight own = model::daylight_of_model(model.sun_direction, model.light);
    double own_energy = 0;
    std::vector<double> energy(moments.size());
    std::vector<WorthPoint> points;
    for (std::size_t n = 0; n < nodes_; ++n) {
        if (model.nodes[n].child_count > 0) continue;
        collect_points(model, model.nodes[n], points);
        const auto size = static_cast<double>(size_of(model.nodes[n].box));
        own_energy += size * worth_of_leaf(points, {}, own, vec3(0.0F)).energy;
        for (std::size_t m = 0; m < moments.size(); ++m) {
            const vec3 fog = vec3(sky[0], sky[1], sky[2]) * moments[m].background;
            const LeafWorth worth = worth_of_leaf(points, groups_, moments[m], fog);
            energy[m] += size * worth.energy;
            for (std::size_t g = 0; g < groups_.size(); ++g) of(m, g)[n] = worth.losses[g];
        }
    }
    for (std::size_t m = 0; m < moments.size(); ++m) {
        constexpr double darkest = 0.01;
        const double bright = own_energy > 0 ? std::clamp(energy[m] / own_energy, darkest, 1.0) : 1.0;
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            for (float& loss : of(m, g)) loss /= static_cast<float>(bright);
            go_up(model, of(m, g));
        }
    }
}

std::array<prepare::EffectLoss, prepare::max_effect_groups> EffectWorth::at(float hour) const {
    std::array<prepare::EffectLoss, prepare::max_effect_groups> out{};
    std::size_t before = 0, after = 0;
    float between = 0;
    if (!hours_.empty() && std::isfinite(hour)) {
        const auto next = std::upper_bound(hours_.begin(), hours_.end(), static_cast<double>(hour));
        after = std::min<std::size_t>(static_cast<std::size_t>(next - hours_.begin()), hours_.size() - 1);
        before = next == hours_.begin() ? 0 : static_cast<std::size_t>(next - hours_.begin()) - 1;
        const double apart = hours_[after] - hours_[before];
        between = apart > 0 ? static_cast<float>((static_cast<double>(hour) - hours_[before]) / apart) : 0.0F;
    }
    const auto of = [&](std::size_t light, std::size_t group) {
        return std::span(losses_).subspan((light * groups_.size() + group) * nodes_, nodes_);
    };
    for (std::size_t g = 0; g < groups_.size(); ++g)
        out[g] = {of(before, g), of(after, g), between, effects::hides_by_depth(groups_[g].own), fog_density_};
    return out;
}

}  // namespace surefoot
