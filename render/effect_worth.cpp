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

// Leaves shaded in a call, each one or two microseconds: where a light is missing, and before it is needed.
constexpr std::size_t missing_nodes = 2048, nodes_ahead = 256;
constexpr std::size_t sums_a_node = 32;  // take as long as a leaf
constexpr std::size_t whole_light = ~std::size_t{0} / sums_a_node;

/// Hours from one to another, forwards.
double hours_on(double from, double to) {
    const double hours = std::fmod(to - from, 24.0);
    return hours < 0 ? hours + 24.0 : hours;
}

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

/// Goes on with a light, or with the one that was begun. Returns the steps that are left.
std::size_t EffectWorth::go_on(std::size_t moment, std::size_t max_steps) {
    if (pass_.moment == moments_.size()) pass_ = {moment, 0, 0, 0};
    const std::size_t leaves = std::min(max_steps, nodes_ - pass_.node);
    shade(pass_.node + leaves);
    max_steps -= leaves;
    if (pass_.node < nodes_) return 0;
    const std::size_t sums = std::min(max_steps * sums_a_node, nodes_ * groups_.size() - pass_.summed);
    go_up(pass_.summed + sums);
    if (pass_.summed < nodes_ * groups_.size()) return 0;
    known_[pass_.moment] = started_ = true;
    pass_.moment = moments_.size();
    return max_steps - (sums + sums_a_node - 1) / sums_a_node;
}

/// Leaves up to a node.
void EffectWorth::shade(std::size_t end) {
    const vec3 fog = vec3(sky_[0], sky_[1], sky_[2]) * moments_[pass_.moment].background;
    LeafPoints points;
    for (; pass_.node < end; ++pass_.node) {
        const model::Node& node = model_->nodes[pass_.node];
        if (node.child_count > 0) continue;
        collect_points(*model_, mean_texels_, node, points);
        const LeafWorth worth = worth_of_leaf(points.all(), groups_, moments_[pass_.moment], fog);
        pass_.energy += weight_[pass_.node] * worth.energy;
        for (std::size_t g = 0; g < groups_.size(); ++g) losses_of(pass_.moment, g)[pass_.node] = worth.losses[g];
    }
}

/// All leaves of the light are known. A cluster's loss is the mean of its leaves', by their size.
void EffectWorth::go_up(std::size_t end) {
    constexpr double darkest = 0.01;
    const auto bright = static_cast<float>(own_energy_ > 0 ? std::clamp(pass_.energy / own_energy_, darkest, 1.0) : 1.0);
    for (; pass_.summed < end; ++pass_.summed) {
        const std::span<float> loss = losses_of(pass_.moment, pass_.summed / nodes_);
        const std::size_t n = nodes_ - 1 - pass_.summed % nodes_;
        const model::Node& node = model_->nodes[n];
        if (node.child_count == 0) sum_[n] = weight_[n] * static_cast<double>(loss[n] / bright);
        loss[n] = weight_[n] > 0 ? static_cast<float>(sum_[n] / weight_[n]) : loss[n] / bright;
        if (node.parent != model::none) sum_[node.parent] += sum_[n];
        sum_[n] = 0;  // for the next group
    }
}

/// The day goes on, or back: the lights of the hours that come next are soon needed, then perhaps those on the other side.
void EffectWorth::look_ahead(const Between& now) {
    const std::size_t count = moments_.size();
    if (pass_.moment < count) {
        go_on(pass_.moment, nodes_ahead);
        return;
    }
    const std::array<std::size_t, 2> later{now.after + 1, now.after + 2}, earlier{now.before + count - 1, now.before + count - 2};
    for (const std::array<std::size_t, 2>& side : {day_runs_ < 0 ? earlier : later, day_runs_ < 0 ? later : earlier}) {
        for (const std::size_t moment : side) {
            if (known_[moment % count]) continue;
            go_on(moment % count, nodes_ahead);
            return;
        }
    }
}

/// Which way the day runs.
void EffectWorth::follow(double hour) {
    const double on = hours_on(last_hour_, hour);
    if (started_ && on > 0) day_runs_ = on > 12 ? -1 : 1;
    last_hour_ = hour;
}

/// A part of what is missing. A light that was begun is finished first, or a fast day would never have one.
void EffectWorth::work(const Between& wanted) {
    const auto all_known = [&] { return known_[wanted.before] && known_[wanted.after]; };
    std::size_t left = started_ ? missing_nodes : whole_light;
    if (pass_.moment < moments_.size() && !all_known()) left = go_on(pass_.moment, left);
    const bool back = day_runs_ < 0;
    for (const std::size_t moment : {back ? wanted.before : wanted.after, back ? wanted.after : wanted.before})
        if (!known_[moment] && left > 0) left = go_on(moment, left);
    if (moments_.size() > 3 && day_runs_ != 0 && all_known()) look_ahead(wanted);
}

EffectWorth::Between EffectWorth::around(double hour) const {
    if (hours_.empty()) return {};
    const auto next = std::upper_bound(hours_.begin(), hours_.end(), hour);
    const std::size_t after = std::min<std::size_t>(static_cast<std::size_t>(next - hours_.begin()), hours_.size() - 1);
    const std::size_t before = next == hours_.begin() ? 0 : static_cast<std::size_t>(next - hours_.begin()) - 1;
    const double apart = hours_[after] - hours_[before];
    return {before, after, apart > 0 ? static_cast<float>((hour - hours_[before]) / apart) : 0.0F};
}

/// Where one of them is missing, the nearest known light, round the clock. Some light is known.
EffectWorth::Between EffectWorth::known_around(const Between& wanted, double hour) const {
    if (known_[wanted.before] && known_[wanted.after]) return wanted;
    const std::size_t count = moments_.size();
    std::size_t before = wanted.before, after = wanted.after;
    while (!known_[before]) before = (before + count - 1) % count;
    while (!known_[after]) after = (after + 1) % count;
    const bool later = hours_on(hour, hours_[after]) < hours_on(hours_[before], hour);
    return {later ? after : before, later ? after : before, 0.0F};
}

std::array<prepare::EffectLoss, prepare::max_effect_groups> EffectWorth::at(float hour, model::EffectMask without) {
    std::array<prepare::EffectLoss, prepare::max_effect_groups> out{};
    if (!any()) return out;
    const double now = std::isfinite(hour) ? static_cast<double>(hour) : 0.0;
    const Between wanted = std::isfinite(hour) ? around(now) : Between{};
    follow(now);
    work(wanted);
    const Between shown = known_around(wanted, now);
    const bool clear = effects::hides_by_depth(without);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const bool is_fog = effects::hides_by_depth(groups_[g].own);
        out[g] = {losses_of(shown.before, g), losses_of(shown.after, g), shown.share, is_fog,
                  clear && !is_fog ? 0.0F : moments_.front().fog_density};
    }
    return out;
}

}  // namespace surefoot
