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

/// The mean colour of a texture: its smallest mip level.
vec3 mean_texel(const model::Model& model, const model::Texture& texture) {
    std::uint64_t at = texture.first_byte;
    for (std::uint32_t level = 0; level + 1 < texture.levels; ++level)
        at += std::uint64_t{4} * std::max(1U, texture.width >> level) * std::max(1U, texture.height >> level);
    if (texture.levels == 0 || at + 4 > model.texels.size()) return vec3(1.0F);
    const auto channel = [&](std::size_t c) { return static_cast<float>(model.texels[at + c]) / 255.0F; };
    return {channel(0), channel(1), channel(2)};
}

vec3 surface_colour(const model::Material& material, const model::Vertex& vertex, std::span<const vec3> mean_texels) {
    vec3 colour(material.colour[0], material.colour[1], material.colour[2]);
    if ((material.effects & model::effect_texture) != 0 && material.texture != model::none)
        colour *= mean_texels[material.texture];
    if ((material.effects & model::effect_vertex_colour) != 0)
        colour *= vec3(vertex.colour[0], vertex.colour[1], vertex.colour[2]) / 255.0F;
    return colour;
}

WorthPoint point_of(const model::Model& model, std::span<const vec3> mean_texels, const model::Part& part, const mat3& to_world,
                    std::uint32_t vertex, float area) {
    const model::Material& material = model.materials[part.material];
    const model::Vertex& v = model.vertices[vertex];
    WorthPoint point;
    point.area = area;
    point.effects = material.effects;
    point.colour = surface_colour(material, v, mean_texels);
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

/// Points of a leaf.
struct LeafPoints {
    std::array<WorthPoint, points_a_leaf> points;
    std::size_t count = 0;
    [[nodiscard]] std::span<const WorthPoint> all() const { return std::span(points).first(count); }
};

/// Corners of triangles that are evenly spread over the list of a leaf's full detail.
void collect_points(const model::Model& model, std::span<const vec3> mean_texels, const model::Node& leaf, LeafPoints& found) {
    found.count = 0;
    const model::Representation& rep = model.reps[leaf.first_rep + leaf.rep_count - 1];
    const mat3& linear = model.placements[rep.placement].linear;
    const mat3 to_world = cofactors(linear) * (glm::determinant(linear) < 0.0F ? -1.0F : 1.0F);
    const std::uint32_t stride = std::max(1U, (rep.triangles + points_a_leaf - 1) / points_a_leaf);
    std::uint32_t triangle = 0;
    for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        const model::Part& part = model.parts[p];
        for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3, ++triangle) {
            if (triangle % stride != 0 || found.count == points_a_leaf) continue;
            const auto corner = [&](std::uint32_t k) { return part.first_vertex + model.indices[part.first_index + i + k]; };
            const auto place = [&](std::uint32_t k) {
                const float* const at = model.vertices[corner(k)].position;
                return linear * vec3(at[0], at[1], at[2]);
            };
            const float area = 0.5F * glm::length(glm::cross(place(1) - place(0), place(2) - place(0)));
            found.points[found.count++] = point_of(model, mean_texels, part, to_world, corner((triangle / stride) % 3), area);
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

constexpr std::size_t nodes_ahead = 256;  // in a call: a fraction of a millisecond

}  // namespace

std::vector<EffectGroup> groups_of(std::span<const model::EffectMask> switches) {
    std::vector<EffectGroup> groups;
    for (const model::EffectMask mask : switches) {
        model::EffectMask priced = mask;
        for (const model::EffectMask other : switches)
            if (other != mask && (other & ~mask) == 0) priced &= ~other;
        groups.push_back({mask, priced & ~model::effect_moving_shadow, priced});  // its map is an item by itself
    }
    return groups;
}

std::vector<EffectGroup> groups_for_sale(std::span<const model::EffectMask> switches) {
    std::vector<model::EffectMask> sold;
    for (const EffectGroup& group : groups_of(switches))
        if (group.own != 0) sold.push_back(group.mask);
    return groups_of(sold);
}

EffectWorth::EffectWorth(const model::Model& model, std::span<const EffectGroup> groups, std::span<const double> hours,
                         const std::array<float, 3>& sky)
    : model_(&model),
      groups_(groups.begin(), groups.end()),
      hours_(hours.begin(), hours.end()),
      sky_(sky),
      nodes_(model.nodes.size()) {
    if (groups.empty()) return;
    for (const double hour : hours_) moments_.push_back(model::daylight_at(hour, model.light));
    const model::Daylight own = model::daylight_of_model(model.sun_direction, model.light);
    if (moments_.empty()) moments_.push_back(own);
    known_.resize(moments_.size(), false);
    pass_.moment = moments_.size();
    losses_.resize(moments_.size() * groups_.size() * nodes_);
    for (const model::Texture& texture : model.textures) mean_texels_.push_back(mean_texel(model, texture));
    weight_.resize(nodes_);
    sum_.resize(nodes_);
    LeafPoints points;
    for (std::size_t n = nodes_; n-- > 0;) {
        const model::Node& node = model.nodes[n];
        if (node.child_count == 0) {
            collect_points(model, mean_texels_, node, points);
            weight_[n] = static_cast<double>(size_of(node.box));
            own_energy_ += weight_[n] * worth_of_leaf(points.all(), {}, own, vec3(0.0F)).energy;
        }
        if (node.parent != model::none) weight_[node.parent] += weight_[n];
    }
}

/// Goes on with a light, up to so many nodes.
void EffectWorth::go_on(std::size_t moment, std::size_t max_nodes) {
    if (pass_.moment != moment) pass_ = {moment, 0, 0};
    const vec3 fog = vec3(sky_[0], sky_[1], sky_[2]) * moments_[moment].background;
    LeafPoints points;
    const std::size_t end = pass_.node + std::min(max_nodes, nodes_ - pass_.node);
    for (; pass_.node < end; ++pass_.node) {
        const model::Node& node = model_->nodes[pass_.node];
        if (node.child_count > 0) continue;
        collect_points(*model_, mean_texels_, node, points);
        const LeafWorth worth = worth_of_leaf(points.all(), groups_, moments_[moment], fog);
        pass_.energy += weight_[pass_.node] * worth.energy;
        for (std::size_t g = 0; g < groups_.size(); ++g) losses_of(moment, g)[pass_.node] = worth.losses[g];
    }
    if (pass_.node == nodes_) finish();
}

/// All leaves of the light are known.
void EffectWorth::finish() {
    constexpr double darkest = 0.01;
    const double bright = own_energy_ > 0 ? std::clamp(pass_.energy / own_energy_, darkest, 1.0) : 1.0;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        for (float& loss : losses_of(pass_.moment, g)) loss /= static_cast<float>(bright);
        go_up(losses_of(pass_.moment, g));
    }
    known_[pass_.moment] = true;
    pass_.moment = moments_.size();
}

/// A cluster's loss is the mean of its leaves', by their size.
void EffectWorth::go_up(std::span<float> loss) {
    std::fill(sum_.begin(), sum_.end(), 0.0);
    for (std::size_t n = nodes_; n-- > 0;) {
        const model::Node& node = model_->nodes[n];
        if (node.child_count == 0) sum_[n] = weight_[n] * static_cast<double>(loss[n]);
        loss[n] = weight_[n] > 0 ? static_cast<float>(sum_[n] / weight_[n]) : loss[n];
        if (node.parent != model::none) sum_[node.parent] += sum_[n];
    }
}

/// The day goes on, or back: the lights of the hours around are soon needed.
void EffectWorth::look_ahead(std::size_t after) {
    const std::size_t count = moments_.size();
    for (const std::size_t by : {std::size_t{1}, std::size_t{2}, count - 2, count - 3}) {
        const std::size_t moment = (after + by) % count;
        if (!known_[moment]) return go_on(moment, nodes_ahead);
    }
}

std::array<prepare::EffectLoss, prepare::max_effect_groups> EffectWorth::at(float hour) {
    std::array<prepare::EffectLoss, prepare::max_effect_groups> out{};
    if (!any()) return out;
    std::size_t before = 0, after = 0;
    float between = 0;
    if (!hours_.empty() && std::isfinite(hour)) {
        const auto next = std::upper_bound(hours_.begin(), hours_.end(), static_cast<double>(hour));
        after = std::min<std::size_t>(static_cast<std::size_t>(next - hours_.begin()), hours_.size() - 1);
        before = next == hours_.begin() ? 0 : static_cast<std::size_t>(next - hours_.begin()) - 1;
        const double apart = hours_[after] - hours_[before];
        between = apart > 0 ? static_cast<float>((static_cast<double>(hour) - hours_[before]) / apart) : 0.0F;
    }
    for (const std::size_t moment : {before, after})
        if (!known_[moment]) go_on(moment, nodes_);
    if (moments_.size() > 3) look_ahead(after);
    for (std::size_t g = 0; g < groups_.size(); ++g)
        out[g] = {losses_of(before, g), losses_of(after, g), between, effects::hides_by_depth(groups_[g].own),
                  moments_.front().fog_density};
    return out;
}

}  // namespace surefoot
